// Node sets in files: PCD, which pcl_viewer opens, and PLY.
#pragma once

#include <ostream>
#include <string>

#include "kerf/nodes.h"

namespace geo {

/// Reads PCD (ASCII or binary) or PLY ("-": standard input) with the fields x, y, z, radius,
/// spacing and volume. Throws InputError that names a missing field, and for malformed files.
NodeSet read_nodes(const std::string& path);
/// The same from bytes in memory; `name` stands for the file in messages.
NodeSet parse_nodes(const std::string& bytes, const std::string& name);

/// Writes binary PCD with double-precision fields, which are read back exactly.
void write_pcd(std::ostream& out, const NodeSet& nodes);
/// Writes binary PLY with double-precision properties, which are read back exactly.
void write_nodes_ply(std::ostream& out, const NodeSet& nodes);

}  // namespace geo
