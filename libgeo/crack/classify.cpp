#include "crack/classify.h"

#include <algorithm>

#include "geometry/predicates.h"
#include "kerf/error.h"

namespace geo::crack {

void EdgeTable::add(Local u, Local v, const Use& use) {
  const Local low = std::min(u, v);
  entries_.push_back({std::max(u, v), head_[low], use});
  head_[low] = static_cast<std::uint32_t>(entries_.size() - 1);
}

void EdgeTable::find(Local u, Local v, std::vector<Use>& out) const {
  out.clear();
  const Local low = std::min(u, v), high = std::max(u, v);
  for (auto e = head_[low]; e != ~0u; e = entries_[e].next)
    if (entries_[e].high == high) out.push_back(entries_[e].use);
  std::reverse(out.begin(), out.end());
}

Member member_at(const Arrangement& a, const Use& use, Local u) {
  const auto& c = a.children[use.child].v;
  return {use.element, c[(use.k + 2) % 3], c[use.k] == u};
}

namespace {

// Which quarter of the turn from `zero`: 0 on its half-plane, 1 before half a turn, 2 at half a
// turn, 3 beyond it.
int quarter(const Arrangement& a, Local u, Local v, const Member& zero, const Member& w) {
  if (zero.element == w.element) return zero.forward == w.forward ? 0 : 2;
  const int side = a.side(zero.element, w.apex);
  if (side != 0) return (side > 0) == zero.forward ? 1 : 3;
  const auto [axis, turn] = view_of(a.points(), a.elements[zero.element].corner);
  return a.points().orient2d(u, v, w.apex, axis) == (zero.forward ? turn : -turn) ? 0 : 2;
}

}  // namespace

int compare_around(const Arrangement& a, Local u, Local v, const Member& zero, const Member& p, const Member& q) {
  const int qp = quarter(a, u, v, zero, p), qq = quarter(a, u, v, zero, q);
  if (qp != qq) return qp < qq ? -1 : 1;
  if (qp == 0 || qp == 2 || p.element == q.element) return 0;
  const int side = a.side(p.element, q.apex);
  return p.forward ? -side : side;
}

EdgeTable edges_of_complex(const Arrangement& a) {
  EdgeTable edges(a.points().size());
  edges.reserve(2 * a.children.size());
  for (std::uint32_t e = a.strip_size; e < a.elements.size(); ++e)
    for (auto c = a.elements[e].first; c < a.elements[e].end; ++c) {
      const Child& child = a.children[c];
      for (std::uint8_t k = 0; k < 3; ++k)
        if (child.edge[k] != edge_diagonal) edges.add(child.v[k], child.v[(k + 1) % 3], {e, c, k});
    }
  return edges;
}

namespace {

// The wedge of K in which a part stands at one of K's edges: material?
bool in_material(const Arrangement& a, const Complex& complex, Local u, Local v, const Member& part,
                 const std::vector<Use>& at) {
  const Use* last = nullptr;
  Member last_member{};
  for (const Use& use : at) {
    const Member m = member_at(a, use, u);
    if (quarter(a, u, v, part, m) == 0) throw GeometryError("a part of the strip lies on a face");
    if (!last || compare_around(a, u, v, part, m, last_member) > 0) last = &use, last_member = m;
  }
  if (complex.face(a.elements[last->element].face).crack > 0) return true;
  // Going on counter-clockwise from the last face one comes to the part: material if the face's
  // back looks that way.
  return !last_member.forward;
}

}  // namespace

std::vector<Part> keep_inside(const Arrangement& a, const Complex& complex, const EdgeTable& edges) {
  std::vector<Part> parts;
  for (std::uint32_t e = 0; e < a.strip_size; ++e)
    for (auto c = a.elements[e].first; c < a.elements[e].end; ++c)
      if (!a.lies_on_other(e, a.children[c])) parts.push_back({e, c});
  EdgeTable own(a.points().size());
  own.reserve(3 * parts.size());
  for (std::uint32_t i = 0; i < parts.size(); ++i)
    for (std::uint8_t k = 0; k < 3; ++k) {
      const auto& v = a.children[parts[i].child].v;
      own.add(v[k], v[(k + 1) % 3], {i, parts[i].child, k});
    }

  std::vector<Part> kept;
  std::vector<bool> visited(parts.size(), false);
  std::vector<std::uint32_t> group;
  std::vector<Use> at;
  for (std::uint32_t start = 0; start < parts.size(); ++start) {
    if (visited[start]) continue;
    group.assign(1, start);
    visited[start] = true;
    std::size_t inside = 0, outside = 0;
    for (std::size_t g = 0; g < group.size(); ++g) {
      const Part part = parts[group[g]];
      const Child& child = a.children[part.child];
      for (std::uint8_t k = 0; k < 3; ++k) {
        const Local u = child.v[k], v = child.v[(k + 1) % 3];
        if (child.edge[k] != edge_diagonal) {
          edges.find(u, v, at);
          if (!at.empty()) {
            ++(in_material(a, complex, u, v, {part.element, child.v[(k + 2) % 3], true}, at) ? inside : outside);
            continue;
          }
        }
        own.find(u, v, at);
        for (const Use& next : at)
          if (!visited[next.element]) visited[next.element] = true, group.push_back(next.element);
      }
    }
    if (inside > 0 && outside > 0) throw GeometryError("the strip is inside and outside at once");
    if (inside + outside == 0) {
      const auto& c = a.children[parts[start].child].v;
      ++(inside_material(complex, (a.points()[c[0]] + a.points()[c[1]] + a.points()[c[2]]) / 3) ? inside : outside);
    }
    if (inside > 0)
      for (const auto i : group) kept.push_back(parts[i]);
  }
  std::sort(kept.begin(), kept.end(), [](const Part& x, const Part& y) { return x.child < y.child; });
  return kept;
}

bool inside_material(const Complex& complex, const Vec3& q) {
  const Box3& extent = complex.extent();
  if (!Box3{q, q}.meets(extent)) return false;
  const double reach = extent.diagonal();
  std::vector<FaceId> near;
  for (int tries = 0; tries < 24; ++tries) {
    const int axis = tries % 3;
    // Straight out along an axis, tilted a little so that the line meets nothing special.
    Vec3 end = q;
    end[axis] = (tries / 3) % 2 == 0 ? extent.hi[axis] + reach * 0.01 : extent.lo[axis] - reach * 0.01;
    end[(axis + 1) % 3] += reach * (1.3e-4 + 3.1e-4 * tries);
    end[(axis + 2) % 3] += reach * (0.7e-4 + 2.3e-4 * tries);
    Box3 box{q, q};
    box.add(end);
    near.clear();
    complex.faces_near(box, near);
    bool clean = true;
    int crossings = 0;
    for (const FaceId f : near) {
      if (complex.face(f).crack > 0) continue;
      const auto t = complex.corners(f);
      const int sq = orient3d(t[0], t[1], t[2], q), se = orient3d(t[0], t[1], t[2], end);
      if (sq == se && sq != 0) continue;
      const int e0 = orient3d(q, end, t[0], t[1]), e1 = orient3d(q, end, t[1], t[2]), e2 = orient3d(q, end, t[2], t[0]);
      if (!((e0 >= 0 && e1 >= 0 && e2 >= 0) || (e0 <= 0 && e1 <= 0 && e2 <= 0))) continue;
      if (sq == 0 || se == 0 || e0 == 0 || e1 == 0 || e2 == 0) {
        clean = false;
        break;
      }
      ++crossings;
    }
    if (clean) return crossings % 2 == 1;
  }
  throw GeometryError("no line from a point of the strip avoids the edges of the skin");
}

}  // namespace geo::crack
