// Coarser surfaces for pages: vertices in one cell of a grid are merged (Rossignac and Borrel
// 1993), separately for each piece and crack sheet. The result is open where sheets meet the skin.
#pragma once

#include <cstdint>
#include <vector>

#include <kerf/mesh.h>

namespace view {

/// At most `most` triangles, unless there are more sheets, with patch. `kept` receives the vertex
/// of `mesh` for each vertex of the result. `piece`: per vertex.
geo::TriangleMesh shrink(const geo::TriangleMesh& mesh, const std::vector<std::uint32_t>& piece, std::size_t most,
                         std::vector<std::uint32_t>& kept);

}  // namespace view
