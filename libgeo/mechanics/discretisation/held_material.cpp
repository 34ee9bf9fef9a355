// Legend: φ_j shape function of node j, d distance to the box, R support radius at the point,
// w = 1 − (1 − t)² with t = d / (0.55 R) < 1, else 1.
#include "mechanics/discretisation/held_material.h"

#include <Eigen/LU>
#include <algorithm>
#include <iterator>
#include <map>
#include <numeric>
#include <optional>

#include "kerf/parallel.h"
#include "mechanics/discretisation/point_supports.h"

namespace geo {
namespace {

constexpr std::uint32_t no_index = ~0u;
// In support radii: about a node spacing. Narrower or wider, cantilevers bend less accurately
// (docs/decisions/060).
constexpr double width = 0.55;
// Least distance of the fourth anchor from the plane of the others, in support radii: coordinates
// near the box stay below about twenty.
constexpr double least_height = 0.05;

bool holds(const HeldBox& box, const Vec3& x) {
  return (x.array() >= box.lo.array()).all() && (x.array() <= box.hi.array()).all();
}

Vec3 nearest_in(const HeldBox& box, const Vec3& x) { return x.cwiseMax(box.lo).cwiseMin(box.hi); }

// The candidate for which value() is greatest, the first of several.
template <class Value>
std::uint32_t farthest(std::span<const std::uint32_t> nodes, const Value& value) {
  return *std::max_element(nodes.begin(), nodes.end(), [&](auto a, auto b) { return value(a) < value(b); });
}

// Four nodes that span a wide tetrahedron; none where they are nearly coplanar.
std::optional<std::array<std::uint32_t, 4>> wide_tetrahedron(const NodeSet& nodes, std::span<const std::uint32_t> of) {
  if (of.size() < 4) return {};
  const auto& x = nodes.position;
  Vec3 centre = Vec3::Zero();
  for (const auto i : of) centre += x[i] / double(of.size());
  const auto a = farthest(of, [&](auto i) { return squared_distance(x[i], centre); });
  const auto b = farthest(of, [&](auto i) { return squared_distance(x[i], x[a]); });
  const Vec3 along = x[b] - x[a];
  const auto c = farthest(of, [&](auto i) { return along.cross(x[i] - x[a]).squaredNorm(); });
  const Vec3 normal = along.cross(x[c] - x[a]);
  const auto d = farthest(of, [&](auto i) { return std::abs(normal.dot(x[i] - x[a])); });
  const double height = std::abs(normal.dot(x[d] - x[a])) / normal.norm();
  const double breadth = normal.norm() / along.norm(), least = least_height * nodes.radius[a];
  if (!(breadth > least) || !(height > least)) return {};
  return std::array{a, b, c, d};
}

}  // namespace

// The shape gradients of one point near a box.
struct HeldMaterial::Shapes {
  const Body& body;
  const std::vector<std::uint32_t>& box_of_node;
  const std::vector<HeldBox>& boxes;
  std::span<const Anchors> anchors;
  const std::vector<std::uint32_t>& component;

  // The box that rules the point: the nearest of those of which it sees a node, the first of
  // several. A point without a component in common with the node is not held by it.
  const Anchors* box_near(const Vec3& x, const ShapeGradients& plain) const {
    const Anchors* nearest = nullptr;
    double least = 0;
    for (const auto j : plain.nodes) {
      if (box_of_node[j] == no_index || component[j] != component[plain.nodes[0]]) continue;
      for (const Anchors& a : anchors) {
        if (a.box != box_of_node[j] || a.component != component[j]) continue;
        const double distance = squared_distance(x, nearest_in(boxes[a.box], x));
        if (!nearest || distance < least || (distance == least && a.box < nearest->box)) {
          nearest = &a;
          least = distance;
        }
      }
    }
    return nearest;
  }

  // None where the plain basis stays.
  std::optional<ShapeGradients> at(const Vec3& x, const ShapeGradients& plain) const {
    if (plain.nodes.empty()) return {};
    const Anchors* const anchor = box_near(x, plain);
    if (!anchor) return {};
    double radius = 0;
    Vec3 radius_gradient = Vec3::Zero();
    for (std::size_t j = 0; j < plain.nodes.size(); ++j) {
      const double r = body.nodes.radius[plain.nodes[j]];
      radius += plain.value[j] * r;
      radius_gradient += r * plain.gradient[j];
    }
    const Vec3 offset = x - nearest_in(boxes[anchor->box], x);
    const double distance = offset.norm(), t = distance / (width * radius);
    if (!(t < 1)) return {};
    const double w = t * (2 - t);
    const Vec3 dw = distance > 0
                        ? Vec3(2 * (1 - t) / (width * radius) * (offset / distance - t * width * radius_gradient))
                        : Vec3(Vec3::Zero());
    return corrected(*anchor, plain, w, dw);
  }

  // ∇u = Σ_a ∇λ_a u_a + Σ_j (w ∇φ_j + φ_j ∇w) (u_j − Σ_a λ_a(x_j) u_a), j over nodes outside.
  ShapeGradients corrected(const Anchors& anchor, const ShapeGradients& plain, double w, const Vec3& dw) const {
    Eigen::Matrix<double, 4, 3> of_anchors = anchor.coordinates.rightCols<3>();
    std::vector<std::pair<std::uint32_t, Vec3>> entries;
    for (std::size_t j = 0; j < plain.nodes.size() && w > 0; ++j) {
      const auto node = plain.nodes[j];
      if (box_of_node[node] == anchor.box) continue;
      const Vec3 g = w * plain.gradient[j] + plain.value[j] * dw;
      const Vec3& x = body.nodes.position[node];
      of_anchors -= anchor.coordinates * Eigen::Vector4d(1, x[0], x[1], x[2]) * g.transpose();
      entries.push_back({node, g});
    }
    for (Eigen::Index a = 0; a < 4; ++a)
      entries.push_back({anchor.node[static_cast<std::size_t>(a)], of_anchors.row(a).transpose()});
    std::sort(entries.begin(), entries.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    ShapeGradients shape;
    Vec3 sum = Vec3::Zero();
    for (const auto& [node, g] : entries) {
      shape.nodes.push_back(node);
      shape.gradient.push_back(g);
      sum += g;
    }
    // Constants are reproduced exactly: an anchor takes the rounding error of the sum.
    const auto first = std::lower_bound(shape.nodes.begin(), shape.nodes.end(), anchor.node[0]) - shape.nodes.begin();
    shape.gradient[static_cast<std::size_t>(first)] -= sum;
    return shape;
  }
};

double HeldMaterial::reach_of(const NodeSet& nodes) {
  return width * support_factors.back() * *std::max_element(nodes.radius.begin(), nodes.radius.end());
}

bool HeldMaterial::is_near(const Vec3& x, double reach) const {
  return std::any_of(boxes_.begin(), boxes_.end(),
                     [&](const HeldBox& box) { return (x - nearest_in(box, x)).norm() < reach; });
}

std::uint32_t HeldMaterial::box_holding(const Vec3& x) const {
  const auto box = std::find_if(boxes_.begin(), boxes_.end(), [&](const HeldBox& b) { return holds(b, x); });
  return box == boxes_.end() ? no_index : static_cast<std::uint32_t>(box - boxes_.begin());
}

std::optional<std::uint32_t> HeldMaterial::rigid_box_at(const Vec3& x) const {
  const std::uint32_t box = box_holding(x);
  if (box == no_index || !boxes_[box].rigid) return {};
  return box;
}

std::vector<std::uint32_t> HeldMaterial::nodes_in(std::uint32_t box, const std::vector<Vec3>& position) const {
  std::vector<std::uint32_t> nodes;
  for (std::uint32_t i = 0; i < position.size(); ++i)
    if (box_holding(position[i]) == box) nodes.push_back(i);
  return nodes;
}

bool HeldMaterial::set_boxes(std::span<const HeldBox> boxes) {
  if (std::equal(boxes.begin(), boxes.end(), boxes_.begin(), boxes_.end())) return false;
  boxes_.assign(boxes.begin(), boxes.end());
  anchors_.clear();
  return true;
}

void HeldMaterial::restore(MaterialPoints& points) {
  for (Replaced& r : replaced_) {
    r.held = std::move(points.blocks[r.block]);
    points.blocks[r.block] = std::move(r.plain);
    r.plain = {};
  }
}

std::vector<HeldMaterial::Anchors> HeldMaterial::anchors_of(const Body& body,
                                                            const std::vector<std::uint32_t>& component) const {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::uint32_t>> held;
  for (std::uint32_t i = 0; i < box_of_node_.size(); ++i)
    if (const auto box = box_of_node_[i]; box != no_index && boxes_[box].rigid) held[{box, component[i]}].push_back(i);
  std::vector<Anchors> all;
  for (const auto& [key, nodes] : held)
    if (const auto four = wide_tetrahedron(body.nodes, nodes)) {
      Eigen::Matrix4d corners;
      for (Eigen::Index a = 0; a < 4; ++a)
        corners.col(a) << 1, body.nodes.position[(*four)[static_cast<std::size_t>(a)]];
      all.push_back({.box = key.first, .component = key.second, .node = *four, .coordinates = corners.inverse()});
    }
  return all;
}

// Former replacements of points, before these changed. A point that is not stale keeps its shape
// gradients where anchors and components are the same: all else that decides them would make it
// stale.
class HeldMaterial::Former {
 public:
  // `component_before`: per node that there was, its component. `points`: as they are now.
  Former(std::vector<Replaced>& replaced, const PointChanges& changes, std::span<const std::uint32_t> component_before,
         const std::vector<std::uint32_t>& component, const MaterialPoints& points)
      : replaced_(replaced),
        changes_(changes),
        component_before_(component_before),
        component_(component),
        same_block_(points.blocks.size(), nullptr) {
    for (Replaced& r : replaced)
      if (const auto b = changes.new_block[r.block]; b != no_index) same_block_[b] = &r;
  }
  // The replacement of a block that is the same now; `first`: its first point. Null: none, or it
  // has changed.
  Replaced* same(std::uint32_t number, std::size_t first, const PointBlock& block) const {
    const auto stale = changes_.is_stale.begin() + static_cast<std::ptrdiff_t>(first);
    const bool changed = std::any_of(stale, stale + static_cast<std::ptrdiff_t>(block.points.size()),
                                     [](char is_stale) { return is_stale != 0; });
    return changed || !has_same_components(block) ? nullptr : same_block_[number];
  }
  // Sets sources and stale points of a block that has changed.
  void find(std::size_t first, const PointBlock& block, Near& near) const {
    const bool is_known = has_same_components(block);
    for (std::uint32_t i = 0; i < block.points.size(); ++i) {
      const std::size_t point = first + i, old = changes_.old_point.empty() ? point : changes_.old_point[point];
      if (!is_known || changes_.is_stale[point])
        near.stale.push_back(i);
      else if (const Replaced* r = replaced_at(old)) {
        near.sources[i] = {&r->held, old - r->first_point, nullptr};
        near.has_former = true;
      }
    }
  }

 private:
  bool has_same_components(const PointBlock& block) const {
    return std::all_of(block.nodes.begin(), block.nodes.end(),
                       [&](auto j) { return j >= component_before_.size() || component_before_[j] == component_[j]; });
  }
  const Replaced* replaced_at(std::size_t old_point) const {
    const auto next = std::upper_bound(replaced_.begin(), replaced_.end(), old_point,
                                       [](auto point, const Replaced& r) { return point < r.first_point; });
    if (next == replaced_.begin()) return nullptr;
    return old_point < next[-1].first_point + next[-1].held.points.size() ? &next[-1] : nullptr;
  }

  std::span<Replaced> replaced_;  // ascending
  const PointChanges& changes_;
  std::span<const std::uint32_t> component_before_;
  const std::vector<std::uint32_t>& component_;
  std::vector<Replaced*> same_block_;  // per block now
};

bool HeldMaterial::apply(const Body& body, const std::vector<std::uint32_t>& component, PointChanges* changes,
                         MaterialPoints& points) {
  std::vector<Replaced> replaced_before = std::move(replaced_);
  const std::vector<std::uint32_t> component_before = std::exchange(component_, component);
  replaced_.clear();
  if (boxes_.empty()) return false;
  box_of_node_.resize(body.nodes.size());
  for (std::size_t i = 0; i < box_of_node_.size(); ++i) box_of_node_[i] = box_holding(body.nodes.position[i]);
  std::vector<Anchors> anchors = anchors_of(body, component);
  const bool same_anchors = anchors == anchors_;
  anchors_ = std::move(anchors);
  if (anchors_.empty()) return false;
  std::optional<Former> former;
  if (changes && same_anchors) former.emplace(replaced_before, *changes, component_before, component, points);
  const double reach = reach_of(body.nodes);
  std::vector<Near> near;
  std::size_t first = 0, next = 0;
  for (std::uint32_t b = 0; b < points.blocks.size(); ++b, first = next) {
    PointBlock& block = points.blocks[b];
    next = first + block.points.size();
    if (std::none_of(anchors_.begin(), anchors_.end(), [&](const Anchors& a) {
          return block.box.grown(reach).meets({boxes_[a.box].lo, boxes_[a.box].hi});
        }))
      continue;
    if (Replaced* r = former ? former->same(b, first, block) : nullptr) {
      for (std::size_t i = 0; i < block.points.size(); ++i) {
        r->held.points[i].volume = block.points[i].volume;
        r->held.points[i].unscaled_volume = block.points[i].unscaled_volume;
      }
      replaced_.push_back(
          {.block = b, .plain = std::exchange(block, std::move(r->held)), .held = {}, .first_point = first});
      continue;
    }
    Near& n = near.emplace_back();
    n.block = b;
    n.first_point = first;
    for (std::size_t i = 0; i < block.points.size(); ++i) n.sources.push_back({&block, i, nullptr});
    if (former)
      former->find(first, block, n);
    else {
      n.stale.resize(block.points.size());
      std::iota(n.stale.begin(), n.stale.end(), 0);
    }
  }
  replace(body, component, near, changes, points);
  std::sort(replaced_.begin(), replaced_.end(), [](const auto& a, const auto& b) { return a.block < b.block; });
  return !replaced_.empty();
}

// A stale point that may be near enough to a box, and its shape gradients.
struct HeldMaterial::Candidate {
  std::uint32_t block, point;
  MaterialPoint copy;
  ShapeGradients plain;  // empty until it is computed
  std::optional<ShapeGradients> held;
};

std::vector<HeldMaterial::Candidate> HeldMaterial::candidates_in(const Near& near, double reach,
                                                                 const MaterialPoints& points,
                                                                 PointChanges* changes) const {
  std::vector<Candidate> candidates;
  // Both lists are ascending.
  std::span<std::pair<std::uint32_t, ShapeGradients>> valued;
  if (changes) valued = changes->valued;
  const auto is_before = [](const auto& entry, std::size_t point) { return entry.first < point; };
  auto known = std::lower_bound(valued.begin(), valued.end(), near.first_point, is_before);
  for (const auto i : near.stale) {
    const MaterialPoint& p = points.blocks[near.block].points[i];
    if (p.quality != MomentQuality::singular && std::any_of(anchors_.begin(), anchors_.end(), [&](const Anchors& a) {
          return (p.position - nearest_in(boxes_[a.box], p.position)).norm() < reach;
        })) {
      Candidate& c =
          candidates.emplace_back(Candidate{.block = near.block, .point = i, .copy = p, .plain = {}, .held = {}});
      c.copy.influence_radius = 0;
      const std::size_t point = near.first_point + i;
      while (known != valued.end() && is_before(*known, point)) ++known;
      if (known != valued.end() && known->first == point) c.plain = std::move(known->second);
    }
  }
  return candidates;
}

// Lines of sight are those of the plain basis, which the blocks know.
void HeldMaterial::replace(const Body& body, const std::vector<std::uint32_t>& component, std::span<const Near> blocks,
                           PointChanges* changes, MaterialPoints& points) {
  const double reach = reach_of(body.nodes);
  std::vector<Candidate> candidates;
  std::vector<std::size_t> first(1, 0);  // per block its first candidate; one more at the end
  for (const Near& near : blocks) {
    auto of_block = candidates_in(near, reach, points, changes);
    candidates.insert(candidates.end(), std::make_move_iterator(of_block.begin()),
                      std::make_move_iterator(of_block.end()));
    first.push_back(candidates.size());
  }
  parallel_for(candidates.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (Candidate& c : std::span(candidates).subspan(begin, end - begin))
      if (c.plain.value.empty()) straight_shape(body, points.blocks[c.block], c.point, c.plain);
  });
  std::vector<SupportTask> tasks;
  for (Candidate& c : candidates)
    if (c.plain.value.empty())
      tasks.push_back({.point = &c.copy,
                       .shape = &c.plain,
                       .before = &points.blocks[c.block],
                       .point_before = c.point,
                       .with_values = true});
  const VisibilityChanges no_changes({}, {}, body.nodes.size());
  if (!tasks.empty()) compute_supports(body, std::move(tasks), nullptr, &no_changes, component);
  const Shapes shapes{
      .body = body, .box_of_node = box_of_node_, .boxes = boxes_, .anchors = anchors_, .component = component};
  parallel_for(candidates.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      candidates[k].held = shapes.at(candidates[k].copy.position, candidates[k].plain);
  });
  std::vector<PointBlock> held(blocks.size());
  std::vector<char> is_replaced(blocks.size(), 0);
  parallel_for(blocks.size(), 1, [&](std::size_t from, std::size_t to) {
    for (std::size_t b = from; b < to; ++b) {
      PointBlock& block = points.blocks[blocks[b].block];
      auto sources = blocks[b].sources;
      is_replaced[b] = blocks[b].has_former;
      for (std::size_t k = first[b]; k < first[b + 1]; ++k)
        if (candidates[k].held) {
          sources[candidates[k].point].shape = &*candidates[k].held;
          is_replaced[b] = 1;
        }
      if (is_replaced[b]) held[b] = PointBlock(block.points, sources);
    }
  });
  for (std::size_t b = 0; b < blocks.size(); ++b)
    if (is_replaced[b])
      replaced_.push_back({.block = blocks[b].block,
                           .plain = std::exchange(points.blocks[blocks[b].block], std::move(held[b])),
                           .held = {},
                           .first_point = blocks[b].first_point});
}

}  // namespace geo
