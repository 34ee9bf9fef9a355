// Colours of pieces: hues in steps of the golden angle, which keeps any number of them apart.
#include "view/compose.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <utility>

#include <kerf/error.h>
#include <kerf/parallel.h>
#include "view/compose_parts.h"
#include "view/pieces.h"

namespace view {
namespace {

using geo::Vec3;

Color piece_color(std::uint32_t piece) {
  // Hues in steps of the golden angle.
  const double hue = std::fmod(0.07 + piece * 0.61803398875, 1.0) * 6;
  const auto channel = [&](double shift) {
    const double h = std::fmod(hue + shift, 6.0);
    return float(0.12 + 0.55 * std::clamp(std::abs(h - 3) - 1, 0.0, 1.0));
  };
  return {channel(0), channel(4), channel(2)};
}

constexpr Color sheet_plus{0.16f, 0.40f, 0.72f};   // side +c
constexpr Color sheet_minus{0.86f, 0.66f, 0.20f};  // side -c

constexpr Color rigid{0.42f, 0.43f, 0.45f};

void add_obstacles(Stage& stage, const geo::TriangleMesh& mesh) {
  const auto first = static_cast<std::uint32_t>(stage.surface.vertices.size());
  stage.surface.vertices.insert(stage.surface.vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
  if (!stage.surface.patch.empty())
    stage.surface.patch.resize(stage.surface.triangles.size() + mesh.triangles.size(), 0);
  for (const auto& [a, b, c] : mesh.triangles) {
    stage.surface.triangles.push_back({first + a, first + b, first + c});
    stage.triangle_colors.push_back(rigid);
    stage.back_colors.push_back(rigid);
  }
  stage.obstacles = mesh.triangles.size();
}

geo::Box3 box_without_obstacles(const Stage& stage) {
  geo::Box3 box;
  for (std::size_t t = 0; t + stage.obstacles < stage.surface.triangles.size(); ++t)
    for (const auto v : stage.surface.triangles[t]) box.add(stage.surface.vertices[v]);
  for (const auto& s : stage.spheres) box.add(geo::Box3{s.center, s.center}.grown(s.radius));
  for (const auto& s : stage.sticks) {
    box.add(s.a);
    box.add(s.b);
  }
  return box;
}

void cut(Stage& stage, const Look& look) {
  if (!look.cutaway) return;
  const geo::Box3 box = frame_of(stage);
  const Vec3 n = look.cutaway->normal.normalized();
  stage.cutaway = Plane{box.center() + look.cutaway->offset * 0.5 * box.diagonal() * n, n};
  // Nodes and edges on the removed side are removed too.
  const auto gone = [&](const Vec3& p) { return (p - stage.cutaway->point).dot(n) > 0; };
  std::erase_if(stage.spheres, [&](const Sphere& s) { return gone(s.center); });
  std::erase_if(stage.sticks, [&](const Stick& s) { return gone(s.a) || gone(s.b); });
}

}  // namespace

Coloring coloring_of(const std::string& name) {
  if (name == "piece") return Coloring::piece;
  if (name == "plain") return Coloring::plain;
  return name == "patch" ? Coloring::patch : Coloring::model;
}

Color parse_color(const std::string& text) {
  unsigned value = 0;
  char rest = 0;
  if (text.size() != 7 || text[0] != '#' || std::sscanf(text.c_str() + 1, "%6x%c", &value, &rest) != 1)
    throw geo::InputError("'" + text + "' is not a colour: write #rrggbb");
  const auto linear = [](unsigned byte) { return float(std::pow(byte / 255.0, 2.2)); };
  return {linear(value >> 16), linear(value >> 8 & 255), linear(value & 255)};
}

Color viridis(double t) {
  constexpr Color stops[] = {{0.058f, 0.0004f, 0.088f},
                             {0.043f, 0.084f, 0.258f},
                             {0.014f, 0.281f, 0.271f},
                             {0.105f, 0.584f, 0.122f},
                             {0.984f, 0.799f, 0.019f}};
  const double s = std::clamp(t, 0.0, 1.0) * 4;
  const int i = std::min(3, static_cast<int>(s));
  Color c{};
  for (int k = 0; k < 3; ++k) c[k] = float(stops[i][k] + (s - i) * (stops[i + 1][k] - stops[i][k]));
  return c;
}

Stage stage_of(const Subject& subject, const Look& look) {
  Stage stage;
  const geo::TriangleMesh& surface = subject.surface;
  stage.surface = surface;
  stage.wire = look.wire;
  stage.section = look.section;
  stage.surface_opacity = look.opacity;
  stage.sheets_opaque = look.sheets && surface.patch.size() == surface.triangles.size() && look.opacity < 1;
  if (look.coloring == Coloring::model) stage.paint = paint_of(surface);
  const bool sheets = look.coloring == Coloring::model || look.coloring == Coloring::patch;
  const PieceMap pieces = pieces_of(surface);
  const Vec3 middle = geo::bounding_box(surface).center();
  const auto shift = [&](std::uint32_t piece) -> Vec3 { return look.explode * (pieces.center[piece] - middle); };
  for (std::size_t v = 0; v < surface.vertices.size(); ++v) stage.surface.vertices[v] += shift(pieces.of_row[v]);
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const int patch = surface.patch.empty() ? 0 : surface.patch[t];
    Color color = look.skin;
    if (look.coloring == Coloring::piece) color = piece_color(pieces.of_row[surface.triangles[t][0]]);
    if (sheets && patch != 0) color = patch > 0 ? sheet_plus : sheet_minus;
    stage.triangle_colors.push_back(color);
    if (sheets && patch != 0) color = patch > 0 ? sheet_minus : sheet_plus;
    stage.back_colors.push_back(color);
  }
  std::vector<Vec3> position = subject.nodes.position;
  if (subject.body && look.explode > 0) {
    const auto piece = pieces_of_nodes(subject, pieces);
    for (std::size_t i = 0; i < position.size(); ++i) position[i] += shift(piece[i]);
  }
  add_nodes(stage, subject, position, look);
  add_trees(stage, subject, position, look);
  if (look.seams) add_seams(stage);
  add_obstacles(stage, subject.obstacles);
  add_fronts(stage, subject.fronts, look);
  cut(stage, look);
  return stage;
}

geo::Box3 box_of(const Stage& stage) {
  geo::Box3 box = box_without_obstacles(stage);
  box.add(geo::bounding_box(stage.surface));
  return box;
}

void add_outermost(const Stage& stage, const geo::Box3& frame, std::vector<Vec3>& points) {
  constexpr int directions = 256;  // evenly over the sphere, on a spiral
  std::vector<Vec3> all = points;
  const auto beyond = [&](const Vec3& p) {
    return stage.cutaway ? (p - stage.cutaway->point).dot(stage.cutaway->normal) : -1.0;
  };
  std::vector<char> taken(stage.surface.vertices.size(), 0);
  for (const auto& triangle : stage.surface.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 &p = stage.surface.vertices[triangle[k]], &next = stage.surface.vertices[triangle[(k + 1) % 3]];
      const double here = beyond(p), there = beyond(next);
      if (here <= 0 && !std::exchange(taken[triangle[k]], 1)) all.push_back(p);
      if ((here < 0 && there > 0) || (here > 0 && there < 0)) all.push_back(p + here / (here - there) * (next - p));
    }
  const auto within = [&](const Vec3& p) -> Vec3 { return p.cwiseMax(frame.lo).cwiseMin(frame.hi); };
  for (Vec3& p : all) p = within(p);
  points.assign(directions, Vec3::Zero());
  geo::parallel_for(directions, 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const double height = 1 - (2 * double(k) + 1) / directions, across = std::sqrt(1 - height * height),
                   turn = double(k) * std::numbers::pi * (3 - std::sqrt(5.0));
      const Vec3 way(across * std::cos(turn), across * std::sin(turn), height);
      double farthest = -std::numeric_limits<double>::infinity();
      const auto take = [&](const Vec3& p) {
        if (const double far = way.dot(p); far > farthest) {
          farthest = far;
          points[k] = p;
        }
      };
      for (const Vec3& p : all) take(p);
      for (const auto& s : stage.spheres) take(within(s.center + s.radius * way));
      for (const auto& s : stage.sticks) {
        take(within(s.a + s.radius * way));
        take(within(s.b + s.radius * way));
      }
    }
  });
}

geo::Box3 frame_of(const Stage& stage) {
  const geo::Box3 bodies = box_without_obstacles(stage), near = bodies.grown(0.25 * bodies.diagonal());
  geo::Box3 box = bodies;
  for (std::size_t t = stage.surface.triangles.size() - stage.obstacles; t < stage.surface.triangles.size(); ++t)
    for (const auto v : stage.surface.triangles[t])
      if (const Vec3& p = stage.surface.vertices[v]; near.meets({p, p})) box.add(p);
  return box;
}

}  // namespace view
