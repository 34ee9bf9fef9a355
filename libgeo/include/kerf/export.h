// Bodies for other programs: VTK's and PLY for pictures, NumPy's and JSON for figures. See
// docs/formats.md.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "kerf/body.h"
#include "kerf/body_file.h"
#include "kerf/pieces.h"

namespace geo {

/// The visibility graph as a binary PLY: nodes as vertices with all that they have and the number
/// of their component, edges i < j as elements `edge`.
void write_graph_ply(std::ostream& out, const Body& body);

/// The visibility graph as VTK's unstructured grid of lines, binary: nodes as points with the same
/// fields.
void write_vtu(std::ostream& out, const Body& body);

/// The same as VTKHDF 1.0. Memory: twice the file. Throws OutputError when there is not enough.
void write_vtkhdf(std::ostream& out, const Body& body);

/// All sections under their names, as NumPy's zip archive of arrays, not compressed; the json ones
/// as they are.
void write_npz(std::ostream& out, const KerfFile& file);

/// All sections under their names, as JSON: numbers in the shortest form that reads back the same,
/// rows as lists.
void write_json(std::ostream& out, const KerfFile& file);

// ---- Pieces and bonds in files: glTF 2.0 (binary) with everything in one, and JSON.

/// What is told of pieces beside their shapes.
struct ChunkNotes {
  std::string kind = "file";       ///< what pieces are named by: file or node
  std::vector<std::string> names;  ///< of each piece
  double strength = 1;             ///< force an area of 1 withstands; a bond's strength is this times its area
};

/// `{"pieces": [{kind, "volume", "centroid", "triangles"}], "bonds": [{"a", "b", "area", "normal",
/// "centroid", "strength"}]}`.
void write_bonds(std::ostream& out, const std::vector<Chunk>& chunks, const std::vector<Bond>& bonds,
                 const ChunkNotes& notes);

struct GlbOptions {
  std::size_t hull_corners =
      0;  ///< of the convex hulls below each piece's node, named UCX_ and the piece's name; 0: none
  std::size_t hull_parts = 1;  ///< see convex_decomposition(); where there are several, their names end in _00, _01 …
  bool z_up = false;           ///< the model's z is up; glTF's is y
};

/// A .glb: a root node with one node for each piece, whose origin is the piece's centroid, and one
/// material for each group, that of cracks with a face on the inside. Normals are those given, on
/// cracks and where there are none those of the triangles around each corner that are bent less
/// than 45 degrees. Colours become linear, as glTF wants them. What write_bonds() says is in the
/// scene's `extras`. Coordinates are single precision about each centroid.
void write_glb(std::ostream& out, const std::vector<Chunk>& chunks, const std::vector<Bond>& bonds,
               const ChunkNotes& notes, const GlbOptions& options = {});

/// What the name of hull `part` of `parts` ends in: "" for a single one, else _00, _01 …
std::string hull_suffix(std::size_t part, std::size_t parts);

}  // namespace geo
