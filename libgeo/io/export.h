// Bodies for other programs: VTK's and PLY for pictures, NumPy's and JSON for figures. See docs/formats.md.
#pragma once

#include <ostream>

#include "body/body.h"
#include "io/kerf_reader.h"

namespace geo {

/// The visibility graph as a binary PLY: nodes as vertices with all that they have and the number of their component,
/// edges i < j as elements `edge`.
void write_graph_ply(std::ostream& out, const Body& body);

/// The visibility graph as VTK's unstructured grid of lines, binary: nodes as points with the same fields.
void write_vtu(std::ostream& out, const Body& body);

/// The same as VTKHDF 1.0. Memory: twice the file. Throws OutputError when there is not enough.
void write_vtkhdf(std::ostream& out, const Body& body);

/// All sections under their names, as NumPy's zip archive of arrays, not compressed; the json ones as they are.
void write_npz(std::ostream& out, const KerfFile& file);

/// All sections under their names, as JSON: numbers in the shortest form that reads back the same, rows as lists.
void write_json(std::ostream& out, const KerfFile& file);

}  // namespace geo
