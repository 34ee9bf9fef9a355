// Per pair of near triangles a direction separates them best (separating axis). The vertices that
// lie foremost along it move back by half of what the gap lacks.
#include "simulation/touching_bodies.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "geometry/aabb_tree.h"
#include "geometry/bvh.h"
#include "geometry/distance.h"
#include "geometry/predicates.h"
#include "kerf/check.h"
#include "kerf/error.h"
#include "kerf/nodes.h"

namespace geo {
namespace {

using Corners = std::array<Vec3, 3>;

// All bodies in one mesh, and where each begins.
struct Assembly {
  const Scene& scene;
  TriangleMesh& all;
  std::vector<std::uint32_t> body_of;  // per triangle
  std::vector<Vec3> before;            // vertices as placed
  double gap;                          // to be left between bodies, m

  Corners corners(std::uint32_t t) const {
    const auto& [a, b, c] = all.triangles[t];
    return {all.vertices[a], all.vertices[b], all.vertices[c]};
  }
};

std::string name_of(const Scene& scene, std::uint32_t body) {
  const SceneBody& b = scene.bodies[body];
  const std::string name = b.name.empty() ? "body " + std::to_string(body + 1) : b.name;
  const std::string file = std::filesystem::path(b.mesh).filename().string();
  return name + (file.empty() ? std::string() : " (" + file + ")");
}

std::string in_words(double length) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2g", length);
  return text;
}

double mean_edge(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& [a, b, c] : corners_of(mesh)) sum += (b - a).norm() + (c - b).norm() + (a - c).norm();
  return sum / (3 * static_cast<double>(std::max<std::size_t>(mesh.triangles.size(), 1)));
}

bool meet(const Corners& s, const Corners& t) {
  const Vec3 p[3] = {s[0], s[1], s[2]}, q[3] = {t[0], t[1], t[2]};
  return triangles_meet(p, q);
}

// The distance of two triangles that do not meet.
double distance(const Corners& s, const Corners& t) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 3; ++i) {
    least = std::min(least, (closest_point_on_triangle(s[i], t[0], t[1], t[2]) - s[i]).norm());
    least = std::min(least, (closest_point_on_triangle(t[i], s[0], s[1], s[2]) - t[i]).norm());
    for (std::size_t j = 0; j < 3; ++j)
      least = std::min(least, distance_between_segments(s[i], s[(i + 1) % 3], t[j], t[(j + 1) % 3]));
  }
  return least;
}

// Pairs of triangles of different bodies that meet or are nearer than half the gap.
AabbTree::Pairs near_pairs(const Assembly& assembly) {
  std::vector<Box3> boxes;
  const Vec3 margin = Vec3::Constant(assembly.gap / 4);
  for (std::uint32_t t = 0; t < assembly.all.triangles.size(); ++t) {
    const Corners c = assembly.corners(t);
    Box3 box = box_of(c[0], c[1], c[2]);
    box.lo -= margin;
    box.hi += margin;
    boxes.push_back(box);
  }
  auto pairs = AabbTree(std::move(boxes)).pairs(nullptr, [&](AabbTree::Pairs& some) {
    std::erase_if(some, [&](const auto& pair) {
      if (assembly.body_of[pair.first] == assembly.body_of[pair.second]) return true;
      const Corners s = assembly.corners(pair.first), t = assembly.corners(pair.second);
      return !meet(s, t) && distance(s, t) >= assembly.gap / 2;
    });
  });
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

struct Axis {
  Vec3 direction = Vec3::Zero();  // unit, from the first triangle to the second
  double separation = -std::numeric_limits<double>::infinity();
};

// The direction that separates two triangles best. A direction is allowed where both triangles
// retreat into their own bodies along it. Normals come first among equals: they keep faces flat.
Axis best_axis(const Corners& s, const Corners& t, double tolerance) {
  const Vec3 normal_s = face_normal(s[0], s[1], s[2]), normal_t = face_normal(t[0], t[1], t[2]);
  Axis best;
  const auto consider = [&](const Vec3& candidate) {
    const double length = candidate.norm();
    constexpr double parallel = 1e-9;  // of unit vectors: below it a cross product has no direction
    if (length < parallel) return;
    for (const Vec3& m : {Vec3(candidate / length), Vec3(-candidate / length)}) {
      if (m.dot(normal_s) < -parallel || m.dot(normal_t) > parallel) continue;
      const double ahead = std::max({m.dot(s[0]), m.dot(s[1]), m.dot(s[2])}),
                   behind = std::min({m.dot(t[0]), m.dot(t[1]), m.dot(t[2])});
      if (behind - ahead > best.separation + tolerance) best = {m, behind - ahead};
    }
  };
  consider(normal_s);
  consider(normal_t);
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 edge = (s[(i + 1) % 3] - s[i]).normalized();
    for (std::size_t j = 0; j < 3; ++j) consider(edge.cross((t[(j + 1) % 3] - t[j]).normalized()));
  }
  for (std::size_t i = 0; i < 3; ++i) {
    consider((s[(i + 1) % 3] - s[i]).normalized().cross(normal_s));
    consider((t[(i + 1) % 3] - t[i]).normalized().cross(normal_t));
  }
  return best;
}

// A vertex is to move by at least `amount` along `direction`.
struct Constraint {
  Vec3 direction;
  double amount;
};
using Constraints = std::map<std::uint32_t, std::vector<Constraint>>;

// The shortest known offset that fulfils all constraints: projections onto one half space after the
// other (Agmon 1954).
Vec3 offset_for(const std::vector<Constraint>& constraints) {
  Vec3 offset = Vec3::Zero();
  constexpr int rounds = 64;  // a bound of the effort: the exact test finds what still lacks
  for (int round = 0; round < rounds; ++round)
    for (const Constraint& w : constraints)
      if (const double lacking = w.amount - offset.dot(w.direction); lacking > 0) offset += lacking * w.direction;
  return offset;
}

// Adds a constraint, unless the vertex has one of the same direction and at least that amount.
void add_constraint(std::vector<Constraint>& constraints, const Constraint& constraint) {
  constexpr double same = 1 - 1e-12;  // cosine of a millionth: offsets differ by a millionth of the gap
  for (Constraint& w : constraints)
    if (w.direction.dot(constraint.direction) > same) {
      w.amount = std::max(w.amount, constraint.amount);
      return;
    }
  constraints.push_back(constraint);
}

void collect_constraints(const Assembly& assembly, const AabbTree::Pairs& pairs, Constraints& constraints) {
  const double gap = assembly.gap;
  for (const auto& [first, second] : pairs) {
    const Corners s = assembly.corners(first), t = assembly.corners(second);
    const Axis axis = best_axis(s, t, 1e-3 * gap);
    // Deeper than the gap, bodies overlap by more than rounding.
    if (axis.separation < -gap || axis.separation >= gap) continue;
    const Vec3& m = axis.direction;
    const double amount = (gap - axis.separation) / 2;
    const double ahead = std::max({m.dot(s[0]), m.dot(s[1]), m.dot(s[2])}),
                 behind = std::min({m.dot(t[0]), m.dot(t[1]), m.dot(t[2])});
    const auto constrain = [&](std::uint32_t v, const Vec3& direction) {
      const double moved = direction.dot(assembly.all.vertices[v] - assembly.before[v]);
      add_constraint(constraints[v], {direction, moved + amount});
    };
    for (std::size_t k = 0; k < 3; ++k) {
      if (m.dot(s[k]) > ahead - gap) constrain(assembly.all.triangles[first][k], -m);
      if (m.dot(t[k]) < behind + gap) constrain(assembly.all.triangles[second][k], m);
    }
  }
}

// Points of a body at which the depth of an overlap is measured: nodes inside, and points on
// triangles and edges.
std::vector<Vec3> probes_of(const TriangleMesh& body, const TriangleBvh& other) {
  SampleOptions options;
  options.count = 500;
  std::vector<Vec3> points = sample_nodes(body, options).position;
  for (const auto& [a, b, c] : corners_of(body)) {
    points.push_back((a + b + c) / 3);
    for (const auto& [p, q] : {std::pair{a, b}, std::pair{b, c}, std::pair{c, a}}) {
      constexpr int parts = 8;  // of an edge
      for (int i = 0; i < parts; ++i) points.push_back(p + double(i) / parts * (q - p));
    }
  }
  std::erase_if(points, [&](const Vec3& p) { return !other.inside(p); });
  return points;
}

// How far two bodies would have to move to be apart, at least: the largest sum of both distances to
// the surfaces, over points that are in both.
double depth_of(const TriangleMesh& a, const TriangleMesh& b) {
  const TriangleBvh tree_a(corners_of(a)), tree_b(corners_of(b));
  double depth = 0;
  const auto measure = [&](const std::vector<Vec3>& points) {
    for (const Vec3& p : points) depth = std::max(depth, tree_a.closest(p).distance + tree_b.closest(p).distance);
  };
  measure(probes_of(a, tree_b));
  measure(probes_of(b, tree_a));
  return depth;
}

[[noreturn]] void refuse_overlap(const Assembly& assembly, const std::vector<TriangleMesh>& bodies, std::uint32_t a,
                                 std::uint32_t b) {
  if (a > b) std::swap(a, b);
  const std::string names = name_of(assembly.scene, a) + " and " + name_of(assembly.scene, b);
  if (const double depth = depth_of(bodies[a], bodies[b]); depth > assembly.gap)
    throw InputError(names + " overlap, about " + in_words(depth) +
                     " deep; move one of them out of the other until they touch at most");
  throw InputError(names + " touch and cannot be moved apart where they do; leave a gap of " + in_words(assembly.gap) +
                   " between them");
}

// A body in the material of another one crosses nothing.
void refuse_inner_bodies(const Assembly& assembly, const std::vector<TriangleMesh>& bodies) {
  const auto shells = find_shells(assembly.all);
  for (const Shell& shell : shells)
    if (!shell.well_oriented() && shell.parent != ~0u)
      refuse_overlap(assembly, bodies, assembly.body_of[shell.first_triangle],
                     assembly.body_of[shells[shell.parent].first_triangle]);
}

bool crosses_nothing(const TriangleMesh& mesh) {
  const SurfaceReport report = check_surface(mesh, SelfIntersections::find);
  return report.self_intersections == std::size_t(0) && report.degenerate_faces == 0;
}

// The bodies of the first pair of triangles that cross; triangles of one body cross after an unfit
// motion.
std::pair<std::uint32_t, std::uint32_t> first_bodies(const Assembly& assembly, const AabbTree::Pairs& pairs) {
  return {assembly.body_of[pairs[0].first], assembly.body_of[pairs[0].second]};
}

}  // namespace

void part_touching_bodies(const Scene& scene, PlacedModels& models) {
  Assembly assembly{.scene = scene,
                    .all = models.all,
                    .body_of = {},
                    .before = models.all.vertices,
                    .gap = ContactOptions{}.gap * mean_edge(models.all)};
  for (std::uint32_t b = 0; b < models.bodies.size(); ++b)
    assembly.body_of.resize(assembly.body_of.size() + models.bodies[b].triangles.size(), b);
  const AabbTree::Pairs touching = near_pairs(assembly);
  Constraints constraints;
  AabbTree::Pairs pairs = touching;
  constexpr int rounds = 8;  // a motion may bring a vertex near to a third body; each round sees more of them
  for (int round = 0; round < rounds && !pairs.empty(); ++round) {
    collect_constraints(assembly, pairs, constraints);
    for (const auto& [v, list] : constraints) models.all.vertices[v] = assembly.before[v] + offset_for(list);
    pairs = near_pairs(assembly);
  }
  if (!pairs.empty() || (!touching.empty() && !crosses_nothing(models.all))) {
    models.all.vertices = assembly.before;
    const auto [a, b] = first_bodies(assembly, pairs.empty() ? touching : pairs);
    refuse_overlap(assembly, models.bodies, a, b);
  }
  refuse_inner_bodies(assembly, models.bodies);
  if (touching.empty()) return;
  std::size_t first = 0;
  for (TriangleMesh& body : models.bodies) {
    std::copy_n(models.all.vertices.begin() + static_cast<std::ptrdiff_t>(first), body.vertices.size(),
                body.vertices.begin());
    first += body.vertices.size();
  }
  for (const auto& [s, t] : touching) {
    const auto [a, b] = std::minmax(assembly.body_of[s], assembly.body_of[t]);
    models.touching.push_back({a, b});
  }
  std::sort(models.touching.begin(), models.touching.end());
  models.touching.erase(std::unique(models.touching.begin(), models.touching.end()), models.touching.end());
  models.gap = assembly.gap;
}

std::string touching_note(const Scene& scene, const PlacedModels& models) {
  if (models.touching.empty()) return {};
  constexpr std::size_t shown = 3;  // so that the note remains one line
  std::string text;
  for (std::size_t i = 0; i < std::min(shown, models.touching.size()); ++i)
    text += (i > 0 ? ", " : "") + name_of(scene, models.touching[i].first) + " and " +
            name_of(scene, models.touching[i].second);
  if (models.touching.size() > shown) text += ", and " + std::to_string(models.touching.size() - shown) + " more pairs";
  return text + " touch: where they do, their surfaces were moved apart by " + in_words(models.gap);
}

}  // namespace geo
