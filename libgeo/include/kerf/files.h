// Files: bytes in and out; surfaces, volumes, nodes, fronts and scenes. Bodies are in
// kerf/body_file.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <ostream>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kerf/crack.h"
#include "kerf/mesh.h"
#include "kerf/nodes.h"
#include "kerf/progress.h"
#include "kerf/scene.h"

namespace geo {

// ---- Input.

/// The bytes of a file, or of standard input where `path` is "-". Throws MissingInputError where
/// the file does not exist, InputError where it is empty, a folder or unreadable.
std::string read_all(const std::string& path);

/// An input that is read by position. A regular file stays open and is not mapped: another program
/// that shortens a mapped file would end this one. Anything else is read to its end on opening.
class Input {
 public:
  /// Opens a file, or standard input where `path` is "-". Throws as read_all().
  explicit Input(const std::string& path);
  /// Bytes in memory; `name` stands for the file in messages.
  Input(std::string bytes, std::string name);
  ~Input();
  /// Takes the open file of `other`.
  Input(Input&& other) noexcept;
  Input(const Input&) = delete;
  Input& operator=(const Input&) = delete;

  /// The path, or the name given.
  const std::string& name() const { return name_; }
  /// Number of bytes when the input was opened.
  std::uint64_t size() const { return size_; }
  /// Fills `out` with the bytes from `offset` on. Threads may read at the same time. Throws
  /// InputError where the input has fewer bytes, or has become shorter.
  void read(std::uint64_t offset, std::span<std::byte> out) const;
  /// At most `count` bytes from `offset` on; fewer at the end of the input.
  std::string text(std::uint64_t offset, std::uint64_t count) const;

 private:
  std::string name_, bytes_;
  std::uint64_t size_ = 0;
  int file_ = -1;  // descriptor; −1: all bytes are in bytes_
};

/// The XXH3 hash of some bytes, 64 bits: identifies an input in the history of a file.
std::uint64_t fingerprint(std::string_view bytes);

// ---- Output.

/// How far write_all() waits. `by_system`: the operating system has the bytes; only a crash of the
/// machine can lose them.
enum class Sync { on_disk, by_system };

/// Writes a file through `write`: to a temporary file in the same folder, which then replaces the
/// file by a rename. On failure the file stays as it was and nothing is left behind. "-" is
/// standard output; devices and pipes are written directly. Throws OutputError.
void write_all(const std::string& path, const std::function<void(std::ostream&)>& write, Sync sync = Sync::on_disk);

/// Waits until files written with Sync::by_system are on the disk. Many files at once cost little
/// more than one. Files that no longer exist are skipped. Throws OutputError.
void flush_to_disk(std::span<const std::string> paths);

/// Throws OutputError, as write_all() would, where no file of this name can be written. To be
/// called before long work.
void require_writable(const std::string& path);

/// A temporary file or folder that becomes an output. The destructor removes it with its content
/// unless it was committed.
class TemporaryOutput {
 public:
  /// `path`: of the temporary file or folder, which the caller creates.
  explicit TemporaryOutput(std::string path);
  ~TemporaryOutput();
  TemporaryOutput(const TemporaryOutput&) = delete;
  TemporaryOutput& operator=(const TemporaryOutput&) = delete;
  /// Renames it to `path`. Throws OutputError.
  void commit(const std::string& path);

 private:
  std::string path_;
  bool committed_ = false;
};

/// Removes all temporary outputs of this process and blocks every later commit: the last call of a
/// program that ends at once.
void discard_temporary_outputs();

// ---- Surfaces: PLY, OBJ, STL and OFF; glTF, FBX and more through assimp.

/// A surface, with the fronts that were cutting it when it was written. kerf-crack continues them.
struct SurfaceFile {
  TriangleMesh mesh;
  std::vector<FrontState> fronts;
  /// Lines that say what the reader left out or assumed, without the file's name: "left out: 2
  /// cameras". Tools print them to standard error.
  std::vector<std::string> notes = {};
};

/// The metres of a unit of length: "m", "cm", "mm", "um", "km", "in", "ft", "yd", or their English
/// names ("millimeter", "inches"). Empty for any other text.
std::optional<double> length_unit(std::string_view name);
/// The signs that length_unit() knows, for messages: "m, cm, …".
std::string length_unit_names();

/// Reads a surface from a file, or from standard input where `path` is "-". The format is
/// recognised by content, some by the ending of the path; unknown content is read as STL. Polygons
/// are triangulated as fans, by ear clipping where they are not convex. Vertices of seams at one
/// place are merged unless the mesh has sites. Formats of other programs (docs/formats.md) are read
/// by assimp in a child process. Files that they name must be in the folder of `path` or below.
/// Throws InputError, with the line or entry: malformed data, numbers that are not finite, indices
/// out of range, sizes larger than the file.
SurfaceFile read_surface(const std::string& path);
/// The same from bytes in memory; `name` stands for the file in messages.
SurfaceFile parse_surface(const std::string& bytes, const std::string& name);

/// Writes binary little-endian PLY with patch, site, source, attributes, and the contacts of
/// `fronts` as further elements (docs/formats.md). Numbers have the smallest type that holds them
/// exactly.
void write_ply(std::ostream& out, const TriangleMesh& mesh, const std::vector<FrontState>& fronts = {},
               const std::string& comment = {});
/// Writes Wavefront OBJ: patches as `g patch_N`, groups as `usemtl`. OBJ has one colour a vertex,
/// without alpha: the colour of the skin is written. See save_obj() for materials.
void write_obj(std::ostream& out, const TriangleMesh& mesh);
/// Writes binary STL: normals and corners of triangles in single precision.
void write_stl(std::ostream& out, const TriangleMesh& mesh);
/// Writes OFF as text; every coordinate returns to the bit.
void write_off(std::ostream& out, const TriangleMesh& mesh);

// ---- Materials beside a surface's file.

/// A file that belongs into the folder of another.
struct BesideFile {
  std::string name;  ///< without a folder
  std::string bytes;
};
/// Writes such a file, as write_all(). An empty folder is the current one. Throws OutputError.
void write_beside(const std::string& folder, const BesideFile& file);

/// Images of a library, and what a preview surface of USD does not hold of its materials.
struct ImageFiles {
  std::vector<BesideFile> images;
  std::vector<std::string> left_out;  ///< as words of a line
};
/// The images of a library, PNG and JPEG. A file's name is `prefix`, the image's name, its ending.
/// write_usd_pieces() names these files. Throws InputError where the library is damaged.
ImageFiles image_files(const MaterialLibrary& library, const std::string& prefix);

/// Materials of groups as an .mtl file says them.
struct MtlFiles {
  std::string mtl;                    ///< the text
  std::vector<BesideFile> images;     ///< that the text names
  std::vector<std::string> left_out;  ///< what the format does not hold, as words of a line
};
/// The materials of these groups: those of the library, else grey ones. Images are named as by
/// image_files(). Throws InputError where the library is damaged.
MtlFiles mtl_files(const std::vector<std::string>& groups, const MaterialLibrary& library, const std::string& prefix);

/// Writes an OBJ file, and the materials of a library beside it: `model.obj` gets `model.mtl` and
/// images `model_NAME.png`. "-" is standard output, without materials.
///
/// Returns what the format does not hold of the mesh, as words of a line. Throws OutputError.
std::vector<std::string> save_obj(const std::string& path, TriangleMesh mesh);

// ---- Volumes.

struct VolumeOptions {
  std::string grid = {};           ///< name of the grid; empty: the only scalar grid of the file
  std::optional<double> iso = {};  ///< level of the surface; default: 0 of a level set, 0.5 of a fog volume
  double adaptivity = 0;           ///< 0: triangles of voxel size; up to 1: larger ones where the surface is flat
};

/// The iso-surface of a scalar grid in an OpenVDB file ("-": standard input). Inside are values
/// below the level for a level set, above it for any other grid. Closed, oriented outwards, world
/// units. Throws InputError where the file is no OpenVDB file, has no floating-point grid, several
/// without a name given, or no closed surface at the level.
TriangleMesh read_volume(const std::string& path, const VolumeOptions& options = {});

/// Writes a mesh as a level set with voxels of edge `voxel`; with `fog` as a density from 0 outside
/// to 1 inside. For samples and tests. Throws OutputError.
void write_level_set(const std::string& path, const TriangleMesh& solid, double voxel, bool fog = false);

// ---- Scans: points of a surface.

/// Points of a scan. Normals and colours are as long as the positions, or empty.
struct PointCloud {
  std::vector<Vec3> position;
  std::vector<Vec3> normal;  ///< of length 1, out of the material
  std::vector<Color> color;
  std::size_t left_out = 0;  ///< points of the file without a finite place or a normal
};

/// Whether a file holds points of a scan: PCD, PLY without faces, or text (.xyz, .pwn, .pts, .asc,
/// .csv) by the ending of its name.
bool holds_points(const std::string& bytes, const std::string& name);
/// Reads a scan. PCD may be ASCII, binary or compressed. In text, three numbers of a line are a
/// place; three more are colours if all are integers up to 255, else a normal.
///
/// Throws InputError for malformed and truncated files, and for files of nodes.
PointCloud parse_points(const std::string& bytes, const std::string& name);
/// The same from a file ("-": standard input).
PointCloud read_points(const std::string& path);

// ---- Nodes: PCD, which pcl_viewer opens, and PLY.

/// Reads PCD (ASCII or binary) or PLY ("-": standard input) with the fields x, y, z, radius,
/// spacing and volume. Throws InputError that names a missing field, and for malformed files.
NodeSet read_nodes(const std::string& path);
/// The same from bytes in memory; `name` stands for the file in messages.
NodeSet parse_nodes(const std::string& bytes, const std::string& name);

/// Writes binary PCD with double-precision fields, which are read back exactly.
void write_pcd(std::ostream& out, const NodeSet& nodes);
/// Writes binary PLY with double-precision properties, which are read back exactly.
void write_nodes_ply(std::ostream& out, const NodeSet& nodes);

/// The nodes of a frame of a run.
struct FrameNodes {
  NodeSet nodes;               ///< deformed positions; radius, spacing and volume of the undeformed material
  std::vector<double> stress;  ///< per node, von Mises, Pa
};
/// Writes a node file (binary PLY, single precision where that is enough) with the stress as well.
void write_frame_nodes(std::ostream& out, const FrameNodes& frame);
/// Reads such a file; `name` stands for it in messages. Throws InputError for any other file.
FrameNodes parse_frame_nodes(const std::string& bytes, const std::string& name);

// ---- Fronts and sheets: `.front` text and OBJ polylines.

/// Reads fronts from a file ("-": standard input). A `.front` file has `front NAME [closed]`, then
/// `step T` and lines `x y z` for each time step; or `sheet NAME`, then `v x y z` and `f a b c`;
/// `#` begins a comment. An OBJ file has `l` polylines, one object for each step, in the order of
/// their names. Throws InputError, with file and line, for fronts with fewer than two points or two
/// steps, numbers that are not finite, and unknown words.
std::vector<Front> read_fronts(const std::string& path);
/// The same from bytes in memory; `name` stands for the file in messages.
std::vector<Front> parse_fronts(const std::string& bytes, const std::string& name);
/// Reads curves: as read_fronts(), but one step is enough.
std::vector<Front> read_curves(const std::string& path);
/// Writes `.front` text. Numbers have enough digits to be read back exactly.
void write_fronts(std::ostream& out, const std::vector<Front>& fronts);

// ---- Scenes in TOML. docs/formats.md lists every key.

/// Keys and TOML values that replace those of a file: "material.young", "2e5". Entries of lists
/// have numbers from 0: "blade.0.thickness", "body.fixed.1.5".
using SceneOverrides = std::vector<std::pair<std::string, std::string>>;

/// Reads a scene ("-": standard input), with the fronts, obstacles and motions that it names. The
/// mesh of each body becomes a path relative to the current folder. Throws InputError, with file,
/// line and column, for syntax errors, unknown keys, wrong types and impossible values.
Scene read_scene(const std::string& path, const SceneOverrides& overrides = {});
/// The same from text in memory; `name` stands for the file in messages. Files that the scene names
/// are relative to `folder`; mesh paths stay as they are written.
Scene parse_scene(const std::string& text, const std::string& name, const SceneOverrides& overrides = {},
                  const std::string& folder = "");

/// Writes a scene as TOML that read_scene() reads to the same run, to the bit. Paths of models are
/// relative to `folder`, that of the written file; absolute where it is empty. Throws InputError
/// where the scene holds a mesh or a crack that was not read from a file.
void write_scene(std::ostream& out, const Scene& scene, const std::string& folder = "");

/// Reads keyframes from a table: time, position, axis and degrees on each line, with commas or
/// blanks between the numbers. A first line of words is ignored, as is what follows #. Throws
/// InputError with the line.
std::vector<Motion::Key> parse_motion(const std::string& text, const std::string& name);

}  // namespace geo
