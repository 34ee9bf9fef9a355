#include "contact/response/body_contact.h"

#include <algorithm>
#include <map>

#include "contact/surface/contact_surface.h"
#include "geometry/distance.h"
#include "geometry/predicates.h"
#include "mechanics/discretisation/point_map.h"

namespace geo {
namespace {

// The place on a body's surface that is nearest to a point in its material.
struct Nearest {
  Side side{FaceId(), 0};
  Vec3 weight = Vec3::Zero();  // of the side's corners
  Vec3 point = Vec3::Zero();
};

class Surroundings {
 public:
  Surroundings(const Body& body, const SurfaceWeights& weights, const std::vector<std::uint32_t>& part,
               const std::vector<Vec3>& u)
      : body_(body), weights_(weights), part_(part), u_(u) {}

  std::uint32_t part_of(SurfaceVertexId v) const {
    return weights_.row(v.index()).empty() ? ~0u : part_[weights_.row(v.index())[0].node];
  }
  Vec3 material(SurfaceVertexId v) const { return body_.surface.point(body_.surface.site(v)); }
  Vec3 world(SurfaceVertexId v) const { return material(v) + weights_.at(v.index(), u_); }
  Vec3 world(const Nearest& n, int which) const {
    Vec3 sum = Vec3::Zero();
    for (int k = 0; k < 3; ++k) sum += n.weight[k] * world(body_.surface.surface_vertex({n.side.face, which}, k));
    return sum;
  }

  // False: none within reach, or x lies beyond a crack from its anchor, in the gap.
  bool nearest(const Vec3& x, const Vec3& anchor, std::uint32_t part, double reach, Nearest& found) {
    const Complex& k = body_.surface;
    faces_.clear();
    k.faces_near(Box3{x, x}.grown(reach), faces_);
    double least = reach, squarely = 0;
    found.side.face = FaceId();
    for (const FaceId f : faces_) {
      const bool crack = k.face(f).crack != 0;
      if (part_of(k.surface_vertex({f, 0}, 0)) != part) continue;
      const auto c = k.corners(f);
      if (crack && segment_meets_triangle(anchor, x, c[0], c[1], c[2])) return false;
      const Vec3 on = closest_point_on_triangle(x, c[0], c[1], c[2]), away = x - on,
                 normal = (c[1] - c[0]).cross(c[2] - c[0]).normalized();
      const double d = away.norm(), square = std::abs(normal.dot(away));
      // Of triangles that share the nearest place the one that looks at x most squarely tells the
      // side.
      if (!(d < least || (d == least && square > squarely))) continue;
      Nearest n{{f, crack && normal.dot(away) > 0 ? 1 : 0}, barycentric(on, c[0], c[1], c[2]), on};
      if (crack && !((world(n, 0) - world(n, 1)).norm() > d)) continue;
      least = d, squarely = square, found = n;
    }
    return found.side.face.valid();
  }

 private:
  const Body& body_;
  const SurfaceWeights& weights_;
  const std::vector<std::uint32_t>& part_;
  const std::vector<Vec3>& u_;
  std::vector<FaceId> faces_;
};

}  // namespace

BodyContactPenalty body_contact(const Body& body, const Solid& solid, const SurfaceWeights& weights,
                                const std::vector<std::uint32_t>& part, const std::vector<Vec3>& u,
                                const BodyContactOptions& options) {
  BodyContactPenalty contact(options.friction, options.slow);
  const std::uint32_t parts = part.empty() ? 0 : *std::max_element(part.begin(), part.end()) + 1;
  if (parts < 2) return contact;
  const Complex& k = body.surface;
  Surroundings around(body, weights, part, u);
  const NodeGradients gradient = solid.gradients_when_asked(u);
  std::vector<Box3> box(parts);
  std::vector<std::pair<SurfaceVertexId, Vec3>> vertices;
  for (std::uint32_t v = 0; v < k.surface_vertex_count(); ++v) {
    const SurfaceVertexId id(v);
    if (!k.alive(id) || weights.row(v).empty()) continue;
    vertices.push_back({id, around.world(id)});
    box[around.part_of(id)].add(vertices.back().second);
  }
  for (std::uint32_t p = 0; p < parts; ++p) {
    std::vector<std::pair<SurfaceVertexId, Vec3>> near;
    Box3 about;
    for (const auto& v : vertices)
      if (around.part_of(v.first) != p && box[p].grown(options.reach).meets({v.second, v.second}))
        near.push_back(v), about.add(v.second);
    if (near.empty()) continue;
    std::vector<std::uint8_t> counted;
    for (const auto q : part) counted.push_back(q == p);
    const PointMap map(body, u, gradient, about, std::move(counted));
    PointMap::Memory memory;
    for (const auto& [v, y] : near) {
      const PointMap::Place place = map.material(y, memory);
      Nearest n;
      if (!place.within ||
          !around.nearest(place.material, body.nodes.position[place.anchor.index()], p, options.reach, n))
        continue;
      Vec3 at[3];
      std::map<std::uint32_t, double> apart;
      for (const auto& e : weights.row(v.index())) apart[e.node] += e.weight;
      for (int c = 0; c < 3; ++c) {
        const SurfaceVertexId corner = k.surface_vertex(n.side, c);
        at[c] = around.world(corner);
        for (const auto& e : weights.row(corner.index())) apart[e.node] -= n.weight[c] * e.weight;
      }
      const Vec3 normal = (n.side.which == 0 ? 1.0 : -1.0) * (at[1] - at[0]).cross(at[2] - at[0]).normalized();
      if (!normal.allFinite() || normal.isZero(0)) continue;
      std::vector<SurfaceWeights::Entry> entries;
      for (const auto& [node, w] : apart) entries.push_back({node, w});
      const auto firm = [&](SurfaceVertexId of) {
        return options.firmness.empty() ? 1.0 : options.firmness[weights.heaviest()[of.index()]];
      };
      const double pressure = 0.5 * options.pressure * std::max(firm(v), firm(k.surface_vertex(n.side, 0)));
      contact.add(std::move(entries), around.material(v) - n.point, normal, pressure * weights.area(v.index()));
    }
  }
  return contact;
}

}  // namespace geo
