// Scores (§ 7): options are keywords with the names of the library's structures; `jagged` is the
// amplitude, `seed` that of pattern and jaggedness.
#include "score.h"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <exception>

#include "apart.h"
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

// The number that a callable of the argument density returned. Throws InputError for anything else.
double density_value(const py::object& value) {
  const double number = PyFloat_AsDouble(value.ptr());
  if (!PyErr_Occurred()) return number;
  if (!PyErr_ExceptionMatches(PyExc_TypeError) && !PyErr_ExceptionMatches(PyExc_ValueError))
    throw py::error_already_set();
  PyErr_Clear();
  throw geo::InputError("density: the callable returned " + py::repr(value).cast<std::string>().substr(0, 60) +
                        "; let it return one number, at least 0");
}

// A Python callable of a point. Its first error ends the search, and is rethrown there.
struct PythonDensity {
  py::object callable;
  std::exception_ptr error;

  double operator()(const geo::Vec3& p) {
    const GilAcquire gil;
    try {
      return density_value(callable(point(p)));
    } catch (...) {
      error = std::current_exception();
    }
    throw geo::Interrupted();
  }
};

// The mesh whose vertices paint the density.
std::shared_ptr<Mesh> painted_mesh(py::handle model) {
  if (!py::isinstance<Complex>(model)) return mesh_argument(model, "model");
  const auto mesh = model.cast<std::shared_ptr<Complex>>()->model;
  if (!mesh) throw geo::InputError("density: the complex knows no model with colours; give a callable of a point");
  return mesh;
}

// A channel of the model's colours, a value for each vertex, or a callable, which `python` keeps.
geo::Density density_from(const py::object& density, py::handle model, PythonDensity& python) {
  if (density.is_none()) return {};
  if (PyCallable_Check(density.ptr())) {
    python.callable = density;
    return [&python](const geo::Vec3& p) { return python(p); };
  }
  if (!py::isinstance<py::str>(density))
    return geo::painted_density(painted_mesh(model)->mesh, numbers_from(density, "density"));
  constexpr std::array channels{"red", "green", "blue", "alpha", "luminance"};
  const auto found = std::find(channels.begin(), channels.end(), density.cast<std::string>());
  if (found == channels.end())
    throw geo::InputError(
        "density: '" + density.cast<std::string>() +
        "' is not red, green, blue, alpha or luminance; or give a value for each vertex, or a callable");
  return geo::painted_density(painted_mesh(model)->mesh, static_cast<geo::ColorChannel>(found - channels.begin()));
}

// Brightness from a (height, width) array: floats from 0 to 1, booleans, or integers up to 255.
geo::GrayImage image_from(const py::object& image) {
  const auto array = py::array::ensure(image);
  if (!array || array.ndim() != 2)
    throw geo::InputError(
        "image: give brightness as a (height, width) array; of colours, their mean over the last axis");
  const char kind = array.dtype().kind();
  const py::object numbers = kind == 'b' ? array.attr("astype")("float64") : py::object(array);
  const auto [shape, values] = values_from(numbers, "image", 2, 2);
  const double white = kind == 'u' || kind == 'i' ? 255 : 1;
  geo::GrayImage gray{.width = static_cast<int>(shape[1]), .height = static_cast<int>(shape[0]), .brightness = {}};
  for (const double v : values) gray.brightness.push_back(static_cast<float>(v / white));
  return gray;
}

// The outlines of the argument `image`, where it is given.
void add_image(Keywords& keywords, const geo::Box3& box, geo::ScoreOptions& o) {
  geo::CutOutOptions cut;
  const auto image = keywords.object("image"), up = keywords.object("up"), fit = keywords.object("fit");
  keywords.take("tolerance", cut.tolerance, 0, 1000);
  if (o.pattern.axis) cut.axis = *o.pattern.axis;
  if (!up.is_none()) cut.up = axis_from(up);
  if (!fit.is_none()) {
    const auto name = fit.cast<std::string>();
    if (name != "inside" && name != "stretched")
      throw geo::InputError("fit: '" + name + "' is not inside or stretched");
    cut.fit = name == "inside" ? geo::ImageFit::inside : geo::ImageFit::stretched;
  }
  if (image.is_none()) return;
  geo::CutOut made = geo::cut_out(image_from(image), box, cut);
  for (auto& curve : made.curves) o.pattern.curves.push_back(std::move(curve));
  if (made.spots == 0) return;
  const std::string text = "image: left out: " + std::to_string(made.spots) + " spots smaller than 4 pixels";
  if (PyErr_WarnEx(PyExc_UserWarning, text.c_str(), 1) != 0) throw py::error_already_set();
}

geo::ScoreOptions options_from(const std::string& pattern, Keywords& keywords, const geo::Box3& box) {
  geo::ScoreOptions o;
  o.pattern.pattern = geo::pattern_named(pattern);
  keywords.require("edge_width", "edge_detail");
  keywords.require("chip_size", "chips");
  for (const char* of_image : {"up", "fit", "tolerance"}) keywords.require(of_image, "image");
  keywords.take("pieces", o.pieces, 1, 1000000);
  keywords.take("attempts", o.attempts, 1, 1000000);
  keywords.take("depth", o.depth, 0, 1);
  keywords.take("jagged", o.jagged.amplitude, 0, 1);
  keywords.take("frequency", o.jagged.frequency, 0, 1e4);
  keywords.take("octaves", o.jagged.octaves, 1, 16);
  keywords.take("edge", o.jagged.edge, 0, 1);
  if (o.jagged.edge > 0 && o.jagged.edge < 1e-4) throw geo::InputError("score: edge must be 0 or at least 1e-4");
  keywords.take("edge_detail", o.jagged.edge_amplitude, 0, 1);
  keywords.take("edge_width", o.jagged.edge_width, 1e-3, 1);
  keywords.take("chips", o.chips.count, 0, 100000);
  keywords.take("chip_size", o.chips.size, 0, 1);
  keywords.take("cluster", o.pattern.cluster, 0, 10);
  keywords.take("grain", o.pattern.grain, 1, 1000);
  keywords.seed("seed", o.pattern.seed);
  o.jagged.seed = o.pattern.seed;
  if (const auto axis = keywords.object("axis"); !axis.is_none()) o.pattern.axis = axis_from(axis);
  if (o.pattern.axis && !(o.pattern.axis->norm() > 0)) throw geo::InputError("axis: has no length");
  if (const auto impact = keywords.object("impact"); !impact.is_none()) o.pattern.impact = point_from(impact, "impact");
  if (const auto curves = keywords.object("curves"); !curves.is_none()) o.pattern.curves = curves_from(curves);
  if (const auto sheets = keywords.object("sheets"); !sheets.is_none()) o.pattern.sheets = sheets_from(sheets);
  const bool curves = o.pattern.pattern == geo::Pattern::curves;
  if (!curves && (!o.pattern.curves.empty() || keywords.given("image")))
    throw geo::InputError("score: the arguments curves and image go with pattern='curves'; give that");
  add_image(keywords, box, o);
  if (curves && o.pattern.curves.empty())
    throw geo::InputError("score: the pattern 'curves' needs the argument curves or image");
  if ((o.pattern.pattern == geo::Pattern::sheets) == o.pattern.sheets.empty())
    throw geo::InputError("score: the pattern 'sheets' and the argument sheets go together");
  return o;
}

// A score with the model cut along it, which is empty where it was not wanted.
struct Scored {
  geo::Score score;
  geo::Complex cut;
};

// Whether the model is to be cut, too.
enum class AlsoCut { no, yes };

// Makes the score, with the options of a call. A thread of its own holds a complex that never
// changes, and calls nothing of Python.
Scored scored(const ModelReading& reading, const geo::ScoreOptions& options, bool calls_python, AlsoCut also,
              ProgressReport& report) {
  const auto uncut = reading.uncut();
  const auto work = [uncut, complex = &reading.complex(), options, also](const geo::Progress& progress) {
    Scored out;
    out.score = geo::make_score(*complex, options, progress, also == AlsoCut::yes ? &out.cut : nullptr);
    return out;
  };
  return report.run([&](const geo::Progress& progress) {
    return uncut && !calls_python ? run_apart(progress, "score", work) : work(progress);
  });
}

// The score of a model, and, where `cut` is given, the model cut along it.
std::shared_ptr<ScoreResult> make(const ModelReading& reading, py::handle model, const std::string& pattern,
                                  ProgressReport& report, py::kwargs given, geo::Complex* cut = nullptr) {
  Keywords keywords(std::move(given), "score");
  PythonDensity python;
  const auto density = keywords.object("density");
  auto options = options_from(pattern, keywords, reading.complex().extent());
  keywords.finish();
  options.pattern.density = density_from(density, model, python);
  if (options.pattern.density && options.pattern.pattern != geo::Pattern::voronoi &&
      options.pattern.pattern != geo::Pattern::wood)
    throw geo::InputError("density: goes with the patterns voronoi and wood");
  geo::Score made;
  try {
    const bool calls_python = static_cast<bool>(python.callable);
    Scored out = scored(reading, options, calls_python, cut ? AlsoCut::yes : AlsoCut::no, report);
    made = std::move(out.score);
    if (cut) *cut = std::move(out.cut);
  } catch (const geo::Interrupted&) {
    if (python.error) std::rethrow_exception(python.error);
    throw;
  }
  return std::make_shared<ScoreResult>(ScoreResult{.sheet = std::make_shared<Mesh>(std::move(made.sheet)),
                                                   .pieces = made.pieces,
                                                   .chips = made.chips,
                                                   .attempts = made.attempts});
}

std::shared_ptr<ScoreResult> score(const py::object& model, const std::string& pattern, py::object progress,
                                   py::kwargs given) {
  ProgressReport report(std::move(progress));
  const ModelReading reading(model, "model");
  return make(reading, model, pattern, report, std::move(given));
}

py::object fracture(const std::shared_ptr<Mesh>& self, const py::object& pieces, const std::string& pattern,
                    const py::object& progress, py::kwargs given) {
  given["pieces"] = pieces;
  ProgressReport report(progress);
  const auto model = model_of(self);
  const ModelReading reading(py::cast(model), "model");
  geo::Complex cut;
  make(reading, py::cast(self), pattern, report, std::move(given), &cut);
  const auto made = std::make_shared<Complex>(std::move(cut), model);
  return py::cast(made).attr("pieces")(py::arg("progress") = progress);
}

}  // namespace

void bind_score(py::module_& module) {
  py::class_<ScoreResult, std::shared_ptr<ScoreResult>>(
      module, "Score", "The walls of a fracture pattern as one sheet that divides a model (§ 7, Fig. 7).")
      .def_property_readonly(
          "sheet", [](const ScoreResult& self) { return self.sheet; },
          "The walls, a Mesh; walls that meet share vertices.")
      .def_readonly("pieces", &ScoreResult::pieces,
                    "Pieces into which a score of full depth divides the model, without chips.")
      .def_readonly("chips", &ScoreResult::chips, "Chips that break off these, pieces of their own.")
      .def_readonly("attempts", &ScoreResult::attempts, "Number of patterns that were tried.")
      .def("__repr__",
           [](const ScoreResult& self) { return "<kerf.Score for " + std::to_string(self.pieces) + " pieces>"; });
  py::class_<Mesh, std::shared_ptr<Mesh>>(module.attr("Mesh"))
      .def("fracture", &fracture, py::arg("pieces") = geo::ScoreOptions{}.pieces, py::arg("pattern") = "voronoi",
           py::arg_v("progress", py::none()),
           "The pieces of the model broken by a pattern, a list of Piece in descending order of volume:\n"
           "those of crack(kerf.score(self, pattern, pieces=pieces)).pieces(), found faster. Keywords as for "
           "kerf.score(): seed, jagged and "
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
      "density (voronoi, wood): where cells are many, 'red', 'green', 'blue', 'alpha' or 'luminance' of the model's\n"
      "colours, a value for each vertex, or a callable of a point (3,), at least 0.\n"
      "image (curves): brightness (height, width), floats up to 1, booleans or integers up to 255; the borders of\n"
      "black areas are swept along axis. up: what is up in it, y for the axis z, else z; fit='inside' the model's "
      "box,\n"
      "or 'stretched' to it; tolerance=0.5 pixels.\n"
      "Edges: edge_detail=0, height of finer bumps near the skin, a fraction of the diagonal; edge_width=0.03, their\n"
      "depth; chips=0 small pieces that break off edges; chip_size=0.25, their length, a fraction of the cube root of\n"
      "the mean piece's volume.\n"
      "progress: a callable of (phase, done, total), or a tqdm bar. Raises InputError for options out of range,\n"
      "Interrupted where progress stops it.");
}

}  // namespace kerf_python
