// Orientation, order and crossing are exact on the rounded coordinates, behind floating-point
// filters; the clearance is measured in doubles. Pairs come from lists of near faces, the index of
// K, and boxes that meet. Repair displaces rounded points of faulty faces and tests again.
#include "crack/guard.h"

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "crack/exits.h"
#include "crack/radial_order.h"
#include "geometry/box_pairs.h"
#include "geometry/distance.h"
#include "geometry/predicates.h"
#include "kerf/check.h"

namespace geo {
namespace {

// A triangle's plane for a quick test of points against it, with a bound of the rounding error.
struct Plane {
  Vec3 normal, at;
  double size;    // longest side of the triangle's box
  double margin;  // clearance times the normal's length

  Plane(const std::array<Vec3, 3>& t, const Box3& box, double clearance)
      : normal((t[1] - t[0]).cross(t[2] - t[0])),
        at(t[0]),
        size((box.hi - box.lo).maxCoeff()),
        margin(clearance > 0 ? clearance * normal.norm() : 0) {}

  // True when the corners of another triangle that `mine` does not share are certainly all on one
  // side and farther than the clearance: the two triangles then have nothing else in common. Error
  // bound: each entry of the normal is off by at most 8 roundings of size², an offset by one; boxes
  // meet, so that no offset is longer than both sizes.
  bool clears(const std::array<std::uint32_t, 3>& mine, const std::array<std::uint32_t, 3>& ids,
              const std::array<Vec3, 3>& corners, double other_size) const {
    // Three products, each off by 12 roundings at most, and their sum: fewer than 64 roundings of
    // 2⁻⁵³, together 2⁻⁴⁷.
    const double volume = size * size * (size + other_size), bound = 0x1p-47 * volume + margin;
    if (!(volume > filter_smallest && volume < filter_largest)) return false;
    int side = 0, shared = 0;
    for (int k = 0; k < 3; ++k) {
      if (ids[k] == mine[0] || ids[k] == mine[1] || ids[k] == mine[2]) {
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

// The tests of one edit, on faces prepared once.
class Inspection {
 public:
  Inspection(const Complex& complex, const ComplexEdit& edit, const GuardContext& context)
      : complex_(complex),
        edit_(edit),
        families_(context.families),
        moved_(context.moved),
        clearance_(context.clearance),
        count_(static_cast<std::uint32_t>(edit.new_faces.size())) {
    faces_.reserve(count_);
    for (const auto& f : edit.new_faces) {
      std::array<Vec3, 3> corners;
      std::array<std::uint32_t, 3> ids;
      bool rounded = moved_.empty();
      for (int k = 0; k < 3; ++k) {
        corners[k] = point(f.v[k]);
        ids[k] = f.v[k].value;
        rounded = rounded || is_moved(f.v[k]);
      }
      const Box3 box = box_of(corners[0], corners[1], corners[2]);
      const double apart = f.crack > 0 ? clearance_ : 0;
      // An exact face of a crack may still be too near to a face that an earlier step has rounded.
      faces_.push_back({.corners = corners,
                        .ids = ids,
                        .box = box.grown(apart),
                        .plane = Plane(corners, box, apart),
                        .family = ~0u,
                        .rounded = rounded,
                        .tested = rounded || apart > 0,
                        .cracked = f.crack > 0});
    }
    for (const Family& family : families_)
      for (auto i = family.first; i < family.end; ++i)
        if (family.whole) faces_[i].family = family.first;
  }

  // A face with the opposite orientation of its family's triangle, or without area.
  Fault find_flipped() const {
    for (const Family& family : families_) {
      const auto [axis, expected] = projection_axis(family.plane[0], family.plane[1], family.plane[2]);
      for (auto i = family.first; i < family.end; ++i) {
        const auto& c = faces_[i].corners;
        const int turn = orient2d(c[0], c[1], c[2], axis);
        if (turn == 0) return {"rounding would leave a face without area", {i}};
        if (turn != expected) return {"rounding would turn a face over", {i}};
        if (clearance_ > 0 && faces_[i].rounded && faces_[i].cracked && height_of(c) < clearance_)
          return {"rounding would leave a face that is too thin", {i}};
      }
    }
    return {};
  }

  // Two vertices that rounding has left a few ulps from each other: no later step could round
  // slivers between them.
  Fault find_coincident() const {
    // Sorted along a generic direction: no model is likely to be flat across it.
    const Vec3 along(0.5412, 0.6173, 0.5710);
    std::vector<std::pair<double, VertexId>> sorted;
    sorted.reserve(3 * faces_.size());
    std::vector<bool> unseen(edit_.new_vertices.size(), true);
    for (const auto& f : edit_.new_faces)
      for (const VertexId v : f.v) {
        if (v.value >= complex_.vertex_count()) {
          const auto i = v.value - complex_.vertex_count();
          if (!unseen[i]) continue;
          unseen[i] = false;
        }
        sorted.push_back({along.dot(point(v)), v});
      }
    std::sort(sorted.begin(), sorted.end());
    // At least 16 ulps (2⁻⁵²) of the diagonal, also for edits without a clearance.
    const double close = std::max(clearance_, 0x1p-48 * complex_.extent().diagonal());
    // Differences of at most `close` per coordinate project to at most √3 · close < 2 · close.
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

  // A new face that crosses, or is too near to, a kept face.
  Fault find_crossing_with_kept(const crack::Pause& pause) const {
    std::vector<FaceId> removed = edit_.removed_faces, looked_up;
    std::sort(removed.begin(), removed.end());
    for (std::size_t at = 0, next; at < families_.size(); at = next) {
      crack::pause_now(pause);
      // Families with the same list of near faces are tested together.
      const Family& family = families_[at];
      for (next = at + 1; next < families_.size() && !family.near.empty() &&
                          families_[next].near.data() == family.near.data() &&
                          families_[next].first == families_[next - 1].end;)
        ++next;
      const auto end = families_[next - 1].end;
      Box3 box;
      for (auto i = family.first; i < end; ++i)
        if (faces_[i].tested) box.add(faces_[i].box);
      if (box.empty() || (family.near_known && family.near.empty())) continue;
      looked_up.clear();
      if (!family.near_known) complex_.faces_near(box, looked_up);
      for (const FaceId f : family.near_known ? family.near : std::span<const FaceId>(looked_up)) {
        const Box3& kept_box = complex_.box(f);
        if (!kept_box.meets(box) || std::binary_search(removed.begin(), removed.end(), f)) continue;
        const double size = (kept_box.hi - kept_box.lo).maxCoeff();
        for (auto i = family.first; i < end; ++i) {
          const TestedFace& face = faces_[i];
          if (!face.tested || !kept_box.meets(face.box)) continue;
          const auto corners = complex_.corners(f);
          const auto& v = complex_.face(f).v;
          const std::array<std::uint32_t, 3> ids{v[0].value, v[1].value, v[2].value};
          if (face.plane.clears(face.ids, ids, corners, size)) continue;
          const bool cracked = complex_.face(f).crack > 0;
          const TestedFace kept{.corners = corners,
                                .ids = ids,
                                .box = kept_box,
                                .plane = Plane(corners, kept_box, cracked ? clearance_ : 0),
                                .family = ~0u,
                                .rounded = false,
                                .tested = false,
                                .cracked = cracked};
          if (const char* what = fault_between(face, kept))
            return {std::string(what) + " face " + std::to_string(f.value), {i}};
        }
      }
    }
    return {};
  }

  // Two new faces that cross or are too near. The first pair along the longest axis is reported.
  Fault find_crossing_among_new(const crack::Pause& pause) const {
    const crack::PauseOfThread pause_here(pause);
    Box3 all;
    std::vector<Box3> boxes;
    boxes.reserve(count_);
    for (const TestedFace& f : faces_) {
      all.add(f.box);
      boxes.push_back(f.box);
    }
    int axis = 0;
    if (count_ > 0) (all.hi - all.lo).maxCoeff(&axis);
    const auto before = [&](std::uint32_t i, std::uint32_t j) {
      const double x = faces_[i].box.lo[axis], y = faces_[j].box.lo[axis];
      return x != y ? x < y : i < j;
    };
    const auto keep_faults = [&](AabbTree::Pairs& pairs) {
      pause_here();
      std::erase_if(pairs, [&](auto& pair) {
        if (before(pair.second, pair.first)) std::swap(pair.first, pair.second);
        const TestedFace &a = faces_[pair.first], &b = faces_[pair.second];
        // Children of one triangle, all there and none turned over, cover it once, as before
        // rounding.
        return !(a.tested || b.tested) || (a.family != ~0u && a.family == b.family) || !fault_between(a, b);
      });
    };
    const auto pairs = meeting_pairs(boxes, keep_faults);
    if (pairs.empty()) return {};
    const auto [i, j] = *std::min_element(pairs.begin(), pairs.end(), [&](const auto& x, const auto& y) {
      return x.first != y.first ? before(x.first, y.first) : before(x.second, y.second);
    });
    return {std::string(fault_between(faces_[i], faces_[j])) + " another new face", {i, j}};
  }

 private:
  struct TestedFace {
    std::array<Vec3, 3> corners;
    std::array<std::uint32_t, 3> ids;  // of the vertices
    Box3 box;
    Plane plane;
    std::uint32_t family;  // first child of its family where all are known not to overlap, else ~0u
    bool rounded;          // has a vertex that rounding moved
    bool tested;           // against other faces
    bool cracked;          // of a crack, not of the skin
  };

  const Vec3& point(VertexId v) const { return point_after(complex_, edit_, v); }
  bool is_moved(VertexId v) const {
    return v.value >= complex_.vertex_count() && (moved_.empty() || moved_[v.value - complex_.vertex_count()]);
  }
  // True when corners or edges of two triangles that share no id are nearer to each other than the
  // clearance.
  bool too_near(const TestedFace& face, const TestedFace& other) const {
    const auto &f = face.ids, &g = other.ids;
    const auto &p = face.corners, &q = other.corners;
    const auto in = [](std::uint32_t v, const std::array<std::uint32_t, 3>& t) {
      return v == t[0] || v == t[1] || v == t[2];
    };
    const auto near = [&](const Vec3& x, const Plane& plane, const std::array<Vec3, 3>& t) {
      return std::abs(plane.normal.dot(x - plane.at)) <= plane.margin &&
             (closest_point_on_triangle(x, t[0], t[1], t[2]) - x).norm() < clearance_;
    };
    for (int i = 0; i < 3; ++i) {
      if ((!in(f[i], g) && near(p[i], other.plane, q)) || (!in(g[i], f) && near(q[i], face.plane, p))) return true;
      const int m = (i + 1) % 3;
      for (int j = 0; j < 3; ++j) {
        const int n = (j + 1) % 3;
        if (f[i] == g[j] || f[i] == g[n] || f[m] == g[j] || f[m] == g[n]) continue;
        // |volume| / |across| is the distance of their lines; both are 0 for parallel ones.
        const Vec3 across = (p[m] - p[i]).cross(q[n] - q[j]);
        const double volume = across.dot(q[j] - p[i]);
        if (volume * volume > clearance_ * clearance_ * across.squaredNorm()) continue;
        if (distance_between_segments(p[i], p[m], q[j], q[n]) < clearance_) return true;
      }
    }
    return false;
  }
  const char* fault_between(const TestedFace& f, const TestedFace& g) const {
    if (f.plane.clears(f.ids, g.ids, g.corners, g.plane.size) || g.plane.clears(g.ids, f.ids, f.corners, f.plane.size))
      return nullptr;
    if (faces_cross(f.ids, f.corners, g.ids, g.corners)) return "rounding would make a new face cross";
    if (clearance_ > 0 && f.cracked && g.cracked && too_near(f, g))
      return "rounding would leave a new face too near to";
    return nullptr;
  }

  const Complex& complex_;
  const ComplexEdit& edit_;
  std::span<const Family> families_;
  std::span<const std::uint8_t> moved_;
  double clearance_;
  std::uint32_t count_;
  std::vector<TestedFace> faces_;
};

}  // namespace

Fault find_fault(const Complex& complex, const ComplexEdit& edit, const GuardContext& context,
                 const crack::Pause& pause) {
  crack::pause_now(pause);
  const Inspection inspection(complex, edit, context);
  Fault fault = inspection.find_flipped();
  if (!fault) fault = inspection.find_coincident();
  crack::pause_now(pause);
  if (!fault) fault = find_radial_fault(complex, edit, context.moved);
  if (!fault) fault = inspection.find_crossing_with_kept(pause);
  crack::pause_now(pause);
  if (!fault) fault = inspection.find_crossing_among_new(pause);
  crack::pause_now(pause);
  if (!fault) fault = find_reentry(complex, edit, context.exits);
  return fault;
}

Fault snap_repair(const Complex& complex, ComplexEdit& edit, const GuardContext& context, std::size_t& repairs,
                  const crack::Pause& pause) {
  Fault fault = find_fault(complex, edit, context, pause);
  if (!fault) return fault;
  const Box3& extent = complex.extent();
  const double ulp = 0x1p-52 * (extent.diagonal() + extent.lo.cwiseAbs().cwiseMax(extent.hi.cwiseAbs()).maxCoeff());
  // Children that were left out do not follow displaced points, so families of the strip no longer
  // cover their triangle.
  std::vector<Family> families(context.families.begin(), context.families.end());
  for (Family& family : families) family.whole = family.whole && edit.new_faces[family.first].parent.valid();
  GuardContext displaced = context;
  displaced.families = families;
  Random random(edit.new_faces.size() * 0x9e3779b97f4a7c15ull + edit.new_vertices.size());
  for (int tries = 0; tries < 32; ++tries) {
    // Displaces the rounded points of the faulty faces by up to 2^⌊tries/2⌋ ≤ 2¹⁵ ulps of the
    // model's size. More tries: fewer steps are refused, refused ones take longer.
    const double distance = ulp * std::pow(2.0, tries / 2);
    std::vector<std::pair<std::uint32_t, Vec3>> before;
    for (const auto f : fault.faces)
      for (const VertexId v : edit.new_faces[f].v) {
        if (v.value < complex.vertex_count() || !context.moved[v.value - complex.vertex_count()]) continue;
        const std::uint32_t i = v.value - complex.vertex_count();
        before.push_back({i, edit.new_vertices[i]});
        const Vec3 direction = random.direction();
        edit.new_vertices[i] += distance * random.uniform(0.5, 1.0) * direction;
      }
    if (before.empty()) return fault;
    Fault now = find_fault(complex, edit, displaced, pause);
    if (!now) {
      ++repairs;
      return now;
    }
    if (now.faces == fault.faces)
      for (auto b = before.rbegin(); b != before.rend(); ++b) edit.new_vertices[b->first] = b->second;
    else
      fault = std::move(now);  // the first fault is removed, this is the next one
  }
  return fault;
}

}  // namespace geo
