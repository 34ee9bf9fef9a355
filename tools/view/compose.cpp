#include "view/compose.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "base/error.h"

namespace view {
namespace {

using geo::Vec3;

// The shells of a surface: rows that triangles connect. Returns the shell of each row and how many there are.
std::uint32_t shells_of(const geo::TriangleMesh& mesh, std::vector<std::uint32_t>& shell) {
  std::vector<std::uint32_t> root(mesh.vertices.size());
  std::iota(root.begin(), root.end(), 0u);
  const auto find = [&](std::uint32_t v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  for (const auto& [a, b, c] : mesh.triangles) {
    root[std::max(find(a), find(b))] = std::min(find(a), find(b));
    root[std::max(find(b), find(c))] = std::min(find(b), find(c));
  }
  std::uint32_t count = 0;
  shell.assign(root.size(), 0);
  for (std::uint32_t v = 0; v < root.size(); ++v) shell[v] = find(v) == v ? count++ : shell[find(v)];
  return count;
}

Color piece_color(std::uint32_t piece) {
  // Hues a golden angle apart.
  const double hue = std::fmod(0.07 + piece * 0.61803398875, 1.0) * 6;
  const auto channel = [&](double shift) {
    const double h = std::fmod(hue + shift, 6.0);
    return float(0.12 + 0.55 * std::clamp(std::abs(h - 3) - 1, 0.0, 1.0));
  };
  return {channel(0), channel(4), channel(2)};
}

constexpr Color sheet_plus{0.16f, 0.40f, 0.72f};   // side +c
constexpr Color sheet_minus{0.86f, 0.66f, 0.20f};  // side -c

void add_nodes(Stage& stage, const geo::NodeSet& nodes) {
  if (nodes.size() == 0) return;
  const auto [lo, hi] = std::minmax_element(nodes.radius.begin(), nodes.radius.end());
  const double low = *lo, range = std::max(*hi - *lo, 1e-300);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    stage.spheres.push_back({nodes.position[i], 0.14 * nodes.spacing[i], viridis((nodes.radius[i] - low) / range)});
}

void cut(Stage& stage, const Look& look) {
  if (!look.cutaway) return;
  const geo::Box3 box = box_of(stage);
  const Vec3 n = look.cutaway->normal.normalized();
  stage.cutaway = Plane{box.center() + look.cutaway->offset * 0.5 * box.diagonal() * n, n};
  // Nodes and edges on the removed side go with it.
  const auto gone = [&](const Vec3& p) { return (p - stage.cutaway->point).dot(n) > 0; };
  std::erase_if(stage.spheres, [&](const Sphere& s) { return gone(s.center); });
  std::erase_if(stage.sticks, [&](const Stick& s) { return gone(s.a) || gone(s.b); });
}

}  // namespace

Color parse_color(const std::string& text) {
  unsigned value = 0;
  char rest = 0;
  if (text.size() != 7 || text[0] != '#' || std::sscanf(text.c_str() + 1, "%6x%c", &value, &rest) != 1)
    throw geo::InputError("'" + text + "' is not a colour: write #rrggbb");
  const auto linear = [](unsigned byte) { return float(std::pow(byte / 255.0, 2.2)); };
  return {linear(value >> 16), linear(value >> 8 & 255), linear(value & 255)};
}

Color viridis(double t) {
  constexpr Color stops[] = {{0.058f, 0.0004f, 0.088f}, {0.043f, 0.084f, 0.258f}, {0.014f, 0.281f, 0.271f}, {0.105f, 0.584f, 0.122f}, {0.984f, 0.799f, 0.019f}};
  const double s = std::clamp(t, 0.0, 1.0) * 4;
  const int i = std::min(3, static_cast<int>(s));
  Color c{};
  for (int k = 0; k < 3; ++k) c[k] = float(stops[i][k] + (s - i) * (stops[i + 1][k] - stops[i][k]));
  return c;
}

Stage stage_of(const geo::TriangleMesh& surface, const Look& look) {
  Stage stage;
  stage.surface = surface;
  stage.wire = look.wire;
  stage.section = look.section;
  stage.surface_opacity = look.opacity;
  stage.sheets_opaque = look.sheets && surface.patch.size() == surface.triangles.size() && look.opacity < 1;
  std::vector<std::uint32_t> shell;
  const std::uint32_t shells = shells_of(surface, shell);
  if (look.explode > 0) {
    const Vec3 middle = geo::bounding_box(surface).center();
    std::vector<geo::Box3> boxes(shells);
    for (std::size_t v = 0; v < surface.vertices.size(); ++v) boxes[shell[v]].add(surface.vertices[v]);
    for (std::size_t v = 0; v < surface.vertices.size(); ++v)
      stage.surface.vertices[v] += look.explode * (boxes[shell[v]].center() - middle);
  }
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const int patch = surface.patch.empty() ? 0 : surface.patch[t];
    Color color = look.skin;
    if (look.coloring == Coloring::piece) color = piece_color(shell[surface.triangles[t][0]]);
    if (look.coloring == Coloring::patch && patch != 0) color = patch > 0 ? sheet_plus : sheet_minus;
    stage.triangle_colors.push_back(color);
    if (look.coloring == Coloring::patch && patch != 0) color = patch > 0 ? sheet_minus : sheet_plus;
    stage.back_colors.push_back(color);
  }
  cut(stage, look);
  return stage;
}

Stage stage_of(const geo::NodeSet& nodes, const Look& look) {
  Stage stage;
  add_nodes(stage, nodes);
  cut(stage, look);
  return stage;
}

Stage stage_of(const geo::Body& body, const Look& look) {
  Look surface_look = look;
  surface_look.cutaway.reset();
  Stage stage = stage_of(body.surface.two_sided(), surface_look);
  if (look.nodes) add_nodes(stage, body.nodes);
  if (look.edges)
    for (std::uint32_t i = 0; i < body.nodes.size(); ++i)
      for (const geo::NodeId j : body.graph.edges(geo::NodeId(i)))
        if (j.value > i) {
          const double width = 0.016 * std::min(body.nodes.spacing[i], body.nodes.spacing[j.index()]);
          stage.sticks.push_back({body.nodes.position[i], body.nodes.position[j.index()], width, {0.10f, 0.22f, 0.55f}});
        }
  cut(stage, look);
  return stage;
}

Stage stage_of(const std::vector<geo::Front>& fronts, const Look& look) {
  Stage stage;
  geo::Box3 box;
  for (const auto& front : fronts)
    for (const auto& step : front.steps)
      for (const auto& p : step) box.add(p);
  const double width = 0.002 * box.diagonal();
  for (const auto& front : fronts)
    for (std::size_t s = 0; s < front.steps.size(); ++s) {
      const auto& points = front.steps[s];
      const Color color = viridis(front.steps.size() > 1 ? double(s) / double(front.steps.size() - 1) : 0);
      const std::size_t n = points.size();
      for (std::size_t i = 0; i + (front.closed ? 0 : 1) < n; ++i) stage.sticks.push_back({points[i], points[(i + 1) % n], width, color});
      if (s + 1 < front.steps.size() && front.steps[s + 1].size() == n)
        for (std::size_t i = 0; i < n; ++i) stage.sticks.push_back({points[i], front.steps[s + 1][i], 0.4 * width, Color{0.4f, 0.4f, 0.42f}});
    }
  cut(stage, look);
  return stage;
}

geo::Box3 box_of(const Stage& stage) {
  geo::Box3 box;
  for (const auto& t : stage.surface.triangles)
    for (const auto v : t) box.add(stage.surface.vertices[v]);
  for (const auto& s : stage.spheres) box.add(geo::Box3{s.center, s.center}.grown(s.radius));
  for (const auto& s : stage.sticks) box.add(s.a), box.add(s.b);
  return box;
}

}  // namespace view
