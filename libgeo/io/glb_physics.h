// Rigid bodies, collision shapes and joints as extensions of glTF: OMI_physics_body with
// OMI_physics_shape, and the review draft KHR_physics_rigid_bodies.
#pragma once

#include "io/glb_file.h"
#include "io/piece_json.h"

namespace geo {

/// Adds one kind of physics to a file; none of it for GlbPhysics::none.
class GlbExtensions {
 public:
  /// Names the extensions in the file.
  GlbExtensions(GlbFile& file, GlbPhysics kind);

  /// Makes a node, whose origin is the centre of mass, a dynamic body. A body without mass has the
  /// reader's.
  void add_body(GlbFile::Json& node, const RigidBody& body) const;
  /// Gives a node the convex hull of a mesh of the file as its collision shape.
  void add_collider(GlbFile::Json& node, std::size_t mesh);
  /// Whether joints are written.
  bool has_joints() const { return kind_ == GlbPhysics::khr; }
  /// Fixes node `a` to node `b`, which are at one place on two bodies. `extras`: of the joint.
  void add_joint(std::size_t a, std::size_t b, GlbFile::Json extras);

 private:
  GlbFile& file_;
  GlbPhysics kind_;
};

}  // namespace geo
