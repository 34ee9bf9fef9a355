// Reports on one node, one pair of nodes or one surface vertex of a body, or one vertex of a
// surface.
#pragma once

#include <kerf/body.h>
#include "info/report.h"

namespace info {

/// A node: its edges, neighbours, component and masters. Like the others, throws InputError for an
/// id that the body does not have.
void ask_node(const geo::Body& body, std::size_t i, Report& report);
/// A pair of nodes: whether they share an edge, whether they are neighbours, their straight
/// distance and that along the graph, and the faces between them.
void ask_edge(const geo::Body& body, std::size_t i, std::size_t j, Report& report);
/// A surface vertex, by its index in the body's file: position, patches, and the path up its tree
/// to the node that carries it.
void ask_vertex(const geo::Body& body, std::size_t v, Report& report);
/// A vertex of a surface, by its index.
void ask_vertex(const geo::TriangleMesh& mesh, std::size_t v, Report& report);

}  // namespace info
