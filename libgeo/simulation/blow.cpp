// Walls of the pattern go through the whole body at first. Those in other pieces are taken out.
#include "simulation/blow.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "base/union_find.h"
#include "geometry/distance.h"
#include "kerf/contact.h"
#include "kerf/crack.h"
#include "kerf/error.h"
#include "kerf/mesh.h"
#include "kerf/pieces.h"
#include "kerf/score.h"
#include "simulation/broken_surface.h"

namespace geo {
namespace {

std::size_t row(Side s) { return 2 * s.face.index() + static_cast<std::size_t>(s.which); }

// Jagged walls of a pattern in the box around a piece. They end outside of the piece.
TriangleMesh walls(const TriangleMesh& piece, const Vec3& impact, int cells, double edge, std::uint64_t seed) {
  constexpr double beyond = 0.02;     // of the box, on each side
  constexpr double roughness = 0.01;  // of the walls, relative to the diagonal of the box
  const Box3 box = bounding_box(piece);
  const Box3 wide = box.grown(beyond * box.diagonal());
  const Vec3 size = wide.hi - wide.lo;
  TriangleMesh block = make_block(size, size.maxCoeff());
  for (Vec3& v : block.vertices) v += wide.lo;
  ScoreOptions options;
  options.pieces = cells;
  options.pattern.impact = impact;
  options.pattern.seed = seed;
  options.jagged.amplitude = roughness;
  options.jagged.octaves = 2;
  options.jagged.edge = edge / size.norm();
  options.jagged.seed = seed;
  return make_score(Complex::from_skin(block), options).sheet;
}

// Takes new walls out again that are in other pieces than the one with this number.
void keep_within(Grown& grown, const Pieces& pieces, std::int32_t piece) {
  // Sides are joined on the surface, or by a new wall between them.
  UnionFind joined(2 * grown.now.face_count());
  const auto join = [&](Side a, Side b) {
    joined.unite(static_cast<std::uint32_t>(row(a)), static_cast<std::uint32_t>(row(b)));
  };
  const auto set_of = [&](Side s) { return joined.find(static_cast<std::uint32_t>(row(s))); };
  grown.for_each_side([&](Side s) {
    for (int k = 0; k < 3; ++k) join(s, grown.now.neighbor(s, k));
    if (!grown.parent[s.face.index()].valid()) join({s.face, 0}, {s.face, 1});
  });
  std::vector<bool> is_hit(grown.parent.size() * 2, false);
  grown.for_each_side([&](Side s) {
    const FaceId parent = grown.parent[s.face.index()];
    if (parent.valid() && pieces.of_side[row({parent, s.which})] == piece) is_hit[set_of(s)] = true;
  });
  ComplexEdit edit;
  for (std::uint32_t f = 0; f < grown.now.face_count(); ++f)
    if (grown.now.alive(FaceId(f)) && !grown.parent[f].valid() && !is_hit[set_of({FaceId(f), 0})])
      edit.removed_faces.push_back(FaceId(f));
  if (!edit.empty()) grown.now.apply(edit);
}

void require_no_blade(const Simulation& run) {
  const RunState& state = run.state();
  for (std::size_t b = 0; b < state.fronts.size(); ++b)
    if (run.scene().blades[b].active(state.time) && !state.fronts[b].empty())
      throw InputError("a blade is in the body: break it when the blade is out");
}

// The point of the surface nearest to a point of the world; of equal distances, of the first side.
SurfaceHit nearest_on_surface(const Simulation& run, const Vec3& point) {
  const Complex& surface = run.body().surface;
  std::vector<std::uint32_t> rows;
  surface.two_sided(&rows);
  const std::vector<Vec3> place = run.surface().vertices;
  SurfaceHit hit;
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t f = 0; f < surface.face_count(); ++f)
    for (const int which : {0, 1}) {
      const Side side{FaceId(f), which};
      if (!surface.has(side)) continue;
      std::array<SurfaceVertexId, 3> corner;
      std::array<Vec3, 3> at;
      for (int k = 0; k < 3; ++k) {
        corner[static_cast<std::size_t>(k)] = surface.surface_vertex(side, k);
        at[static_cast<std::size_t>(k)] = place[rows[corner[static_cast<std::size_t>(k)].index()]];
      }
      const Vec3 on = closest_point_on_triangle(point, at[0], at[1], at[2]);
      const double distance = (on - point).squaredNorm();
      if (!(distance < least)) continue;
      least = distance;
      const Vec3 share = barycentric(on, at[0], at[1], at[2]);
      hit = {.material = Vec3::Zero(), .nearest = {}, .side = side};
      int most = 0;
      for (int k = 0; k < 3; ++k) {
        hit.material += share[k] * surface.point(surface.site(corner[static_cast<std::size_t>(k)]));
        if (share[k] > share[most]) most = k;
      }
      hit.nearest = corner[static_cast<std::size_t>(most)];
    }
  return hit;
}

// Nodes near the blow get a velocity away from it.
void push_away(const Body& body, const Vec3& from, State& motion) {
  constexpr double speed = 0.5, reach = 0.5;  // at the blow, per second; in diagonals of the body
  const double size = body.surface.extent().diagonal();
  for (std::size_t i = 0; i < body.nodes.size(); ++i) {
    const Vec3 away = body.nodes.position[i] + motion.displacement[i] - from;
    const double distance = away.norm(), share = 1 - distance / (reach * size);
    if (share > 0 && distance > 0) motion.velocity[i] += speed * size * share * away / distance;
  }
}

// The run with one pattern. Throws GeometryError where it cannot be.
RunStart attempt(const Simulation& run, const SurfaceHit& hit, int cells, std::uint64_t seed) {
  const Complex& old = run.body().surface;
  const Pieces pieces = find_pieces(old);
  const std::int32_t piece = pieces.of_side[row(hit.side)];
  const TriangleMesh mesh = piece_mesh(old, pieces, static_cast<std::uint32_t>(piece));
  Complex cut = old;
  insert_sheet(cut, walls(mesh, hit.material, cells, run.body().finest_spacing, seed), CrackNumbers(old).next());
  Grown grown(old, cut);
  keep_within(grown, pieces, piece);
  if (find_pieces(grown.now).count == pieces.count) throw GeometryError("no wall divides it");
  RunStart start{.body = run.body(), .state = run.state()};
  // Cracks of blades that have gone leave nothing to go on with.
  for (std::vector<EdgeFront>& fronts : start.state.fronts) fronts.clear();
  start.state.fracture.fronts.clear();
  start.state.rest = {};  // nothing sleeps
  const BodyDelta delta = update_body(start.body, grown.now);
  Solid solid = run.solid();
  solid.update(start.body, delta, start.state.motion);
  auto& index = start.state.body_index;
  for (const NodeId donor : delta.donors) index.push_back(std::uint32_t(index[donor.index()]));
  if (start.state.surface.empty()) return start;
  start.state.surface = broken_surface(run, Grown(old, start.body.surface), hit);
  TriangleMesh surface = start.body.surface.two_sided();
  surface.vertices = start.state.surface;
  if (count_crossings(surface) > 0)
    throw GeometryError("faces would cross; break it elsewhere, or when it is less bent");
  return start;
}

}  // namespace

RunStart broken_by(const Simulation& run, const Blow& blow) {
  constexpr std::uint64_t attempts = 4, with_all_cells = 2;  // then with half of them: walls are farther apart
  require_no_blade(run);
  const SurfaceHit hit = nearest_on_surface(run, blow.point);
  std::string reason;
  for (std::uint64_t i = 0; i < attempts; ++i) {
    try {
      RunStart start = attempt(run, hit, i < with_all_cells ? blow.cells : std::max(2, blow.cells / 2),
                               run.body().crack_steps + 1 + (i << 32));
      push_away(start.body, blow.point, start.state.motion);
      return start;
    } catch (const GeometryError& e) {
      reason = e.what();
    } catch (const InputError& e) {
      reason = e.what();
    }
  }
  throw GeometryError("the body does not break here: " + reason);
}

}  // namespace geo
