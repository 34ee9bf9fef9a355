// advance() of kerf/crack.h. One step of a crack: sweep, meet, split, classify, stitch, guard,
// commit (docs/design.md). A refused attempt is repeated with the new front displaced at random;
// the front's contacts follow from the vertices along the strip's new edges.
#include "kerf/crack.h"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>

#include "base/random.h"
#include "crack/insert.h"
#include "crack/near_edges.h"
#include "crack/specks.h"
#include "geometry/distance.h"
#include "geometry/predicates.h"
#include "kerf/error.h"
#include "kerf/progress.h"
#include "surface/delta_sum.h"
#include "surface/edit_group.h"

namespace geo {
namespace {

// Whether a vertex of K is on the sheet of a crack.
bool is_on_crack(const Complex& complex, VertexId v, std::int32_t crack) {
  const auto faces = complex.faces_at(v);
  return std::any_of(faces.begin(), faces.end(), [&](FaceId f) { return complex.face(f).crack == crack; });
}

// The vertices of K on a segment of a front from a to b, in order, if edges of K join them to each
// other, and to a and b where these are in K; else none. An end in the air is joined to none.
std::vector<VertexId> vertices_between(const Complex& complex, const FrontState::Point& a, const FrontState::Point& b,
                                       std::int32_t crack, double tolerance) {
  const Vec3 along = b.position - a.position;
  const double length = along.squaredNorm();
  std::vector<FaceId> near;
  Box3 box{a.position, a.position};
  box.add(b.position);
  complex.faces_near(box.grown(tolerance), near);
  std::vector<std::pair<double, VertexId>> between;
  for (const FaceId f : near)
    for (const VertexId v : complex.face(f).v) {
      const Vec3 w = complex.point(v) - a.position;
      const double t = w.dot(along) / length;
      if (v != a.id && v != b.id && t > 0 && t < 1 && (w - t * along).norm() <= tolerance) between.push_back({t, v});
    }
  std::sort(between.begin(), between.end());
  between.erase(std::unique(between.begin(), between.end()), between.end());
  std::vector<VertexId> chain;
  VertexId last = a.id;
  for (const auto& [t, v] : between) {
    const bool is_joined = last.valid() ? !complex.faces_around(last, v).empty() : is_on_crack(complex, v, crack);
    if (!is_joined) return {};
    chain.push_back(last = v);
  }
  if (b.id.valid() && last.valid() && complex.faces_around(last, b.id).empty()) return {};
  return chain;
}

// Another crack, or the front itself where it folds, may have divided the front's edges since the
// last step. Consecutive contacts that no edge of K joins are joined through the vertices that now
// lie between them; and so are a contact and a point in the air.
void update_contacts(FrontState& front, const Complex& complex) {
  // Far above rounding (2⁻⁵² ≈ 2e-16), far below a front segment. Vertices found count only where
  // edges of K join them.
  const double tolerance = 1e-12 * complex.extent().diagonal();
  for (auto& segment : front.segments) {
    std::vector<FrontState::Point> updated{segment.front()};
    for (std::size_t i = 1; i < segment.size(); ++i) {
      const auto &a = segment[i - 1], &b = segment[i];
      const bool are_in_k = a.id.valid() && b.id.valid();
      const bool may_lack = are_in_k ? a.id != b.id && complex.faces_around(a.id, b.id).empty()
                                     : front.has_moved && a.position != b.position;
      if (may_lack)
        for (const VertexId v : vertices_between(complex, a, b, front.crack, tolerance))
          updated.push_back({complex.point(v), v});
      updated.push_back(b);
    }
    segment = std::move(updated);
  }
}

using Chain = std::vector<crack::PointIndex>;

// Joins chains of points, of either direction, into one that starts at `from`.
Chain join_chains(std::vector<Chain>& chains, const Vec3& from, const crack::Points& points) {
  Chain joined;
  Vec3 end = from;
  for (bool found = true; found;) {
    found = false;
    for (auto& chain : chains) {
      if (chain.empty()) continue;
      if (points[chain.front()] != end && points[chain.back()] == end) std::reverse(chain.begin(), chain.end());
      if (points[chain.front()] != end) continue;
      joined.insert(joined.end(), chain.begin() + (joined.empty() ? 0 : 1), chain.end());
      end = points[chain.back()];
      chain.clear();
      found = true;
      break;
    }
  }
  return joined;
}

// Advances the front to the end of the step: each new segment lists the vertices of K on it, in
// order.
void advance_contacts(FrontState& front, const Complex& complex, const Strip& strip,
                      const crack::Arrangement& arrangement, const std::vector<VertexId>& vertex) {
  const std::size_t count = front.segments.size(), n = strip.new_front.size();
  // The strip edges that make up each new segment: one, or several where it was snapped to vertices
  // between its ends.
  std::vector<std::vector<Chain>> chains(count);
  for (std::uint32_t t = 0; t < arrangement.strip_size; ++t)
    for (int k = 0; k < 3; ++k)
      if (const int s = strip.triangles[t].segment[k]; s >= 0)
        chains[static_cast<std::size_t>(s)].push_back(arrangement.along_edge(t, k));
  std::vector<FrontState::Point> points;
  for (const Vec3& p : strip.new_front) points.push_back({p, VertexId()});
  for (std::size_t s = 0; s < count; ++s) {
    const Vec3 &p = strip.new_front[s], &q = strip.new_front[(s + 1) % n];
    if (chains[s].empty() && front.points[s].position == p && front.points[(s + 1) % n].position == q)
      continue;  // it did not move
    std::vector<FrontState::Point> segment;
    for (const auto l : join_chains(chains[s], p, arrangement.points()))
      if (l < vertex.size() && vertex[l].valid()) segment.push_back({complex.point(vertex[l]), vertex[l]});
    if (segment.empty() || segment.front().position != p) segment.insert(segment.begin(), {p, VertexId()});
    if (segment.back().position != q) segment.push_back({q, VertexId()});
    front.segments[s] = std::move(segment);
  }
  // A segment between two points at one place is on no strip edge: its neighbours know the vertex.
  for (std::size_t s = 0; s < count; ++s) {
    if (front.segments[s].front().id.valid()) points[s].id = front.segments[s].front().id;
    if (front.segments[s].back().id.valid()) points[(s + 1) % n].id = front.segments[s].back().id;
  }
  for (std::size_t s = 0; s < count; ++s) {
    if (points[s].position == points[(s + 1) % n].position) {
      const VertexId id = points[s].id.valid() ? points[s].id : points[(s + 1) % n].id;
      points[s].id = id;
      points[(s + 1) % n].id = id;
    }
    front.segments[s].front().id = points[s].id;
    front.segments[s].back().id = points[(s + 1) % n].id;
  }
  front.points = std::move(points);
}

// A point nearer to a face of K than 0.01 · distance moves away from it by `distance`, on its own
// side. Otherwise needles in the strip could not be rounded there. Points exactly on K stay.
Vec3 offset_from_faces(const Complex& complex, Vec3 p, double distance) {
  const double reach = 0.01 * distance;
  if (!Box3{p, p}.grown(reach).meets(complex.extent())) return p;
  std::vector<FaceId> near;
  complex.faces_near(Box3{p, p}.grown(reach), near);
  for (const FaceId f : near) {
    const auto t = complex.corners(f);
    if (segment_meets_triangle(p, p, t[0], t[1], t[2])) return p;
  }
  for (const FaceId f : near) {
    const auto t = complex.corners(f);
    const Vec3 n = (t[1] - t[0]).cross(t[2] - t[0]).normalized();
    const int side = orient3d(t[0], t[1], t[2], p);
    if (side != 0 && (closest_point_on_triangle(p, t[0], t[1], t[2]) - p).norm() < reach) p += side * distance * n;
  }
  return p;
}

// How far a strip snaps, and to which features of K.
struct Snapping {
  double reach;  // model units
  enum class To { vertices, vertices_and_edges } to;
  double thickness;                           // of specks, model units; see crack::find_specks()
  enum class Specks { refuse, join } specks;  // an attempt that cuts off specks fails, or joins them to the rest
};

struct Step {
  CrackDelta delta;
  FrontState front;
};

// Snaps the strip to vertices of K. To snap it to edges, divides them where the strip passes, and
// snaps to the new vertices. A strip that snaps has new edges, which may be near others. Appends
// what it changes in K to `deltas`; returns the number of vertices snapped to.
std::size_t snap(Strip& strip, Complex& complex, const Snapping& snapping, std::vector<CrackDelta>& deltas) {
  std::size_t count = snap_to_vertices(strip, complex, snapping.reach);
  if (snapping.to == Snapping::To::vertices) return count;
  // A round divides edges near those that the last one has made. Where these are not fewer, as in
  // a strip nearly in a sheet, each round would have several times as many: the rest stays near.
  constexpr int max_rounds = 3;
  std::size_t last = std::numeric_limits<std::size_t>::max();
  for (int round = 0; round < max_rounds; ++round) {
    const ComplexEdit edit = crack::divide_near_edges(complex, strip, snapping.reach);
    if (edit.empty() || edit.new_vertices.size() >= last) break;
    last = edit.new_vertices.size();
    deltas.push_back(complex.apply(edit));
    count += snap_to_vertices(strip, complex, snapping.reach);
  }
  return count;
}

// Joins the specks that a step has cut off to what is beside them: they lose a face of the crack.
// `deltas`: of the step so far, the insertion last; appends to them. Returns how many there are.
// Throws GeometryError where specks are refused.
std::size_t join_specks(Complex& complex, const Snapping& snapping, std::vector<CrackDelta>& deltas) {
  if (!(snapping.thickness > 0)) return 0;
  const std::size_t insertion = deltas.size() - 1;
  // Two specks that lie on each other are one after the first round.
  constexpr int max_rounds = 4;
  std::size_t joined = 0;
  for (int round = 0; round < max_rounds; ++round) {
    ComplexEdit edit;
    edit.removed_faces = crack::find_specks(complex, deltas[insertion], snapping.thickness);
    if (edit.empty()) break;
    if (snapping.specks == Snapping::Specks::refuse) throw GeometryError("a speck would come off");
    joined += edit.removed_faces.size();
    deltas.push_back(complex.apply(edit));
  }
  return joined;
}

// The changes of consecutive edits, at least one, as those of one.
CrackDelta joined(std::vector<CrackDelta> deltas) {
  if (deltas.size() == 1) return std::move(deltas[0]);
  DeltaSum sum;
  for (const CrackDelta& delta : deltas) sum.add(delta);
  return sum.sum();
}

// One attempt. Throws GeometryError, K unchanged, when the guard refuses it.
Step try_step(Complex& complex, const FrontState& front, const std::vector<Vec3>& next, const Snapping& snapping,
              double clearance, CrackStats& stats) {
  Stopwatch watch;
  Step result{{}, front};
  Strip strip = sweep(front, next);
  std::vector<CrackDelta> deltas;
  Complex::EditGroup edits(complex);
  stats.snapped += snap(strip, complex, snapping, deltas);
  stats.near_seconds += watch.lap();
  crack::Arrangement arrangement(complex, strip);
  std::vector<VertexId> vertex;
  const bool is_divided = !deltas.empty();
  deltas.push_back(crack::insert_strip(complex, strip, arrangement, front.crack, vertex, clearance, stats));
  if (is_divided && deltas.back().empty()) throw GeometryError("edges are divided where nothing is cut");
  stats.joined_specks += join_specks(complex, snapping, deltas);
  const bool is_sum = deltas.size() > 1;
  result.delta = joined(std::move(deltas));
  // Else K would keep the numbers of what came and went, and who follows it would not know.
  if (is_sum && result.delta.empty()) throw GeometryError("nothing but specks would come off");
  watch.lap();
  advance_contacts(result.front, complex, strip, arrangement, vertex);
  stats.stitch_seconds += watch.lap();
  edits.keep();
  return result;
}

// Displaces a point by up to `jitter`.
Vec3 displaced(const Vec3& p, double jitter, Random& random) {
  const Vec3 direction = random.direction();
  return p + random.uniform(0.2, 1.0) * jitter * direction;
}

// Displaces the points of a front that has not made a step yet and its new position, for a repeated
// attempt.
void displace_front(FrontState& front, std::vector<Vec3>& target, double jitter, Random& random) {
  const bool first = !front.has_moved;
  for (std::size_t i = 0; i < target.size(); ++i)
    if (target[i] != front.points[i].position || first) target[i] = displaced(target[i], jitter, random);
  if (!first) return;
  for (auto& segment : front.segments)
    for (auto& p : segment)
      if (!p.id.valid()) p.position = displaced(p.position, jitter, random);
  for (std::size_t s = 0; s < front.segments.size(); ++s) {
    front.points[s].position = front.segments[s].front().position;
    const std::size_t end = (s + 1) % front.points.size();
    if (s + 1 < front.segments.size() || front.closed)
      front.segments[(s + 1) % front.segments.size()].front().position = front.segments[s].back().position;
    front.points[end].position = front.segments[s].back().position;
  }
}

// The shares of the way that attempts to snap to edges go. A shorter step is in the plane of the
// blade, while a displaced front leaves it: the sheet would be folded by less than nodes resolve.
constexpr std::array<double, 4> shorter_ways = {1, 0.83, 0.71, 0.59};

std::vector<Vec3> shortened(const FrontState& front, const std::vector<Vec3>& next, double share) {
  if (share == 1) return next;
  std::vector<Vec3> target;
  for (std::size_t i = 0; i < next.size(); ++i) {
    const Vec3& from = front.points[i].position;
    target.push_back(next[i] == from ? from : Vec3(from + share * (next[i] - from)));
  }
  return target;
}

// The front as the step starts: contacts updated, and before the first step its free points off the
// faces of K.
FrontState prepared(const FrontState& front, const Complex& complex, double face_offset) {
  FrontState old = front;
  update_contacts(old, complex);
  if (!front.has_moved)
    for (auto& segment : old.segments)
      for (auto& p : segment)
        if (!p.id.valid()) p.position = offset_from_faces(complex, p.position, face_offset);
  for (std::size_t s = 0; s < old.segments.size(); ++s) {
    old.points[s].position = old.segments[s].front().position;
    old.points[(s + 1) % old.points.size()].position = old.segments[s].back().position;
  }
  return old;
}

}  // namespace

CrackStats& CrackStats::operator+=(const CrackStats& o) {
  faces_near += o.faces_near;
  triangles_cut += o.triangles_cut;
  new_crack_faces += o.new_crack_faces;
  attempts += o.attempts;
  snapped += o.snapped;
  repairs += o.repairs;
  joined_specks += o.joined_specks;
  near_seconds += o.near_seconds;
  meet_seconds += o.meet_seconds;
  split_seconds += o.split_seconds;
  keep_seconds += o.keep_seconds;
  stitch_seconds += o.stitch_seconds;
  guard_seconds += o.guard_seconds;
  return *this;
}

double CrackStats::seconds() const {
  return near_seconds + meet_seconds + split_seconds + keep_seconds + stitch_seconds + guard_seconds;
}

FrontState begin_front(std::span<const Vec3> points, bool closed, std::int32_t crack) {
  if (points.size() < 2) throw InputError("a front needs at least two points");
  if (closed && points.size() < 3) throw InputError("a closed front needs at least three points");
  if (crack < 1) throw InputError("cracks are numbered from 1");
  for (const Vec3& p : points)
    if (!p.allFinite()) throw InputError("a front point has a coordinate that is not a finite number");
  FrontState front;
  front.closed = closed;
  front.crack = crack;
  for (const Vec3& p : points) front.points.push_back({p, VertexId()});
  for (std::size_t i = 0; i + (closed ? 0 : 1) < points.size(); ++i)
    front.segments.push_back({front.points[i], front.points[(i + 1) % points.size()]});
  return front;
}

CrackDelta advance(Complex& complex, FrontState& front, std::span<const Vec3> next, const CrackOptions& options,
                   CrackStats* stats) {
  if (next.size() != front.points.size())
    throw InputError("the front has " + std::to_string(front.points.size()) + " points and its next position " +
                     std::to_string(next.size()));
  for (const Vec3& p : next)
    if (!p.allFinite()) throw InputError("a front point has a coordinate that is not a finite number");
  const double size = complex.extent().diagonal();
  const FrontState old = prepared(front, complex, options.face_offset * size);
  CrackStats done;
  std::string reason;
  // 2⁶⁴ / golden ratio spreads consecutive seeds; each step has its own displacements.
  Random random(options.seed * 0x9e3779b97f4a7c15ull + front.step);
  std::vector<Vec3> offset_next(next.begin(), next.end());
  for (std::size_t i = 0; i < offset_next.size(); ++i)
    if (offset_next[i] != old.points[i].position)
      offset_next[i] = offset_from_faces(complex, offset_next[i], options.face_offset * size);
  const auto attempt = [&](const FrontState& from, const std::vector<Vec3>& target, const Snapping& snapping,
                           double clearance) -> std::optional<CrackDelta> {
    ++done.attempts;
    try {
      Step result = try_step(complex, from, target, snapping, clearance, done);
      result.front.has_moved = true;
      ++result.front.step;
      front = std::move(result.front);
      if (stats) *stats += done;
      return std::move(result.delta);
    } catch (const GeometryError& e) {
      reason = e.what();
      return {};
    }
  };
  const double thickness = options.snap_edges * size;
  if (options.snap_edges > 0) {
    Snapping to_edges{.reach = std::max(options.snap, options.snap_edges) * size,
                      .to = Snapping::To::vertices_and_edges,
                      .thickness = thickness,
                      .specks = Snapping::Specks::refuse};
    for (const double share : shorter_ways)
      if (auto delta = attempt(old, shortened(old, offset_next, share), to_edges, options.clearance * size))
        return std::move(*delta);
    to_edges.specks = Snapping::Specks::join;
    if (auto delta = attempt(old, offset_next, to_edges, options.clearance * size)) return std::move(*delta);
  }
  for (int number = 0; number <= options.attempts; ++number) {
    const auto [jitter, clearance] = crack::attempt_at(number, options, size);
    const Snapping to_vertices{.reach = options.snap * size,
                               .to = Snapping::To::vertices,
                               .thickness = thickness,
                               .specks = Snapping::Specks::join};
    std::vector<Vec3> target = offset_next;
    FrontState from = old;
    if (number > 0) displace_front(from, target, jitter, random);
    if (auto delta = attempt(from, target, to_vertices, clearance)) return std::move(*delta);
  }
  if (stats) *stats += done;
  throw GeometryError("step " + std::to_string(front.step + 1) + " of the front cannot be made: " + reason);
}

}  // namespace geo
