// An input that is read by parts: a file by position, standard input or a pipe from memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace geo {

/// A regular file stays where it is and is read by position. It is not mapped: a mapped file that another program
/// shortens ends this one, and one that it changes is no longer what was checked. Everything else is read to its end.
class Input {
 public:
  /// Opens a file, or standard input where `path` is "-". Throws MissingInputError, or InputError when empty or a
  /// folder.
  explicit Input(const std::string& path);
  /// The bytes given, under that name.
  Input(std::string bytes, std::string name);
  ~Input();
  Input(Input&& other) noexcept;
  Input(const Input&) = delete;
  Input& operator=(const Input&) = delete;

  const std::string& name() const { return name_; }
  /// Bytes there were when it was opened.
  std::uint64_t size() const { return size_; }
  /// Fills `out` from `offset` on; safe to call from several threads. Throws InputError when it has become shorter.
  void read(std::uint64_t offset, std::span<std::byte> out) const;
  /// Up to `count` bytes from `offset` on, fewer at the end.
  std::string text(std::uint64_t offset, std::uint64_t count) const;

 private:
  std::string name_, bytes_;
  std::uint64_t size_ = 0;
  int file_ = -1;  ///< −1: all is in bytes_
};

}  // namespace geo
