// Fronts and sheets in files: `.front` text and OBJ polylines.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "kerf/crack.h"

namespace geo {

/// Reads fronts from a file ("-": standard input). A `.front` file has `front NAME [closed]`, then
/// `step T` and lines `x y z` for each time step; or `sheet NAME`, then `v x y z` and `f a b c`;
/// `#` begins a comment. An OBJ file has `l` polylines, one object for each step, in the order of
/// their names. Throws InputError, with file and line, for fronts with fewer than two points or two
/// steps, numbers that are not finite, and unknown words.
std::vector<Front> read_fronts(const std::string& path);
/// The same from bytes in memory; `name` stands for the file in messages.
std::vector<Front> parse_fronts(const std::string& bytes, const std::string& name);
/// Reads curves: as read_fronts(), but one step is enough.
std::vector<Front> read_curves(const std::string& path);
/// Writes `.front` text. Numbers have enough digits to be read back exactly.
void write_fronts(std::ostream& out, const std::vector<Front>& fronts);

}  // namespace geo
