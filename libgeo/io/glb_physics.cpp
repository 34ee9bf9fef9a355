// io/glb_physics.h. Joints of KHR_physics_rigid_bodies limit all distances and angles to zero.
#include "io/glb_physics.h"

namespace geo {
namespace {

using Json = GlbFile::Json;
constexpr const char* omi_body = "OMI_physics_body";
constexpr const char* omi_shape = "OMI_physics_shape";
constexpr const char* khr_bodies = "KHR_physics_rigid_bodies";

}  // namespace

GlbExtensions::GlbExtensions(GlbFile& file, GlbPhysics kind) : file_(file), kind_(kind) {
  if (kind == GlbPhysics::omi) file.json["extensionsUsed"] = {omi_body, omi_shape};
  if (kind == GlbPhysics::khr) file.json["extensionsUsed"] = Json::array({khr_bodies});
}

void GlbExtensions::add_body(Json& node, const RigidBody& body) const {
  if (kind_ == GlbPhysics::none) return;
  Json motion = Json::object();
  if (kind_ == GlbPhysics::omi) motion["type"] = "dynamic";
  if (body.mass > 0) {
    motion["mass"] = body.mass;
    motion["centerOfMass"] = {0.0, 0.0, 0.0};
    motion["inertiaDiagonal"] = {body.inertia.x(), body.inertia.y(), body.inertia.z()};
    motion["inertiaOrientation"] = {body.axes.x(), body.axes.y(), body.axes.z(), body.axes.w()};
  }
  node["extensions"][kind_ == GlbPhysics::omi ? omi_body : khr_bodies]["motion"] = motion;
}

void GlbExtensions::add_collider(Json& node, std::size_t mesh) {
  if (kind_ == GlbPhysics::omi) {
    Json& shapes = file_.json["extensions"][omi_shape]["shapes"];
    shapes.push_back({{"type", "convex"}, {"convex", {{"mesh", mesh}}}});
    node["extensions"][omi_body]["collider"]["shape"] = shapes.size() - 1;
  }
  if (kind_ == GlbPhysics::khr)
    node["extensions"][khr_bodies]["collider"]["geometry"] = {{"mesh", mesh}, {"convexHull", true}};
}

void GlbExtensions::add_joint(std::size_t a, std::size_t b, Json extras) {
  Json& joints = file_.json["extensions"][khr_bodies]["physicsJoints"];
  if (joints.empty()) {
    const Json axes = {0, 1, 2};
    joints.push_back(
        {{"limits",
          {{{"linearAxes", axes}, {"min", 0.0}, {"max", 0.0}}, {{"angularAxes", axes}, {"min", 0.0}, {"max", 0.0}}}}});
  }
  file_.json["nodes"][a]["extensions"][khr_bodies]["joint"] = {
      {"connectedNode", b}, {"joint", 0}, {"enableCollision", false}, {"extras", std::move(extras)}};
}

}  // namespace geo
