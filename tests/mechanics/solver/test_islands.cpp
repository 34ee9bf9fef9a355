// Islands of a cut block against a search over all material points, and sums over them.
#include "mechanics/solver/islands.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <limits>
#include <map>
#include <set>

#include "base/random.h"
#include "cases.h"
#include "mechanics/bodies.h"
#include "mechanics/solver/solid_discretisation.h"

using namespace geo;

namespace {

// A block that cuts divide into slabs.
Body slabs(Random& random) {
  Body body = block_body({1, 0.3, 0.3}, 0.09);
  for (std::int32_t c = 1, cuts = static_cast<std::int32_t>(random.below(4)); c <= cuts; ++c) {
    const double x = 0.2 * c + random.uniform(-0.05, 0.05);
    const Vec3 a(x, -0.1, 0.4), b(x + random.uniform(-0.05, 0.05), 0.4, 0.4);
    FrontState front = begin_front(std::vector<Vec3>{a, b}, false, c);
    split(body, front, {a - Vec3(0, 0, 0.5), b - Vec3(0, 0, 0.5)});
  }
  return body;
}

// Sets of nodes by repeated minima over the components that share a point or are coupled.
std::vector<std::uint32_t> sets_of(const MaterialPoints& points, const std::vector<std::uint32_t>& component,
                                   std::span<const std::pair<std::uint32_t, std::uint32_t>> coupled) {
  std::vector<std::uint32_t> label(1 + *std::max_element(component.begin(), component.end()));
  for (std::uint32_t c = 0; c < label.size(); ++c) label[c] = c;
  for (bool changed = true; changed;) {
    changed = false;
    const auto join = [&](std::uint32_t a, std::uint32_t b) {
      const auto least = std::min(label[a], label[b]);
      changed |= label[a] != least || label[b] != least;
      label[a] = label[b] = least;
    };
    for (const auto& block : points.blocks)
      for (std::size_t i = 0; i < block.points.size(); ++i) {
        const auto nodes = block.shape_gradients(i).nodes;
        for (const auto node : nodes) join(component[nodes[0]], component[node]);
      }
    for (const auto& [a, b] : coupled) join(a, b);
  }
  std::vector<std::uint32_t> of_node;
  for (const auto c : component) of_node.push_back(label[c]);
  return of_node;
}

// True when both number the same sets.
bool same_sets(std::span<const std::uint32_t> a, std::span<const std::uint32_t> b) {
  std::map<std::uint32_t, std::uint32_t> to, from;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (to.try_emplace(a[i], b[i]).first->second != b[i] || from.try_emplace(b[i], a[i]).first->second != a[i])
      return false;
  return a.size() == b.size();
}

}  // namespace

TEST_CASE("islands are the sets of nodes that points and contact join, free-floating ones those of points alone",
          "[mechanics]") {
  const auto [first, count] = seeds(12);
  std::size_t several = 0, coupled_islands = 0;
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const Body body = slabs(random);
    const Solid owner(body, Material());
    const SolidDiscretisation& solid = SolidDiscretisation::of(owner);
    // Every other time components fall into parts that only points join.
    std::vector<std::uint32_t> component = solid.component;
    std::uint32_t components = solid.components;
    if (random.below(2) == 0) {
      std::map<std::uint32_t, std::uint32_t> number;
      for (auto& c : component)
        c = number.try_emplace(3 * c + random.below(3), static_cast<std::uint32_t>(number.size())).first->second;
      components = static_cast<std::uint32_t>(number.size());
    }
    std::vector<std::pair<std::uint32_t, std::uint32_t>> coupled;
    const auto node = [&] { return random.below(static_cast<std::uint32_t>(solid.size())); };
    if (random.below(2) == 0) coupled.push_back({component[node()], component[node()]});
    const Islands islands(solid.points, component, components, coupled);
    CHECK(same_sets(islands.of_nodes(), sets_of(solid.points, component, coupled)));
    CHECK(same_sets(islands.free_of_nodes(), sets_of(solid.points, component, {})));
    const auto numbers = [](std::span<const std::uint32_t> of) { return std::set(of.begin(), of.end()); };
    CHECK(islands.count() == numbers(islands.of_nodes()).size());
    CHECK(islands.free_count() == numbers(islands.free_of_nodes()).size());
    CHECK(*numbers(islands.of_nodes()).rbegin() + 1 == islands.count());
    several += islands.count() > 1;
    coupled_islands += islands.count() < islands.free_count();
    std::size_t listed = 0;
    for (std::size_t p = 0; p < islands.count(); ++p) {
      const auto nodes = islands.nodes(p);
      CHECK(std::is_sorted(nodes.begin(), nodes.end()));
      for (const auto i : nodes) CHECK(islands.of(i) == p);
      listed += nodes.size();
    }
    CHECK(listed == solid.size());
    REQUIRE(islands.block_count() == solid.points.blocks.size());
    for (std::size_t b = 0; b < islands.block_count(); ++b) {
      const PointBlock& block = solid.points.blocks[b];
      std::set<std::uint32_t> expected;
      for (const auto i : block.nodes) expected.insert(islands.of(i));
      const auto of_block = islands.of_block(b);
      CHECK(std::vector(of_block.begin(), of_block.end()) == std::vector(expected.begin(), expected.end()));
      CHECK(islands.block_first(b + 1) - islands.block_first(b) == expected.size());
      for (std::size_t i = 0; i < block.points.size(); ++i) {
        const auto nodes = block.shape_gradients(i).nodes;
        if (nodes.empty())
          CHECK(islands.slot(b, block, i) == 0);
        else
          for (const auto node : nodes) CHECK(of_block[islands.slot(b, block, i)] == islands.of(node));
      }
    }
  }
  CHECK(several > 0);
  CHECK(coupled_islands > 0);
}

TEST_CASE("sums, maxima and work run over the selected islands, and leave the entries of all others", "[mechanics]") {
  const auto [first, count] = seeds(8);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    const Body body = slabs(random);
    const Solid owner(body, Material());
    const SolidDiscretisation& solid = SolidDiscretisation::of(owner);
    const Islands islands(solid.points, solid.component, solid.components, {});
    ActiveIslands active(islands, solid.subdomains);
    CHECK_FALSE(active.none());
    std::vector<char> mask;
    for (std::size_t p = 0; p < islands.count(); ++p) mask.push_back(static_cast<char>(random.below(2)));
    active.select(mask);
    CHECK(active.mask() == mask);
    CHECK(active.none() == (std::count(mask.begin(), mask.end(), 1) == 0));
    std::vector<double> term;
    for (std::size_t i = 0; i < solid.size(); ++i) term.push_back(random.uniform(0, 1));
    std::vector<double> sum(islands.count(), -1), maximum = sum, sum2 = sum, maximum2 = sum, roots = sum;
    active.sum(sum, 0.0, [&](std::size_t i) { return term[i]; });
    active.maximum(maximum, [&](std::size_t i) { return term[i]; });
    active.sum_and_maximum(sum2, maximum2, [&](std::size_t i) { return std::pair(term[i], term[i]); });
    CHECK(sum2 == sum);
    CHECK(maximum2 == maximum);
    roots = sum;
    active.take_square_roots(roots);
    std::vector<int> visits(solid.size(), 0);
    active.each_node([&](std::size_t i) { ++visits[i]; });
    for (std::size_t p = 0; p < islands.count(); ++p) {
      double expected = mask[p] ? 0 : -1, largest = mask[p] ? 0 : -1;
      for (const auto i : islands.nodes(p)) {
        CHECK(visits[i] == mask[p]);
        if (mask[p]) {
          expected += term[i];
          largest = std::max(largest, term[i]);
        }
      }
      CHECK(active[p] == (mask[p] != 0));
      CHECK(sum[p] == Approx(expected));
      CHECK(maximum[p] == largest);
      CHECK(roots[p] == (mask[p] ? std::sqrt(sum[p]) : -1));
    }
    std::vector<std::uint32_t> blocks, subdomains;
    for (std::uint32_t b = 0; b < islands.block_count(); ++b)
      for (const auto p : islands.of_block(b))
        if (mask[p] && (blocks.empty() || blocks.back() != b)) blocks.push_back(b);
    for (std::uint32_t s = 0; s < solid.subdomains.count(); ++s)
      if (mask[islands.of(solid.subdomains.nodes(s)[0])]) subdomains.push_back(s);
    CHECK(std::vector(active.blocks().begin(), active.blocks().end()) == blocks);
    CHECK(std::vector(active.subdomains().begin(), active.subdomains().end()) == subdomains);
    // NaN exceeds every number.
    if (active.none()) continue;
    const auto some = static_cast<std::size_t>(std::find(mask.begin(), mask.end(), 1) - mask.begin());
    term[islands.nodes(some)[islands.nodes(some).size() / 2]] = std::numeric_limits<double>::quiet_NaN();
    active.maximum(maximum, [&](std::size_t i) { return term[i]; });
    CHECK(std::isnan(maximum[some]));
  }
}
