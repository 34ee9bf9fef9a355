// The bodies, blades, grips, obstacles and options of a scene, read-only.
#include <pybind11/stl.h>

#include "bind.h"
#include "pose.h"
#include "scene.h"

namespace kerf_python {
namespace {

void bind_body_and_grip(py::module_& module) {
  using geo::SceneBody;
  py::class_<SceneBody>(module, "SceneBody", "One solid of a scene.")
      .def_readonly("name", &SceneBody::name, "Its name.")
      .def_readonly("mesh", &SceneBody::mesh, "Path of the model.")
      .def_property_readonly(
          "spacing", [](const SceneBody& b) { return b.sampling.spacing; }, "Spacing at the surface; 0: by the others.")
      .def_property_readonly(
          "nodes", [](const SceneBody& b) { return b.sampling.count; }, "Wanted number of nodes; 0: by spacing.")
      .def_readonly("spacing_percent", &SceneBody::spacing_percent, "Spacing in percent of the model's diagonal.")
      .def_readonly("scale", &SceneBody::scale, "Of the model, applied before the pose.")
      .def_readonly("refine", &SceneBody::refine, "Longest edge of the skin, model units; 0: as modelled.")
      .def_property_readonly(
          "place", [](const SceneBody& b) { return pose_to(b.place); },
          "Pose in the world: position and quaternion (w, x, y, z).")
      .def_property_readonly(
          "velocity", [](const SceneBody& b) { return point(b.velocity); }, "Initial, (3,), model units per second.")
      .def_property_readonly(
          "spin", [](const SceneBody& b) { return point(b.spin); }, "Initial angular velocity, (3,), rad/s.")
      .def_readonly("material", &SceneBody::material, "Its own Material, or None.");
  using geo::Grip;
  py::class_<Grip>(module, "Grip", "A box whose nodes are held, and moved rigidly.")
      .def_property_readonly(
          "lo", [](const Grip& g) { return point(g.lo); }, "Lowest corner, (3,), material coordinates.")
      .def_property_readonly(
          "hi", [](const Grip& g) { return point(g.hi); }, "Highest corner, (3,), material coordinates.")
      .def_property_readonly(
          "keys", [](const Grip& g) { return keys_to(g.motion); },
          "Keyframes, (k, 8): time, x, y, z, axis, degrees; of the box's middle, relative to its first place.")
      .def_readonly("release", &Grip::release, "Whether nodes become free after the last key.");
}

void bind_loads(py::module_& module) {
  using geo::Load;
  py::class_<Load>(module, "Load", "A force over area on the skin in a box.")
      .def_property_readonly(
          "lo", [](const Load& l) { return point(l.lo); }, "Lowest corner, (3,), material coordinates.")
      .def_property_readonly(
          "hi", [](const Load& l) { return point(l.hi); }, "Highest corner, (3,), material coordinates.")
      .def_property_readonly(
          "traction", [](const Load& l) { return point(l.traction); }, "Force over undeformed area, (3,), Pa.")
      .def_readonly("start", &Load::from, "When it begins, s.")
      .def_readonly("ramp", &Load::ramp, "Seconds from then on in which it grows.")
      .def_readonly("until", &Load::until, "When it ends, s.");
  using geo::Support;
  py::class_<Support>(module, "Support", "The skin in a box, held along some axes of the world.")
      .def_property_readonly(
          "lo", [](const Support& s) { return point(s.lo); }, "Lowest corner, (3,), material coordinates.")
      .def_property_readonly(
          "hi", [](const Support& s) { return point(s.hi); }, "Highest corner, (3,), material coordinates.")
      .def_property_readonly(
          "axes",
          [](const Support& s) {
            return std::string(s.axes.x ? "x" : "") + (s.axes.y ? "y" : "") + (s.axes.z ? "z" : "");
          },
          "The axes along which the skin is held, as 'xz'.")
      .def_property_readonly(
          "keys", [](const Support& s) { return keys_to(s.motion); },
          "Keyframes, (k, 8): time, x, y, z, axis, degrees; of its way.");
}

void bind_blade_and_obstacle(py::module_& module) {
  using geo::Blade;
  py::class_<Blade>(module, "Blade", "A rigid cutting edge, with an optional wedge behind it.")
      .def_readonly("name", &Blade::name, "Its name.")
      .def_property_readonly(
          "points", [](const Blade& b) { return moved_points(std::vector<geo::Vec3>(b.points)); },
          "Of the edge, (n, 3), in the blade's coordinates.")
      .def_readonly("closed", &Blade::closed, "Whether the last point is joined to the first.")
      .def_property_readonly(
          "keys", [](const Blade& b) { return keys_to(b.motion); },
          "Keyframes, (k, 8): time, x, y, z, axis, degrees. The blade exists from the first to the last.")
      .def_property_readonly(
          "back", [](const Blade& b) { return point(b.back); }, "Vector from the edge to the back of the blade, (3,).")
      .def_readonly("thickness", &Blade::thickness, "Of the wedge at the back; 0: no wedge.")
      .def_readonly("friction", &Blade::friction, "Of the wedge's flanks: Coulomb's coefficient.")
      .def_readonly("resistance", &Blade::resistance, "Energy for each area that the edge cuts, J/m2; 0: none.")
      .def_readonly("stiffness", &Blade::stiffness, "Of the wedge: acceleration per depth, 1/s2.")
      .def_readonly("limit", &Blade::limit, "Longest motion of an edge point in one cut, in node spacings.")
      .def(
          "at", [](const Blade& b, double time) { return moved_points(b.at(time)); }, py::arg("time"),
          "World positions of the edge's points at a time in seconds, (n, 3).");
  using geo::SceneObstacle;
  py::class_<SceneObstacle>(module, "SceneObstacle",
                            "A rigid obstacle: a closed mesh, or the half-space below a plane.")
      .def_readonly("name", &SceneObstacle::name, "Its name.")
      .def_property_readonly(
          "plane", [](const SceneObstacle& o) { return o.mesh.triangles.empty(); }, "Whether it is a plane.")
      .def_property_readonly(
          "normal", [](const SceneObstacle& o) { return point(o.normal); }, "Of the plane, towards the bodies, (3,).")
      .def_readonly("scale", &SceneObstacle::scale, "Of the mesh, applied before the pose.")
      .def_property_readonly(
          "keys", [](const SceneObstacle& o) { return keys_to(o.motion); },
          "Keyframes, (k, 8): time, x, y, z, axis, degrees; applied to the placed obstacle.")
      .def_readonly("stiffness", &SceneObstacle::stiffness, "Acceleration per depth, 1/s2.")
      .def_readonly("friction", &SceneObstacle::friction, "Coulomb's coefficient.")
      .def(
          "pose", [](const SceneObstacle& o, double time) { return pose_to(o.pose(time)); }, py::arg("time"),
          "Pose of the scaled mesh at a time in seconds: position and quaternion (w, x, y, z).");
}

void bind_options(py::module_& module) {
  using F = geo::FractureOptions;
  py::class_<F>(module, "FractureOptions", "Parameters of fracture by stress.")
      .def_readonly("on", &F::on, "Whether anything breaks by itself.")
      .def_readonly("strength", &F::strength, "Largest principal stress at which a crack starts, Pa.")
      .def_readonly("toughness", &F::toughness, "Critical stress intensity, Pa sqrt(m); 0: by strength.")
      .def_readonly("variation", &F::variation, "Both are multiplied by 1 + variation times noise.")
      .def_readonly("grain", &F::grain, "Length scale of the noise; 0: a tenth of the diagonal.")
      .def_readonly("speed", &F::speed, "Largest crack speed over the Rayleigh wave speed.")
      .def_readonly("branching", &F::branching, "Ratio of stress to resistance at which a front branches; 0: never.")
      .def_readonly("separation", &F::separation, "Smallest distance between two starts, in node spacings.")
      .def_readonly("max_cracks", &F::max_cracks, "Cracks that may start in a run.")
      .def_readonly("cracks_per_step", &F::cracks_per_step, "Cracks that may start in a time step.")
      .def_readonly("start", &F::start, "No crack starts or grows earlier, s.");
  using C = geo::ContactOptions;
  py::class_<C>(module, "ContactOptions",
                "Parameters of self-contact. Lengths are in mean edge lengths of the surface.")
      .def_readonly("friction", &C::friction, "Coulomb's coefficient.")
      .def_readonly("gap", &C::gap, "Distance that opened sheets of a crack keep.")
      .def_readonly("opening", &C::opening, "Normal distance at which two sheets of a crack separate.")
      .def_readonly("recovery", &C::recovery, "Share of an interpenetration that an explicit step removes.")
      .def_readonly("rounds", &C::rounds, "Iterations of contact in explicit steps.");
}

}  // namespace

void bind_scene_objects(py::module_& module) {
  bind_body_and_grip(module);
  bind_loads(module);
  bind_blade_and_obstacle(module);
  bind_options(module);
}

}  // namespace kerf_python
