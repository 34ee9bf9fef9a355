// Complex::difference() of kerf/complex.h. Faces with equal vertices, crack and orientation are
// kept. A new face is the child of the removed face of its crack nearest to its centroid. Radial
// orders are copied from the other complex.
#include <algorithm>
#include <map>
#include <set>
#include <unordered_map>

#include "geometry/distance.h"
#include "geometry/triangle_index.h"
#include "kerf/complex.h"
#include "kerf/error.h"
#include "surface/face_key.h"

namespace geo {
namespace {

class Difference {
 public:
  Difference(const Complex& from, const Complex& to) : from_(from), to_(to) {
    // Corners of a divided face are off its plane by rounding, which grows with the distance from
    // the origin.
    const Box3& extent = from.extent();
    const double rounding = 0x1p-50 * extent.hi.cwiseAbs().cwiseMax(extent.lo.cwiseAbs()).maxCoeff();
    // Relative to the diagonal: 1e-9 to find candidate faces by their boxes, 1e-7 to count as lying
    // on one. Larger values accept a surface that has been moved slightly.
    search_reach_ = 1e-9 * extent.diagonal() + rounding;
    tolerance_ = 1e-7 * extent.diagonal() + rounding;
  }

  ComplexEdit edit() {
    check_vertices();
    for (std::uint32_t v = from_.vertex_count(); v < to_.vertex_count(); ++v)
      edit_.new_vertices.push_back(to_.point(VertexId(v)));
    match_faces();
    for (const FaceId f : new_faces_) add_face(f);
    check_removed_faces();
    give_radial_orders();
    return std::move(edit_);
  }

 private:
  void check_vertices() const {
    for (std::uint32_t v = to_.vertex_count(); v < from_.vertex_count(); ++v)
      if (!from_.faces_at(VertexId(v)).empty())
        throw InputError("the surface has not grown from the body's: it has fewer vertices");
    const std::uint32_t common = std::min(from_.vertex_count(), to_.vertex_count());
    for (std::uint32_t v = 0; v < common; ++v)
      if (!from_.faces_at(VertexId(v)).empty() && !to_.faces_at(VertexId(v)).empty() &&
          from_.point(VertexId(v)) != to_.point(VertexId(v)))
        throw InputError("the surface has not grown from the body's: vertex " + std::to_string(v) + " is elsewhere");
  }

  // Faces of the same vertices, crack and orientation are kept; the others are removed or new.
  void match_faces() {
    std::map<std::array<std::uint32_t, 3>, FaceId> mine;
    for (std::uint32_t f = 0; f < from_.face_count(); ++f)
      if (from_.alive(FaceId(f))) mine[face_key(from_.face(FaceId(f)).v)] = FaceId(f);
    std::vector<bool> kept(from_.face_count(), false);
    for (std::uint32_t f = 0; f < to_.face_count(); ++f) {
      if (!to_.alive(FaceId(f))) continue;
      const auto& face = to_.face(FaceId(f));
      const auto it = mine.find(face_key(face.v));
      if (it != mine.end() && from_.face(it->second).crack == face.crack &&
          is_even(from_.face(it->second).v) == is_even(face.v)) {
        translated_[FaceId(f)] = it->second;
        kept[it->second.index()] = true;
      } else {
        translated_[FaceId(f)] = FaceId(from_.face_count() + static_cast<std::uint32_t>(new_faces_.size()));
        new_faces_.push_back(FaceId(f));
      }
    }
    for (std::uint32_t f = 0; f < from_.face_count(); ++f)
      if (from_.alive(FaceId(f)) && !kept[f]) {
        edit_.removed_faces.push_back(FaceId(f));
        removed_.insert(f, from_.box(FaceId(f)));
      }
  }

  static Vec3 centroid(const std::array<Vec3, 3>& c) { return (c[0] + c[1] + c[2]) / 3; }
  static double distance(const Vec3& p, const std::array<Vec3, 3>& t) {
    return (closest_point_on_triangle(p, t[0], t[1], t[2]) - p).norm();
  }

  // The removed face of the same crack that the centroid lies on.
  FaceId parent_of(FaceId f) {
    const Vec3 middle = centroid(to_.corners(f));
    candidates_.clear();
    removed_.find(Box3{middle, middle}.grown(search_reach_), candidates_);
    FaceId parent;
    double best = tolerance_;
    for (const auto id : candidates_) {
      if (from_.face(FaceId(id)).crack != to_.face(f).crack) continue;
      const double d = distance(middle, from_.corners(FaceId(id)));
      if (d < best) {
        best = d;
        parent = FaceId(id);
      }
    }
    return parent;
  }

  void touch_edges(const std::array<VertexId, 3>& v) {
    for (std::size_t k = 0; k < 3; ++k) touched_.insert(std::minmax(v[k], v[(k + 1) % 3]));
  }

  void add_face(FaceId f) {
    const auto& face = to_.face(f);
    const FaceId parent = parent_of(f);
    if (face.crack == 0 && !parent.valid())
      throw InputError("the surface has not grown from the body's: it has skin where the body has none");
    edit_.new_faces.push_back({face.v, face.crack, parent});
    touch_edges(face.v);
  }

  // A crack must still be there after the edit: a body's nodes lie on its sides.
  void check_removed_faces() {
    TriangleIndex made;
    for (const FaceId f : new_faces_) made.insert(f.value, to_.box(f));
    for (const FaceId f : edit_.removed_faces) {
      const Vec3 middle = centroid(from_.corners(f));
      const std::int32_t crack = from_.face(f).crack;
      candidates_.clear();
      made.find(Box3{middle, middle}.grown(tolerance_), candidates_);
      const bool found = std::any_of(candidates_.begin(), candidates_.end(), [&](std::uint32_t id) {
        return to_.face(FaceId(id)).crack == crack && distance(middle, to_.corners(FaceId(id))) < tolerance_;
      });
      if (!found)
        throw InputError(crack > 0 ? "crack " + std::to_string(crack) +
                                         " of the body was moved since; build the body anew from the new surface"
                                   : "the surface has not grown from the body's: skin is gone");
    }
  }

  void give_radial_orders() {
    for (const FaceId f : edit_.removed_faces) touch_edges(from_.face(f).v);
    for (const auto& edge : touched_) {
      const RadialCycle cycle = to_.faces_around(edge.first, edge.second);
      if (cycle.size() < 3) continue;
      ComplexEdit::RadialOrder order{edge.first, edge.second, {}};
      for (const FaceId f : cycle) order.faces.push_back(translated_.at(f));
      edit_.radial_orders.push_back(std::move(order));
    }
  }

  const Complex &from_, &to_;
  double search_reach_ = 0, tolerance_ = 0;  // model units
  ComplexEdit edit_;
  std::vector<FaceId> new_faces_;                  // of to_
  std::unordered_map<FaceId, FaceId> translated_;  // ids of to_ → ids of from_ after the edit
  TriangleIndex removed_;
  std::set<std::pair<VertexId, VertexId>> touched_;  // edges, lower end first
  std::vector<std::uint32_t> candidates_;
};

}  // namespace

ComplexEdit Complex::difference(const Complex& other) const { return Difference(*this, other).edit(); }

}  // namespace geo
