// Scores (§ 7): options are keywords with the names of the library's structures; `jagged` is the
// amplitude, `seed` that of pattern and jaggedness.
#include "score.h"

#include <pybind11/stl.h>

#include "bind.h"
#include "complex.h"
#include "fronts.h"
#include "kerf/error.h"
#include "kerf/score.h"
#include "keywords.h"

namespace kerf_python {
namespace {

geo::Vec3 axis_from(const py::object& axis) {
  if (!py::isinstance<py::str>(axis)) return point_from(axis, "axis");
  const auto text = axis.cast<std::string>();
  if (text.size() != 1 || text[0] < 'x' || text[0] > 'z')
    throw geo::InputError("axis: '" + text + "' is not 'x', 'y', 'z' or three numbers");
  return geo::Vec3::Unit(text[0] - 'x');
}

// Curves: a line (n, 3), a front whose steps are curves, or a list of both.
std::vector<std::vector<geo::Vec3>> curves_from(const py::object& curves) {
  std::vector<std::vector<geo::Vec3>> out;
  const auto add = [&](py::handle item) {
    if (!py::isinstance<geo::Front>(item)) return out.push_back(points_from(item, "curves"));
    const auto& front = item.cast<const geo::Front&>();
    if (front.is_sheet()) throw geo::InputError("curves: '" + front.name + "' is a sheet; give it as sheets");
    for (auto curve : front.steps) {
      if (front.closed) curve.push_back(curve.front());
      out.push_back(std::move(curve));
    }
  };
  if (py::isinstance<py::list>(curves) || py::isinstance<py::tuple>(curves))
    for (const auto item : curves) add(item);
  else
    add(curves);
  for (const auto& curve : out)
    if (curve.size() < 2) throw geo::InputError("curves: give two points at least for each");
  return out;
}

std::vector<geo::TriangleMesh> sheets_from(const py::object& sheets) {
  std::vector<geo::TriangleMesh> out;
  const auto add = [&](py::handle item) {
    const auto& mesh = mesh_argument(item, "sheets")->mesh;
    out.emplace_back();
    out.back().vertices = mesh.vertices;
    out.back().triangles = mesh.triangles;
  };
  if (py::isinstance<py::list>(sheets) || py::isinstance<py::tuple>(sheets))
    for (const auto item : sheets) add(item);
  else
    add(sheets);
  return out;
}

geo::ScoreOptions options_from(const std::string& pattern, Keywords& keywords) {
  geo::ScoreOptions o;
  o.pattern.pattern = geo::pattern_named(pattern);
  keywords.take("pieces", o.pieces, 1, 1000000);
  keywords.take("attempts", o.attempts, 1, 1000000);
  keywords.take("depth", o.depth, 0, 1);
  keywords.take("jagged", o.jagged.amplitude, 0, 1);
  keywords.take("frequency", o.jagged.frequency, 0, 1e4);
  keywords.take("octaves", o.jagged.octaves, 1, 16);
  keywords.take("edge", o.jagged.edge, 0, 1);
  if (o.jagged.edge > 0 && o.jagged.edge < 1e-4) throw geo::InputError("score: edge must be 0 or at least 1e-4");
  keywords.take("cluster", o.pattern.cluster, 0, 10);
  keywords.take("grain", o.pattern.grain, 1, 1000);
  keywords.seed("seed", o.pattern.seed);
  o.jagged.seed = o.pattern.seed;
  if (const auto axis = keywords.object("axis"); !axis.is_none()) o.pattern.axis = axis_from(axis);
  if (o.pattern.axis && !(o.pattern.axis->norm() > 0)) throw geo::InputError("axis: has no length");
  if (const auto impact = keywords.object("impact"); !impact.is_none()) o.pattern.impact = point_from(impact, "impact");
  if (const auto curves = keywords.object("curves"); !curves.is_none()) o.pattern.curves = curves_from(curves);
  if (const auto sheets = keywords.object("sheets"); !sheets.is_none()) o.pattern.sheets = sheets_from(sheets);
  if ((o.pattern.pattern == geo::Pattern::curves) == o.pattern.curves.empty())
    throw geo::InputError("score: the pattern 'curves' and the argument curves go together");
  if ((o.pattern.pattern == geo::Pattern::sheets) == o.pattern.sheets.empty())
    throw geo::InputError("score: the pattern 'sheets' and the argument sheets go together");
  return o;
}

std::shared_ptr<ScoreResult> score(const py::object& model, const std::string& pattern, py::object progress,
                                   py::kwargs given) {
  Keywords keywords(std::move(given), "score");
  const auto options = options_from(pattern, keywords);
  keywords.finish();
  ProgressReport report(std::move(progress));
  const ModelReading reading(model, "model");
  auto made =
      report.run([&](const geo::Progress& progress) { return geo::make_score(reading.complex(), options, progress); });
  return std::make_shared<ScoreResult>(
      ScoreResult{std::make_shared<Mesh>(std::move(made.sheet)), made.pieces, made.attempts});
}

py::object fracture(const py::object& self, const py::object& pieces, const std::string& pattern,
                    const py::object& progress, py::kwargs given) {
  given["pieces"] = pieces;
  const auto walls = score(self, pattern, progress, std::move(given));
  const py::object cut = self.attr("crack")(walls, py::arg("progress") = progress);
  return cut.attr("pieces")(py::arg("progress") = progress);
}

}  // namespace

void bind_score(py::module_& module) {
  py::class_<ScoreResult, std::shared_ptr<ScoreResult>>(
      module, "Score", "The walls of a fracture pattern as one sheet that divides a model (§ 7, Fig. 7).")
      .def_property_readonly(
          "sheet", [](const ScoreResult& self) { return self.sheet; },
          "The walls, a Mesh; walls that meet share vertices.")
      .def_readonly("pieces", &ScoreResult::pieces, "Pieces into which a score of full depth divides the model.")
      .def_readonly("attempts", &ScoreResult::attempts, "Number of patterns that were tried.")
      .def("__repr__",
           [](const ScoreResult& self) { return "<kerf.Score for " + std::to_string(self.pieces) + " pieces>"; });
  py::class_<Mesh, std::shared_ptr<Mesh>>(module.attr("Mesh"))
      .def("fracture", &fracture, py::arg("pieces") = geo::ScoreOptions{}.pieces, py::arg("pattern") = "voronoi",
           py::arg_v("progress", py::none()),
           "The pieces of the model broken by a pattern, a list of Piece in descending order of volume:\n"
           "crack(kerf.score(self, pattern, pieces=pieces)).pieces(). Keywords as for kerf.score(): seed, jagged and "
           "so on.\n"
           "Raises InputError where the mesh is no valid model, and as these.");
  module.attr("PATTERNS") =
      py::tuple(py::cast(std::vector<std::string>(geo::pattern_names.begin(), geo::pattern_names.end())));
  module.def(
      "score", &score, py::arg("model"), py::arg("pattern") = "voronoi", py::arg_v("progress", py::none()),
      "Tries patterns, coarser, finer and of other seeds, until one divides the model into as many pieces as wanted;\n"
      "else returns the nearest one, a Score (§ 7).\n\n"
      "model: a Solid, a Complex, or a Mesh that is a valid solid. pattern: one of kerf.PATTERNS. Keywords, with the\n"
      "defaults of the C++ structures: pieces=20, from 1 to 1000000; attempts=60; seed=1; depth=1, below 1 a partial\n"
      "score: how deep walls are cut in, as a fraction of their greatest depth.\n"
      "Fractal bumps: jagged=0, the amplitude, a fraction of the diagonal, 0: flat; frequency=8, bumps per "
      "diagonal;\n"
      "octaves=3; edge=0, the longest edge, a fraction of the diagonal, 0: 1 / (8 frequency).\n"
      "Pattern: axis, 'x', 'y', 'z' or three numbers (planes: normal; wood: grain; bricks: courses; radial, glass: "
      "axis;\n"
      "curves: extrusion); impact, three numbers, where cracks meet or cells are small; cluster=0.15, its radius, a\n"
      "fraction of the diagonal; grain=5, length to thickness of wood's cells. curves: lines (n, 3) or Front objects;\n"
      "sheets: meshes.\n"
      "progress: a callable of (phase, done, total), or a tqdm bar. Raises InputError for options out of range,\n"
      "Interrupted where progress stops it.");
}

}  // namespace kerf_python
