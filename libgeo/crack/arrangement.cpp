#define CGAL_NO_CDT_2_WARNING  // crossings are few, and each face is triangulated alone
#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <CGAL/intersections.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <set>

#include "base/error.h"
#include "crack/arrangement_internal.h"
#include "geometry/predicates.h"

namespace geo::crack {
namespace {

std::uint64_t hash(const Vec3& p) {
  std::uint64_t h = 1469598103934665603ull;
  for (int i = 0; i < 3; ++i) {
    h = (h ^ std::bit_cast<std::uint64_t>(p[i] + 0.0)) * 1099511628211ull;  // + 0.0: one zero
    h ^= h >> 29;
  }
  return h;
}

// Correctly rounded, unlike to_double of a lazy number.
double round_exactly(const Exact::FT& x) {
  const auto interval = CGAL::to_interval(x);
  return interval.first == interval.second ? interval.first : CGAL::to_double(x.exact());
}

// What a vertex of the planar triangulation stands for; those that crossing constraints make stand for nothing yet.
struct Row {
  Local row = ~0u;
};
using Planar = CGAL::Triangulation_vertex_base_with_info_2<Row, Exact>;
using Structure = CGAL::Triangulation_data_structure_2<Planar, CGAL::Constrained_triangulation_face_base_2<Exact>>;
using Triangulation = CGAL::Constrained_Delaunay_triangulation_2<Exact, Structure, CGAL::Exact_intersections_tag>;

}  // namespace

Arrangement::Arrangement(const Complex& complex, const Strip& strip) : complex_(complex), strip_(strip) {
  std::vector<FaceId> near;
  for (const auto& t : strip.triangles) {
    Element e;
    for (int k = 0; k < 3; ++k) e.corner[k] = local(strip.points[t.p[k]]);
    elements.push_back(e);
  }
  strip_size = elements.size();
  coplanar_.resize(strip_size);
}

Local Arrangement::local(VertexId v) {
  const auto [it, fresh] = by_id_.try_emplace(v, 0);
  if (fresh) {
    it->second = local(complex_.point(v));
    ids_[it->second] = v;
  }
  return it->second;
}

Local Arrangement::local(const Vec3& p) {
  auto& bucket = by_hash_[hash(p)];
  for (const Local l : bucket)
    if (rounded_[l] == p && points_[l] == ExactPoint(p.x(), p.y(), p.z())) return l;
  bucket.push_back(static_cast<Local>(points_.size()));
  points_.emplace_back(p.x(), p.y(), p.z());
  rounded_.push_back(p + Vec3::Zero());
  ids_.emplace_back();
  return bucket.back();
}

Local Arrangement::local(const ExactPoint& p) {
  const Vec3 r(round_exactly(p.x()), round_exactly(p.y()), round_exactly(p.z()));
  auto& bucket = by_hash_[hash(r)];
  for (const Local l : bucket)
    if (rounded_[l] == r && points_[l] == p) return l;
  bucket.push_back(static_cast<Local>(points_.size()));
  points_.push_back(p);
  rounded_.push_back(r + Vec3::Zero());
  ids_.emplace_back();
  return bucket.back();
}

void Arrangement::meet(CrackWork& work) {
  std::vector<FaceId> near;
  std::vector<Box3> boxes;
  for (const auto& t : strip_.triangles) boxes.push_back(box_of(strip_.points[t.p[0]], strip_.points[t.p[1]], strip_.points[t.p[2]]));
  for (std::size_t s = 0; s < strip_size; ++s) {
    near.clear();
    complex_.near(boxes[s], near);
    work.faces_near += near.size();
    const auto& t = strip_.triangles[s].p;
    const Vec3 mine[3] = {strip_.points[t[0]], strip_.points[t[1]], strip_.points[t[2]]};
    for (const FaceId f : near) {
      const auto c = complex_.corners(f);
      const Vec3 theirs[3] = {c[0], c[1], c[2]};
      if (!triangles_meet(mine, theirs)) continue;
      const auto [it, fresh] = element_of.try_emplace(f, elements.size());
      if (fresh) {
        Element e;
        for (int k = 0; k < 3; ++k) e.corner[k] = local(complex_.face(f).v[k]);
        e.face = f;
        elements.push_back(e);
      }
      share(s, it->second);
    }
  }
  // The strip with itself: a sweep may cross or fold back.
  for (std::size_t i = 0; i < strip_size; ++i)
    for (std::size_t j = i + 1; j < strip_size; ++j)
      if (boxes[i].meets(boxes[j])) share(i, j);
}

void Arrangement::share(std::size_t a, std::size_t b) {
  Element &x = elements[a], &y = elements[b];
  int at_x[3], at_y[3], common = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (x.corner[i] == y.corner[j]) at_x[common] = i, at_y[common] = j, ++common;
  const auto px = [&](int i) -> const Vec3& { return rounded_[x.corner[i % 3]]; };
  const auto py = [&](int i) -> const Vec3& { return rounded_[y.corner[i % 3]]; };
  if (common == 3) {
    if (a < strip_size) coplanar_[a].push_back(b);
    if (b < strip_size) coplanar_[b].push_back(a);
    return;
  }
  // What is shared by corners alone divides nothing.
  if (common == 2) {
    const int i = 3 - at_x[0] - at_x[1], j = 3 - at_y[0] - at_y[1];
    if (orient3d(px(0), px(1), px(2), py(j)) != 0) return;
    if (coplanar_side(px(at_x[0]), px(at_x[1]), px(i), py(j)) < 0) return;
  } else if (common == 1) {
    const int i = at_x[0], j = at_y[0];
    if (!segment_meets_triangle(px(i + 1), px(i + 2), py(0), py(1), py(2)) &&
        !segment_meets_triangle(py(j + 1), py(j + 2), px(0), px(1), px(2)))
      return;
  } else {
    const Vec3 s[3] = {px(0), px(1), px(2)}, t[3] = {py(0), py(1), py(2)};
    if (!triangles_meet(s, t)) return;
  }
  const Exact::Triangle_3 tx(points_[x.corner[0]], points_[x.corner[1]], points_[x.corner[2]]);
  const Exact::Triangle_3 ty(points_[y.corner[0]], points_[y.corner[1]], points_[y.corner[2]]);
  const auto result = CGAL::intersection(tx, ty);
  if (!result) return;
  std::vector<ExactPoint> corners;
  if (const auto* point = boost::get<ExactPoint>(&*result))
    corners = {*point};
  else if (const auto* segment = boost::get<Exact::Segment_3>(&*result))
    corners = {segment->source(), segment->target()};
  else if (const auto* triangle = boost::get<Exact::Triangle_3>(&*result))
    corners = {triangle->vertex(0), triangle->vertex(1), triangle->vertex(2)};
  else
    corners = boost::get<std::vector<ExactPoint>>(*result);
  std::vector<Local> rows;
  for (const auto& p : corners) rows.push_back(local(p));
  if (rows.size() >= 3) {
    if (a < strip_size) coplanar_[a].push_back(b);
    if (b < strip_size) coplanar_[b].push_back(a);
  }
  for (Element* e : {&x, &y}) {
    if (rows.size() == 1) e->shared.push_back({rows[0], rows[0]});
    if (rows.size() == 2) e->shared.push_back({rows[0], rows[1]});
    for (std::size_t k = 0; rows.size() >= 3 && k < rows.size(); ++k) e->shared.push_back({rows[k], rows[(k + 1) % rows.size()]});
  }
}

void Arrangement::split() {
  for (auto& e : elements) {
    std::set<Local> extra;
    std::set<std::pair<Local, Local>> constraints;
    const std::set<Local> own(e.corner.begin(), e.corner.end());
    for (const auto& [a, b] : e.shared) {
      for (const Local p : {a, b})
        if (!own.count(p)) extra.insert(p);
      if (a != b) constraints.insert({std::min(a, b), std::max(a, b)});
    }
    if (extra.empty()) {
      e.children = {e.corner};
      continue;
    }
    e.cut = true;
    // Seen along the axis in which the normal is longest; exact, so any axis with a non-zero normal would do.
    const Vec3 n = (rounded_[e.corner[1]] - rounded_[e.corner[0]]).cross(rounded_[e.corner[2]] - rounded_[e.corner[0]]);
    int axis = 0, turn = 0;
    n.cwiseAbs().maxCoeff(&axis);
    const auto flat = [&](const ExactPoint& p) { return Exact::Point_2(p[(axis + 1) % 3], p[(axis + 2) % 3]); };
    for (int tries = 0; tries < 3 && turn == 0; ++tries) {
      if (tries > 0) axis = (axis + 1) % 3;
      turn = CGAL::orientation(flat(points_[e.corner[0]]), flat(points_[e.corner[1]]), flat(points_[e.corner[2]]));
    }
    if (turn == 0) throw GeometryError("a triangle without area was met");

    Triangulation plane;
    std::map<Local, Triangulation::Vertex_handle> handles;
    const auto insert = [&](Local p) {
      const auto h = plane.insert(flat(points_[p]));
      h->info().row = p;
      handles[p] = h;
    };
    for (const Local p : e.corner) insert(p);
    for (const Local p : extra) insert(p);
    for (const auto& [a, b] : constraints) plane.insert_constraint(handles.at(a), handles.at(b));
    {
      // Where constraints crossed, the crossing is lifted back into the plane of the element.
      const Exact::Plane_3 plane3(points_[e.corner[0]], points_[e.corner[1]], points_[e.corner[2]]);
      for (auto v = plane.finite_vertices_begin(); v != plane.finite_vertices_end(); ++v) {
        if (v->info().row != ~0u) continue;
        Exact::FT c[3];
        c[(axis + 1) % 3] = v->point().x();
        c[(axis + 2) % 3] = v->point().y();
        const Exact::FT normal[3] = {plane3.a(), plane3.b(), plane3.c()};
        c[axis] = -(plane3.d() + normal[(axis + 1) % 3] * c[(axis + 1) % 3] + normal[(axis + 2) % 3] * c[(axis + 2) % 3]) / normal[axis];
        v->info().row = local(ExactPoint(c[0], c[1], c[2]));
      }
    }
    for (auto f = plane.finite_faces_begin(); f != plane.finite_faces_end(); ++f) {
      std::array<Local, 3> child{f->vertex(0)->info().row, f->vertex(1)->info().row, f->vertex(2)->info().row};
      if (turn < 0) std::swap(child[1], child[2]);
      std::rotate(child.begin(), std::min_element(child.begin(), child.end()), child.end());
      e.children.push_back(child);
    }
    std::sort(e.children.begin(), e.children.end());
  }
}

bool Arrangement::lies_on_other(std::size_t e, const std::array<Local, 3>& c) const {
  if (coplanar_[e].empty()) return false;
  const ExactPoint middle = CGAL::centroid(points_[c[0]], points_[c[1]], points_[c[2]]);
  for (const std::size_t other : coplanar_[e]) {
    if (other < strip_size && other >= e) continue;
    const auto& o = elements[other].corner;
    if (Exact::Triangle_3(points_[o[0]], points_[o[1]], points_[o[2]]).has_on(middle)) return true;
  }
  return false;
}

}  // namespace geo::crack
