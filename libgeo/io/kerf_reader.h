// Reading `.kerf` files: what is in them is known at once, arrays are read when they are wanted.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "io/input.h"
#include "io/kerf_writer.h"

namespace geo {

constexpr std::uint32_t kerf_format_version = 2;

/// True when the bytes begin like a .kerf file.
bool looks_like_kerf(std::string_view bytes);

/// The state after the last complete commit of a file. Sizes, ranges, alignment and hashes of all that is no array are
/// checked on opening; of arrays, the sizes on opening and the hash on reading, before anything is handed out.
class KerfFile {
 public:
  /// Some bytes of a section and where they are in the file.
  struct Piece {
    std::uint64_t at = 0, from = 0, size = 0;
  };
  struct Section {
    std::string dtype;
    std::vector<std::uint64_t> shape;
    std::uint64_t bytes = 0, hash = 0;
    std::vector<Piece> pieces;  ///< in order, without gaps
  };

  /// Throws InputError (name first): not a .kerf file, damaged by a text transfer, of a newer version or the other byte
  /// order, without a complete commit, damaged; a write that was killed after the last commit is passed over.
  explicit KerfFile(Input input);

  const std::string& name() const { return input_.name(); }
  const std::map<std::string, Section>& sections() const { return sections_; }
  /// Bytes up to the end of the last commit record; what follows was never finished.
  std::uint64_t committed() const { return committed_; }
  /// How often the file was appended to.
  std::uint32_t updates() const { return segments_ - 1; }
  /// The hash that the last commit record ends with: names the state of the file.
  std::uint64_t fingerprint() const { return fingerprint_; }
  std::uint32_t version() const { return version_; }

  /// All bytes of a section, read and hashed by all threads; `out` has room for exactly these. Throws InputError when
  /// they do not match their hash.
  void read(const std::string& section, std::span<std::byte> out) const;
  /// A section of numbers of type T with `columns` columns. Throws InputError when it is not there or of another kind.
  template <class T>
  std::vector<T> read(const std::string& section, std::uint64_t columns = 1) const {
    std::vector<T> values(expect(section, kerf_dtype<T>(), columns).bytes / sizeof(T));
    read(section, std::as_writable_bytes(std::span(values)));
    return values;
  }
  /// The text of a json section.
  std::string text(const std::string& section) const;
  /// The section's bytes in order, without having all of them in memory. Throws InputError at their end when they do
  /// not match their hash.
  void stream(const std::string& section, KerfSink& sink) const;

  [[noreturn]] void fail(const std::string& what) const;

 private:
  const Section& expect(const std::string& section, const std::string& dtype, std::uint64_t columns) const;
  void fetch(const Section& s, std::uint64_t at, std::span<std::byte> out) const;
  void open_version_1();
  bool open_segment(std::uint64_t start);
  void take_table(const std::string& text, std::uint64_t start, std::uint64_t end);
  Section patched(const std::string& name, Section s, const Piece& stored, std::uint64_t runs) const;

  Input input_;
  std::map<std::string, Section> sections_;
  std::uint64_t committed_ = 0, fingerprint_ = 0;
  std::uint32_t version_ = kerf_format_version, segments_ = 0;
};

/// A file with the same sections in a single segment.
void write_compacted(std::ostream& out, const KerfFile& file);

}  // namespace geo
