// Files of a run for other programs: nodes of frames, ParaView's series, USD.
#include <pybind11/stl.h>

#include "arguments.h"
#include "bind.h"
#include "kerf/error.h"
#include "kerf/export.h"
#include "kerf/files.h"
#include "nodes.h"
#include "progress.h"

namespace kerf_python {
namespace {

void write_frame_nodes(const Path& path, const NodeSet& nodes, py::object stress) {
  geo::FrameNodes frame{*nodes.nodes, numbers_from(stress, "stress")};
  if (frame.stress.size() != frame.nodes.size()) throw geo::InputError("stress: give one value per node");
  const GilRelease release;
  geo::write_all(path, [&](std::ostream& out) { geo::write_frame_nodes(out, frame); });
}

py::tuple read_frame_nodes(const Path& path) {
  geo::FrameNodes frame;
  {
    const GilRelease release;
    frame = geo::parse_frame_nodes(geo::read_all(path), path.text);
  }
  return py::make_tuple(NodeSet(std::move(frame.nodes)), moved<double>(std::move(frame.stress)));
}

void write_series(const Path& path, const std::vector<Path>& frames, double frame_rate) {
  if (!(frame_rate > 0 && frame_rate < 1e9)) throw geo::InputError("frame_rate: give a positive number");
  std::vector<std::string> names;
  for (const auto& frame : frames) names.push_back(frame.text);
  geo::write_all(path, [&](std::ostream& out) { geo::write_series(out, names, frame_rate); });
}

// The frames of an argument: meshes, paths, or both; none for None.
std::vector<std::shared_ptr<const Mesh>> frames_from(py::handle object, const char* name,
                                                     std::vector<std::string>& paths) {
  std::vector<std::shared_ptr<const Mesh>> out;
  if (object.is_none()) return out;
  for (const auto item : object) {
    const bool path = is_path(item);
    out.push_back(path ? nullptr : mesh_argument(item, name));
    paths.push_back(path ? path_from(item, name) : "");
  }
  return out;
}

void write_usd(const Path& path, py::object frames, double frame_rate, const std::string& up, py::object obstacles) {
  if (!(frame_rate > 0 && frame_rate < 1e9)) throw geo::InputError("frame_rate: give a positive number");
  if (up != "Y" && up != "Z") throw geo::InputError("up: give 'Y' or 'Z'");
  std::vector<std::string> paths[2];
  const auto surfaces = frames_from(frames, "frames", paths[0]), rigid = frames_from(obstacles, "obstacles", paths[1]);
  if (surfaces.empty()) throw geo::InputError("frames: give one at least");
  if (!rigid.empty() && rigid.size() != surfaces.size())
    throw geo::InputError("obstacles: give one for each frame, or none");
  for (const auto& mesh : rigid)
    if (mesh && rigid[0] && mesh->mesh.triangles != rigid[0]->mesh.triangles)
      throw geo::InputError("obstacles: have other triangles in some frames; give the same in all");
  geo::UsdRun run{surfaces.size(), frame_rate, up[0], {}, {}};
  run.surface = [&](std::size_t i) { return surfaces[i] ? surfaces[i]->mesh : geo::read_surface(paths[0][i]).mesh; };
  if (!rigid.empty())
    run.obstacles = [&](std::size_t i) { return rigid[i] ? rigid[i]->mesh : geo::read_surface(paths[1][i]).mesh; };
  const GilRelease release;
  geo::write_all(path, [&](std::ostream& out) { geo::write_usda(out, run); });
}

}  // namespace

void bind_run_files(py::module_& module) {
  module.def(
      "write_frame_nodes", &write_frame_nodes, py::arg("path"), py::arg("nodes"), py::arg("stress"),
      "Writes nodes of a frame with their stress, (n,), as PLY in single precision. Raises InputError, OutputError.");
  module.def("read_frame_nodes", &read_frame_nodes, py::arg("path"),
             "Reads nodes of a frame: NodeSet, and stress, (n,) float64, Pa. Raises InputError.");
  module.def("write_series", &write_series, py::arg("path"), py::arg("frames"), py::arg("frame_rate") = 24.0,
             "Writes a ParaView series (.ply.series) of paths of frames, relative to it. Raises OutputError.");
  module.def(
      "write_usd", &write_usd, py::arg("path"), py::arg("frames"), py::arg("frame_rate") = 24.0, py::arg("up") = "Z",
      py::arg("obstacles") = py::none(),
      "Writes a run as USD text. frames: deformed surfaces, each a Mesh or the path of one, metres. up: the vertical\n"
      "axis. obstacles: likewise, with the same triangles in all frames. Raises InputError, OutputError.");
}

}  // namespace kerf_python
