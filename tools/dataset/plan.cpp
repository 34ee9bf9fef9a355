// Consecutive shards have the same model, so that a process with a part of them reads few models.
#include "dataset/plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include <kerf/files.h>

namespace dataset {
namespace {

std::string padded(std::uint64_t number, std::size_t digits) {
  const std::string text = std::to_string(number);
  return std::string(digits - std::min(digits, text.size()), '0') + text;
}

}  // namespace

std::vector<std::size_t> sets_of(const std::vector<ModelFile>& models, const Settings& settings) {
  std::vector<int> place;  // of 100 places, of which each set has its share
  std::vector<std::size_t> sets;
  std::array<std::size_t, 3> count{};
  for (const auto& model : models) {
    place.push_back(static_cast<int>(geo::fingerprint(model.name) % 100));
    sets.push_back(place.back() < settings.split[0] ? 0 : place.back() < settings.split[0] + settings.split[1] ? 1 : 2);
    ++count[sets.back()];
  }
  std::array<std::size_t, 3> order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return settings.split[a] > settings.split[b]; });
  for (std::size_t rank = 0; rank < order.size(); ++rank) {
    const std::size_t set = order[rank];
    if (settings.split[set] == 0 || count[set] > 0) continue;
    // The donor is a set that keeps a model, or one of a smaller share; of its models, the one
    // whose place is nearest to the set's.
    const int middle = std::accumulate(settings.split.begin(), settings.split.begin() + std::ptrdiff_t(set), 0) +
                       settings.split[set] / 2;
    std::size_t best = models.size();
    for (std::size_t m = 0; m < models.size(); ++m) {
      const auto from = static_cast<std::size_t>(std::find(order.begin(), order.end(), sets[m]) - order.begin());
      if (count[sets[m]] < 2 && from < rank) continue;
      if (best == models.size() || std::abs(place[m] - middle) < std::abs(place[best] - middle)) best = m;
    }
    if (best == models.size()) continue;
    --count[sets[best]];
    sets[best] = set;
    ++count[set];
  }
  return sets;
}

std::string intact_path(const ModelFile& model, const Settings& settings) {
  return settings.folders ? "shapes/" + model.name + "/intact.ply" : "models/" + model.name + ".ply";
}

std::vector<Shard> plan(const std::vector<ModelFile>& models, const Settings& s) {
  std::vector<Shard> shards;
  const auto digits = std::to_string(s.first_seed + static_cast<std::uint64_t>(s.seeds) - 1).size();
  const int step = s.folders ? 1 : s.per_shard;
  const std::vector<std::size_t> sets = sets_of(models, s);
  for (std::size_t m = 0; m < models.size(); ++m) {
    std::size_t number = 0;
    for (const auto pattern : s.patterns)
      for (int done = 0; done < s.seeds; done += step, ++number) {
        Shard shard{.model = m,
                    .set = sets[m],
                    .pattern = pattern,
                    .first_seed = s.first_seed + static_cast<std::uint64_t>(done),
                    .count = std::min(step, s.seeds - done),
                    .data = {},
                    .record = {}};
        if (s.folders) {
          const std::string folder = "shapes/" + models[m].name + "/";
          shard.data = folder + "fractured_" + std::to_string(number);
          shard.record = folder + "labels_" + std::to_string(number) + ".json";
        } else {
          const std::string stem = std::string(set_names[sets[m]]) + "/" + models[m].name + "-" +
                                   geo::pattern_names[static_cast<std::size_t>(pattern)] + "-" +
                                   padded(shard.first_seed, digits);
          shard.data = stem + ".npz";
          shard.record = stem + ".json";
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
