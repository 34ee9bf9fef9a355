// The wall of a chip is a bumpy paraboloid across a convex edge of a piece, deepest in the middle
// and level with the edge at its ends.
//
// Walls and paraboloids are inserted into a block, which divides them where they cross. A
// paraboloid keeps the part that the walls enclose around its middle. A chip that does not part one
// small piece from another is left out again.
#include "score/chips.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>

#include "base/elementary.h"
#include "base/random.h"
#include "base/union_find.h"
#include "geometry/distance.h"
#include "kerf/crack.h"
#include "kerf/error.h"
#include "kerf/mesh.h"
#include "kerf/pieces.h"

namespace geo {
namespace {

constexpr double turn = 6.283185307179586;

// A convex edge of a piece between faces of different neighbours, with their outward normals.
struct PieceEdge {
  Vec3 a, b;
  std::array<Vec3, 2> normal;
};

// A side of a face at one of its edges.
struct EdgeUse {
  std::uint32_t a, b;            // vertices, a < b
  std::int32_t piece, neighbor;  // that the side belongs to, and that is beyond; −1: air
  Vec3 normal, opposite;         // outwards; the third corner
};

// The uses of edges by sides of the skin and of one crack, those of one edge and piece together.
std::vector<EdgeUse> edge_uses(const Complex& cut, std::int32_t crack, const Pieces& pieces) {
  std::vector<EdgeUse> uses;
  for (std::uint32_t f = 0; f < cut.face_count(); ++f) {
    const auto& face = cut.face(FaceId(f));
    if (!cut.alive(FaceId(f)) || (face.crack != 0 && face.crack != crack)) continue;
    const auto c = cut.corners(FaceId(f));
    const Vec3 normal = face_normal(c[0], c[1], c[2]);
    for (std::uint32_t which = 0; which < (face.crack == 0 ? 1u : 2u); ++which)
      for (std::size_t k = 0; k < 3; ++k) {
        const auto u = face.v[k].value, v = face.v[(k + 1) % 3].value;
        uses.push_back({.a = std::min(u, v),
                        .b = std::max(u, v),
                        .piece = pieces.of_side[2 * f + which],
                        .neighbor = face.crack == 0 ? -1 : pieces.of_side[2 * f + 1 - which],
                        .normal = which == 0 ? normal : Vec3(-normal),
                        .opposite = c[(k + 2) % 3]});
      }
  }
  std::stable_sort(uses.begin(), uses.end(), [](const EdgeUse& s, const EdgeUse& t) {
    return std::tie(s.a, s.b, s.piece) < std::tie(t.a, t.b, t.piece);
  });
  return uses;
}

// Where chips can be. Flatter edges than 30 degrees have no corner to break off, and edges sharper
// than 150 degrees bound needles.
std::vector<PieceEdge> chip_edges(const Complex& cut, std::int32_t crack, const Pieces& pieces) {
  const double blunt = std::sqrt(0.75), sharp = -std::sqrt(0.75);  // cosines between normals
  const std::vector<EdgeUse> uses = edge_uses(cut, crack, pieces);
  std::vector<PieceEdge> edges;
  const auto same = [&](std::size_t i, std::size_t j) {
    return uses[i].a == uses[j].a && uses[i].b == uses[j].b && uses[i].piece == uses[j].piece;
  };
  for (std::size_t i = 0, end = 0; i < uses.size(); i = end) {
    for (end = i + 1; end < uses.size() && same(i, end);) ++end;
    if (end != i + 2 || uses[i].neighbor == uses[i + 1].neighbor) continue;
    const EdgeUse &s = uses[i], &t = uses[i + 1];
    const double cosine_between = s.normal.dot(t.normal);
    const Vec3& a = cut.point(VertexId(s.a));
    if (cosine_between > blunt || cosine_between < sharp || (t.opposite - a).dot(s.normal) >= 0) continue;
    edges.push_back({.a = a, .b = cut.point(VertexId(s.b)), .normal = {s.normal, t.normal}});
  }
  return edges;
}

// The wall of a chip before walls of the score bound it.
struct Scoop {
  Vec3 edge_point, deepest;
  double radius;  // of a ball around edge_point that contains the chip
  TriangleMesh mesh;
};

// A paraboloid across an edge: half of its opening along the edge is `half`.
Scoop make_scoop(const PieceEdge& edge, const Vec3& at, double half, Random& random) {
  const Vec3 along = (edge.b - edge.a).normalized();
  // The chip lies a little askew, and is 1/4 to 2/5 as deep as half its length: flat like chips of
  // stone. Larger numbers make deeper notches.
  Vec3 out = (edge.normal[0] + edge.normal[1]).normalized() + 0.15 * random.direction();
  out = (out - along.dot(out) * along).normalized();
  const Vec3 across = out.cross(along);
  const double depth = half * random.uniform(0.25, 0.4), width = half * random.uniform(0.7, 1);
  const double start = random.uniform(0, turn);
  // Rings at these shares of the opening. The last one is beyond the edge: it ends in air or in
  // another piece.
  constexpr std::array rings{0.35, 0.7, 1.0, 1.3};
  constexpr int spokes = 12;
  Scoop scoop{.edge_point = at, .deepest = at - depth * out, .radius = 1.1 * half, .mesh = {}};
  auto& mesh = scoop.mesh;
  mesh.vertices.push_back(scoop.deepest);
  for (const double ring : rings)
    for (int s = 0; s < spokes; ++s) {
      // Bumps of a tenth: the wall is a height field still, and does not cross itself.
      const double share = ring * random.uniform(0.92, 1.08);
      const double angle = start + turn / spokes * (s + random.uniform(-0.2, 0.2));
      const double height = depth * (share * share * random.uniform(0.9, 1.1) - 1 + 0.1 * random.uniform(-1, 1));
      mesh.vertices.push_back(at + half * share * cosine(angle) * along + width * share * sine(angle) * across +
                              height * out);
    }
  const auto vertex = [](std::size_t ring, int spoke) {
    return static_cast<std::uint32_t>(1 + ring * spokes + static_cast<std::size_t>(spoke % spokes));
  };
  for (int s = 0; s < spokes; ++s) mesh.triangles.push_back({0, vertex(0, s), vertex(0, s + 1)});
  for (std::size_t ring = 0; ring + 1 < rings.size(); ++ring)
    for (int s = 0; s < spokes; ++s) {
      mesh.triangles.push_back({vertex(ring, s), vertex(ring + 1, s), vertex(ring + 1, s + 1)});
      mesh.triangles.push_back({vertex(ring, s), vertex(ring + 1, s + 1), vertex(ring, s + 1)});
    }
  return scoop;
}

// Scoops at random places of edges, in proportion to length, which keep apart.
std::vector<Scoop> place_scoops(const std::vector<PieceEdge>& edges, std::size_t count, double length,
                                std::uint64_t seed) {
  std::vector<double> until;
  for (const auto& e : edges) until.push_back((until.empty() ? 0 : until.back()) + (e.b - e.a).norm());
  std::vector<Scoop> scoops;
  if (edges.empty() || !(until.back() > 0)) return scoops;
  Random random(seed);
  for (std::size_t tries = 0; scoops.size() < count && tries < 30 * count; ++tries) {
    const double pick = random.uniform(0, until.back());
    const auto e = std::min<std::size_t>(
        static_cast<std::size_t>(std::upper_bound(until.begin(), until.end(), pick) - until.begin()), edges.size() - 1);
    const Vec3 at = edges[e].a + random.uniform() * (edges[e].b - edges[e].a);
    const double half = 0.5 * length * random.uniform(0.6, 1.4);
    // The farthest corners of a scoop are 1.3 · 1.08 of half its length away.
    const bool free = std::all_of(scoops.begin(), scoops.end(), [&](const Scoop& other) {
      return (other.edge_point - at).norm() > 1.5 * (half + other.radius / 1.1);
    });
    if (free) scoops.push_back(make_scoop(edges[e], at, half, random));
  }
  return scoops;
}

// The walls of a score and of chips as one sheet, whose triangles know their chip.
class ChippedWalls {
 public:
  // Divides walls and scoops where they cross. A scoop that cannot be inserted has no triangles.
  ChippedWalls(const TriangleMesh& walls, const std::vector<Scoop>& scoops, const TriangleBvh& skin,
               const std::function<void()>& pause)
      : skin_(skin) {
    Box3 box = bounding_box(walls);
    for (const auto& scoop : scoops) box.add(bounding_box(scoop.mesh));
    box = box.grown(0.1 * box.diagonal());
    TriangleMesh block = make_block(box.hi - box.lo, box.diagonal());
    for (Vec3& p : block.vertices) p += box.lo;
    block_ = Complex::from_skin(block);
    insert_sheet(block_, walls, wall_crack);
    for (std::size_t i = 0; i < scoops.size(); ++i) {
      pause();
      try {
        insert_sheet(block_, scoops[i].mesh, crack_of(i));
      } catch (const GeometryError&) {
        continue;  // another chip takes its place
      }
    }
    for (std::uint32_t f = 0; f < block_.face_count(); ++f)
      if (block_.alive(FaceId(f)) && block_.face(FaceId(f)).crack == wall_crack) add(FaceId(f), none);
    for (std::size_t i = 0; i < scoops.size(); ++i) keep_enclosed(i, scoops[i].deepest);
  }

  // The triangles of walls and chips; chip_of()[t] is the chip of triangle t, or `none`.
  const TriangleMesh& sheet() const { return sheet_; }
  const std::vector<std::uint32_t>& chip_of() const { return chip_of_; }

  // Leaves out the walls of chips.
  void leave_out(const std::vector<std::uint8_t>& chips) {
    std::size_t kept = 0;
    for (std::size_t t = 0; t < chip_of_.size(); ++t) {
      if (chip_of_[t] != none && chips[chip_of_[t]]) continue;
      sheet_.triangles[kept] = sheet_.triangles[t];
      chip_of_[kept++] = chip_of_[t];
    }
    sheet_.triangles.resize(kept);
    chip_of_.resize(kept);
  }

  static constexpr std::uint32_t none = ~0u;

 private:
  static constexpr std::int32_t wall_crack = 1;
  static std::int32_t crack_of(std::size_t chip) { return static_cast<std::int32_t>(chip) + wall_crack + 1; }

  void add(FaceId f, std::uint32_t chip) {
    index_.resize(block_.vertex_count(), ~0u);
    Triangle triangle;
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexId v = block_.face(f).v[k];
      if (index_[v.index()] == ~0u) {
        index_[v.index()] = static_cast<std::uint32_t>(sheet_.vertices.size());
        sheet_.vertices.push_back(block_.point(v));
      }
      triangle[k] = index_[v.index()];
    }
    sheet_.triangles.push_back(triangle);
    chip_of_.push_back(chip);
  }

  bool inside(VertexId v) {
    const auto [entry, fresh] = inside_.try_emplace(v.value, false);
    if (fresh) entry->second = skin_.inside(block_.point(v));
    return entry->second;
  }
  // Outside of the model, an edge does not lead on: the walls of a score end there, and beyond
  // their end is another piece.
  bool in_model(VertexId a, VertexId b) {
    return inside(a) || inside(b) || skin_.blocks(block_.point(a), block_.point(b));
  }

  // Adds the faces of a scoop that are connected with the one at `deepest`, not across walls.
  void keep_enclosed(std::size_t chip, const Vec3& deepest) {
    std::vector<FaceId> near;
    Box3 around;
    around.add(deepest);
    block_.faces_near(around, near);
    std::optional<FaceId> first;
    double nearest = std::numeric_limits<double>::infinity();
    for (const FaceId f : near) {
      if (block_.face(f).crack != crack_of(chip)) continue;
      const auto c = block_.corners(f);
      const double distance = (closest_point_on_triangle(deepest, c[0], c[1], c[2]) - deepest).norm();
      if (distance < nearest) {
        nearest = distance;
        first = f;
      }
    }
    if (!first || !skin_.inside(deepest)) return;
    std::vector<FaceId> reached{*first};
    std::map<std::uint32_t, bool> known{{first->value, true}};
    while (!reached.empty()) {
      const FaceId f = reached.back();
      reached.pop_back();
      add(f, static_cast<std::uint32_t>(chip));
      for (std::size_t k = 0; k < 3; ++k) {
        const VertexId a = block_.face(f).v[k], b = block_.face(f).v[(k + 1) % 3];
        const RadialCycle around_edge = block_.faces_around(a, b);
        const bool open = around_edge.size() == 2 && std::all_of(around_edge.begin(), around_edge.end(), [&](FaceId g) {
                            return block_.face(g).crack == crack_of(chip);
                          });
        if (!open || !in_model(a, b)) continue;
        for (const FaceId g : around_edge)
          if (known.try_emplace(g.value, true).second) reached.push_back(g);
      }
    }
  }

  const TriangleBvh& skin_;
  Complex block_;
  std::vector<std::uint32_t> index_;  // per vertex of the block: in the sheet
  std::map<std::uint32_t, bool> inside_;
  TriangleMesh sheet_;
  std::vector<std::uint32_t> chip_of_;
};

// Which chips do not part one small piece from one other piece, or are too small. `used` receives
// the chips that the cut has.
class Inspection {
 public:
  Inspection(const ChippedWalls& walls, std::size_t chips, const Complex& cut, std::int32_t crack, const Pieces& pieces)
      : between_(chips), pieces_(pieces) {
    const TriangleBvh tree(corners_of(walls.sheet()));
    for (std::uint32_t f = 0; f < cut.face_count(); ++f) {
      if (!cut.alive(FaceId(f)) || cut.face(FaceId(f)).crack != crack) continue;
      const auto c = cut.corners(FaceId(f));
      const auto chip = walls.chip_of()[tree.closest((c[0] + c[1] + c[2]) / 3).triangle];
      if (chip == ChippedWalls::none) continue;
      const auto sides = std::minmax(pieces.of_side[2 * f], pieces.of_side[2 * f + 1]);
      auto& pairs = between_[chip];
      if (std::find(pairs.begin(), pairs.end(), Pair(sides)) == pairs.end()) pairs.push_back(sides);
    }
  }

  // A flag for each chip that is wrong. A chip has a quarter of its piece's volume at most.
  std::vector<std::uint8_t> wrong(double least) const {
    constexpr double largest_share = 0.25;
    std::vector<std::uint8_t> flags(between_.size());
    UnionFind joined(pieces_.count);
    for (std::size_t chip = 0; chip < between_.size(); ++chip) {
      const auto& pairs = between_[chip];
      bool right = pairs.size() == 1 && pairs[0].first != pairs[0].second;
      if (right) {
        const auto a = static_cast<std::uint32_t>(pairs[0].first), b = static_cast<std::uint32_t>(pairs[0].second);
        const double small = std::min(pieces_.volume[a], pieces_.volume[b]);
        const double large = std::max(pieces_.volume[a], pieces_.volume[b]);
        right = small >= least && small <= largest_share * large && joined.find(a) != joined.find(b);
        if (right) joined.unite(a, b);
      }
      flags[chip] = !right;
    }
    return flags;
  }
  // Whether the cut has faces of a chip.
  bool has(std::size_t chip) const { return !between_[chip].empty(); }

 private:
  using Pair = std::pair<std::int32_t, std::int32_t>;
  std::vector<std::vector<Pair>> between_;  // per chip: pieces on both sides of its faces
  const Pieces& pieces_;
};

// How many chips are wanted, the least volume of one, and the pieces of the score alone.
struct ChipLimits {
  std::size_t wanted;
  double least;
  std::uint32_t pieces;
};

// Leaves out chips until all that are left are right, and not too many; returns their number. `cut`
// becomes the model cut along the sheet.
std::uint32_t keep_right_ones(ChippedWalls& chipped, std::size_t scoops, const ChipLimits& limits, const Complex& model,
                              Complex& cut, const std::function<void()>& pause) {
  const std::int32_t crack = CrackNumbers(model).next();
  for (;;) {
    pause();
    cut = model;
    insert_sheet(cut, chipped.sheet(), crack);
    const Pieces pieces = find_pieces(cut);
    const Inspection inspection(chipped, scoops, cut, crack, pieces);
    auto wrong = inspection.wrong(limits.least);
    std::size_t right = 0, bad = 0;
    for (std::size_t i = 0; i < scoops; ++i) {
      if (!wrong[i] && right == limits.wanted) wrong[i] = 1;
      if (!wrong[i]) ++right;
      if (wrong[i] && inspection.has(i)) ++bad;
    }
    if (bad == 0) return pieces.count == limits.pieces + right ? static_cast<std::uint32_t>(right) : 0;
    chipped.leave_out(wrong);
  }
}

}  // namespace

std::uint32_t add_chips(TriangleMesh& walls, const Complex& model, Complex& cut, const TriangleBvh& skin,
                        const ChipOptions& o, std::uint64_t seed, const std::function<void()>& pause) {
  if (o.count == 0) return 0;
  const Pieces before = find_pieces(cut);
  double volume = 0;
  for (const double v : before.volume) volume += v;
  const double length = o.size * cube_root(volume / before.count);
  const double least = o.least * 0.1 * std::pow(length / 2, 3);
  // Half more than wanted: some do not break off. All places have the same chance, so the first of
  // those that do are taken.
  const auto wanted = static_cast<std::size_t>(o.count);
  const auto edges = chip_edges(cut, CrackNumbers(model).next(), before);
  const auto scoops = place_scoops(edges, wanted + wanted / 2 + 4, length, seed);
  if (scoops.empty()) return 0;
  pause();
  try {
    ChippedWalls chipped(walls, scoops, skin, pause);
    Complex now;
    const ChipLimits limits{.wanted = wanted, .least = least, .pieces = before.count};
    const std::uint32_t made = keep_right_ones(chipped, scoops.size(), limits, model, now, pause);
    if (made == 0) return 0;
    walls = chipped.sheet();
    cut = std::move(now);
    return made;
  } catch (const GeometryError&) {
    return 0;  // the walls cannot be divided, and stay whole
  }
}

}  // namespace geo
