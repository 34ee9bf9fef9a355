#include "mechanics/solver/node_groups.h"

#include <algorithm>
#include <numeric>

namespace geo {
namespace {

Eigen::Index longest_side(const Box3& box) {
  Eigen::Index axis;
  (box.hi - box.lo).maxCoeff(&axis);
  return axis;
}

// Numbers the boxes of about `most` nodes that a range of nodes is halved into.
struct Boxes {
  const std::vector<Vec3>& position;
  std::vector<std::uint32_t> of;
  std::uint32_t count = 0;

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
    divide(nodes.first(half), most), divide(nodes.subspan(half), most);
  }
};

}  // namespace

NodeGroups::NodeGroups(const std::vector<Vec3>& position, const NodalGradientOperator& rows,
                       const std::vector<std::uint32_t>& part_of, std::uint32_t parts, std::size_t fewest,
                       std::size_t most_groups)
    : of(position.size(), ~0u) {
  const std::size_t n = position.size();
  std::vector<std::uint32_t> nodes(n);
  std::iota(nodes.begin(), nodes.end(), 0);
  std::stable_sort(nodes.begin(), nodes.end(), [&](auto a, auto b) { return part_of[a] < part_of[b]; });
  Boxes boxes{position, std::vector<std::uint32_t>(n)};
  std::vector<Eigen::Index> along(parts);
  for (std::size_t begin = 0, end; begin < n; begin = end) {
    Box3 box;
    for (end = begin; end < n && part_of[nodes[end]] == part_of[nodes[begin]]; ++end) box.add(position[nodes[end]]);
    along[part_of[nodes[begin]]] = longest_side(box);
    boxes.divide({&nodes[begin], end - begin}, std::max(fewest, (end - begin) / most_groups));
  }
  // What hangs together in a box.
  std::vector<std::uint32_t> front;
  std::vector<std::pair<std::uint32_t, double>> place;  // part, and the sum of coordinates along it
  std::vector<double> size;
  for (std::uint32_t i = 0; i < n; ++i) {
    if (of[i] != ~0u) continue;
    const auto group = static_cast<std::uint32_t>(place.size());
    place.push_back({part_of[i], 0.0}), size.push_back(0);
    of[i] = group, front = {i};
    while (!front.empty()) {
      const auto j = front.back();
      front.pop_back();
      place[group].second += position[j][along[part_of[i]]], ++size[group];
      for (const auto k : rows[j].neighbors)
        if (of[k] == ~0u && boxes.of[k] == boxes.of[i]) of[k] = group, front.push_back(k);
    }
  }
  std::vector<std::uint32_t> order(place.size()), rank(place.size());
  for (std::size_t g = 0; g < place.size(); ++g) place[g].second /= size[g];
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](auto a, auto b) { return std::pair(place[a], a) < std::pair(place[b], b); });
  for (std::uint32_t k = 0; k < order.size(); ++k) rank[order[k]] = k, part.push_back(place[order[k]].first);
  for (auto& g : of) g = rank[g];
}

}  // namespace geo
