// Reads a PNG as brightness, for kerf-score.
#pragma once

#include <string>

#include <kerf/score.h>

namespace tool {

/// The brightness of a PNG's pixels; what is transparent is white.
/// \throws geo::InputError, which begins with the path, for another file, a damaged one, or one of
///   more than 16 million pixels
geo::GrayImage read_png(const std::string& path);

}  // namespace tool
