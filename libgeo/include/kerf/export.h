// Bodies, pieces, bonds and runs for other programs: VTK, PLY, NumPy, JSON, glTF, USD
// (docs/formats.md).
#pragma once

#include <cstddef>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "kerf/body.h"
#include "kerf/body_file.h"
#include "kerf/hierarchy.h"
#include "kerf/mesh.h"
#include "kerf/pieces.h"

namespace geo {

// ---- The graph and the sections of a body.

/// Writes the visibility graph as binary PLY: nodes as vertices with all their fields and the index
/// of their component, edges i < j as elements `edge`.
void write_graph_ply(std::ostream& out, const Body& body);

/// Writes the visibility graph as a VTK unstructured grid of lines (`.vtu`, binary) with the same
/// fields.
void write_vtu(std::ostream& out, const Body& body);

/// Writes the same as VTKHDF 1.0. Memory: twice the file. Throws OutputError where there is too
/// little.
void write_vtkhdf(std::ostream& out, const Body& body);

/// Writes all sections of a file as a NumPy archive (`.npz`), uncompressed; json sections as text.
void write_npz(std::ostream& out, const KerfFile& file);

/// Writes all sections of a file as JSON: numbers in the shortest form that is read back exactly,
/// NaN and infinity as null, rows of arrays as lists. Sections of an unknown type are left out.
/// Throws InputError where the file is damaged.
void write_json(std::ostream& out, const KerfFile& file);

// ---- Pieces and bonds.

/// Names and physical constants of pieces in written files.
struct ChunkLabels {
  std::string kind = "file";              ///< key of the names: "file" or "node"
  std::vector<std::string> names;         ///< per piece
  double strength = 1;                    ///< force per square metre that a bond withstands
  std::vector<ClusterLevel> levels = {};  ///< clusters of the pieces, see make_hierarchy(); may be empty
  double density = 1000;                  ///< mass per cubic metre, where rigid bodies are written
};

/// Pieces with what is written about them.
struct PieceSet {
  std::vector<Chunk> chunks;
  std::vector<Bond> bonds;
  ChunkLabels labels;
};
/// The same pieces in metres, by the unit of their meshes. Without a unit, one is a metre.
PieceSet in_metres(const std::vector<Chunk>& chunks, const std::vector<Bond>& bonds, const ChunkLabels& labels);
/// The point that writers of single-precision numbers subtract from coordinates; zero where it is
/// not needed. The nearest single-precision number to the centre of the box, where a coordinate is
/// farther from the origin than 64 diagonals of the box.
Vec3 single_precision_offset(const Box3& box);
/// The pairs of triangles of a piece that cross in single precision relative to its centroid, as
/// write_glb() writes it. Rounding makes triangles cross that are thinner or closer than floats.
std::size_t crossings_in_single_precision(const Chunk& chunk);
/// The box around the meshes of some pieces.
Box3 bounding_box(const std::vector<Chunk>& chunks);

/// Name of a piece in written files: piece_000, piece_001 …
std::string piece_name(std::size_t piece);
/// The names of the first `count` pieces.
std::vector<std::string> piece_names(std::size_t count);
/// Name of a cluster in written files: cluster_1_000 is the first of those above the pieces.
std::string cluster_name(std::size_t level, std::size_t cluster);

/// Writes `{"pieces": [{kind, "volume", "centroid", "triangles"}], "bonds": [{"a", "b", "area",
/// "normal", "centroid", "strength", "torque"}]}`. Torque: of bending, at which the stress at the
/// edge of the wall is the strength. Lengths, areas and volumes are in model units. Where the
/// meshes state a unit that is no metre, strength is in N, torque in N m, and "unit" has its
/// metres. With clusters a piece has a "parent", and there are `"levels": [{"clusters": [{"name",
/// "volume", "centroid", "parent"}], "bonds": […]}]`, fine to coarse.
void write_bonds(std::ostream& out, const std::vector<Chunk>& chunks, const std::vector<Bond>& bonds,
                 const ChunkLabels& labels);

/// Extensions of glTF that describe rigid bodies: none; OMI_physics_body with OMI_physics_shape; or
/// the review draft KHR_physics_rigid_bodies, which also has joints.
enum class GlbPhysics { none, omi, khr };

/// Names of the nodes of hulls: piece_000_hull; UCX_piece_000, a collision shape for Unreal; or
/// piece_000_hull-convcolonly, one for Godot.
enum class HullNames { plain, unreal, godot };

struct GlbOptions {
  std::size_t hull_corners = 0;  ///< corners of the convex hulls below each piece's node; 0: no hulls
  std::size_t hull_parts = 1;    ///< hulls for each piece, see convex_decomposition()
  bool z_up = false;             ///< the model's z axis is vertical; in glTF y is
  GlbPhysics physics = GlbPhysics::none;
  HullNames names = HullNames::unreal;
};

/// Writes a .glb file (glTF 2.0, binary): a root node with a node for each piece, whose origin is
/// the piece's centroid, and a material for each group; inner faces have the material of cracks.
/// Clusters are nodes between root and pieces. Normals are the mesh's. Without them, and on cracks,
/// a corner's normal is the mean over triangles around it that differ by less than 45°, weighted by
/// area. Colours are converted to linear ones, as glTF requires. Hulls have a name that ends with
/// hull_suffix(). The scene's `extras` hold what write_bonds() writes. Lengths are in metres, as
/// glTF requires, by the unit of the meshes. Coordinates are in single precision, relative to each
/// centroid. Far from the origin the root has single_precision_offset() as its translation. Groups
/// with a material in the mesh's library get it, with its images. Triangles without patch are skin,
/// corners without texture coordinates have (0, 0), a chunk without groups has one, "skin". Throws
/// InputError for a chunk without triangles.
///
/// With physics each piece is a dynamic body with exact mass and inertia, and its hulls are its
/// collision shapes. Hulls with plain names then are no meshes of nodes, so
/// they are not drawn.
void write_glb(std::ostream& out, const std::vector<Chunk>& chunks, const std::vector<Bond>& bonds,
               const ChunkLabels& labels, const GlbOptions& options = {});

/// Suffix of the name of hull `part` of `parts`: "" for a single one, else _00, _01 …
std::string hull_suffix(std::size_t part, std::size_t parts);

struct UsdOptions {
  bool z_up = false;           ///< the model's z axis is vertical, else y is
  std::size_t hull_parts = 1;  ///< 1: readers take the convex hull of a piece as its shape; more: they decompose it
  std::string image_prefix;    ///< of the files beside that hold textures, see image_files(); empty: no textures
};

/// Writes pieces as USD text with the schema UsdPhysics: a mesh for each piece, which is a rigid
/// body with exact mass and inertia; clusters above them; and a fixed joint for each bond, which
/// breaks at its strength (breakForce) and torque (breakTorque). Coordinates are the model's, and
/// `metersPerUnit` is its unit. The root's translation is single_precision_offset(). Meshes have
/// normals as in write_glb(), texture coordinates, patches, and a subset and a material for each
/// group: a UsdPreviewSurface with the values and textures of the mesh's library. Textures read
/// `primvars:st`, and `st1` for the second set of texture coordinates. Throws InputError for a
/// chunk without triangles.
void write_usd_pieces(std::ostream& out, const std::vector<Chunk>& chunks, const std::vector<Bond>& bonds,
                      const ChunkLabels& labels, const UsdOptions& options = {});

// ---- All frames of a run.

/// Writes a ParaView series (`.ply.series`, JSON): paths of numbered frames, relative to the
/// series, and their times. ParaView's collections, `.pvd`, take VTK's own formats only.
void write_series(std::ostream& out, const std::vector<std::string>& frames, double frame_rate);

/// The frames of a run as write_usda() reads them. `surface` and `obstacles` are called from
/// several threads: once for each frame, and several times for frames whose triangles change where
/// there are many. Memory: one frame for each thread and one more, and the triangles of the first
/// few changes.
struct UsdRun {
  std::size_t frames = 0;
  double frame_rate = 24;                              ///< frames per second
  char up = 'Z';                                       ///< vertical axis, 'Y' or 'Z', as USD has no other
  std::function<TriangleMesh(std::size_t)> surface;    ///< of the bodies in a frame, metres
  std::function<TriangleMesh(std::size_t)> obstacles;  ///< in a frame, with the same triangles in all; may be empty
};

/// Writes a run as USD text (Universal Scene Description). The mesh /run/body has a time sample of
/// points for each frame, and of its triangles where they change; texture coordinates where the
/// surface has them; skin and cracks as subsets bound to two materials; and the crack of each
/// triangle as primvars:patch. Obstacles are the mesh /run/obstacles. Far from the origin /run has
/// single_precision_offset() of the first frame as its translation.
void write_usda(std::ostream& out, const UsdRun& run);

}  // namespace geo
