// Input of kerf/files.h. Regular files are read by pread(), which has no common position and is
// safe in threads.
#include "kerf/files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "kerf/error.h"

namespace geo {

Input::Input(const std::string& path) : name_(path) {
  struct stat info {};
  if (path != "-" && ::stat(path.c_str(), &info) == 0 && S_ISREG(info.st_mode) && info.st_size > 0) {
    file_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (file_ < 0) throw MissingInputError(path + ": cannot be opened (" + std::strerror(errno) + "); check the name");
    if (::fstat(file_, &info) != 0 || !S_ISREG(info.st_mode)) info.st_size = 0;  // exchanged just now
    size_ = static_cast<std::uint64_t>(info.st_size);
    return;
  }
  bytes_ = read_all(path);
  size_ = bytes_.size();
}

Input::Input(std::string bytes, std::string name)
    : name_(std::move(name)), bytes_(std::move(bytes)), size_(bytes_.size()) {}

Input::~Input() {
  if (file_ >= 0) ::close(file_);
}

Input::Input(Input&& other) noexcept
    : name_(std::move(other.name_)),
      bytes_(std::move(other.bytes_)),
      size_(other.size_),
      file_(std::exchange(other.file_, -1)) {}

void Input::read(std::uint64_t offset, std::span<std::byte> out) const {
  if (offset > size_ || out.size() > size_ - offset)
    throw InputError(name_ + ": ends before all of it was read; the file is truncated");
  if (file_ < 0) {
    if (!out.empty()) std::memcpy(out.data(), bytes_.data() + offset, out.size());
    return;
  }
  for (std::size_t done = 0; done < out.size();) {
    const auto n = ::pread(file_, out.data() + done, out.size() - done, static_cast<off_t>(offset + done));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw InputError(name_ + ": cannot be read (" + std::strerror(errno) + ")");
    if (n == 0) throw InputError(name_ + ": became shorter while it was read; read it again when it is written");
    done += static_cast<std::size_t>(n);
  }
}

std::string Input::text(std::uint64_t offset, std::uint64_t count) const {
  std::string out(offset < size_ ? std::min(count, size_ - offset) : 0, '\0');
  read(std::min(offset, size_), std::as_writable_bytes(std::span(out)));
  return out;
}

}  // namespace geo
