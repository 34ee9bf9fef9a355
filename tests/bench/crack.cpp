// Progressive cutting: a curved sheet of 12 steps × 40 front points through a model, Kerf against
// CGAL's corefine.
#include <cmath>
#include <cstdio>
#include <map>

#include "bench.h"
#include "crack_peers.h"
#include "kerf/check.h"
#include "kerf/crack.h"
#include "kerf/files.h"
#include "kerf/mesh.h"
#include "kerf/pieces.h"

namespace bench {
namespace {

constexpr int steps = 12, points = 40;

// The front after `s` steps: a wavy sheet across the box, in general position relative to the axes.
std::vector<geo::Vec3> front_at(const geo::Box3& box, int s) {
  const geo::Vec3 u = geo::Vec3(0.62, -0.47, 0.31).normalized(), v = u.cross(geo::Vec3(0.2, 0.3, -0.9)).normalized(),
                  n = u.cross(v);
  const double half = 0.62 * box.diagonal(), a = 2.6 * (double(s) / steps - 0.5);
  std::vector<geo::Vec3> front;
  for (int i = 0; i < points; ++i) {
    const double b = 2.6 * (double(i) / (points - 1) - 0.5);
    const double h = 0.09 * std::sin(1.7 * a + 0.3) + 0.06 * std::cos(2.1 * b + 0.5) + 0.03 * a * b + 0.0137;
    front.push_back(box.center() + half / 1.3 * (a * u + b * v + h * n));
  }
  return front;
}

geo::TriangleMesh sheet_of(const geo::Box3& box, int from, int to) {
  geo::TriangleMesh m;
  for (int s = from; s <= to; ++s) {
    const auto row = front_at(box, s);
    m.vertices.insert(m.vertices.end(), row.begin(), row.end());
  }
  for (std::uint32_t s = 0; s < static_cast<std::uint32_t>(to - from); ++s)
    for (std::uint32_t i = 0; i + 1 < points; ++i) {
      const std::uint32_t a = s * points + i, b = a + 1, c = a + points, d = c + 1;
      m.triangles.push_back({a, b, c});
      m.triangles.push_back({b, d, c});
    }
  return m;
}

struct Row {
  std::string name;
  std::size_t triangles = 0, cut = 0, pieces = 0;
  double progressive = 0, oneshot = 0, idle = 0, restarted = 0, corefine = 0, floor = 0;
  geo::CrackStats stats;
};

Row measure(const std::string& name, const geo::TriangleMesh& model) {
  Row row;
  row.name = name;
  row.triangles = model.triangles.size();
  const geo::Box3 box = geo::bounding_box(model);
  std::vector<std::vector<geo::Vec3>> fronts;
  for (int s = 0; s <= steps; ++s) fronts.push_back(front_at(box, s));
  const auto whole = sheet_of(box, 0, steps);
  std::vector<geo::TriangleMesh> growing;
  for (int s = 1; s <= steps; ++s) growing.push_back(sheet_of(box, 0, s));
  // A front that moves beside the model: nothing is cut.
  std::vector<geo::Vec3> beside = fronts[0], beyond = fronts[1];
  for (auto* f : {&beside, &beyond})
    for (auto& p : *f) p -= 0.55 * box.diagonal() * geo::Vec3(0.62, -0.47, 0.31).normalized();

  row.progressive = row.oneshot = row.idle = row.restarted = row.corefine = row.floor = 1e300;
  const auto lower = [](double& least_yet, double t) { least_yet = std::min(least_yet, t); };
  geo::Complex k;
  // All variants in turn, repeatedly: slow moments of a shared machine must not fall on one
  // variant.
  const int rounds = row.triangles > 300000 ? 2 : 4;
  for (int round = 0; round < rounds; ++round) {
    for (int run = 0; run < 5; ++run) {
      k = geo::Complex::from_skin(model);
      geo::CrackStats stats;
      geo::FrontState front = geo::begin_front(fronts[0], false, 1);
      const double start = cpu_seconds();
      for (int s = 1; s <= steps; ++s) geo::advance(k, front, fronts[static_cast<std::size_t>(s)], {}, &stats);
      if (const double t = cpu_seconds() - start; t < row.progressive) {
        row.progressive = t;
        row.stats = stats;
      }
    }
    row.pieces = geo::find_pieces(k).count;
    lower(row.oneshot, least([&] { k = geo::Complex::from_skin(model); }, [&] { geo::insert_sheet(k, whole, 1); }, 5));
    k = geo::Complex::from_skin(model);
    geo::FrontState state;
    lower(row.idle,
          least([&] { state = geo::begin_front(beside, false, 1); }, [&] { geo::advance(k, state, beyond); }, 200));
    lower(row.restarted, corefine_seconds(model, growing, 1));
    lower(row.corefine, corefine_seconds(model, {whole}, 2));
    lower(row.floor, floor_seconds(model, whole, 5, row.cut));
  }
  return row;
}

}  // namespace

int crack(const Options& options) {
  std::vector<Row> rows;
  for (const int f : options.frequencies)
    rows.push_back(measure("pumpkin " + std::to_string(20 * f * f), geo::make_pumpkin(f)));
  for (const auto& path : options.models)
    rows.push_back(measure(path.substr(path.find_last_of('/') + 1), geo::read_surface(path).mesh));
  if (!options.json) {
    std::printf(
        "CPU ms; 12 steps x 40 points\n%-18s %7s %6s | %8s = %5s %5s %5s %5s %6s %5s | %8s %6s | %9s %9s %7s | %9s %9s "
        "%7s\n",
        "model", "cut", "pieces", "12 steps", "near", "meet", "split", "keep", "stitch", "guard", "one-shot", "idle",
        "restarted", "corefine", "floor", "x restart", "x corefi", "x floor");
    for (const Row& r : rows)
      std::printf(
          "%-18s %7zu %6zu | %8.2f = %5.2f %5.2f %5.2f %5.2f %6.2f %5.2f | %8.2f %6.3f | %9.1f %9.1f %7.2f | %9.1f "
          "%9.2f %7.2f\n",
          r.name.c_str(), r.cut, r.pieces, 1e3 * r.progressive, 1e3 * r.stats.near_seconds, 1e3 * r.stats.meet_seconds,
          1e3 * r.stats.split_seconds, 1e3 * r.stats.keep_seconds, 1e3 * r.stats.stitch_seconds,
          1e3 * r.stats.guard_seconds, 1e3 * r.oneshot, 1e3 * r.idle, 1e3 * r.restarted, 1e3 * r.corefine,
          1e3 * r.floor, r.restarted / r.progressive, r.corefine / r.oneshot, r.progressive / r.floor);
  }
  Figures figures;
  const auto size_name = [](std::size_t n) {
    return n > 300000 ? "640k" : n > 100000 ? "160k" : n > 20000 ? "40k" : n > 5000 ? "10k" : "2k";
  };
  for (const Row& r : rows) {
    if (r.name.rfind("pumpkin", 0) != 0) continue;
    const std::string size = size_name(r.triangles);
    figures["progressive_vs_corefine_" + size] = r.restarted / r.progressive;
    figures["oneshot_vs_corefine_" + size] = r.corefine / r.oneshot;
    figures["progressive_vs_floor_" + size] = r.progressive / r.floor;
    figures["idle_step_us_" + size] = 1e6 * r.idle;
    figures["cut_triangles_per_second_" + size] = double(r.cut) / r.progressive;
  }
  if (options.frequencies.size() >= 2) {
    const Row &a = rows[0], &b = rows[options.frequencies.size() - 1];
    figures["progressive_exponent"] = growth(a.progressive, b.progressive, double(a.triangles), double(b.triangles));
  }
  print(figures, options.json);
  return 0;
}

}  // namespace bench
