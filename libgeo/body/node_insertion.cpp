// New nodes are offset samples of crack faces, kept if they see their face and no node nearer than
// 0.6 spacings. The nearest nodes that see a new one give it volume. Debris is decided by the
// eigenvalues of Σ x xᵀ over the neighbours.
#include "body/node_insertion.h"
#include "body/incremental_cache.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "base/random.h"
#include "body/locate.h"
#include "geometry/distance.h"
#include "geometry/predicates.h"
#include "kerf/parallel.h"
#include "sampling/resample.h"

namespace geo {

namespace {

// A node nearer to a face than this, in spacings, counts as on it, and is moved off. Larger: more
// nodes are moved and lose their edges.
constexpr double on_face = 0.02;

// Walls nearer to each other than this, in spacings, have no node between them (decision 116).
constexpr double resolved_walls = 0.03;

}  // namespace

void set_original_nodes(Body& body, std::uint32_t count) {
  body.original_nodes = count;
  body.finest_spacing = *std::min_element(body.nodes.spacing.begin(), body.nodes.spacing.begin() + count);
  body.widest_radius = *std::max_element(body.nodes.radius.begin(), body.nodes.radius.begin() + count);
}

namespace {

// Volumes are given in multiples of 2⁻⁴⁰ of the largest: no sum is rounded.
double volume_unit(double largest) { return std::ldexp(1.0, std::ilogb(largest) - 40); }

double cube_of(double x) { return x * x * x; }

// Each giver keeps (1 − α) of its volume: α = c s³ / (V + c s³) for the volume V of all givers and
// their mean c of volume over cubed spacing, at most a half. So volumes in proportion to the cubes
// of spacings stay so.
double take_volume(NodeSet& nodes, double spacing, std::span<const std::uint32_t> givers) {
  double sum = 0, density = 0, largest = 0;
  for (const auto j : givers) {
    const double v = nodes.volume[j];
    sum += v;
    density += v / cube_of(nodes.spacing[j]);
    largest = std::max(largest, v);
  }
  const double wanted = cube_of(spacing) * density / double(givers.size()),
               share = std::min(0.5, wanted / (sum + wanted)), unit = volume_unit(largest);
  double taken = 0;
  for (const auto j : givers) {
    const double given = unit * std::floor(share * nodes.volume[j] / unit);
    nodes.volume[j] -= given;
    taken += given;
  }
  return taken;
}

// Half of the volume: exact, too.
double take_half(NodeSet& nodes, NodeId giver) { return nodes.volume[giver.index()] *= 0.5; }

}  // namespace

NodeId NewNodes::insert(const Vec3& x, NodeId donor, double spacing, std::span<const std::uint32_t> givers) {
  NodeSet& nodes = body_.nodes;
  const NodeId id(nodes.size());
  const double volume = givers.empty() ? take_half(nodes, donor) : take_volume(nodes, spacing, givers);
  nodes.position.push_back(x);
  nodes.spacing.push_back(spacing);
  nodes.radius.push_back(double(nodes.radius[donor.index()]));
  nodes.volume.push_back(volume);
  body_.debris.push_back(0);
  body_.cache->grid.insert(nodes.position, id.value);
  donors_.push_back(donor);
  return id;
}

void NewNodes::remove_from(NodeId first) {
  NodeSet& nodes = body_.nodes;
  for (std::uint32_t i = std::uint32_t(nodes.size()); i-- > first.value;) {
    nodes.volume[donors_.back().index()] += nodes.volume[i];
    body_.cache->grid.erase(i, nodes.position[i]);
    nodes.position.pop_back();
    nodes.spacing.pop_back();
    nodes.radius.pop_back();
    nodes.volume.pop_back();
    body_.debris.pop_back();
    donors_.pop_back();
  }
}

namespace {

// The wanted spacing of new nodes at a crack: half of the spacing of the nearest original node to
// each cell of a lattice. A crack is a boundary, and the leaves of an octree halve at most from one
// to the next; half is as fine as nodes usually are. New nodes do not count, or each step would
// halve anew.
class CrackSpacing {
 public:
  explicit CrackSpacing(const Body& body) : body_(body), cell_(body.cache->grid.cell()) {}
  double at(const Vec3& x) {
    const std::array<double, 3> index{std::floor(x[0] / cell_), std::floor(x[1] / cell_), std::floor(x[2] / cell_)};
    const auto [known, fresh] = known_.try_emplace(index, 0);
    if (fresh) {
      const Vec3 middle = cell_ * (Vec3(index.data()) + Vec3::Constant(0.5));
      const double spacing = body_.nodes.spacing[body_.cache->grid.nearest(
          body_.nodes.position, middle, 1, ~0u, [&](std::uint32_t i) { return i < body_.original_nodes; })[0]];
      known->second = std::min(spacing, std::max(body_.finest_spacing, 0.5 * spacing));
    }
    return known->second;
  }

 private:
  const Body& body_;
  const double cell_;
  std::map<std::array<double, 3>, double> known_;
};

// The nearest nodes to x that see it, at most twelve; `nearest` are the nearest of all. Faces in
// `except` do not hide any.
std::vector<std::uint32_t> visible_nodes(const Body& body, const Vec3& x, const std::vector<std::uint32_t>& nearest,
                                         std::span<const FaceId> except = {}) {
  Box3 around{x, x};
  for (const auto i : nearest) around.add(body.nodes.position[i]);
  const BoxVisibility visibility(body.surface, around, except);
  std::vector<std::uint32_t> visible;
  for (const auto i : nearest)
    if (visible.size() < 12 && !visibility.blocked(body.nodes.position[i], x)) visible.push_back(i);
  return visible;
}

// The share of the way from a point of a face at which the first other face is; 1: none is met.
double way_to_next_face(const Complex& k, FaceId own, const Vec3& from, const Vec3& to) {
  Box3 way{from, from};
  way.add(to);
  std::vector<FaceId> near;
  k.faces_near(way, near);
  double least = 1;
  for (const FaceId f : near) {
    const auto [a, b, c] = k.corners(f);
    if (f == own || !segment_meets_triangle(from, to, a, b, c)) continue;
    const Vec3 normal = (b - a).cross(c - a);
    const double share = normal.dot(a - from) / normal.dot(to - from);
    if (share > 0 && share < least) least = share;
  }
  return least;
}

// Whether a place has a node that it sees nearer than 0.6 spacings: below the 0.8 spacings between
// samples (resample.h). Larger: fewer new nodes beside old ones.
bool has_node_near(const Body& body, const Vec3& x, double spacing) {
  std::vector<std::uint32_t> near;
  body.cache->grid.within(body.nodes.position, x, 0.6 * spacing, near);
  return std::any_of(near.begin(), near.end(),
                     [&](std::uint32_t i) { return !is_blocked(body.surface, body.nodes.position[i], x); });
}

// 24 candidates for at most twelve visible nodes. Fewer are found where the crack hides more than
// half.
std::vector<std::uint32_t> candidates_at(const Body& body, const Vec3& x) {
  return body.cache->grid.nearest(body.nodes.position, x, 24, ~0u, [](std::uint32_t) { return true; });
}

// Inserts a node that sees others, which give it volume. Its radius is in proportion to the spacing
// and wide enough for a dozen neighbours, as the sampling makes it.
void insert_seen(NewNodes& inserted, const Vec3& x, NodeId donor, double spacing,
                 const std::vector<std::uint32_t>& visible) {
  Body& body = inserted.body();
  const NodeId node = inserted.insert(x, donor, spacing, visible);
  const double reach = std::min((body.nodes.position[visible.back()] - x).norm(), 3 * spacing);
  double& radius = body.nodes.radius[node.index()];
  radius = std::min(body.widest_radius, std::max(radius * (spacing / body.nodes.spacing[donor.index()]), 1.05 * reach));
}

std::vector<std::array<Vec3, 3>> corners_of(const Complex& surface, const std::vector<FaceId>& faces) {
  std::vector<std::array<Vec3, 3>> triangles;
  for (const FaceId f : faces) triangles.push_back(surface.corners(f));
  return triangles;
}

}  // namespace

std::size_t insert_nodes_near(NewNodes& inserted, const std::vector<FaceId>& faces, const InsertionOptions& options) {
  if (faces.empty()) return 0;
  Body& body = inserted.body();
  CrackSpacing crack_spacing(body);
  const auto spacing_at = [&](const Vec3& x) { return options.spacing > 0 ? options.spacing : crack_spacing.at(x); };
  std::size_t count = 0;
  for (const auto& s : offset_samples(corners_of(body.surface, faces), spacing_at, options.seed)) {
    if (!is_in_front(body.surface, {faces[s.face], s.side}, s.base, s.position)) continue;
    if (has_node_near(body, s.position, s.spacing)) continue;
    // The donor is the nearest node that sees the new one; else, in a fresh sliver, the nearest
    // that saw it before this step; else the nearest of all. Another may have moved far away.
    const auto nearest = candidates_at(body, s.position);
    const auto visible = visible_nodes(body, s.position, nearest);
    // Where rounding has exchanged two sheets, even air may be in front of a side with material.
    if (visible.empty() && !is_inside(body.surface, s.position)) continue;
    const auto seen_before =
        visible.empty() ? visible_nodes(body, s.position, nearest, options.fresh) : std::vector<std::uint32_t>();
    const NodeId donor(!visible.empty() ? visible[0] : !seen_before.empty() ? seen_before[0] : nearest[0]);
    if (options.spacing == 0 && !visible.empty())
      insert_seen(inserted, s.position, donor, s.spacing, visible);
    else
      inserted.insert(s.position, donor, s.spacing);
    if (++count == options.limit) break;
  }
  return count;
}

std::vector<NodePair> insert_nodes_between_walls(NewNodes& inserted, const std::vector<FaceId>& faces,
                                                 std::uint64_t seed) {
  std::vector<NodePair> joins;
  if (faces.empty()) return joins;
  Body& body = inserted.body();
  CrackSpacing crack_spacing(body);
  std::vector<OffsetSample> waiting;
  const auto spacing_at = [&](const Vec3& x) { return crack_spacing.at(x); };
  for (OffsetSample& s : offset_samples(corners_of(body.surface, faces), spacing_at, seed)) {
    const Side side{faces[s.face], s.side};
    if (is_in_front(body.surface, side, s.base, s.position)) continue;
    // Two heights in turn, since nodes in one plane carry no bending; the middle where those would
    // be on a face.
    const Vec3 way = way_to_next_face(body.surface, side.face, s.base, s.position) * (s.position - s.base);
    const bool is_near_base = waiting.size() % 2 == 0;
    const bool has_heights = 0.3 * way.norm() >= on_face * s.spacing;
    if (way.norm() < resolved_walls * s.spacing) continue;
    s.position = s.base + (!has_heights ? 0.5 : is_near_base ? 0.3 : 0.7) * way;
    if (is_in_front(body.surface, side, s.base, s.position)) waiting.push_back(s);
  }
  // Only where a node sees them: so pieces stay connected. In turn, since each may be the one that
  // the next sees.
  for (bool any = true; any;) {
    any = false;
    std::erase_if(waiting, [&](const OffsetSample& s) {
      if (has_node_near(body, s.position, s.spacing)) return true;
      const auto visible = visible_nodes(body, s.position, candidates_at(body, s.position));
      if (visible.empty()) return false;
      joins.push_back({NodeId(visible[0]), NodeId(body.nodes.size())});
      insert_seen(inserted, s.position, NodeId(visible[0]), s.spacing, visible);
      return any = true;
    });
  }
  return joins;
}

namespace {

// Gives node i its fair share of the volume of it and its neighbours, if it has less than half of
// that. Returns whether it had.
bool take_fair_share(NodeSet& nodes, const VisibilityGraph& graph, NodeId i) {
  const auto cube = [&](std::uint32_t j) { return cube_of(nodes.spacing[j]); };
  double volume = nodes.volume[i.index()], cubes = cube(i.value), largest = volume;
  const auto neighbors = graph.neighbors(nodes, i);
  for (const auto& n : neighbors) {
    volume += nodes.volume[n.to.index()];
    cubes += cube(n.to.value);
    largest = std::max(largest, nodes.volume[n.to.index()]);
  }
  const double density = volume / cubes, fair = density * cube(i.value);
  if (!(nodes.volume[i.index()] < 0.5 * fair)) return false;
  const auto excess = [&](std::uint32_t j) { return std::max(0.0, nodes.volume[j] - density * cube(j)); };
  double all = 0;
  for (const auto& n : neighbors) all += excess(n.to.value);
  // The excesses of all neighbours have at least the sum that this node lacks.
  const double share = std::min(1.0, (fair - nodes.volume[i.index()]) / all), unit = volume_unit(largest);
  double taken = 0;
  for (const auto& n : neighbors) {
    const double given = unit * std::floor(share * excess(n.to.value) / unit);
    nodes.volume[n.to.index()] -= given;
    taken += given;
  }
  nodes.volume[i.index()] += taken;
  return taken > 0;
}

}  // namespace

void even_out_volumes(NewNodes& inserted) {
  Body& body = inserted.body();
  std::vector<NodeId> nodes = inserted.donors();
  for (std::uint32_t i = inserted.first().value; i < body.nodes.size(); ++i) nodes.push_back(NodeId(i));
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  // A volume spreads by one edge of the graph in a sweep, and a chain of n new nodes is even after
  // about n sweeps; more are not worth their time.
  constexpr int max_sweeps = 32;
  bool any = true;
  for (int sweep = 0; any && sweep < max_sweeps; ++sweep) {
    any = false;
    for (const NodeId i : nodes) any = take_fair_share(body.nodes, body.graph, i) || any;
  }
}

namespace {

// Maximises min_k n_k · d over unit vectors d approximately: adds the normal n_k with the least
// n_k · sum, 64 times. Between two faces d is their bisector, in a corner its axis.
Vec3 away_from(const std::vector<Vec3>& normals) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& n : normals) sum += n;
  for (int i = 0; normals.size() > 1 && i < 64; ++i)
    sum += *std::min_element(normals.begin(), normals.end(),
                             [&](const Vec3& a, const Vec3& b) { return a.dot(sum) < b.dot(sum); });
  const double length = sum.norm();
  return length > 0 ? Vec3(sum / length) : normals[0];
}

// A position with more clearance for a node on or very near faces; x itself where there is none.
Vec3 position_off_faces(const Complex& surface, std::uint32_t node, const Vec3& x, double spacing) {
  // By 10 % of the spacing at most. Larger: more nodes lose their edges.
  const double close = on_face * spacing, farthest = 0.1 * spacing;
  std::vector<FaceId> around;
  surface.faces_near(Box3{x, x}.grown(farthest + close), around);
  const auto distance = [&](FaceId f, const Vec3& p) {
    const auto t = surface.corners(f);
    return (closest_point_on_triangle(p, t[0], t[1], t[2]) - p).norm();
  };
  // Directions away from all close faces at once, since the way straight off one face may pass
  // another. On a face either side will do.
  std::array<std::vector<Vec3>, 2> normals;
  double clearance = farthest;
  for (const FaceId f : around) {
    const double d = distance(f, x);
    if (d > close) continue;
    clearance = std::min(clearance, d);
    const auto t = surface.corners(f);
    const int above = orient3d(t[0], t[1], t[2], x);
    const Vec3 n = (t[1] - t[0]).cross(t[2] - t[0]).normalized();
    normals[0].push_back(above < 0 ? Vec3(-n) : n);
    normals[1].push_back(above > 0 ? n : Vec3(-n));
  }
  if (normals[0].empty()) return x;
  const auto on = std::partition(around.begin(), around.end(), [&](FaceId f) { return !touches(surface, f, x, x); });
  if (on != around.end()) clearance = -1;  // any other position is better
  std::vector<Vec3> directions{away_from(normals[0]), away_from(normals[1])};
  for (const auto& side : normals) directions.insert(directions.end(), side.begin(), side.end());
  for (Random random(node); directions.size() < 2 * normals[0].size() + 16;) directions.push_back(random.direction());
  // As far as possible. The node leaves the faces that it is on, and passes no other.
  Vec3 best = x;
  for (const Vec3& along : directions)
    // At most 17 steps, each half of the one before. Leaving a face is tested from 1e-3 of the step
    // on, since x itself is on the face.
    for (double step = farthest; step > 1e-6 * spacing; step *= 0.5) {
      const Vec3 to = x + step * along;
      if (std::any_of(around.begin(), on, [&](FaceId f) { return touches(surface, f, x, to); }) ||
          std::any_of(on, around.end(), [&](FaceId f) { return touches(surface, f, x + 1e-3 * step * along, to); }))
        continue;
      double least = farthest;
      for (const FaceId f : around) least = std::min(least, distance(f, to));
      if (least > clearance) {
        clearance = least;
        best = to;
      }
      if (clearance > close) return best;
      break;
    }
  return best;
}

}  // namespace

std::vector<NodeId> move_nodes_off(Body& body, const std::vector<FaceId>& faces) {
  std::vector<std::uint32_t> near;
  for (const FaceId f : faces) {
    const auto t = body.surface.corners(f);
    // Nodes in grid cubes along the face: a ball around a large face may hold the whole body.
    body.cache->grid.walk(
        [&](int, const Vec3& middle, double half) {
          const double reach = std::numbers::sqrt3 * half + 0.1 * body.cache->grid.cell();
          return (closest_point_on_triangle(middle, t[0], t[1], t[2]) - middle).squaredNorm() <= reach * reach;
        },
        [&](int, std::uint32_t i) {
          const Vec3& x = body.nodes.position[i];
          if ((closest_point_on_triangle(x, t[0], t[1], t[2]) - x).norm() <= on_face * body.nodes.spacing[i])
            near.push_back(i);
        });
  }
  std::sort(near.begin(), near.end());
  near.erase(std::unique(near.begin(), near.end()), near.end());
  std::vector<NodeId> moved;
  for (const auto i : near) {
    const Vec3 from = body.nodes.position[i], to = position_off_faces(body.surface, i, from, body.nodes.spacing[i]);
    if (to == from) continue;
    body.cache->grid.erase(i, from);
    body.nodes.position[i] = to;
    body.cache->grid.insert(body.nodes.position, i);
    moved.push_back(NodeId(i));
  }
  return moved;
}

void mark_debris(Body& body, const std::vector<NodeId>& nodes) {
  parallel_for(nodes.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      const std::size_t i = nodes[n].index();
      Mat3 moment = Mat3::Zero();
      for (const auto& neighbor : body.graph.neighbors(body.nodes, nodes[n])) {
        const Vec3 x = (body.nodes.position[neighbor.to.index()] - body.nodes.position[i]) / body.nodes.radius[i];
        moment += x * x.transpose();
      }
      const Vec3 spread = Eigen::SelfAdjointEigenSolver<Mat3>(moment, Eigen::EigenvaluesOnly).eigenvalues();
      body.debris[i] = !(spread[0] > debris_below * spread[2]);
    }
  });
}

}  // namespace geo
