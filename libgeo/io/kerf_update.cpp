// Under a file lock, sections whose hashes differ are appended as one segment: whole, or as runs of
// rows if these are shorter. The commit record is written after fsync(), so a crash leaves the old
// state.
#include "io/kerf_update.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "io/kerf_delta.h"
#include "kerf/error.h"
#include "kerf/files.h"

namespace geo {
namespace {

std::uint64_t hash_in_blocks(std::span<const std::byte> bytes) {
  std::vector<std::uint64_t> blocks;
  for (std::size_t at = 0; at < bytes.size(); at += kerf::hash_block)
    blocks.push_back(kerf::hash_of(bytes.data() + at, std::min(kerf::hash_block, bytes.size() - at)));
  return kerf::hash_of(blocks);
}

std::vector<std::byte> all_of(const KerfArray& array) {
  std::vector<std::byte> bytes;
  bytes.reserve((array.shape.empty() ? 1 : array.shape[0]) * kerf::row_bytes(array.dtype, array.shape));
  KerfSink sink([&](std::span<const std::byte> block) { bytes.insert(bytes.end(), block.begin(), block.end()); });
  array.fill(sink);
  sink.finish();
  return bytes;
}

// The array as runs of rows of its previous version; whole if that is shorter, or if the types
// differ.
kerf::Stored stored(const KerfArray& array, std::vector<std::byte> after, std::uint64_t hash, const KerfFile& file) {
  const KerfFile::Section& old = file.sections().at(array.name);
  kerf::Stored s{.array = array, .runs = {}, .literal_rows = 0, .hash = hash};
  const std::uint64_t width = kerf::row_bytes(array.dtype, array.shape);
  const bool comparable = !array.shape.empty() && array.dtype == old.dtype && array.shape.size() == old.shape.size() &&
                          std::equal(array.shape.begin() + 1, array.shape.end(), old.shape.begin() + 1);
  if (comparable && width > 0 && old.bytes > 0) {
    std::vector<std::byte> before(old.bytes);
    file.read(array.name, before);
    auto runs = kerf::difference(before, after, width);
    std::uint64_t given = 0;
    for (const auto& run : runs) given += run.from == kerf::literal ? run.count : 0;
    if (given * width + runs.size() * sizeof(kerf::Run) < after.size()) {
      std::size_t to = 0, at = 0;  // what is given is moved together
      for (const auto& run : runs) {
        const auto n = static_cast<std::size_t>(run.count * width);
        if (run.from == kerf::literal) {
          std::memmove(after.data() + to, after.data() + at, n);
          to += n;
        }
        at += n;
      }
      after.resize(to);
      after.shrink_to_fit();
      s.runs = std::move(runs);
      s.literal_rows = given;
      s.array.fill = [bytes = std::make_shared<const std::vector<std::byte>>(std::move(after))](KerfSink& sink) {
        sink.write(*bytes);
      };
    }
  }
  return s;
}

}  // namespace

UpdatedFile::UpdatedFile(const std::string& path) : path_(path) {
  Input input(path_);  // throws where the file is missing, empty or a folder
  struct stat info {};
  if (::stat(path_.c_str(), &info) != 0 || !S_ISREG(info.st_mode))
    throw OutputError(path_ + ": is no regular file and cannot be updated in place; write to another one");
  descriptor_ = ::open(path_.c_str(), O_RDWR | O_CLOEXEC);
  if (descriptor_ < 0) throw OutputError(path_ + ": cannot be written (" + std::strerror(errno) + ")");
  try {
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0)
      throw OutputError(path_ + ": is being updated by another program; wait for it, or write to another file");
    file_.emplace(Input(path_));  // read under the lock: no other program appends from here on
    require_same_file();
  } catch (...) {
    ::close(descriptor_);
    throw;
  }
}

UpdatedFile::~UpdatedFile() { ::close(descriptor_); }

// Another program may have replaced the file, which a lock does not prevent.
void UpdatedFile::require_same_file() const {
  struct stat ours {
  }, there{};
  if (::fstat(descriptor_, &ours) != 0 || ::stat(path_.c_str(), &there) != 0 || ours.st_dev != there.st_dev ||
      ours.st_ino != there.st_ino)
    throw OutputError(path_ + ": was replaced by another program; start again");
}

void UpdatedFile::write(std::uint64_t offset, std::span<const std::byte> bytes) const {
  while (!bytes.empty()) {
    const auto n = ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) throw OutputError(path_ + ": cannot be written (" + std::strerror(errno) + ")");
    bytes = bytes.subspan(static_cast<std::size_t>(n));
    offset += static_cast<std::uint64_t>(n);
  }
}

void UpdatedFile::sync() const {
  if (::fsync(descriptor_) != 0) throw OutputError(path_ + ": cannot be written (" + std::strerror(errno) + ")");
}

std::vector<kerf::Stored> UpdatedFile::changes(const std::vector<KerfArray>& arrays) const {
  std::vector<kerf::Stored> changed;
  for (const auto& array : arrays) {
    const auto old = file_->sections().find(array.name);
    if (old == file_->sections().end()) {
      changed.push_back({.array = array, .runs = {}, .literal_rows = 0, .hash = 0});
      continue;
    }
    auto bytes = all_of(array);
    const std::uint64_t hash = hash_in_blocks(bytes);
    if (old->second.hash != hash || old->second.dtype != array.dtype || old->second.shape != array.shape)
      changed.push_back(stored(array, std::move(bytes), hash, *file_));
  }
  return changed;
}

void UpdatedFile::append(const std::vector<kerf::Stored>& changed) {
  const std::uint64_t start = file_->committed();
  require_same_file();
  try {
    if (::ftruncate(descriptor_, static_cast<off_t>(start)) != 0)
      throw OutputError(path_ + ": cannot be written (" + std::strerror(errno) + ")");
    std::uint64_t at = start;
    const auto put = [&](std::span<const std::byte> bytes) {
      write(at, bytes);
      at += bytes.size();
    };
    const auto segment = kerf::write_segment(put, start, file_->updates() + 1, file_->fingerprint(), changed);
    sync();  // the sections are on the disk before the commit record is
    put(kerf::bytes_of_one(segment));
    sync();
  } catch (...) {
    [[maybe_unused]] const int ignored = ::ftruncate(descriptor_, static_cast<off_t>(start));
    throw;
  }
}

std::uint64_t UpdatedFile::commit(const std::vector<KerfArray>& arrays) {
  std::vector<kerf::Stored> whole;
  for (const auto& array : arrays) whole.push_back({.array = array, .runs = {}, .literal_rows = 0, .hash = 0});
  const std::uint64_t size = kerf::segment_size(0, whole);
  const bool kept = std::all_of(file_->sections().begin(), file_->sections().end(), [&](const auto& s) {
    return std::any_of(arrays.begin(), arrays.end(), [&](const KerfArray& a) { return a.name == s.first; });
  });
  if (kept && file_->version() == kerf_format_version) {
    const auto changed = changes(arrays);
    const std::uint64_t added = kerf::segment_size(file_->committed(), changed);
    // Appends while the file is at most twice as long as a new one; else it is written anew.
    if (file_->committed() + added <= 2 * size) {
      append(changed);
      return added;
    }
  }
  require_same_file();
  write_all(path_, [&](std::ostream& out) { write_kerf(out, arrays); });
  return size;
}

void UpdatedFile::compact() const {
  require_same_file();
  write_all(path_, [&](std::ostream& out) { write_compacted(out, *file_); });
}

KerfUpdate::KerfUpdate(const std::string& path) : file_(std::make_unique<UpdatedFile>(path)) {}
KerfUpdate::~KerfUpdate() = default;
const KerfFile& KerfUpdate::file() const { return file_->file(); }
void KerfUpdate::compact() { file_->compact(); }

bool same_file(const std::string& a, const std::string& b) {
  struct stat first {
  }, second{};
  return ::stat(a.c_str(), &first) == 0 && ::stat(b.c_str(), &second) == 0 && S_ISREG(first.st_mode) &&
         first.st_dev == second.st_dev && first.st_ino == second.st_ino;
}

}  // namespace geo
