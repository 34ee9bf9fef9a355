// kerf-score: writes fracture patterns as sheets for kerf-crack.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>

#include <kerf/files.h>
#include <kerf/score.h>
#include "model.h"
#include "tool.h"

namespace {

struct Command {
  std::string model, pattern = "voronoi", axis, impact, depth;
  std::vector<std::string> curves, sheets;
  int pieces = 20, attempts = 60;
  double jagged = 0, bumps = 8, cluster = 0.15, grain = 5;
  bool repair = false;
};

geo::Vec3 vector(const std::string& option, const std::string& text) {
  double x = 0, y = 0, z = 0;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%lf,%lf,%lf%c", &x, &y, &z, &rest) != 3 || !geo::in_range({x, y, z}))
    throw tool::UsageError(option + " '" + text + "' is not X,Y,Z");
  return {x, y, z};
}

double percent(const std::string& text) {
  double value = 0;
  char sign = 0, rest = 0;
  if (std::sscanf(text.c_str(), "%lf%c%c", &value, &sign, &rest) != 2 || sign != '%' || !(value > 0 && value <= 100))
    throw tool::UsageError("--depth '" + text + "' is not a percentage, like 80%");
  return value / 100;
}

geo::ScoreOptions options_of(const Command& w, std::uint64_t seed) {
  geo::ScoreOptions o;
  o.pattern.pattern = geo::pattern_named(w.pattern);
  const bool curves = o.pattern.pattern == geo::Pattern::curves, sheets = o.pattern.pattern == geo::Pattern::sheets;
  if (curves == w.curves.empty()) throw tool::UsageError("--pattern curves and --curves FILE go together");
  if (sheets == w.sheets.empty()) throw tool::UsageError("--pattern sheets and --sheets FILE go together");
  if (w.axis == "x" || w.axis == "y" || w.axis == "z")
    o.pattern.axis = geo::Vec3::Unit(w.axis[0] - 'x');
  else if (!w.axis.empty())
    o.pattern.axis = vector("--axis", w.axis);
  if (o.pattern.axis && !(o.pattern.axis->norm() > 0)) throw tool::UsageError("--axis has no length");
  if (!w.impact.empty()) o.pattern.impact = vector("--impact", w.impact);
  if (!w.depth.empty()) o.depth = percent(w.depth);
  if (w.pieces < 1 || w.pieces > 1000000) throw tool::UsageError("--pieces must be between 1 and 1000000");
  if (w.attempts < 1) throw tool::UsageError("--attempts must be at least 1");
  if (!(w.jagged >= 0 && w.jagged < 1))
    throw tool::UsageError("--jagged must be a fraction of the diagonal, at least 0 and below 1");
  if (!(w.bumps > 0 && w.bumps <= 1e4)) throw tool::UsageError("--bumps must be positive and at most 10000");
  if (!(w.cluster > 0 && w.cluster <= 10)) throw tool::UsageError("--cluster must be above 0 and at most 10");
  if (!(w.grain >= 1 && w.grain <= 1000)) throw tool::UsageError("--grain must be between 1 and 1000");
  o.pieces = w.pieces;
  o.attempts = w.attempts;
  o.jagged.amplitude = w.jagged;
  o.jagged.frequency = w.bumps;
  o.jagged.seed = seed;
  o.pattern.cluster = w.cluster;
  o.pattern.grain = w.grain;
  o.pattern.seed = seed;
  for (const auto& path : w.curves)
    for (const auto& front : geo::read_curves(path)) {
      if (front.is_sheet())
        throw geo::InputError(path + ": '" + front.name + "' is a sheet, not a curve; give it with --sheets");
      for (auto curve : front.steps) {
        if (front.closed) curve.push_back(curve.front());
        o.pattern.curves.push_back(std::move(curve));
      }
    }
  for (const auto& path : w.sheets) o.pattern.sheets.push_back(tool::read_surface(path).mesh);
  return o;
}

}  // namespace

int main(int argc, char** argv) {
  tool::Tool t("kerf-score", "Writes a fracture pattern as a front file, for kerf-crack to part a model along.",
               R"(  kerf-score bear.off --pattern voronoi --pieces 30 --jagged 0.02 --seed 7 -o score.front
  kerf-score bear.off --pattern voronoi --impact 0,0.2,0.1 --pieces 50 -o impact.front
  kerf-score pane.ply --pattern glass --impact 0.4,0.5,0 --pieces 60 -o glass.front
  kerf-score bear.off --pattern bricks --axis y --depth 80% -o partial.front
  kerf-score bear.off --pattern curves --curves lines.obj --axis z -o curves.front)");
  Command w;
  t.argument("MODEL", w.model, "A closed surface, or a cut one from kerf-crack");
  t.choice("--pattern", w.pattern, {geo::pattern_names.begin(), geo::pattern_names.end()}, "Where the walls are");
  t.option("--pieces", w.pieces,
           "How many pieces of the model, as nearly as attempts find; curves, sheets: as they come");
  t.option("--attempts", w.attempts, "How many patterns are tried for that");
  t.option("--jagged", w.jagged, "Height of the walls' bumps as a fraction of the model's diagonal; 0: walls are flat");
  t.option("--bumps", w.bumps, "How many of the largest bumps fit along the diagonal");
  t.option("--depth", w.depth,
           "Partial score: cracks go so far in from the skin, P% of each wall's depth, and the body holds");
  t.option("--axis", w.axis,
           "x, y, z or X,Y,Z: across planes, along grain, up the courses, through radial cracks, of the sweep");
  t.option("--impact", w.impact,
           "X,Y,Z: where radial and glass cracks meet, near where cells of voronoi and wood are small");
  t.option("--cluster", w.cluster, "How far from the impact cells are small, as a fraction of the diagonal");
  t.option("--grain", w.grain, "wood: how many times longer than thick cells are");
  t.option("--curves", w.curves, "Polylines to sweep: OBJ, or the steps of front files");
  t.option("--sheets", w.sheets, "Surfaces, open or closed, which may cross each other");
  t.flag("--repair", w.repair, "Repair the model first, as kerf-repair does; give it to kerf-crack, too");
  t.output("The front file", {".front"});
  return t.run(argc, argv, [&] {
    const auto options = options_of(w, t.seed);
    const std::string target = t.target(false);
    const auto file =
        tool::read_solid(w.model, w.repair, [&](const std::string& line) { t.say("kerf-score: " + line); });
    const geo::Complex complex = tool::complex_of(file, w.model);
    geo::Score score;
    try {
      score = geo::make_score(complex, options, t.progress());
    } catch (const geo::GeometryError& e) {
      throw geo::GeometryError(w.model + ": " + e.what());
    }
    if (score.sheet.triangles.empty()) throw tool::Failure("the pattern does not meet the model; ask for more pieces");
    const std::size_t triangles = score.sheet.triangles.size();
    const geo::Front front{.name = w.pattern,
                           .closed = false,
                           .steps = {std::move(score.sheet.vertices)},
                           .triangles = std::move(score.sheet.triangles)};
    geo::write_all(target, [&](std::ostream& out) { geo::write_fronts(out, {front}); });
    const bool as_given =
        options.pattern.pattern == geo::Pattern::curves || options.pattern.pattern == geo::Pattern::sheets;
    if (!as_given && score.pieces != static_cast<std::uint32_t>(w.pieces))
      t.say("kerf-score: " + std::to_string(score.pieces) + " pieces, not " + std::to_string(w.pieces) +
            "; another --seed or more --attempts may find them");
    if (t.json)
      (target == "-" ? std::cerr : std::cout)
          << "{\"pattern\":" << tool::quoted(w.pattern) << ",\"pieces\":" << score.pieces
          << ",\"attempts\":" << score.attempts << ",\"triangles\":" << triangles << "}\n";
    if (t.verbose)
      t.say("kerf-score: " + std::to_string(score.pieces) + " pieces, " + std::to_string(triangles) +
            " triangles, attempt " + std::to_string(score.attempts));
  });
}
