// Groups of pieces on random graphs and on random cuts; volume integrals and sections of bonds.
#include <catch2/catch.hpp>

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include <Eigen/Geometry>

#include "base/union_find.h"
#include "cases.h"
#include "invariants/random_cuts.h"
#include "kerf/check.h"
#include "kerf/error.h"
#include "kerf/hierarchy.h"
#include "kerf/mesh.h"

using namespace geo;

namespace {

struct Graph {
  std::vector<double> volume;
  std::vector<Bond> bonds;
};

// Pieces of volumes over six orders of magnitude; some have no bond.
Graph random_graph(Random& random) {
  Graph graph;
  const std::uint32_t count = 1 + random.below(60);
  for (std::uint32_t p = 0; p < count; ++p) graph.volume.push_back(std::pow(10, random.uniform(-6, 0)));
  std::sort(graph.volume.rbegin(), graph.volume.rend());
  const double density = random.uniform(0, 0.2);
  for (std::uint32_t a = 0; a < count; ++a)
    for (std::uint32_t b = a + 1; b < count; ++b)
      if (random.uniform() < density)
        graph.bonds.push_back({a, b, random.uniform(0, 1), random.direction(), random.direction(), random.uniform()});
  return graph;
}

// Whether the members of each group are connected by bonds among themselves.
bool connected(const std::vector<std::uint32_t>& group, const std::vector<Bond>& bonds) {
  UnionFind joined(group.size());
  for (const Bond& bond : bonds)
    if (group[bond.a] == group[bond.b]) joined.unite(bond.a, bond.b);
  std::map<std::uint32_t, std::uint32_t> root;
  for (std::uint32_t p = 0; p < group.size(); ++p)
    if (root.try_emplace(group[p], joined.find(p)).first->second != joined.find(p)) return false;
  return true;
}

std::size_t components(const Graph& graph) {
  UnionFind joined(graph.volume.size());
  for (const Bond& bond : graph.bonds) joined.unite(bond.a, bond.b);
  std::set<std::uint32_t> roots;
  for (std::uint32_t p = 0; p < graph.volume.size(); ++p) roots.insert(joined.find(p));
  return roots.size();
}

Bond bond(std::uint32_t a, std::uint32_t b, double area) { return {a, b, area, Vec3::UnitX(), Vec3::Zero(), 0}; }

Complex cut_ball(Random& random, const TriangleMesh& model) {
  Complex complex = Complex::from_skin(model);
  for (std::int32_t crack = 1; crack <= 6; ++crack) {
    const auto cut = random_cuts::make_cut(complex.extent(), random);
    auto front = begin_front(cut.at(0), false, crack);
    advance(complex, front, cut.at(1));
  }
  return complex;
}

}  // namespace

TEST_CASE("Small pieces join until none with a bond is left", "[hierarchy]") {
  const auto [first, count] = seeds(300);
  for (int c = 0; c < count; ++c) {
    const auto seed = first + static_cast<std::uint64_t>(c);
    INFO("seed " << seed);
    Random random(seed);
    const Graph graph = random_graph(random);
    const double least = std::pow(10, random.uniform(-6, 0));
    const auto group = join_small_pieces(graph.volume, graph.bonds, least);
    REQUIRE(group.size() == graph.volume.size());
    CHECK(connected(group, graph.bonds));
    std::vector<double> volume(group.size(), 0);
    for (std::uint32_t p = 0; p < group.size(); ++p) {
      CHECK(group[p] <= p);
      CHECK(group[group[p]] == group[p]);
      volume[group[p]] += graph.volume[p];
    }
    std::set<std::uint32_t> bonded;
    for (const Bond& bond : graph.bonds)
      if (group[bond.a] != group[bond.b]) {
        bonded.insert(group[bond.a]);
        bonded.insert(group[bond.b]);
      }
    for (const auto g : bonded) CHECK(volume[g] >= least);
    // Only small groups join: a group of several has at most one member that is not small.
    for (std::uint32_t p = 0; p < group.size(); ++p)
      if (group[p] != p) CHECK(std::min(graph.volume[p], graph.volume[group[p]]) < least);
  }
}

TEST_CASE("A small piece joins the neighbour with the greatest area", "[hierarchy]") {
  const std::vector<double> volume{5, 4, 0.1};
  const std::vector<Bond> bonds{bond(0, 1, 9), bond(0, 2, 0.2), bond(1, 2, 0.3)};
  CHECK(join_small_pieces(volume, bonds, 1) == std::vector<std::uint32_t>{0, 1, 1});
  CHECK(join_small_pieces(volume, bonds, 0) == std::vector<std::uint32_t>{0, 1, 2});
  CHECK(join_small_pieces(volume, bonds, 4.5) == std::vector<std::uint32_t>{0, 0, 0});
  CHECK(join_small_pieces(volume, {}, 1) == std::vector<std::uint32_t>{0, 1, 2});
  CHECK_THROWS_AS(join_small_pieces(std::vector<double>{1, 1}, bonds, 1), InputError);
  CHECK_THROWS_AS(make_hierarchy(volume, bonds, 0), InputError);
}

TEST_CASE("Each piece is in one cluster at each level, and clusters hold together", "[hierarchy]") {
  const auto [first, count] = seeds(300);
  for (int c = 0; c < count; ++c) {
    const auto seed = first + static_cast<std::uint64_t>(c);
    INFO("seed " << seed);
    Random random(seed);
    const Graph graph = random_graph(random);
    const std::size_t levels = 1 + random.below(5);
    const auto hierarchy = make_hierarchy(graph.volume, graph.bonds, levels);
    REQUIRE(hierarchy.size() == levels - 1);
    std::vector<std::uint32_t> cluster(graph.volume.size());
    std::iota(cluster.begin(), cluster.end(), 0u);
    std::size_t below = cluster.size();
    for (const ClusterLevel& level : hierarchy) {
      REQUIRE(level.of.size() == below);
      REQUIRE(level.volume.size() <= below);
      below = level.volume.size();
      for (auto& of_piece : cluster) of_piece = level.of[of_piece];
      CHECK(connected(cluster, graph.bonds));
      CHECK(std::is_sorted(level.volume.rbegin(), level.volume.rend()));
      std::vector<double> volume(below, 0);
      for (std::size_t p = 0; p < cluster.size(); ++p) {
        REQUIRE(cluster[p] < below);
        volume[cluster[p]] += graph.volume[p];
      }
      std::map<std::pair<std::uint32_t, std::uint32_t>, double> shared;
      for (const Bond& bond : graph.bonds)
        if (cluster[bond.a] != cluster[bond.b]) shared[std::minmax(cluster[bond.a], cluster[bond.b])] += bond.area;
      for (std::size_t i = 0; i < below; ++i) CHECK(level.volume[i] == Approx(volume[i]).epsilon(1e-12));
      REQUIRE(level.bonds.size() == shared.size());
      for (const Bond& bond : level.bonds) {
        CHECK(bond.a < bond.b);
        CHECK(bond.area == Approx(shared.at({bond.a, bond.b})).epsilon(1e-12));
      }
    }
    if (!hierarchy.empty()) {
      CHECK(hierarchy.back().volume.size() == components(graph));
      CHECK(hierarchy.back().bonds.empty());
    }
  }
}

TEST_CASE("Healed pieces are closed, and the volume stays", "[hierarchy]") {
  const auto [first, count] = seeds(12);
  int joined = 0;
  for (int c = 0; c < count; ++c) {
    const auto seed = first + static_cast<std::uint64_t>(c);
    INFO("seed " << seed);
    Random random(seed);
    const TriangleMesh model = make_sphere(6);
    Complex complex = cut_ball(random, model);
    const Pieces before = find_pieces(complex);
    const double whole = signed_volume(model), least = random.uniform(0.02, 0.3) * whole;
    const auto bonds = find_bonds(complex, before);
    const auto group = join_small_pieces(before.volume, bonds, least);
    const std::set<std::uint32_t> groups(group.begin(), group.end());
    heal(complex, before, group);
    const Pieces pieces = find_pieces(complex);
    joined += int(before.count - pieces.count);
    REQUIRE(pieces.count == groups.size());
    std::vector<double> expected(before.count, 0);
    for (std::uint32_t p = 0; p < before.count; ++p) expected[group[p]] += before.volume[p];
    std::sort(expected.rbegin(), expected.rend());
    double sum = 0;
    for (std::uint32_t p = 0; p < pieces.count; ++p) {
      CHECK(pieces.volume[p] == Approx(expected[p]).epsilon(1e-9));
      CHECK((pieces.volume[p] >= least || pieces.count == 1));  // a ball is in one part: all pieces have bonds
      const TriangleMesh mesh = piece_mesh(complex, pieces, p);
      std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
      for (const auto& t : mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k) {
          ++edges[{t[k], t[(k + 1) % 3]}];
          --edges[{t[(k + 1) % 3], t[k]}];
        }
      CHECK(std::all_of(edges.begin(), edges.end(), [](const auto& edge) { return edge.second == 0; }));
      sum += pieces.volume[p];
    }
    CHECK(sum == Approx(whole).epsilon(1e-12));
    // The healed complex is read back as it was written.
    CHECK(find_pieces(Complex::from_two_sided(complex.two_sided())).volume.size() == pieces.count);
    // No bond appears, and no area is lost but inside groups.
    double left = 0, outside = 0;
    for (const Bond& bond : find_bonds(complex, pieces)) left += bond.area;
    for (const Bond& bond : bonds) outside += group[bond.a] != group[bond.b] ? bond.area : 0;
    CHECK(left == Approx(outside).epsilon(1e-9));
    CHECK_THROWS_AS(heal(complex, pieces, std::vector<std::uint32_t>(pieces.count + 1)), InputError);
  }
  CHECK(joined > 0);
}

TEST_CASE("Inertia of a turned block is that of the formula, and of pieces adds up", "[hierarchy]") {
  TriangleMesh block = make_block({1, 2, 3}, 5);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  for (Vec3& p : block.vertices) p = turn * p + Vec3(10, -20, 30);
  const MassProperties whole = mass_properties(block);
  CHECK(whole.volume == Approx(6));
  CHECK((whole.centroid - turn * Vec3(0.5, 1, 1.5) - Vec3(10, -20, 30)).norm() < 1e-12);
  const Eigen::Matrix3d expected = turn * Vec3(6.5, 5, 2.5).asDiagonal() * turn.transpose();
  CHECK((whole.inertia - expected).norm() < 1e-9);

  const auto [first, count] = seeds(5);
  for (int c = 0; c < count; ++c) {
    const auto seed = first + static_cast<std::uint64_t>(c);
    INFO("seed " << seed);
    Random random(seed);
    const TriangleMesh ball = make_sphere(6);
    const Complex complex = cut_ball(random, ball);
    const MassProperties all = mass_properties(ball);
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (const Chunk& chunk : make_chunks(complex, find_pieces(complex), {}, 1)) {
      const MassProperties m = mass_properties(chunk.mesh);
      const Vec3 d = m.centroid - all.centroid;
      sum += m.inertia + m.volume * (d.squaredNorm() * Eigen::Matrix3d::Identity() - d * d.transpose());
    }
    CHECK((sum - all.inertia).norm() < 1e-10);
  }
}

TEST_CASE("A bond's section is that of a rectangular beam", "[hierarchy]") {
  const TriangleMesh block = make_block({2, 0.3, 1}, 0.5);
  Complex complex = Complex::from_skin(block);
  auto front = begin_front(std::vector<Vec3>{{0.7, -1, -1}, {0.7, -1, 2}}, false, 1);
  advance(complex, front, std::vector<Vec3>{{0.7, 2, -1}, {0.7, 2, 2}});
  const auto bonds = find_bonds(complex, find_pieces(complex));
  REQUIRE(bonds.size() == 1);
  CHECK(bonds[0].area == Approx(0.3));
  // The worst moment stresses one corner: 6 / (b h) √(1 / b² + 1 / h²) for each unit of it.
  CHECK(1 / bonds[0].section == Approx(6 / 0.3 * std::hypot(1.0, 1 / 0.3)));
}
