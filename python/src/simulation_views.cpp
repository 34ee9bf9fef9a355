// Fields of the nodes, surfaces, body and sums of a run; the statistics of frames.
#include <pybind11/stl.h>

#include "arguments.h"
#include "bind.h"
#include "body.h"
#include "kerf/export.h"
#include "kerf/files.h"
#include "simulation.h"
#include "solid.h"

namespace kerf_python {
namespace {

using Class = py::class_<Simulation, std::shared_ptr<Simulation>>;

// A snapshot, made by `make` without the GIL and turned into an object by `show`.
template <class Make, class Show>
void snapshot(Class& simulation, const char* name, py::object Simulation::*kept, const Make& make, const Show& show,
              const char* doc) {
  simulation.def_property_readonly(
      name,
      [kept, make, show](Simulation& self) {
        const Reading reading(self.busy);
        auto& run = self.run();
        if (!(self.*kept)) {
          auto made = without_gil([&] { return make(self, run); });
          self.*kept = show(std::move(made));
        }
        return self.*kept;
      },
      doc);
}

std::vector<geo::Vec3> positions_of(const geo::Simulation& run) {
  auto out = geo::material_displacement(run.solid(), run.body().nodes, run.body().graph, run.state().motion);
  for (std::size_t i = 0; i < out.size(); ++i) out[i] += run.body().nodes.position[i];
  return out;
}

// The nodes of a frame as kerf-sim writes them.
geo::FrameNodes frame_nodes(const geo::Simulation& run) {
  geo::FrameNodes out{run.body().nodes, geo::von_mises_stress(run.solid(), run.body().nodes, run.state().motion)};
  out.nodes.position = positions_of(run);
  return out;
}

// The model whose attributes frames carry; null: several bodies have none.
const geo::TriangleMesh* model_of(const Simulation& self) {
  const geo::PlacedModels& placed = self.models.placed;
  return placed.bodies.size() == 1 || !placed.all.attributes.empty() ? &placed.all : nullptr;
}

py::object moved_vectors(std::vector<geo::Vec3>&& v) { return moved_points(std::move(v)); }

template <class T>
py::object object_of(std::shared_ptr<T>&& made) {
  return py::cast(std::move(made));
}

void add_arrays(Class& simulation) {
  snapshot(
      simulation, "positions", &Simulation::positions,
      [](Simulation&, geo::Simulation& run) { return positions_of(run); }, &moved_vectors,
      "Deformed position of the material at each node (Eq. 1), (n, 3) float64, model units. Snapshot.");
  snapshot(
      simulation, "displacement", &Simulation::displacement,
      [](Simulation&, geo::Simulation& run) { return run.state().motion.displacement; }, &moved_vectors,
      "Displacement of each node, (n, 3) float64: a coefficient of the field that positions shows. Snapshot.");
  snapshot(
      simulation, "velocities", &Simulation::velocities,
      [](Simulation&, geo::Simulation& run) { return run.state().motion.velocity; }, &moved_vectors,
      "Velocity of each node, (n, 3) float64, model units per second. Snapshot.");
  snapshot(
      simulation, "stress", &Simulation::stress,
      [](Simulation&, geo::Simulation& run) {
        return geo::von_mises_stress(run.solid(), run.body().nodes, run.state().motion);
      },
      [](std::vector<double>&& v) -> py::object { return moved<double>(std::move(v)); },
      "Von Mises stress at each node, (n,) float64, Pa. Snapshot.");
}

void add_objects(Class& simulation) {
  snapshot(
      simulation, "body", &Simulation::body,
      [](Simulation& self, geo::Simulation& run) {
        const auto* model = model_of(self);
        return std::make_shared<Body>(run.body(), model ? std::make_shared<Mesh>(*model) : nullptr);
      },
      &object_of<Body>, "The body in material coordinates, a copy: changing it leaves the run alone. Snapshot.");
  snapshot(
      simulation, "state", &Simulation::state,
      [](Simulation&, geo::Simulation& run) { return std::make_shared<State>(run.state().motion); }, &object_of<State>,
      "Displacements, velocities and plastic strains, a copy, State. Snapshot.");
  simulation
      .def(
          "surface",
          [](Simulation& self) {
            const Reading reading(self.busy);
            auto& run = self.run();
            if (!self.surface)
              self.surface = py::cast(without_gil([&] { return std::make_shared<Mesh>(run.surface(model_of(self))); }));
            return self.surface;
          },
          "The deformed two-sided surface with patch, site, source, and the model's attributes; a Mesh. Snapshot.")
      .def(
          "obstacle_surface",
          [](Simulation& self) {
            const Reading reading(self.busy);
            auto& run = self.run();
            return without_gil([&] {
              return std::make_shared<Mesh>(geo::place_obstacles(run.scene(), self.models.placed, run.state().time));
            });
          },
          "The obstacles as they stand now, as one Mesh; a plane is a square. Empty where there are none.")
      .def(
          "solid",
          [](Simulation& self) {
            const Reading reading(self.busy);
            auto& run = self.run();
            return without_gil([&] { return std::make_shared<DeformingSolid>(run.solid()); });
          },
          "The discretised solid, a copy, DeformingSolid.")
      .def(
          "write_frame",
          [](Simulation& self, const Path& path) {
            const Reading reading(self.busy);
            auto& run = self.run();
            without_gil([&] {
              const auto mesh = run.surface(model_of(self));
              geo::write_all(path, [&](std::ostream& out) { geo::write_ply(out, mesh); });
            });
          },
          py::arg("path"), "Writes the deformed surface as PLY, the same bytes as kerf-sim's. Raises OutputError.")
      .def(
          "write_nodes",
          [](Simulation& self, const Path& path) {
            const Reading reading(self.busy);
            auto& run = self.run();
            without_gil([&] {
              const auto nodes = frame_nodes(run);
              geo::write_all(path, [&](std::ostream& out) { geo::write_frame_nodes(out, nodes); });
            });
          },
          py::arg("path"), "Writes nodes and stress as PLY, the same bytes as kerf-sim's. Raises OutputError.");
}

template <class T>
void sum(Class& simulation, const char* name, T (geo::Solid::*of)(const geo::State&) const, const char* doc) {
  simulation.def_property_readonly(
      name,
      [of](Simulation& self) {
        const Reading reading(self.busy);
        auto& run = self.run();
        const T out = without_gil([&] { return (run.solid().*of)(run.state().motion); });
        if constexpr (std::is_same_v<T, double>)
          return out;
        else
          return point(out);
      },
      doc);
}

void add_numbers(Class& simulation) {
  sum(simulation, "momentum", &geo::Solid::momentum, "Linear momentum, (3,) float64, kg m/s.");
  sum(simulation, "angular_momentum", &geo::Solid::angular_momentum,
      "Angular momentum about the world's origin, (3,) float64, kg m2/s.");
  sum(simulation, "kinetic_energy", &geo::Solid::kinetic_energy, "Kinetic energy, J.");
  simulation
      .def_property_readonly(
          "time",
          [](Simulation& self) {
            const Reading reading(self.busy);
            return self.run().state().time;
          },
          "Time of the run, s.")
      .def_property_readonly(
          "frame",
          [](Simulation& self) {
            const Reading reading(self.busy);
            return self.run().state().frame;
          },
          "Frames computed so far.")
      .def_property_readonly(
          "total",
          [](Simulation& self) {
            const Reading reading(self.busy);
            return self.run().state().total;
          },
          "FrameStats of the whole run.")
      .def_property_readonly(
          "last",
          [](Simulation& self) {
            const Reading reading(self.busy);
            return self.last;
          },
          "FrameStats of the last frame.")
      .def_property_readonly(
          "body_index",
          [](Simulation& self) {
            const Reading reading(self.busy);
            return moved<std::uint32_t>(std::vector<std::uint32_t>(self.run().state().body_index));
          },
          "The body of the scene that each node belongs to, (n,) uint32.")
      .def_property_readonly(
          "scene", [](Simulation& self) { return std::const_pointer_cast<Scene>(self.scene); },
          "The scene as it was given, Scene.")
      .def("__repr__", [](Simulation& self) {
        const Reading reading(self.busy);
        auto& run = self.run();
        return "<kerf.Simulation of " + std::to_string(run.body().nodes.size()) + " nodes, frame " +
               std::to_string(run.state().frame) + ">";
      });
}

void bind_more_stats(py::module_& module) {
  using C = geo::ContactStats;
  py::class_<C>(module, "ContactStats", "Counts and seconds of contact.")
      .def_readonly("planes", &C::planes, "Separating planes used.")
      .def_readonly("touching", &C::touching, "Contacts with a force or an impulse.")
      .def_readonly("in_zones", &C::in_zones, "Vertices moved in rigid impact zones.")
      .def_readonly("opened", &C::opened, "Vertices of coincident sheets that separated.")
      .def_readonly("held", &C::held, "Steps in which the surface was not moved at all.")
      .def_readonly("tracking_error", &C::tracking_error, "Largest distance of a vertex from Eq. 1, model units.")
      .def_readonly("seconds", &C::seconds, "Seconds.");
  using H = geo::SheetStats;
  py::class_<H>(module, "SheetStats", "Shape of the sheets that blades cut.")
      .def_readonly("deviation", &H::deviation,
                    "Largest deviation of a sheet from the surface that its edge sweeps, in node spacings.")
      .def_readonly("turning", &H::turning, "Largest angle between neighbouring faces, degrees.")
      .def_readonly("retreating", &H::retreating, "Front points held, because their edge goes back in its own cut.")
      .def_readonly("crumbs", &H::crumbs, "Pieces with less than a tenth of a node's volume, at the frame's end.");
  using T = geo::CrackTip;
  py::class_<T>(module, "CrackTip", "Where a growing front is.")
      .def_readonly("crack", &T::crack, "Number of the crack behind it.")
      .def_property_readonly(
          "at", [](const T& t) { return point(t.at); }, "Mean of its points, (3,), material coordinates.")
      .def_readonly("length", &T::length, "Largest growth of a point since it began or branched, model units.");
  using F = geo::FractureStats;
  py::class_<F>(module, "FractureStats", "Counts of fracture by stress.")
      .def_readonly("begun", &F::begun, "Cracks started.")
      .def_readonly("divided", &F::divided, "Branches.")
      .def_readonly("advanced", &F::advanced, "Steps of fronts.")
      .def_readonly("refused", &F::refused, "Steps that could not be made.")
      .def_readonly("tips", &F::tips, "Fronts at the frame's end, list of CrackTip.");
}

}  // namespace

void add_views(Class& simulation) {
  add_arrays(simulation);
  add_objects(simulation);
  add_numbers(simulation);
}

void bind_frame_stats(py::module_& module) {
  bind_more_stats(module);
  using S = geo::FrameStats;
  const auto forces = [](std::vector<geo::Vec3> S::*member) {
    return [member](const S& s) { return moved_points(std::vector<geo::Vec3>(s.*member)); };
  };
  py::class_<S>(module, "FrameStats", "Counts of a frame, or of a run, and seconds by phase.")
      .def_readonly("split", &S::split, "Cutting, SplitStats.")
      .def_readonly("fracture", &S::fracture, "Fracture by stress, FractureStats.")
      .def_readonly("contact", &S::contact, "Contact, ContactStats.")
      .def_readonly("sheet", &S::sheet, "Shape of the sheets that blades cut, SheetStats.")
      .def_readonly("refused", &S::refused, "Crack steps that could not be made.")
      .def_readonly("fronts", &S::fronts, "Steps of blade fronts tried.")
      .def_readonly("newton", &S::newton, "Newton iterations.")
      .def_readonly("cg", &S::cg, "Iterations of conjugate gradients.")
      .def_readonly("steps", &S::steps, "Time steps.")
      .def_readonly("fracture_seconds", &S::fracture_seconds, "Stresses and plans, without the splits.")
      .def_readonly("front_seconds", &S::front_seconds,
                    "Mapping of blades into the material, as far as it is not beside contact.")
      .def_readonly("mechanics_seconds", &S::mechanics_seconds, "Mechanics, as far as it is not beside contact.")
      .def_readonly("contact_seconds", &S::contact_seconds, "Contact.")
      .def_property_readonly("split_seconds", &S::split_seconds, "All phases of cutting.")
      .def_readonly("energy", &S::energy, "Elastic energy at the frame's end, J.")
      .def_readonly("work", &S::work, "Work of loads, supports, pulls, stitches and blades on the bodies, J.")
      .def_readonly("cut_energy", &S::cut_energy, "Energy that the resistance to blades has taken, J.")
      .def_property_readonly("support_force", forces(&S::support_force),
                             "Mean force of the material on each support along its axes, (s, 3), N.")
      .def_property_readonly("blade_force", forces(&S::blade_force),
                             "Mean force of the material on each blade, (b, 3), N; zero without a resistance, or back\n"
                             "and thickness.")
      .def_property_readonly("pull_force", forces(&S::pull_force),
                             "Mean force of the material on each pull, (p, 3), N.")
      .def_property_readonly(
          "stitch_force", [](const S& s) { return s.stitch_force; }, "Mean tension of each stitch, a list, N.")
      .def_property_readonly("obstacle_force", forces(&S::obstacle_force),
                             "Mean force of the bodies on each obstacle, then the ground, (o, 3), N.")
      .def_property_readonly("obstacle_torque", forces(&S::obstacle_torque),
                             "Likewise the torque about the obstacle's origin, (o, 3), N m.");
}

}  // namespace kerf_python
