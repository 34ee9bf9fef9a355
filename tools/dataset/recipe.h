// Settings of a data set, and the recipe of each fracture that follows from them and its seed.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <kerf/score.h>

namespace dataset {

/// Numbers from `low` to `high`, of which each fracture draws one.
struct Range {
  double low = 0, high = 0;
};

struct Settings {
  std::vector<geo::Pattern> patterns;
  std::uint64_t first_seed = 1;
  int seeds = 100;  ///< fractures for each model and pattern
  Range pieces{20, 20}, jagged{0, 0}, chips{0, 0}, edge_detail{0, 0};
  double bumps = 4;                      ///< see geo::JaggedOptions::frequency
  double edge_width = 0.03;              ///< see geo::JaggedOptions
  double chip_size = 0.25;               ///< see geo::ChipOptions
  int attempts = 10;                     ///< see geo::ScoreOptions
  bool rotate = false;                   ///< each piece about its centroid, at random
  bool single = false;                   ///< vertices in single precision
  bool folders = false;                  ///< a folder of PLY files for each fracture, instead of archives
  bool repair = false;                   ///< models, before anything else
  int per_shard = 100;                   ///< fractures in a shard
  std::array<int, 3> split{80, 10, 10};  ///< percentages of models for training, validation and test
};

/// All that decides a fracture of a given model.
struct Recipe {
  geo::Pattern pattern = geo::Pattern::voronoi;
  std::uint64_t seed = 1;
  int pieces = 20, attempts = 60;
  double jagged = 0, bumps = 8;
  int chips = 0;
  double chip_size = 0.25, edge_detail = 0, edge_width = 0.03;
};

/// The recipe of one fracture: numbers of ranges are drawn by a generator that starts from the
/// seed.
Recipe recipe_of(const Settings& settings, geo::Pattern pattern, std::uint64_t seed);

/// Options of kerf-score for a recipe.
geo::ScoreOptions score_options(const Recipe& recipe);

/// The commands that make the same cut surface from a model's file, for a shell.
std::string command_of(const Recipe& recipe, const std::string& model);

/// A rotation drawn uniformly (Shoemake 1992), the same for each seed and piece: a unit quaternion
/// w, x, y, z.
std::array<double, 4> random_rotation(std::uint64_t seed, std::uint32_t piece);

}  // namespace dataset
