// A segment: head, sections aligned to 64 bytes, table of sections as JSON, commit record. The
// position of the table is known before the arrays are written.
#include "io/kerf_writer.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "io/kerf_segment.h"

namespace geo {

KerfSink::KerfSink(Take take) : take_(std::move(take)), block_(kerf::hash_block) {}

void KerfSink::write(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    std::size_t n = std::min(bytes.size(), block_.size() - used_);
    if (n == block_.size()) {
      take_(bytes.first(n));
      taken_ += n;
    } else {
      std::memcpy(block_.data() + used_, bytes.data(), n);
      used_ += n;
      if (used_ == block_.size()) {
        take_(block_);
        taken_ += used_;
        used_ = 0;
      }
    }
    bytes = bytes.subspan(n);
  }
}

std::uint64_t KerfSink::finish() {
  if (used_ > 0) take_(std::span(block_).first(used_));
  taken_ += used_;
  used_ = 0;
  return taken_;
}

void write_kerf(std::ostream& out, const std::vector<KerfArray>& arrays) {
  std::vector<kerf::Stored> sections;
  for (const auto& a : arrays) sections.push_back({.array = a, .runs = {}, .literal_rows = 0, .hash = 0});
  const auto put = [&](std::span<const std::byte> bytes) {
    out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  };
  put(kerf::bytes_of_one(kerf::write_segment(put, 0, 0, 0, sections)));
}

}  // namespace geo

namespace geo::kerf {
namespace {

// Layout of a segment: offset, length and hash of each section, and the offset of the table.
struct Plan {
  std::vector<std::uint64_t> offsets, lengths, hashes;
  std::uint64_t table = 0;
  // The table as JSON. Hashes have all their digits, so its length does not depend on them.
  std::string text(const std::vector<Stored>& sections) const {
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (std::size_t i = 0; i < sections.size(); ++i) {
      const auto& [name, dtype, shape, fill] = sections[i].array;
      rows.push_back({{"name", name},
                      {"dtype", dtype},
                      {"shape", shape},
                      {"offset", offsets[i]},
                      {"length", lengths[i]},
                      {"xxh3", hex(hashes[i])}});
      if (!sections[i].runs.empty()) rows.back()["runs"] = sections[i].runs.size();
    }
    return rows.dump();
  }
};

Plan plan_of(std::uint64_t start, const std::vector<Stored>& sections) {
  Plan plan;
  std::uint64_t at = start + sizeof(Head);
  for (const auto& s : sections) {
    const std::uint64_t rows = s.runs.empty() ? (s.array.shape.empty() ? 1 : s.array.shape[0]) : s.literal_rows;
    plan.offsets.push_back(at);
    plan.lengths.push_back(rows * row_bytes(s.array.dtype, s.array.shape) + s.runs.size() * sizeof(Run));
    plan.hashes.push_back(s.hash);
    at = aligned(at + plan.lengths.back());
  }
  plan.table = at;
  return plan;
}

}  // namespace

std::uint64_t row_bytes(const std::string& dtype, const std::vector<std::uint64_t>& shape) {
  std::uint64_t bytes = size_of(dtype);
  for (std::size_t i = 1; i < shape.size(); ++i) bytes *= shape[i];
  return bytes;
}

std::uint64_t segment_size(std::uint64_t start, const std::vector<Stored>& sections) {
  const Plan plan = plan_of(start, sections);
  return aligned(plan.table + plan.text(sections).size()) + sizeof(Commit) - start;
}

Commit write_segment(const KerfSink::Take& out, std::uint64_t start, std::uint32_t number, std::uint64_t previous,
                     const std::vector<Stored>& sections) {
  static constexpr std::byte zeros[alignment] = {};
  std::uint64_t at = start;
  const auto put = [&](std::span<const std::byte> bytes) {
    out(bytes);
    at += bytes.size();
  };
  const auto pad = [&] { put(std::span(zeros).first(aligned(at) - at)); };
  Plan plan = plan_of(start, sections);
  Head head;
  head.number = number;
  head.previous = previous;
  head.table = plan.table;
  head.table_length = plan.text(sections).size();
  head.hash = head.own_hash();
  put(bytes_of_one(head));
  for (std::size_t i = 0; i < sections.size(); ++i) {
    const auto& s = sections[i];
    put(std::as_bytes(std::span(s.runs)));
    std::vector<std::uint64_t> blocks;
    KerfSink sink([&](std::span<const std::byte> block) {
      if (s.runs.empty()) blocks.push_back(hash_of(block.data(), block.size()));
      put(block);
    });
    s.array.fill(sink);
    if (sink.finish() != plan.lengths[i] - s.runs.size() * sizeof(Run))
      throw std::logic_error("section " + s.array.name + " has another size than its shape");
    if (s.runs.empty()) plan.hashes[i] = hash_of(blocks);
    pad();
  }
  const std::string table = plan.text(sections);
  put(std::as_bytes(std::span(table)));
  pad();
  Commit commit;
  commit.number = number;
  commit.table = plan.table;
  commit.table_length = table.size();
  commit.table_hash = hash_of(table.data(), table.size());
  commit.head_hash = head.hash;
  commit.hash = commit.own_hash();
  return commit;
}

}  // namespace geo::kerf
