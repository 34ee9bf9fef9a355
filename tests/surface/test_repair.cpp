// Repair of surfaces that are nearly solid.
#include <catch2/catch.hpp>

#include "base/random.h"
#include "cases.h"
#include "kerf/check.h"
#include "kerf/mesh.h"
#include "kerf/repair.h"

using namespace geo;

namespace {

// Texture coordinates equal to the corner's position.
TriangleMesh dressed(TriangleMesh mesh) {
  for (const auto& t : mesh.triangles) {
    auto& row = mesh.attributes.uv.emplace_back();
    for (int k = 0; k < 3; ++k) row[k] = mesh.vertices[t[k]].head<2>();
    mesh.attributes.group.push_back(static_cast<std::int32_t>(mesh.attributes.group.size() % 2));
  }
  mesh.attributes.group_names = {"a", "b"};
  return mesh;
}

void drop_row(TriangleMesh& mesh, std::size_t t) {
  const auto at = static_cast<std::ptrdiff_t>(t);
  mesh.triangles.erase(mesh.triangles.begin() + at);
  mesh.attributes.uv.erase(mesh.attributes.uv.begin() + at);
  mesh.attributes.group.erase(mesh.attributes.group.begin() + at);
}

void add(TriangleMesh& mesh, const TriangleMesh& other, double scale, const Vec3& to, bool turned) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Vec3& p : other.vertices) mesh.vertices.push_back(scale * p + to);
  for (auto [a, b, c] : other.triangles)
    mesh.triangles.push_back(turned ? Triangle{first + a, first + c, first + b}
                                    : Triangle{first + a, first + b, first + c});
}

void check_dress(const TriangleMesh& mesh) {
  REQUIRE(mesh.attributes.uv.size() == mesh.triangles.size());
  REQUIRE(mesh.attributes.group.size() == mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) CHECK(mesh.attributes.uv[t][k] == Vec2(mesh.vertices[mesh.triangles[t][k]].head<2>()));
}

}  // namespace

TEST_CASE("a sound solid stays as it is") {
  TriangleMesh mesh = dressed(make_sphere(5));
  const auto triangles = mesh.triangles;
  CHECK(repair(mesh).nothing());
  CHECK(mesh.triangles == triangles);
  check_dress(mesh);
}

TEST_CASE("triangles missing, turned, twice, and with a vertex twice, are mended in one go") {
  const auto [first, count] = seeds(10);
  const std::uint64_t seed = first + static_cast<std::uint64_t>(GENERATE_COPY(range(0, count)));
  CAPTURE(seed);
  Random random(seed);
  const TriangleMesh ball = dressed(make_sphere(6));
  TriangleMesh mesh = ball;
  drop_row(mesh, random.below(mesh.triangles.size()));
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (random.below(5) == 0) {
      std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
      std::swap(mesh.attributes.uv[t][1], mesh.attributes.uv[t][2]);
    }
  const auto twice = static_cast<std::uint32_t>(random.below(mesh.triangles.size()));
  const auto again = [&](const Triangle& t) {
    mesh.triangles.push_back(t);
    auto& row = mesh.attributes.uv.emplace_back();
    for (int k = 0; k < 3; ++k) row[k] = mesh.vertices[t[k]].head<2>();
    mesh.attributes.group.push_back(0);
  };
  again(mesh.triangles[twice]);
  again({mesh.triangles[0][0], mesh.triangles[0][0], mesh.triangles[0][1]});
  mesh.vertices.push_back({9, 9, 9});
  const RepairStats done = repair(mesh);
  CHECK(done.dropped_triangles == 2);
  CHECK(done.flipped_triangles > 0);
  CHECK(done.filled_holes == 1);
  CHECK(done.added_triangles == 1);
  CHECK(check_surface(mesh, SelfIntersections::find).first_problem == "");
  CHECK(mesh.vertices.size() == ball.vertices.size());
  CHECK(signed_volume(mesh) == Approx(signed_volume(ball)));
  check_dress(mesh);
}

TEST_CASE("a hole of many corners is closed, its dress that of its rim") {
  TriangleMesh mesh = dressed(make_block({2, 1, 1}, 0.25));
  const double volume = signed_volume(mesh);
  for (std::size_t t = mesh.triangles.size(); t-- > 0;) {
    const auto& [a, b, c] = mesh.triangles[t];
    if (mesh.vertices[a].z() == 1 && mesh.vertices[b].z() == 1 && mesh.vertices[c].z() == 1) drop_row(mesh, t);
  }
  const RepairStats done = repair(mesh);
  CHECK(done.filled_holes == 1);
  CHECK(check_surface(mesh, SelfIntersections::find).first_problem == "");
  CHECK(signed_volume(mesh) == Approx(volume));
  check_dress(mesh);
}

TEST_CASE("a hole closed smoothly goes on from what is around it, as fine as its rim") {
  // A ball without its cap: the plane through the rim is far below where the cap was.
  const TriangleMesh ball = make_sphere(12);
  for (const double from : {0.9, 0.6, 0.2}) {
    CAPTURE(from);
    TriangleMesh open = dressed(ball);
    for (std::size_t t = open.triangles.size(); t-- > 0;)
      if (const auto& [a, b, c] = open.triangles[t];
          open.vertices[a].z() > from && open.vertices[b].z() > from && open.vertices[c].z() > from)
        drop_row(open, t);
    const std::size_t rows = open.triangles.size();
    TriangleMesh flat = open, mesh = open;
    repair(flat);
    const RepairStats done = repair(mesh, {.smooth_fill = true});
    CHECK(done.filled_holes == 1);
    CHECK(done.smooth_fills == 1);
    CHECK(check_surface(mesh, SelfIntersections::find).first_problem == "");
    CHECK(mesh.attributes.uv.size() == mesh.triangles.size());
    CHECK(mesh.attributes.group.size() == mesh.triangles.size());
    const double missing = signed_volume(ball) - signed_volume(flat);
    CHECK(std::abs(signed_volume(ball) - signed_volume(mesh)) < 0.4 * missing);
    // Edges about as long as the ball's, and no triangle as thin as those between corners of the
    // rim.
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      if (t < rows) continue;
      const auto& [a, b, c] = mesh.triangles[t];
      const Vec3 &p = mesh.vertices[a], &q = mesh.vertices[b], &r = mesh.vertices[c];
      CHECK(std::max({(p - q).norm(), (q - r).norm(), (r - p).norm()}) < 0.5);
    }
    CHECK(mesh.triangles.size() - rows > 3 * (flat.triangles.size() - rows));
  }
}

TEST_CASE("a smooth patch that would cross something is not taken") {
  // An open box beside whose opening a ball lies: the dome would pass through it.
  TriangleMesh mesh = make_block({1, 1, 1}, 0.1);
  for (std::size_t t = mesh.triangles.size(); t-- > 0;) {
    const auto& [a, b, c] = mesh.triangles[t];
    if (mesh.vertices[a].z() == 1 && mesh.vertices[b].z() == 1 && mesh.vertices[c].z() == 1)
      mesh.triangles.erase(mesh.triangles.begin() + static_cast<std::ptrdiff_t>(t));
  }
  TriangleMesh dome = mesh;
  CHECK(repair(dome, {.smooth_fill = true}).smooth_fills == 1);
  CHECK(check_surface(dome, SelfIntersections::find).first_problem == "");
  CHECK(signed_volume(dome) > 1.05);
  add(mesh, make_sphere(6), 0.3, {0.5, 0.5, 1.32}, false);
  const RepairStats done = repair(mesh, {.smooth_fill = true});
  CHECK(done.filled_holes == 1);
  CHECK(done.smooth_fills == 0);
  CHECK(check_surface(mesh, SelfIntersections::find).first_problem == "");
}

TEST_CASE("random holes are closed smoothly or flat, without a crossing where there was none") {
  const auto [first, count] = seeds(12);
  const std::uint64_t seed = first + static_cast<std::uint64_t>(GENERATE_COPY(range(0, count)));
  CAPTURE(seed);
  Random random(seed);
  TriangleMesh mesh = seed % 2 ? make_pumpkin(8) : make_sphere(9);
  // Everything in some balls, and some triangles by themselves.
  std::vector<std::pair<Vec3, double>> balls;
  for (int i = 0; i < 3; ++i)
    balls.push_back({mesh.vertices[random.below(mesh.vertices.size())], 0.15 + 0.4 * random.uniform()});
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    return random.below(60) == 0 || std::any_of(balls.begin(), balls.end(), [&](const auto& b) {
             return (mesh.vertices[t[0]] - b.first).norm() < b.second;
           });
  });
  TriangleMesh flat = mesh;
  repair(flat);
  const RepairStats done = repair(mesh, {.smooth_fill = true});
  CAPTURE(done.filled_holes, done.smooth_fills);
  if (check_surface(flat, SelfIntersections::find).first_problem == "")
    CHECK(check_surface(mesh, SelfIntersections::find).first_problem == "");
}

TEST_CASE("seams that are a little apart are welded within reach") {
  const TriangleMesh ball = make_sphere(4);
  TriangleMesh soup;
  Random random(3);
  for (const auto& t : ball.triangles) {
    const auto first = static_cast<std::uint32_t>(soup.vertices.size());
    for (const auto v : t)
      soup.vertices.push_back(ball.vertices[v] + 1e-6 * Vec3(random.uniform(), random.uniform(), random.uniform()));
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  TriangleMesh apart = soup;
  repair(apart);
  CHECK(apart.vertices.size() != ball.vertices.size());
  CHECK(repair(soup, {.weld_distance = 1e-5}).welded_vertices == 3 * ball.triangles.size() - ball.vertices.size());
  CHECK(check_surface(soup, SelfIntersections::find).first_problem == "");
}

TEST_CASE("shells are turned outwards, cavities inwards, and what is hidden in a solid goes") {
  const TriangleMesh ball = make_sphere(4);
  const double one = signed_volume(ball);
  for (const bool flipped : {false, true}) {
    CAPTURE(flipped);
    TriangleMesh mesh;
    add(mesh, ball, 1, Vec3::Zero(), flipped);
    add(mesh, ball, 0.3, {0.4, 0, 0}, !flipped);  // a cavity
    add(mesh, ball, 0.3, {-0.4, 0, 0}, flipped);  // hidden
    add(mesh, ball, 0.1, {0.4, 0, 0}, flipped);   // a core in the cavity
    add(mesh, ball, 1, {5, 0, 0}, true);          // beside it all
    const RepairStats done = repair(mesh);
    CHECK(done.dropped_shells == 1);
    CHECK(check_surface(mesh, SelfIntersections::find).first_problem == "");
    CHECK(signed_volume(mesh) == Approx(one * (2 - 0.027 + 0.001)));
  }
}

TEST_CASE("triangles reported as turned are those whose orientation differs in the end") {
  const auto [first, count] = seeds(100);
  const TriangleMesh ball = make_sphere(3);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    CAPTURE(seed);
    Random random(seed);
    TriangleMesh mesh = ball;
    const double share = random.uniform();  // above a half, the component is turned the wrong way first
    std::size_t turned = 0;
    for (Triangle& t : mesh.triangles)
      if (random.uniform() < share) {
        std::swap(t[1], t[2]);
        ++turned;
      }
    CHECK(repair(mesh).flipped_triangles == turned);
    CHECK(signed_volume(mesh) == Approx(signed_volume(ball)));
  }
}

TEST_CASE("anything in gives an end") {
  const auto [first, count] = seeds(200);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    CAPTURE(seed);
    Random random(seed);
    TriangleMesh mesh;
    for (int v = 0; v < 7; ++v) mesh.vertices.push_back({random.uniform(), random.uniform(), double(random.below(2))});
    for (int t = 0; t < 12; ++t) mesh.triangles.push_back({random.below(7), random.below(7), random.below(7)});
    repair(mesh, {.weld_distance = seed % 2 ? 0.1 : 0.0});
    for (const auto& t : mesh.triangles)
      for (const auto v : t) REQUIRE(v < mesh.vertices.size());
  }
}

TEST_CASE("a hole whose smooth patch would have millions of triangles is closed flat") {
  // A drum without its top, of a rim with very many corners.
  TriangleMesh mesh;
  constexpr std::uint32_t n = 4000;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double angle = 2 * 3.14159265358979 * i / n;
    for (const double z : {0.0, 1.0}) mesh.vertices.push_back({std::cos(angle), std::sin(angle), z});
  }
  mesh.vertices.push_back(Vec3::Zero());
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t a = 2 * i, b = 2 * ((i + 1) % n);
    mesh.triangles.insert(mesh.triangles.end(), {{a, b, a + 1}, {b, b + 1, a + 1}, {b, a, 2 * n}});
  }
  const RepairStats done = repair(mesh, {.smooth_fill = true});
  CHECK(done.filled_holes == 1);
  CHECK(done.smooth_fills == 0);
  CHECK(check_surface(mesh, SelfIntersections::ignore).first_problem == "");
}
