// The `.kerf` file: a body with its graph, in named sections; checked on reading, updated by
// appending. docs/formats.md describes the bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <ostream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kerf/body.h"
#include "kerf/files.h"
#include "kerf/simulation.h"
#include "kerf/vectors.h"

namespace geo {

class UpdatedFile;  // private: an open file, and what is appended to it

/// Newest version of the format that this library reads and writes.
constexpr std::uint32_t kerf_format_version = 2;

/// True where the bytes begin as a .kerf file does.
bool looks_like_kerf(std::string_view bytes);

/// A .kerf file opened for reading, in the state of its last complete commit. Opening checks the
/// sizes and hashes of everything but the arrays; reading an array checks its hash first.
class KerfFile {
 public:
  /// An array by type and shape.
  struct Section {
    std::string dtype;  ///< f8, f4, u8, u4, i4, u2, u1 or json
    std::vector<std::uint64_t> shape;
    std::uint64_t bytes = 0, hash = 0;  ///< size and XXH3 hash of the content
  };

  /// Opens a file. A commit that was interrupted is ignored. Throws InputError, with the file's
  /// name first: no .kerf file, a newer version, another byte order, damage, or no complete commit.
  explicit KerfFile(Input input);
  /// Takes the open file of `other`, which must not be used afterwards.
  KerfFile(KerfFile&& other) noexcept;
  ~KerfFile();

  /// Name of the input.
  const std::string& name() const;
  /// All sections by name.
  const std::map<std::string, Section>& sections() const;
  /// Number of bytes up to the end of the last complete commit.
  std::uint64_t committed() const;
  /// How many times the file was appended to.
  std::uint32_t updates() const;
  /// Hash of the last commit: identifies the state of the file.
  std::uint64_t fingerprint() const;
  /// Version of the format.
  std::uint32_t version() const;

  /// Reads the bytes of a section, with all threads; `out` has exactly their size. Throws
  /// InputError where they do not match their hash, std::out_of_range for an unknown section.
  void read(const std::string& section, std::span<std::byte> out) const;
  /// Reads a section of numbers of type T (double, float, std::uint64_t, uint32_t, int32_t,
  /// uint16_t or uint8_t) with that many columns, row by row. Throws InputError where it is
  /// missing, of another type or shape, or damaged.
  template <class T>
  std::vector<T> read(const std::string& section, std::uint64_t columns = 1) const;
  /// The text of a json section. Throws as read().
  std::string text(const std::string& section) const;
  /// Passes the bytes of a section on in blocks, in order.
  /// \param take  receives the next block, which is valid during the call
  /// \throws InputError at the end where the bytes do not match their hash
  /// \throws std::out_of_range for an unknown section
  void stream(const std::string& section, const std::function<void(std::span<const std::byte>)>& take) const;

  /// Throws InputError: name, `what`, and that the file is damaged.
  [[noreturn]] void fail(const std::string& what) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Writes a file with the same sections in a single segment, without the history of updates.
void write_compacted(std::ostream& out, const KerfFile& file);

/// A .kerf file opened for an update in place, and locked against other programs that update it.
class KerfUpdate {
 public:
  /// Opens and locks a file. Throws MissingInputError or InputError as KerfFile, OutputError where
  /// it is no regular file, cannot be written, or is locked.
  explicit KerfUpdate(const std::string& path);
  ~KerfUpdate();
  KerfUpdate(const KerfUpdate&) = delete;
  KerfUpdate& operator=(const KerfUpdate&) = delete;

  /// The file before the update.
  const KerfFile& file() const;

  /// Rewrites the file in a single segment, with the same state. Throws OutputError.
  void compact();

 private:
  friend class UpdatedFile;  // it alone reaches itself, for the library's own code
  std::unique_ptr<UpdatedFile> file_;
};

/// True where both paths name the same regular file.
bool same_file(const std::string& a, const std::string& b);

// ---- Bodies.

/// Reads a body. Size, range and hash of every section are checked before use. Throws InputError as
/// KerfFile, and where a section is missing, of another type, or holds ids or numbers out of range.
Body read_body(const KerfFile& file);
/// The same from a path, or standard input where it is "-".
Body read_body(const std::string& path);
/// The same from bytes in memory; `name` stands for the file in messages.
Body parse_body(const std::string& bytes, const std::string& name);

/// Writes a body as a new file. The same body gives the same bytes.
void write_body(std::ostream& out, const Body& body);

/// Updates a file to a later state of its body. Changes are appended, so that an interrupted write
/// leaves the state before. The file is written anew if it would become more than twice as long as
/// a new one, loses a section, or has an older version. Memory: twice the largest section.
/// \param file  to be used for one update only
/// \return the number of bytes written
/// \throws OutputError where the file cannot be written; the state before stays
std::uint64_t write_body(KerfUpdate& file, const Body& body);

// ---- Checkpoints: the body of a run and its state in one `.kerf` file, replaced by one rename.

struct Checkpoint {
  Body body;
  RunState state;
  std::uint64_t scene = 0;            ///< fingerprint of the scene and its models
  Vectors vectors = Vectors::widest;  ///< that the run is computed with
};

/// Writes a body as write_body() does, then sections `run/…`, and the kind of vectors in use. The
/// same run gives the same bytes.
void write_checkpoint(std::ostream& out, const Body& body, const RunState& state, std::uint64_t scene);
/// Reads a checkpoint. Throws InputError as read_body(), and where sections of the run are missing
/// or impossible.
Checkpoint read_checkpoint(const KerfFile& file);

}  // namespace geo
