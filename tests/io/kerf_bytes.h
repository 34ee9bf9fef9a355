// `.kerf` files taken apart and sealed again, so that damage gets past the hashes.
#pragma once

#include <catch2/catch.hpp>
#include <map>
#include <sstream>
#include <string>

#include "io/kerf_append.h"
#include "io/kerf_layout_internal.h"

/// The last segment of a file's bytes: where it begins, and its table.
struct LastSegment {
  std::size_t start = 0;
  geo::kerf::Head head;
  std::string table;
};
inline LastSegment last_segment(const std::string& bytes) {
  LastSegment last;
  for (std::size_t at = 0; at < bytes.size();) {
    last.start = at;
    std::memcpy(&last.head, bytes.data() + at, sizeof last.head);
    at = geo::kerf::aligned(last.head.table + last.head.table_length) + sizeof(geo::kerf::Commit);
  }
  last.table = bytes.substr(last.head.table, last.head.table_length);
  return last;
}

/// The bytes with another table in the last segment, all hashes but the sections' own fitting.
inline std::string with_table(const std::string& bytes, const std::string& table) {
  LastSegment last = last_segment(bytes);
  last.head.table_length = table.size();
  last.head.hash = last.head.own_hash();
  geo::kerf::Commit commit;
  commit.number = last.head.number, commit.table = last.head.table, commit.table_length = table.size();
  commit.table_hash = geo::kerf::hash_of(table.data(), table.size()), commit.head_hash = last.head.hash;
  commit.hash = commit.own_hash();
  std::string out = bytes.substr(0, last.head.table) + table;
  std::memcpy(out.data() + last.start, &last.head, sizeof last.head);
  out.resize(geo::kerf::aligned(out.size()));
  return out.append(reinterpret_cast<const char*>(&commit), sizeof commit);
}

/// What a file says: type, shape and bytes of each section.
using KerfState = std::map<std::string, std::pair<std::string, std::string>>;
inline KerfState state_of(const geo::KerfFile& file) {
  KerfState state;
  for (const auto& [name, s] : file.sections()) {
    std::string shape = s.dtype;
    for (const auto d : s.shape) shape += " " + std::to_string(d);
    std::ostringstream bytes;
    geo::KerfSink sink([&](std::span<const std::byte> block) { bytes.write(reinterpret_cast<const char*>(block.data()), static_cast<std::streamsize>(block.size())); });
    file.stream(name, sink);
    sink.finish();
    std::string again(s.bytes, '\0');
    file.read(name, std::as_writable_bytes(std::span(again)));
    REQUIRE(again == bytes.str());
    state[name] = {shape, std::move(again)};
  }
  return state;
}
inline KerfState state_of(std::string bytes) { return state_of(geo::KerfFile(geo::Input(std::move(bytes), "f.kerf"))); }
