// Output files of kerf/files.h. Outputs go to a temporary file in the same folder, then fsync() and
// rename(), which is atomic under POSIX.
#include "kerf/files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <mutex>
#include <random>
#include <set>
#include <streambuf>

#include "kerf/error.h"

namespace geo {
namespace {

// A stream buffer over a file descriptor that keeps the error code of a failed write.
class DescriptorBuffer : public std::streambuf {
 public:
  explicit DescriptorBuffer(int fd) : fd_(fd) { setp(buffer_, buffer_ + sizeof buffer_); }
  int error() const { return error_; }

 protected:
  int overflow(int c) override {
    if (sync() != 0) return traits_type::eof();
    if (c != traits_type::eof()) sputc(static_cast<char>(c));
    return 0;
  }
  // Text larger than the buffer is written directly.
  std::streamsize xsputn(const char* text, std::streamsize size) override {
    if (size < static_cast<std::streamsize>(sizeof buffer_)) return std::streambuf::xsputn(text, size);
    return sync() == 0 && pass_on(text, text + size) ? size : 0;
  }
  int sync() override {
    if (!pass_on(pbase(), pptr())) return -1;
    setp(buffer_, buffer_ + sizeof buffer_);
    return 0;
  }

 private:
  bool pass_on(const char* at, const char* end) {
    while (at < end) {
      const auto n = ::write(fd_, at, static_cast<std::size_t>(end - at));
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) {
        error_ = errno;
        return false;
      }
      at += n;
    }
    return true;
  }
  int fd_, error_ = 0;
  char buffer_[1 << 16];
};

std::string reason(int error) { return std::string(std::strerror(error)); }

// Temporary outputs of this process. Never destroyed: a thread may end the program at any moment.
struct Temporaries {
  std::recursive_mutex mutex;
  std::set<std::string> paths;
};
Temporaries& temporaries() {
  static auto* all = new Temporaries;
  return *all;
}

void remove_quietly(const std::string& path) {
  std::error_code ignored;
  std::filesystem::remove_all(path, ignored);
}

}  // namespace

TemporaryOutput::TemporaryOutput(std::string path) : path_(std::move(path)) {
  const std::lock_guard lock(temporaries().mutex);
  temporaries().paths.insert(path_);
}

TemporaryOutput::~TemporaryOutput() {
  const std::lock_guard lock(temporaries().mutex);
  temporaries().paths.erase(path_);
  if (!committed_) remove_quietly(path_);
}

void TemporaryOutput::commit(const std::string& path) {
  const std::lock_guard lock(temporaries().mutex);
  if (::rename(path_.c_str(), path.c_str()) != 0)
    throw OutputError(path + ": cannot be written (" + reason(errno) + ")");
  committed_ = true;
}

void discard_temporary_outputs() {
  temporaries().mutex.lock();  // never unlocked: nothing is committed from here on
  for (const auto& path : temporaries().paths) remove_quietly(path);
}

std::string read_all(const std::string& path) {
  if (path.empty()) throw MissingInputError("the name of an input file is empty; give a file, or - for standard input");
  int fd = 0;
  std::string bytes;
  if (path != "-") {
    fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (fd < 0) throw MissingInputError(path + ": cannot be opened (" + reason(errno) + "); check the name");
    struct stat info {};
    if (::fstat(fd, &info) == 0 && S_ISDIR(info.st_mode)) {
      ::close(fd);
      throw InputError(path + ": is a folder; give a file");
    }
    constexpr std::size_t max_at_once = 1u << 30;  // the size that a file system reports may be wrong
    if (S_ISREG(info.st_mode))
      bytes.reserve(std::min<std::size_t>(static_cast<std::size_t>(info.st_size), max_at_once));
  }
  if (path == "-" && ::isatty(0)) throw InputError("-: standard input is a terminal; give a file or a pipe");
  char chunk[1 << 16];
  for (;;) {
    const auto n = ::read(fd, chunk, sizeof chunk);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) {
      const int error = errno;
      if (fd != 0) ::close(fd);
      throw InputError(path + ": cannot be read (" + reason(error) + ")");
    }
    if (n == 0) break;
    bytes.append(chunk, static_cast<std::size_t>(n));
  }
  if (fd != 0) ::close(fd);
  if (bytes.empty()) throw InputError(path + ": is empty; was it written completely?");
  return bytes;
}

void require_writable(const std::string& path) {
  if (path == "-") return;
  if (path.empty()) throw OutputError("the name of an output file is empty; give one");
  struct stat info {};
  const bool there = ::stat(path.c_str(), &info) == 0;
  if (there && S_ISDIR(info.st_mode)) throw OutputError(path + ": is a folder; give a file name");
  // Devices and pipes are written directly, other files through a temporary one in the same folder.
  const auto folder = std::filesystem::path(path).parent_path() / ".";
  const bool possible =
      there && !S_ISREG(info.st_mode) ? ::access(path.c_str(), W_OK) == 0 : ::access(folder.c_str(), W_OK | X_OK) == 0;
  if (!possible)
    throw OutputError(path + ": cannot be made (" + reason(errno) + "); check the folder and its permissions");
}

void write_all(const std::string& path, const std::function<void(std::ostream&)>& write, Sync to) {
  if (path == "-") {
    DescriptorBuffer buffer(1);
    std::ostream out(&buffer);
    write(out);
    out.flush();
    if (!out) throw OutputError("-: cannot be written (" + reason(buffer.error()) + ")");
    return;
  }
  struct stat info {};
  const bool special = ::stat(path.c_str(), &info) == 0 && !S_ISREG(info.st_mode);
  if (special && S_ISDIR(info.st_mode)) throw OutputError(path + ": is a folder; give a file name");
  std::string aside = path;
  std::unique_ptr<TemporaryOutput> unfinished;
  int fd = -1;
  if (special) {
    fd = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);  // a device or a pipe, which a rename would replace
  } else {
    thread_local std::random_device random;
    for (int tries = 0; tries < 16 && fd < 0; ++tries) {
      aside = path + "." + std::to_string(random()) + ".tmp";
      unfinished = std::make_unique<TemporaryOutput>(aside);
      fd = ::open(aside.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
      if (fd < 0 && errno != EEXIST) break;
    }
  }
  if (fd < 0)
    throw OutputError(path + ": cannot be made (" + reason(errno) + "); check the folder and its permissions");
  int error = 0;
  try {
    auto buffer = std::make_unique<DescriptorBuffer>(fd);
    std::ostream out(buffer.get());
    write(out);
    out.flush();
    if (!out) error = buffer->error() ? buffer->error() : EIO;
  } catch (...) {
    ::close(fd);
    throw;
  }
  if (error == 0 && !special && to == Sync::on_disk && ::fsync(fd) != 0) error = errno;
  if (::close(fd) != 0 && error == 0) error = errno;
  if (error != 0) throw OutputError(path + ": cannot be written (" + reason(error) + ")");
  if (unfinished) unfinished->commit(path);
}

void flush_to_disk(std::span<const std::string> paths) {
  for (const std::string& path : paths) {
    const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (fd < 0 && errno == ENOENT) continue;
    int error = fd < 0 || ::fsync(fd) != 0 ? errno : 0;
    if (fd >= 0 && ::close(fd) != 0 && error == 0) error = errno;
    if (error != 0) throw OutputError(path + ": cannot be written (" + reason(error) + ")");
  }
}

}  // namespace geo
