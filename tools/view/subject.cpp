// The kind of each file is recognised by its content. Bodies bring their surface, nodes and graph.
#include "view/subject.h"

#include <algorithm>
#include <filesystem>

#include <kerf/body_file.h>
#include <kerf/error.h>
#include <kerf/files.h>
#include "kind.h"
#include "run_materials.h"
#include "tool.h"

namespace view {
namespace {

namespace fs = std::filesystem;

// A body, or a checkpoint: a body with its motion.
void add_body(Subject& subject, geo::Input input) {
  const geo::KerfFile file(std::move(input));
  if (file.sections().count("run/displacement") > 0) {
    auto checkpoint = geo::read_checkpoint(file);
    subject.body = std::move(checkpoint.body);
    subject.motion = std::move(checkpoint.state.motion);
    subject.frame = checkpoint.state.frame;
  } else {
    subject.body = geo::read_body(file);
  }
  subject.surface = subject.body->surface.two_sided(&subject.row_of);
  subject.nodes = subject.body->nodes;
}

// The obstacles of frames/frame_0007.ply are in obstacles/obstacles_0007.ply; empty where there is
// no such file.
std::string obstacles_of(const fs::path& frame) {
  const std::string name = frame.filename().string(), begin = "frame_";
  if (!name.starts_with(begin)) return {};
  const fs::path beside = frame.parent_path().parent_path() / "obstacles" / ("obstacles_" + name.substr(begin.size()));
  return fs::exists(beside) ? beside.string() : std::string();
}

void add(Subject& subject, const std::string& path) {
  const std::string bytes = geo::read_all(path);
  const auto refuse = [&](const char* what) {
    throw geo::InputError(path + ": is a second file with " + what + "; give one of them");
  };
  switch (tool::kind_of(bytes, path)) {
    case tool::Kind::body:
      if (subject.nodes.size() > 0) refuse("nodes");
      if (!subject.surface.triangles.empty()) refuse("a surface");
      add_body(subject, geo::Input(bytes, path));
      break;
    case tool::Kind::nodes:
      if (subject.nodes.size() > 0) refuse("nodes");
      subject.nodes = geo::parse_nodes(bytes, path);
      break;
    case tool::Kind::fronts: {
      geo::TriangleMesh sheets;  // drawn like cracks
      for (auto& front : geo::parse_fronts(bytes, path)) {
        if (!front.is_sheet()) {
          subject.fronts.push_back(std::move(front));
          continue;
        }
        const auto first = static_cast<std::uint32_t>(sheets.vertices.size());
        sheets.vertices.insert(sheets.vertices.end(), front.steps[0].begin(), front.steps[0].end());
        for (const auto& [a, b, c] : front.triangles) sheets.triangles.push_back({first + a, first + b, first + c});
      }
      if (sheets.triangles.empty()) break;
      if (!subject.surface.triangles.empty()) refuse("a surface");
      sheets.patch.assign(sheets.triangles.size(), 1);
      subject.surface = std::move(sheets);
      break;
    }
    case tool::Kind::surface:
      if (!subject.surface.triangles.empty()) refuse("a surface");
      subject.surface = tool::parse_surface(bytes, path).mesh;
      tool::add_run_materials(subject.surface, path);
      if (const auto beside = obstacles_of(path); !beside.empty()) subject.obstacles = geo::read_surface(beside).mesh;
      break;
  }
}

}  // namespace

Subject read_subject(const std::vector<std::string>& paths) {
  Subject subject;
  for (const auto& path : paths) {
    add(subject, path);
    subject.title += (subject.title.empty() ? "" : ", ") + fs::path(path).filename().string();
  }
  return subject;
}

namespace {

std::vector<std::string> ply_files(const fs::path& folder) {
  std::vector<std::string> paths;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".ply") paths.push_back(entry.path().string());
  std::sort(paths.begin(), paths.end());
  return paths;
}

}  // namespace

Run find_run(const std::string& folder) {
  Run run;
  const fs::path top(folder);
  run.frames = ply_files(fs::is_directory(top / "frames") ? top / "frames" : top);
  if (fs::is_directory(top / "nodes")) run.nodes = ply_files(top / "nodes");
  run.nodes.resize(
      run.nodes.size() < run.frames.size() ? 0 : run.frames.size());  // a run that was stopped may have one more
  if (run.frames.empty()) throw geo::InputError(folder + ": holds no frames; give the folder that kerf-sim wrote");
  if (fs::exists(top / "checkpoint.kerf")) run.body = (top / "checkpoint.kerf").string();
  if (const fs::path usd = top / "run.usda"; fs::exists(usd)) {
    const geo::Input input(usd.string());
    run.y_up = input.text(0, std::min<std::uint64_t>(input.size(), 256)).find("upAxis = \"Y\"") != std::string::npos;
  }
  run.title = fs::absolute(top).lexically_normal().filename().string();
  if (run.title.empty()) run.title = fs::absolute(top).lexically_normal().parent_path().filename().string();
  return run;
}

Subject read_checkpoint(const Run& run) {
  Subject subject;
  if (!run.body.empty()) add_body(subject, geo::Input(run.body));
  return subject;
}

std::vector<geo::TriangleMesh> read_obstacles(const Run& run) {
  std::vector<geo::TriangleMesh> frames;
  for (const auto& path : run.frames) {
    const auto beside = obstacles_of(path);
    if (beside.empty()) return {};
    frames.push_back(geo::read_surface(beside).mesh);
    if (frames.back().triangles != frames[0].triangles)
      throw geo::InputError(beside + ": its triangles are not those of the frames before; run kerf-sim again");
  }
  return frames;
}

}  // namespace view
