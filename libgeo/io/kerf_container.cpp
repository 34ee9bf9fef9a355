#include "io/kerf_container.h"

#include <xxhash.h>

#include <bit>
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "io/body_file.h"
#include "io/text_internal.h"

namespace geo {
namespace {

static_assert(std::endian::native == std::endian::little, "files are little-endian");

// Like PNG's: a byte over 127, the name, CR LF, end-of-file for DOS, LF: any text transfer breaks it.
constexpr char magic[] = {'\x8b', 'K', 'E', 'R', 'F', '\r', '\n', '\x1a', '\n'};
constexpr std::size_t header_size = 64, record_size = 32, alignment = 64;
constexpr std::uint32_t endian_tag = 0x01020304;
constexpr char commit_word[] = {'K', 'C', 'O', 'M', 'M', 'I', 'T', '\n'};

std::string hex(std::uint64_t h) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(h));
  return text;
}

std::size_t size_of(const std::string& dtype) {
  return dtype == "f8" ? 8 : dtype == "f4" || dtype == "u4" || dtype == "i4" ? 4 : dtype == "u1" || dtype == "json" ? 1 : 0;
}

void pad(std::string& bytes, std::uint64_t base) { bytes.append((alignment - (base + bytes.size()) % alignment) % alignment, '\0'); }

struct Place {
  std::uint64_t offset = 0;
  std::string hash;
};

nlohmann::ordered_json table_row(const std::string& name, const KerfSection& s, const Place& place) {
  return {{"name", name}, {"dtype", s.dtype}, {"shape", s.shape}, {"offset", place.offset}, {"length", s.bytes.size()}, {"xxh3", place.hash}};
}

// Table and commit record: the record says where the table is and how it hashes, then hashes itself.
void finish(std::string& out, std::uint64_t base, const nlohmann::ordered_json& table) {
  pad(out, base);
  const std::string text = table.dump();
  const std::uint64_t at = base + out.size(), length = text.size(), hash = XXH3_64bits(text.data(), text.size());
  out += text;
  pad(out, base);
  char record[record_size];
  std::memcpy(record, commit_word, 8);
  std::memcpy(record + 8, &at, 8);
  std::memcpy(record + 16, &length, 8);
  std::memcpy(record + 24, &hash, 8);
  out.append(record, record_size);
}

}  // namespace

bool looks_like_kerf(std::string_view bytes) { return bytes.size() >= 5 && std::memcmp(bytes.data(), magic, 5) == 0; }

void write_kerf(std::ostream& out, const KerfSections& sections) {
  std::string header(header_size, '\0');
  std::memcpy(header.data(), magic, sizeof magic);
  std::memcpy(header.data() + 12, &kerf_format_version, 4);
  std::memcpy(header.data() + 16, &endian_tag, 4);
  std::string body;
  nlohmann::ordered_json table = nlohmann::ordered_json::array();
  for (const auto& [name, s] : sections) {
    pad(body, header_size);
    table.push_back(table_row(name, s, {header_size + body.size(), hex(XXH3_64bits(s.bytes.data(), s.bytes.size()))}));
    body += s.bytes;
  }
  finish(body, header_size, table);
  out << header << body;
}

KerfSections parse_kerf(std::string_view bytes, const std::string& name, std::uint64_t* committed) {
  if (!looks_like_kerf(bytes)) throw InputError(name + ": is not a .kerf file; make one with kerf-graph");
  if (bytes.size() < header_size) throw InputError(name + ": ends within its header; the file is truncated");
  if (std::memcmp(bytes.data(), magic, sizeof magic) != 0) throw InputError(name + ": was damaged by a text transfer; copy it as binary");
  std::uint32_t version, tag;
  std::memcpy(&version, bytes.data() + 12, 4);
  std::memcpy(&tag, bytes.data() + 16, 4);
  if (tag != endian_tag) throw InputError(name + ": has another byte order than this machine, or is damaged");
  if (version == 0 || version > kerf_format_version)
    throw InputError(name + ": is of version " + std::to_string(version) + ", newer than " + std::to_string(kerf_format_version) + " that this program reads; update it");

  // The last commit record whose table is whole; what a killed write left after it is passed over.
  for (std::size_t end = bytes.size(); end >= header_size + record_size;) {
    const auto at = bytes.substr(0, end).rfind(std::string_view(commit_word, 8));
    if (at == std::string_view::npos || at < header_size) break;
    end = at + 7;
    if (at + record_size > bytes.size()) continue;
    std::uint64_t offset, length, hash;
    std::memcpy(&offset, bytes.data() + at + 8, 8);
    std::memcpy(&length, bytes.data() + at + 16, 8);
    std::memcpy(&hash, bytes.data() + at + 24, 8);
    if (offset > at || length > at - offset || XXH3_64bits(bytes.data() + offset, length) != hash) continue;
    const auto table = nlohmann::json::parse(bytes.substr(offset, length), nullptr, false);
    if (!table.is_array()) continue;
    KerfSections sections;
    for (const auto& row : table) {
      const auto fail = [&](const std::string& what) { throw InputError(name + ": " + what + "; the file is damaged"); };
      KerfSection s;
      std::string key, wanted;
      std::uint64_t from = 0, size = 0;
      try {
        key = row.at("name").get<std::string>(), s.dtype = row.at("dtype").get<std::string>();
        s.shape = row.at("shape").get<std::vector<std::uint64_t>>();
        from = row.at("offset").get<std::uint64_t>(), size = row.at("length").get<std::uint64_t>(), wanted = row.at("xxh3").get<std::string>();
      } catch (const nlohmann::json::exception&) {
        fail("its table of sections is malformed");
      }
      if (from > at || size > at - from) fail("section '" + shown(key) + "' lies outside of the file");
      std::uint64_t count = size_of(s.dtype);
      for (const auto d : s.shape) {
        if (d != 0 && count > bytes.size() / d) fail("section '" + shown(key) + "' is larger than the file");
        count *= d;
      }
      if (size_of(s.dtype) != 0 && s.dtype != "json" && count != size) fail("section '" + shown(key) + "' has another size than its shape");
      s.bytes = std::string(bytes.substr(from, size));
      if (hex(XXH3_64bits(s.bytes.data(), s.bytes.size())) != wanted) fail("section '" + shown(key) + "' does not match its hash");
      sections[key] = std::move(s);
    }
    if (committed) *committed = at + record_size;
    return sections;
  }
  throw InputError(name + ": holds no complete commit; the file is truncated");
}

}  // namespace geo
