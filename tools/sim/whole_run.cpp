// Frames are read again from the folder, a few at a time, so memory does not grow with the run.
#include "sim/whole_run.h"

#include <vector>

#include <memory>

#include <kerf/export.h>
#include <kerf/files.h>

namespace sim {

char up_axis(const geo::Vec3& gravity) { return gravity.x() == 0 && gravity.z() == 0 && gravity.y() < 0 ? 'Y' : 'Z'; }

std::vector<std::string> write_whole_run(const RunFolder& folder, int last, double frame_rate, char up) {
  const bool obstacles = std::filesystem::exists(folder.obstacles(0));
  std::vector<std::vector<std::string>> parts(obstacles ? 2 : 1);
  for (int i = 0; i <= last; ++i) {
    parts[0].push_back(RunFolder::frame_name(i));
    if (obstacles) parts[1].push_back(RunFolder::obstacles_name(i));
  }
  for (std::size_t part = 0; part < parts.size(); ++part)
    geo::write_all((folder.path / (part == 0 ? "run.ply.series" : "obstacles.ply.series")).string(),
                   [&](std::ostream& out) { geo::write_series(out, parts[part], frame_rate); });
  const auto frames = [&](std::size_t part) {
    return [&, part](std::size_t i) { return geo::read_surface((folder.path / parts[part][i]).string()).mesh; };
  };
  geo::MaterialLibrary library;
  if (std::filesystem::exists(folder.materials()))
    library.glb = std::make_shared<const std::string>(geo::read_all(folder.materials().string()));
  geo::UsdRun usd{.frames = parts[0].size(), .frame_rate = frame_rate, .up = up, .surface = frames(0), .obstacles = {}};
  usd.surface = [&, read = frames(0)](std::size_t i) {
    geo::TriangleMesh mesh = read(i);
    mesh.attributes.library = library;
    return mesh;
  };
  if (obstacles) usd.obstacles = frames(1);
  const geo::ImageFiles images = geo::image_files(library, "run_");
  for (const geo::BesideFile& image : images.images) geo::write_beside(folder.path.string(), image);
  geo::write_all((folder.path / "run.usda").string(), [&](std::ostream& out) { geo::write_usda(out, usd); });
  return images.left_out;
}

}  // namespace sim
