// Walls of the pattern go through the whole body at first. Those in other pieces are taken out.
#include "live/broken_body.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include <kerf/contact.h>
#include <kerf/crack.h>
#include <kerf/error.h>
#include <kerf/mesh.h>
#include <kerf/pieces.h>
#include <kerf/score.h>
#include "live/broken_surface.h"

namespace live {
namespace {

using geo::Complex;
using geo::FaceId;
using geo::Side;
using geo::SurfaceVertexId;
using geo::Vec3;

std::size_t row(Side s) { return 2 * s.face.index() + static_cast<std::size_t>(s.which); }

// Jagged walls of a pattern in the box around a piece. They end outside of the piece.
geo::TriangleMesh walls(const geo::TriangleMesh& piece, const Vec3& impact, int cells, double edge,
                        std::uint64_t seed) {
  constexpr double beyond = 0.02;     // of the box, on each side
  constexpr double roughness = 0.01;  // of the walls, relative to the diagonal of the box
  const geo::Box3 box = geo::bounding_box(piece);
  const geo::Box3 wide = box.grown(beyond * box.diagonal());
  const Vec3 size = wide.hi - wide.lo;
  geo::TriangleMesh block = geo::make_block(size, size.maxCoeff());
  for (Vec3& v : block.vertices) v += wide.lo;
  geo::ScoreOptions options;
  options.pieces = cells;
  options.pattern.impact = impact;
  options.pattern.seed = seed;
  options.jagged.amplitude = roughness;
  options.jagged.octaves = 2;
  options.jagged.edge = edge / size.norm();
  options.jagged.seed = seed;
  return geo::make_score(Complex::from_skin(block), options).sheet;
}

// Sets of sides that are joined on the surface, or by a new wall between them.
class JoinedSides {
 public:
  explicit JoinedSides(const Complex& complex) : root_(2 * complex.face_count()) {
    std::iota(root_.begin(), root_.end(), std::size_t(0));
  }
  void join(Side a, Side b) { root_[find(row(a))] = find(row(b)); }
  std::size_t find(std::size_t i) {
    while (root_[i] != i) {
      root_[i] = root_[root_[i]];
      i = root_[i];
    }
    return i;
  }

 private:
  std::vector<std::size_t> root_;
};

// Takes new walls out again that are in other pieces than the one with this number.
void keep_within(Grown& grown, const geo::Pieces& pieces, std::int32_t piece) {
  JoinedSides joined(grown.now);
  grown.for_each_side([&](Side s) {
    for (int k = 0; k < 3; ++k) joined.join(s, grown.now.neighbor(s, k));
    if (!grown.parent[s.face.index()].valid()) joined.join({s.face, 0}, {s.face, 1});
  });
  std::vector<bool> is_hit(grown.parent.size() * 2, false);
  grown.for_each_side([&](Side s) {
    const FaceId parent = grown.parent[s.face.index()];
    if (parent.valid() && pieces.of_side[row({parent, s.which})] == piece) is_hit[joined.find(row(s))] = true;
  });
  geo::ComplexEdit edit;
  for (std::uint32_t f = 0; f < grown.now.face_count(); ++f)
    if (grown.now.alive(FaceId(f)) && !grown.parent[f].valid() && !is_hit[joined.find(row({FaceId(f), 0}))])
      edit.removed_faces.push_back(FaceId(f));
  if (!edit.empty()) grown.now.apply(edit);
}

// Cracks of blades that have gone leave nothing to go on with. A blade that is there does.
void end_cracks(const geo::Simulation& run, geo::RunState& state) {
  for (std::size_t b = 0; b < state.fronts.size(); ++b) {
    if (run.scene().blades[b].active(state.time) && !state.fronts[b].empty())
      throw BadMessage("a blade is in the body: break it when the blade is out");
    state.fronts[b].clear();
  }
  state.fracture.fronts.clear();
}

// Nodes near the blow get a velocity away from it.
void push_away(const geo::Body& body, const Vec3& from, geo::State& motion) {
  constexpr double speed = 0.5, reach = 0.5;  // at the blow, per second; in diagonals of the body
  const double size = body.surface.extent().diagonal();
  for (std::size_t i = 0; i < body.nodes.size(); ++i) {
    const Vec3 away = body.nodes.position[i] + motion.displacement[i] - from;
    const double distance = away.norm(), share = 1 - distance / (reach * size);
    if (share > 0 && distance > 0) motion.velocity[i] += speed * size * share * away / distance;
  }
}

// The run with one pattern. Throws GeometryError where it cannot be.
geo::RunStart attempt(const geo::Simulation& run, const PickedPoint& hit, int cells, std::uint64_t seed) {
  const Complex& old = run.body().surface;
  const geo::Pieces pieces = geo::find_pieces(old);
  const std::int32_t piece = pieces.of_side[row(hit.side)];
  const geo::TriangleMesh mesh = geo::piece_mesh(old, pieces, static_cast<std::uint32_t>(piece));
  Complex cut = old;
  geo::insert_sheet(cut, walls(mesh, hit.material, cells, run.body().finest_spacing, seed),
                    geo::CrackNumbers(old).next());
  Grown grown(old, cut);
  keep_within(grown, pieces, piece);
  if (geo::find_pieces(grown.now).count == pieces.count) throw geo::GeometryError("no wall divides it");
  geo::RunStart start{.body = run.body(), .state = run.state()};
  end_cracks(run, start.state);
  const geo::BodyDelta delta = geo::update_body(start.body, grown.now);
  geo::Solid solid = run.solid();
  solid.update(start.body, delta, start.state.motion);
  auto& index = start.state.body_index;
  for (const geo::NodeId donor : delta.donors) index.push_back(std::uint32_t(index[donor.index()]));
  if (start.state.surface.empty()) return start;
  start.state.surface = broken_surface(run, Grown(old, start.body.surface), hit);
  geo::TriangleMesh surface = start.body.surface.two_sided();
  surface.vertices = start.state.surface;
  if (geo::count_crossings(surface) > 0)
    throw geo::GeometryError("faces would cross; break it elsewhere, or when it is less bent");
  return start;
}

}  // namespace

geo::RunStart broken_body(const geo::Simulation& run, const PickedPoint& hit, const Vec3& place, int cells) {
  constexpr std::uint64_t attempts = 4, with_all_cells = 2;  // then with half of them: walls are farther apart
  std::string reason;
  for (std::uint64_t i = 0; i < attempts; ++i) {
    try {
      geo::RunStart start = attempt(run, hit, i < with_all_cells ? cells : std::max(2, cells / 2),
                                    run.body().crack_steps + 1 + (i << 32));
      push_away(start.body, place, start.state.motion);
      return start;
    } catch (const geo::GeometryError& e) {
      reason = e.what();
    } catch (const geo::InputError& e) {
      reason = e.what();
    }
  }
  throw BadMessage("the body does not break here: " + reason);
}

}  // namespace live
