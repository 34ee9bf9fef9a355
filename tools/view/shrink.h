// Coarser surfaces for looking at, whatever their size: vertices in one cell of a grid become one (Rossignac and Borrel
// 1993), apart for each piece and each sheet of a crack. Not closed any more where sheets meet skin.
#pragma once

#include <cstdint>
#include <vector>

#include <kerf/mesh.h>

namespace view {

/// At most `most` triangles, more only where there are more sheets: positions, triangles and patch; `kept` receives the
/// row that stands for each row of the result. `piece`: per vertex row.
geo::TriangleMesh shrink(const geo::TriangleMesh& mesh, const std::vector<std::uint32_t>& piece, std::size_t most,
                         std::vector<std::uint32_t>& kept);

}  // namespace view
