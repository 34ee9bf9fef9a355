// The extension kerf._scan: surfaces of scans by PCL, loaded with the first call that needs it.
#include <chrono>
#include <mutex>

#include "../apart.h"
#include "../arguments.h"
#include "../arrays.h"
#include "../gil.h"
#include "../mesh.h"
#include "../progress.h"
#include "kerf/error.h"
#include "kerf/files.h"
#include "scan/module.h"

namespace kerf_python {
namespace {

// Rows as many as there are points; empty for None.
std::vector<geo::Vec3> rows_from(const py::object& given, const char* name, std::size_t points) {
  if (given.is_none()) return {};
  auto rows = points_from(given, name);
  if (rows.size() != points)
    throw geo::InputError(std::string(name) + ": has " + std::to_string(rows.size()) + " rows, but there are " +
                          std::to_string(points) + " points");
  return rows;
}

geo::PointCloud cloud_from(const py::object& points, const py::object& normals, const py::object& colors) {
  geo::PointCloud cloud;
  cloud.position = points_from(points, "points");
  cloud.normal = rows_from(normals, "normals", cloud.position.size());
  for (geo::Vec3& n : cloud.normal) {
    n.stableNormalize();
    if (!n.allFinite() || n.isZero()) throw geo::InputError("normals: one has no length; leave its point out");
  }
  for (const geo::Vec3& c : rows_from(colors, "colors", cloud.position.size()))
    cloud.color.emplace_back(geo::Color(c.x(), c.y(), c.z(), 1).array().max(0).min(1));
  return cloud;
}

// Waits until no other fit runs, as one is made at a time. A call that was stopped meanwhile throws
// Interrupted: the process need not wait for its fit at its end.
std::unique_lock<std::timed_mutex> turn_of_fit(const geo::Progress& progress) {
  static std::timed_mutex fitting;
  std::unique_lock lock(fitting, std::defer_lock);
  do geo::report(progress, "scan", 0, 1);
  while (!lock.try_lock_for(std::chrono::milliseconds(20)));
  geo::report(progress, "scan", 0, 1);
  return lock;
}

py::tuple reconstruct(const py::object& points, const py::object& normals, const py::object& colors, double outliers,
                      std::int64_t depth, py::object progress) {
  if (!(outliers >= 0 && outliers <= 1000)) throw geo::InputError("reconstruct: outliers must be from 0 to 1000");
  if (depth != 0 && (depth < 4 || depth > 12)) throw geo::InputError("reconstruct: depth must be from 4 to 12, or 0");
  const auto cloud = std::make_shared<geo::PointCloud>(cloud_from(points, normals, colors));
  const scan::Options options{outliers, static_cast<int>(depth)};
  ProgressReport report(std::move(progress));
  const auto result = report.run([&](const geo::Progress& progress) {
    return run_apart(progress, "scan", [cloud, options](const geo::Progress& own) {
      const std::unique_lock fit = turn_of_fit(own);
      auto made = std::make_shared<scan::Result>();
      std::string message;
      if (!kerf_scan_reconstruct(cloud.get(), &options, made.get(), &message))
        throw geo::InputError("reconstruct: " + message);
      return made;
    });
  });
  return py::make_tuple(std::make_shared<Mesh>(std::move(result->mesh)), result->stats.holes, result->stats.hole_share);
}

}  // namespace
}  // namespace kerf_python

PYBIND11_MODULE(_scan, module) {
  using namespace kerf_python;
  module.doc() = "Surfaces of scans; the package kerf loads this.";
  pybind11::module_::import("kerf._kerf");  // the classes of arguments and results
  module.def("reconstruct", &reconstruct, py::arg("points"), py::arg("normals"), py::arg("colors"), py::arg("outliers"),
             py::arg("depth"), py::arg("progress"));
  wait_for_threads_at_exit();
  stop_calls_at_exit();
}
