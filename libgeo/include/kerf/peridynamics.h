// Bodies for peridynamics: bonds between nodes without those that a face crosses, and the files of
// three programs (docs/peridynamics.md).
#pragma once

#include <cstdint>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "kerf/body.h"
#include "kerf/vec.h"

namespace geo {

/// The nodes of a body with their families. A node j is in the family of node i when it is within
/// the horizon of i, the distance included, and no face of skin or crack touches the segment ij.
/// Families are in compressed sparse row format, as in CsrArrays.
struct BondModel {
  std::vector<double> horizon;                    ///< by block, ascending; model units
  std::vector<std::uint32_t> block;               ///< by NodeId: index into horizon
  std::vector<std::uint64_t> indptr;              ///< node_count + 1 offsets into indices
  std::vector<std::uint32_t> indices;             ///< the families, ascending by id
  std::vector<std::pair<NodeId, NodeId>> broken;  ///< pairs i < j within the horizon of i or j that a face touches,
                                                  ///< ascending
};

/// Finds the bonds of a body. The horizon of a node is `horizon` times its spacing, rounded to a
/// power of two times the finest one: one block for each. Exact for faces; parallel. Throws
/// InputError for a horizon below 1 or above 20.
BondModel find_bond_model(const Body& body, double horizon = 3.015);

/// A rectangle that breaks the bonds through it: a bond filter of Peridigm and PeriLab. Its edges
/// begin in `corner` and run along `bottom` and along bottom × normal.
struct BondFilter {
  Vec3 corner;               ///< model units
  Vec3 bottom;               ///< unit vector
  Vec3 normal;               ///< unit vector, perpendicular to bottom
  double bottom_length = 0;  ///< model units
  double side_length = 0;    ///< model units
};

/// Rectangles that break all of model.broken and no other bond of the families, with a margin of
/// 10⁻⁹ horizons. A flat crack needs few of them. A bond that no rectangle along the faces breaks
/// has a small one across it.
std::vector<BondFilter> bond_filters(const Body& body, const BondModel& model);

// ---- Files. Programs count nodes from 1, in the order of the lines of the node table.

/// Writes a line for each node: x, y, z, block from 1, volume. `header`: the first line, which
/// PeriLab requires and Peridigm must not have.
void write_bond_nodes(std::ostream& out, const Body& body, const BondModel& model, bool header);
/// Writes each family as a line: the node, then its members.
void write_families(std::ostream& out, const BondModel& model);
/// Writes the discretisation and the blocks of Peridigm's input (YAML), with `filters`; the node
/// table is "nodes.txt".
void write_peridigm(std::ostream& out, const BondModel& model, const std::vector<BondFilter>& filters);
/// Writes the same for PeriLab.
void write_perilab(std::ostream& out, const BondModel& model, const std::vector<BondFilter>& filters);
/// Writes a function of Julia that makes a Body of Peridynamics.jl from "nodes.txt": a point set
/// for each block, and precracks for all broken bonds.
void write_peridynamics_jl(std::ostream& out, const BondModel& model);

/// Whether a name ends as that of a folder for such a program: .peridigm, .perilab, .peridynamics.
bool is_bond_folder(const std::string& path);
/// Writes a folder with "nodes.txt", "families.txt" and the input of the program that its ending
/// tells: "input.yaml", or "body.jl" for Peridynamics.jl. It exists whole or not at all. Throws
/// InputError for another ending or a horizon out of range, OutputError where it cannot be made.
void write_bond_folder(const std::string& path, const Body& body, double horizon = 3.015);

}  // namespace geo
