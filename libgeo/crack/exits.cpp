// Inside or outside around a vertex: parity of the faces that an arc of directions crosses, from
// the line's direction to a point on one face of the fan. The rest of the line is tested exactly
// against the skin, through a box tree of the new faces where there are many pairs.
#include "crack/exits.h"

#include <algorithm>
#include <optional>

#include "geometry/bvh.h"
#include "geometry/predicates.h"

namespace geo {
namespace {

// Pairs of exits and faces that are tested without an index; the result does not depend on it.
constexpr std::size_t few = 1 << 14;

// The skin around the exits, after the edit. An exit is a piece of the front's line outside.
class Surroundings {
 public:
  Surroundings(const Complex& complex, const ComplexEdit& edit, std::span<const FrontExit> exits)
      : complex_(complex), edit_(edit), removed_(edit.removed_faces) {
    std::sort(removed_.begin(), removed_.end());
    std::vector<VertexId> ends;
    for (const FrontExit& e : exits) {
      ends.push_back(e.from);
      if (e.at.valid()) ends.push_back(e.at);
    }
    std::sort(ends.begin(), ends.end());
    for (std::uint32_t i = 0; i < edit.new_faces.size(); ++i) {
      for (const VertexId v : edit.new_faces[i].v)
        if (std::binary_search(ends.begin(), ends.end(), v)) at_.push_back({v, i});
      if (edit.new_faces[i].crack == 0) skin_.push_back(i);
    }
    std::sort(at_.begin(), at_.end());
    if (exits.size() * skin_.size() <= few) return;
    std::vector<std::array<Vec3, 3>> corners;
    for (const auto i : skin_) corners.push_back(corners_of(edit.new_faces[i].v));
    index_.emplace(corners);
  }

  /// New faces at a vertex.
  std::vector<std::uint32_t> new_faces(VertexId v) const {
    std::vector<std::uint32_t> faces;
    for (auto i = std::lower_bound(at_.begin(), at_.end(), std::pair(v, 0u)); i != at_.end() && i->first == v; ++i)
      faces.push_back(i->second);
    return faces;
  }

  /// Whether the line from v towards a point starts inside the skin around v.
  bool inside_at(VertexId v, const Vec3& towards) const {
    std::vector<std::array<Vec3, 3>> fan;
    const auto add = [&](const std::array<VertexId, 3>& f) {
      const auto k = static_cast<std::size_t>(std::find(f.begin(), f.end(), v) - f.begin());
      fan.push_back({point(v), point(f[(k + 1) % 3]), point(f[(k + 2) % 3])});
    };
    for (const auto i : new_faces(v))
      if (edit_.new_faces[i].crack == 0) add(edit_.new_faces[i].v);
    if (v.value < complex_.vertex_count())
      for (const FaceId f : complex_.faces_at(v))
        if (stays(f)) add(complex_.face(f).v);
    return begins_inside(point(v), towards, fan);
  }

  /// Whether an exit meets a face of the skin between its ends.
  bool meets(const FrontExit& exit) const {
    const Vec3 from = point(exit.from), to = end(exit);
    Box3 box{from, from};
    box.add(to);
    const auto met = [&](const std::array<VertexId, 3>& v) {
      if (std::any_of(v.begin(), v.end(), [&](VertexId w) { return w == exit.from || w == exit.at; })) return false;
      const auto t = corners_of(v);
      return box_of(t[0], t[1], t[2]).meets(box) && segment_meets_triangle(from, to, t[0], t[1], t[2]);
    };
    if (!index_)
      return std::any_of(skin_.begin(), skin_.end(), [&](auto i) { return met(edit_.new_faces[i].v); }) ||
             std::any_of(exit.near.begin(), exit.near.end(),
                         [&](FaceId f) { return stays(f) && met(complex_.face(f).v); });
    std::vector<std::uint32_t> near;
    index_->near(box, near);
    std::vector<FaceId> old;
    complex_.faces_near(box, old);
    return std::any_of(near.begin(), near.end(), [&](auto i) { return met(edit_.new_faces[skin_[i]].v); }) ||
           std::any_of(old.begin(), old.end(), [&](FaceId f) { return stays(f) && met(complex_.face(f).v); });
  }

  Vec3 point(VertexId v) const { return point_after(complex_, edit_, v); }
  Vec3 end(const FrontExit& exit) const { return exit.at.valid() ? point(exit.at) : exit.to; }

 private:
  std::array<Vec3, 3> corners_of(const std::array<VertexId, 3>& v) const {
    return {point(v[0]), point(v[1]), point(v[2])};
  }
  bool stays(FaceId f) const {
    return complex_.face(f).crack == 0 && !std::binary_search(removed_.begin(), removed_.end(), f);
  }

  const Complex& complex_;
  const ComplexEdit& edit_;
  std::vector<FaceId> removed_;
  std::vector<std::uint32_t> skin_;                     // new faces of it
  std::vector<std::pair<VertexId, std::uint32_t>> at_;  // new faces by the exits' ends
  std::optional<TriangleBvh> index_;                    // of skin_, where these and the exits are many
};

}  // namespace

bool begins_inside(const Vec3& u, const Vec3& q, std::span<const std::array<Vec3, 3>> fan) {
  // Parity along the arc, in a plane, from the direction of q to that of a point w on a face: each
  // other face that the arc crosses changes sides.
  constexpr std::size_t max_chosen = 4;  // w is tried on that many faces, the largest first
  std::vector<std::size_t> largest(fan.size());
  for (std::size_t i = 0; i < fan.size(); ++i) largest[i] = i;
  const auto area = [&](std::size_t i) { return (fan[i][1] - u).cross(fan[i][2] - u).squaredNorm(); };
  std::stable_sort(largest.begin(), largest.end(), [&](auto i, auto j) { return area(i) > area(j); });
  largest.resize(std::min(largest.size(), max_chosen));
  for (const auto chosen : largest)
    for (const double share : {0.5, 0.375, 0.6875}) {  // other points where the arc meets an edge
      const Vec3 w = fan[chosen][1] + share * (fan[chosen][2] - fan[chosen][1]);
      const int start = orient3d(u, fan[chosen][1], fan[chosen][2], q),
                end = orient3d(u, fan[chosen][1], fan[chosen][2], w);
      bool inside = (end != 0 ? end : start) < 0, sure = end != 0 || start != 0;
      for (std::size_t i = 0; i < fan.size() && sure; ++i) {
        const Vec3 &a = fan[i][1], &b = fan[i][2];
        const int from = orient3d(u, a, b, q), to = orient3d(u, a, b, w), of_a = orient3d(u, q, w, a),
                  of_b = orient3d(u, q, w, b);
        if (from == 0 && of_a != of_b && (q - u).dot((a - u).normalized() + (b - u).normalized()) > 0)
          return false;         // along the face
        if (to == 0) continue;  // w is in its plane: only the chosen face
        sure = of_a != 0 && of_b != 0;
        inside ^= from * to < 0 && of_a * of_b < 0 && of_a == to;
      }
      if (sure) return inside;
    }
  return false;
}

Fault find_reentry(const Complex& complex, const ComplexEdit& edit, std::span<const FrontExit> exits) {
  if (exits.empty()) return {};
  const Surroundings about(complex, edit, exits);
  for (const FrontExit& exit : exits) {
    const Vec3 from = about.point(exit.from), to = about.end(exit);
    if (!about.inside_at(exit.from, to) && !(exit.at.valid() && about.inside_at(exit.at, from)) && !about.meets(exit))
      continue;
    Fault fault{"rounding would bring the front back into the material where it leaves", about.new_faces(exit.from)};
    if (exit.at.valid())
      for (const auto i : about.new_faces(exit.at)) fault.faces.push_back(i);
    return fault;
  }
  return {};
}

}  // namespace geo
