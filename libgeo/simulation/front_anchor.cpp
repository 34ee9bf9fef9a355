// Only the change along the normal of the sheet turns it; a change within the sheet makes the edge
// faster or slower. Points without a sheet behind them are not corrected.
#include "simulation/front_anchor.h"

#include <algorithm>

#include "kerf/parallel.h"

namespace geo {
namespace {

constexpr double reach = 2;  // spacings, of a correction; measured in docs/decisions/086

// Faces lower than this, in sizes of the model, have no normal: places of blades are rounded to
// 2⁻³³ of the size (mapped_places.h), and a face a thousand times as high turns by a thousandth.
constexpr double lowest_face = 0x1p-23;

// Per front point: the sum of the normals of the sheet's faces beside it, each as long as twice its
// area; zero where it has none.
std::vector<Vec3> sheet_normals(const Complex& surface, const FrontState& front) {
  const double lowest = lowest_face * surface.extent().diagonal();
  std::vector<Vec3> normals(front.points.size(), Vec3::Zero());
  for (std::size_t s = 0; s < front.segments.size(); ++s) {
    const auto& segment = front.segments[s];
    for (std::size_t k = 0; k + 1 < segment.size(); ++k) {
      const VertexId a = segment[k].id, b = segment[k + 1].id;
      if (!a.valid() || !b.valid() || a == b) continue;
      for (const FaceId f : surface.faces_around(a, b)) {
        if (surface.face(f).crack != front.crack) continue;
        const auto t = surface.corners(f);
        const Vec3 n = (t[1] - t[0]).cross(t[2] - t[0]);
        const double longest = std::max({(t[1] - t[0]).norm(), (t[2] - t[1]).norm(), (t[0] - t[2]).norm()});
        if (n.norm() < lowest * longest) continue;
        for (const std::size_t i : {s, (s + 1) % normals.size()}) normals[i] += n.dot(normals[i]) < 0 ? Vec3(-n) : n;
      }
    }
  }
  return normals;
}

}  // namespace

FrontAnchor::FrontAnchor(const Complex& surface, const MapAt& start, const Blade& blade, const EdgeFront& edge)
    : at_(edge.at), change_(edge.at.size(), Vec3::Zero()) {
  const std::vector<Vec3> normals = sheet_normals(surface, edge.front);
  for (std::size_t i = 0; i < at_.size(); ++i) place_.push_back(edge.front.points[i].position);
  parallel_for(at_.size(), 8, [&](std::size_t begin, std::size_t end) {
    InverseDeformation::VertexCache memory;
    for (std::size_t i = begin; i < end; ++i) {
      if (!edge.front.points[i].id.valid() || normals[i].isZero(0)) continue;
      const auto mapped = start.map().to_material(start.pose() * place_on(blade, at_[i]), memory, &place_[i]);
      if (!mapped.in_support) continue;
      const Vec3 normal = normals[i].normalized();
      change_[i] = normal.dot(mapped.position - place_[i]) * normal;
    }
  });
}

Vec3 FrontAnchor::corrected(double at, const Vec3& place, double spacing) const {
  const auto k = static_cast<std::size_t>(std::lower_bound(at_.begin(), at_.end(), at) - at_.begin());
  const std::size_t after = std::min(k, at_.size() - 1), before = k > 0 && k < at_.size() ? k - 1 : after;
  const double t = before < after ? (at - at_[before]) / (at_[after] - at_[before]) : 1;
  const Vec3 from = place_[before] + t * (place_[after] - place_[before]);
  const double share = std::max(0.0, 1 - (place - from).norm() / (reach * spacing));
  return place - share * (change_[before] + t * (change_[after] - change_[before]));
}

}  // namespace geo
