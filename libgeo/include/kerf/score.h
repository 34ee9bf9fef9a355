// Scores (§ 7, Fig. 7): the walls of a fracture pattern as one sheet that divides a model into a
// number of pieces.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "kerf/complex.h"
#include "kerf/mesh.h"
#include "kerf/progress.h"
#include "kerf/vec.h"

namespace geo {

/// Kinds of fracture pattern. `curves` and `sheets` are given by the caller, the others are
/// generated.
enum class Pattern { planes, crossing, voronoi, radial, glass, wood, bricks, curves, sheets };
/// Names of the patterns, in the order of their values.
inline constexpr std::array pattern_names{"planes", "crossing", "voronoi", "radial", "glass",
                                          "wood",   "bricks",   "curves",  "sheets"};

/// The pattern of this name. Throws InputError, which lists the names, for an unknown one.
Pattern pattern_named(std::string_view name);

/// How many cells a volume has at a point, relative to other places: at least 0. Material
/// coordinates.
using Density = std::function<double(const Vec3&)>;

/// Shape of a pattern's walls.
struct PatternOptions {
  Pattern pattern = Pattern::voronoi;
  /// planes: their normal; wood: the grain; bricks: the direction in which courses are stacked;
  /// radial, glass: the axis; curves: the direction of extrusion. Not given: z for curves, the
  /// model's shortest extent for radial and glass, its longest else.
  std::optional<Vec3> axis;
  /// radial, glass: where cracks meet (not given: the model's middle); voronoi, wood: where cells
  /// are small (not given: nowhere).
  std::optional<Vec3> impact;
  double cluster = 0.15;  ///< radius of the region of small cells around the impact, as a fraction of the diagonal
  double grain = 5;       ///< wood: ratio of length to thickness of its cells
  Density density;        ///< voronoi, wood: where cells are many; empty: everywhere alike
  std::vector<TriangleMesh> sheets;       ///< for the pattern sheets
  std::vector<std::vector<Vec3>> curves;  ///< for the pattern curves: polylines
  std::uint64_t seed = 1;
};

/// Fractal displacement of walls. Lengths are relative to the diagonal of the model's box.
struct JaggedOptions {
  double amplitude = 0;  ///< of the largest bumps; 0: flat walls
  double frequency = 8;  ///< of the largest bumps, per diagonal
  int octaves = 3;       ///< each twice as fine and 0.6 times as high
  double edge = 0;       ///< longest edge; 0: 1 / (8 · frequency)
  std::uint64_t seed = 1;
  /// Height of finer bumps near the skin, where pieces show their edges; 0: none. They fade to
  /// nothing at the depth `edge_width`, and are as wide as half of it.
  double edge_amplitude = 0;
  double edge_width = 0.03;  ///< depth under the skin to which there are finer bumps
};

/// Chips: small pieces that break off where walls meet the skin or each other.
struct ChipOptions {
  int count = 0;  ///< how many are wanted
  /// Length of a chip along its edge: a fraction of the cube root of the mean piece's volume, from
  /// 0.01 to 1. Smaller chips would need walls of millions of triangles.
  double size = 0.25;
  /// No chip is smaller than this fraction of the volume that a chip of mean length has where faces
  /// meet at right angles, about a tenth of (length / 2)³.
  double least = 0.2;
};

struct ScoreOptions {
  PatternOptions pattern;
  int pieces = 20;  ///< wanted number of pieces of material; patterns sheets and curves: as they come
  JaggedOptions jagged;
  ChipOptions chips;
  /// Below 1: a partial score. Each wall is cut in only as deep under the skin as this fraction of
  /// its greatest depth.
  double depth = 1;
  int attempts = 60;  ///< how many patterns are tried for the wanted number of pieces
};

struct Score {
  TriangleMesh sheet;        ///< for insert_sheet(): walls that meet share vertices
  std::uint32_t pieces = 0;  ///< pieces into which a score of full depth divides the model, without chips
  std::uint32_t chips = 0;   ///< chips that break off them, pieces of their own
  int attempts = 0;          ///< patterns tried
};

/// Tries patterns, coarser, finer and of other seeds, until one divides the model into as many
/// pieces as wanted; else returns the nearest one.
/// \param options  lengths are relative to the diagonal of Complex::extent()
/// \param cut  where given, receives the model cut along the sheet, as insert_sheet() with the next
///   crack number cuts it
/// \throws InputError for options out of range
/// \throws GeometryError where no pattern can be inserted
/// \throws Interrupted where `progress` asks for it
Score make_score(const Complex& model, const ScoreOptions& options, const Progress& progress = {},
                 Complex* cut = nullptr);

// ---- Densities

/// A number that a colour stands for; luminance: 0.2126 red + 0.7152 green + 0.0722 blue (ITU-R
/// BT.709), of the values as they are.
enum class ColorChannel { red, green, blue, alpha, luminance };

/// The density that the colours of a model paint. A point in the material has the value of the
/// nearest point of the skin.
/// \throws InputError where the model has no colours
Density painted_density(const TriangleMesh& model, ColorChannel channel);
/// The same with a value for each vertex, linear on each triangle.
/// \param values  at least 0
/// \throws InputError for another number of values, and for values below 0 or not finite
Density painted_density(const TriangleMesh& model, std::span<const double> values);
/// A density that rises evenly along `axis`, from 0 where the box begins to 1 where it ends.
/// \throws InputError for an axis without length
Density ramp_density(const Box3& box, const Vec3& axis);

// ---- Cut-outs: the outlines of black areas in an image as curves

struct GrayImage {
  int width = 0, height = 0;      ///< pixels
  std::vector<float> brightness;  ///< of each pixel, row by row from the top; 0 black … 1 white
};

/// How an image covers a box: as large as fits inside, with its proportions, or stretched to the
/// box.
enum class ImageFit { inside, stretched };

struct CutOutOptions {
  /// Points to the viewer who sees the image as it is. The pattern `curves` needs the same axis.
  Vec3 axis = Vec3::UnitZ();
  /// Points up in the image. Not given: y for an axis along z, else z.
  std::optional<Vec3> up;
  ImageFit fit = ImageFit::inside;
  double threshold = 0.5;    ///< darker is black
  double tolerance = 0.5;    ///< pixels: how far outlines may leave the border between black and white
  double least_area = 4;     ///< pixels: smaller spots are left out
  int max_segments = 20000;  ///< of all outlines
};

struct CutOut {
  std::vector<std::vector<Vec3>> curves;  ///< for PatternOptions::curves; closed ones end in their first point
  std::size_t spots = 0;                  ///< outlines left out, as they are smaller than least_area
};

/// The outlines of the black areas, by marching squares on the centres of pixels, with points
/// between them by their brightness. Outlines neither cross nor touch. Those that meet the border
/// of the image go on at right angles to it, beyond the box.
/// \param box  of the model, in the middle of which the image is; material coordinates
/// \throws InputError for an image without outlines or with too many, and for options out of range
CutOut cut_out(const GrayImage& image, const Box3& box, const CutOutOptions& options = {});

}  // namespace geo
