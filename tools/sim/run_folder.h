// The folder of a run: what is in it, and where.
#pragma once

#include <filesystem>
#include <string>

#include <kerf/mesh.h>

namespace sim {

struct RunFolder {
  std::filesystem::path path;
  std::filesystem::path frames() const { return path / "frames"; }
  std::filesystem::path nodes() const { return path / "nodes"; }
  std::filesystem::path checkpoint() const { return path / "checkpoint.kerf"; }
  std::filesystem::path log() const { return path / "frames.jsonl"; }
  /// "frames/frame_0007.ply", in the folder.
  static std::string frame_name(int i);
  std::string frame(int i) const { return (path / frame_name(i)).string(); }
  std::string nodes(int i) const;
  std::filesystem::path obstacles() const { return path / "obstacles"; }
  static std::string obstacles_name(int i);
  std::string obstacles(int i) const { return (path / obstacles_name(i)).string(); }

  /// Throws OutputError unless a run may begin here: the folder is new or empty, but for hidden files. With `resume`
  /// one that holds a run, or began to, will do.
  void require_room(bool resume) const;
  /// `with_obstacles`: a folder for them, too. Throws OutputError.
  void make(bool with_obstacles) const;
  /// Removes what make() made, where nothing came of it.
  void unmake() const;
  void write_text(const std::filesystem::path& file, const std::string& text) const;
  /// The first `count` lines of the log, which is never behind the checkpoint. Throws InputError where there are fewer.
  std::string read_log(int count) const;
  /// Throws OutputError where `bytes` more do not fit beside the folder, which need not be there.
  void require_space(double bytes) const;
};

/// A frame as PLY and its samples in the USD file, by what there is now and half as much again for cracks; bytes of so
/// many.
double bytes_of_frames(const geo::TriangleMesh& mesh, int frames);

}  // namespace sim
