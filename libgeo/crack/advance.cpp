// One step of a crack, as docs/design.md tells it: sweep, meet, split, keep, guard, stitch.
#include "kerf/crack.h"

#include <algorithm>

#include "base/random.h"
#include "crack/insert.h"
#include "geometry/distance.h"
#include "geometry/predicates.h"
#include "kerf/error.h"
#include "kerf/progress.h"

namespace geo {
namespace {

// Another crack may have divided the front's edges since: consecutive contacts that K joins no
// longer are joined again through the vertices that now lie between them.
void renew_contacts(FrontState& front, const Complex& complex) {
  const double reach = 1e-12 * complex.extent().diagonal();
  for (auto& segment : front.segments) {
    std::vector<FrontState::Point> renewed{segment.front()};
    for (std::size_t i = 1; i < segment.size(); ++i) {
      const auto &a = segment[i - 1], &b = segment[i];
      if (a.id.valid() && b.id.valid() && a.id != b.id && complex.faces_around(a.id, b.id).empty()) {
        const Vec3 along = b.position - a.position;
        const double length = along.squaredNorm();
        std::vector<FaceId> near;
        Box3 box{a.position, a.position};
        box.add(b.position);
        complex.faces_near(box.grown(reach), near);
        std::vector<std::pair<double, VertexId>> between;
        for (const FaceId f : near)
          for (const VertexId v : complex.face(f).v) {
            const Vec3 w = complex.point(v) - a.position;
            const double t = w.dot(along) / length;
            if (v != a.id && v != b.id && t > 0 && t < 1 && (w - t * along).norm() <= reach) between.push_back({t, v});
          }
        std::sort(between.begin(), between.end());
        between.erase(std::unique(between.begin(), between.end()), between.end());
        bool joined = true;
        VertexId last = a.id;
        for (const auto& [t, v] : between) joined = joined && !complex.faces_around(last, v).empty(), last = v;
        if (joined && !between.empty() && !complex.faces_around(last, b.id).empty())
          for (const auto& [t, v] : between) renewed.push_back({complex.point(v), v});
      }
      renewed.push_back(b);
    }
    segment = std::move(renewed);
  }
}

// The front after the step: the points of K that lie on each new segment, in order.
void follow_front(FrontState& front, const Complex& complex, const Strip& strip, const crack::Arrangement& arrangement,
                  const std::vector<VertexId>& vertex) {
  const std::size_t count = front.segments.size(), n = strip.next.size();
  // The strip edges that make up each new segment: one, or several where it was snapped to vertices
  // between its ends.
  std::vector<std::vector<std::vector<crack::Local>>> rows(count);
  for (std::uint32_t t = 0; t < arrangement.strip_size; ++t)
    for (int k = 0; k < 3; ++k)
      if (const int s = strip.triangles[t].segment[k]; s >= 0)
        rows[static_cast<std::size_t>(s)].push_back(arrangement.along_edge(t, k));
  std::vector<FrontState::Point> points;
  for (const Vec3& p : strip.next) points.push_back({p, VertexId()});
  for (std::size_t s = 0; s < count; ++s) {
    const Vec3 &p = strip.next[s], &q = strip.next[(s + 1) % n];
    if (rows[s].empty() && front.points[s].position == p && front.points[(s + 1) % n].position == q)
      continue;  // stood still
    // Chained from p on; each row either way round.
    std::vector<crack::Local> chain;
    Vec3 end = p;
    for (bool found = true; found;) {
      found = false;
      for (auto& row : rows[s]) {
        if (row.empty()) continue;
        if (arrangement.points()[row.front()] != end && arrangement.points()[row.back()] == end)
          std::reverse(row.begin(), row.end());
        if (arrangement.points()[row.front()] != end) continue;
        chain.insert(chain.end(), row.begin() + (chain.empty() ? 0 : 1), row.end());
        end = arrangement.points()[row.back()];
        row.clear();
        found = true;
        break;
      }
    }
    std::vector<FrontState::Point> segment;
    for (const auto l : chain)
      if (l < vertex.size() && vertex[l].valid()) segment.push_back({complex.point(vertex[l]), vertex[l]});
    if (segment.empty() || segment.front().position != p) segment.insert(segment.begin(), {p, VertexId()});
    if (segment.back().position != q) segment.push_back({q, VertexId()});
    front.segments[s] = std::move(segment);
  }
  for (std::size_t s = 0; s < count; ++s) {
    points[s].id = front.segments[s].front().id;
    if (front.segments[s].back().id.valid()) points[(s + 1) % n].id = front.segments[s].back().id;
  }
  front.points = std::move(points);
}

// A point beside a face of K, neither on it nor clear of it, would make needles that cannot be
// rounded: it is moved clear, to the side that it is on. Points that are exactly on K stay.
Vec3 clear_of_faces(const Complex& complex, Vec3 p, double distance) {
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

struct Step {
  CrackDelta delta;
  FrontState front;
};

Step try_step(Complex& complex, const FrontState& front, const std::vector<Vec3>& next, double reach, double clearance,
              CrackStats& work) {
  Stopwatch watch;
  Step result{{}, front};
  Strip strip = sweep(front, next);
  work.snapped += snap_to_vertices(strip, complex, reach);
  work.near_seconds += watch.lap();
  crack::Arrangement arrangement(complex, strip);
  std::vector<VertexId> vertex;
  result.delta = crack::insert_strip(complex, strip, arrangement, front.crack, vertex, clearance, work);
  watch.lap();
  follow_front(result.front, complex, strip, arrangement, vertex);
  work.stitch_seconds += watch.lap();
  return result;
}

}  // namespace

CrackStats& CrackStats::operator+=(const CrackStats& o) {
  faces_near += o.faces_near, triangles_cut += o.triangles_cut, new_crack_faces += o.new_crack_faces;
  attempts += o.attempts, snapped += o.snapped, repairs += o.repairs;
  near_seconds += o.near_seconds, meet_seconds += o.meet_seconds, split_seconds += o.split_seconds;
  keep_seconds += o.keep_seconds, stitch_seconds += o.stitch_seconds, guard_seconds += o.guard_seconds;
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
                   CrackStats* work) {
  if (next.size() != front.points.size())
    throw InputError("the front has " + std::to_string(front.points.size()) + " points and its next position " +
                     std::to_string(next.size()));
  for (const Vec3& p : next)
    if (!p.allFinite()) throw InputError("a front point has a coordinate that is not a finite number");
  const double size = complex.extent().diagonal();
  FrontState old = front;
  renew_contacts(old, complex);
  if (front.step == 0)
    for (auto& segment : old.segments)
      for (auto& p : segment)
        if (!p.id.valid()) p.position = clear_of_faces(complex, p.position, options.face_offset * size);
  for (std::size_t s = 0; s < old.segments.size(); ++s) {
    old.points[s].position = old.segments[s].front().position;
    old.points[(s + 1) % old.points.size()].position = old.segments[s].back().position;
  }
  CrackStats done;
  std::string reason;
  Random random(options.seed * 0x9e3779b97f4a7c15ull + front.step);
  std::vector<Vec3> wanted(next.begin(), next.end());
  for (std::size_t i = 0; i < wanted.size(); ++i)
    if (wanted[i] != old.points[i].position) wanted[i] = clear_of_faces(complex, wanted[i], options.face_offset * size);
  for (int attempt = 0; attempt <= options.attempts; ++attempt) {
    const crack::Attempt allowed = crack::attempt_at(attempt, options, size);
    std::vector<Vec3> target = wanted;
    FrontState from = old;
    if (attempt > 0) {
      const auto moved = [&](const Vec3& p) {
        return Vec3(p + random.uniform(0.2, 1.0) * allowed.jitter * random.direction());
      };
      for (std::size_t i = 0; i < target.size(); ++i)
        if (target[i] != old.points[i].position || front.step == 0) target[i] = moved(target[i]);
      if (front.step == 0)
        for (auto& segment : from.segments)
          for (auto& p : segment)
            if (!p.id.valid()) p.position = moved(p.position);
      if (front.step == 0)
        for (std::size_t s = 0; s < from.segments.size(); ++s) {
          from.points[s].position = from.segments[s].front().position;
          const std::size_t end = (s + 1) % from.points.size();
          if (s + 1 < from.segments.size() || from.closed)
            from.segments[(s + 1) % from.segments.size()].front().position = from.segments[s].back().position;
          from.points[end].position = from.segments[s].back().position;
        }
    }
    ++done.attempts;
    try {
      Step result = try_step(complex, from, target, options.snap * size, allowed.clearance, done);
      ++result.front.step;
      front = std::move(result.front);
      if (work) *work += done;
      return std::move(result.delta);
    } catch (const GeometryError& e) {
      reason = e.what();
    }
  }
  if (work) *work += done;
  throw GeometryError("step " + std::to_string(front.step + 1) + " of the front cannot be made: " + reason);
}

}  // namespace geo
