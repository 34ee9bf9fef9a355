#include "crack/arrangement.h"

#include <algorithm>
#include <numeric>

#include "geometry/predicates.h"
#include "kerf/error.h"

namespace geo::crack {
namespace {

std::uint64_t edge_key(Local a, Local b) { return std::uint64_t(std::min(a, b)) << 32 | std::max(a, b); }

// The side of plane abc that p is on; 0 without asking where p is one of the three.
int side_of(const Vec3 (&t)[3], const Vec3& p) {
  if (const int side = orient3d_filtered(t[0], t[1], t[2], p); side != 2) return side;
  if (p == t[0] || p == t[1] || p == t[2]) return 0;
  return orient3d(t[0], t[1], t[2], p);
}

}  // namespace

Arrangement::Arrangement(const Complex& complex, const Strip& strip)
    : complex_(complex), strip_(strip), triangulator_(points_) {
  points_.reserve(strip.points.size() * 8 + 64);
  for (const Vec3& p : strip.points) {
    const Local l = points_.add(p);
    if (auto& row = strip_places_[hash_of(p)]; row == no_local) row = l;
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

Local Arrangement::local_of(VertexId v) {
  std::uint32_t& row = by_id_[v.value];
  if (row != no_local) return row;
  const Vec3& p = complex_.point(v);
  const Local same = strip_places_.find(hash_of(p));
  row = same != no_local && points_[same] == p ? same : points_.add(p);
  if (ids_.size() < points_.size()) ids_.resize(points_.size());
  ids_[row] = v;
  return row;
}

void Arrangement::meet(CrackStats& work) {
  shared_.reserve(8 * strip_size);
  std::vector<Box3> boxes;
  for (const auto& t : strip_.triangles)
    boxes.push_back(box_of(strip_.points[t.p[0]], strip_.points[t.p[1]], strip_.points[t.p[2]]));
  for (std::uint32_t s = 0; s < strip_size; ++s) {
    const auto near = this->near(s);
    work.faces_near += near.size();
    const auto& t = strip_.triangles[s].p;
    const Vec3 mine[3] = {strip_.points[t[0]], strip_.points[t[1]], strip_.points[t[2]]};
    for (const FaceId f : near) {
      const auto c = complex_.corners(f);
      const Vec3 theirs[3] = {c[0], c[1], c[2]};
      Signs sign;
      if (!signs_of(theirs, mine, sign)) continue;
      std::uint32_t e = by_face_.find(f.value);
      const bool known = e != no_local;
      if (!known) {
        e = static_cast<std::uint32_t>(elements.size());
        Element element;
        for (int k = 0; k < 3; ++k) element.corner[k] = local_of(complex_.face(f).v[k]);
        element.face = f;
        elements.push_back(element);
      }
      meet_pair(e, s, sign);
      if (known) continue;
      if (features_.empty())
        elements.pop_back();  // apart after all
      else
        by_face_[f.value] = e;
    }
  }
  // The strip with itself: a sweep may cross or fold back.
  const std::size_t before = shared_.size();
  std::vector<std::uint32_t> order(strip_size);
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](auto i, auto j) {
    return boxes[i].lo.x() != boxes[j].lo.x() ? boxes[i].lo.x() < boxes[j].lo.x() : i < j;
  });
  for (std::size_t i = 0; i < order.size(); ++i)
    for (std::size_t j = i + 1; j < order.size() && boxes[order[j]].lo.x() <= boxes[order[i]].hi.x(); ++j) {
      if (!boxes[order[i]].meets(boxes[order[j]])) continue;
      const auto a = std::min(order[i], order[j]), b = std::max(order[i], order[j]);
      const auto &s = strip_.triangles[a].p, &t = strip_.triangles[b].p;
      const Vec3 mine[3] = {strip_.points[s[0]], strip_.points[s[1]], strip_.points[s[2]]};
      const Vec3 theirs[3] = {strip_.points[t[0]], strip_.points[t[1]], strip_.points[t[2]]};
      Signs sign;
      if (share_corners_only(mine, theirs) || !signs_of(mine, theirs, sign)) continue;
      meet_pair(a, b, sign);
      const bool flat = !flat_pairs_.empty() && flat_pairs_.back() == std::pair{a, b};
      meets_itself_ = meets_itself_ || flat;
    }
  meets_itself_ = meets_itself_ || shared_.size() != before;
}

// Where a point of the element's plane lies: 1 inside, edges by bit; 0 outside. `on`: the edges it
// is on.
int Arrangement::locate_flat(std::uint32_t e, Local p, std::uint8_t& on) const {
  const auto& c = elements[e].corner;
  on = 0;
  for (int k = 0; k < 3; ++k)
    if (c[k] == p) return on = corner_bits(k), 1;
  const auto [axis, turn] = view_of(points_, c);
  for (int k = 0; k < 3; ++k) {
    const int s = turn * orient2d(points_[c[k]], points_[c[(k + 1) % 3]], points_[p], axis);
    if (s < 0) return 0;
    if (s == 0) on = static_cast<std::uint8_t>(on | 1 << k);
  }
  return 1;
}

// The key of the point where edges ab and cd cross, in whatever order they are given.
Arrangement::Key Arrangement::edge_edge(Local a, Local b, Local c, Local d) {
  const auto [low, high] = std::minmax({edge_key(a, b), edge_key(c, d)});
  return {low, high | 1ull << 63};  // no element has that number
}

// Where edge `edge` of an element crosses the other one: inside of it, or on its edge `other_edge`
// (−1: inside).
Local Arrangement::crossing(std::uint32_t edge_of, int edge, std::uint32_t other, int other_edge) {
  const auto &c = elements[edge_of].corner, &o = elements[other].corner;
  const Local a = c[edge], b = c[(edge + 1) % 3];
  Local& row =
      by_key_[other_edge < 0 ? Key{edge_key(a, b), other} : edge_edge(a, b, o[other_edge], o[(other_edge + 1) % 3])];
  // From the lower end to the higher one, so that the double is the same whoever asks.
  if (row == no_local)
    row = points_.add_crossing(points_[std::min(a, b)], points_[std::max(a, b)], points_[o[0]], points_[o[1]],
                               points_[o[2]]);
  return row;
}

// Where two edges of elements in one plane cross.
Local Arrangement::crossing_flat(std::uint32_t a, int edge_a, std::uint32_t b, int edge_b) {
  const auto &ca = elements[a].corner, &cb = elements[b].corner;
  Local& row = by_key_[edge_edge(ca[edge_a], ca[(edge_a + 1) % 3], cb[edge_b], cb[(edge_b + 1) % 3])];
  if (row == no_local) {
    // The plane through edge b that stands across the common plane.
    const int axis = view_of(points_, ca).first;
    const Vec3 &c = points_[cb[edge_b]], &d = points_[cb[(edge_b + 1) % 3]];
    Vec3 r = c;
    r[axis] += std::abs(r[axis]) + (d - c).cwiseAbs().maxCoeff();
    row = points_.add_crossing(points_[ca[edge_a]], points_[ca[(edge_a + 1) % 3]], c, d, r);
  }
  return row;
}

void Arrangement::feature(Local p, std::uint8_t on_a, std::uint8_t on_b) {
  for (Feature& f : features_)
    if (f.point == p) {
      f.on[0] |= on_a, f.on[1] |= on_b;
      return;
    }
  features_.push_back({p, {on_a, on_b}});
}

// What the features mean for element e, the first or second of the pair.
void Arrangement::divide(std::uint32_t e, int which) {
  const auto& c = elements[e].corner;
  for (const Feature& f : features_)
    if (f.point != c[0] && f.point != c[1] && f.point != c[2]) shared_.push_back({e, f.point, no_local, f.on[which]});
}

// The corners of s against the plane of t, and the other way round; false when one is clear of the
// other's plane.
bool Arrangement::signs_of(const Vec3 (&s)[3], const Vec3 (&t)[3], Signs& sign) const {
  for (int k = 0; k < 3; ++k) sign[0][k] = side_of(t, s[k]);
  if (sign[0][0] != 0 && sign[0][0] == sign[0][1] && sign[0][0] == sign[0][2]) return false;
  for (int k = 0; k < 3; ++k) sign[1][k] = side_of(s, t[k]);
  return sign[1][0] == 0 || sign[1][0] != sign[1][1] || sign[1][0] != sign[1][2];
}

void Arrangement::meet_pair(std::uint32_t a, std::uint32_t b, const Signs& sign) {
  features_.clear();
  const std::uint32_t element[2] = {a, b};
  if (sign[0][0] == 0 && sign[0][1] == 0 && sign[0][2] == 0) return meet_flat(a, b);
  for (int i = 0; i < 2; ++i) {
    const std::uint32_t me = element[i], it = element[1 - i];
    const auto mine = elements[me].corner, other = elements[it].corner;
    const auto add = [&](Local p, std::uint8_t on_mine, std::uint8_t on_other) {
      i == 0 ? feature(p, on_mine, on_other) : feature(p, on_other, on_mine);
    };
    for (int k = 0; k < 3; ++k) {
      const int n = (k + 1) % 3;
      if (sign[i][k] == 0) {
        std::uint8_t on = 0;
        if (locate_flat(it, mine[k], on)) add(mine[k], corner_bits(k), on);
      }
      if (sign[i][k] * sign[i][n] >= 0) continue;
      // The edge goes through the other's plane: on which side of its three edges?
      int turn[3], up = 0, down = 0;
      for (int j = 0; j < 3; ++j) {
        turn[j] = geo::orient3d(points_[mine[k]], points_[mine[n]], points_[other[j]], points_[other[(j + 1) % 3]]);
        up += turn[j] > 0, down += turn[j] < 0;
      }
      if (up > 0 && down > 0) continue;
      const auto on_mine = static_cast<std::uint8_t>(1 << k);
      if (up + down == 3) {
        add(crossing(me, k, it, -1), on_mine, 0);
      } else if (up + down == 2) {
        const int edge = turn[0] == 0 ? 0 : turn[1] == 0 ? 1 : 2;
        add(crossing(me, k, it, edge), on_mine, static_cast<std::uint8_t>(1 << edge));
      } else {
        // Two edges of the other: at the corner where they meet.
        const int corner = turn[0] != 0 ? 2 : turn[1] != 0 ? 0 : 1;
        add(other[corner], on_mine, corner_bits(corner));
      }
    }
  }
  if (features_.size() > 2) throw GeometryError("two triangles meet in more than a segment");
  for (int i = 0; i < 2; ++i) {
    divide(element[i], i);
    if (features_.size() == 2 && !(features_[0].on[i] & features_[1].on[i]))
      shared_.push_back({element[i], features_[0].point, features_[1].point, 0});
  }
}

void Arrangement::meet_flat(std::uint32_t a, std::uint32_t b) {
  const std::uint32_t element[2] = {a, b};
  const auto &ca = elements[a].corner, &cb = elements[b].corner;
  for (int k = 0; k < 3; ++k) {
    std::uint8_t on = 0;
    if (locate_flat(b, ca[k], on)) feature(ca[k], corner_bits(k), on);
    if (locate_flat(a, cb[k], on)) feature(cb[k], on, corner_bits(k));
  }
  const auto [axis, turn] = view_of(points_, ca);
  const auto side = [&, axis = axis](Local p, Local q, Local r) {
    return p == r || q == r ? 0 : orient2d(points_[p], points_[q], points_[r], axis);
  };
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const Local p = ca[i], q = ca[(i + 1) % 3], r = cb[j], s = cb[(j + 1) % 3];
      if (side(p, q, r) * side(p, q, s) < 0 && side(r, s, p) * side(r, s, q) < 0)
        feature(crossing_flat(a, i, b, j), static_cast<std::uint8_t>(1 << i), static_cast<std::uint8_t>(1 << j));
    }
  for (int i = 0; i < 2; ++i) {
    divide(element[i], i);
    // Each edge of the other, as far as it runs through this one.
    for (int k = 0; k < 3; ++k) {
      const Feature *from = nullptr, *to = nullptr;
      for (const Feature& f : features_)
        if (f.on[1 - i] & 1 << k) (from ? to : from) = &f;
      if (from && to && !(from->on[i] & to->on[i])) shared_.push_back({element[i], from->point, to->point, 0});
    }
  }
  if (features_.size() >= 3) flat_pairs_.push_back(a < strip_size ? std::pair{a, b} : std::pair{b, a});
}

Local Arrangement::known_place(Local l) {
  auto& there = by_place_[points_.hash(l)];
  for (const Local other : there)
    if (points_.same_place(other, l)) return other;
  there.push_back(l);
  if (ids_.size() < points_.size()) ids_.resize(points_.size());
  return l;
}

// One row for each place, whoever named it.
void Arrangement::unify() {
  std::vector<Local> row(points_.size());
  for (Local l = 0; l < row.size(); ++l) row[l] = known_place(l);
  for (auto& s : shared_) {
    s.a = row[s.a];
    if (s.b != no_local) s.b = row[s.b];
  }
}

void Arrangement::split() {
  ids_.resize(points_.size());
  children.reserve(elements.size() + 2 * shared_.size());
  marks_.reserve(shared_.size());
  if (meets_itself_) unify();
  // By element; a point that several name once, on all the edges that they say.
  std::stable_sort(shared_.begin(), shared_.end(), [](const Shared& x, const Shared& y) {
    return x.element != y.element                   ? x.element < y.element
           : (x.b == no_local) != (y.b == no_local) ? x.b == no_local
           : x.b == no_local                        ? x.a < y.a
                                                    : false;
  });
  mark_begin_.assign(elements.size() + 1, 0);
  Triangulator::Known known;
  if (meets_itself_) known = [this](Local l) { return known_place(l); };
  std::vector<std::pair<Local, Local>> constraints;
  std::size_t at = 0;
  for (std::uint32_t i = 0; i < elements.size(); ++i) {
    Element& e = elements[i];
    mark_begin_[i] = static_cast<std::uint32_t>(marks_.size());
    constraints.clear();
    for (; at < shared_.size() && shared_[at].element == i; ++at) {
      const Shared& s = shared_[at];
      if (s.b == no_local) {
        if (s.a == e.corner[0] || s.a == e.corner[1] || s.a == e.corner[2]) continue;
        if (marks_.size() > mark_begin_[i] && marks_.back().point == s.a)
          marks_.back().edges |= s.edges;
        else
          marks_.push_back({s.a, s.edges});
      } else if (s.a != s.b) {
        constraints.push_back({s.a, s.b});
      }
    }
    e.first = static_cast<std::uint32_t>(children.size());
    e.cut = marks_.size() > mark_begin_[i];
    if (e.cut)
      triangulator_.triangulate(e.corner, {marks_.data() + mark_begin_[i], marks_.size() - mark_begin_[i]}, constraints,
                                known, children);
    else
      children.push_back({e.corner, {0, 1, 2}});
    e.end = static_cast<std::uint32_t>(children.size());
  }
  mark_begin_.back() = static_cast<std::uint32_t>(marks_.size());
  ids_.resize(points_.size());
}

bool Arrangement::lies_on_other(std::uint32_t e, const Child& c) const {
  for (const auto& [mine, other] : flat_pairs_) {
    const std::uint32_t that = mine == e ? other : other == e ? mine : e;
    if (that == e || (that < strip_size && that > e)) continue;
    const auto& o = elements[that].corner;
    const auto [axis, turn] = view_of(points_, o);
    bool inside = true;
    for (int k = 0; k < 3; ++k)
      for (const Local p : c.v) {
        const Local a = o[k], b = o[(k + 1) % 3];
        inside = inside && (p == a || p == b || turn * points_.orient2d(a, b, p, axis) >= 0);
      }
    if (inside) return true;
  }
  return false;
}

std::vector<Local> Arrangement::along_edge(std::uint32_t e, int k) const {
  const Local from = elements[e].corner[k], to = elements[e].corner[(k + 1) % 3];
  std::vector<Local> row;
  for (auto m = mark_begin_[e]; m < mark_begin_[e + 1]; ++m)
    if (marks_[m].edges & 1 << k) row.push_back(marks_[m].point);
  int along = 0;
  (points_[to] - points_[from]).cwiseAbs().maxCoeff(&along);
  const int up = points_.compare(to, from, along);
  std::sort(row.begin(), row.end(), [&](Local a, Local b) { return a != b && points_.compare(a, b, along) == -up; });
  row.insert(row.begin(), from);
  row.push_back(to);
  return row;
}

}  // namespace geo::crack
