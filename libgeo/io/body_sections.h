// A body's file with further sections behind it, as a checkpoint has, and the points of sections.
#pragma once

#include <ostream>
#include <span>
#include <string>
#include <vector>

#include "io/kerf_writer.h"
#include "kerf/body.h"
#include "kerf/body_file.h"

namespace geo {

/// Writes a body as write_body() does, then `more`, which readers of bodies ignore.
void write_body_with(std::ostream& out, const Body& body, const std::vector<KerfArray>& more);

/// The coordinates of points as a section of three columns has them. Refers to `points`.
std::span<const double> coordinates(const std::vector<Vec3>& points);

/// The points of a section of three columns. Throws InputError where a value is out of range, and
/// as KerfFile::read().
std::vector<Vec3> read_points(const KerfFile& file, const std::string& section);

}  // namespace geo
