// A .kerf file that is open for an update in place: what is behind KerfUpdate of kerf/body_file.h.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/kerf_segment.h"
#include "io/kerf_writer.h"
#include "kerf/body_file.h"

namespace geo {

/// An open and locked file, and the changes that are appended to it.
class UpdatedFile {
 public:
  /// Opens and locks a file. Throws as KerfUpdate.
  explicit UpdatedFile(const std::string& path);
  ~UpdatedFile();
  UpdatedFile(const UpdatedFile&) = delete;
  UpdatedFile& operator=(const UpdatedFile&) = delete;

  /// The file of an update.
  static UpdatedFile& of(KerfUpdate& update) { return *update.file_; }

  /// The file before the update.
  const KerfFile& file() const { return *file_; }
  /// Makes `arrays` the state of the file, by appending the changes or by writing it anew. Call at
  /// most once. Returns the number of bytes written. Memory: twice the largest array. Throws
  /// OutputError; the state before stays.
  std::uint64_t commit(const std::vector<KerfArray>& arrays);
  /// Rewrites the file in a single segment, with the same state. Throws OutputError.
  void compact() const;

 private:
  void require_same_file() const;
  void write(std::uint64_t offset, std::span<const std::byte> bytes) const;
  void sync() const;
  std::vector<kerf::Stored> changes(const std::vector<KerfArray>& arrays) const;
  void append(const std::vector<kerf::Stored>& changed);

  std::string path_;
  int descriptor_ = -1;
  std::optional<KerfFile> file_;
};

}  // namespace geo
