// The files of a run that other programs read: ParaView collection, USD.
#pragma once

#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "surface/triangle_mesh.h"

namespace geo {

/// A ParaView collection of numbered frames.
void write_pvd(std::ostream& out, const std::vector<std::string>& frames, double frame_rate);
/// A USD layer whose mesh has time samples of points, counts and indices: topology may change per frame. `frame` gives each
/// of `count` frames, three times; one is in memory at a time.
void write_usda(std::ostream& out, std::size_t count, const std::function<TriangleMesh(std::size_t)>& frame, double frame_rate);

}  // namespace geo
