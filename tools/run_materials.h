// The materials of a run, which are beside its frames in one file.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <system_error>

#include <kerf/files.h>
#include <kerf/mesh.h>

namespace tool {

/// The name of that file in the folder of a run, a .glb as geo::MaterialLibrary has it. Each frame
/// would hold all images otherwise.
inline constexpr const char* run_materials = "materials.glb";

/// Gives the frame of a run, "RUN/frames/frame_0007.ply", the run's materials, where it has some.
inline void add_run_materials(geo::TriangleMesh& mesh, const std::string& path) {
  const std::filesystem::path frame = std::filesystem::absolute(path);
  if (mesh.attributes.library.glb || !frame.filename().string().starts_with("frame_")) return;
  const std::filesystem::path beside = frame.parent_path().parent_path() / run_materials;
  std::error_code error;
  if (frame.parent_path().filename() != "frames" || !std::filesystem::exists(beside, error)) return;
  mesh.attributes.library.glb = std::make_shared<const std::string>(geo::read_all(beside.string()));
}

}  // namespace tool
