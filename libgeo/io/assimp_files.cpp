// io/assimp_files.h: files in memory, with assimp's C functions to read and to seek.
#include "io/assimp_files.h"

#include <algorithm>
#include <cstring>
#include <memory>

#include "kerf/error.h"
#include "kerf/files.h"

namespace geo {

struct AssimpFiles::File : aiFile {
  const std::string* bytes;
  std::size_t at = 0;

  explicit File(const std::string* content) : aiFile{}, bytes(content) {
    ReadProc = [](aiFile* self, char* out, std::size_t size, std::size_t count) -> std::size_t {
      File& file = *static_cast<File*>(self);
      if (size == 0) return 0;
      count = std::min(count, (file.bytes->size() - file.at) / size);
      std::memcpy(out, file.bytes->data() + file.at, size * count);
      file.at += size * count;
      return count;
    };
    WriteProc = [](aiFile*, const char*, std::size_t, std::size_t) -> std::size_t { return 0; };
    TellProc = [](aiFile* self) { return static_cast<File*>(self)->at; };
    FileSizeProc = [](aiFile* self) { return static_cast<File*>(self)->bytes->size(); };
    SeekProc = [](aiFile* self, std::size_t offset, aiOrigin origin) {
      File& file = *static_cast<File*>(self);
      const std::size_t from = origin == aiOrigin_SET ? 0 : origin == aiOrigin_CUR ? file.at : file.bytes->size();
      if (from + offset > file.bytes->size()) return aiReturn_FAILURE;  // a step back wraps around, as it should
      file.at = from + offset;
      return aiReturn_SUCCESS;
    };
    FlushProc = [](aiFile*) {};
  }
};

AssimpFiles::AssimpFiles(const std::string& bytes, const std::string& name, const std::string& ending)
    : aiFileIO{}, bytes_(bytes), folder_(std::filesystem::path(name).parent_path()) {
  path_ = (folder_ / ("model." + ending)).string();
  OpenProc = &AssimpFiles::open;
  CloseProc = &AssimpFiles::close;
}

const std::string* AssimpFiles::bytes_at(const std::string& path) {
  if (path == path_) return &bytes_;
  const auto inside = std::filesystem::path(path).lexically_normal().lexically_relative(
      folder_.empty() ? "." : folder_.lexically_normal());
  std::error_code failed;
  if (inside.empty() || *inside.begin() == ".." || !std::filesystem::is_regular_file(path, failed)) return nullptr;
  try {
    return &others_.emplace_back(read_all(path));
  } catch (const InputError&) {
    return nullptr;
  }
}

aiFile* AssimpFiles::open(aiFileIO* self, const char* path, const char* mode) {
  const std::string* bytes = std::strchr(mode, 'w') ? nullptr : static_cast<AssimpFiles*>(self)->bytes_at(path);
  return bytes ? new File(bytes) : nullptr;
}

void AssimpFiles::close(aiFileIO*, aiFile* file) { delete static_cast<File*>(file); }

}  // namespace geo
