// Local edits of a whole complex: remeshing, roughening, decimation. Contacts of its fronts are
// kept.
#include "kerf/crack.h"

#include <pybind11/stl.h>

#include <exception>
#include <numeric>

#include "bind.h"
#include "complex.h"
#include "kerf/error.h"
#include "keywords.h"
#include "progress.h"

namespace kerf_python {
namespace {

// A Python callable that allows an edit. Its first error refuses all later edits, and is rethrown
// at the end.
struct MaySweep {
  py::object callable;
  std::exception_ptr error;

  bool operator()(const std::array<geo::Vec3, 4>& corners) {
    if (error) return false;
    const GilAcquire gil;
    try {
      return py::bool_(callable(moved_points(std::vector<geo::Vec3>(corners.begin(), corners.end()))));
    } catch (py::error_already_set&) {
      error = std::current_exception();
    }
    return false;
  }
};

// An edit of the whole complex, which progress and Ctrl-C may stop: it is then as before.
template <class Edit>
std::shared_ptr<Delta> edit_all(Complex& self, py::object progress, const Edit& edit) {
  ProgressReport report(std::move(progress));
  const Writing writing(self.busy);
  return self.edit_held(self.fronts, false, [&] { return report.run(edit); });
}

std::shared_ptr<Delta> remesh(Complex& self, const py::object& region, py::object may_sweep, py::object progress,
                              py::kwargs given) {
  geo::RemeshOptions options;
  Keywords keywords(std::move(given), "remesh");
  keywords.take("angle", options.angle, 0, 30);
  keywords.take("deviation", options.deviation, 0, 1);
  keywords.take("shortest", options.shortest, 1e-9, 1);
  keywords.take("crease", options.crease, 0, 180);
  keywords.finish();
  if (!may_sweep.is_none() && !PyCallable_Check(may_sweep.ptr()))
    throw py::type_error("remesh: may_sweep must be a callable of (4, 3) corners");
  std::vector<geo::FaceId> faces(self.complex.face_count());
  for (std::uint32_t f = 0; f < faces.size(); ++f) faces[f] = geo::FaceId(f);
  if (!region.is_none()) faces = ids_from<geo::FaceId>(region, "region", self.complex.face_count());
  MaySweep test{std::move(may_sweep), nullptr};
  if (!test.callable.is_none())
    options.may_sweep = [&test](const std::array<geo::Vec3, 4>& corners) { return test(corners); };
  geo::RemeshStats done;
  auto delta = edit_all(self, std::move(progress), [&](const geo::Progress& report) {
    return geo::remesh(self.complex, faces, self.states(), options, &done, report);
  });
  if (test.error) std::rethrow_exception(test.error);
  auto& stats = delta->stats;
  stats["faces"] = done.faces;
  stats["flips"] = done.flips;
  stats["collapses"] = done.collapses;
  stats["moves"] = done.moves;
  stats["divisions"] = done.divisions;
  stats["refused"] = done.refused;
  stats["seconds"] = done.seconds;
  return delta;
}

std::shared_ptr<Delta> roughen(Complex& self, py::object progress, py::kwargs given) {
  geo::RoughenOptions options;
  Keywords keywords(std::move(given), "roughen");
  keywords.take("amplitude", options.amplitude, 0, 1);
  keywords.take("frequency", options.frequency, 0, 1e4);
  keywords.take("octaves", options.octaves, 1, 16);
  keywords.take("edge", options.edge, 0, 1);
  keywords.seed("seed", options.seed);
  const auto cracks = keywords.object("cracks");
  keywords.finish();
  if (options.edge > 0 && options.edge < 1e-4) throw geo::InputError("roughen: edge must be 0 or at least 1e-4");
  if (!cracks.is_none())
    for (const auto c : integers_from(cracks, "cracks", 1, self.complex.crack_count()))
      options.cracks.push_back(static_cast<std::int32_t>(c));
  geo::RoughenStats done;
  auto delta = edit_all(self, std::move(progress), [&](const geo::Progress& report) {
    return geo::roughen(self.complex, self.states(), options, &done, report);
  });
  auto& stats = delta->stats;
  stats["divisions"] = done.divisions;
  stats["moves"] = done.moves;
  stats["lowered"] = done.lowered;
  stats["refused"] = done.refused;
  stats["seconds"] = done.seconds;
  return delta;
}

std::shared_ptr<Delta> decimate(Complex& self, py::object progress, py::kwargs given) {
  geo::DecimateOptions options;
  Keywords keywords(std::move(given), "decimate");
  keywords.take("deviation", options.deviation, 0, 1);
  keywords.take("faces", options.faces, 0, std::int64_t(1) << 32);
  keywords.take("crease", options.crease, 0, 180);
  keywords.take("angle", options.angle, 0, 60);
  keywords.finish();
  geo::DecimateStats done;
  auto delta = edit_all(self, std::move(progress), [&](const geo::Progress& report) {
    return geo::decimate(self.complex, self.states(), options, &done, report);
  });
  auto& stats = delta->stats;
  stats["collapses"] = done.collapses;
  stats["refused"] = done.refused;
  stats["seconds"] = done.seconds;
  return delta;
}

}  // namespace

void bind_crack_edits(py::module_& module) {
  py::class_<Complex, std::shared_ptr<Complex>>(module.attr("Complex"))
      .def(
          "remesh", &remesh, py::arg_v("region", py::none()), py::arg_v("may_sweep", py::none()),
          py::arg_v("progress", py::none()),
          "Improves faces by flips, collapses, moves and divisions; returns the CrackDelta, with counts in its stats.\n"
          "Kept are the skin's surface, lines where cracks meet each other and the skin, tips, creases, and contacts "
          "of\n"
          "fronts (§ 5.2).\n\n"
          "region: (k,) ids of faces, by default all. Keywords: angle=15 degrees, faces with a smaller angle are\n"
          "improved; deviation=1e-4, how far a crack may move in one edit, and shortest=2e-3, no edge is divided into\n"
          "shorter ones, fractions of the diagonal; crease=20 degrees. may_sweep: a callable of (4, 3) corners that\n"
          "refuses an edit sweeping that tetrahedron by returning False. progress: as elsewhere; a stop leaves the "
          "complex\n"
          "as it was. Raises InputError for options out of range, Interrupted.")
      .def(
          "roughen", &roughen, py::arg_v("progress", py::none()),
          "Divides the inner edges of cracks and displaces their inner vertices along the normal by fractal noise;\n"
          "returns the CrackDelta, with counts in its stats. The noise fades towards skin, other cracks and tips. The\n"
          "pieces' volumes keep their sum (§ 8).\n\n"
          "Keywords: amplitude=0.01, a fraction of the diagonal; frequency=8, bumps per diagonal; octaves=4; edge=0,\n"
          "longest edge inside a crack, a fraction of the diagonal, 0: 1 / (12 frequency); seed=1; cracks, their\n"
          "numbers, by default all. progress: a stop leaves the complex as it was. Raises InputError for options out "
          "of\n"
          "range, Interrupted.")
      .def("decimate", &decimate, py::arg_v("progress", py::none()),
           "Collapses edges of skin and cracks, the shortest first; returns the CrackDelta, with counts in its stats.\n"
           "Lines where surfaces meet, tips and creases stay lines. Volumes change within the deviation.\n\n"
           "Keywords: deviation=1e-3, how far the surface may move, a fraction of the diagonal; faces=0, no fewer "
           "living\n"
           "faces than this; crease=30 degrees; angle=5 degrees, no face gets a smaller one unless it had one. \n"
           "progress: a stop leaves the complex as it was. Raises InputError for options out of range, Interrupted.");
}

}  // namespace kerf_python
