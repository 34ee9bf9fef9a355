// Writing one segment of a `.kerf` file. A new file has one segment, and each update appends one.
#pragma once

#include "io/kerf_layout.h"
#include "io/kerf_writer.h"

namespace geo::kerf {

/// An array to store: whole, or as runs of rows. A run of rows is copied from the previous version
/// of the array (same name, earlier segment), or it is literal: stored in this segment.
struct Stored {
  KerfArray array;
  std::vector<Run> runs;           ///< none: the array is stored whole
  std::uint64_t literal_rows = 0;  ///< with runs: how many rows `array.fill` puts
  std::uint64_t hash = 0;          ///< with runs: of the array that results
};

/// Size of a row of an array in bytes: the product of all dimensions of `shape` but the first
/// (number of rows), times the size of `dtype`.
std::uint64_t row_bytes(const std::string& dtype, const std::vector<std::uint64_t>& shape);

/// Writes a segment that begins at `start`, without its commit record. Returns the record, which
/// the caller writes once the segment is on the disk. `number`: of the segment in the file, from 0.
/// `previous`: hash of the commit record before; 0 for the first segment.
Commit write_segment(const KerfSink::Take& out, std::uint64_t start, std::uint32_t number, std::uint64_t previous,
                     const std::vector<Stored>& sections);

/// Size in bytes of a segment that begins at `start`, with its commit record.
std::uint64_t segment_size(std::uint64_t start, const std::vector<Stored>& sections);

}  // namespace geo::kerf
