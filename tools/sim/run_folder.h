// The folder of a run: the paths in it, and checks before a run begins.
#pragma once

#include <filesystem>
#include <string>

#include <kerf/mesh.h>
#include "run_materials.h"

namespace sim {

struct RunFolder {
  std::filesystem::path path;
  std::filesystem::path frames() const { return path / "frames"; }
  std::filesystem::path nodes() const { return path / "nodes"; }
  std::filesystem::path checkpoint() const { return path / "checkpoint.kerf"; }
  std::filesystem::path materials() const { return path / tool::run_materials; }
  std::filesystem::path log() const { return path / "frames.jsonl"; }
  /// "frames/frame_0007.ply", relative to the folder.
  static std::string frame_name(int i);
  std::string frame(int i) const { return (path / frame_name(i)).string(); }
  std::string nodes(int i) const;
  std::filesystem::path obstacles() const { return path / "obstacles"; }
  static std::string obstacles_name(int i);
  std::string obstacles(int i) const { return (path / obstacles_name(i)).string(); }

  /// Throws OutputError unless the folder is new, or empty but for hidden files. With `resume` it
  /// may hold a run.
  void require_room(bool resume) const;
  /// Creates the folder and those in it, one for obstacles on demand. Throws OutputError.
  void make(bool with_obstacles) const;
  /// Removes what make() has created, where the run could not begin.
  void unmake() const;
  /// Writes a text file. Throws OutputError.
  void write_text(const std::filesystem::path& file, const std::string& text) const;
  /// The first `count` lines of the log, which is never older than the checkpoint. Throws
  /// InputError where there are fewer.
  std::string read_log(int count) const;
  /// Throws OutputError where the file system has less than `bytes` free. The folder need not
  /// exist.
  void require_space(double bytes) const;
};

/// Estimate of the bytes of that many frames, as PLY and in the USD file: by the size of the uncut
/// mesh, and half as much again for cracks.
double bytes_of_frames(const geo::TriangleMesh& mesh, int frames);

}  // namespace sim
