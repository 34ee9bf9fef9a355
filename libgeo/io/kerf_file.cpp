// KerfFile of kerf/body_file.h. Segments are opened in order, each checked by the hashes of head,
// table and commit record. The content of a section is a list of extents of the file; an update
// refers to extents of the section before.
#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>

#include "io/json_integer.h"
#include "io/kerf_segment.h"
#include "io/kerf_writer.h"
#include "io/shown.h"
#include "kerf/body_file.h"
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

// A contiguous part of a section: `size` bytes from `at` in the section are at `from` in the file.
struct Extent {
  std::uint64_t at = 0, from = 0, size = 0;
};

// A section as its table entry describes it.
struct Entry {
  std::string name;
  KerfFile::Section section;
  std::uint64_t runs = 0;       // number of runs over the section before; 0: stored whole
  Extent stored;                // where its bytes are in the file
  std::vector<Extent> extents;  // in order, without gaps
};

template <class T>
bool all_zero(const T& value) {
  const auto bytes = kerf::bytes_of_one(value);
  return std::all_of(bytes.begin(), bytes.end(), [](std::byte b) { return b == std::byte(0); });
}

}  // namespace

bool looks_like_kerf(std::string_view bytes) {
  return bytes.size() >= 5 && std::memcmp(bytes.data(), Head().magic, 5) == 0;
}

struct KerfFile::Impl {
  explicit Impl(Input in) : input(std::move(in)) {}
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(input.name() + ": " + what + "; the file is damaged");
  }
  void open();
  void open_version_1();
  bool open_segment(std::uint64_t start);
  void open_table(const std::string& text, std::uint64_t start, std::uint64_t end);
  Entry parse_entry(const nlohmann::json& row) const;
  void locate(Entry& entry, std::uint64_t start, std::uint64_t end) const;
  void apply_runs(Entry& entry) const;
  const Section& expect(const std::string& name, const std::string& dtype, std::uint64_t columns) const;
  void fetch(const std::vector<Extent>& extents, std::uint64_t at, std::span<std::byte> out) const;

  Input input;
  std::map<std::string, Section> sections;
  std::map<std::string, std::vector<Extent>> extents;  // by section
  std::uint64_t committed = 0, fingerprint = 0;
  std::uint32_t version = kerf_format_version, segments = 0;
};

void KerfFile::Impl::open() {
  const std::string begin = input.text(0, sizeof(Head));
  const std::string& name = input.name();
  if (!looks_like_kerf(begin)) throw InputError(name + ": is not a .kerf file; make one with kerf-graph");
  if (begin.size() < sizeof(Head)) throw InputError(name + ": ends within its header; the file is truncated");
  Head head;
  std::memcpy(&head, begin.data(), sizeof head);
  if (std::memcmp(head.magic, Head().magic, sizeof head.magic) != 0)
    throw InputError(name + ": was damaged by a text transfer; copy it as binary");
  if (head.endian != Head().endian)
    throw InputError(name + ": has another byte order than this machine, or is damaged");
  version = head.version;
  if (version == 0 || version > kerf_format_version)
    throw InputError(name + ": is of version " + std::to_string(version) + ", newer than " +
                     std::to_string(kerf_format_version) + " that this program reads; update it");
  if (version == 1)
    open_version_1();
  else
    while (open_segment(committed)) {
    }
  if (segments == 0) throw InputError(name + ": holds no complete commit; the file is truncated");
}

// Version 1 had one segment, no hash of the head, and a record of 32 bytes at the end.
void KerfFile::Impl::open_version_1() {
  struct Record {
    char word[8];
    std::uint64_t table, length, hash;
  };
  if (input.size() < sizeof(Head) + sizeof(Record))
    throw InputError(input.name() + ": holds no complete commit; the file is truncated");
  const std::uint64_t at = input.size() - sizeof(Record);
  const auto record = read_one<Record>(input, at);
  if (std::memcmp(record.word, Commit().word, sizeof record.word) != 0)
    throw InputError(input.name() + ": holds no complete commit; the file is truncated");
  if (record.table > at || record.length > at - record.table) fail("its table of sections lies outside of the file");
  const std::string table = input.text(record.table, record.length);
  if (kerf::hash_of(table.data(), table.size()) != record.hash) fail("its table of sections does not match its hash");
  open_table(table, 0, record.table);
  committed = input.size();
  fingerprint = record.hash;
  segments = 1;
}

// False at the end of the last complete commit. Only the beginning of a segment may follow there,
// or zeros where the system allocated one: anything else is damage. So no changed bit restores an
// older state.
bool KerfFile::Impl::open_segment(std::uint64_t start) {
  const std::uint64_t room = input.size() - start;
  if (room == 0) return false;
  Head expected;
  expected.number = segments;
  expected.previous = fingerprint;
  const auto damaged = [&] {
    fail(segments == 0
             ? "its header does not match its hash"
             : "what follows commit " + std::to_string(segments) + " is neither a commit nor the beginning of one");
  };
  if (room < sizeof(Head)) {
    std::byte begin[sizeof(Head)] = {};
    input.read(start, std::span(begin).first(room));
    if (!all_zero(begin) && std::memcmp(begin, &expected, std::min<std::size_t>(room, offsetof(Head, table))) != 0)
      damaged();
    return false;
  }
  const auto head = read_one<Head>(input, start);
  if (segments > 0 && all_zero(head)) return false;
  if (head.hash != head.own_hash() || std::memcmp(&head, &expected, offsetof(Head, table)) != 0 ||
      head.previous != expected.previous)
    damaged();
  if (head.table < start + sizeof(Head) || head.table % kerf::alignment != 0 ||
      head.table > ~head.table_length - kerf::alignment)
    damaged();
  const std::uint64_t commit_at = kerf::aligned(head.table + head.table_length);
  if (input.size() < sizeof(Commit) || commit_at > input.size() - sizeof(Commit)) return false;
  const auto commit = read_one<Commit>(input, commit_at);
  if (all_zero(commit) && commit_at + sizeof(Commit) == input.size()) return false;
  if (std::memcmp(commit.word, Commit().word, sizeof commit.word) != 0 || commit.hash != commit.own_hash() ||
      commit.number != head.number || commit.head_hash != head.hash || commit.table != head.table ||
      commit.table_length != head.table_length)
    fail("commit record " + std::to_string(segments) + " does not match its hash");
  const std::string table = input.text(head.table, head.table_length);
  if (kerf::hash_of(table.data(), table.size()) != commit.table_hash)
    fail("its table of sections does not match its hash");
  open_table(table, start, head.table);
  committed = commit_at + sizeof(Commit);
  fingerprint = commit.hash;
  ++segments;
  return true;
}

// Parses a row of the table of sections.
Entry KerfFile::Impl::parse_entry(const nlohmann::json& row) const {
  Entry entry;
  std::string hash;
  try {
    entry.name = row.at("name").get<std::string>();
    entry.section.dtype = row.at("dtype").get<std::string>();
    hash = row.at("xxh3").get<std::string>();
    for (const auto& d : row.at("shape")) entry.section.shape.push_back(json_integer<std::uint64_t>(d));
    entry.stored.from = json_integer<std::uint64_t>(row.at("offset"));
    entry.stored.size = json_integer<std::uint64_t>(row.at("length"));
    if (row.contains("runs")) entry.runs = json_integer<std::uint64_t>(row.at("runs"));
  } catch (const nlohmann::json::exception&) {
    fail("its table of sections is malformed");
  } catch (const std::out_of_range&) {
    fail("its table of sections is malformed");
  }
  if (std::from_chars(hash.data(), hash.data() + hash.size(), entry.section.hash, 16).ptr != hash.data() + 16 ||
      hash.size() != 16)
    fail("section '" + shown(entry.name) + "' has a malformed hash");
  return entry;
}

// Checks that the section lies between `start` and `end` of the file, and finds its extents.
void KerfFile::Impl::locate(Entry& entry, std::uint64_t start, std::uint64_t end) const {
  const auto quoted = "section '" + shown(entry.name) + "'";
  const Extent& stored = entry.stored;
  Section& s = entry.section;
  if (stored.from < start + sizeof(Head) || stored.from > end || stored.size > end - stored.from)
    fail(quoted + " lies outside of the file");
  if (stored.from % kerf::alignment != 0) fail(quoted + " is not aligned");
  if (entry.runs > 0) return apply_runs(entry);
  std::uint64_t count = kerf::size_of(s.dtype);
  for (const auto d : s.shape) {
    if (d != 0 && count > stored.size / d) fail(quoted + " is larger than the file says");
    count *= d;
  }
  if (kerf::size_of(s.dtype) != 0 && count != stored.size) fail(quoted + " has another size than its shape");
  s.bytes = stored.size;
  if (s.bytes > 0) entry.extents = {stored};
}

// Reads the table of a segment whose sections lie between `start` and `end`.
void KerfFile::Impl::open_table(const std::string& text, std::uint64_t start, std::uint64_t end) {
  const auto table = nlohmann::json::parse(text, nullptr, false);
  if (!table.is_array()) fail("its table of sections is malformed");
  std::map<std::string, Entry> found;
  std::vector<Extent> taken;
  for (const auto& row : table) {
    Entry entry = parse_entry(row);
    locate(entry, start, end);
    taken.push_back(entry.stored);
    const std::string name = entry.name;
    if (!found.emplace(name, std::move(entry)).second) fail("section '" + shown(name) + "' is there twice");
  }
  std::sort(taken.begin(), taken.end(),
            [](const Extent& a, const Extent& b) { return std::pair(a.from, a.size) < std::pair(b.from, b.size); });
  for (std::size_t i = 1; i < taken.size(); ++i)
    if (taken[i].from - taken[i - 1].from < taken[i - 1].size) fail("two of its sections overlap");
  for (auto& [name, entry] : found) {
    sections[name] = std::move(entry.section);
    extents[name] = std::move(entry.extents);
  }
}

// The content of a section from runs of rows: of the section before, in ascending order and each at
// most once, or stored in this segment. So no file expands to more than its size.
void KerfFile::Impl::apply_runs(Entry& entry) const {
  const auto quoted = "section '" + shown(entry.name) + "'";
  const auto before = sections.find(entry.name);
  if (before == sections.end()) fail(quoted + " changes one that is not there");
  Section& s = entry.section;
  const Section& old = before->second;
  if (old.dtype != s.dtype || s.shape.empty() || old.shape.size() != s.shape.size() ||
      !std::equal(s.shape.begin() + 1, s.shape.end(), old.shape.begin() + 1))
    fail(quoted + " changes one of another kind");
  const Extent& stored = entry.stored;
  const std::uint64_t width = kerf::row_bytes(s.dtype, s.shape);
  if (width == 0 || entry.runs > stored.size / sizeof(Run)) fail(quoted + " has another size than its shape");
  std::vector<Run> list(entry.runs);
  input.read(stored.from, std::as_writable_bytes(std::span(list)));
  std::uint64_t used = 0, given = stored.from + entry.runs * sizeof(Run);
  const std::uint64_t end = stored.from + stored.size;
  const auto add = [&](std::uint64_t from, std::uint64_t size) {
    if (!entry.extents.empty() && entry.extents.back().from + entry.extents.back().size == from)
      entry.extents.back().size += size;
    else
      entry.extents.push_back({s.bytes, from, size});
    s.bytes += size;
  };
  auto extent = extents.at(entry.name).begin();
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
      while (extent->at + extent->size <= at) ++extent;
      const std::uint64_t size = std::min(last, extent->at + extent->size) - at;
      add(extent->from + (at - extent->at), size);
      at += size;
    }
  }
  if (given != end || s.bytes % width != 0 || s.bytes / width != s.shape[0])
    fail(quoted + " has another size than its shape");
}

const KerfFile::Section& KerfFile::Impl::expect(const std::string& name, const std::string& dtype,
                                                std::uint64_t columns) const {
  const auto it = sections.find(name);
  if (it == sections.end()) fail("has no section '" + name + "'");
  const Section& s = it->second;
  if (s.dtype != dtype || s.shape.size() != (columns > 1 ? 2u : 1u) || (columns > 1 && s.shape[1] != columns))
    fail("section '" + name + "' is not of the expected type and shape");
  return s;
}

// Reads bytes of a section from `at` on.
void KerfFile::Impl::fetch(const std::vector<Extent>& from, std::uint64_t at, std::span<std::byte> out) const {
  auto extent =
      std::upper_bound(from.begin(), from.end(), at, [](std::uint64_t x, const Extent& e) { return x < e.at; });
  for (--extent; !out.empty(); ++extent) {
    const std::uint64_t skip = at - extent->at;
    const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(out.size(), extent->size - skip));
    input.read(extent->from + skip, out.first(n));
    out = out.subspan(n);
    at += n;
  }
}

KerfFile::KerfFile(Input input) : impl_(std::make_unique<Impl>(std::move(input))) { impl_->open(); }
KerfFile::KerfFile(KerfFile&& other) noexcept = default;
KerfFile::~KerfFile() = default;

const std::string& KerfFile::name() const { return impl_->input.name(); }
const std::map<std::string, KerfFile::Section>& KerfFile::sections() const { return impl_->sections; }
std::uint64_t KerfFile::committed() const { return impl_->committed; }
std::uint32_t KerfFile::updates() const { return impl_->segments - 1; }
std::uint64_t KerfFile::fingerprint() const { return impl_->fingerprint; }
std::uint32_t KerfFile::version() const { return impl_->version; }
void KerfFile::fail(const std::string& what) const { impl_->fail(what); }

std::string KerfFile::text(const std::string& section) const {
  std::string bytes(impl_->expect(section, "json", 1).bytes, '\0');
  read(section, std::as_writable_bytes(std::span(bytes)));
  return bytes;
}

template <class T>
std::vector<T> KerfFile::read(const std::string& section, std::uint64_t columns) const {
  std::vector<T> values(impl_->expect(section, kerf_dtype<T>(), columns).bytes / sizeof(T));
  read(section, std::as_writable_bytes(std::span(values)));
  return values;
}
template std::vector<double> KerfFile::read(const std::string&, std::uint64_t) const;
template std::vector<float> KerfFile::read(const std::string&, std::uint64_t) const;
template std::vector<std::uint64_t> KerfFile::read(const std::string&, std::uint64_t) const;
template std::vector<std::uint32_t> KerfFile::read(const std::string&, std::uint64_t) const;
template std::vector<std::int32_t> KerfFile::read(const std::string&, std::uint64_t) const;
template std::vector<std::uint16_t> KerfFile::read(const std::string&, std::uint64_t) const;
template std::vector<std::uint8_t> KerfFile::read(const std::string&, std::uint64_t) const;

void KerfFile::read(const std::string& section, std::span<std::byte> out) const {
  const std::uint64_t expected = impl_->sections.at(section).hash;
  const std::vector<Extent>& from = impl_->extents.at(section);
  const bool in_blocks = impl_->version > 1;
  // Each block is hashed while it is in the cache.
  std::vector<std::uint64_t> blocks((out.size() + kerf::hash_block - 1) / kerf::hash_block);
  parallel_for(blocks.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      const auto block =
          out.subspan(b * kerf::hash_block, std::min(kerf::hash_block, out.size() - b * kerf::hash_block));
      impl_->fetch(from, b * kerf::hash_block, block);
      if (in_blocks) blocks[b] = kerf::hash_of(block.data(), block.size());
    }
  });
  const auto hash = in_blocks ? kerf::hash_of(blocks) : kerf::hash_of(out.data(), out.size());
  if (hash != expected) fail("section '" + shown(section) + "' does not match its hash");
}

void KerfFile::stream(const std::string& section, const std::function<void(std::span<const std::byte>)>& take) const {
  const Section& s = impl_->sections.at(section);
  const std::vector<Extent>& from = impl_->extents.at(section);
  const bool in_blocks = impl_->version > 1;
  std::vector<std::byte> block(in_blocks ? std::min<std::uint64_t>(s.bytes, kerf::hash_block) : s.bytes);
  std::vector<std::uint64_t> hashes;
  for (std::uint64_t at = 0; at < s.bytes; at += block.size()) {
    const auto part =
        std::span(block).first(static_cast<std::size_t>(std::min<std::uint64_t>(block.size(), s.bytes - at)));
    impl_->fetch(from, at, part);
    hashes.push_back(kerf::hash_of(part.data(), part.size()));
    take(part);
  }
  const auto hash = in_blocks || s.bytes == 0 ? kerf::hash_of(hashes) : hashes[0];
  if (hash != s.hash) fail("section '" + shown(section) + "' does not match its hash");
}

void write_compacted(std::ostream& out, const KerfFile& file) {
  std::vector<KerfArray> arrays;
  for (const auto& [name, section] : file.sections())
    if (kerf::size_of(section.dtype) != 0)
      arrays.push_back(
          {.name = name, .dtype = section.dtype, .shape = section.shape, .fill = [&file, key = name](KerfSink& sink) {
             file.stream(key, into(sink));
           }});
  write_kerf(out, arrays);
}

}  // namespace geo
