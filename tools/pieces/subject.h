// The surface that is divided into pieces: of a file, a body, or a frame of a run.
#pragma once

#include <string>
#include <vector>

#include <kerf/complex.h>
#include <kerf/mesh.h>
#include "model.h"

namespace pieces {

struct Subject {
  geo::TriangleMesh mesh;  ///< undeformed, with its attributes; `complex` was made from it. Empty where a body's file
                           ///< has the complex itself
  geo::Complex complex;
  std::vector<geo::Vec3> moved;  ///< of a deformed frame: where its vertices are, by their rows in `mesh`; else empty
};

/// Reads any of them; of a run's folder the last frame. A frame with open cracks gets the
/// undeformed positions of its run's checkpoint.kerf, in the folder above, where its topology is
/// decided. With `repair`, a plain surface is repaired first; `say` takes what was
/// decided about shells. Throws InputError.
Subject read_subject(const std::string& path, bool repair, const tool::Say& say);

}  // namespace pieces
