// Bytes in and out: whole inputs from a file or standard input, outputs written aside and renamed.
#pragma once

#include <cstdint>
#include <functional>
#include <ostream>
#include <span>
#include <string>
#include <string_view>

namespace geo {

/// The whole of a file, or of standard input where `path` is "-". Throws MissingInputError, or InputError when empty.
std::string read_all(const std::string& path);

/// Where a file is when it has been written: on the disk, or with the system, which takes it there by and by. No kill
/// takes the latter from it, only a machine that stops at once does.
enum class Kept { on_disk, by_system };

/// Writes a file through `write`: aside in the same folder, flushed, then renamed; on any failure nothing is left
/// behind and what was there before stays. "-" writes to standard output. Throws OutputError.
void write_all(const std::string& path, const std::function<void(std::ostream&)>& write, Kept kept = Kept::on_disk);

/// After it, what write_all() left with the system is on the disk. Many files at once cost little more than one; what
/// somebody has taken away since is nobody's loss. Throws OutputError.
void flush_to_disk(std::span<const std::string> paths);

/// Throws OutputError, as write_all would, where no file of this name can be made: to be called before long work.
void require_place(const std::string& path);

/// Something that is being written aside, a file or a folder: removed with all it holds by the destructor, unless it
/// was committed before.
class Unfinished {
 public:
  explicit Unfinished(std::string aside);
  ~Unfinished();
  Unfinished(const Unfinished&) = delete;
  Unfinished& operator=(const Unfinished&) = delete;
  /// Renames what was written to `path`. Throws OutputError.
  void commit(const std::string& path);

 private:
  std::string aside_;
  bool committed_ = false;
};

/// Removes everything that is being written aside now, and lets nothing be committed any more: the last call of a
/// program that is told to stop at once.
void discard_unfinished();

/// The XXH3 hash of some bytes, 64 bits: names an input in a file's provenance.
std::uint64_t fingerprint(std::string_view bytes);

}  // namespace geo
