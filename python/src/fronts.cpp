// A step names the state alone as what may change, so that undo() restores it.
#include "fronts.h"

#include <pybind11/stl.h>

#include "bind.h"
#include "kerf/error.h"
#include "options.h"

namespace kerf_python {

std::shared_ptr<Delta> step_front(const LiveFront& front, std::vector<geo::Vec3> next) {
  Complex& complex = *front.complex;
  FrontRecord& record = *front.record;
  const Writing writing(complex.busy);
  std::vector<geo::Vec3> from;
  for (const auto& p : record.state.points) from.push_back(p.position);
  if (next.size() < 2) throw geo::InputError("advance: give at least two points");
  geo::CrackStats work;
  auto delta = complex.edit_held({front.record}, true, [&] {
    return without_gil([&] {
      const auto to = geo::resample_front(from, next, record.state.closed);
      return geo::advance(complex.complex, record.state, to, record.options, &work);
    });
  });
  record.work += work;
  delta->stats = dict_of(work);
  return delta;
}

namespace {

// The steps of an array (steps, points, 3), or of a list or tuple of lines.
std::vector<std::vector<geo::Vec3>> steps_from(py::handle object, const std::string& name) {
  const bool list = py::isinstance<py::list>(object) || py::isinstance<py::tuple>(object);
  const bool array =
      !list && py::hasattr(object, "__array__") && py::module_::import("numpy").attr("ndim")(object).cast<int>() == 3;
  if (!list && !array)
    throw geo::InputError(name + ": give an array (steps, points, 3) or a list of lines (points, 3)");
  std::vector<std::vector<geo::Vec3>> steps;
  for (const auto step : py::reinterpret_borrow<py::sequence>(object))
    steps.push_back(points_from(step, name + ": step " + std::to_string(steps.size())));
  return steps;
}

}  // namespace

std::vector<geo::Front> fronts_from(py::handle object, const std::string& name) {
  if (py::isinstance<geo::Front>(object)) return {object.cast<const geo::Front&>()};
  const bool list = py::isinstance<py::list>(object) || py::isinstance<py::tuple>(object);
  if (list && py::len(object) > 0 && py::isinstance<geo::Front>(py::reinterpret_borrow<py::sequence>(object)[0])) {
    std::vector<geo::Front> out;
    for (const auto item : object) {
      if (!py::isinstance<geo::Front>(item)) throw geo::InputError(name + ": give fronts only");
      out.push_back(item.cast<const geo::Front&>());
    }
    return out;
  }
  geo::Front front;
  front.steps = steps_from(object, name);
  for (const auto& step : front.steps)
    if (step.size() < 2) throw geo::InputError(name + ": a step has fewer than two points");
  if (front.steps.size() < 2) throw geo::InputError(name + ": give two steps at least");
  return {std::move(front)};
}

namespace {

void bind_whole_front(py::module_& module) {
  using Front = geo::Front;
  py::class_<Front, std::shared_ptr<Front>>(
      module, "Front",
      "A front over time, as front files have it: F_0, F_1 and so on (§ 5.1); or a sheet, a crack given whole.\n\n"
      "Front(steps, *, name, closed, triangles): steps is an array (t, n, 3) or a list of arrays (n, 3), material\n"
      "coordinates; closed joins the last point to the first. With triangles, (m, 3) indices, it is a sheet and has "
      "one\n"
      "step. Raises InputError.")
      .def(py::init([](const py::object& steps, const std::string& name, bool closed, const py::object& triangles) {
             Front front{name, closed, steps_from(steps, "steps"), {}};
             for (const auto& step : front.steps)
               if (step.size() < (closed ? 3 : 2))
                 throw geo::InputError("steps: a front has two points at least, a closed one three");
             if (front.steps.empty()) throw geo::InputError("steps: give one at least");
             if (!triangles.is_none()) {
               if (front.steps.size() != 1) throw geo::InputError("triangles: a sheet has one step");
               front.triangles = triangles_from(triangles, "triangles", front.steps[0].size());
             }
             if (name.find('\n') != name.npos) throw geo::InputError("name: give one line");
             return front;
           }),
           py::arg("steps"), py::kw_only(), py::arg("name") = "", py::arg("closed") = false,
           py::arg_v("triangles", py::none()), "See the class.")
      .def_readonly("name", &Front::name, "As in its file; may be empty.")
      .def_readonly("closed", &Front::closed, "Whether the last point is joined to the first.")
      .def_property_readonly("is_sheet", &Front::is_sheet, "Whether this is a sheet.")
      .def_property_readonly(
          "steps",
          [](const py::object& self) {
            py::list out;
            for (const auto& step : self.cast<const Front&>().steps)
              out.append(view<double>(step.data(), {static_cast<py::ssize_t>(step.size()), 3}, self));
            return out;
          },
          "Points of each step, a list of (n, 3) float64 read-only views.")
      .def_property_readonly(
          "triangles",
          [](const py::object& self) {
            const auto& t = self.cast<const Front&>().triangles;
            return view<std::uint32_t>(t.data(), {static_cast<py::ssize_t>(t.size()), 3}, self);
          },
          "Triangles of a sheet, (m, 3) uint32, indices into its points; empty for a front. Read-only view.")
      .def("__repr__", [](const Front& self) {
        return "<kerf.Front '" + self.name + "' of " + std::to_string(self.steps.size()) + " steps>";
      });
}

py::array positions(const std::vector<geo::FrontState::Point>& points) {
  std::vector<geo::Vec3> out;
  for (const auto& p : points) out.push_back(p.position);
  return moved_points(std::move(out));
}

py::array ids(const std::vector<geo::FrontState::Point>& points) {
  std::vector<geo::VertexId> out;
  for (const auto& p : points) out.push_back(p.id);
  return moved_ids(std::move(out));
}

void bind_live_front(py::module_& module) {
  py::class_<LiveFront, std::shared_ptr<LiveFront>>(module, "FrontState",
                                                    "A front that cuts a Complex, between two steps (§ 5.2): "
                                                    "Complex.front() begins it. Its contacts with the complex\n"
                                                    "are kept by id. Arrays are copies.")
      .def(
          "advance",
          [](const LiveFront& self, const py::object& line) { return step_front(self, points_from(line, "line")); },
          py::arg("line"),
          "Sweeps the front to a line, (n, 3) points in material coordinates, inserts the strip and returns the\n"
          "CrackDelta. A line of another number of points is resampled at equal fractions of its length. Cracks that\n"
          "begin, branch, merge and end follow from the intersection (§ 5.2). Raises InputError for points out of\n"
          "range; GeometryError where no attempt passes the guard: front and complex are then unchanged.")
      .def(
          "end",
          [](LiveFront& self) {
            const Writing writing(self.complex->busy);
            std::erase(self.complex->fronts, self.record);
          },
          "Ends the front: the complex forgets it, later edits need not keep its contacts.")
      .def_property_readonly(
          "points",
          [](const LiveFront& self) {
            const Reading reading(self.complex->busy);
            return positions(self.record->state.points);
          },
          "Positions of its points, (n, 3) float64, material coordinates.")
      .def_property_readonly(
          "ids",
          [](const LiveFront& self) {
            const Reading reading(self.complex->busy);
            return ids(self.record->state.points);
          },
          "The vertex of the complex at each point, (n,) uint32; 2**32 - 1 outside the material.")
      .def_property_readonly(
          "segments",
          [](const LiveFront& self) {
            const Reading reading(self.complex->busy);
            py::list out;
            for (const auto& s : self.record->state.segments) out.append(py::make_tuple(positions(s), ids(s)));
            return out;
          },
          "For each segment a tuple of the positions, (k, 3), and the vertices, (k,) uint32, that lie on it in order,\n"
          "its ends included.")
      .def_property_readonly(
          "complex", [](const LiveFront& self) { return self.complex; }, "The Complex that it cuts.")
      .def_property_readonly(
          "crack", [](const LiveFront& self) { return self.record->state.crack; }, "Number of the crack behind it.")
      .def_property_readonly(
          "closed", [](const LiveFront& self) { return self.record->state.closed; },
          "Whether the last point is joined to the first.")
      .def_property_readonly(
          "step", [](const LiveFront& self) { return self.record->state.step; }, "Number of steps that it has made.")
      .def_property_readonly(
          "name", [](const LiveFront& self) { return self.record->state.name; }, "Its name in files.")
      .def_property_readonly(
          "stats", [](const LiveFront& self) { return dict_of(self.record->work); },
          "Counts and seconds of all its steps, a dict.")
      .def("__repr__", [](const LiveFront& self) {
        return "<kerf.FrontState of crack " + std::to_string(self.record->state.crack) + ", step " +
               std::to_string(self.record->state.step) + ">";
      });
}

std::shared_ptr<LiveFront> begin(const std::shared_ptr<Complex>& self, const py::object& line, bool closed,
                                 const std::string& name, py::kwargs given) {
  Keywords keywords(std::move(given), "front");
  const auto options = crack_options(keywords);
  keywords.finish();
  const auto points = points_from(line, "line");
  if (name.find('\n') != name.npos) throw geo::InputError("name: give one line");
  const Writing writing(self->busy);
  auto record =
      std::make_shared<FrontRecord>(FrontRecord{geo::begin_front(points, closed, self->next_crack()), options, {}});
  record->state.name = name;
  self->fronts.push_back(record);
  return std::make_shared<LiveFront>(LiveFront{self, std::move(record)});
}

void add_to_complex(py::module_& module) {
  py::class_<Complex, std::shared_ptr<Complex>>(module.attr("Complex"))
      .def(
          "front", &begin, py::arg("line"), py::arg("closed") = false, py::arg("name") = "",
          "Begins a front at a line, (n, 3) points in material coordinates: F_0 of § 5.1, without contacts. Its crack\n"
          "gets the next number. Keywords, with the defaults of CrackOptions: snap, snap_edges, face_offset, clearance "
          "and "
          "jitter,\n"
          "lengths relative to the diagonal; attempts; seed. Raises InputError for fewer than two points (closed:\n"
          "three).")
      .def_property_readonly(
          "fronts",
          [](const std::shared_ptr<Complex>& self) {
            py::list out;
            for (const auto& record : self->fronts) out.append(std::make_shared<LiveFront>(LiveFront{self, record}));
            return out;
          },
          "The fronts that cut the complex, a list of FrontState: those begun here, and those of its file.");
}

}  // namespace

void bind_fronts(py::module_& module) {
  bind_whole_front(module);
  bind_live_front(module);
  add_to_complex(module);
  module.def(
      "resample_front",
      [](const py::object& previous, const py::object& next, bool closed) {
        const auto from = points_from(previous, "previous"), to = points_from(next, "next");
        if (from.size() < 2 || to.size() < 2)
          throw geo::InputError("resample_front: give lines of two points at least");
        return moved_points(geo::resample_front(from, to, closed));
      },
      py::arg("previous"), py::arg("next"), py::arg("closed") = false,
      "Resamples `next` to as many points as `previous`, at the fractions of arc length of its points; unchanged "
      "where\n"
      "the counts agree. Lines are (n, 3). Returns (n, 3) float64. Raises InputError.");
  module.def(
      "substep_count",
      [](const py::object& previous, const py::object& next, double limit) {
        return geo::substep_count(points_from(previous, "previous"), points_from(next, "next"), limit);
      },
      py::arg("previous"), py::arg("next"), py::arg("limit"),
      "The number of substeps, at least 1, that keeps each front point's motion per substep at or below `limit`, "
      "model\n"
      "units (§ 5.1). Raises InputError unless limit is positive.");
}

}  // namespace kerf_python
