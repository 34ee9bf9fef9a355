// Random numbers are those of SplitMix64 (Steele, Lea, Flood 2014), a generator for each purpose.
#include "dataset/recipe.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>

#include "tool.h"

namespace dataset {
namespace {

class Generator {
 public:
  Generator(std::uint64_t seed, std::uint64_t purpose) : state_(seed * 0x9e3779b97f4a7c15ull ^ purpose << 32) {}

  // Uniform in [0, 1).
  double uniform() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ull);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1.0p-53;
  }
  double uniform(const Range& range) { return range.low + (range.high - range.low) * uniform(); }

 private:
  std::uint64_t state_;
};

// A file's name as a word of a shell's command.
std::string quoted_for_shell(const std::string& name) {
  const auto is_plain = [](unsigned char c) { return std::isalnum(c) || std::strchr("._-/+,@", c); };
  if (std::all_of(name.begin(), name.end(), is_plain)) return name;
  std::string quoted = "'";
  for (const char c : name) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

constexpr std::uint64_t drawing = 1, turning = 2;  // purposes; pieces count up from the second

}  // namespace

Recipe recipe_of(const Settings& s, geo::Pattern pattern, std::uint64_t seed) {
  Generator random(seed, drawing);
  Recipe r{.pattern = pattern,
           .seed = seed,
           .pieces = 0,
           .attempts = s.attempts,
           .jagged = 0,
           .bumps = s.bumps,
           .chips = 0,
           .chip_size = s.chip_size,
           .edge_detail = 0,
           .edge_width = s.edge_width};
  const auto whole = [&](const Range& range) {
    return static_cast<int>(std::floor(random.uniform({range.low, range.high + 1})));
  };
  // Three digits after the first: the command that is recorded stays short.
  const auto fraction = [&](const Range& range) {
    const double drawn = random.uniform(range);
    return range.low == range.high ? drawn : std::round(drawn * 1e5) / 1e5;
  };
  r.pieces = whole(s.pieces);
  r.jagged = fraction(s.jagged);
  r.chips = whole(s.chips);
  r.edge_detail = fraction(s.edge_detail);
  return r;
}

geo::ScoreOptions score_options(const Recipe& r) {
  geo::ScoreOptions o;
  o.pattern.pattern = r.pattern;
  o.pieces = r.pieces;
  o.attempts = r.attempts;
  o.jagged.amplitude = r.jagged;
  o.jagged.frequency = r.bumps;
  o.jagged.edge_amplitude = r.edge_detail;
  o.jagged.edge_width = r.edge_width;
  o.chips.count = r.chips;
  o.chips.size = r.chip_size;
  o.pattern.seed = o.jagged.seed = r.seed;
  return o;
}

std::string command_of(const Recipe& r, const std::string& model) {
  const std::string quoted = quoted_for_shell(model);
  std::string at_edges;
  if (r.chips > 0) at_edges += " --chips " + std::to_string(r.chips) + " --chip-size " + tool::number(r.chip_size);
  if (r.edge_detail > 0)
    at_edges += " --edge-detail " + tool::number(r.edge_detail) + " --edge-width " + tool::number(r.edge_width);
  return "kerf-score " + quoted + " --pattern " + geo::pattern_names[static_cast<std::size_t>(r.pattern)] +
         " --pieces " + std::to_string(r.pieces) + " --jagged " + tool::number(r.jagged) + " --bumps " +
         tool::number(r.bumps) + at_edges + " --attempts " + std::to_string(r.attempts) + " --seed " +
         std::to_string(r.seed) + " | kerf-crack " + quoted + " --front - -o broken.ply";
}

std::array<double, 4> random_rotation(std::uint64_t seed, std::uint32_t piece) {
  Generator random(seed, turning + piece);
  constexpr double turn = 6.283185307179586;
  const double u = random.uniform(), a = turn * random.uniform(), b = turn * random.uniform();
  const double r = std::sqrt(1 - u), s = std::sqrt(u);
  return {s * std::cos(b), r * std::sin(a), r * std::cos(a), s * std::sin(b)};
}

}  // namespace dataset
