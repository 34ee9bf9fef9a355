// Options and counts of cracks between Python and the library's structures.
#pragma once

#include "kerf/crack.h"
#include "keywords.h"

namespace kerf_python {

/// Takes snap, snap_edges, face_offset, clearance, jitter, attempts and seed. Throws as Keywords.
geo::CrackOptions crack_options(Keywords& keywords);
/// The counts and seconds of steps, by the names of geo::CrackStats.
py::dict dict_of(const geo::CrackStats& stats);

}  // namespace kerf_python
