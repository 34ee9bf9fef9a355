// Consecutive shards have the same model, so that a process with a part of them reads few models.
#include "dataset/plan.h"

#include <algorithm>

namespace dataset {
namespace {

std::string padded(std::uint64_t number, std::size_t digits) {
  const std::string text = std::to_string(number);
  return std::string(digits - std::min(digits, text.size()), '0') + text;
}

}  // namespace

std::vector<Shard> plan(const std::vector<ModelFile>& models, const Settings& s) {
  std::vector<Shard> shards;
  const auto digits = std::to_string(s.first_seed + static_cast<std::uint64_t>(s.seeds) - 1).size();
  const int step = s.folders ? 1 : s.per_shard;
  for (std::size_t m = 0; m < models.size(); ++m) {
    std::size_t number = 0;
    for (const auto pattern : s.patterns)
      for (int done = 0; done < s.seeds; done += step, ++number) {
        Shard shard{m,  pattern, s.first_seed + static_cast<std::uint64_t>(done), std::min(step, s.seeds - done),
                    {}, {}};
        if (s.folders) {
          const std::string folder = "shapes/" + models[m].name + "/";
          shard.data = folder + "fractured_" + std::to_string(number);
          shard.record = folder + "labels_" + std::to_string(number) + ".json";
        } else {
          const std::string stem = std::string(set_names[set_of(s, models[m].name)]) + "/" + models[m].name + "-" +
                                   geo::pattern_names[static_cast<std::size_t>(pattern)] + "-" +
                                   padded(shard.first_seed, digits);
          shard.data = stem + ".npz", shard.record = stem + ".json";
        }
        shards.push_back(std::move(shard));
      }
  }
  return shards;
}

std::pair<std::size_t, std::size_t> part_of(std::size_t total, std::size_t index, std::size_t count) {
  const auto end = [&](std::size_t i) { return total / count * i + std::min(total % count, i); };
  return {end(index - 1), end(index)};
}

}  // namespace dataset
