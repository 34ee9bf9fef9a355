// Bytes of files: input by position or as a whole, output that replaces a file only when complete.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <ostream>
#include <span>
#include <string>
#include <string_view>

namespace geo {

// ---- Input.

/// The bytes of a file, or of standard input where `path` is "-". Throws MissingInputError where
/// the file does not exist, InputError where it is empty, a folder or unreadable.
std::string read_all(const std::string& path);

/// An input that is read by position. A regular file stays open and is not mapped: another program
/// that shortens a mapped file would end this one. Anything else is read to its end on opening.
class Input {
 public:
  /// Opens a file, or standard input where `path` is "-". Throws as read_all().
  explicit Input(const std::string& path);
  /// Bytes in memory; `name` stands for the file in messages.
  Input(std::string bytes, std::string name);
  ~Input();
  /// Takes the open file of `other`.
  Input(Input&& other) noexcept;
  Input(const Input&) = delete;
  Input& operator=(const Input&) = delete;

  /// The path, or the name given.
  const std::string& name() const { return name_; }
  /// Number of bytes when the input was opened.
  std::uint64_t size() const { return size_; }
  /// Fills `out` with the bytes from `offset` on. Threads may read at the same time. Throws
  /// InputError where the input has fewer bytes, or has become shorter.
  void read(std::uint64_t offset, std::span<std::byte> out) const;
  /// At most `count` bytes from `offset` on; fewer at the end of the input.
  std::string text(std::uint64_t offset, std::uint64_t count) const;

 private:
  std::string name_, bytes_;
  std::uint64_t size_ = 0;
  int file_ = -1;  // descriptor; −1: all bytes are in bytes_
};

/// The XXH3 hash of some bytes, 64 bits: identifies an input in the history of a file.
std::uint64_t fingerprint(std::string_view bytes);

// ---- Output.

/// How far write_all() waits. `by_system`: the operating system has the bytes; only a crash of the
/// machine can lose them.
enum class Sync { on_disk, by_system };

/// Writes a file through `write`: to a temporary file in the same folder, which then replaces the
/// file by a rename. On failure the file stays as it was and nothing is left behind. "-" is
/// standard output; devices and pipes are written directly. Throws OutputError.
void write_all(const std::string& path, const std::function<void(std::ostream&)>& write, Sync sync = Sync::on_disk);

/// Waits until files written with Sync::by_system are on the disk. Many files at once cost little
/// more than one. Files that no longer exist are skipped. Throws OutputError.
void flush_to_disk(std::span<const std::string> paths);

/// Throws OutputError, as write_all() would, where no file of this name can be written. To be
/// called before long work.
void require_writable(const std::string& path);

/// A temporary file or folder that becomes an output. The destructor removes it with its content
/// unless it was committed.
class TemporaryOutput {
 public:
  /// `path`: of the temporary file or folder, which the caller creates.
  explicit TemporaryOutput(std::string path);
  ~TemporaryOutput();
  TemporaryOutput(const TemporaryOutput&) = delete;
  TemporaryOutput& operator=(const TemporaryOutput&) = delete;
  /// Renames it to `path`. Throws OutputError.
  void commit(const std::string& path);

 private:
  std::string path_;
  bool committed_ = false;
};

/// Removes all temporary outputs of this process and blocks every later commit: the last call of a
/// program that ends at once.
void discard_temporary_outputs();

}  // namespace geo
