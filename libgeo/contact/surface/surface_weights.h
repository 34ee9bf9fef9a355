// Equation 1 as a sparse linear map: displacements of surface vertices from those of nodes.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/resolution.h"
#include "kerf/body.h"
#include "kerf/potential.h"
#include "kerf/solid.h"

namespace geo {

/// One stencil of nodes per surface vertex, with weights of sum 1. The same weights give a vertex
/// its velocity, and distribute an impulse on it over the nodes (§ 3.3).
class SurfaceWeights {
 public:
  /// A node and its weight.
  using Entry = NodeWeight;
  /// Computes the stencils of all living surface vertices: the kernel weights of Eq. 1 and, through
  /// the shape gradients of its nodes, weights of their neighbours. The cost follows the surface.
  void rebuild(const Body& body, const Solid& solid);
  /// Marks the stencils that a split of the body may have changed, for update().
  void mark_changed(const Body& body, const BodyDelta& delta);
  /// Computes the marked stencils; the result is that of rebuild(). Returns their vertices,
  /// ascending. The cost follows the marks.
  std::vector<std::uint32_t> update(const Body& body, const Solid& solid);
  /// Whether stencils are marked.
  bool has_changes() const { return !changed_.empty(); }

  /// Sets rotated() for displacements u of the nodes: after a step of the solid, and after
  /// rebuild() or update(). Returns whether it has changed for any vertex.
  bool set_rotations(const Solid& solid, const std::vector<Vec3>& u);

  /// Number of surface vertices.
  std::size_t size() const { return stencils_.size(); }
  /// The stencil of surface vertex v; empty if v is dead or no node carries it.
  Stencil stencil(std::size_t v) const { return stencils_[v]; }
  /// Whether surface vertex v is alive.
  bool alive(std::size_t v) const { return !std::isnan(rest_[v][0]); }
  /// The position of surface vertex v at rest. Precondition: it is alive.
  const Vec3& rest(std::size_t v) const { return rest_[v]; }
  /// The position of surface vertex v by Eq. 1. `displacement`: interpolate() of the nodes' ones.
  /// Moves from rest by multiples of the model's resolution. Precondition: v is alive.
  Vec3 placed(std::size_t v, const Vec3& displacement) const {
    return rest_[v] + resolution_.rounded(Vec3(displacement + rotated(v)));
  }
  /// vertex_area() of surface vertex v, model units².
  double area(std::size_t v) const { return area_[v]; }
  /// weight_norm() of the stencil of surface vertex v.
  double norm(std::size_t v) const { return norm_[v]; }
  /// Per surface vertex its node with the largest weight, the lowest of several; ~0u: no node.
  const std::vector<std::uint32_t>& heaviest() const { return heaviest_; }
  /// The nodes' values interpolated at surface vertex v; zero if no node carries it.
  Vec3 interpolate(std::size_t v, const std::vector<Vec3>& values) const { return weighted_sum(stencils_[v], values); }
  /// The part of the displacement of surface vertex v that rotations of nodes add in Eq. 1: those
  /// of debris (State::rotation), and those that take the place of what gradients would amplify
  /// (most_amplified). It is constant in a step.
  Vec3 rotated(std::size_t v) const { return rotated_.empty() ? Vec3(Vec3::Zero()) : rotated_[v]; }
  /// interpolate() for many vertices, in parallel; equal to the bit.
  std::vector<Vec3> interpolate(std::span<const std::uint32_t> vertices, const std::vector<Vec3>& values) const;

 private:
  struct Arm {
    std::uint32_t node;
    Vec3 arm;      // from the node to the vertex, times the node's kernel weight
    double share;  // of the gradient; the rotation has the rest
  };
  void compute(const Body& body, const Solid& solid, std::span<const std::uint32_t> vertices);

  Resolution resolution_{0};  // of the body
  std::vector<std::vector<Entry>> stencils_;
  std::vector<std::uint32_t> heaviest_;
  std::vector<Vec3> rest_;  // per vertex; not a number: dead
  std::vector<double> area_, norm_;
  std::vector<std::array<NodeId, 2>> masters_;  // per vertex, of master_nodes(); invalid: dead
  std::vector<std::vector<Arm>> arms_;          // per vertex: to nodes whose rotation has a share in its motion
  std::vector<Vec3> rotated_;                   // per vertex; empty: zero
  std::vector<std::uint8_t> changed_;           // per vertex: 1 if marked; empty: none is
};

}  // namespace geo
