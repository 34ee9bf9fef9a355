// Edges that cracks have cut, and nodes whose neighbours changed: red in the paper's Fig. 4c.
#pragma once

#include <utility>
#include <vector>

#include <kerf/body.h>

namespace view {

/// Pairs i < j that are no longer edges: edges of `before`, an earlier state of the same body;
/// without it, the edges that there would be if only the skin blocked sight.
std::vector<std::pair<std::uint32_t, std::uint32_t>> cut_edges(const geo::Body& body, const geo::Body* before);

/// Per node: 1 where its edges or neighbours differ from those before, or it is new. Throws
/// InputError where `before` has more nodes.
std::vector<std::uint8_t> updated_nodes(const geo::Body& body, const geo::Body& before);

}  // namespace view
