// Surface vertices of other bodies are mapped to this body's material by the inverse deformation.
// The nearest point of the undeformed surface gives the contact; its deformed triangle the normal.
#include "contact/response/body_contact.h"

#include <algorithm>
#include <map>
#include <optional>

#include "geometry/distance.h"
#include "geometry/predicates.h"
#include "mechanics/discretisation/inverse_deformation.h"
#include "mechanics/solver/solid_discretisation.h"

namespace geo {
namespace {

// A point on the surface of a body.
struct SidePoint {
  Side side{FaceId(), 0};
  Vec3 weight = Vec3::Zero();  // of the side's corners
  Vec3 point = Vec3::Zero();   // material coordinates
};

class BodyContactFinder {
 public:
  BodyContactFinder(const BodyContactInput& input, const BodyContactOptions& options)
      : in_(input), options_(options), contacts_(options.friction, options.slip_regularisation) {}

  BodyContactPenalty run() {
    const auto& index = in_.body_index;
    const std::uint32_t bodies = index.empty() ? 0 : *std::max_element(index.begin(), index.end()) + 1;
    if (bodies < 2) return contacts_;
    const LazyNodalGradients gradient = lazy_gradients(in_.solid.discretisation(), in_.displacement);
    std::vector<Box3> box(bodies);
    for (std::uint32_t v = 0; v < complex().surface_vertex_count(); ++v) {
      const SurfaceVertexId id(v);
      if (!complex().alive(id) || in_.weights.stencil(v).empty()) continue;
      vertices_.push_back({id, world(id)});
      box[body_of(id)].add(vertices_.back().world);
    }
    for (std::uint32_t b = 0; b < bodies; ++b) add_contacts_inside(b, box[b], gradient);
    return std::move(contacts_);
  }

 private:
  struct Vertex {
    SurfaceVertexId id;
    Vec3 world;
  };

  const Complex& complex() const { return in_.body.surface; }
  std::uint32_t body_of(SurfaceVertexId v) const {
    const Stencil carriers = in_.weights.stencil(v.index());
    return carriers.empty() ? ~0u : in_.body_index[carriers[0].node];
  }
  Vec3 material(SurfaceVertexId v) const { return complex().point(complex().site(v)); }
  Vec3 world(SurfaceVertexId v) const { return material(v) + in_.weights.interpolate(v.index(), in_.displacement); }
  // The point's position where it is on the given side of its face.
  Vec3 world(const SidePoint& p, int which) const {
    Vec3 sum = Vec3::Zero();
    for (int k = 0; k < 3; ++k) sum += p.weight[k] * world(complex().surface_vertex({p.side.face, which}, k));
    return sum;
  }

  // Adds contacts of vertices of other bodies in body b, whose deformed surface has this box.
  void add_contacts_inside(std::uint32_t b, const Box3& box, const LazyNodalGradients& gradient) {
    std::vector<Vertex> near;
    Box3 near_box;
    for (const Vertex& v : vertices_)
      if (body_of(v.id) != b && box.grown(options_.reach).meets({v.world, v.world}))
        near.push_back(v), near_box.add(v.world);
    if (near.empty()) return;
    std::vector<std::uint8_t> of_body;
    for (const auto other : in_.body_index) of_body.push_back(other == b);
    const InverseDeformation map(in_.body, in_.displacement, gradient, near_box, std::move(of_body));
    InverseDeformation::VertexCache memory;
    for (const Vertex& v : near) {
      const InverseDeformation::Location mapped = map.to_material(v.world, memory);
      if (!mapped.in_support) continue;
      const auto nearest = nearest_point(mapped.position, in_.body.nodes.position[mapped.nearest.index()], b);
      if (nearest) add_contact(v.id, *nearest);
    }
  }

  // The point of body b's surface nearest to x, material coordinates. None if no surface is within
  // reach, or if a crack lies between x and `anchor`, the node that mapped it: x is in an open gap.
  std::optional<SidePoint> nearest_point(const Vec3& x, const Vec3& anchor, std::uint32_t b) {
    faces_.clear();
    complex().faces_near(Box3{x, x}.grown(options_.reach), faces_);
    std::optional<SidePoint> found;
    double least = options_.reach, most_frontal = 0;
    for (const FaceId f : faces_) {
      const bool crack = complex().face(f).crack != 0;
      if (body_of(complex().surface_vertex({f, 0}, 0)) != b) continue;
      const auto c = complex().corners(f);
      if (crack && segment_meets_triangle(anchor, x, c[0], c[1], c[2])) return {};
      const Vec3 on = closest_point_on_triangle(x, c[0], c[1], c[2]), away = x - on,
                 normal = (c[1] - c[0]).cross(c[2] - c[0]).normalized();
      const double d = away.norm(), frontal = std::abs(normal.dot(away));
      // Several triangles may share the nearest point: the largest |normal · (x − point)| decides
      // the side.
      if (!(d < least || (d == least && frontal > most_frontal))) continue;
      const SidePoint p{{f, crack && normal.dot(away) > 0 ? 1 : 0}, barycentric(on, c[0], c[1], c[2]), on};
      if (crack && !((world(p, 0) - world(p, 1)).norm() > d)) continue;
      least = d, most_frontal = frontal, found = p;
    }
    return found;
  }

  void add_contact(SurfaceVertexId v, const SidePoint& p) {
    Vec3 corner[3];
    std::map<std::uint32_t, double> stencil;
    for (const auto& e : in_.weights.stencil(v.index())) stencil[e.node] += e.weight;
    for (int c = 0; c < 3; ++c) {
      const SurfaceVertexId id = complex().surface_vertex(p.side, c);
      corner[c] = world(id);
      for (const auto& e : in_.weights.stencil(id.index())) stencil[e.node] -= p.weight[c] * e.weight;
    }
    const Vec3 normal =
        (p.side.which == 0 ? 1.0 : -1.0) * (corner[1] - corner[0]).cross(corner[2] - corner[0]).normalized();
    if (!normal.allFinite() || normal.isZero(0)) return;  // a collapsed triangle
    std::vector<NodeWeight> entries;
    for (const auto& [node, weight] : stencil) entries.push_back({node, weight});
    const double factor = std::max(pressure_factor(v), pressure_factor(complex().surface_vertex(p.side, 0)));
    const double pressure = 0.5 * options_.pressure * factor;  // vertices of both bodies act: half each
    contacts_.add(std::move(entries), material(v) - p.point, normal, pressure * in_.weights.area(v.index()));
  }
  double pressure_factor(SurfaceVertexId v) const {
    return options_.pressure_factor.empty() ? 1.0 : options_.pressure_factor[in_.weights.heaviest()[v.index()]];
  }

  const BodyContactInput& in_;
  const BodyContactOptions& options_;
  BodyContactPenalty contacts_;
  std::vector<Vertex> vertices_;  // of all bodies, world
  std::vector<FaceId> faces_;     // scratch
};

}  // namespace

BodyContactPenalty find_body_contacts(const BodyContactInput& input, const BodyContactOptions& options) {
  return BodyContactFinder(input, options).run();
}

}  // namespace geo
