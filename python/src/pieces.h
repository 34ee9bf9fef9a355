// The class Piece: a mesh of one region of material, with its measures and hulls.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "kerf/pieces.h"
#include "mesh.h"

namespace kerf_python {

/// A piece of a cut model (§ 7). It is closed and oriented; a crack that ends inside it leaves two
/// faces at one place, so that calls which need a valid model check it when they need one.
struct Piece : Solid {
  /// Takes the chunk over.
  Piece(geo::Chunk&& chunk, std::uint32_t number)
      : Solid(std::move(chunk.mesh), true), index(number), volume(chunk.volume), centroid(chunk.centroid) {}
  const std::uint32_t index;  ///< its number among the pieces, by descending volume
  const double volume;        ///< model units cubed
  const geo::Vec3 centroid;   ///< of the material
  bool is_model() const override { return false; }
  std::vector<std::shared_ptr<Mesh>> hulls;  ///< convex hulls that cover it; empty unless wanted
};

/// Bonds as a structured array with the fields a, b, area, normal, centroid.
py::array bonds_array(std::vector<geo::Bond>&& bonds);

}  // namespace kerf_python
