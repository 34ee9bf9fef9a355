// Fronts in files: `.front` text and OBJ polylines.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "kerf/crack.h"

namespace geo {

/// `front NAME [closed]`, then `step T` and rows `x y z`; `sheet NAME`, then `v x y z` and `f a b c`; `#` comments. Or
/// OBJ with `l` polylines, one object a step in name order. Throws InputError with file and line: fewer than two
/// points, one step only, not finite, unknown words.
std::vector<Front> read_fronts(const std::string& path);
std::vector<Front> parse_fronts(const std::string& bytes, const std::string& name);
/// The same where lines need not move: one step is enough, each is a curve.
std::vector<Front> read_curves(const std::string& path);
/// Numbers in digits enough to read the same.
void write_fronts(std::ostream& out, const std::vector<Front>& fronts);

}  // namespace geo
