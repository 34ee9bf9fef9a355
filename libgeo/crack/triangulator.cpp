// Points are inserted one by one. Flipping the diagonals in its way enforces a constraint (Sloan
// 1993); Lawson flips improve the result towards Delaunay. Orientation is decided by the exact
// predicates of points.h, in the projection along the face's dominant axis.
#include "crack/triangulator.h"

#include <algorithm>
#include <cmath>

#include "geometry/predicates.h"
#include "kerf/error.h"

namespace geo::crack {

std::pair<int, int> projection_of(const Points& points, const std::array<PointIndex, 3>& corner) {
  return projection_axis(points[corner[0]], points[corner[1]], points[corner[2]]);
}

int Triangulator::add_vertex(PointIndex l, std::uint8_t edges) {
  if (vertex_.size() < points_.size()) vertex_.resize(points_.size(), -1);
  const int v = static_cast<int>(local_.size());
  vertex_[l] = v;
  local_.push_back(l);
  edges_.push_back(edges);
  at_.push_back(-1);
  return v;
}

int Triangulator::turn(int a, int b, int c) const {
  const auto ia = static_cast<std::size_t>(a), ib = static_cast<std::size_t>(b), ic = static_cast<std::size_t>(c);
  if (edges_[ia] & edges_[ib] & edges_[ic]) return 0;  // all on one edge of the face
  return sign_ * points_.orient2d(local_[ia], local_[ib], local_[ic], axis_);
}

int Triangulator::rounded_turn(int a, int b, int c) const {
  const auto p = [&](int v) -> const Vec3& { return points_[local_[static_cast<std::size_t>(v)]]; };
  return sign_ * orient2d(p(a), p(b), p(c), axis_);
}

// Rotates the corners of t so that `edge` becomes edge 0.
void Triangulator::turn_to(int t, int edge) {
  if (edge == 0) return;
  Tri& x = tri_[static_cast<std::size_t>(t)];
  const Tri y = x;
  for (int k = 0; k < 3; ++k) {
    x.v[k] = y.v[(k + edge) % 3];
    x.n[k] = y.n[(k + edge) % 3];
    x.e[k] = y.e[(k + edge) % 3];
  }
}

// Replaces t's neighbour `from` by `to`.
void Triangulator::relink(int t, int from, int to) {
  if (t < 0) return;
  for (int& n : tri_[static_cast<std::size_t>(t)].n)
    if (n == from) {
      n = to;
      return;
    }
}

void Triangulator::split_edge(int t, int edge, int p) {
  turn_to(t, edge);
  const int u = tri_[static_cast<std::size_t>(t)].n[0];
  const int t2 = static_cast<int>(tri_.size());
  tri_.push_back({});
  int u2 = -1;
  if (u >= 0) {
    u2 = static_cast<int>(tri_.size());
    tri_.push_back({});
  }
  {
    Tri &x = tri_[static_cast<std::size_t>(t)], &y = tri_[static_cast<std::size_t>(t2)];
    const int b = x.v[1], c = x.v[2];
    y = {{p, b, c}, {u2 >= 0 ? u2 : -1, x.n[1], t}, {x.e[0], x.e[1], edge_diagonal}};
    relink(x.n[1], t, t2);
    x.v[1] = p;
    x.n[1] = t2;
    x.e[1] = edge_diagonal;
    at_[static_cast<std::size_t>(p)] = t;
    at_[static_cast<std::size_t>(b)] = t2;
    at_[static_cast<std::size_t>(c)] = t;
  }
  if (u < 0) return;
  int j = 0;
  while (tri_[static_cast<std::size_t>(u)].n[j] != t ||
         tri_[static_cast<std::size_t>(u)].v[(j + 1) % 3] != tri_[static_cast<std::size_t>(t)].v[0])
    ++j;
  turn_to(u, j);
  Tri &x = tri_[static_cast<std::size_t>(u)], &y = tri_[static_cast<std::size_t>(u2)];  // x: b, a, d
  const int b = x.v[0], d = x.v[2];
  y = {{b, p, d}, {t2, u, x.n[2]}, {x.e[0], edge_diagonal, x.e[2]}};
  relink(x.n[2], u, u2);
  x.v[0] = p;
  x.n[2] = u2;
  x.e[2] = edge_diagonal;
  at_[static_cast<std::size_t>(b)] = u2;
  at_[static_cast<std::size_t>(d)] = u;
}

void Triangulator::split_face(int t, int p) {
  const int t1 = static_cast<int>(tri_.size()), t2 = t1 + 1;
  tri_.push_back({});
  tri_.push_back({});
  Tri& x = tri_[static_cast<std::size_t>(t)];
  const int a = x.v[0], b = x.v[1], c = x.v[2];
  tri_[static_cast<std::size_t>(t1)] = {{b, c, p}, {x.n[1], t2, t}, {x.e[1], edge_diagonal, edge_diagonal}};
  tri_[static_cast<std::size_t>(t2)] = {{c, a, p}, {x.n[2], t, t1}, {x.e[2], edge_diagonal, edge_diagonal}};
  relink(x.n[1], t, t1);
  relink(x.n[2], t, t2);
  x = {{a, b, p}, {x.n[0], t1, t2}, {x.e[0], edge_diagonal, edge_diagonal}};
  at_[static_cast<std::size_t>(p)] = t;
  at_[static_cast<std::size_t>(a)] = t;
  at_[static_cast<std::size_t>(b)] = t;
  at_[static_cast<std::size_t>(c)] = t1;
}

void Triangulator::flip(int t, int edge) {
  turn_to(t, edge);
  const int u = tri_[static_cast<std::size_t>(t)].n[0], a = tri_[static_cast<std::size_t>(t)].v[0];
  int j = 0;
  while (tri_[static_cast<std::size_t>(u)].n[j] != t || tri_[static_cast<std::size_t>(u)].v[(j + 1) % 3] != a) ++j;
  turn_to(u, j);
  Tri &x = tri_[static_cast<std::size_t>(t)], &y = tri_[static_cast<std::size_t>(u)];  // x: a, b, c   y: b, a, d
  const int b = x.v[1], c = x.v[2], d = y.v[2];
  relink(y.n[1], u, t);
  relink(x.n[1], t, u);
  const Tri nx = {{a, d, c}, {y.n[1], u, x.n[2]}, {y.e[1], edge_diagonal, x.e[2]}};
  const Tri ny = {{d, b, c}, {y.n[2], x.n[1], t}, {y.e[2], x.e[1], edge_diagonal}};
  x = nx;
  y = ny;
  at_[static_cast<std::size_t>(a)] = at_[static_cast<std::size_t>(c)] = at_[static_cast<std::size_t>(d)] = t;
  at_[static_cast<std::size_t>(b)] = u;
}

// True when the edge is a diagonal and both triangles after a flip have an area. `other`, `apex`:
// the triangle across it and its vertex there.
bool Triangulator::may_flip(int t, int edge, int& other, int& apex) {
  const Tri& x = tri_[static_cast<std::size_t>(t)];
  other = x.n[edge];
  if (other < 0 || x.e[edge] != edge_diagonal) return false;
  const int a = x.v[edge], b = x.v[(edge + 1) % 3], c = x.v[(edge + 2) % 3];
  apex = -1;
  for (const int v : tri_[static_cast<std::size_t>(other)].v)
    if (v != a && v != b) apex = v;
  return turn(a, apex, c) > 0 && turn(apex, b, c) > 0;
}

// Calls visit(t, k) for each triangle t at a, with a's corner k: one way around until a side of the
// face is met, then the other way. Ends when visit() is true.
template <class Visit>
void Triangulator::around(int a, const Visit& visit) const {
  const int start = at_[static_cast<std::size_t>(a)];
  for (const bool left : {true, false}) {
    int t = start;
    do {
      const Tri& x = tri_[static_cast<std::size_t>(t)];
      int k = 0;
      while (x.v[k] != a) ++k;
      if (visit(t, k)) return;
      t = left ? x.n[(k + 2) % 3] : x.n[k];
    } while (t >= 0 && t != start);
    if (t == start) return;
  }
}

// The triangle whose boundary runs a → b, and the edge's number; {−1, 0} when there is none.
std::pair<int, int> Triangulator::find_edge(int a, int b) const {
  std::pair<int, int> found{-1, 0};
  around(a, [&](int t, int k) {
    if (tri_[static_cast<std::size_t>(t)].v[(k + 1) % 3] != b) return false;
    found = {t, k};
    return true;
  });
  return found;
}

void Triangulator::insert(int p) {
  int t = 0;
  // Visibility walk; the bound ends it where exact and given incidences contradict each other.
  for (std::size_t step = 0; step <= 4 * tri_.size() + 16; ++step) {
    const Tri& x = tri_[static_cast<std::size_t>(t)];
    int next = -1, on = -1, zeros = 0;
    for (int k = 0; k < 3 && next < 0; ++k) {
      const int side = turn(x.v[k], x.v[(k + 1) % 3], p);
      if (side < 0) {
        if (x.n[k] < 0) throw GeometryError("a point of a face lies outside of it");
        next = x.n[k];
      } else if (side == 0) {
        on = k;
        ++zeros;
      }
    }
    if (next >= 0) {
      t = next;
      continue;
    }
    if (zeros > 1) throw GeometryError("two points of a face are at one place");
    if (on >= 0) {
      if (x.n[on] < 0) throw GeometryError("a point of a face lies on its edge unknown to the faces around");
      split_edge(t, on, p);
    } else {
      split_face(t, p);
    }
    return;
  }
  throw GeometryError("a point of a face cannot be located");
}

// Marks edge ab, in either direction, as part of the constraint at hand. False when there is no
// such edge.
bool Triangulator::mark_constraint(int a, int b) {
  const auto [t, k] = find_edge(a, b);
  if (t < 0) return find_edge(b, a).first >= 0 && mark_constraint(b, a);  // an edge of the face, seen from inside
  Tri& x = tri_[static_cast<std::size_t>(t)];
  const int line = first_line + static_cast<int>(lines_.size()) - 1;
  if (x.e[k] == edge_diagonal) x.e[k] = line;
  if (const int u = x.n[k]; u >= 0)
    for (int j = 0; j < 3; ++j)
      if (tri_[static_cast<std::size_t>(u)].n[j] == t && tri_[static_cast<std::size_t>(u)].v[j] == b &&
          tri_[static_cast<std::size_t>(u)].e[j] == edge_diagonal)
        tri_[static_cast<std::size_t>(u)].e[j] = line;
  return true;
}

// True when v, which is on the line ab, lies on b's side of a.
bool Triangulator::is_ahead(int a, int b, int v) const {
  int along = 0;
  const auto la = local_[static_cast<std::size_t>(a)], lb = local_[static_cast<std::size_t>(b)],
             lv = local_[static_cast<std::size_t>(v)];
  (points_[lb] - points_[la]).cwiseAbs().maxCoeff(&along);
  for (int i = 0; i < 3 && points_.compare(lb, la, along) == 0; ++i) along = (along + 1) % 3;
  return points_.compare(lb, la, along) == points_.compare(lv, la, along);
}

// How segment ab leaves a: through a triangle at a, or along an edge to a vertex.
Triangulator::Departure Triangulator::leave(int a, int b) const {
  Departure found;
  around(a, [&](int t, int k) {
    const Tri& x = tri_[static_cast<std::size_t>(t)];
    const int p = x.v[(k + 1) % 3], q = x.v[(k + 2) % 3];
    const int sp = side(p), sq = side(q);
    if (sp == 0 && is_ahead(a, b, p)) found.ahead = p;
    if (sq == 0 && is_ahead(a, b, q)) found.ahead = q;
    if (sp < 0 && sq > 0) {
      found.through = t;
      found.edge = (k + 1) % 3;
    }
    return found.through >= 0 || found.ahead >= 0;
  });
  return found;
}

// Divides the constraint at hand and the one in its way, edge `edge` of t, where they cross.
// Returns the new vertex.
int Triangulator::split_at_crossing(int t, int edge, const Canonicalize& canonicalize) {
  const int line = tri_[static_cast<std::size_t>(t)].e[edge] - first_line;
  if (!canonicalize || line < 0) throw GeometryError("constraints of a face cross");
  const Line &mine = lines_.back(), &other = lines_[static_cast<std::size_t>(line)];
  const auto point = [&](int v) { return local_[static_cast<std::size_t>(v)]; };
  const PointIndex canonical =
      canonicalize(points_.add_crossing_in_plane(point(mine.a), point(mine.b), point(other.a), point(other.b), axis_));
  if (vertex_.size() < points_.size()) vertex_.resize(points_.size(), -1);
  if (vertex_[canonical] >= 0) throw GeometryError("constraints cross at a vertex that is not on them");
  const int p = add_vertex(canonical, 0);
  split_edge(t, edge, p);
  return p;
}

// Walks along the constraint at hand from triangle to triangle towards b, as far as the next vertex
// on it. Where a constraint is in the way the walk ends at a new vertex, with no edges to flip.
Triangulator::Corridor Triangulator::walk(int b, const Departure& from, const Canonicalize& canonicalize) {
  Corridor corridor;
  for (int t = from.through, k = from.edge;;) {
    const Tri& x = tri_[static_cast<std::size_t>(t)];
    const int r = x.v[k], l = x.v[(k + 1) % 3];
    if (x.e[k] != edge_diagonal) return {{}, split_at_crossing(t, k, canonicalize)};
    corridor.crossed.push_back({r, l});
    const int u = x.n[k];
    const Tri& y = tri_[static_cast<std::size_t>(u)];
    int j = 0;
    while (y.v[j] == r || y.v[j] == l) ++j;
    corridor.end = y.v[j];
    if (corridor.end == b) return corridor;
    const int where = side(corridor.end);
    if (where == 0) return corridor;
    // y runs l → r across the edge; the segment leaves through (apex, l) or (r, apex).
    t = u;
    k = where < 0 ? j : (j + 2) % 3;  // apex on the right: between apex and l
  }
}

// Flips edges until none crosses the segment from a to `end` any more (Sloan 1993).
void Triangulator::clear_corridor(int a, int end, std::vector<std::pair<int, int>>& crossed) {
  // Flips terminate in O(n²) for n crossed edges; beyond that the input is inconsistent.
  std::size_t patience = 16 * crossed.size() * crossed.size() + 64;
  for (std::size_t head = 0; head < crossed.size(); ++head) {
    if (patience-- == 0) throw GeometryError("a constraint cannot be reached by flips");
    const auto [r, l] = crossed[head];
    const auto [t, k] = find_edge(r, l);
    if (t < 0) throw GeometryError("a crossed edge is lost");
    int other = -1, apex = -1;
    const int mine = tri_[static_cast<std::size_t>(t)].v[(k + 2) % 3];
    if (!may_flip(t, k, other, apex)) {
      crossed.push_back({r, l});
      continue;
    }
    flip(t, k);
    const int s1 = mine == a || mine == end ? 0 : side(mine), s2 = apex == a || apex == end ? 0 : side(apex);
    if (s1 * s2 < 0) crossed.push_back(s1 < 0 ? std::pair{mine, apex} : std::pair{apex, mine});
  }
}

// Makes segment ab a chain of constraint edges, from each vertex on it to the next.
void Triangulator::constrain(int a, int b, const Canonicalize& canonicalize) {
  for (int guard = 0; a != b; ++guard) {
    // Ends the loop where the input is inconsistent: the chain has a link for each vertex on ab.
    if (guard > 4096) throw GeometryError("a constraint cannot be inserted");
    if (mark_constraint(a, b)) return;
    const Departure from = leave(a, b);
    int next = from.ahead;
    if (next < 0) {
      if (from.through < 0) throw GeometryError("a constraint leaves its face");
      Corridor corridor = walk(b, from, canonicalize);
      next = corridor.end;
      clear_corridor(a, next, corridor.crossed);
    }
    constrain(a, next, canonicalize);
    a = next;
  }
}

// Flips diagonals to be locally Delaunay (Lawson 1977), by the cotangents of the opposite angles.
void Triangulator::improve() {
  const auto cotangent = [&](int apex, int a, int b) {
    const auto p = [&](int v) -> const Vec3& { return points_[local_[static_cast<std::size_t>(v)]]; };
    const Vec3 u = p(a) - p(apex), v = p(b) - p(apex);
    return u.dot(v) / std::max(u.cross(v).norm(), 1e-300);
  };
  std::vector<std::pair<int, int>> todo;
  for (const Tri& x : tri_)
    for (int k = 0; k < 3; ++k)
      if (x.e[k] == edge_diagonal && x.v[k] < x.v[(k + 1) % 3]) todo.push_back({x.v[k], x.v[(k + 1) % 3]});
  // Lawson flips terminate in exact arithmetic; this bound ends them where rounding repeats one.
  std::size_t patience = 20 * todo.size() + 20;
  while (!todo.empty() && patience-- > 0) {
    const auto [a, b] = todo.back();
    todo.pop_back();
    const auto [t, k] = find_edge(a, b);
    if (t < 0) continue;
    int other = -1, d = -1;
    const int c = tri_[static_cast<std::size_t>(t)].v[(k + 2) % 3];
    if (tri_[static_cast<std::size_t>(t)].e[k] != edge_diagonal) continue;
    other = tri_[static_cast<std::size_t>(t)].n[k];
    for (const int v : tri_[static_cast<std::size_t>(other)].v)
      if (v != a && v != b) d = v;
    // cot γ + cot δ < 0 iff d lies in the circumcircle of abc; −1e-6 leaves cocircular quads alone.
    if (!(cotangent(c, a, b) + cotangent(d, a, b) < -1e-6) || !may_flip(t, k, other, d)) continue;
    flip(t, k);
    for (const auto& [x, y] : {std::pair{a, d}, {d, b}, {b, c}, {c, a}})
      todo.push_back({std::min(x, y), std::max(x, y)});
  }
}

// Flips diagonals of children that rounding turns over, where both new children keep their
// orientation.
void Triangulator::unflip_rounded() {
  for (int t = 0; t < static_cast<int>(tri_.size()); ++t) {
    const Tri x = tri_[static_cast<std::size_t>(t)];
    if (rounded_turn(x.v[0], x.v[1], x.v[2]) > 0) continue;
    for (int k = 0; k < 3; ++k) {
      int other = -1, d = -1;
      if (!may_flip(t, k, other, d)) continue;
      const int a = x.v[k], b = x.v[(k + 1) % 3], c = x.v[(k + 2) % 3];
      if (rounded_turn(a, d, c) <= 0 || rounded_turn(d, b, c) <= 0) continue;
      flip(t, k);
      break;
    }
  }
}

// Divides the triangles behind edge k of the face at the points on it. No predicate is needed
// there.
void Triangulator::insert_edge_points(const std::array<PointIndex, 3>& corner, std::span<const SteinerPoint> steiner,
                                      int k) {
  chain_.clear();
  for (const SteinerPoint& s : steiner)
    if (s.edges & 1 << k) chain_.push_back(s.point);
  if (chain_.empty()) return;
  const PointIndex from = corner[k], to = corner[(k + 1) % 3];
  if (chain_.size() > 1) {
    int along = 0;
    (points_[to] - points_[from]).cwiseAbs().maxCoeff(&along);
    const int up = points_.compare(to, from, along);
    std::sort(chain_.begin(), chain_.end(),
              [&](PointIndex a, PointIndex b) { return a != b && points_.compare(a, b, along) == -up; });
  }
  int last = k;
  for (const PointIndex l : chain_) {
    const int p = add_vertex(l, static_cast<std::uint8_t>(1 << k));
    const auto [t, edge] = find_edge(last, (k + 1) % 3);
    split_edge(t, edge, p);
    last = p;
  }
}

void Triangulator::triangulate(const std::array<PointIndex, 3>& corner, std::span<const SteinerPoint> steiner,
                               std::span<const std::pair<PointIndex, PointIndex>> constraints,
                               const Canonicalize& canonicalize, std::vector<Child>& out) {
  std::tie(axis_, sign_) = projection_of(points_, corner);
  if (sign_ == 0) throw GeometryError("a triangle without area was met");
  local_.clear();
  edges_.clear();
  at_.clear();
  tri_.clear();
  lines_.clear();
  for (int k = 0; k < 3; ++k) add_vertex(corner[k], corner_bits(k));
  tri_.push_back({{0, 1, 2}, {-1, -1, -1}, {0, 1, 2}});
  at_[0] = at_[1] = at_[2] = 0;
  for (int k = 0; k < 3; ++k) insert_edge_points(corner, steiner, k);
  for (const SteinerPoint& s : steiner)
    if (s.edges == 0) insert(add_vertex(s.point, 0));
  for (const auto& [a, b] : constraints) {
    lines_.push_back({vertex_[a], vertex_[b]});
    constrain(vertex_[a], vertex_[b], canonicalize);
  }
  improve();
  unflip_rounded();
  for (const Tri& x : tri_) {
    Child child;
    for (int k = 0; k < 3; ++k) {
      child.v[k] = local_[static_cast<std::size_t>(x.v[k])];
      child.edge[k] = static_cast<std::uint8_t>(x.e[k] < first_line ? x.e[k] : int(edge_constraint));
    }
    out.push_back(child);
  }
  for (const PointIndex l : local_) vertex_[l] = -1;
}

}  // namespace geo::crack
