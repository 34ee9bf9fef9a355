// OpenVDB volumes as surfaces and back, and the wrapping of surfaces.
#include "../apart.h"
#include "../arguments.h"
#include "../busy.h"
#include "../mesh.h"
#include "../progress.h"
#include "formats.h"
#include "kerf/check.h"
#include "kerf/error.h"
#include "kerf/files.h"
#include "kerf/repair.h"

namespace kerf_python {
namespace {

std::shared_ptr<Solid> read_volume(const Path& path, const std::string& grid, const py::object& iso,
                                   double adaptivity) {
  geo::VolumeOptions options{grid, {}, adaptivity};
  if (!(adaptivity >= 0 && adaptivity <= 1)) throw geo::InputError("read_volume: adaptivity must be from 0 to 1");
  if (!iso.is_none()) {
    options.iso = iso.cast<double>();
    if (!(std::abs(*options.iso) <= geo::largest_coordinate)) throw geo::InputError("read_volume: iso must be finite");
  }
  return without_gil([&] {
    auto mesh = geo::read_volume(path.text, options);
    try {
      geo::require_solid(mesh);
    } catch (const geo::InputError& e) {
      throw geo::InputError(path.text + ": the surface at this level is no solid: " + e.what() +
                            "; choose another iso, adaptivity 0 or smaller voxels");
    }
    return std::make_shared<Solid>(std::move(mesh), true);
  });
}

// A voxel that leaves at most two thousand of them along the diagonal, as the tools do.
void require_voxel(const geo::TriangleMesh& mesh, double voxel) {
  const double diagonal = geo::bounding_box(mesh).diagonal();
  if (!(diagonal > 0)) throw geo::InputError("voxel: the mesh has no extent");
  if (!(voxel >= 0.0005 * diagonal && voxel <= 0.1 * diagonal))
    throw geo::InputError("voxel: give 0.0005 to 0.1 of the diagonal, here " + std::to_string(0.0005 * diagonal) +
                          " to " + std::to_string(0.1 * diagonal));
}

std::shared_ptr<Mesh> wrapped(const std::shared_ptr<Mesh>& mesh, double voxel, py::object progress) {
  require_voxel(mesh->mesh, voxel);
  ProgressReport report(std::move(progress));
  return report.run([&](const geo::Progress& progress) {
    return run_apart(progress, "wrap", [mesh, voxel](const geo::Progress& own) {
      return std::make_shared<Mesh>(geo::wrapped(mesh->mesh, voxel, geo::OpenParts::by_area, own));
    });
  });
}

std::shared_ptr<Mesh> wrapped_solid(const std::shared_ptr<Mesh>& mesh, double voxel, double weld, bool smooth,
                                    int inner, int open, py::object progress) {
  require_voxel(mesh->mesh, voxel);
  const geo::RepairOptions options{weld, smooth, static_cast<geo::InnerShells>(inner)};
  ProgressReport report(std::move(progress));
  return report.run([&](const geo::Progress& progress) {
    return run_apart(progress, "wrap", [mesh, voxel, options, open](const geo::Progress& own) {
      return std::make_shared<Mesh>(
          geo::wrapped_solid(mesh->mesh, voxel, options, static_cast<geo::OpenParts>(open), nullptr, own));
    });
  });
}

void write_level_set(const Path& path, const std::shared_ptr<Mesh>& mesh, double voxel, bool fog) {
  require_voxel(mesh->mesh, voxel);
  without_gil([&] { geo::write_level_set(path.text, mesh->mesh, voxel, fog); });
}

}  // namespace

void bind_volumes(py::module_& module) {
  module.def("read_volume", &read_volume, py::arg("path"), py::arg("grid"), py::arg("iso"), py::arg("adaptivity"));
  module.def("wrapped", &wrapped, py::arg("mesh"), py::arg("voxel"), py::arg("progress"));
  module.def("wrapped_solid", &wrapped_solid, py::arg("mesh"), py::arg("voxel"), py::arg("weld"), py::arg("smooth"),
             py::arg("inner"), py::arg("open"), py::arg("progress"));
  module.def("write_level_set", &write_level_set, py::arg("path"), py::arg("mesh"), py::arg("voxel"), py::arg("fog"));
}

}  // namespace kerf_python
