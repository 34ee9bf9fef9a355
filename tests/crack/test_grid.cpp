// Insertion on an integer grid: small bodies, fronts through grid points only, so that vertices,
// edges, faces, old fronts and old cracks are met exactly, and sweeps fold back over themselves.
#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>

#include "cases.h"
#include "crack/grid_case.h"
#include "crack/shrink.h"
#include "kerf/crack.h"
#include "kerf/files.h"
#include "kerf/parallel.h"
#include "kerf/progress.h"

using namespace geo;

TEST_CASE("random fronts on an integer grid keep every invariant after every step", "[grid]") {
  // A campaign: KERF_CASES=1000 KERF_SEED=7 test_crack '[grid]'; one case of it: KERF_CASE=7000123.
  const Seeds which = seeds(150);
  std::size_t steps = 0, refused = 0;
  std::map<std::string, std::size_t> reasons;
  Stopwatch watch;
  // Cases are independent: they run on all cores and are reported in order.
  constexpr int batch = 256;
  std::vector<GridOutcome> outcomes(batch);
  for (int c = 0; c < which.count; ++c) {
    if (c % batch == 0)
      parallel_for(static_cast<std::size_t>(std::min(batch, which.count - c)), 4,
                   [&](std::size_t from, std::size_t to) {
                     for (auto i = from; i < to; ++i)
                       outcomes[i] = outcome(random_case(which.first + static_cast<std::uint64_t>(c) + i));
                   });
    const std::uint64_t seed = which.first + static_cast<std::uint64_t>(c);
    const GridOutcome& result = outcomes[static_cast<std::size_t>(c % batch)];
    steps += result.steps;
    refused += result.refused;
    for (const auto& [reason, times] : result.reasons) reasons[reason] += times;
    if (result.violation.empty()) continue;
    const std::string kind = kind_of(result.violation), file = "grid-" + std::to_string(seed) + ".front";
    const GridCase small =
        shrink(random_case(seed), [&](const GridCase& g) { return kind_of(outcome(g).violation) == kind; });
    write_all(file, [&](std::ostream& out) {
      write_case(out, small, "expect: good; found with seed " + std::to_string(seed) + ": " + result.violation);
    });
    FAIL_CHECK("seed " << seed << ", " << result.where << ": " << result.violation << "; the smallest such case is in "
                       << file);
  }
  const double seconds = watch.lap();
  for (const auto& [reason, times] : reasons) WARN(times << " of " << steps << " steps refused: " << reason);
  if (std::getenv("KERF_CASES"))
    WARN(which.count / seconds << " cases and " << static_cast<double>(steps) / seconds << " steps a second");
  // Where an older repair has left a point an ulp beside a plane of the grid, a few steps cannot be
  // rounded.
  CHECK(refused * 200 <= std::max<std::size_t>(steps, 200));
}

TEST_CASE("refusals of each kind, shrunk into files", "[.refusals]") {
  // Not a test: the source of cases to keep. KERF_CASES=200 KERF_SEED=11 test_crack '[refusals]'.
  const Seeds which = seeds(150);
  std::map<std::string, int> known;
  for (int c = 0; c < which.count; ++c) {
    const std::uint64_t seed = which.first + static_cast<std::uint64_t>(c);
    const GridCase grid = random_case(seed);
    const GridOutcome result = outcome(grid);
    for (const auto& refusal : result.reasons) {
      const std::string& reason = refusal.first;
      if (++known[reason] > 3) continue;
      const GridCase small = shrink(grid, [&](const GridCase& g) { return outcome(g).reasons.count(reason) > 0; });
      write_all("refused-" + std::to_string(seed) + ".front",
                [&](std::ostream& out) { write_case(out, small, "expect: refused; " + reason); });
    }
  }
  for (const auto& [reason, times] : known) WARN(times << " times: " << reason);
}

TEST_CASE("kept cases of degenerate fronts are as their files say") {
  // "expect: good": every step is made; "expect: refused": one is refused, and leaves everything as
  // it was.
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(KERF_KEPT_FOLDER)) {
    if (entry.path().extension() != ".front") continue;
    const std::string name = entry.path().filename().string(), text = read_all(entry.path().string());
    CAPTURE(name);
    const bool good = text.find("expect: good") != std::string::npos;
    REQUIRE(good != (text.find("expect: refused") != std::string::npos));
    const GridOutcome result = outcome(read_case(text, name), true);
    CHECK(result.where + result.violation == "");
    if (good) CHECK(result.refused == 0);
    if (!good && result.refused == 0) WARN(name << " is no longer refused: say 'expect: good' there");
    ++count;
  }
  CHECK(count >= 5);
}

TEST_CASE("a failing case is shrunk to what makes it fail") {
  // Artificial: fails while a closed crack has a point at x = 3 that a step takes to y < 0.
  const auto fails = [](const GridCase& grid) {
    for (const auto& c : grid.cracks)
      for (std::size_t s = 1; s < c.rows.size(); ++s)
        for (std::size_t p = 0; p < c.rows[s].size(); ++p)
          if (c.closed && c.rows[s - 1][p].x() >= 3 && c.rows[s][p].y() < 0) return true;
    return false;
  };
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const GridCase grid = random_case(seed);
    if (!fails(grid)) continue;
    ++found;
    const GridCase small = shrink(grid, fails);
    CAPTURE(seed);
    REQUIRE(small.cracks.size() == 1);
    CHECK(small.divisions == 1);
    CHECK(small.cracks[0].closed);
    REQUIRE(small.cracks[0].rows.size() == 2);
    CHECK(small.cracks[0].rows[0].size() == 3);
    std::vector<double> numbers;
    for (const auto& row : small.cracks[0].rows)
      for (const auto& p : row)
        for (int axis = 0; axis < 3; ++axis)
          if (p[axis] != 0) numbers.push_back(p[axis]);
    std::sort(numbers.begin(), numbers.end());
    CHECK(numbers == std::vector<double>{-1, 3});
    std::ostringstream text;
    write_case(text, small, "expect: good");
    CHECK(read_case(text.str(), "small.front").cracks[0].rows == small.cracks[0].rows);
  }
  CHECK(found > 3);
}

TEST_CASE("a sheet in one step cuts as its front does in twelve") {
  const TriangleMesh model = make_pumpkin(6);
  for (int seed = 1; seed <= cases(10); ++seed) {
    CAPTURE(seed);
    Random random(static_cast<std::uint64_t>(seed));
    const Vec3 n = random.direction(), u = n.unitOrthogonal(), v = n.cross(u);
    std::vector<std::vector<Vec3>> rows;
    TriangleMesh sheet;
    for (int s = 0; s <= 12; ++s) {
      rows.emplace_back();
      for (int i = 0; i <= 10; ++i)
        rows.back().push_back(3.4 * (s / 12.0 - 0.5) * u + 3.4 * (i / 10.0 - 0.5) * v +
                              (0.1 * std::sin(s * 0.7) + 0.1 * std::cos(i * 0.9)) * n);
      sheet.vertices.insert(sheet.vertices.end(), rows.back().begin(), rows.back().end());
    }
    // The same triangles as the sweep's: a fan around the new left point, closed by the one that
    // holds the new front.
    for (std::uint32_t s = 0; s < 12; ++s)
      for (std::uint32_t i = 0; i < 10; ++i) {
        const std::uint32_t a = s * 11 + i, b = a + 1, c = a + 11, d = c + 1;
        sheet.triangles.push_back({a, b, c});
        sheet.triangles.push_back({b, d, c});
      }
    Complex once = Complex::from_skin(model), slowly = once;
    insert_sheet(once, sheet, 1);
    FrontState front = begin_front(rows[0], false, 1);
    for (std::size_t s = 1; s < rows.size(); ++s) advance(slowly, front, rows[s]);
    CHECK(fault_of(once, signed_volume(model)) == "");
    CHECK(fault_of(slowly, signed_volume(model)) == "");
    const Pieces a = find_pieces(once), b = find_pieces(slowly);
    REQUIRE(a.count == b.count);
    CHECK(a.count >= 2);
    for (std::size_t p = 0; p < a.count; ++p) CHECK(std::abs(a.volume[p] - b.volume[p]) <= 1e-9 * signed_volume(model));
  }
}
