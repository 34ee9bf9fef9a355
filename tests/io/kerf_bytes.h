// Changes `.kerf` files and recomputes their hashes, so that damage passes the checks of hashes.
#pragma once

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <string>

#include "io/kerf_layout.h"
#include "io/kerf_writer.h"
#include "kerf/body_file.h"

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

/// The bytes with another table in the last segment. All hashes fit but those of the sections.
inline std::string with_table(const std::string& bytes, const std::string& table) {
  LastSegment last = last_segment(bytes);
  last.head.table_length = table.size();
  last.head.hash = last.head.own_hash();
  geo::kerf::Commit commit;
  commit.number = last.head.number;
  commit.table = last.head.table;
  commit.table_length = table.size();
  commit.table_hash = geo::kerf::hash_of(table.data(), table.size());
  commit.head_hash = last.head.hash;
  commit.hash = commit.own_hash();
  std::string out = bytes.substr(0, last.head.table) + table;
  out.replace(last.start, sizeof last.head, reinterpret_cast<const char*>(&last.head), sizeof last.head);
  out.resize(geo::kerf::aligned(out.size()));
  return out.append(reinterpret_cast<const char*>(&commit), sizeof commit);
}

/// The bytes with every hash, number and commit record recomputed, where possible.
inline std::string resealed(std::string bytes) {
  using namespace geo::kerf;
  std::map<std::string, std::string> state;
  const auto result = [&](const nlohmann::ordered_json& row, const std::string& stored) {
    if (!row.contains("runs")) return stored;
    std::uint64_t width = size_of(row.at("dtype"));
    for (std::size_t d = 1; d < row.at("shape").size(); ++d) width *= row["shape"][d].get<std::uint64_t>();
    const std::string& before = state[row.at("name")];
    std::string values;
    std::size_t given = row["runs"].get<std::size_t>() * sizeof(Run);
    for (std::size_t at = 0; at + sizeof(Run) <= std::min(given, stored.size()); at += sizeof(Run)) {
      Run run;
      std::memcpy(&run, stored.data() + at, sizeof run);
      const std::string& source = run.from == literal ? stored : before;
      const std::size_t from = run.from == literal ? given : run.from * width;
      if (from > source.size() || values.size() > 1 << 20) break;
      values += source.substr(from, run.count * width);
      if (run.from == literal) given += run.count * width;
    }
    return values;
  };
  Commit last;
  for (std::size_t at = 0; at + sizeof(Head) <= bytes.size();) {
    Head head;
    std::memcpy(&head, bytes.data() + at, sizeof head);
    if (head.table < at + sizeof head || head.table > bytes.size() || head.table_length > bytes.size() - head.table)
      break;
    const std::size_t commit_at = aligned(head.table + head.table_length);
    if (commit_at + sizeof last > bytes.size()) break;
    try {
      auto table = nlohmann::ordered_json::parse(bytes.substr(head.table, head.table_length));
      for (auto& row : table) {
        const std::string values = state[row.at("name")] =
            result(row, bytes.substr(std::min(bytes.size(), row.at("offset").get<std::size_t>()),
                                     row.at("length").get<std::size_t>()));
        std::vector<std::uint64_t> blocks;
        for (std::size_t b = 0; b < values.size(); b += hash_block)
          blocks.push_back(hash_of(values.data() + b, std::min(hash_block, values.size() - b)));
        row["xxh3"] = hex(hash_of(blocks));
      }
      const std::string text = table.dump();
      if (text.size() == head.table_length) bytes.replace(head.table, text.size(), text);
    } catch (const nlohmann::json::exception&) {
    }
    head.number = at == 0 ? 0 : last.number + 1;
    head.previous = last.hash;
    head.hash = head.own_hash();
    std::memcpy(bytes.data() + at, &head, sizeof head);
    last = Commit();
    last.number = head.number;
    last.table = head.table;
    last.table_length = head.table_length;
    last.table_hash = hash_of(bytes.data() + head.table, head.table_length);
    last.head_hash = head.hash;
    last.hash = last.own_hash();
    std::memcpy(bytes.data() + commit_at, &last, sizeof last);
    at = commit_at + sizeof last;
  }
  return bytes;
}

/// The content of a file: type, shape and bytes of each section.
using KerfState = std::map<std::string, std::pair<std::string, std::string>>;
inline KerfState state_of(const geo::KerfFile& file) {
  KerfState state;
  for (const auto& [name, s] : file.sections()) {
    std::string shape = s.dtype;
    for (const auto d : s.shape) shape += " " + std::to_string(d);
    std::ostringstream bytes;
    geo::KerfSink sink([&](std::span<const std::byte> block) {
      bytes.write(reinterpret_cast<const char*>(block.data()), static_cast<std::streamsize>(block.size()));
    });
    file.stream(name, geo::into(sink));
    sink.finish();
    std::string again(s.bytes, '\0');
    file.read(name, std::as_writable_bytes(std::span(again)));
    if (again != bytes.str()) throw std::logic_error("section " + name + " differs when it is streamed");
    state[name] = {shape, std::move(again)};
  }
  return state;
}
inline KerfState state_of(std::string bytes) { return state_of(geo::KerfFile(geo::Input(std::move(bytes), "f.kerf"))); }
