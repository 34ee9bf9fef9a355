// Two triangles in different planes share at most a segment. Its ends follow from signs of orient3d
// alone (compare Guigue and Devillers 2003); coplanar triangles are clipped edge by edge. Pairs
// come from the lists of near faces, and for the strip with itself from their boxes.
#include "crack/arrangement.h"

#include <algorithm>

#include "geometry/box_pairs.h"
#include "geometry/predicates.h"
#include "kerf/error.h"

namespace geo::crack {
namespace {

std::uint64_t edge_key(PointIndex a, PointIndex b) { return std::uint64_t(std::min(a, b)) << 32 | std::max(a, b); }

// The side of plane t on which p lies; 0 without a predicate where p is a corner.
int side_of(const Vec3 (&t)[3], const Vec3& p) {
  if (const int side = orient3d_filtered(t[0], t[1], t[2], p); side != 2) return side;
  if (p == t[0] || p == t[1] || p == t[2]) return 0;
  return orient3d(t[0], t[1], t[2], p);
}

}  // namespace

Arrangement::Arrangement(const Complex& complex, const Strip& strip, Pause pause)
    : complex_(complex), strip_(strip), pause_(std::move(pause)), triangulator_(points_) {
  points_.reserve(strip.points.size() * 8 + 64);
  for (const Vec3& p : strip.points) {
    const PointIndex l = points_.add(p);
    if (auto& first = strip_points_[hash_of(p)]; first == no_point) first = l;
  }
  elements.reserve(strip.triangles.size() * 4);
  for (const auto& t : strip.triangles) {
    Element e;
    e.corner = {t.p[0], t.p[1], t.p[2]};
    elements.push_back(e);
  }
  strip_size = static_cast<std::uint32_t>(elements.size());
  ids_.resize(points_.size());
}

PointIndex Arrangement::point_of(VertexId v) {
  std::uint32_t& point = by_id_[v.value];
  if (point != no_point) return point;
  const Vec3& p = complex_.point(v);
  const PointIndex same = strip_points_.find(hash_of(p));
  point = same != no_point && points_[same] == p ? same : points_.add(p);
  if (ids_.size() < points_.size()) ids_.resize(points_.size());
  ids_[point] = v;
  return point;
}

void Arrangement::meet(CrackStats& stats) {
  divisions_.reserve(8 * strip_size);
  for (std::uint32_t s = 0; s < strip_size; ++s) {
    pause_before(s, pause_);
    meet_faces(s, stats);
  }
  meet_itself();
}

Arrangement::Corners Arrangement::corners_of(std::uint32_t s) const {
  const auto& p = strip_.triangles[s].p;
  return {{strip_.points[p[0]], strip_.points[p[1]], strip_.points[p[2]]}};
}

// Intersects strip triangle s with the faces of K near it. Faces that it meets become elements.
void Arrangement::meet_faces(std::uint32_t s, CrackStats& stats) {
  const auto near = this->near(s);
  stats.faces_near += near.size();
  const auto mine = corners_of(s);
  for (const FaceId f : near) {
    const auto c = complex_.corners(f);
    const Vec3 theirs[3] = {c[0], c[1], c[2]};
    Signs sign;
    if (!signs_of(theirs, mine.p, sign)) continue;
    std::uint32_t e = by_face_.find(f.value);
    const bool known = e != ~0u;
    if (!known) {
      e = static_cast<std::uint32_t>(elements.size());
      Element element;
      for (int k = 0; k < 3; ++k) element.corner[k] = point_of(complex_.face(f).v[k]);
      element.face = f;
      elements.push_back(element);
    }
    meet_pair(e, s, sign);
    if (known) continue;
    if (shared_.empty())
      elements.pop_back();  // disjoint after all
    else
      by_face_[f.value] = e;
  }
}

// Intersects the strip with itself: a sweep may cross itself or fold back. Pairs are in ascending
// order along x, which decides the numbers of points.
void Arrangement::meet_itself() {
  std::vector<Box3> boxes;
  for (const auto& t : strip_.triangles)
    boxes.push_back(box_of(strip_.points[t.p[0]], strip_.points[t.p[1]], strip_.points[t.p[2]]));
  const PauseOfThread pause_here(pause_);
  const auto keep_meeting = [&](AabbTree::Pairs& pairs) {
    pause_here();
    std::erase_if(pairs, [&](const auto& pair) {
      const auto s = corners_of(pair.first), t = corners_of(pair.second);
      Signs sign;
      return share_corners_only(s.p, t.p) || !signs_of(s.p, t.p, sign);
    });
  };
  const auto before = [&](std::uint32_t i, std::uint32_t j) {
    const double x = boxes[i].lo.x(), y = boxes[j].lo.x();
    return x != y ? x < y : i < j;
  };
  auto pairs = meeting_pairs(boxes, keep_meeting);
  for (auto& [i, j] : pairs)
    if (before(j, i)) std::swap(i, j);
  std::sort(pairs.begin(), pairs.end(), [&](const auto& x, const auto& y) {
    return x.first != y.first ? before(x.first, y.first) : before(x.second, y.second);
  });
  const std::size_t divisions = divisions_.size();
  std::size_t met = 0;
  for (const auto& [i, j] : pairs) {
    pause_before(met++, pause_);
    const auto a = std::min(i, j), b = std::max(i, j);
    const auto s = corners_of(a), t = corners_of(b);
    Signs sign;
    signs_of(s.p, t.p, sign);
    meet_pair(a, b, sign);
    const bool coplanar = !coplanar_pairs_.empty() && coplanar_pairs_.back() == std::pair{a, b};
    meets_itself_ = meets_itself_ || coplanar;
  }
  meets_itself_ = meets_itself_ || divisions_.size() != divisions;
}

// Whether p, which lies in the element's plane, lies in the element: 1 or 0. `on`: bits of the
// edges on which it lies.
int Arrangement::locate_coplanar(std::uint32_t e, PointIndex p, std::uint8_t& on) const {
  const auto& c = elements[e].corner;
  on = 0;
  for (int k = 0; k < 3; ++k)
    if (c[k] == p) {
      on = corner_bits(k);
      return 1;
    }
  const auto [axis, turn] = projection_of(points_, c);
  for (int k = 0; k < 3; ++k) {
    const int s = turn * orient2d(points_[c[k]], points_[c[(k + 1) % 3]], points_[p], axis);
    if (s < 0) return 0;
    if (s == 0) on = static_cast<std::uint8_t>(on | 1 << k);
  }
  return 1;
}

// The key of the point where edges ab and cd cross, independent of the order of the arguments.
Arrangement::Key Arrangement::edge_edge(PointIndex a, PointIndex b, PointIndex c, PointIndex d) {
  const auto [low, high] = std::minmax({edge_key(a, b), edge_key(c, d)});
  return {low, high | 1ull << 63};  // no element has that number
}

// The point where edge `edge` of an element crosses the other one: inside it (other_edge −1), or on
// its edge `other_edge`.
PointIndex Arrangement::crossing(std::uint32_t edge_of, int edge, std::uint32_t other, int other_edge) {
  const auto &c = elements[edge_of].corner, &o = elements[other].corner;
  const PointIndex a = c[edge], b = c[(edge + 1) % 3];
  PointIndex& point =
      by_key_[other_edge < 0 ? Key{edge_key(a, b), other} : edge_edge(a, b, o[other_edge], o[(other_edge + 1) % 3])];
  // From the lower end to the higher one: the double must not depend on the element.
  if (point == no_point)
    point = points_.add_crossing(points_[std::min(a, b)], points_[std::max(a, b)], points_[o[0]], points_[o[1]],
                                 points_[o[2]]);
  return point;
}

// The point where two edges of coplanar elements cross.
PointIndex Arrangement::crossing_coplanar(std::uint32_t a, int edge_a, std::uint32_t b, int edge_b) {
  const auto &ca = elements[a].corner, &cb = elements[b].corner;
  PointIndex& point = by_key_[edge_edge(ca[edge_a], ca[(edge_a + 1) % 3], cb[edge_b], cb[(edge_b + 1) % 3])];
  if (point == no_point) {
    // As the crossing of edge a with a plane through edge b that is not the common plane.
    const int axis = projection_of(points_, ca).first;
    const Vec3 &c = points_[cb[edge_b]], &d = points_[cb[(edge_b + 1) % 3]];
    Vec3 r = c;
    r[axis] += std::abs(r[axis]) + (d - c).cwiseAbs().maxCoeff();
    point = points_.add_crossing(points_[ca[edge_a]], points_[ca[(edge_a + 1) % 3]], c, d, r);
  }
  return point;
}

// Adds a point shared by the pair. `on_mine` holds the edge bits in element `which` (0, 1) of the
// pair, `on_other` those in the other one.
void Arrangement::add_shared(PointIndex p, int which, std::uint8_t on_mine, std::uint8_t on_other) {
  for (SharedPoint& s : shared_)
    if (s.point == p) {
      s.on[which] |= on_mine;
      s.on[1 - which] |= on_other;
      return;
    }
  SharedPoint shared{p, {}};
  shared.on[which] = on_mine;
  shared.on[1 - which] = on_other;
  shared_.push_back(shared);
}

// Enters the shared points as divisions of element e, the first or second of the pair.
void Arrangement::divide(std::uint32_t e, int which) {
  const auto& c = elements[e].corner;
  for (const SharedPoint& s : shared_)
    if (s.point != c[0] && s.point != c[1] && s.point != c[2])
      divisions_.push_back({.element = e, .a = s.point, .b = no_point, .edges = s.on[which]});
}

// The sides of the corners of s against the plane of t, and vice versa; false when one is clear of
// the other's plane.
bool Arrangement::signs_of(const Vec3 (&s)[3], const Vec3 (&t)[3], Signs& sign) const {
  for (int k = 0; k < 3; ++k) sign[0][k] = side_of(t, s[k]);
  if (sign[0][0] != 0 && sign[0][0] == sign[0][1] && sign[0][0] == sign[0][2]) return false;
  for (int k = 0; k < 3; ++k) sign[1][k] = side_of(s, t[k]);
  return sign[1][0] == 0 || sign[1][0] != sign[1][1] || sign[1][0] != sign[1][2];
}

// Intersects two elements whose corners have these sides against each other's plane.
void Arrangement::meet_pair(std::uint32_t a, std::uint32_t b, const Signs& sign) {
  shared_.clear();
  const std::uint32_t element[2] = {a, b};
  if (sign[0][0] == 0 && sign[0][1] == 0 && sign[0][2] == 0) return meet_coplanar(a, b);
  for (int i = 0; i < 2; ++i)
    for (int k = 0; k < 3; ++k) {
      if (sign[i][k] == 0) meet_corner(element[i], element[1 - i], k, i);
      if (sign[i][k] * sign[i][(k + 1) % 3] < 0) meet_edge(element[i], element[1 - i], k, i);
    }
  if (shared_.size() > 2) throw GeometryError("two triangles meet in more than a segment");
  for (int i = 0; i < 2; ++i) {
    divide(element[i], i);
    if (shared_.size() == 2 && !(shared_[0].on[i] & shared_[1].on[i]))
      divisions_.push_back({.element = element[i], .a = shared_[0].point, .b = shared_[1].point, .edges = 0});
  }
}

// Corner k of an element, which lies in the other one's plane.
void Arrangement::meet_corner(std::uint32_t mine, std::uint32_t other, int k, int which) {
  std::uint8_t on = 0;
  const PointIndex corner = elements[mine].corner[k];
  if (locate_coplanar(other, corner, on)) add_shared(corner, which, corner_bits(k), on);
}

// Edge k of an element, which crosses the other one's plane: inside the other one, on an edge or at
// a corner of it.
void Arrangement::meet_edge(std::uint32_t mine, std::uint32_t other, int k, int which) {
  const auto m = elements[mine].corner, o = elements[other].corner;
  const Vec3 &from = points_[m[k]], &to = points_[m[(k + 1) % 3]];
  int turn[3], up = 0, down = 0;
  for (int j = 0; j < 3; ++j) {
    turn[j] = geo::orient3d(from, to, points_[o[j]], points_[o[(j + 1) % 3]]);
    up += turn[j] > 0;
    down += turn[j] < 0;
  }
  if (up > 0 && down > 0) return;
  const auto on_mine = static_cast<std::uint8_t>(1 << k);
  if (up + down == 3) {
    add_shared(crossing(mine, k, other, -1), which, on_mine, 0);
  } else if (up + down == 2) {
    const int edge = turn[0] == 0 ? 0 : turn[1] == 0 ? 1 : 2;
    add_shared(crossing(mine, k, other, edge), which, on_mine, static_cast<std::uint8_t>(1 << edge));
  } else {
    const int corner = turn[0] != 0 ? 2 : turn[1] != 0 ? 0 : 1;  // where the two edges with turn 0 meet
    add_shared(o[corner], which, on_mine, corner_bits(corner));
  }
}

void Arrangement::meet_coplanar(std::uint32_t a, std::uint32_t b) {
  const std::uint32_t element[2] = {a, b};
  const auto &ca = elements[a].corner, &cb = elements[b].corner;
  for (int k = 0; k < 3; ++k) {
    std::uint8_t on = 0;
    if (locate_coplanar(b, ca[k], on)) add_shared(ca[k], 0, corner_bits(k), on);
    if (locate_coplanar(a, cb[k], on)) add_shared(cb[k], 1, corner_bits(k), on);
  }
  const auto [axis, turn] = projection_of(points_, ca);
  const auto side = [&, axis = axis](PointIndex p, PointIndex q, PointIndex r) {
    return p == r || q == r ? 0 : orient2d(points_[p], points_[q], points_[r], axis);
  };
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const PointIndex p = ca[i], q = ca[(i + 1) % 3], r = cb[j], s = cb[(j + 1) % 3];
      if (side(p, q, r) * side(p, q, s) < 0 && side(r, s, p) * side(r, s, q) < 0)
        add_shared(crossing_coplanar(a, i, b, j), 0, static_cast<std::uint8_t>(1 << i),
                   static_cast<std::uint8_t>(1 << j));
    }
  for (int i = 0; i < 2; ++i) {
    divide(element[i], i);
    // Each edge of the other element, as far as it runs through this one.
    for (int k = 0; k < 3; ++k) {
      const SharedPoint *from = nullptr, *to = nullptr;
      for (const SharedPoint& s : shared_)
        if (s.on[1 - i] & 1 << k) (from ? to : from) = &s;
      if (from && to && !(from->on[i] & to->on[i]))
        divisions_.push_back({.element = element[i], .a = from->point, .b = to->point, .edges = 0});
    }
  }
  if (shared_.size() >= 3) coplanar_pairs_.push_back(a < strip_size ? std::pair{a, b} : std::pair{b, a});
}

// The index by which the position of point l is known; l itself for a new position.
PointIndex Arrangement::canonical_point(PointIndex l) {
  auto& there = by_position_[points_.hash(l)];
  for (const PointIndex other : there)
    if (points_.coincide(other, l)) return other;
  there.push_back(l);
  if (ids_.size() < points_.size()) ids_.resize(points_.size());
  return l;
}

// Gives each position one index, whichever edges and faces define it.
void Arrangement::merge_coinciding_points() {
  std::vector<PointIndex> canonical(points_.size());
  for (PointIndex l = 0; l < canonical.size(); ++l) canonical[l] = canonical_point(l);
  for (auto& d : divisions_) {
    d.a = canonical[d.a];
    if (d.b != no_point) d.b = canonical[d.b];
  }
}

// Collects the Steiner points and constraints of element e from divisions_[at..]; returns the end
// of its divisions. A point named by several divisions is entered once, with the union of their
// edge bits.
std::size_t Arrangement::collect_divisions(std::uint32_t e, std::size_t at) {
  const auto& corner = elements[e].corner;
  constraints_.clear();
  for (; at < divisions_.size() && divisions_[at].element == e; ++at) {
    const Division& d = divisions_[at];
    if (d.b == no_point) {
      if (d.a == corner[0] || d.a == corner[1] || d.a == corner[2]) continue;
      if (steiner_.size() > steiner_begin_[e] && steiner_.back().point == d.a)
        steiner_.back().edges |= d.edges;
      else
        steiner_.push_back({d.a, d.edges});
    } else if (d.a != d.b) {
      constraints_.push_back({d.a, d.b});
    }
  }
  return at;
}

void Arrangement::split() {
  ids_.resize(points_.size());
  children.reserve(elements.size() + 2 * divisions_.size());
  steiner_.reserve(divisions_.size());
  if (meets_itself_) merge_coinciding_points();
  for (std::size_t i = 0, n = coplanar_pairs_.size(); i < n; ++i)
    coplanar_pairs_.push_back({coplanar_pairs_[i].second, coplanar_pairs_[i].first});
  std::sort(coplanar_pairs_.begin(), coplanar_pairs_.end());
  std::stable_sort(divisions_.begin(), divisions_.end(), [](const Division& x, const Division& y) {
    return x.element != y.element                   ? x.element < y.element
           : (x.b == no_point) != (y.b == no_point) ? x.b == no_point
           : x.b == no_point                        ? x.a < y.a
                                                    : false;
  });
  steiner_begin_.assign(elements.size() + 1, 0);
  Triangulator::Canonicalize canonicalize;
  if (meets_itself_) canonicalize = [this](PointIndex l) { return canonical_point(l); };
  std::size_t at = 0;
  for (std::uint32_t i = 0; i < elements.size(); ++i) {
    pause_before(i, pause_);
    Element& e = elements[i];
    steiner_begin_[i] = static_cast<std::uint32_t>(steiner_.size());
    at = collect_divisions(i, at);
    e.first = static_cast<std::uint32_t>(children.size());
    e.cut = steiner_.size() > steiner_begin_[i];
    if (e.cut)
      triangulator_.triangulate(e.corner, {steiner_.data() + steiner_begin_[i], steiner_.size() - steiner_begin_[i]},
                                constraints_, canonicalize, children);
    else
      children.push_back({e.corner, {0, 1, 2}});
    e.end = static_cast<std::uint32_t>(children.size());
  }
  steiner_begin_.back() = static_cast<std::uint32_t>(steiner_.size());
  ids_.resize(points_.size());
}

bool Arrangement::lies_on_other(std::uint32_t e, const Child& c) const {
  for (auto pair = std::lower_bound(coplanar_pairs_.begin(), coplanar_pairs_.end(), std::pair{e, 0u});
       pair != coplanar_pairs_.end() && pair->first == e; ++pair) {
    const std::uint32_t that = pair->second;
    if (that < strip_size && that > e) continue;
    const auto& o = elements[that].corner;
    const auto [axis, turn] = projection_of(points_, o);
    bool inside = true;
    for (int k = 0; k < 3; ++k)
      for (const PointIndex p : c.v) {
        const PointIndex a = o[k], b = o[(k + 1) % 3];
        inside = inside && (p == a || p == b || turn * points_.orient2d(a, b, p, axis) >= 0);
      }
    if (inside) return true;
  }
  return false;
}

std::vector<PointIndex> Arrangement::along_edge(std::uint32_t e, int k) const {
  const PointIndex from = elements[e].corner[k], to = elements[e].corner[(k + 1) % 3];
  std::vector<PointIndex> chain;
  for (auto m = steiner_begin_[e]; m < steiner_begin_[e + 1]; ++m)
    if (steiner_[m].edges & 1 << k) chain.push_back(steiner_[m].point);
  int along = 0;
  (points_[to] - points_[from]).cwiseAbs().maxCoeff(&along);
  const int up = points_.compare(to, from, along);
  std::sort(chain.begin(), chain.end(),
            [&](PointIndex a, PointIndex b) { return a != b && points_.compare(a, b, along) == -up; });
  chain.insert(chain.begin(), from);
  chain.push_back(to);
  return chain;
}

}  // namespace geo::crack
