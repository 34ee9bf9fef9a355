// Legend: φ_j shape function of node j, d distance to the box, R support radius at the point,
// w = 1 − (1 − t)² with t = d / (0.55 R) < 1, else 1.
#include "mechanics/discretisation/held_material.h"

#include <Eigen/LU>
#include <algorithm>
#include <map>
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

// Farthest from a box that a point is affected: supports of points may be widened.
double largest_reach(const NodeSet& nodes) {
  return width * support_factors.back() * *std::max_element(nodes.radius.begin(), nodes.radius.end());
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
        if (!nearest || distance < least || (distance == least && a.box < nearest->box)) nearest = &a, least = distance;
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
      radius += plain.value[j] * r, radius_gradient += r * plain.gradient[j];
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
    for (const auto& [node, g] : entries) shape.nodes.push_back(node), shape.gradient.push_back(g), sum += g;
    // Constants are reproduced exactly: an anchor takes the rounding error of the sum.
    const auto first = std::lower_bound(shape.nodes.begin(), shape.nodes.end(), anchor.node[0]) - shape.nodes.begin();
    shape.gradient[static_cast<std::size_t>(first)] -= sum;
    return shape;
  }
};

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
      all.push_back({key.first, key.second, *four, corners.inverse()});
    }
  return all;
}

bool HeldMaterial::apply(const Body& body, const std::vector<std::uint32_t>& component, const PointChanges* changes,
                         MaterialPoints& points) {
  std::vector<Replaced> former = std::move(replaced_);
  replaced_.clear();
  if (boxes_.empty()) return false;
  box_of_node_.assign(body.nodes.size(), no_index);
  for (std::size_t i = 0; i < box_of_node_.size(); ++i)
    for (std::uint32_t k = 0; k < boxes_.size() && box_of_node_[i] == no_index; ++k)
      if (holds(boxes_[k], body.nodes.position[i])) box_of_node_[i] = k;
  std::vector<Anchors> anchors = anchors_of(body, component);
  const bool same_anchors = anchors == anchors_;
  anchors_ = std::move(anchors);
  if (anchors_.empty()) return false;
  std::vector<char> kept(points.blocks.size(), 0);
  for (Replaced& r : former) {
    const auto block = changes ? changes->new_block[r.block] : r.block;
    if (!same_anchors || block == no_index || (changes && !changes->same_points[r.block])) continue;
    PointBlock& plain = points.blocks[block];
    for (std::size_t i = 0; i < plain.points.size(); ++i)
      r.held.points[i].volume = plain.points[i].volume,
      r.held.points[i].unscaled_volume = plain.points[i].unscaled_volume;
    kept[block] = 1;
    replaced_.push_back({block, std::exchange(plain, std::move(r.held)), {}});
  }
  const double reach = largest_reach(body.nodes);
  std::vector<std::uint32_t> near;
  for (std::uint32_t b = 0; b < points.blocks.size(); ++b)
    if (!kept[b] && std::any_of(anchors_.begin(), anchors_.end(), [&](const Anchors& a) {
          return points.blocks[b].box.grown(reach).meets({boxes_[a.box].lo, boxes_[a.box].hi});
        }))
      near.push_back(b);
  replace(body, component, near, points);
  std::sort(replaced_.begin(), replaced_.end(), [](const auto& a, const auto& b) { return a.block < b.block; });
  return !replaced_.empty();
}

// Lines of sight are those of the plain basis, which the blocks know.
void HeldMaterial::replace(const Body& body, const std::vector<std::uint32_t>& component,
                           std::span<const std::uint32_t> blocks, MaterialPoints& points) {
  const double reach = largest_reach(body.nodes);
  struct Candidate {
    std::uint32_t block, point;
    MaterialPoint copy;
    ShapeGradients plain;
    std::optional<ShapeGradients> held;
  };
  std::vector<Candidate> candidates;
  for (const auto b : blocks)
    for (std::uint32_t i = 0; i < points.blocks[b].points.size(); ++i) {
      const MaterialPoint& p = points.blocks[b].points[i];
      if (p.quality == MomentQuality::singular) continue;
      if (std::any_of(anchors_.begin(), anchors_.end(), [&](const Anchors& a) {
            return (p.position - nearest_in(boxes_[a.box], p.position)).norm() < reach;
          }))
        candidates.push_back({b, i, p, {}, {}}), candidates.back().copy.influence_radius = 0;
    }
  std::vector<SupportTask> tasks;
  for (Candidate& c : candidates) tasks.push_back({&c.copy, &c.plain, &points.blocks[c.block], c.point, true});
  if (tasks.empty()) return;
  const VisibilityChanges no_changes({}, {}, body.nodes.size());
  compute_supports(body, std::move(tasks), nullptr, &no_changes);
  const Shapes shapes{body, box_of_node_, boxes_, anchors_, component};
  parallel_for(candidates.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      candidates[k].held = shapes.at(candidates[k].copy.position, candidates[k].plain);
  });
  std::erase_if(candidates, [](const Candidate& c) { return !c.held; });
  std::vector<std::pair<std::size_t, std::size_t>> runs;  // of candidates of one block
  for (std::size_t begin = 0, end; begin < candidates.size(); begin = end) {
    for (end = begin; end < candidates.size() && candidates[end].block == candidates[begin].block;) ++end;
    runs.push_back({begin, end});
  }
  const std::size_t first = replaced_.size();
  replaced_.resize(first + runs.size());
  parallel_for(runs.size(), 1, [&](std::size_t from, std::size_t to) {
    for (std::size_t r = from; r < to; ++r) {
      const auto [begin, end] = runs[r];
      PointBlock& block = points.blocks[candidates[begin].block];
      std::vector<PointBlock::Source> sources;
      for (std::size_t i = 0; i < block.points.size(); ++i) sources.push_back({&block, i, nullptr});
      for (std::size_t k = begin; k < end; ++k) sources[candidates[k].point] = {nullptr, 0, &*candidates[k].held};
      PointBlock held(block.points, sources);
      replaced_[first + r] = {candidates[begin].block, std::exchange(block, std::move(held)), {}};
    }
  });
}

}  // namespace geo
