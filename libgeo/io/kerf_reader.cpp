#include "io/kerf_reader.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "io/json_integer.h"
#include "io/kerf_segment.h"
#include "io/line_reader.h"
#include "kerf/error.h"
#include "kerf/parallel.h"

namespace geo {
namespace {

using kerf::Commit;
using kerf::Head;
using kerf::Run;

template <class T>
T read_one(const Input& input, std::uint64_t at) {
  T value;
  input.read(at, std::as_writable_bytes(std::span<T, 1>(&value, 1)));
  return value;
}

template <class T>
bool all_zero(const T& value) {
  const auto bytes = kerf::bytes_of_one(value);
  return std::all_of(bytes.begin(), bytes.end(), [](std::byte b) { return b == std::byte(0); });
}

}  // namespace

bool looks_like_kerf(std::string_view bytes) {
  return bytes.size() >= 5 && std::memcmp(bytes.data(), Head().magic, 5) == 0;
}

void KerfFile::fail(const std::string& what) const { throw InputError(name() + ": " + what + "; the file is damaged"); }

KerfFile::KerfFile(Input input) : input_(std::move(input)) {
  const std::string begin = input_.text(0, sizeof(Head));
  if (!looks_like_kerf(begin)) throw InputError(name() + ": is not a .kerf file; make one with kerf-graph");
  if (begin.size() < sizeof(Head)) throw InputError(name() + ": ends within its header; the file is truncated");
  Head head;
  std::memcpy(&head, begin.data(), sizeof head);
  if (std::memcmp(head.magic, Head().magic, sizeof head.magic) != 0)
    throw InputError(name() + ": was damaged by a text transfer; copy it as binary");
  if (head.endian != Head().endian)
    throw InputError(name() + ": has another byte order than this machine, or is damaged");
  version_ = head.version;
  if (version_ == 0 || version_ > kerf_format_version)
    throw InputError(name() + ": is of version " + std::to_string(version_) + ", newer than " +
                     std::to_string(kerf_format_version) + " that this program reads; update it");
  if (version_ == 1)
    open_version_1();
  else
    while (open_segment(committed_)) {
    }
  if (segments_ == 0) throw InputError(name() + ": holds no complete commit; the file is truncated");
}

// Version 1 had one segment, no hash of the head, and a record of 32 bytes at the end.
void KerfFile::open_version_1() {
  struct Record {
    char word[8];
    std::uint64_t table, length, hash;
  };
  if (input_.size() < sizeof(Head) + sizeof(Record))
    throw InputError(name() + ": holds no complete commit; the file is truncated");
  const std::uint64_t at = input_.size() - sizeof(Record);
  const auto record = read_one<Record>(input_, at);
  if (std::memcmp(record.word, Commit().word, sizeof record.word) != 0)
    throw InputError(name() + ": holds no complete commit; the file is truncated");
  if (record.table > at || record.length > at - record.table) fail("its table of sections lies outside of the file");
  const std::string table = input_.text(record.table, record.length);
  if (kerf::hash_of(table.data(), table.size()) != record.hash) fail("its table of sections does not match its hash");
  take_table(table, 0, record.table);
  committed_ = input_.size(), fingerprint_ = record.hash, segments_ = 1;
}

// False at the end of what was committed. What follows there can only be the beginning of a segment, or zeros where the
// system had made room for one: anything else is damage, so that no changed bit ever brings back an older state.
bool KerfFile::open_segment(std::uint64_t start) {
  const std::uint64_t room = input_.size() - start;
  if (room == 0) return false;
  Head expected;
  expected.number = segments_, expected.previous = fingerprint_;
  const auto damaged = [&] {
    fail(segments_ == 0
             ? "its header does not match its hash"
             : "what follows commit " + std::to_string(segments_) + " is neither a commit nor the beginning of one");
  };
  if (room < sizeof(Head)) {
    std::byte begin[sizeof(Head)] = {};
    input_.read(start, std::span(begin).first(room));
    if (!all_zero(begin) && std::memcmp(begin, &expected, std::min<std::size_t>(room, offsetof(Head, table))) != 0)
      damaged();
    return false;
  }
  const auto head = read_one<Head>(input_, start);
  if (segments_ > 0 && all_zero(head)) return false;
  if (head.hash != head.own_hash() || std::memcmp(&head, &expected, offsetof(Head, table)) != 0 ||
      head.previous != expected.previous)
    damaged();
  if (head.table < start + sizeof(Head) || head.table % kerf::alignment != 0 ||
      head.table > ~head.table_length - kerf::alignment)
    damaged();
  const std::uint64_t commit_at = kerf::aligned(head.table + head.table_length);
  if (input_.size() < sizeof(Commit) || commit_at > input_.size() - sizeof(Commit)) return false;
  const auto commit = read_one<Commit>(input_, commit_at);
  if (all_zero(commit) && commit_at + sizeof(Commit) == input_.size()) return false;
  if (std::memcmp(commit.word, Commit().word, sizeof commit.word) != 0 || commit.hash != commit.own_hash() ||
      commit.number != head.number || commit.head_hash != head.hash || commit.table != head.table ||
      commit.table_length != head.table_length)
    fail("commit record " + std::to_string(segments_) + " does not match its hash");
  const std::string table = input_.text(head.table, head.table_length);
  if (kerf::hash_of(table.data(), table.size()) != commit.table_hash)
    fail("its table of sections does not match its hash");
  take_table(table, start, head.table);
  committed_ = commit_at + sizeof(Commit), fingerprint_ = commit.hash, ++segments_;
  return true;
}

// The sections of a segment lie between `start` and `end`.
void KerfFile::take_table(const std::string& text, std::uint64_t start, std::uint64_t end) {
  const auto table = nlohmann::json::parse(text, nullptr, false);
  if (!table.is_array()) fail("its table of sections is malformed");
  std::map<std::string, Section> found;
  std::vector<Piece> taken;
  for (const auto& row : table) {
    Section s;
    Piece stored;
    std::string key, hash;
    std::uint64_t runs = 0;
    try {
      key = row.at("name").get<std::string>(), s.dtype = row.at("dtype").get<std::string>(),
      hash = row.at("xxh3").get<std::string>();
      for (const auto& d : row.at("shape")) s.shape.push_back(json_integer<std::uint64_t>(d));
      stored.from = json_integer<std::uint64_t>(row.at("offset")),
      stored.size = json_integer<std::uint64_t>(row.at("length"));
      if (row.contains("runs")) runs = json_integer<std::uint64_t>(row.at("runs"));
    } catch (const nlohmann::json::exception&) {
      fail("its table of sections is malformed");
    } catch (const std::out_of_range&) {
      fail("its table of sections is malformed");
    }
    const auto quoted = "section '" + shown(key) + "'";
    if (std::from_chars(hash.data(), hash.data() + hash.size(), s.hash, 16).ptr != hash.data() + 16 ||
        hash.size() != 16)
      fail(quoted + " has a malformed hash");
    if (stored.from < start + sizeof(Head) || stored.from > end || stored.size > end - stored.from)
      fail(quoted + " lies outside of the file");
    if (stored.from % kerf::alignment != 0) fail(quoted + " is not aligned");
    taken.push_back(stored);
    if (runs > 0) {
      s = patched(key, std::move(s), stored, runs);
    } else {
      std::uint64_t count = kerf::size_of(s.dtype);
      for (const auto d : s.shape) {
        if (d != 0 && count > stored.size / d) fail(quoted + " is larger than the file says");
        count *= d;
      }
      if (kerf::size_of(s.dtype) != 0 && count != stored.size) fail(quoted + " has another size than its shape");
      s.bytes = stored.size;
      if (s.bytes > 0) s.pieces = {stored};
    }
    if (!found.emplace(key, std::move(s)).second) fail(quoted + " is there twice");
  }
  std::sort(taken.begin(), taken.end(),
            [](const Piece& a, const Piece& b) { return std::pair(a.from, a.size) < std::pair(b.from, b.size); });
  for (std::size_t i = 1; i < taken.size(); ++i)
    if (taken[i].from - taken[i - 1].from < taken[i - 1].size) fail("two of its sections overlap");
  for (auto& [key, s] : found) sections_[key] = std::move(s);
}

// Runs take rows of the section before in ascending order, each at most once: no file unfolds to more than its size.
KerfFile::Section KerfFile::patched(const std::string& key, Section s, const Piece& stored, std::uint64_t runs) const {
  const auto quoted = "section '" + shown(key) + "'";
  const auto before = sections_.find(key);
  if (before == sections_.end()) fail(quoted + " changes one that is not there");
  const Section& old = before->second;
  if (old.dtype != s.dtype || s.shape.empty() || old.shape.size() != s.shape.size() ||
      !std::equal(s.shape.begin() + 1, s.shape.end(), old.shape.begin() + 1))
    fail(quoted + " changes one of another kind");
  const std::uint64_t width = kerf::row_bytes(s.dtype, s.shape);
  if (width == 0 || runs > stored.size / sizeof(Run)) fail(quoted + " has another size than its shape");
  std::vector<Run> list(runs);
  input_.read(stored.from, std::as_writable_bytes(std::span(list)));
  std::uint64_t used = 0, given = stored.from + runs * sizeof(Run);
  const std::uint64_t end = stored.from + stored.size;
  const auto add = [&](std::uint64_t from, std::uint64_t size) {
    if (!s.pieces.empty() && s.pieces.back().from + s.pieces.back().size == from)
      s.pieces.back().size += size;
    else
      s.pieces.push_back({s.bytes, from, size});
    s.bytes += size;
  };
  auto piece = old.pieces.begin();
  for (const Run& run : list) {
    if (run.count == 0 || run.count > std::max(end, old.bytes) / width)
      fail(quoted + " has a run that is out of range");
    if (run.from == kerf::literal) {
      if (run.count * width > end - given) fail(quoted + " has a run that is out of range");
      add(given, run.count * width);
      given += run.count * width;
      continue;
    }
    if (run.from < used || run.from > old.bytes / width || run.count > old.bytes / width - run.from)
      fail(quoted + " has a run that is out of range");
    used = run.from + run.count;
    for (std::uint64_t at = run.from * width, last = used * width; at < last;) {
      while (piece->at + piece->size <= at) ++piece;
      const std::uint64_t size = std::min(last, piece->at + piece->size) - at;
      add(piece->from + (at - piece->at), size);
      at += size;
    }
  }
  if (given != end || s.bytes % width != 0 || s.bytes / width != s.shape[0])
    fail(quoted + " has another size than its shape");
  return s;
}

const KerfFile::Section& KerfFile::expect(const std::string& section, const std::string& dtype,
                                          std::uint64_t columns) const {
  const auto it = sections_.find(section);
  if (it == sections_.end()) fail("has no section '" + section + "'");
  const Section& s = it->second;
  if (s.dtype != dtype || s.shape.size() != (columns > 1 ? 2u : 1u) || (columns > 1 && s.shape[1] != columns))
    fail("section '" + section + "' is not of the expected type and shape");
  return s;
}

std::string KerfFile::text(const std::string& section) const {
  std::string bytes(expect(section, "json", 1).bytes, '\0');
  read(section, std::as_writable_bytes(std::span(bytes)));
  return bytes;
}

void KerfFile::fetch(const Section& s, std::uint64_t at, std::span<std::byte> out) const {
  auto piece =
      std::upper_bound(s.pieces.begin(), s.pieces.end(), at, [](std::uint64_t x, const Piece& p) { return x < p.at; });
  for (--piece; !out.empty(); ++piece) {
    const std::uint64_t skip = at - piece->at;
    const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(out.size(), piece->size - skip));
    input_.read(piece->from + skip, out.first(n));
    out = out.subspan(n), at += n;
  }
}

void KerfFile::read(const std::string& section, std::span<std::byte> out) const {
  const Section& s = sections_.at(section);
  // Read and hashed while still in the cache.
  std::vector<std::uint64_t> blocks((out.size() + kerf::hash_block - 1) / kerf::hash_block);
  parallel_for(blocks.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      const auto block =
          out.subspan(b * kerf::hash_block, std::min(kerf::hash_block, out.size() - b * kerf::hash_block));
      fetch(s, b * kerf::hash_block, block);
      if (version_ > 1) blocks[b] = kerf::hash_of(block.data(), block.size());
    }
  });
  const auto hash = version_ > 1 ? kerf::hash_of(blocks) : kerf::hash_of(out.data(), out.size());
  if (hash != s.hash) fail("section '" + shown(section) + "' does not match its hash");
}

void KerfFile::stream(const std::string& section, KerfSink& sink) const {
  const Section& s = sections_.at(section);
  std::vector<std::byte> block(version_ > 1 ? std::min<std::uint64_t>(s.bytes, kerf::hash_block) : s.bytes);
  std::vector<std::uint64_t> hashes;
  for (std::uint64_t at = 0; at < s.bytes; at += block.size()) {
    const auto part =
        std::span(block).first(static_cast<std::size_t>(std::min<std::uint64_t>(block.size(), s.bytes - at)));
    fetch(s, at, part);
    hashes.push_back(kerf::hash_of(part.data(), part.size()));
    sink.write(part);
  }
  const auto hash = version_ > 1 || s.bytes == 0 ? kerf::hash_of(hashes) : hashes[0];
  if (hash != s.hash) fail("section '" + shown(section) + "' does not match its hash");
}

void write_compacted(std::ostream& out, const KerfFile& file) {
  std::vector<KerfArray> arrays;
  for (const auto& [name, section] : file.sections())
    if (kerf::size_of(section.dtype) != 0)
      arrays.push_back(
          {name, section.dtype, section.shape, [&file, key = name](KerfSink& sink) { file.stream(key, sink); }});
  write_kerf(out, arrays);
}

}  // namespace geo
