// kerf-score: writes fracture patterns as sheets for kerf-crack.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iostream>

#include <kerf/files.h>
#include <kerf/pieces.h>
#include <kerf/score.h>
#include "model.h"
#include "score/png_file.h"
#include "tool.h"

namespace {

// Names of geo::ColorChannel, in the order of its values.
constexpr std::array channels{"red", "green", "blue", "alpha", "luminance"};
const std::vector<std::string> densities{"even", "red", "green", "blue",      "alpha",     "luminance",
                                         "x",    "y",   "z",     "falling-x", "falling-y", "falling-z"};

struct Command {
  std::string model, pattern = "voronoi", axis, impact, depth, density = "even", image, up, fit = "inside";
  std::vector<std::string> curves, sheets;
  int pieces = 20, attempts = 60, chips = 0;
  double jagged = 0, bumps = 8, cluster = 0.15, grain = 5;
  double edge_detail = 0, edge_width = 0.03, chip_size = 0.25, tolerance = 0.5;
  bool repair = false;
};

// x, y, z or X,Y,Z.
geo::Vec3 direction(const std::string& option, const std::string& text) {
  if (text == "x" || text == "y" || text == "z") return geo::Vec3::Unit(text[0] - 'x');
  const geo::Vec3 given = tool::parse_vector(option, text);
  if (!(given.norm() > 0)) throw tool::UsageError(option + " has no length");
  return given;
}

double percent(const std::string& text) {
  double value = 0;
  char sign = 0, rest = 0;
  if (std::sscanf(text.c_str(), "%lf%c%c", &value, &sign, &rest) != 2 || sign != '%' || !(value > 0 && value <= 100))
    throw tool::UsageError("--depth '" + text + "' is not a percentage, like 80%");
  return value / 100;
}

// The options for what is done to walls.
void require_finish(const Command& w) {
  if (!(w.edge_detail >= 0 && w.edge_detail < 1))
    throw tool::UsageError("--edge-detail must be a fraction of the diagonal, at least 0 and below 1");
  if (!(w.edge_width >= 0.001 && w.edge_width <= 1)) throw tool::UsageError("--edge-width must be from 0.001 to 1");
  if (w.chips < 0 || w.chips > 100000) throw tool::UsageError("--chips must be from 0 to 100000");
  if (!(w.chip_size >= 0.01 && w.chip_size <= 1)) throw tool::UsageError("--chip-size must be from 0.01 to 1");
  if (w.chips > 0 && !w.depth.empty()) throw tool::UsageError("--chips and --depth do not go together: none break off");
  if (!(w.tolerance >= 0 && w.tolerance <= 1000)) throw tool::UsageError("--tolerance must be from 0 to 1000 pixels");
}

geo::ScoreOptions options_of(const Command& w, std::uint64_t seed) {
  geo::ScoreOptions o;
  o.pattern.pattern = geo::pattern_named(w.pattern);
  const bool curves = o.pattern.pattern == geo::Pattern::curves, sheets = o.pattern.pattern == geo::Pattern::sheets;
  if (curves && w.curves.empty() && w.image.empty())
    throw tool::UsageError("--pattern curves needs --curves FILE or --image FILE");
  if (!curves && !(w.curves.empty() && w.image.empty()))
    throw tool::UsageError(std::string(w.image.empty() ? "--curves" : "--image") +
                           " goes with --pattern curves; add it");
  if (sheets && w.sheets.empty()) throw tool::UsageError("--pattern sheets needs --sheets FILE");
  if (!sheets && !w.sheets.empty()) throw tool::UsageError("--sheets goes with --pattern sheets; add it");
  if (!w.axis.empty()) o.pattern.axis = direction("--axis", w.axis);
  if (w.density != "even" && o.pattern.pattern != geo::Pattern::voronoi && o.pattern.pattern != geo::Pattern::wood)
    throw tool::UsageError("--density goes with --pattern voronoi or wood");
  if (!w.impact.empty()) o.pattern.impact = tool::parse_vector("--impact", w.impact);
  if (!w.depth.empty()) o.depth = percent(w.depth);
  if (w.pieces < 1 || w.pieces > 1000000) throw tool::UsageError("--pieces must be between 1 and 1000000");
  if (w.attempts < 1) throw tool::UsageError("--attempts must be at least 1");
  if (!(w.jagged >= 0 && w.jagged < 1))
    throw tool::UsageError("--jagged must be a fraction of the diagonal, at least 0 and below 1");
  if (!(w.bumps > 0 && w.bumps <= 1e4)) throw tool::UsageError("--bumps must be positive and at most 10000");
  if (!(w.cluster > 0 && w.cluster <= 10)) throw tool::UsageError("--cluster must be above 0 and at most 10");
  if (!(w.grain >= 1 && w.grain <= 1000)) throw tool::UsageError("--grain must be between 1 and 1000");
  require_finish(w);
  o.jagged.edge_amplitude = w.edge_detail;
  o.jagged.edge_width = w.edge_width;
  o.chips.count = w.chips;
  o.chips.size = w.chip_size;
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

// The density that --density names; empty: none.
geo::Density density_of(const Command& w, const geo::TriangleMesh& model) {
  if (w.density == "even") return {};
  const auto channel = std::find(channels.begin(), channels.end(), w.density);
  try {
    if (channel != channels.end())
      return geo::painted_density(model, static_cast<geo::ColorChannel>(channel - channels.begin()));
  } catch (const geo::InputError& e) {
    throw geo::InputError(w.model + ": " + e.what() + "; give a file with colours of vertices, or another --density");
  }
  const bool falling = w.density.size() > 1;
  const geo::Vec3 axis = geo::Vec3::Unit(w.density.back() - 'x');
  return geo::ramp_density(geo::bounding_box(model), falling ? geo::Vec3(-axis) : axis);
}

// The outlines of --image as curves.
std::vector<std::vector<geo::Vec3>> image_curves(const Command& w, const geo::ScoreOptions& score, const geo::Box3& box,
                                                 const tool::Tool& t) {
  geo::CutOutOptions o;
  if (score.pattern.axis) o.axis = *score.pattern.axis;
  if (!w.up.empty()) o.up = direction("--up", w.up);
  o.fit = w.fit == "inside" ? geo::ImageFit::inside : geo::ImageFit::stretched;
  o.tolerance = w.tolerance;
  const geo::GrayImage image = tool::read_png(w.image);
  geo::CutOut cut;
  try {
    cut = geo::cut_out(image, box, o);
  } catch (const geo::InputError& e) {
    throw geo::InputError(w.image + ": " + e.what());
  }
  if (cut.spots > 0)
    t.say("kerf-score: " + w.image + ": left out: " + tool::counted(cut.spots, "spot") + " smaller than " +
          tool::number(o.least_area) + " pixels");
  return std::move(cut.curves);
}

// Says where the score has fewer pieces or chips than are wanted.
void say_missing(const Command& w, const geo::ScoreOptions& options, const geo::Score& score, const tool::Tool& t) {
  const bool as_given =
      options.pattern.pattern == geo::Pattern::curves || options.pattern.pattern == geo::Pattern::sheets;
  if (!as_given && score.pieces != static_cast<std::uint32_t>(w.pieces))
    t.say("kerf-score: " + std::to_string(score.pieces) + " pieces, not " + std::to_string(w.pieces) +
          "; another --seed or more --attempts may find them");
  if (score.chips != static_cast<std::uint32_t>(w.chips))
    t.say("kerf-score: " + tool::counted(score.chips, "chip") + ", not " + std::to_string(w.chips) +
          "; edges have room for more of a smaller --chip-size");
}

// Why a score of the model has no walls.
std::string why_no_walls(const geo::Complex& complex) {
  const auto parts = geo::find_pieces(complex).count;
  if (parts == 1) return "the pattern does not meet the model; ask for more pieces";
  return "consists of " + std::to_string(parts) +
         " parts that do not touch, which are pieces already; ask for more than that";
}

}  // namespace

int main(int argc, char** argv) {
  tool::Tool t("kerf-score", "Writes a fracture pattern as a front file, for kerf-crack to part a model along.",
               R"(  kerf-score bear.off --pattern voronoi --pieces 30 --jagged 0.02 --seed 7 -o score.front
  kerf-score bear.off --pattern voronoi --impact 0,0.2,0.1 --pieces 50 -o impact.front
  kerf-score pane.ply --pattern glass --impact 0.4,0.5,0 --pieces 60 -o glass.front
  kerf-score bear.off --pattern bricks --axis y --depth 80% -o partial.front
  kerf-score bear.off --pattern curves --curves lines.obj --axis z -o curves.front
  kerf-score plate.ply --pattern curves --image letters.png -o letters.front
  kerf-score painted.ply --density red --pieces 40 -o painted.front
  kerf-score bear.off --pieces 20 --chips 60 --edge-detail 0.004 -o chipped.front)");
  Command w;
  t.argument("MODEL", w.model, "A closed surface, or a cut one from kerf-crack");
  t.choice("--pattern", w.pattern, {geo::pattern_names.begin(), geo::pattern_names.end()}, "Where the walls are");
  t.option("--pieces", w.pieces,
           "How many pieces of the model, as nearly as attempts find; curves, sheets: as they come");
  t.option("--attempts", w.attempts, "How many patterns are tried for that");
  t.option("--jagged", w.jagged, "Height of the walls' bumps as a fraction of the model's diagonal; 0: walls are flat");
  t.option("--bumps", w.bumps, "How many of the largest bumps fit along the diagonal");
  t.option("--edge-detail", w.edge_detail,
           "Height of finer bumps where walls meet the skin, as a fraction of the diagonal; 0: none");
  t.option("--edge-width", w.edge_width, "How deep under the skin these go, as a fraction of the diagonal");
  t.option("--chips", w.chips, "How many small pieces break off where walls meet the skin or each other");
  t.option("--chip-size", w.chip_size,
           "Length of a chip along its edge, as a fraction of the cube root of the mean piece's volume");
  t.option("--depth", w.depth,
           "Partial score: cracks go so far in from the skin, P% of each wall's depth, and the body holds");
  t.option("--axis", w.axis,
           "x, y, z or X,Y,Z: across planes, along grain, up the courses, through radial cracks, of the sweep");
  t.option("--impact", w.impact,
           "X,Y,Z: where radial and glass cracks meet, near where cells of voronoi and wood are small");
  t.option("--cluster", w.cluster, "How far from the impact cells are small, as a fraction of the diagonal");
  t.choice("--density", w.density, densities,
           "voronoi, wood: where cells are many: a colour of the model's vertices, or rising or falling along an axis");
  t.option("--grain", w.grain, "wood: how many times longer than thick cells are");
  t.option("--curves", w.curves, "Polylines to sweep: OBJ, or the steps of front files");
  t.option("--image", w.image, "curves: a PNG; the borders between black and white are swept");
  t.option("--up", w.up, "x, y, z or X,Y,Z: what is up in the image; without it y for --axis z, else z");
  t.choice("--fit", w.fit, {"inside", "stretched"},
           "The image keeps its proportions inside the model's box, or fills it");
  t.option("--tolerance", w.tolerance, "How many pixels simplified outlines of the image may be off");
  t.option("--sheets", w.sheets, "Surfaces, open or closed, which may cross each other");
  t.flag("--repair", w.repair, "Repair the model first, as kerf-repair does; give it to kerf-crack, too");
  t.output("The front file", {".front"});
  return t.run(argc, argv, [&] {
    t.require("--edge-width", "--edge-detail");
    t.require("--chip-size", "--chips");
    for (const char* option : {"--up", "--fit", "--tolerance"}) t.require(option, "--image");
    auto options = options_of(w, t.seed);
    const std::string target = t.target(false);
    const auto file =
        tool::read_solid(w.model, w.repair, [&](const std::string& line) { t.say("kerf-score: " + line); });
    const geo::Complex complex = tool::complex_of(file, w.model);
    options.pattern.density = density_of(w, file.mesh);
    if (!w.image.empty())
      for (auto& curve : image_curves(w, options, complex.extent(), t))
        options.pattern.curves.push_back(std::move(curve));
    geo::Score score;
    try {
      score = geo::make_score(complex, options, t.progress());
    } catch (const geo::GeometryError& e) {
      throw geo::GeometryError(w.model + ": " + e.what());
    }
    if (score.sheet.triangles.empty()) throw tool::Failure(w.model + ": " + why_no_walls(complex));
    const std::size_t triangles = score.sheet.triangles.size();
    const geo::Front front{.name = w.pattern,
                           .closed = false,
                           .steps = {std::move(score.sheet.vertices)},
                           .triangles = std::move(score.sheet.triangles)};
    geo::write_all(target, [&](std::ostream& out) { geo::write_fronts(out, {front}); });
    say_missing(w, options, score, t);
    if (t.json)
      (target == "-" ? std::cerr : std::cout)
          << "{\"pattern\":" << tool::quoted(w.pattern) << ",\"pieces\":" << score.pieces
          << ",\"chips\":" << score.chips << ",\"attempts\":" << score.attempts << ",\"triangles\":" << triangles
          << "}\n";
    if (t.verbose)
      t.say("kerf-score: " + std::to_string(score.pieces) + " pieces, " + tool::counted(score.chips, "chip") + ", " +
            std::to_string(triangles) + " triangles, attempt " + std::to_string(score.attempts));
  });
}
