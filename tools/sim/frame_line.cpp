// One JSON object a line (docs/tools/kerf-sim.md), or a line for people.
#include "sim/frame_line.h"

#include <cstdio>
#include <utility>
#include <vector>

#include "tool.h"

namespace sim {

namespace {

std::string vector(const geo::Vec3& v) {
  return "[" + tool::number(v.x()) + "," + tool::number(v.y()) + "," + tool::number(v.z()) + "]";
}

std::vector<std::pair<std::string, double>> phases(const geo::FrameStats& stats) {
  return {{"front", stats.front_seconds},
          {"mesh", stats.split.crack.seconds()},
          {"graph", stats.split.graph_seconds},
          {"resample", stats.split.resample_seconds},
          {"binding", stats.split.binding_seconds},
          {"fracture", stats.fracture_seconds},
          {"mechanics", stats.mechanics_seconds},
          {"contact", stats.contact_seconds},
          {"write", stats.write_seconds}};
}

}  // namespace

std::string seconds(const geo::FrameStats& stats) {
  std::string text;
  for (const auto& [name, s] : phases(stats)) text += (text.empty() ? "{\"" : ",\"") + name + "\":" + tool::number(s);
  return text + "}";
}

std::string seconds_in_words(const geo::FrameStats& stats) {
  double all = 0;
  std::string text;
  char shown[32];
  const auto rounded = [&](double s) {
    std::snprintf(shown, sizeof shown, "%.2g", s);
    return std::string(shown);
  };
  for (const auto& [name, s] : phases(stats)) {
    all += s;
    if (rounded(s) != "0") text += (text.empty() ? "" : ", ") + name + " " + rounded(s);
  }
  return text.empty() ? std::string() : "; " + rounded(all) + " s: " + text;
}

std::string counts(const geo::FrameStats& stats) {
  const auto of = [](const char* name, std::size_t n) { return std::string("\"") + name + "\":" + std::to_string(n); };
  return of("steps", stats.steps) + "," + of("newton", stats.newton) + "," + of("cg", stats.cg) + "," +
         of("fronts", stats.fronts) + "," + of("cracks_begun", stats.fracture.begun + stats.fracture.divided) + "," +
         of("bonds_broken", stats.fracture.broken) + "," + of("refused", stats.refused) + "," +
         of("triangles_cut", stats.split.crack.triangles_cut) + "," + of("edges_cut", stats.split.edges_cut) + "," +
         of("nodes_updated", stats.split.nodes_updated) + "," + of("nodes_added", stats.split.nodes_added) + "," +
         of("blows", stats.blows) + "," + of("blow_parts", stats.blow_parts) + "," +
         of("touching", stats.contact.touching) + "," + of("in_zones", stats.contact.in_zones) + "," +
         of("held", stats.contact.held);
}

std::string line_of(const FrameOutcome& o, std::size_t crossings) {
  std::string line =
      "{\"frame\":" + std::to_string(o.frame) + ",\"time\":" + tool::number(o.time) +
      ",\"nodes\":" + std::to_string(o.nodes) + ",\"faces\":" + std::to_string(o.faces) + "," + counts(o.stats) +
      ",\"crossings\":" + std::to_string(crossings) + ",\"lag\":" + tool::number(o.stats.contact.tracking_error) +
      ",\"sheet_deviation\":" + tool::number(o.stats.sheet.deviation) +
      ",\"sheet_turning\":" + tool::number(o.stats.sheet.turning) +
      ",\"retreating\":" + std::to_string(o.stats.sheet.retreating) +
      ",\"crumbs\":" + std::to_string(o.stats.sheet.crumbs) +
      ",\"broken_area\":" + tool::number(o.stats.fracture.broken_area) +
      ",\"surface_energy\":" + tool::number(o.stats.fracture.spent) + ",\"energy\":" + tool::number(o.stats.energy) +
      ",\"kinetic\":" + tool::number(o.stats.kinetic) + ",\"weight\":" + tool::number(o.stats.weight) +
      ",\"cut_energy\":" + tool::number(o.stats.cut_energy) + ",\"blade_force\":[";
  for (std::size_t b = 0; b < o.stats.blade_force.size(); ++b) line += (b ? "," : "") + vector(o.stats.blade_force[b]);
  line += "],\"obstacles\":[";
  for (std::size_t k = 0; k < o.stats.obstacle_force.size(); ++k)
    line += std::string(k ? "," : "") + "{\"force\":" + vector(o.stats.obstacle_force[k]) +
            ",\"torque\":" + vector(o.stats.obstacle_torque[k]) + "}";
  line += "],\"work\":" + tool::number(o.stats.work) + ",\"supports\":[";
  for (std::size_t k = 0; k < o.stats.support_force.size(); ++k)
    line += (k ? "," : "") + vector(o.stats.support_force[k]);
  line += "],\"tips\":[";
  for (std::size_t k = 0; k < o.stats.fracture.tips.size(); ++k) {
    const geo::CrackTip& tip = o.stats.fracture.tips[k];
    line += std::string(k ? "," : "") + "{\"crack\":" + std::to_string(tip.crack) + ",\"at\":" + vector(tip.at) +
            ",\"length\":" + tool::number(tip.length) + "}";
  }
  return line + "]";
}

}  // namespace sim
