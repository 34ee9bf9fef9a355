#include "crack/guard.h"

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "crack/exits.h"
#include "crack/radial_order.h"
#include "geometry/distance.h"
#include "geometry/predicates.h"
#include "kerf/check.h"

namespace geo {
namespace {

// A triangle's plane against points, quickly: by how much the normal's and the products' rounding
// can be off.
struct Plane {
  Vec3 normal, at;
  double size;    // the longest side of the triangle's box
  double margin;  // a height of `clearance`, times the normal's length

  Plane(const std::array<Vec3, 3>& t, const Box3& box, double clearance)
      : normal((t[1] - t[0]).cross(t[2] - t[0])),
        at(t[0]),
        size((box.hi - box.lo).maxCoeff()),
        margin(clearance > 0 ? clearance * normal.norm() : 0) {}

  // True when those corners of the other that the two do not share are all on one side, for
  // certain, and farther than the clearance: the two then have nothing else in common. Each entry
  // of the normal is off by 8 roundings of size² at most, an offset by one; boxes meet, so that no
  // offset is longer than both sizes.
  bool clears(const std::array<std::uint32_t, 3>& mine, const std::array<std::uint32_t, 3>& rows,
              const std::array<Vec3, 3>& corners, double other_size) const {
    const double volume = size * size * (size + other_size), bound = 0x1p-47 * volume + margin;
    if (!(volume > filter_smallest && volume < filter_largest)) return false;
    int side = 0, shared = 0;
    for (int k = 0; k < 3; ++k) {
      if (rows[k] == mine[0] || rows[k] == mine[1] || rows[k] == mine[2]) {
        ++shared;
        continue;
      }
      const double height = normal.dot(corners[k] - at);
      if (std::abs(height) <= bound || (height > 0 ? side < 0 : side > 0)) return false;
      side = height > 0 ? 1 : -1;
    }
    return shared < 3;
  }
};

double height(const std::array<Vec3, 3>& t) {
  const double longest =
      std::max({(t[1] - t[0]).squaredNorm(), (t[2] - t[1]).squaredNorm(), (t[0] - t[2]).squaredNorm()});
  return (t[1] - t[0]).cross(t[2] - t[0]).norm() / std::sqrt(longest);
}

// True when corners or edges of two triangles that do not touch by id are nearer to each other than
// `clearance`.
bool too_near(const Plane& of_f, const std::array<std::uint32_t, 3>& f, const std::array<Vec3, 3>& p, const Plane& of_g,
              const std::array<std::uint32_t, 3>& g, const std::array<Vec3, 3>& q, double clearance) {
  const auto in = [](std::uint32_t v, const std::array<std::uint32_t, 3>& t) {
    return v == t[0] || v == t[1] || v == t[2];
  };
  const auto near = [&](const Vec3& x, const Plane& plane, const std::array<Vec3, 3>& t) {
    return std::abs(plane.normal.dot(x - plane.at)) <= plane.margin &&
           (closest_point_on_triangle(x, t[0], t[1], t[2]) - x).norm() < clearance;
  };
  for (int i = 0; i < 3; ++i) {
    if ((!in(f[i], g) && near(p[i], of_g, q)) || (!in(g[i], f) && near(q[i], of_f, p))) return true;
    const int m = (i + 1) % 3;
    for (int j = 0; j < 3; ++j) {
      const int n = (j + 1) % 3;
      if (f[i] == g[j] || f[i] == g[n] || f[m] == g[j] || f[m] == g[n]) continue;
      // Their lines are this far apart, or they are parallel.
      const Vec3 across = (p[m] - p[i]).cross(q[n] - q[j]);
      const double volume = across.dot(q[j] - p[i]);
      if (volume * volume > clearance * clearance * across.squaredNorm()) continue;
      if (distance_between_segments(p[i], p[m], q[j], q[n]) < clearance) return true;
    }
  }
  return false;
}

// An edit with all that the questions about it need.
class Inspection {
 public:
  Inspection(const Complex& complex, const ComplexEdit& edit, std::span<const Family> families,
             std::span<const std::uint8_t> moved, double clearance)
      : complex_(complex),
        edit_(edit),
        families_(families),
        moved_(moved),
        clearance_(clearance),
        count_(static_cast<std::uint32_t>(edit.new_faces.size())) {
    faces_.reserve(count_);
    for (const auto& f : edit.new_faces) {
      std::array<Vec3, 3> corners;
      std::array<std::uint32_t, 3> rows;
      bool rounded = moved.empty();
      for (int k = 0; k < 3; ++k)
        corners[k] = point(f.v[k]), rows[k] = f.v[k].value, rounded = rounded || is_moved(f.v[k]);
      const Box3 box = box_of(corners[0], corners[1], corners[2]);
      const double apart = f.crack > 0 ? clearance : 0;
      // An exact face of a crack may still come too near to what an earlier step has rounded.
      faces_.push_back({corners, rows, box.grown(apart), Plane(corners, box, apart), ~0u, rounded, rounded || apart > 0,
                        f.crack > 0});
    }
    for (const Family& family : families)
      for (auto i = family.first; i < family.end; ++i)
        if (family.whole) faces_[i].family = family.first;
  }

  // A face that is turned over against its triangle, or has no area.
  Fault turned() const {
    for (const Family& family : families_) {
      const auto [axis, was] = projection_axis(family.plane[0], family.plane[1], family.plane[2]);
      for (auto i = family.first; i < family.end; ++i) {
        const auto& c = faces_[i].corners;
        const int is = orient2d(c[0], c[1], c[2], axis);
        if (is == 0) return {"rounding would leave a face without area", {i}};
        if (was != is) return {"rounding would turn a face over", {i}};
        if (clearance_ > 0 && faces_[i].rounded && faces_[i].cracked && height(c) < clearance_)
          return {"rounding would leave a face that is too thin", {i}};
      }
    }
    return {};
  }

  // Two vertices that rounding has left a few places from each other: slivers that no later step
  // could round.
  Fault coincident() const {
    // Sorted along a direction that no model is likely to be flat across.
    const Vec3 along(0.5412, 0.6173, 0.5710);
    std::vector<std::pair<double, VertexId>> sorted;
    sorted.reserve(3 * faces_.size());
    std::vector<bool> fresh(edit_.new_vertices.size(), true);
    for (const auto& f : edit_.new_faces)
      for (const VertexId v : f.v) {
        if (v.value >= complex_.vertex_count()) {
          const auto i = v.value - complex_.vertex_count();
          if (!fresh[i]) continue;
          fresh[i] = false;
        }
        sorted.push_back({along.dot(point(v)), v});
      }
    std::sort(sorted.begin(), sorted.end());
    const double close = std::max(clearance_, 0x1p-48 * complex_.extent().diagonal());
    const double reach =
        2 * close +
        0x1p-50 * (complex_.extent().lo.cwiseAbs().cwiseMax(complex_.extent().hi.cwiseAbs()).sum());  // and rounding
    for (std::size_t i = 0; i < sorted.size(); ++i)
      for (std::size_t j = i + 1; j < sorted.size() && sorted[j].first <= sorted[i].first + reach; ++j) {
        const VertexId p = sorted[i].second, q = sorted[j].second;
        if (p == q || !(is_moved(p) || is_moved(q))) continue;
        if (((point(p) - point(q)).cwiseAbs().array() > close).any()) continue;
        Fault fault{"rounding would leave two vertices at one place", {}};
        for (std::uint32_t f = 0; f < count_; ++f)
          for (const VertexId v : edit_.new_faces[f].v)
            if (v == p || v == q) fault.faces.push_back(f);
        return fault;
      }
    return {};
  }

  // A new face that crosses one that stays.
  Fault crossing_old() const {
    std::vector<FaceId> removed = edit_.removed_faces, looked_up;
    std::sort(removed.begin(), removed.end());
    for (std::size_t at = 0, next; at < families_.size(); at = next) {
      // Families that are to look at the same faces look together.
      const Family& family = families_[at];
      for (next = at + 1; next < families_.size() && !family.near.empty() &&
                          families_[next].near.data() == family.near.data() &&
                          families_[next].first == families_[next - 1].end;)
        ++next;
      const auto end = families_[next - 1].end;
      Box3 box;
      for (auto i = family.first; i < end; ++i)
        if (faces_[i].asked) box.add(faces_[i].box);
      if (box.empty()) continue;
      looked_up.clear();
      if (family.near.empty()) complex_.faces_near(box, looked_up);
      for (const FaceId f : family.near.empty() ? std::span<const FaceId>(looked_up) : family.near) {
        const Box3& there = complex_.box(f);
        if (!there.meets(box) || std::binary_search(removed.begin(), removed.end(), f)) continue;
        const double size = (there.hi - there.lo).maxCoeff();
        for (auto i = family.first; i < end; ++i) {
          const New& face = faces_[i];
          if (!face.asked || !there.meets(face.box)) continue;
          const auto corners = complex_.corners(f);
          const auto& v = complex_.face(f).v;
          const std::array<std::uint32_t, 3> rows{v[0].value, v[1].value, v[2].value};
          if (face.plane.clears(face.rows, rows, corners, size)) continue;
          const bool cracked = complex_.face(f).crack > 0;
          const New old{corners, rows,  there, Plane(corners, there, cracked ? clearance_ : 0),
                        ~0u,     false, false, cracked};
          if (const char* what = fault_between(face, old))
            return {std::string(what) + " face " + std::to_string(f.value), {i}};
        }
      }
    }
    return {};
  }

  // Two new faces that cross, found by a sweep along the longest way.
  Fault crossing_new() const {
    Box3 all;
    for (const New& f : faces_) all.add(f.box);
    int axis = 0;
    if (count_ > 0) (all.hi - all.lo).maxCoeff(&axis);
    std::vector<std::pair<double, std::uint32_t>> order;
    order.reserve(count_);
    for (std::uint32_t i = 0; i < count_; ++i) order.push_back({faces_[i].box.lo[axis], i});
    std::sort(order.begin(), order.end());
    for (std::uint32_t i = 0; i < count_; ++i) {
      const New& a = faces_[order[i].second];
      const double end = a.box.hi[axis];
      for (std::uint32_t j = i + 1; j < count_ && order[j].first <= end; ++j) {
        const New& b = faces_[order[j].second];
        if (!a.box.meets(b.box) || !(a.asked || b.asked)) continue;
        // All children of a triangle, none turned over: they cover it once, as before rounding.
        if (a.family != ~0u && a.family == b.family) continue;
        if (const char* what = fault_between(a, b))
          return {std::string(what) + " another new face", {order[i].second, order[j].second}};
      }
    }
    return {};
  }

 private:
  struct New {
    std::array<Vec3, 3> corners;
    std::array<std::uint32_t, 3> rows;
    Box3 box;
    Plane plane;
    std::uint32_t family;  // the first child of the same triangle where all are known not to overlap, else ~0u
    bool rounded;          // has a vertex that rounding moved
    bool asked;            // is compared with other faces
    bool cracked;          // of a crack, not of the skin
  };

  const Vec3& point(VertexId v) const { return point_after(complex_, edit_, v); }
  bool is_moved(VertexId v) const {
    return v.value >= complex_.vertex_count() && (moved_.empty() || moved_[v.value - complex_.vertex_count()]);
  }
  const char* fault_between(const New& f, const New& g) const {
    if (f.plane.clears(f.rows, g.rows, g.corners, g.plane.size) ||
        g.plane.clears(g.rows, f.rows, f.corners, f.plane.size))
      return nullptr;
    if (faces_cross(f.rows, f.corners, g.rows, g.corners)) return "rounding would make a new face cross";
    if (clearance_ > 0 && f.cracked && g.cracked &&
        too_near(f.plane, f.rows, f.corners, g.plane, g.rows, g.corners, clearance_))
      return "rounding would leave a new face too near to";
    return nullptr;
  }

  const Complex& complex_;
  const ComplexEdit& edit_;
  std::span<const Family> families_;
  std::span<const std::uint8_t> moved_;
  double clearance_;
  std::uint32_t count_;
  std::vector<New> faces_;
};

}  // namespace

Fault find_fault(const Complex& complex, const ComplexEdit& edit, std::span<const Family> families,
                 std::span<const std::uint8_t> moved, double clearance, std::span<const Exit> exits) {
  const Inspection inspection(complex, edit, families, moved, clearance);
  Fault fault = inspection.turned();
  if (!fault) fault = inspection.coincident();
  if (!fault) fault = find_misplaced(complex, edit, moved);
  if (!fault) fault = inspection.crossing_old();
  if (!fault) fault = inspection.crossing_new();
  if (!fault) fault = find_return(complex, edit, exits);
  return fault;
}

Fault repair(const Complex& complex, ComplexEdit& edit, std::span<const Family> families,
             std::span<const std::uint8_t> moved, double clearance, std::span<const Exit> exits, std::size_t& repairs) {
  Fault fault = find_fault(complex, edit, families, moved, clearance, exits);
  if (!fault) return fault;
  const double last_place =
      0x1p-52 * (complex.extent().diagonal() +
                 complex.extent().lo.cwiseAbs().cwiseMax(complex.extent().hi.cwiseAbs()).maxCoeff());
  std::vector<Family> rest(families.begin(), families.end());  // what is left out does not follow the points
  for (Family& family : rest) family.whole = family.whole && edit.new_faces[family.first].parent.valid();
  Random random(edit.new_faces.size() * 0x9e3779b97f4a7c15ull + edit.new_vertices.size());
  for (int tries = 0; tries < 32; ++tries) {
    // The points that the fault's faces have and that rounding has moved anyway, a little farther
    // each time.
    const double distance = last_place * std::pow(2.0, tries / 2);
    std::vector<std::pair<std::uint32_t, Vec3>> before;
    for (const auto f : fault.faces)
      for (const VertexId v : edit.new_faces[f].v) {
        if (v.value < complex.vertex_count() || !moved[v.value - complex.vertex_count()]) continue;
        const std::uint32_t i = v.value - complex.vertex_count();
        before.push_back({i, edit.new_vertices[i]});
        edit.new_vertices[i] += distance * random.uniform(0.5, 1.0) * random.direction();
      }
    if (before.empty()) return fault;
    Fault now = find_fault(complex, edit, rest, moved, clearance, exits);
    if (!now) {
      ++repairs;
      return now;
    }
    if (now.faces == fault.faces)
      for (auto b = before.rbegin(); b != before.rend(); ++b) edit.new_vertices[b->first] = b->second;
    else
      fault = std::move(now);  // that one is mended; this comes next
  }
  return fault;
}

}  // namespace geo
