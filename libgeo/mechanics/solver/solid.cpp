#include "kerf/solid.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "kerf/error.h"
#include "kerf/parallel.h"
#include "mechanics/discretisation/elastic_block.h"
#include "mechanics/discretisation/kernel.h"
#include "mechanics/material/plasticity.h"

namespace geo {
namespace {

constexpr std::size_t nodes_a_block = 256;  // of mueller04, where each node is a point

std::vector<NodeId> all_nodes(std::size_t count) {
  std::vector<NodeId> all(count);
  for (std::uint32_t i = 0; i < count; ++i) all[i] = NodeId(i);
  return all;
}

}  // namespace

Solid::Solid(const Body& body, Materials materials) : materials_(std::move(materials)) {
  if (!materials_.fits(body.nodes.size())) throw InputError("a solid of several materials needs one for each node");
  State none;
  follow_nodes(body.nodes, body.graph, NodeId(body.nodes.size()), {}, all_nodes(body.nodes.size()), none);
  if (materials_.discretisation() == Discretisation::galerkin) {
    galerkin_.emplace(body, points_);
    points_.set_materials(materials_);
    group_nodes();
  } else {
    nodal_points(all_nodes(body.nodes.size()));
  }
}

Solid::Solid(const NodeSet& nodes, const VisibilityGraph& graph, Materials materials)
    : materials_(std::move(materials)) {
  if (!materials_.fits(nodes.size())) throw InputError("a solid of several materials needs one for each node");
  materials_.set_discretisation(Discretisation::mueller04);
  State none;
  update(nodes, graph, NodeId(nodes.size()), {}, all_nodes(nodes.size()), none);
}

void Solid::update(const NodeSet& nodes, const VisibilityGraph& graph, NodeId first_new, std::span<const NodeId> donors,
                   std::span<const NodeId> updated, State& state) {
  follow_nodes(nodes, graph, first_new, donors, updated, state);
  nodal_points(updated);
}

void Solid::follow(const Body& body, const BodyDelta& delta, State& state) {
  std::vector<Vec3> before;
  for (const NodeId i : delta.moved_nodes) before.push_back(position_[i.index()]);
  follow_nodes(body.nodes, body.graph, delta.first_new_node, delta.donors, delta.updated_nodes, state,
               !delta.detached.empty());
  if (!galerkin_) return nodal_points(delta.updated_nodes);
  galerkin_->mark_changed(body, delta, before);
  other_.resize(size(), 0);
  for (const NodeId i : delta.updated_nodes) other_[i.index()] = 1;
}

void Solid::settle(const Body& body, State& state) {
  if (!galerkin_ || !galerkin_->has_changes()) return;
  PointChanges changes;
  parallel_invoke([&] { groups_ = NodeGroups(position_, rows_, part_, parts_); },
                  [&] {
                    changes = galerkin_->rebuild_changed(body, points_);
                    points_.set_materials(materials_);
                    inverses_.follow(patches_, patches_.follow(position_, rows_, spacing_, other_, points_, changes));
                  });
  other_.clear();
  const auto& kept = changes.old_point;
  if (state.plastic.empty() || kept.empty()) return;
  std::vector<Mat3> plastic(points_.size(), Mat3::Zero());
  for (std::size_t i = 0; i < plastic.size(); ++i)
    if (kept[i] != ~0u) plastic[i] = state.plastic[kept[i]];
  state.plastic.swap(plastic);
}

void Solid::nodal_points(std::span<const NodeId> updated) {
  const std::size_t n = rows_.size(), count = (n + nodes_a_block - 1) / nodes_a_block, before = points_.blocks.size();
  std::vector<char> stale(count, 0);
  for (const NodeId i : updated) stale[i.index() / nodes_a_block] = 1;
  points_.blocks.resize(count);
  parallel_for(count, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      std::vector<MaterialPoint> points;
      std::vector<ShapeGradients> rows;
      for (std::size_t i = b * nodes_a_block; i < std::min(n, (b + 1) * nodes_a_block); ++i) {
        points.push_back({position_[i], volume_[i], rows_.quality(i), 0, false, 0, 0, volume_[i]});
        if (stale[b] || b >= before)
          rows.push_back(rows_.quality(i) == MomentQuality::singular ? ShapeGradients{} : rows_.shape_gradients(i));
      }
      if (stale[b] || b >= before)
        points_.blocks[b] = PointBlock(std::move(points), rows);
      else
        points_.blocks[b].points = std::move(points);  // volumes are halved without a change of neighbours
    }
  });
  points_.number_points(n);
  points_.set_materials(materials_);
  group_nodes();
  std::vector<double> penalty;
  for (std::size_t i = 0; i < n; ++i)
    penalty.push_back(materials_.of(i).mode_penalty * materials_.of(i).young * volume_[i]);
  penalty_.emplace(rows_, std::move(penalty));
}

void Solid::group_nodes() {
  groups_ = NodeGroups(position_, rows_, part_, parts_);
  patches_ = NodePatches(position_, rows_, spacing_, points_), inverses_ = {};
}

MomentQualityCounts Solid::moment_quality_counts() const {
  MomentQualityCounts counts;
  for (std::size_t i = 0; i < rows_.size(); ++i) ++counts.nodes[static_cast<std::size_t>(rows_.quality(i))];
  for (const PointBlock& b : points_.blocks)
    for (const MaterialPoint& p : b.points)
      ++counts.points[static_cast<std::size_t>(p.quality)], counts.widened += p.widenings > 0;
  return counts;
}

void Solid::gradient_row(NodeId i, std::vector<std::pair<NodeId, Vec3>>& out) const {
  const auto& node = rows_[i.index()];
  for (std::size_t q = 0; q < node.neighbors.size(); ++q) out.push_back({NodeId(node.neighbors[q]), node.gradient[q]});
  out.push_back({i, node.own_gradient});
}

double Solid::elastic_force(const std::vector<Vec3>& u, std::vector<Vec3>* force,
                            const std::vector<PointMatrices<double>>& relaxed) const {
  std::vector<double> energy(points_.blocks.size(), 0), pull(force ? 4 * points_.scatter_size() : 0);
  const BlockStrain strain(points_);
  parallel_for(energy.size(), 1, [&](std::size_t begin, std::size_t end) {
    ElasticBlock::Scratch room;
    ElasticBlock work(room, strain, materials_);
    for (std::size_t b = begin; b < end; ++b) {
      const auto& of_point = work.evaluate(b, u, {relaxed.empty() ? nullptr : &relaxed[b], nullptr}, nullptr,
                                           force ? &pull[4 * points_.scatter_offset(b)] : nullptr);
      energy[b] = std::accumulate(of_point.begin(), of_point.end(), 0.0);
    }
  });
  if (force) {
    force->resize(size());
    parallel_for(size(), 1024, [&](std::size_t begin, std::size_t end) {
      for (std::size_t j = begin; j < end; ++j) {
        const auto sum = points_.sum_at_node<4>(pull.data(), j);
        (*force)[j] = {sum[0], sum[1], sum[2]};
      }
    });
  }
  double sum = std::accumulate(energy.begin(), energy.end(), 0.0);
  if (penalty_) sum += penalty_->add(rows_, u, force);
  if (force)
    for (Vec3& f : *force) f = -f;
  return sum;
}

double Solid::energy(const std::vector<Vec3>& u) const { return elastic_force(u, nullptr); }

std::vector<Vec3> Solid::forces(const std::vector<Vec3>& u) const {
  std::vector<Vec3> f;
  elastic_force(u, &f);
  return f;
}

Mat3 Solid::stress_at(const State& state, const Vec3& x, double radius,
                      const std::function<bool(const Vec3&)>& sees) const {
  Mat3 sum = Mat3::Zero();
  double total = 0;
  for (std::size_t b = 0; b < points_.blocks.size(); ++b) {
    const PointBlock& block = points_.blocks[b];
    if (!block.box.meets(Box3{x, x}.grown(radius))) continue;
    std::vector<Mat3> gradient;
    for (std::size_t i = 0; i < block.points.size(); ++i) {
      const MaterialPoint& p = block.points[i];
      const double w = p.volume * kernel((p.position - x).norm() / radius, 1.0);
      if (!(w > 0) || p.quality == MomentQuality::singular || (sees && !sees(p.position))) continue;
      if (gradient.empty()) gradient = points_.gradients(b, state.displacement);
      Mat3 f = Mat3::Identity() + gradient[i];
      if (!state.plastic.empty()) f = f * inverse_plastic_stretch(state.plastic[points_.first_point(b) + i]);
      const double j = f.determinant();
      if (!(j > 0)) continue;  // turned inside out: it has no Cauchy stress
      const Mat3 cauchy = stress(materials_[p.material], f) * f.transpose() / j;
      sum += 0.5 * w * (cauchy + cauchy.transpose()), total += w;
    }
  }
  return total > 0 ? Mat3(sum / total) : sum;
}

Vec3 Solid::momentum(const State& state) const {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < size(); ++i) sum += mass_[i] * state.velocity[i];
  return sum;
}

Vec3 Solid::angular_momentum(const State& state) const {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < size(); ++i)
    sum += mass_[i] * (position_[i] + state.displacement[i]).cross(state.velocity[i]);
  return sum;
}

double Solid::kinetic_energy(const State& state) const {
  double sum = 0;
  for (std::size_t i = 0; i < size(); ++i) sum += 0.5 * mass_[i] * state.velocity[i].squaredNorm();
  return sum;
}

}  // namespace geo
