// Node sets in files: PCD (x y z radius spacing volume; opens in pcl_viewer) and PLY.
#pragma once

#include <ostream>
#include <string>

#include "kerf/nodes.h"

namespace geo {

/// Reads PCD (ascii and binary) or PLY. Missing radius, spacing or volume are an InputError that says which.
NodeSet read_nodes(const std::string& path);
NodeSet parse_nodes(const std::string& bytes, const std::string& name);

/// Binary PCD, doubles (SIZE 8), so that what is read back equals what was written.
void write_pcd(std::ostream& out, const NodeSet& nodes);
void write_nodes_ply(std::ostream& out, const NodeSet& nodes);

}  // namespace geo
