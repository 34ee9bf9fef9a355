// Pieces have material coordinates. A deformed frame takes them from the checkpoint of its run.
#include "pieces/subject.h"

#include <filesystem>

#include <kerf/body_file.h>
#include "model.h"
#include "run_materials.h"
#include "tool.h"

namespace pieces {
namespace {

namespace fs = std::filesystem;

// True where copies of one vertex have different positions.
bool is_deformed(const geo::TriangleMesh& mesh) {
  std::vector<const geo::Vec3*> at;
  for (std::size_t v = 0; v < mesh.site.size(); ++v) {
    const auto site = mesh.site[v];
    if (site > 64 * mesh.vertices.size()) return false;  // no frame: reading it reports the fault
    if (site >= at.size()) at.resize(site + 1);
    if (at[site] && *at[site] != mesh.vertices[v]) return true;
    at[site] = &mesh.vertices[v];
  }
  return false;
}

// Undeformed positions of a frame's vertices, from the last body of its run. Runs add vertices to a
// body and move none.
std::vector<geo::Vec3> material_points(const geo::TriangleMesh& frame, const std::string& path) {
  const fs::path checkpoint = fs::absolute(path).parent_path().parent_path() / "checkpoint.kerf";
  std::error_code error;
  if (path == "-" || !fs::exists(checkpoint, error))
    throw geo::InputError(path +
                          ": is deformed, and no frame in the folder of its run, whose checkpoint.kerf says where it "
                          "was; give the undeformed surface");
  const geo::Complex surface = geo::read_body(checkpoint.string()).surface;
  std::vector<geo::Vec3> points;
  for (const auto site : frame.site) {
    if (site >= surface.vertex_count() || surface.faces_at(geo::VertexId(site)).empty())
      throw geo::InputError(path +
                            ": was cut after its run's checkpoint.kerf was written, or is of another run; bring the "
                            "run to its end with kerf-sim --resume");
    points.push_back(surface.point(geo::VertexId(site)));
  }
  return points;
}

// The last frame of a run's folder; any other path as it is.
std::string file_of(const std::string& path) {
  std::error_code error;
  std::string last;
  if (!fs::is_directory(path, error)) return path;
  for (const auto& entry : fs::directory_iterator(fs::path(path) / "frames", error))
    if (entry.path().extension() == ".ply") last = std::max(last, entry.path().string());
  if (last.empty()) throw geo::InputError(path + ": is a folder without frames of a run; give a file");
  return last;
}

}  // namespace

Subject read_subject(const std::string& given, bool repair, const tool::Say& say) {
  const std::string path = file_of(given);
  const std::string bytes = geo::read_all(path);
  Subject subject;
  if (geo::looks_like_kerf(bytes)) {
    subject.complex = geo::parse_body(bytes, path).surface;  // bodies have no attributes
    return subject;
  }
  geo::SurfaceFile file = tool::parse_surface(bytes, path);
  tool::add_run_materials(file.mesh, path);
  if (is_deformed(file.mesh)) {
    subject.moved = material_points(file.mesh, path);
    subject.moved.swap(file.mesh.vertices);
  }
  if (repair && !file.mesh.two_sided())
    tool::repair_plain(file.mesh, path, say);
  else
    tool::require_solid(file.mesh, path, bytes);
  subject.complex = tool::complex_of(file, path);
  subject.mesh = std::move(file.mesh);
  return subject;
}

}  // namespace pieces
