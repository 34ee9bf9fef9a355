// Updating a `.kerf` file in place: what changed is appended, and counts from the moment its commit record is written.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "io/kerf_reader.h"

namespace geo {

namespace kerf {
struct Stored;
}

/// A file that is read, and brought up to another state later. Locked meanwhile against others that do the same.
class KerfUpdate {
 public:
  /// Throws MissingInputError, InputError as KerfFile does, OutputError when it is no regular file, cannot be written
  /// or is locked.
  explicit KerfUpdate(const std::string& path);
  ~KerfUpdate();
  KerfUpdate(const KerfUpdate&) = delete;
  KerfUpdate& operator=(const KerfUpdate&) = delete;

  /// The state before.
  const KerfFile& file() const { return *file_; }

  /// Makes `arrays` the state of the file; call it once. What changed is appended: a write that is killed leaves the
  /// state before. Where the file would become more than twice as long as a whole one, has lost a section, or is of an
  /// older version, it is written whole, aside and renamed. Returns how many bytes were written. Memory: the largest
  /// array twice. Throws OutputError, the state before stays.
  std::uint64_t commit(const std::vector<KerfArray>& arrays);

  /// Folds all that was appended: the same state in a single segment, written aside and renamed.
  void compact();

 private:
  std::vector<kerf::Stored> changes(const std::vector<KerfArray>& arrays) const;
  void append(const std::vector<kerf::Stored>& changed);
  void write(std::uint64_t offset, std::span<const std::byte> bytes) const;
  void sync() const;
  void require_same_file() const;

  std::string path_;
  int fd_ = -1;
  std::unique_ptr<KerfFile> file_;
};

/// True when both paths name one file.
bool same_file(const std::string& a, const std::string& b);

}  // namespace geo
