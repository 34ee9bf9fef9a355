// Scores (§ 7, Fig. 7): the walls of a fracture pattern as one sheet that divides a model into a
// number of pieces.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
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
};

struct ScoreOptions {
  PatternOptions pattern;
  int pieces = 20;  ///< wanted number of pieces of material; patterns sheets and curves: as they come
  JaggedOptions jagged;
  /// Below 1: a partial score. Each wall is cut in only as deep under the skin as this fraction of
  /// its greatest depth.
  double depth = 1;
  int attempts = 60;  ///< how many patterns are tried for the wanted number of pieces
};

struct Score {
  TriangleMesh sheet;        ///< for insert_sheet(): walls that meet share vertices
  std::uint32_t pieces = 0;  ///< pieces into which a score of full depth divides the model
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

}  // namespace geo
