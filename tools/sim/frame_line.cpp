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

std::vector<std::pair<std::string, double>> phases(const geo::FrameStats& w) {
  return {{"front", w.front_seconds},
          {"mesh", w.split.crack.seconds()},
          {"graph", w.split.graph_seconds},
          {"resample", w.split.resample_seconds},
          {"binding", w.split.binding_seconds},
          {"fracture", w.fracture_seconds},
          {"mechanics", w.mechanics_seconds},
          {"contact", w.contact_seconds},
          {"write", w.write_seconds}};
}

}  // namespace

std::string seconds(const geo::FrameStats& w) {
  std::string text;
  for (const auto& [name, s] : phases(w)) text += (text.empty() ? "{\"" : ",\"") + name + "\":" + tool::number(s);
  return text + "}";
}

std::string seconds_in_words(const geo::FrameStats& w) {
  double all = 0;
  std::string text;
  char shown[32];
  const auto rounded = [&](double s) { return std::snprintf(shown, sizeof shown, "%.2g", s), std::string(shown); };
  for (const auto& [name, s] : phases(w)) {
    all += s;
    if (rounded(s) != "0") text += (text.empty() ? "" : ", ") + name + " " + rounded(s);
  }
  return text.empty() ? std::string() : "; " + rounded(all) + " s: " + text;
}

std::string counts(const geo::FrameStats& w) {
  const auto of = [](const char* name, std::size_t n) { return std::string("\"") + name + "\":" + std::to_string(n); };
  return of("steps", w.steps) + "," + of("newton", w.newton) + "," + of("cg", w.cg) + "," + of("fronts", w.fronts) +
         "," + of("cracks_begun", w.fracture.begun + w.fracture.divided) + "," + of("refused", w.refused) + "," +
         of("triangles_cut", w.split.crack.triangles_cut) + "," + of("edges_cut", w.split.edges_cut) + "," +
         of("nodes_updated", w.split.nodes_updated) + "," + of("nodes_added", w.split.nodes_added) + "," +
         of("touching", w.contact.touching) + "," + of("in_zones", w.contact.in_zones) + "," +
         of("held", w.contact.held);
}

std::string line_of(const FrameOutcome& o, std::size_t crossings) {
  std::string line = "{\"frame\":" + std::to_string(o.frame) + ",\"time\":" + tool::number(o.time) +
                     ",\"nodes\":" + std::to_string(o.nodes) + ",\"faces\":" + std::to_string(o.faces) + "," +
                     counts(o.work) + ",\"crossings\":" + std::to_string(crossings) +
                     ",\"lag\":" + tool::number(o.work.contact.tracking_error) +
                     ",\"energy\":" + tool::number(o.work.energy) + ",\"blade_force\":[";
  for (std::size_t b = 0; b < o.work.blade_force.size(); ++b) line += (b ? "," : "") + vector(o.work.blade_force[b]);
  line += "],\"obstacles\":[";
  for (std::size_t k = 0; k < o.work.obstacle_force.size(); ++k)
    line += std::string(k ? "," : "") + "{\"force\":" + vector(o.work.obstacle_force[k]) +
            ",\"torque\":" + vector(o.work.obstacle_torque[k]) + "}";
  return line + "]";
}

}  // namespace sim
