#include <catch2/catch.hpp>
#include <numeric>

#include "geometry/bvh.h"
#include "kerf/error.h"
#include "kerf/nodes.h"
#include "kerf/parallel.h"
#include "solids.h"

using namespace geo;

namespace {

void require_sound(const TriangleMesh& mesh, const NodeSet& nodes) {
  const TriangleBvh tree(corners_of(mesh));
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    REQUIRE(tree.inside(nodes.position[i]));
    REQUIRE(nodes.volume[i] > 0);
    REQUIRE(nodes.radius[i] >= nodes.spacing[i]);
  }
  REQUIRE(nodes.radius.size() == nodes.size());
  CHECK(std::accumulate(nodes.volume.begin(), nodes.volume.end(), 0.0) == Approx(signed_volume(mesh)).epsilon(1e-10));
}

bool same(const NodeSet& a, const NodeSet& b) {
  return a.position == b.position && a.radius == b.radius && a.spacing == b.spacing && a.volume == b.volume;
}

/// The distance from each node to the nearest other, over the smaller of their spacings: the least
/// and the mean.
std::pair<double, double> nearest_other(const NodeSet& nodes) {
  double least = 1e300, sum = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    double best = 1e300;
    for (std::size_t j = 0; j < nodes.size(); ++j)
      if (j != i)
        best = std::min(best,
                        (nodes.position[i] - nodes.position[j]).norm() / std::min(nodes.spacing[i], nodes.spacing[j]));
    least = std::min(least, best);
    sum += best;
  }
  return {least, sum / double(nodes.size())};
}

}  // namespace

TEST_CASE("nodes are inside and own the whole volume, in as many as asked for") {
  for (const auto& [name, mesh] : solids::all())
    for (const std::size_t count : {150u, 1500u, 15000u})
      for (const int levels : {1, 2, 5}) {
        INFO(name << ", " << count << " nodes, levels " << levels);
        SampleOptions options;
        options.count = count;
        options.levels = levels;
        options.across = levels == 2 ? 3 : 0;
        const NodeSet nodes = sample_nodes(mesh, options);
        CHECK(std::abs(double(nodes.size()) - double(count)) <= 0.02 * double(count));
        require_sound(mesh, nodes);
      }
}

TEST_CASE("the same nodes for any number of threads, others for another seed") {
  for (const NodePattern pattern : {NodePattern::jitter, NodePattern::blue, NodePattern::grid}) {
    SampleOptions options;
    options.count = 3000;
    options.levels = 3;
    options.across = 3;
    options.pattern = pattern;
    const auto mesh = make_polyp(8);
    set_threads(1);
    const NodeSet one = sample_nodes(mesh, options);
    for (const int threads : {2, 4}) {
      set_threads(threads);
      CHECK(same(one, sample_nodes(mesh, options)));
    }
    set_threads(0);
    options.seed = 2;
    CHECK(same(one, sample_nodes(mesh, options)) == (pattern == NodePattern::grid));
  }
}

TEST_CASE("a plate of 1:200 has three nodes across, whichever way it lies") {
  const TriangleMesh flat = make_block({1, 0.1, 0.005}, 0.1);
  for (const bool skew : {false, true}) {
    const TriangleMesh plate = skew ? solids::turned(flat) : flat;
    SampleOptions options;
    options.spacing = 0.05;
    options.across = 3;
    SampleReport report;
    const NodeSet nodes = sample_nodes(plate, options, {}, &report);
    CHECK(report.thinnest == Approx(0.005).epsilon(1e-6));
    CHECK(report.unresolved == 0);
    // Columns through the plate: the number of nodes over its area in cells.
    const double spacing = *std::min_element(nodes.spacing.begin(), nodes.spacing.end());
    CHECK(spacing <= 0.005 / 3);
    CHECK(double(nodes.size()) > 2.8 * 0.1 / (spacing * spacing));
    options.across = 0;
    CHECK(sample_nodes(plate, options).size() > 10);  // one across, never none
    CHECK(sample_nodes(plate, options).size() < 80);
  }
}

TEST_CASE("a thin curved shell is sampled across, and what is too thin is told") {
  const TriangleMesh shell = solids::shell(0.08);
  SampleOptions options;
  options.spacing = 0.2;
  options.across = 3;
  SampleReport report;
  const NodeSet nodes = sample_nodes(shell, options, {}, &report);
  require_sound(shell, nodes);
  CHECK(report.thinnest > 0.06);
  CHECK(report.thinnest < 0.082);
  CHECK(report.unresolved == 0);
  // Three layers: about as many nodes in each third of the wall.
  std::array<std::size_t, 3> third{};
  for (const Vec3& p : nodes.position)
    ++third[static_cast<std::size_t>(std::clamp(int((p.norm() - 0.92) / 0.08 * 3), 0, 2))];
  for (const auto n : third) CHECK(double(n) > 0.2 * double(nodes.size()));
  options.spacing = 0.5;
  const TriangleMesh skin = solids::shell(0.004);
  sample_nodes(skin, options, {}, &report);
  CHECK(report.unresolved > 0.0019);
  CHECK(report.unresolved < 0.0045);
  CHECK(std::abs(report.unresolved_at.norm() - 0.997) < 0.01);
}

TEST_CASE("thick material with sharp edges is not made finer") {
  for (const char* name : {"pumpkin", "block", "turned block"})
    for (const auto& [other, mesh] : solids::all())
      if (other == name) {
        CAPTURE(name);
        SampleOptions options;
        options.spacing = 0.03 * bounding_box(mesh).diagonal();
        const std::size_t plain = sample_nodes(mesh, options).size();
        options.across = 3;
        CHECK(double(sample_nodes(mesh, options).size()) == Approx(double(plain)).epsilon(0.03));
      }
}

TEST_CASE("a slit much narrower than a cell has no nodes in it and some on either side") {
  const double width = 1e-7, at = 0.4137;
  const auto slit = solids::moved(make_block({0.9, 0.9, width}, 0.9), {0.05, 0.05, at});
  const TriangleMesh mesh = solids::hollow(make_block({1, 1, 1}, 1), slit);
  SampleOptions options;
  options.spacing = 0.08;
  const NodeSet nodes = sample_nodes(mesh, options);
  require_sound(mesh, nodes);
  std::size_t below = 0, above = 0;
  for (const Vec3& p : nodes.position) {
    const bool beside = p.x() > 0.1 && p.x() < 0.9 && p.y() > 0.1 && p.y() < 0.9;
    REQUIRE_FALSE((beside && p.z() >= at && p.z() <= at + width));
    if (beside && std::abs(p.z() - at) < 0.1) ++(p.z() < at ? below : above);
  }
  CHECK(below > 50);
  CHECK(above > 50);
}

TEST_CASE("support radii change gradually and hold a dozen nodes") {
  const TriangleMesh mesh = make_block({1, 1, 1}, 0.5);
  SampleOptions options;
  options.spacing = 0.035;
  options.levels = 5;
  const NodeSet nodes = sample_nodes(mesh, options);
  double worst = 1;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    std::size_t within = 0;
    double nearest = 1e300, ratio = 1;
    for (std::size_t j = 0; j < nodes.size(); ++j) {
      const double d = (nodes.position[i] - nodes.position[j]).norm();
      within += j != i && d <= nodes.radius[i];
      if (j != i && d < nearest) {
        nearest = d;
        ratio = std::max(nodes.radius[i] / nodes.radius[j], nodes.radius[j] / nodes.radius[i]);
      }
    }
    worst = std::max(worst, ratio);
    REQUIRE(within >= 12);
  }
  CAPTURE(worst);
  CHECK(worst < 1.8);  // spacings differ by 2
}

TEST_CASE("blue noise keeps nodes apart") {
  const TriangleMesh mesh = make_pumpkin(8);
  SampleOptions options;
  options.count = 2500;
  options.pattern = NodePattern::blue;
  const NodeSet nodes = sample_nodes(mesh, options);
  require_sound(mesh, nodes);
  const auto [least, mean] = nearest_other(nodes);
  options.pattern = NodePattern::jitter;
  options.jitter = 0.38;
  const auto [random_least, random_mean] = nearest_other(sample_nodes(mesh, options));
  CAPTURE(least, mean, random_least, random_mean);
  CHECK(least > 0.3);
  CHECK(least > random_least);
  CHECK(mean > 1.1 * random_mean);
}

TEST_CASE("hostile sampling options are refused") {
  const TriangleMesh mesh = make_block({1, 1, 1}, 1);
  const auto refuses = [&](SampleOptions options, const char* word) {
    CHECK_THROWS_WITH(sample_nodes(mesh, options), Catch::Contains(word));
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  refuses({.spacing = 1e-9}, "0.01 %");
  refuses({.spacing = nan}, "positive");
  refuses({.spacing = -1}, "positive");
  refuses({.levels = 0}, "levels");
  refuses({.levels = 11}, "levels");
  refuses({.jitter = nan}, "jitter");
  refuses({.jitter = 0.6}, "jitter");
  refuses({.support = 0}, "support");
  refuses({.across = -1}, "across");
  refuses({.across = 101}, "across");
}
