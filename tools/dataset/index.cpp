// All files are the same whichever process writes them, so several may do so at once.
#include "dataset/index.h"

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>

#include <kerf/error.h>
#include <kerf/files.h>

namespace dataset {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::string text_of(const std::vector<ModelFile>& models, const Settings& s) {
  Json text{{"format", 2}, {"patterns", Json::array()}};
  for (const auto pattern : s.patterns) text["patterns"].push_back(geo::pattern_names[std::size_t(pattern)]);
  text["seed"] = s.first_seed;
  text["seeds"] = s.seeds;
  text["pieces"] = {s.pieces.low, s.pieces.high};
  text["jagged"] = {s.jagged.low, s.jagged.high};
  text["bumps"] = s.bumps;
  if (s.chips.high > 0) {  // data sets from before these options go on
    text["chips"] = {s.chips.low, s.chips.high};
    text["chip_size"] = s.chip_size;
  }
  if (s.edge_detail.high > 0) {
    text["edge_detail"] = {s.edge_detail.low, s.edge_detail.high};
    text["edge_width"] = s.edge_width;
  }
  text["attempts"] = s.attempts;
  text["rotate"] = s.rotate;
  text["repair"] = s.repair;
  text["single"] = s.single;
  text["layout"] = s.folders ? "folders" : "npz";
  if (!s.folders) text["per_shard"] = s.per_shard;
  text["split"] = s.split;
  text["models"] = Json::array();
  const std::vector<std::size_t> sets = sets_of(models, s);
  for (std::size_t m = 0; m < models.size(); ++m)
    text["models"].push_back({{"name", models[m].name}, {"set", set_names[sets[m]]}});
  return text.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

void write_text(const std::string& path, const std::string& text) {
  geo::write_all(path, [&](std::ostream& out) { out << text; });
}

// Sums of all records, and a line for each failure.
struct Sum {
  std::size_t fractures = 0, pieces = 0, faces = 0, failed = 0;
  std::string failures;

  // Returns the number of fractures in the record at `path`.
  std::size_t add(const std::string& path, const Shard& shard) {
    try {
      const auto record = Json::parse(geo::read_all(path));
      for (const auto& entry : record.at("fractures")) {
        ++fractures;
        pieces += entry.at("pieces").get<std::size_t>();
        faces += entry.at("faces").get<std::size_t>();
      }
      const std::string name = record.at("model").get<std::string>() + "\t" + record.at("pattern").get<std::string>();
      failed += record.at("failed").size();
      if (record.contains("refused"))
        failures += name + "\t" + std::to_string(shard.first_seed) + ".." +
                    std::to_string(shard.first_seed + static_cast<std::uint64_t>(shard.count) - 1) + "\t" +
                    record.at("refused").get<std::string>() + "\n";
      else
        for (const auto& entry : record.at("failed"))
          failures += name + "\t" + std::to_string(entry.at("seed").get<std::uint64_t>()) + "\t" +
                      entry.at("why").get<std::string>() + "\n";
      return record.at("fractures").size();
    } catch (const Json::exception&) {
      throw geo::InputError(path + ": is no record of a shard; remove it, and what it stands for is made anew");
    }
  }
};

}  // namespace

void begin_folder(const std::string& folder, const std::vector<ModelFile>& models, const Settings& settings) {
  std::error_code error;
  if (fs::exists(folder, error) && !fs::is_directory(folder, error))
    throw geo::OutputError(folder + ": is not a folder; give another name");
  const std::string path = folder + "/dataset.json", text = text_of(models, settings);
  if (!fs::exists(path, error)) {
    fs::create_directories(folder);
    for (const auto& entry : fs::directory_iterator(folder))  // another process may begin at the same time
      if (const auto name = entry.path().filename().string(); !name.starts_with("dataset.json") && name != "unfinished")
        throw geo::InputError(folder + ": is not empty, and no data set; give another name");
    write_text(path, text);
  } else if (geo::read_all(path) != text) {
    throw geo::InputError(folder + ": holds a data set of other models or options (dataset.json); give another name");
  }
  fs::create_directories(folder + "/unfinished");
}

bool finish_folder(const std::string& folder, const std::vector<ModelFile>& models, const Settings& settings,
                   const std::vector<Shard>& shards, std::vector<std::string>& notes) {
  const auto at = [&](const std::string& path) { return folder + "/" + path; };
  for (const auto& shard : shards)
    if (!fs::exists(at(shard.record))) return false;
  Sum sum;
  std::array<std::string, 3> lists;
  std::size_t listed = models.size();  // the last model that is in a list
  for (const auto& shard : shards) {
    if (sum.add(at(shard.record), shard) == 0) continue;
    if (!settings.folders)
      lists[shard.set] += shard.data + "\n";
    else if (listed != shard.model)
      lists[shard.set] += "shapes/" + models[shard.model].name + "\n";
    listed = shard.model;
  }
  for (std::size_t set = 0; set < set_names.size(); ++set)
    if (settings.split[set] > 0 && lists[set].empty())
      notes.push_back(std::string("data_split/shapes.") + set_names[set] +
                      ".txt is empty: too few models could be broken; give more, or another --split");
  fs::create_directories(at("data_split"));
  for (std::size_t set = 0; set < set_names.size(); ++set)
    write_text(at(std::string("data_split/shapes.") + set_names[set] + ".txt"), lists[set]);
  write_text(at("failed.txt"), sum.failures);
  const Json summary{{"models", models.size()}, {"shards", shards.size()}, {"fractures", sum.fractures},
                     {"pieces", sum.pieces},    {"faces", sum.faces},      {"failed", sum.failed}};
  write_text(at("summary.json"), summary.dump(1) + "\n");
  fs::remove_all(at("unfinished"));
  return true;
}

}  // namespace dataset
