// kerf-dataset: makes labelled fractures of many models, for learning.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <sstream>

#include <kerf/error.h>
#include "dataset/models.h"
#include "dataset/plan.h"
#include "dataset/run.h"
#include "tool.h"

namespace {

struct Command {
  std::vector<std::string> models;
  std::string patterns = "voronoi", pieces = "20", jagged = "0", chips = "0", edge_detail = "0", split = "80,10,10",
              shard = "1/1", layout = "npz";
  int seeds = 100, per_shard = 100, attempts = 10;
  double bumps = 4, chip_size = 0.25, edge_width = 0.03;
  bool rotate = false, single = false, repair = false, strict = false;
};

// The numbers of "A" or "A:B".
dataset::Range range(const std::string& option, const std::string& text) {
  dataset::Range r;
  char rest = 0;
  const int read = std::sscanf(text.c_str(), "%lf:%lf%c", &r.low, &r.high, &rest);
  if (read == 1 && text.find(':') == text.npos && std::sscanf(text.c_str(), "%lf%c", &r.low, &rest) == 1)
    r.high = r.low;
  else if (read != 2)
    throw tool::UsageError(option + " '" + text + "' is no number, and no range A:B");
  if (!std::isfinite(r.low) || !std::isfinite(r.high) || r.low > r.high)
    throw tool::UsageError(option + " '" + text + "' is no range A:B with A at most B");
  return r;
}

std::array<int, 3> split(const std::string& text) {
  std::array<int, 3> s{};
  char rest = 0;
  if (std::sscanf(text.c_str(), "%d,%d,%d%c", &s[0], &s[1], &s[2], &rest) != 3 ||
      std::any_of(s.begin(), s.end(), [](int x) { return x < 0 || x > 100; }) || s[0] + s[1] + s[2] != 100)
    throw tool::UsageError("--split '" + text + "' is not three percentages that sum to 100, like 80,10,10");
  return s;
}

std::pair<std::size_t, std::size_t> shard(const std::string& text) {
  unsigned long index = 0, count = 0;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%lu/%lu%c", &index, &count, &rest) != 2 || index < 1 || index > count ||
      count > 1000000000 || text.find('-') != text.npos)
    throw tool::UsageError("--shard '" + text + "' is not I/N with I from 1 to N");
  return {index, count};
}

// The options for chips and detail at edges.
void take_edges(const Command& w, dataset::Settings& s) {
  s.chips = range("--chips", w.chips);
  s.edge_detail = range("--edge-detail", w.edge_detail);
  if (!(s.chips.low >= 0 && s.chips.high <= 100000) || s.chips.low != std::floor(s.chips.low) ||
      s.chips.high != std::floor(s.chips.high))
    throw tool::UsageError("--chips must be whole numbers between 0 and 100000");
  if (!(s.edge_detail.low >= 0 && s.edge_detail.high < 1))
    throw tool::UsageError("--edge-detail must be fractions of the diagonal, at least 0 and below 1");
  if (!(w.chip_size >= 0.01 && w.chip_size <= 1)) throw tool::UsageError("--chip-size must be from 0.01 to 1");
  if (!(w.edge_width >= 0.001 && w.edge_width <= 1)) throw tool::UsageError("--edge-width must be from 0.001 to 1");
  s.chip_size = w.chip_size;
  s.edge_width = w.edge_width;
}

dataset::Settings settings_of(const Command& w, std::uint64_t seed) {
  dataset::Settings s;
  std::string name;
  for (std::istringstream names(w.patterns); std::getline(names, name, ',');) {
    try {
      s.patterns.push_back(geo::pattern_named(name));
    } catch (const geo::InputError& e) {
      throw tool::UsageError("--patterns '" + name + "': " + e.what());
    }
    if (s.patterns.back() == geo::Pattern::curves || s.patterns.back() == geo::Pattern::sheets)
      throw tool::UsageError("--patterns: " + name + " are drawn by hand; give patterns that seeds vary");
    if (std::count(s.patterns.begin(), s.patterns.end(), s.patterns.back()) > 1)
      throw tool::UsageError("--patterns: " + name + " is there twice");
  }
  if (s.patterns.empty()) throw tool::UsageError("--patterns is empty");
  s.pieces = range("--pieces", w.pieces);
  s.jagged = range("--jagged", w.jagged);
  if (!(s.pieces.low >= 2 && s.pieces.high <= 100000) || s.pieces.low != std::floor(s.pieces.low) ||
      s.pieces.high != std::floor(s.pieces.high))
    throw tool::UsageError("--pieces must be whole numbers between 2 and 100000");
  if (!(s.jagged.low >= 0 && s.jagged.high < 1))
    throw tool::UsageError("--jagged must be fractions of the diagonal, at least 0 and below 1");
  if (!(w.bumps > 0 && w.bumps <= 1e4)) throw tool::UsageError("--bumps must be positive and at most 10000");
  if (w.seeds < 1 || w.seeds > 100000000) throw tool::UsageError("--seeds must be between 1 and 100000000");
  // Seeds are signed in archives.
  if (seed > std::uint64_t(std::numeric_limits<std::int64_t>::max()) - 100000000)
    throw tool::UsageError("--seed is too large");
  if (w.per_shard < 1 || w.per_shard > 10000) throw tool::UsageError("--per-shard must be between 1 and 10000");
  if (w.attempts < 1 || w.attempts > 10000) throw tool::UsageError("--attempts must be between 1 and 10000");
  s.first_seed = seed;
  s.seeds = w.seeds;
  s.bumps = w.bumps;
  s.attempts = w.attempts;
  take_edges(w, s);
  s.per_shard = w.per_shard;
  s.rotate = w.rotate;
  s.single = w.single;
  s.repair = w.repair;
  s.folders = w.layout == "folders";
  if (s.folders && s.single) throw tool::UsageError("--single is for --layout npz; PLY files have doubles");
  s.split = split(w.split);
  return s;
}

void print(const dataset::Totals& t) {
  std::printf(
      "{\"made\":%zu,\"found\":%zu,\"failed\":%zu,\"refused_models\":%zu,\"bytes\":%zu,\"seconds\":%s,"
      "\"cpu_seconds\":%s,\"complete\":%s}\n",
      t.made, t.found, t.failed, t.refused_models, t.bytes, tool::number(t.seconds).c_str(),
      tool::number(t.cpu_seconds).c_str(), t.complete ? "true" : "false");
}

}  // namespace

int main(int argc, char** argv) {
  tool::Tool t("kerf-dataset",
               "Breaks many models many times: pieces with labels of their faces, bonds and volumes, for learning.",
               R"(  kerf-dataset models/*.off -o fractures
  kerf-dataset models.txt --patterns voronoi,planes --pieces 5:30 --jagged 0:0.02 --seeds 1000 -o fractures
  kerf-dataset models.txt --shard 3/100 -o fractures
  kerf-dataset models/*.off --seeds 20 --layout folders -o fractures)");
  Command w;
  t.argument("MODELS", w.models, "Closed surfaces, or lists (.txt) with a path, or name, tab and path, on each line");
  t.option("--patterns", w.patterns, "Patterns of kerf-score, separated by commas");
  t.option("--seeds", w.seeds, "Fractures for each model and pattern, with consecutive seeds from --seed on");
  t.option("--pieces", w.pieces,
           "Pieces of a fracture, as nearly as attempts find; A:B: a number between, drawn for each");
  t.option("--jagged", w.jagged,
           "Height of bumps as a fraction of the diagonal; A:B: a number between, drawn for each");
  t.option("--bumps", w.bumps, "How many of the largest bumps fit along the diagonal; more make finer walls");
  t.option("--edge-detail", w.edge_detail,
           "Height of finer bumps where walls meet the skin, as a fraction of the diagonal; A:B as above");
  t.option("--edge-width", w.edge_width, "How deep under the skin these go, as a fraction of the diagonal");
  t.option("--chips", w.chips, "Small pieces that break off edges, beside --pieces; A:B as above");
  t.option("--chip-size", w.chip_size,
           "Length of a chip along its edge, as a fraction of the cube root of the mean piece's volume");
  t.option("--attempts", w.attempts, "How many patterns are tried for the number of pieces");
  t.flag("--rotate", w.rotate, "Rotate each piece at random about its centroid, which becomes the origin");
  t.flag("--repair", w.repair, "Repair models first, as kerf-repair does");
  t.choice("--layout", w.layout, {"npz", "folders"}, "NumPy archives, or folders of PLY files as of Breaking Bad");
  t.option("--per-shard", w.per_shard, "Fractures in an archive");
  t.flag("--single", w.single, "Vertices in single precision");
  t.option("--split", w.split, "Percentages of models for training, validation and test");
  t.option("--shard", w.shard, "I/N: make part I of N alone; N processes make the whole");
  t.flag("--strict", w.strict, "Exit with 1 where a fracture failed or a model was refused");
  t.output("The folder of the data set; continued where it is there", {"a folder"});
  return t.run(argc, argv, [&] {
    if (w.models.empty()) throw tool::UsageError("MODELS is required");
    if (t.output_path.empty() || t.output_path == "-") throw tool::UsageError("give a folder with -o");
    t.require_ending();
    for (const auto& [option, companion] : {std::pair("--edge-width", "--edge-detail"), {"--chip-size", "--chips"}})
      t.require(option, companion);
    const auto settings = settings_of(w, t.seed);
    const auto [index, count] = shard(w.shard);
    const auto models = dataset::list_models(w.models);
    if (models.empty()) throw geo::InputError(w.models.front() + ": lists no model");
    const auto part = dataset::part_of(dataset::plan(models, settings).size(), index, count);
    const auto totals = dataset::run(t.output_path, models, settings, part, t.progress());
    for (const std::string& note : totals.notes) t.say("kerf-dataset: " + note);
    if (t.json) print(totals);
    const std::size_t bad = totals.failed;
    if (bad > 0)
      t.say("kerf-dataset: " + tool::counted(bad, "fracture") + " failed, " +
            tool::counted(totals.refused_models, "model") + " refused" +
            (totals.refused_models > 0 && !w.repair ? ", which --repair may mend" : "") +
            "; reasons are in the records" + (totals.complete ? " and in " + t.output_path + "/failed.txt" : ""));
    if (t.verbose)
      t.say("kerf-dataset: " + tool::counted(totals.made, "fracture") + " made, " + std::to_string(totals.found) +
            " were there, " + tool::rounded(totals.seconds) + " s" + (totals.complete ? "; complete" : ""));
    if (bad > 0 && totals.made + totals.found == 0) throw tool::Failure("no fracture could be made");
    if (bad > 0 && w.strict) throw tool::Failure("some fractures failed");
  });
}
