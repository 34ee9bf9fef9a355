// The shards of a data set in order, and their paths in its folder.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "dataset/models.h"
#include "dataset/recipe.h"

namespace dataset {

/// Fractures of one model by one pattern, with consecutive seeds: written at once.
struct Shard {
  std::size_t model = 0;  ///< row in the list of models
  std::size_t set = 0;    ///< of the model, see sets_of()
  geo::Pattern pattern = geo::Pattern::voronoi;
  std::uint64_t first_seed = 1;
  int count = 0;
  std::string data;    ///< path of the archive, or of the folder of PLY files
  std::string record;  ///< path of the JSON file that ends the shard
};

/// Names of the sets.
inline constexpr std::array set_names{"train", "val", "test"};

/// The set of each model: 0 training, 1 validation, 2 test, by the hash of its name. A set that has
/// a share and would be empty gets one of the others' models, the larger share first, as long as
/// there are models.
std::vector<std::size_t> sets_of(const std::vector<ModelFile>& models, const Settings& settings);

/// Path of the intact model in the data set: models/MODEL.ply, shapes/MODEL/intact.ply with
/// Settings::folders.
std::string intact_path(const ModelFile& model, const Settings& settings);

/// All shards: by model, pattern and seed. Archives are SET/MODEL-PATTERN-SEED.npz; with
/// Settings::folders each fracture is a shard, shapes/MODEL/fractured_NUMBER.
std::vector<Shard> plan(const std::vector<ModelFile>& models, const Settings& settings);

/// The part `index` (from 1) of `count` of the rows 0 … total: [begin, end). Parts differ by at
/// most one row.
std::pair<std::size_t, std::size_t> part_of(std::size_t total, std::size_t index, std::size_t count);

}  // namespace dataset
