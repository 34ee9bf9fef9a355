// Names of files are numbered by frame; a folder that holds a run is refused without --resume.
#include "sim/run_folder.h"

#include <cstdio>
#include <ostream>

#include <kerf/error.h>
#include <kerf/files.h>

namespace sim {

namespace fs = std::filesystem;

namespace {

std::string numbered(const char* format, int i) {
  char name[64];
  std::snprintf(name, sizeof name, format, i);
  return name;
}

}  // namespace

std::string RunFolder::frame_name(int i) { return numbered("frames/frame_%04d.ply", i); }

std::string RunFolder::nodes(int i) const { return (nodes() / numbered("nodes_%04d.ply", i)).string(); }

std::string RunFolder::obstacles_name(int i) { return numbered("obstacles/obstacles_%04d.ply", i); }

void RunFolder::require_room(bool resume) const {
  std::error_code error;
  if (!fs::exists(path, error)) return;
  if (!fs::is_directory(path, error)) throw geo::OutputError(path.string() + ": is not a folder; give another name");
  if (fs::exists(frames(), error)) {
    if (resume) return;
    throw geo::OutputError(path.string() +
                           ": holds a run already; go on with --resume, remove it, or give another folder");
  }
  for (const auto& entry : fs::directory_iterator(path, error))
    if (const auto name = entry.path().filename().string(); name[0] != '.')
      throw geo::OutputError(path.string() + ": holds other files, as '" + name +
                             "'; give another folder, or empty it");
}

void RunFolder::make(bool with_obstacles) const {
  std::error_code error;
  fs::create_directories(frames(), error);
  if (!error) fs::create_directories(nodes(), error);
  if (!error && with_obstacles) fs::create_directories(obstacles(), error);
  if (error) throw geo::OutputError(path.string() + ": cannot be made (" + error.message() + ")");
}

void RunFolder::unmake() const {
  std::error_code ignored;
  fs::remove_all(frames(), ignored);
  fs::remove_all(nodes(), ignored);
  fs::remove_all(obstacles(), ignored);
  fs::remove(path, ignored);
}

void RunFolder::write_text(const fs::path& file, const std::string& text) const {
  geo::write_all(file.string(), [&](std::ostream& out) { out << text; });
}

std::string RunFolder::read_log(int count) const {
  if (count == 0) return "";
  const std::string all = geo::read_all(log().string());
  std::size_t end = 0;
  for (int i = 0; i < count && end != std::string::npos; ++i) end = all.find('\n', end ? end + 1 : 0);
  if (end == std::string::npos)
    throw geo::InputError(log().string() + ": has fewer lines than there are frames; begin the run anew");
  return all.substr(0, end + 1);
}

void RunFolder::require_space(double bytes) const {
  std::error_code error;
  fs::path there = fs::absolute(path);
  while (!fs::exists(there, error) && there.has_parent_path() && there != there.parent_path())
    there = there.parent_path();
  const auto space = fs::space(there, error);
  if (error || space.capacity == 0 || double(space.available) >= bytes) return;
  const auto megabytes = [](double b) { return std::to_string(static_cast<long long>(b / 1e6) + 1) + " MB"; };
  throw geo::OutputError(path.string() + ": the run needs about " + megabytes(bytes) + ", but " +
                         megabytes(double(space.available)) +
                         " are free; ask for fewer frames, or give another folder");
}

double bytes_of_frames(const geo::TriangleMesh& mesh, int frames) {
  return 1.5 * double(frames + 1) * (100.0 * double(mesh.vertices.size()) + 60.0 * double(mesh.triangles.size()));
}

}  // namespace sim
