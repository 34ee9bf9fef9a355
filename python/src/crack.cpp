// Cracks given whole: sheets, scores and fronts with all their steps.
#include <pybind11/stl.h>

#include "apart.h"
#include "bind.h"
#include "fronts.h"
#include "kerf/error.h"
#include "kerf/jobs.h"
#include "mesh_space.h"
#include "options.h"
#include "score.h"

namespace kerf_python {
namespace {

using Shared = std::shared_ptr<Complex>;

// Whether others hold the complex that a call cuts. One that they do not may be left to a thread.
enum class Held { alone, by_others };

std::shared_ptr<Delta> insert(const Shared& self, const std::shared_ptr<Mesh>& sheet, const geo::CrackOptions& options,
                              Held held, ProgressReport& progress) {
  const auto work = std::make_shared<geo::CrackStats>();
  const Writing writing(self->busy);
  const auto cut = [self, sheet, options, work, crack = self->next_crack()](const geo::Progress& report) {
    return geo::insert_sheet(self->complex, sheet->mesh, crack, options, work.get(), report);
  };
  auto delta = self->edit_held({}, true, [&] {
    return progress.run([&](const geo::Progress& report) {
      return held == Held::alone ? run_apart(report, "crack", cut) : cut(report);
    });
  });
  delta->stats = dict_of(*work);
  return delta;
}

geo::TriangleMesh sheet_of(const geo::Front& front) {
  geo::TriangleMesh sheet;
  sheet.vertices = front.steps[0];
  sheet.triangles = front.triangles;
  return sheet;
}

// Sweeps a front through all its steps, or inserts a sheet; a report before each.
void sweep(const Shared& self, const geo::Front& front, const geo::CrackOptions& options, double max_move, Held held,
           ProgressReport& progress) {
  const auto total = front.is_sheet() ? 1 : front.steps.size() - 1;
  const auto tell = [&](std::size_t done) {
    progress.run([&](const geo::Progress& report) { geo::report(report, "crack " + front.name, done, total); });
  };
  tell(0);
  if (front.is_sheet()) {
    insert(self, std::make_shared<Mesh>(sheet_of(front)), options, held, progress);
    return tell(1);
  }
  LiveFront live{self, nullptr};
  {
    const Writing writing(self->busy);
    live.record = std::make_shared<FrontRecord>(
        FrontRecord{geo::begin_front(front.steps[0], front.closed, self->next_crack()), options, {}});
    live.record->state.name = front.name;
    self->fronts.push_back(live.record);
  }
  for (std::size_t step = 0; step < total; ++step) {
    std::vector<geo::Vec3> start;
    for (const auto& p : live.record->state.points) start.push_back(p.position);
    const auto end = geo::resample_front(start, front.steps[step + 1], front.closed);
    const int parts = max_move > 0 ? geo::substep_count(start, end, max_move) : 1;
    for (int i = 1; i <= parts; ++i) {
      auto next = end;
      if (i < parts)
        for (std::size_t p = 0; p < next.size(); ++p) next[p] = start[p] + (end[p] - start[p]) * (double(i) / parts);
      step_front(live, std::move(next));
    }
    live.record->state.step = static_cast<std::uint32_t>(step + 1);
    tell(step + 1);
  }
}

bool is_sheet(py::handle what) {
  return py::isinstance<ScoreResult>(what) || py::isinstance<Mesh>(what) || py::isinstance<Plane>(what) ||
         py::hasattr(what, "faces");
}

// The sheet of a score, of a plane, of a mesh, or of an object like one.
std::shared_ptr<Mesh> sheet_argument(py::handle what, const Complex& across) {
  if (py::isinstance<ScoreResult>(what)) return what.cast<const ScoreResult&>().sheet;
  if (py::isinstance<Plane>(what))
    return std::make_shared<Mesh>(sheet_across(what.cast<const Plane&>(), across.complex.extent()));
  return mesh_argument(what, "sheet");
}

// Whether an array has integers.
bool has_integers(const py::handle& object) {
  const auto kind = py::module_::import("numpy").attr("asarray")(object).attr("dtype").attr("kind");
  return kind.cast<std::string>() == "i" || kind.cast<std::string>() == "u";
}

// Whether an object is an array of NumPy with integers: no one writes a line so by hand.
bool is_integer_array(const py::handle& object) { return py::isinstance<py::array>(object) && has_integers(object); }

bool is_integral(const py::handle& object) {
  const auto numpy = py::module_::import("numpy");
  const auto array = numpy.attr("asarray")(object);
  return numpy.attr("all")(numpy.attr("equal")(array, numpy.attr("floor")(array))).cast<bool>();
}

MeshArguments pair_of_arrays(const py::object& vertices, const py::object& faces) {
  MeshArguments arguments;
  for (auto* at : {&arguments.uv, &arguments.normals, &arguments.colors, &arguments.groups, &arguments.group_names,
                   &arguments.patch, &arguments.site, &arguments.source})
    *at = py::none();
  arguments.vertices = vertices;
  arguments.faces = faces;
  return arguments;
}

// A pair of arrays may be vertices and faces, or two lines. Vertices and faces become a mesh; null:
// two lines. Throws InputError for a pair that may be both, and for an array of integers that are
// no indices.
std::shared_ptr<Mesh> mesh_of_pair(const py::sequence& pair) {
  bool must_be_faces = false;
  try {
    must_be_faces = is_integer_array(pair[1]) && !has_integers(pair[0]);
    py::object faces = pair[1];
    if (!has_integers(faces)) {
      if (!is_integral(faces)) return nullptr;
      faces = py::module_::import("numpy").attr("asarray")(faces).attr("astype")("int64");
    }
    auto mesh = std::make_shared<Mesh>(mesh_from(pair_of_arrays(pair[0], faces)));
    const bool has_triangles = std::none_of(mesh->mesh.triangles.begin(), mesh->mesh.triangles.end(),
                                            [](const auto& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
    if (!has_triangles) return nullptr;
    if (!has_integers(pair[0]) && has_integers(pair[1])) return mesh;
  } catch (const geo::InputError&) {
    if (must_be_faces) throw;
    return nullptr;  // no indices of vertices
  } catch (const py::error_already_set&) {
    return nullptr;  // no arrays
  }
  throw geo::InputError(
      "what: two such arrays may be a mesh or two lines; give kerf.Mesh(vertices, faces), or a kerf.Front of two "
      "steps");
}

void crack_by(const Shared& self, py::handle what, const geo::CrackOptions& options, double max_move, Held held,
              ProgressReport& progress) {
  if (is_sheet(what)) {
    insert(self, sheet_argument(what, *self), options, held, progress);
    return;
  }
  if (py::isinstance<py::list>(what) || py::isinstance<py::tuple>(what)) {
    bool mixed = py::len(what) > 0;
    for (const auto item : what) mixed = mixed && (is_sheet(item) || py::isinstance<geo::Front>(item));
    if (mixed) {
      for (const auto item : what) crack_by(self, item, options, max_move, held, progress);
      return;
    }
    if (py::len(what) == 2)
      if (const auto sheet = mesh_of_pair(py::reinterpret_borrow<py::sequence>(what))) {
        insert(self, sheet, options, held, progress);
        return;
      }
  }
  for (const auto& front : fronts_from(what, "what")) {
    if (!front.is_sheet() && front.steps.size() < 2)
      throw geo::InputError("what: the front '" + front.name + "' has one step; give two at least");
    sweep(self, front, options, max_move, held, progress);
  }
}

// The complex of a model with cracks.
Shared cracked(const std::shared_ptr<Mesh>& mesh, const py::object& what, double max_move, py::object progress,
               Keywords&& keywords) {
  const auto options = crack_options(keywords);
  keywords.finish();
  ProgressReport report(std::move(progress));
  auto made = uncut_complex(mesh);
  crack_by(made, what, options, max_move, Held::alone, report);
  return made;
}

py::object pieces_of_cut(const std::shared_ptr<Mesh>& mesh, const py::object& what, const py::object& progress,
                         Keywords&& keywords) {
  const auto made = cracked(mesh, what, 0, progress, std::move(keywords));
  return py::cast(made).attr("pieces")(py::arg("progress") = progress);
}

constexpr const char* crack_doc =
    "what: a Score, a Mesh (a sheet) or its arrays (vertices, faces), a Plane, a Front, an array (steps, points, 3), "
    "a\n"
    "list of lines (points, 3), or a list of scores, meshes, planes and fronts. max_move divides steps in which a "
    "front point moves farther, model units; 0: never.\n"
    "Keywords, with the defaults of CrackOptions: snap, snap_edges, face_offset, clearance and jitter, lengths "
    "relative to the\n"
    "diagonal; attempts; seed. progress: a callable of (phase, done, total), called before each step; False stops.\n"
    "Raises InputError for what cannot be used, GeometryError where no attempt of a step passes the guard, "
    "Interrupted.";

}  // namespace

void bind_crack(py::module_& module) {
  static const std::string of_model =
      std::string(
          "The crack complex of the model with one or more cracks (§ 5). Raises InputError where the mesh is no\n"
          "valid model, with the repair.\n\n") +
      crack_doc;
  static const std::string of_complex =
      std::string(
          "Adds one or more cracks, each with a number of its own (§ 5). Steps before one that fails stay.\n\n") +
      crack_doc;
  py::class_<Mesh, std::shared_ptr<Mesh>>(module.attr("Mesh"))
      .def(
          "crack",
          [](const std::shared_ptr<Mesh>& self, const py::object& what, double max_move, py::object progress,
             py::kwargs given) {
            return cracked(self, what, max_move, std::move(progress), Keywords(std::move(given), "crack"));
          },
          py::arg("what"), py::arg("max_move") = 0.0, py::arg_v("progress", py::none()), of_model.c_str())
      .def(
          "cut",
          [](const std::shared_ptr<Mesh>& self, const py::object& what, const py::object& progress, py::kwargs given) {
            return pieces_of_cut(self, what, progress, Keywords(std::move(given), "cut"));
          },
          py::arg("what"), py::arg_v("progress", py::none()),
          "The pieces into which planes, sheets or other cracks divide the model, a list of Piece in descending order "
          "of\n"
          "volume: crack(what).pieces(). Raises as these.")
      .def(
          "split",
          [](const std::shared_ptr<Mesh>& self, const py::object& what, const py::object& progress, py::kwargs given) {
            return pieces_of_cut(self, what, progress, Keywords(std::move(given), "split"));
          },
          py::arg("what"), py::arg_v("progress", py::none()),
          "The older name of cut(). The split() of trimesh is another thing: it separates connected parts.");
  py::class_<Complex, Shared>(module.attr("Complex"))
      .def(
          "crack",
          [](const Shared& self, const py::object& what, double max_move, py::object progress, py::kwargs given) {
            Keywords keywords(std::move(given), "crack");
            const auto options = crack_options(keywords);
            keywords.finish();
            ProgressReport report(std::move(progress));
            crack_by(self, what, options, max_move, Held::by_others, report);
          },
          py::arg("what"), py::arg("max_move") = 0.0, py::arg_v("progress", py::none()), of_complex.c_str())
      .def(
          "insert",
          [](const Shared& self, const py::object& sheet, py::kwargs given) {
            Keywords keywords(std::move(given), "insert");
            const auto options = crack_options(keywords);
            keywords.finish();
            const auto mesh = sheet_argument(sheet, *self);
            ProgressReport no_report{py::none()};
            return insert(self, mesh, options, Held::by_others, no_report);
          },
          py::arg("sheet"),
          "Inserts the parts of a sheet (a Mesh, a Plane or a Score) in the material as one crack, in one step, and "
          "returns "
          "the\n"
          "CrackDelta (§ 5.2, § 7). Any triangles will do, connected or not, crossing each other or not. Keywords as "
          "for\n"
          "front(). Raises InputError for a sheet that cannot be used; GeometryError where no attempt passes the "
          "guard:\n"
          "the complex is then unchanged.");
}

}  // namespace kerf_python
