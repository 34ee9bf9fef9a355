// Recursive coordinate bisection at the median of the nodes, then depth-first search for the
// connected sets of each box. Their order along the component's longest side keeps the band of the
// coarse matrix narrow.
#include "mechanics/solver/aggregates.h"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

namespace geo {
namespace {

Eigen::Index longest_side(const Box3& box) {
  Eigen::Index axis;
  (box.hi - box.lo).maxCoeff(&axis);
  return axis;
}

// Boxes with equal numbers of nodes.
struct Boxes {
  const std::vector<Vec3>& position;
  std::vector<std::uint32_t> of;  // per node
  std::uint32_t count = 0;

  // Halves nodes until at most `most` are left in a box.
  void divide(std::span<std::uint32_t> nodes, std::size_t most) {
    if (nodes.size() <= most) {
      for (const auto i : nodes) of[i] = count;
      ++count;
      return;
    }
    Box3 box;
    for (const auto i : nodes) box.add(position[i]);
    const Eigen::Index axis = longest_side(box);
    const std::size_t half = nodes.size() / 2;
    std::nth_element(nodes.begin(), nodes.begin() + static_cast<std::ptrdiff_t>(half), nodes.end(),
                     [&](auto a, auto b) { return std::pair(position[a][axis], a) < std::pair(position[b][axis], b); });
    divide(nodes.first(half), most);
    divide(nodes.subspan(half), most);
  }
};

// Sort key of an aggregate, from which its number follows.
struct Placement {
  std::uint32_t component;
  double coordinate = 0;  // mean along the longest side of the component
  double nodes = 0;
};

}  // namespace

Aggregates::Aggregates(const std::vector<Vec3>& position, const NodalGradientOperator& mls,
                       const std::vector<std::uint32_t>& component_of, std::uint32_t components, const Size& size)
    : of(position.size(), ~0u) {
  const std::size_t n = position.size();
  std::vector<std::uint32_t> nodes(n);
  std::iota(nodes.begin(), nodes.end(), 0);
  std::stable_sort(nodes.begin(), nodes.end(), [&](auto a, auto b) { return component_of[a] < component_of[b]; });
  Boxes boxes{position, std::vector<std::uint32_t>(n)};
  std::vector<Eigen::Index> axis(components);
  for (std::size_t begin = 0, end; begin < n; begin = end) {
    const auto c = component_of[nodes[begin]];
    Box3 box;
    for (end = begin; end < n && component_of[nodes[end]] == c; ++end) box.add(position[nodes[end]]);
    axis[c] = longest_side(box);
    boxes.divide({&nodes[begin], end - begin}, std::max(size.least_nodes, (end - begin) / size.max_per_component));
  }
  // Connected nodes of each box, by depth-first search.
  std::vector<std::uint32_t> stack;
  std::vector<Placement> found;
  for (std::uint32_t i = 0; i < n; ++i) {
    if (of[i] != ~0u) continue;
    const auto aggregate = static_cast<std::uint32_t>(found.size());
    Placement& own = found.emplace_back(Placement{component_of[i]});
    of[i] = aggregate;
    stack = {i};
    while (!stack.empty()) {
      const auto j = stack.back();
      stack.pop_back();
      own.coordinate += position[j][axis[component_of[i]]];
      ++own.nodes;
      for (const auto k : mls[j].neighbors)
        if (of[k] == ~0u && boxes.of[k] == boxes.of[i]) {
          of[k] = aggregate;
          stack.push_back(k);
        }
    }
    own.coordinate /= own.nodes;
  }
  std::vector<std::uint32_t> order(found.size()), rank(found.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](std::uint32_t a) { return std::tuple(found[a].component, found[a].coordinate, a); };
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return key(a) < key(b); });
  for (std::uint32_t k = 0; k < order.size(); ++k) {
    rank[order[k]] = k;
    component.push_back(found[order[k]].component);
  }
  for (auto& a : of) a = rank[a];
}

}  // namespace geo
