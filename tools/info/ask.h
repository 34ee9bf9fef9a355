// What is known of one node, pair of nodes or surface vertex of a body, or one vertex of a surface.
#pragma once

#include <kerf/body.h>
#include "info/report.h"

namespace info {

/// All throw InputError for ids that the body does not have.
void ask_node(const geo::Body& body, std::size_t i, Report& report);
/// Edge or not, neighbours or not, lengths along the graph and straight, and the faces between them.
void ask_edge(const geo::Body& body, std::size_t i, std::size_t j, Report& report);
/// A surface vertex, by its row in the body's file: place, patches, and the way up its tree to the node that carries
/// it.
void ask_vertex(const geo::Body& body, std::size_t v, Report& report);
/// A row of a surface.
void ask_vertex(const geo::TriangleMesh& mesh, std::size_t v, Report& report);

}  // namespace info
