#include <algorithm>
#include <set>

#include "base/error.h"
#include "crack/keep_internal.h"
#include "geometry/predicates.h"

namespace geo::crack {
namespace {

Local apex_of(const std::array<Local, 3>& t, Local u, Local v) {
  for (const Local p : t)
    if (p != u && p != v) return p;
  return u;
}

bool runs(const std::array<Local, 3>& t, Local u, Local v) {
  for (int k = 0; k < 3; ++k)
    if (t[k] == u && t[(k + 1) % 3] == v) return true;
  return false;
}

}  // namespace

int compare_exact(const Arrangement& a, Local u, Local v, Local zero, Local p, Local q) {
  const auto &pu = a.exact(u), &pv = a.exact(v), &pz = a.exact(zero);
  const auto quarter = [&](Local w) {
    const auto side = CGAL::orientation(pu, pv, pz, a.exact(w));
    if (side != CGAL::COPLANAR) return side == CGAL::POSITIVE ? 1 : 3;
    return CGAL::coplanar_orientation(pu, pv, pz, a.exact(w)) == CGAL::POSITIVE ? 0 : 2;
  };
  const int qp = quarter(p), qq = quarter(q);
  if (qp != qq) return qp < qq ? -1 : 1;
  if (qp == 0 || qp == 2) return 0;
  return -static_cast<int>(CGAL::orientation(pu, pv, a.exact(p), a.exact(q)));
}

EdgeMap edges_of_complex(const Arrangement& a) {
  EdgeMap edges;
  for (std::size_t e = a.strip_size; e < a.elements.size(); ++e)
    for (std::uint32_t c = 0; c < a.elements[e].children.size(); ++c) {
      const auto& t = a.elements[e].children[c];
      for (int k = 0; k < 3; ++k) edges[edge_key(t[k], t[(k + 1) % 3])].push_back({e, c});
    }
  return edges;
}

std::vector<Part> keep_inside(const Arrangement& a, const Complex& complex, const EdgeMap& edges) {
  std::vector<Part> parts;
  std::set<std::array<Local, 3>> seen;
  for (std::size_t e = 0; e < a.strip_size; ++e)
    for (const auto& child : a.elements[e].children) {
      auto sorted = child;
      std::sort(sorted.begin(), sorted.end());
      if (!seen.insert(sorted).second || a.lies_on_other(e, child)) continue;
      parts.push_back({e, child});
    }
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> own_edges;
  for (std::uint32_t i = 0; i < parts.size(); ++i)
    for (int k = 0; k < 3; ++k) own_edges[edge_key(parts[i].corner[k], parts[i].corner[(k + 1) % 3])].push_back(i);

  // The wedge of K in which a part stands at one of K's edges: material?
  const auto in_material = [&](const Part& part, Local u, Local v, const std::vector<Occupant>& at) {
    const Local w = apex_of(part.corner, u, v);
    const Occupant* last = nullptr;
    Local last_apex = w;
    for (const auto& o : at) {
      const Local p = apex_of(a.elements[o.element].children[o.child], u, v);
      if (compare_exact(a, u, v, w, p, w) == 0) throw GeometryError("a part of the strip lies on a face");
      if (!last || compare_exact(a, u, v, w, p, last_apex) > 0) last = &o, last_apex = p;
    }
    const auto& element = a.elements[last->element];
    if (complex.face(element.face).crack > 0) return true;
    // Going on counter-clockwise from the last face one comes to the part: material if the face's back looks that way.
    return !runs(element.children[last->child], u, v);
  };

  std::vector<Part> kept;
  std::vector<bool> visited(parts.size(), false);
  for (std::uint32_t start = 0; start < parts.size(); ++start) {
    if (visited[start]) continue;
    std::vector<std::uint32_t> group{start};
    visited[start] = true;
    int inside = 0, outside = 0;
    for (std::size_t at = 0; at < group.size(); ++at) {
      const Part& part = parts[group[at]];
      for (int k = 0; k < 3; ++k) {
        const Local u = part.corner[k], v = part.corner[(k + 1) % 3];
        const auto key = edge_key(u, v);
        if (const auto it = edges.find(key); it != edges.end()) {
          ++(in_material(part, u, v, it->second) ? inside : outside);
          continue;
        }
        for (const auto next : own_edges.at(key))
          if (!visited[next]) visited[next] = true, group.push_back(next);
      }
    }
    if (inside > 0 && outside > 0) throw GeometryError("the strip is inside and outside at once");
    if (inside + outside == 0) {
      const auto& c = parts[start].corner;
      ++(inside_material(complex, (a.rounded(c[0]) + a.rounded(c[1]) + a.rounded(c[2])) / 3) ? inside : outside);
    }
    if (inside > 0)
      for (const auto i : group) kept.push_back(parts[i]);
  }
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
    complex.near(box, near);
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

ComplexEdit stitch(Arrangement& a, const Complex& complex, const EdgeMap& edges, const std::vector<Part>& parts, std::int32_t crack,
                   std::vector<VertexId>& vertex) {
  ComplexEdit edit;
  vertex.assign(a.point_count(), VertexId());
  const auto id = [&](Local p) {
    if (!vertex[p].valid()) {
      vertex[p] = a.id(p);
      if (!vertex[p].valid()) {
        vertex[p] = VertexId(complex.vertex_count() + static_cast<std::uint32_t>(edit.new_vertices.size()));
        edit.new_vertices.push_back(a.rounded(p));
      }
    }
    return vertex[p];
  };
  const std::uint32_t base = complex.face_count();
  std::map<std::pair<std::size_t, std::uint32_t>, FaceId> face_of;  // element and child
  for (std::size_t e = a.strip_size; e < a.elements.size(); ++e) {
    const auto& element = a.elements[e];
    for (std::uint32_t c = 0; c < element.children.size(); ++c) {
      if (!element.cut) {
        face_of[{e, c}] = element.face;
        for (const Local p : element.corner) id(p);
        continue;
      }
      face_of[{e, c}] = FaceId(base + static_cast<std::uint32_t>(edit.new_faces.size()));
      const auto& t = element.children[c];
      edit.new_faces.push_back({{id(t[0]), id(t[1]), id(t[2])}, complex.face(element.face).crack, element.face});
    }
    if (element.cut) edit.removed_faces.push_back(element.face);
  }
  struct Fresh {
    FaceId face;
    Local apex;
  };
  std::map<std::uint64_t, std::vector<Fresh>> crack_edges;
  for (const Part& part : parts) {
    const FaceId f(base + static_cast<std::uint32_t>(edit.new_faces.size()));
    const auto& t = part.corner;
    edit.new_faces.push_back({{id(t[0]), id(t[1]), id(t[2])}, crack, FaceId()});
    for (int k = 0; k < 3; ++k) crack_edges[edge_key(t[k], t[(k + 1) % 3])].push_back({f, t[(k + 2) % 3]});
  }

  // The order around edges. K's own order is authoritative; crack faces are put into it by exact angles.
  std::set<std::uint64_t> wanted;
  for (const auto& [key, fresh] : crack_edges) wanted.insert(key);
  // Whole edges of K that gain nothing keep their order: parts take their faces' places in it.
  const auto is_whole = [&](std::uint64_t key) {
    const VertexId u = a.id(static_cast<Local>(key >> 32)), v = a.id(static_cast<Local>(key));
    return u.valid() && v.valid() && !complex.around(u, v).empty();
  };
  for (const auto& [key, at] : edges)
    if (at.size() >= 3 && !is_whole(key) && std::any_of(at.begin(), at.end(), [&](const Occupant& o) { return a.elements[o.element].cut; })) wanted.insert(key);
  for (const auto key : wanted) {
    const Local u(static_cast<Local>(key >> 32)), v(static_cast<Local>(key));
    struct Member {
      FaceId face;
      Local apex;
    };
    std::vector<Member> ring;
    const auto it = edges.find(key);
    if (it != edges.end()) {
      const auto& at = it->second;
      std::vector<Member> members;
      for (const auto& o : at)
        members.push_back({face_of.at({o.element, o.child}), apex_of(a.elements[o.element].children[o.child], u, v)});
      if (at.size() <= 2) {
        ring = members;
      } else {
        // The edge of K that this one lies on is the one that the faces' corners share.
        std::vector<VertexId> common(complex.face(a.elements[at[0].element].face).v.begin(), complex.face(a.elements[at[0].element].face).v.end());
        for (const auto& o : at) {
          const auto& w = complex.face(a.elements[o.element].face).v;
          std::erase_if(common, [&](VertexId c) { return std::find(w.begin(), w.end(), c) == w.end(); });
        }
        if (common.size() != 2) throw GeometryError("faces meet at an edge that is not one of the complex");
        const auto order = complex.around(common[0], common[1]);
        const VertexId lo = std::min(common[0], common[1]), hi = std::max(common[0], common[1]);
        if (order.size() != at.size()) throw GeometryError("a face around a met edge was not met");
        for (const FaceId f : order) {
          const auto found = std::find_if(at.begin(), at.end(), [&](const Occupant& o) { return a.elements[o.element].face == f; });
          if (found == at.end()) throw GeometryError("a face around a met edge was not met");
          ring.push_back(members[static_cast<std::size_t>(found - at.begin())]);
        }
        // K's order is counter-clockwise about lo to hi; ours about u to v.
        const Vec3 along = complex.point(hi) - complex.point(lo);
        int axis = 0;
        along.cwiseAbs().maxCoeff(&axis);
        const bool up = along[axis] > 0, ours_up = CGAL::compare(a.exact(u)[axis], a.exact(v)[axis]) == CGAL::SMALLER;
        if (up != ours_up) std::reverse(ring.begin(), ring.end());
      }
    }
    if (const auto fresh = crack_edges.find(key); fresh != crack_edges.end()) {
      for (const auto& f : fresh->second) {
        std::size_t place = ring.size();
        for (std::size_t i = 0; i < ring.size() && ring.size() >= 2; ++i) {
          const auto &from = ring[i], &to = ring[(i + 1) % ring.size()];
          const bool on_from = compare_exact(a, u, v, from.apex, f.apex, from.apex) == 0;
          if (on_from) throw GeometryError("two faces lie on each other at an edge");
          // Counter-clockwise from `from`, is f before `to`?
          if (compare_exact(a, u, v, from.apex, to.apex, from.apex) == 0 || compare_exact(a, u, v, from.apex, f.apex, to.apex) < 0) {
            place = i + 1;
            break;
          }
        }
        if (ring.size() == 1 && compare_exact(a, u, v, ring[0].apex, f.apex, ring[0].apex) == 0)
          throw GeometryError("two faces lie on each other at an edge");
        ring.insert(ring.begin() + static_cast<std::ptrdiff_t>(std::min(place, ring.size())), {f.face, f.apex});
      }
    }
    if (ring.size() < 3) continue;
    ComplexEdit::Ring given{id(u), id(v), {}};
    for (const auto& m : ring) given.faces.push_back(m.face);
    edit.rings.push_back(std::move(given));
  }
  return edit;
}

}  // namespace geo::crack
