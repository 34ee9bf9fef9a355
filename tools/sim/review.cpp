// The frames' lines tell of all frames, those before a resumed run included.
#include "sim/review.h"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include <kerf/error.h>
#include "tool.h"

namespace sim {
namespace {

// Energy counts as risen above this share of the largest kinetic and elastic energy of the run: ten
// times the error of the scenes' accuracy.
constexpr double energy_margin = 0.01;
// For three frames: one frame alone may show a penalty that gives back what it has stored.
constexpr int frames_of_rise = 3;

bool moves(const geo::Motion& motion, double from, double to) {
  return motion.keys.size() > 1 && motion.keys.front().time <= to && motion.keys.back().time >= from;
}

// Whether something outside does work on the bodies, or changes them, between two times.
bool is_loaded(const geo::Scene& scene, double from, double to) {
  const auto any = [&](const auto& things) {
    return std::any_of(things.begin(), things.end(), [&](const auto& t) { return moves(t.motion, from, to); });
  };
  const auto changes = [&](const geo::SceneChange& c) { return c.time >= from && c.time <= to; };
  const auto tightens = [&](const geo::Stitch& s) {
    return (s.from <= to && s.from + s.closing >= from) || (s.until >= from && s.until <= to);
  };
  if (std::any_of(scene.stitches.begin(), scene.stitches.end(), tightens)) return true;
  return any(scene.blades) || any(scene.grips) || any(scene.pulls) || any(scene.obstacles) || scene.fracture.on ||
         std::any_of(scene.changes.begin(), scene.changes.end(), changes);
}

std::string crossing_fault(const geo::Scene& scene, const std::vector<FrameFigures>& frames) {
  std::size_t all = 0, first = 0;
  for (const FrameFigures& f : frames) {
    if (f.crossings > 0 && all == 0) first = static_cast<std::size_t>(f.frame);
    all += f.crossings;
  }
  if (all == 0) return {};
  return tool::counted(all, "pair") + " of triangles cross, from frame " + std::to_string(first) + " on" +
         (scene.self_contact ? "" : ", without contact.self");
}

std::string lag_fault(const std::vector<FrameFigures>& frames, double spacing) {
  const auto worst =
      std::max_element(frames.begin(), frames.end(), [](const auto& a, const auto& b) { return a.lag < b.lag; });
  if (worst == frames.end() || worst->lag <= spacing) return {};
  return "the surface is " + tool::rounded(worst->lag) + " behind its nodes in frame " + std::to_string(worst->frame) +
         ", more than their spacing of " + tool::rounded(spacing);
}

// The largest energy since the last load is the reference: what bounces gives back energy that it
// has stored, but no more.
std::string energy_fault(const geo::Scene& scene, const std::vector<FrameFigures>& frames, double least_energy) {
  double scale = least_energy, reference = -std::numeric_limits<double>::infinity();
  for (const FrameFigures& f : frames) scale = std::max(scale, f.elastic + f.kinetic);
  int risen = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const FrameFigures& f = frames[i];
    const double energy = f.elastic + f.kinetic + f.weight;
    const bool loaded = i == 0 || is_loaded(scene, frames[i - 1].time, f.time);
    if (loaded) {
      // The frame before may hold what a contact has stored.
      const double before = i > 0 ? frames[i - 1].elastic + frames[i - 1].kinetic + frames[i - 1].weight : energy;
      reference = std::max(energy, before);
    }
    risen = energy > reference + energy_margin * scale ? risen + 1 : 0;
    if (risen == frames_of_rise)
      return "energy rises by itself, from " + tool::rounded(reference) + " to " + tool::rounded(energy) +
             " J in frame " + std::to_string(f.frame);
  }
  return {};
}

}  // namespace

std::vector<FrameFigures> read_figures(const std::string& log) {
  std::vector<FrameFigures> frames;
  std::istringstream lines(log);
  for (std::string line; std::getline(lines, line);) {
    const auto figures = nlohmann::json::parse(line, nullptr, false);
    if (!figures.is_object()) throw geo::InputError("frames.jsonl has a line that is no JSON object");
    frames.push_back({.frame = figures.value("frame", 0),
                      .time = figures.value("time", 0.0),
                      .crossings = figures.value("crossings", std::size_t(0)),
                      .refused = figures.value("refused", std::size_t(0)),
                      .crumbs = figures.value("crumbs", std::size_t(0)),
                      .lag = figures.value("lag", 0.0),
                      .elastic = figures.value("energy", 0.0),
                      .kinetic = figures.value("kinetic", 0.0),
                      .weight = figures.value("weight", 0.0)});
  }
  return frames;
}

std::vector<std::string> faults_of(const geo::Scene& scene, const std::vector<FrameFigures>& frames,
                                   const BodyFigures& bodies) {
  std::vector<std::string> faults;
  if (frames.empty()) return faults;
  faults.push_back(crossing_fault(scene, frames));
  if (frames.back().crumbs > 0)
    faults.push_back(tool::counted(frames.back().crumbs, "piece") + " of less than a tenth of a node's volume");
  std::size_t refused = 0;
  for (const FrameFigures& f : frames) refused += f.refused;
  if (refused > 0)
    faults.push_back(tool::counted(refused, "crack step") + " could not be made, and cuts may lag behind their blades");
  faults.push_back(lag_fault(frames, bodies.spacing));
  faults.push_back(energy_fault(scene, frames, bodies.least_energy));
  std::erase_if(faults, [](const std::string& fault) { return fault.empty(); });
  return faults;
}

}  // namespace sim
