// Each point tries the support factors in turn until it sees enough nodes, with a well-conditioned
// moment matrix and no steep shape function. Exact segment–triangle tests decide which nodes it
// sees; after a cut, only where a changed face touches the line of sight, or the node has changed.
//
// Each piece of material is one component of the visibility graph. So the first node that a point
// sees names the component of all others.
#include "mechanics/discretisation/point_supports.h"

#include <algorithm>
#include <optional>

#include "body/incremental_cache.h"
#include "geometry/predicates.h"
#include "kerf/parallel.h"

namespace geo {
namespace {

constexpr std::size_t least_nodes = 4;   // that determine a linear field
constexpr std::size_t enough_nodes = 8;  // a point with fewer nodes widens its support
constexpr double ill_conditioned = 500;  // and so does one with a larger condition number; larger: fewer are widened.
                                         // A point where none is wide enough carries no strain
// So does a point from which a face hides nodes, if a shape gradient is steeper than this, in units
// of 1 / support radius (docs/decisions/061).
constexpr double steepest_shape = 4;
constexpr std::size_t least_tasks = 4, max_tasks = 32;  // of a batch; affects speed alone
// A path to a node that is shorter than its support S admits stays within ½ √(L² − s²) of the box
// of point and node, with s their distance and L = (S / s)^¼ s. That is at most 0.1624 S, where s =
// 9/16 S. The rest covers the distance of a path from its front edge.
constexpr double bent_width = 0.17;

bool is_on_face(const Complex& surface, const Vec3& p) {
  std::vector<FaceId> near;
  surface.faces_near({p, p}, near);
  return std::any_of(near.begin(), near.end(), [&](FaceId f) {
    const auto [a, b, c] = surface.corners(f);
    return segment_meets_triangle(p, p, a, b, c);
  });
}

// The component of each node, and the number of nodes in each component.
class NodeComponents {
 public:
  explicit NodeComponents(std::span<const std::uint32_t> of_node) : of_node_(of_node) {
    for (const auto c : of_node) {
      if (c >= size_.size()) size_.resize(c + 1, 0);
      ++size_[c];
    }
  }
  // The component of the first node that is not hidden; none where all are, or where components are
  // unknown.
  std::optional<std::uint32_t> seen(std::span<const std::uint32_t> nodes, std::span<const std::uint8_t> hidden) const {
    if (of_node_.empty()) return {};
    const auto first = std::find(hidden.begin(), hidden.end(), 0);
    if (first == hidden.end()) return {};
    return of_node_[nodes[static_cast<std::size_t>(first - hidden.begin())]];
  }
  std::size_t size(std::uint32_t component) const { return size_[component]; }
  bool holds(std::uint32_t component, std::uint32_t node) const { return of_node_[node] == component; }

 private:
  std::span<const std::uint32_t> of_node_;
  std::vector<std::uint32_t> size_;
};

// Supports of nodes, coordinate by coordinate: loops over them load no more than they need.
class Balls {
 public:
  Balls(const Body& body, std::span<const std::uint32_t> nodes, double factor) : squared_radius_(nodes.size()) {
    constexpr double margin = 1 + 1e-12;  // far beyond rounding
    for (auto& of_axis : center_) of_axis.resize(nodes.size());
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      const Vec3& x = body.nodes.position[nodes[k]];
      const double r = factor * body.nodes.radius[nodes[k]];
      for (std::size_t axis = 0; axis < 3; ++axis) center_[axis][k] = x[static_cast<Eigen::Index>(axis)];
      squared_radius_[k] = margin * r * r;
    }
  }
  // Sets `holds` to 1 where a ball holds x, and may do so where x is on its surface but for
  // rounding.
  void hold(const Vec3& x, std::vector<std::uint8_t>& holds) const {
    const double* const u = center_[0].data();
    const double* const v = center_[1].data();
    const double* const w = center_[2].data();
    for (std::size_t k = 0; k < holds.size(); ++k) {
      const double a = u[k] - x[0], b = v[k] - x[1], c = w[k] - x[2];
      holds[k] = a * a + b * b + c * c < squared_radius_[k];
    }
  }

 private:
  std::array<std::vector<double>, 3> center_;
  std::vector<double> squared_radius_;
};

// Tasks of neighbouring points, with the nodes that may support each, and fronts that they share.
struct Batch {
  std::span<const SupportTask> tasks;
  std::vector<std::size_t> first;                   // per task and one more, into `nodes`
  std::vector<std::uint32_t> nodes;                 // that may support each task, ascending
  std::vector<std::vector<std::uint32_t>> changed;  // per task: faces that lines of sight may touch
  std::vector<FrontEdge> fronts;
  Box3 influence;                      // holds all lines of sight to be tested, bent ones included
  std::vector<SupportTask> deficient;  // points that see too few nodes at the largest factor tried

  // `factor`: the largest.
  void find_nodes(const Body& body, double factor, double largest_radius, const VisibilityChanges* changes) {
    const auto& position = body.nodes.position;
    const auto& radius = body.nodes.radius;
    Box3 box;
    for (const SupportTask& task : tasks) box.add(task.point->position);
    double largest = 0;
    first.assign(1, 0);
    const auto all = supporting_nodes(body, box, factor, largest_radius);
    const Balls supports(body, all, factor);
    std::vector<std::uint8_t> holds(all.size());
    for (const SupportTask& task : tasks) {
      const Vec3& x = task.point->position;
      influence.add(x);
      changed.push_back(changed_near(task, changes));
      const bool recalls = sees_as_before(task, factor, changes, changed.back());
      supports.hold(x, holds);
      for (std::size_t k = 0; k < all.size(); ++k)
        if (const auto j = all[k]; holds[k]) {
          nodes.push_back(j);
          if (!recalls || changes->has_changed(j)) {
            influence.add(position[j]);
            largest = std::max(largest, radius[j]);
          }
        }
      first.push_back(nodes.size());
    }
    influence = influence.grown(bent_width * factor * largest);
  }

  void compute(const Body& body, std::span<const double> factors, const Occluders& occluders,
               const VisibilityChanges* changes, const NodeComponents& components) {
    for (const FrontEdge& e : occluders.fronts)
      if (const Vec3 middle = 0.5 * (e.a + e.b); influence.grown((e.b - e.a).norm()).meets({middle, middle}))
        fronts.push_back(e);
    Scratch scratch;
    for (std::size_t t = 0; t < tasks.size(); ++t) {
      const SupportTask& task = tasks[t];
      const auto candidates = std::span(nodes).subspan(first[t], first[t + 1] - first[t]);
      bool enough = false, few = false;
      for (std::size_t k = 0; k < factors.size() && !enough; ++k) {
        // With too few nodes in the component no factor is enough: the last one decides.
        if (few) k = factors.size() - 1;
        enough = compute({.body = body,
                          .task = task,
                          .factor = factors[k],
                          .faces = occluders.faces,
                          .changes = changes,
                          .components = components,
                          .changed = changed[t]},
                         candidates, fronts, scratch);
        few = scratch.component && components.size(*scratch.component) < enough_nodes;
      }
      if (!enough) deficient.push_back(task);
    }
  }

 private:
  // Knowledge of paths to a node round a front. `lost`: there was none, and there is none unless a
  // face has changed near it. `none`: there is none, or none that matters.
  enum class Path : std::uint8_t { unknown, lost, none };
  struct Scratch {
    std::vector<std::uint32_t> nodes;
    std::vector<Vec3> positions;
    std::vector<std::uint8_t> hidden;
    std::vector<SupportNode> seen;
    std::vector<std::uint8_t> is_known, touched;
    std::vector<Path> path;  // of hidden nodes
    std::vector<std::uint32_t> unknown;
    std::vector<Vec3> ends;
    std::optional<std::uint32_t> component;  // of the nodes that the point sees straight ahead, if any
  };
  // A point at one factor of the support radii.
  struct Trial {
    const Body& body;
    const SupportTask& task;
    double factor;
    const OccludingFaces& faces;
    const VisibilityChanges* changes;
    const NodeComponents& components;
    std::span<const std::uint32_t> changed;  // faces that lines of sight of the point may touch
  };

  // Whether what the point saw before is known, and may be true still.
  static bool is_recalled(const SupportTask& task, const VisibilityChanges* changes) {
    if (!changes || !task.before) return false;
    const auto seen = task.before->entry_begin[task.point_before + 1] - task.before->entry_begin[task.point_before];
    // With fewer nodes, paths round fronts were not tried.
    return seen >= least_nodes && task.before->points[task.point_before].position == task.point->position;
  }

  // The changed faces that lines of sight of the point may touch.
  static std::vector<std::uint32_t> changed_near(const SupportTask& task, const VisibilityChanges* changes) {
    std::vector<std::uint32_t> near;
    if (!is_recalled(task, changes)) return near;
    const MaterialPoint& before = task.before->points[task.point_before];
    changes->faces_near({before.position, before.position}, before.influence_radius, near);
    return near;
  }

  // Whether the point sees all nodes within `factor` times their supports that have not changed: it
  // saw them before, and no changed face is near. `changed`: those faces.
  static bool sees_as_before(const SupportTask& task, double factor, const VisibilityChanges* changes,
                             std::span<const std::uint32_t> changed) {
    if (!is_recalled(task, changes) || !changed.empty()) return false;
    const MaterialPoint& before = task.before->points[task.point_before];
    return !before.occluded && factor <= support_factors[before.widenings];
  }

  // Marks the nodes that the point saw or did not see before, in `hidden` as it was then. A node
  // within the same support had no path round a front where it was not seen.
  static void recall(const Trial& trial, Scratch& scratch) {
    const auto& [body, task, factor, faces, changes, components, changed] = trial;
    const PointBlock& block = *task.before;
    const MaterialPoint& before = block.points[task.point_before];
    auto entry = block.entry_begin[task.point_before];
    const auto end = block.entry_begin[task.point_before + 1];
    for (std::size_t q = 0; q < scratch.nodes.size(); ++q) {
      const auto j = scratch.nodes[q];
      while (entry < end && block.nodes[block.entry_node[entry]] < j) ++entry;
      const bool was_seen = entry < end && block.nodes[block.entry_node[entry]] == j;
      const double support = support_factors[before.widenings] * body.nodes.radius[j];
      scratch.is_known[q] =
          !changes->has_changed(j) && (was_seen || (scratch.positions[q] - before.position).norm() < support);
      scratch.hidden[q] = !was_seen || block.entry_bent[entry];
      if (scratch.is_known[q] && !was_seen && factor == support_factors[before.widenings]) scratch.path[q] = Path::lost;
    }
  }

  // Sets `hidden`, `path` and `component`.
  static void find_hidden(const Trial& trial, Scratch& scratch) {
    find_hidden_straight(trial, scratch);
    scratch.component = trial.components.seen(scratch.nodes, scratch.hidden);
    if (scratch.component) {
      const bool singular = trial.components.size(*scratch.component) < least_nodes;
      for (std::size_t q = 0; q < scratch.nodes.size(); ++q)
        if (singular || !trial.components.holds(*scratch.component, scratch.nodes[q])) scratch.path[q] = Path::none;
    }
    forget_paths(trial, scratch);
  }

  // Sets `hidden` for each node.
  static void find_hidden_straight(const Trial& trial, Scratch& scratch) {
    const auto& [body, task, factor, faces, changes, components, changed] = trial;
    const Vec3& x = task.point->position;
    const std::size_t n = scratch.nodes.size();
    scratch.hidden.assign(n, 0);
    scratch.path.assign(n, Path::unknown);
    if (faces.empty()) return;
    if (!is_recalled(task, changes)) return faces.blocks(x, scratch.positions, scratch.hidden.data());
    scratch.is_known.assign(n, 0);
    scratch.touched.assign(n, 0);
    scratch.unknown.clear();
    scratch.ends.clear();
    recall(trial, scratch);
    if (!changed.empty()) changes->faces().blocks(x, scratch.positions, scratch.touched.data());
    for (std::uint32_t q = 0; q < n; ++q)
      if (!scratch.is_known[q] || scratch.touched[q]) {
        scratch.unknown.push_back(q);
        scratch.ends.push_back(scratch.positions[q]);
      }
    scratch.touched.assign(scratch.ends.size(), 0);
    faces.blocks(x, scratch.ends, scratch.touched.data());
    for (std::size_t k = 0; k < scratch.unknown.size(); ++k) scratch.hidden[scratch.unknown[k]] = scratch.touched[k];
  }

  // Keeps `lost` only where no changed face may touch a path, and so no new front either.
  static void forget_paths(const Trial& trial, Scratch& scratch) {
    const auto& [body, task, factor, faces, changes, components, changed] = trial;
    if (std::find(scratch.path.begin(), scratch.path.end(), Path::lost) == scratch.path.end()) return;
    const VisibilityChanges::NearFaces near = changes->seen_from(task.point->position, changed);
    for (std::size_t q = 0; q < scratch.nodes.size(); ++q)
      if (scratch.hidden[q] && scratch.path[q] == Path::lost &&
          near.meet_bent_paths(scratch.positions[q], factor * body.nodes.radius[scratch.nodes[q]]))
        scratch.path[q] = Path::unknown;
  }

  static double largest_support(const Trial& trial, const Scratch& scratch) {
    double largest = 0;
    for (const auto j : scratch.nodes) largest = std::max(largest, trial.body.nodes.radius[j]);
    return trial.factor * largest;
  }

  static bool is_steep(const ShapeGradients& shape, std::span<const SupportNode> nodes) {
    for (std::size_t j = 0; j < nodes.size(); ++j)
      if (shape.gradient[j].norm() * nodes[j].support > steepest_shape) return true;
    return false;
  }

  // True if the point sees enough nodes, and its shape functions are usable. `candidates`: the
  // nodes that support it at the largest factor.
  static bool compute(const Trial& trial, std::span<const std::uint32_t> candidates, std::span<const FrontEdge> fronts,
                      Scratch& scratch) {
    const auto& [body, task, factor, faces, changes, components, changed] = trial;
    MaterialPoint& point = *task.point;
    ShapeGradients& shape = *task.shape;
    const Vec3& x = point.position;
    scratch.nodes.clear();
    scratch.positions.clear();
    scratch.seen.clear();
    shape.nodes.clear();
    shape.bent.clear();
    for (const auto j : candidates)
      if (const Vec3& y = body.nodes.position[j]; (y - x).norm() < factor * body.nodes.radius[j]) {
        scratch.nodes.push_back(j);
        scratch.positions.push_back(y);
      }
    find_hidden(trial, scratch);
    point.widenings = static_cast<std::uint8_t>(std::find(support_factors.begin(), support_factors.end(), factor) -
                                                support_factors.begin());
    point.occluded = std::find(scratch.hidden.begin(), scratch.hidden.end(), 1) != scratch.hidden.end();
    const std::vector<NearFront> near =
        point.occluded ? fronts_near(x, largest_support(trial, scratch), fronts) : std::vector<NearFront>();
    for (std::size_t q = 0; q < scratch.nodes.size(); ++q) {
      const Vec3& y = scratch.positions[q];
      const double support = factor * body.nodes.radius[scratch.nodes[q]], straight = (y - x).norm();
      // A path to the node that is shorter than its support stays within half of the sum of both
      // lengths.
      point.influence_radius =
          std::max(point.influence_radius, scratch.hidden[q] ? 0.5 * (straight + support) : straight);
      if (scratch.hidden[q] && scratch.path[q] != Path::unknown) continue;
      const auto node =
          scratch.hidden[q] ? diffracted_support(x, y, support, near, faces) : direct_support(x, y, support);
      if (!node) continue;
      shape.nodes.push_back(scratch.nodes[q]);
      shape.bent.push_back(scratch.hidden[q]);
      scratch.seen.push_back(*node);
    }
    const double condition =
        shape_gradients(x, scratch.seen, shape.gradient, task.with_values ? &shape.value : nullptr, ill_conditioned);
    point.quality = condition <= ill_conditioned ? MomentQuality::good : MomentQuality::singular;
    const bool enough = shape.nodes.size() >= enough_nodes && point.quality == MomentQuality::good &&
                        !(point.occluded && is_steep(shape, scratch.seen));
    // Its nodes are kept, without gradients: what it has seen need not be looked for again.
    if (point.quality == MomentQuality::singular) shape.gradient.assign(shape.nodes.size(), Vec3::Zero());
    return enough;
  }
};

// Consecutive tasks whose points are closer than `distance` to the first one's.
std::vector<Batch> batches_of(std::span<const SupportTask> tasks, double distance) {
  constexpr std::size_t shares = 16;  // so that few tasks keep several threads busy, too
  const std::size_t tasks_per_batch = std::clamp(tasks.size() / shares, least_tasks, max_tasks);
  std::vector<Batch> batches;
  for (std::size_t begin = 0, end; begin < tasks.size(); begin = end) {
    const Vec3& first = tasks[begin].point->position;
    for (end = begin + 1; end < std::min(begin + tasks_per_batch, tasks.size()) &&
                          (tasks[end].point->position - first).norm() < distance;)
      ++end;
    batches.emplace_back().tasks = tasks.subspan(begin, end - begin);
  }
  return batches;
}

}  // namespace

VisibilityChanges::VisibilityChanges(std::span<const std::array<Vec3, 3>> faces, std::span<const std::uint32_t> nodes,
                                     std::size_t node_count)
    : faces_(faces), node_(node_count, 0) {
  for (const auto i : nodes) node_[i] = 1;
  for (const auto& face : faces) {
    boxes_.push_back(box_of(face[0], face[1], face[2]));
    balls_.push_back(bounding_ball(face));
  }
}

void VisibilityChanges::faces_near(const Box3& points, double radius, std::vector<std::uint32_t>& faces) const {
  faces_.near(points.grown(radius * (1 + 2 * bend_margin)), faces);
}

std::vector<std::uint32_t> VisibilityChanges::faces_near(const Vec3& x, double radius,
                                                         std::span<const std::uint32_t> faces) const {
  const Box3 influence = Box3{x, x}.grown(radius * (1 + 2 * bend_margin));
  std::vector<std::uint32_t> near;
  for (const auto f : faces)
    if (boxes_[f].meets(influence)) near.push_back(f);
  return near;
}

VisibilityChanges::NearFaces VisibilityChanges::seen_from(const Vec3& x, std::span<const std::uint32_t> faces) const {
  NearFaces near;
  near.x = x;
  for (const auto f : faces) {
    const auto& [middle, radius] = balls_[f];
    near.faces.push_back(
        {.middle = middle, .twice_radius = 2 * radius, .distance = (middle - x).norm(), .corners = &faces_.corners(f)});
  }
  return near;
}

// All such paths fill an ellipsoid, which is nowhere farther than `width` from the segment to the
// node. A face is outside of it if its ball is. So is one with all corners beyond a plane at this
// distance, normal to the shortest way from the segment to the face's middle.
bool VisibilityChanges::NearFaces::meet_bent_paths(const Vec3& node, double support) const {
  const Vec3 along = node - x;
  const double straight = along.norm(), longest = longest_path(straight, support) + 2 * bend_margin * support,
               width = 0.5 * std::sqrt((longest - straight) * (longest + straight));
  return std::any_of(faces.begin(), faces.end(), [&](const Face& face) {
    const double rest = longest + face.twice_radius - face.distance;
    if (!(rest > 0 && (face.middle - node).squaredNorm() < rest * rest)) return false;
    const double at = std::clamp((face.middle - x).dot(along) / (straight * straight), 0.0, 1.0);
    const Vec3 foot = x + at * along, normal = face.middle - foot;
    const double beyond = width * normal.norm();
    return std::any_of(face.corners->begin(), face.corners->end(),
                       [&](const Vec3& c) { return !(normal.dot(c - foot) > beyond); });
  });
}

Vec3 moved_off_faces(const Body& body, const Vec3& p) {
  if (!is_on_face(body.surface, p)) return p;
  const auto near = body.cache->grid.nearest(body.nodes.position, p, 1, ~0u, [](auto) { return true; })[0];
  const Vec3 to_node = body.nodes.position[near] - p;
  if (!(to_node.norm() < support_factors.back() * body.nodes.radius[near])) return p;
  for (double step = 1e-3; step < 0.5; step *= 4)
    if (const Vec3 moved = p + step * to_node; !is_on_face(body.surface, moved)) return moved;
  return p;
}

std::vector<std::uint32_t> supporting_nodes(const Body& body, const Box3& box, double factor, double largest_radius) {
  constexpr std::size_t few = 1024;  // nodes, of which a look at each takes less time than a walk
  const auto& position = body.nodes.position;
  const auto& radius = body.nodes.radius;
  std::vector<std::uint32_t> nodes;
  const auto add_if_near = [&](std::uint32_t j) {
    const Vec3& x = position[j];
    double away = 0;  // along the axis on which x is farthest from the box
    for (int a = 0; a < 3; ++a) away = std::max({away, x[a] - box.hi[a], box.lo[a] - x[a]});
    if (away <= factor * radius[j]) nodes.push_back(j);
  };
  if (position.size() <= few) {
    for (std::uint32_t j = 0; j < position.size(); ++j) add_if_near(j);
    return nodes;
  }
  const Box3 reach = box.grown(factor * largest_radius);
  body.cache->grid.walk(
      [&](int, const Vec3& middle, double half) {
        return reach.meets({middle - Vec3::Constant(half), middle + Vec3::Constant(half)});
      },
      [&](int, std::uint32_t j) { add_if_near(j); });
  std::sort(nodes.begin(), nodes.end());
  return nodes;
}

bool straight_shape(const Body& body, const PointBlock& block, std::size_t point, ShapeGradients& shape) {
  const auto begin = block.entry_begin[point], end = block.entry_begin[point + 1];
  if (std::any_of(block.entry_bent.begin() + begin, block.entry_bent.begin() + end,
                  [](auto bent) { return bent != 0; }))
    return false;
  const MaterialPoint& p = block.points[point];
  std::vector<SupportNode> seen;
  shape.nodes.clear();
  shape.bent.assign(end - begin, 0);
  for (auto q = begin; q < end; ++q) {
    const auto j = block.nodes[block.entry_node[q]];
    shape.nodes.push_back(j);
    const double support = support_factors[p.widenings] * body.nodes.radius[j];
    seen.push_back(direct_support(p.position, body.nodes.position[j], support));
  }
  shape_gradients(p.position, seen, shape.gradient, &shape.value, ill_conditioned);
  return true;
}

void compute_supports(const Body& body, std::vector<SupportTask> tasks, const Occluders* occluders,
                      const VisibilityChanges* changes, std::span<const std::uint32_t> component,
                      NearbyOccluders* kept) {
  NearbyOccluders own, &nearby = kept ? *kept : own;
  const NodeComponents components(component);
  const double largest_radius = *std::max_element(body.nodes.radius.begin(), body.nodes.radius.end());
  // Two passes: most points need no wider support, so the first pass queries small neighbourhoods.
  const std::span all(support_factors);
  for (const auto factors : {all.first(1), all.subspan(1)}) {
    std::vector<Batch> batches = batches_of(tasks, largest_radius);
    parallel_for(batches.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b) batches[b].find_nodes(body, factors.back(), largest_radius, changes);
    });
    std::vector<Box3> influence;
    for (const Batch& batch : batches) influence.push_back(batch.influence);
    const Occluders& near = occluders ? *occluders : nearby.near(body.surface, influence, kept ? largest_radius : 0);
    parallel_for(batches.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t b = begin; b < end; ++b) batches[b].compute(body, factors, near, changes, components);
    });
    std::vector<SupportTask> deficient;
    for (const Batch& batch : batches)
      deficient.insert(deficient.end(), batch.deficient.begin(), batch.deficient.end());
    tasks.swap(deficient);
  }
}

}  // namespace geo
