// Impacts (kerf/impact.h): the classes Breakable, Breaking and BrokenPart.
#include "kerf/impact.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <optional>

#include "bind.h"
#include "busy.h"
#include "kerf/error.h"
#include "kerf/pieces.h"
#include "keywords.h"
#include "mesh.h"

namespace kerf_python {
namespace {

constexpr double all_at_once = 1e9;  // s: a call that goes on until the break is finished

// A solid that is prepared to be broken, with its mesh as Python sees it.
class Breakable {
 public:
  Breakable(geo::Breakable made, std::shared_ptr<Mesh> of) : solid(std::move(made)), mesh_(std::move(of)) {}
  // Made at the first call. To be called with the GIL.
  const std::shared_ptr<Mesh>& mesh() {
    if (!mesh_) mesh_ = std::make_shared<Mesh>(solid.mesh());
    return mesh_;
  }
  const geo::Breakable solid;

 private:
  std::shared_ptr<Mesh> mesh_;
};

// A part of a break; `divided`, `whole` and `hulls` follow the break.
struct BrokenPart {
  std::shared_ptr<Breakable> solid;
  std::size_t index = 0;
  std::optional<std::size_t> parent;
  bool divided = false, whole = false;
  std::vector<std::shared_ptr<Mesh>> hulls;
};

// A break that goes on. The parts are objects of Python's own, each made once.
struct Breaking {
  explicit Breaking(geo::Breaking made) : breaking(std::move(made)) {}
  // Goes on without the GIL, then brings the parts up to date.
  bool advance(double seconds) {
    if (!(seconds >= 0)) throw geo::InputError("advance: seconds must not be negative");
    const Writing writing(busy);
    const bool finished = without_gil([&] { return breaking.advance(std::min(seconds, all_at_once)); });
    follow();
    return finished;
  }
  void follow() {
    const auto& from = breaking.parts();
    for (std::size_t i = 0; i < from.size(); ++i) {
      if (i == parts.size()) {
        parts.push_back(std::make_shared<BrokenPart>());
        parts[i]->solid = std::make_shared<Breakable>(from[i].solid, nullptr);
        parts[i]->index = i;
        if (from[i].parent < from.size()) parts[i]->parent = from[i].parent;
      }
      parts[i]->divided = from[i].divided;
      if (from[i].whole && !parts[i]->whole)
        for (const geo::TriangleMesh& hull : from[i].hulls) parts[i]->hulls.push_back(std::make_shared<Mesh>(hull));
      parts[i]->whole = from[i].whole;
    }
  }

  geo::Breaking breaking;
  Busy busy;
  std::vector<std::shared_ptr<BrokenPart>> parts;
};

using BreakableClass = py::class_<Breakable, std::shared_ptr<Breakable>>;
using PartClass = py::class_<BrokenPart, std::shared_ptr<BrokenPart>>;
using BreakingClass = py::class_<Breaking, std::shared_ptr<Breaking>>;

std::shared_ptr<Breakable> prepared(const py::object& solid) {
  const auto mesh = mesh_argument(solid, "solid");
  return std::make_shared<Breakable>(without_gil([&] { return geo::Breakable(mesh->mesh); }), mesh);
}

geo::ImpactOptions options_from(Keywords& keywords) {
  geo::ImpactOptions o;
  keywords.take("toughness", o.toughness);
  keywords.take("max_pieces", o.max_pieces, 2, 10000);
  keywords.take("grading", o.grading);
  keywords.take("elongation", o.elongation);
  keywords.take("hull_parts", o.hull_parts, 1, 100);
  keywords.take("hull_corners", o.hull_corners, 4, 10000);
  keywords.seed("seed", o.seed);
  bool guard = false;
  keywords.flag("guard", guard);
  o.guard = guard ? geo::ImpactGuard::full : geo::ImpactGuard::none;
  return o;
}

std::shared_ptr<Breaking> strike(const Breakable& self, const py::object& at, double energy, const py::object& along,
                                 const py::object& seconds, py::kwargs given) {
  Keywords keywords(std::move(given), "strike");
  const geo::ImpactOptions options = options_from(keywords);
  keywords.finish();
  geo::Impact impact{.point = point_from(at, "point"), .direction = geo::Vec3::Zero(), .energy = energy};
  if (!along.is_none()) impact.direction = point_from(along, "direction");
  const double budget = seconds.is_none() ? all_at_once : seconds.cast<double>();
  auto made = std::make_shared<Breaking>(without_gil([&] { return geo::Breaking(self.solid, impact, options); }));
  made->advance(budget);
  return made;
}

constexpr const char* strike_doc =
    "Breaks it by a blow, and returns the Breaking. Pieces are small at the point and large away from it.\n\n"
    "point: (3,), inside the solid or near it, model units. energy: J; a new wall takes `toughness` J per square "
    "unit,\n"
    "from which their number follows, at most `max_pieces`. direction: (3,), pieces are `elongation` times as long\n"
    "along it as wide. seconds: time that this call may take, as in Breaking.advance(); None: as long as it takes.\n"
    "grading: spacing of pieces over distance from the impact, as a power; 0: even. hull_parts, hull_corners: most\n"
    "hulls of a piece, and corners of a hull. guard: whether no faces may cross by a rounding, either, so that every\n"
    "piece is a Solid; takes twice as long. Raises InputError.";

template <class Class, class Call>
void add_strike(Class& made, const Call& call) {
  made.def("strike", call, py::arg("point"), py::arg("energy"), py::arg_v("direction", py::none()),
           py::arg_v("seconds", py::none()), strike_doc);
}

void add_to_breakable(BreakableClass& made, py::module_& module) {
  made.def(py::init(&prepared), py::arg("solid"), "solid: a Solid, or a Mesh that is a valid model. Raises InputError.")
      .def_property_readonly(
          "mesh", [](Breakable& self) { return self.mesh(); },
          "The solid, a Mesh. Faces of breaks have the group \"crack\", and a patch other than 0.")
      .def_property_readonly(
          "volume", [](const Breakable& self) { return self.solid.volume(); }, "Volume, model units cubed.");
  add_strike(made, &strike);
  py::class_<Mesh, std::shared_ptr<Mesh>> mesh(module.attr("Mesh"));
  add_strike(mesh, [](const py::object& self, const py::object& point, double energy, const py::object& direction,
                      const py::object& seconds,
                      py::kwargs given) { return strike(*prepared(self), point, energy, direction, seconds, given); });
}

void add_to_part(PartClass& part) {
  part.def_readonly("index", &BrokenPart::index, "Its number among Breaking.parts.")
      .def_readonly("solid", &BrokenPart::solid, "The part as a Breakable: whole parts may be hit again.")
      .def_property_readonly(
          "mesh", [](const BrokenPart& self) { return self.solid->mesh(); },
          "Its boundary, a closed Mesh with the attributes of the solid.")
      .def_property_readonly(
          "volume", [](const BrokenPart& self) { return self.solid->solid.volume(); }, "Volume, model units cubed.")
      .def_property_readonly(
          "centroid",
          [](const BrokenPart& self) { return point(geo::mass_properties(self.solid->solid.mesh()).centroid); },
          "Centroid of the material, (3,) float64.")
      .def_readonly("parent", &BrokenPart::parent, "Index of the part that it came out of; None: it is the solid.")
      .def_readonly("divided", &BrokenPart::divided, "Whether other parts have taken its place.")
      .def_readonly("whole", &BrokenPart::whole, "Whether it breaks no further in this impact, and has its hulls.")
      .def_property_readonly(
          "hulls", [](const BrokenPart& self) { return self.hulls; }, "Convex hulls that cover it, a list of Mesh.")
      .def("__repr__", [](const BrokenPart& self) {
        return "<kerf.BrokenPart " + std::to_string(self.index) + " of volume " +
               py::str(py::float_(self.solid->solid.volume())).cast<std::string>() + ">";
      });
}

void add_to_breaking(BreakingClass& breaking) {
  breaking
      .def("advance", &Breaking::advance, py::arg("seconds"),
           "Goes on for about `seconds`, for one step at least, and returns whether it is finished. The pieces depend\n"
           "on the steps, and with enough time for all at once on the arguments of strike() alone. Raises InputError.")
      .def_property_readonly(
          "finished",
          [](Breaking& self) {
            const Reading reading(self.busy);
            return self.breaking.finished();
          },
          "Whether nothing is left to do.")
      .def_property_readonly(
          "parts",
          [](Breaking& self) {
            const Reading reading(self.busy);
            return self.parts;
          },
          "All parts in the order in which they came out, a list of BrokenPart; the first is the solid.")
      .def_property_readonly(
          "pieces",
          [](Breaking& self) {
            const Reading reading(self.busy);
            std::vector<std::shared_ptr<BrokenPart>> there;
            for (const auto& part : self.parts)
              if (!part->divided) there.push_back(part);
            return there;
          },
          "The parts that are not divided, a list of BrokenPart: together they fill the solid.")
      .def("__repr__", [](Breaking& self) {
        const Reading reading(self.busy);
        const auto there =
            std::count_if(self.parts.begin(), self.parts.end(), [](const auto& p) { return !p->divided; });
        return "<kerf.Breaking in " + std::to_string(there) +
               (self.breaking.finished() ? " pieces>" : " pieces, not finished>");
      });
}

}  // namespace

void bind_impact(py::module_& module) {
  // All three first: signatures name them.
  BreakableClass breakable(
      module, "Breakable",
      "A solid that is prepared to be broken where it is hit. It never changes. Making it is the slow part of an\n"
      "impact, and best done when a model is loaded.");
  PartClass part(module, "BrokenPart",
                 "A part of a solid that breaks. `divided`, `whole` and `hulls` follow the break; the rest never "
                 "changes.");
  BreakingClass breaking(
      module, "Breaking",
      "A break that goes on from call to call: made by strike(). After each call its pieces fill the solid, and those\n"
      "near the impact were divided first.");
  add_to_breakable(breakable, module);
  add_to_part(part);
  add_to_breaking(breaking);
}

}  // namespace kerf_python
