// The files that assimp may open: the bytes of one, and what that one names in its own folder.
#pragma once

#include <assimp/cfileio.h>

#include <filesystem>
#include <list>
#include <string>

namespace geo {

/// Callbacks for assimp. `path()` stands for the bytes given. Any other path is read whole where it
/// is a regular file in the folder of `name` or below; otherwise it is missing for assimp.
class AssimpFiles : public aiFileIO {
 public:
  /// `bytes` must outlive this. `name`: of the file that they are from, or of none.
  AssimpFiles(const std::string& bytes, const std::string& name, const std::string& ending);
  AssimpFiles(const AssimpFiles&) = delete;
  AssimpFiles& operator=(const AssimpFiles&) = delete;
  ~AssimpFiles() = default;

  /// The path by which assimp opens the bytes; its ending is the one given.
  const std::string& path() const { return path_; }

 private:
  struct File;
  static aiFile* open(aiFileIO* self, const char* path, const char* mode);
  static void close(aiFileIO* self, aiFile* file);
  const std::string* bytes_at(const std::string& path);

  const std::string& bytes_;
  std::filesystem::path folder_;
  std::string path_;
  std::list<std::string> others_;  // files read so far
};

}  // namespace geo
