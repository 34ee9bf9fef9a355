// Order of placement: remaining sides, divided faces (barycentric), copies of placed vertices, then
// the inside: x ↦ Σ w (p' + x − p + u(x) − u(p)) / Σ w over visible old points p, now at p'. Here
// w = |x − p|⁻⁴, and u is the blended displacement (Eq. 1).
#include "contact/embedding/surface_embedding.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "body/binding.h"
#include "body/incremental_cache.h"
#include "contact/embedding/untangle.h"
#include "geometry/distance.h"
#include "geometry/predicates.h"
#include "kerf/error.h"
#include "kerf/parallel.h"
#include "mechanics/discretisation/deformation.h"
#include "mechanics/solver/solid_discretisation.h"

namespace geo {
namespace {

// The orthonormal frame of a triangle: its first edge, a perpendicular in its plane, its normal.
Mat3 frame_of(const std::array<Vec3, 3>& t) {
  Mat3 frame;
  frame.col(0) = (t[1] - t[0]).normalized();
  frame.col(2) = (t[1] - t[0]).cross(t[2] - t[0]).normalized();
  frame.col(1) = frame.col(2).cross(frame.col(0));
  return frame;
}

// The image of x under the motion of a triangle from `rest` to `now`. x lies on the triangle
// except for the offset of rounding, which turns with the triangle: it decides whether slivers
// cross.
Vec3 carried(const Vec3& x, const std::array<Vec3, 3>& rest, const std::array<Vec3, 3>& now) {
  const Vec3 w = barycentric(x, rest[0], rest[1], rest[2]);
  const Vec3 offset = x - (w[0] * rest[0] + w[1] * rest[1] + w[2] * rest[2]);
  const Vec3 moved = w[0] * (now[0] - rest[0]) + w[1] * (now[1] - rest[1]) + w[2] * (now[2] - rest[2]);
  const Vec3 turned = frame_of(now) * (frame_of(rest).transpose() * offset) - offset;
  return x + moved + (turned.allFinite() ? turned : Vec3(Vec3::Zero()));
}

// Farthest that untangling carries a vertex with the material around it, in node spacings: the
// length of the shortest way that a front goes, below which nothing of a sheet is resolved.
constexpr double carried_spacings = 0.05;

class SurfaceEmbedder {
 public:
  explicit SurfaceEmbedder(const EmbeddingInput& input)
      : in_(input),
        k_(input.after),
        gradient_(lazy_gradients(SolidDiscretisation::of(input.solid), input.state.displacement)) {
    result_.surface = updated_contact_surface(in_.before, k_, in_.crack);
    result_.positions = in_.positions;
    result_.positions.resize(result_.surface.site.size(), Vec3::Zero());
    reference_.resize(result_.positions.size());
    for (std::uint32_t v = 0; v < reference_.size(); ++v)
      reference_[v] = v < in_.positions.size() ? SurfaceVertexId(v) : SurfaceVertexId();
    placed_.assign(result_.positions.size(), 1);
  }

  EmbeddedSurface run() {
    parallel_invoke([&] { result_.surface.edge = mean_edge(result_.surface, k_); },
                    [&] {
                      for (const auto v : in_.crack.new_surface_vertices) placed_[v.index()] = 0;
                      place_on_remaining_sides();
                      place_on_divided_faces();
                      place_across_new_faces();
                      place_inside();
                      untangle_new_triangles();
                    });
    return std::move(result_);
  }

 private:
  // `reference`: the old vertex whose nodes describe the motion of the material around v.
  void place(SurfaceVertexId v, const Vec3& at, SurfaceVertexId reference) {
    result_.positions[v.index()] = at;
    placed_[v.index()] = 1;
    reference_[v.index()] = reference;
  }

  // The old vertices of a side, in the order of its face; none if the side is new.
  std::optional<Triangle> old_side(Side side) const {
    for (auto [t, end] = in_.before.triangles_of(side.face); t < end; ++t)
      if (const auto& [a, b, c] = in_.before.triangles[t];
          in_.before.side[t] % 2 == static_cast<std::uint32_t>(side.which))
        return side.which == 0 ? Triangle{a, b, c} : Triangle{a, c, b};
    return {};
  }

  // A side that remains keeps the positions of its corners. New faces may join vertices of one
  // site that had positions of their own: cracks that only touched there. Their mean is the new
  // position.
  void place_on_remaining_sides() {
    for (const auto v : in_.crack.new_surface_vertices)
      if (k_.alive(v)) place_on_sides_at(v);
    for (const auto v : in_.crack.touched_surface_vertices)
      if (k_.alive(v)) place_on_sides_at(v);
  }

  void place_on_sides_at(SurfaceVertexId v) {
    std::vector<SurfaceVertexId> old;  // vertices of the corners of remaining sides
    for (const FaceId f : k_.faces_at(k_.site(v)))
      for (int which = 0; which < 2; ++which)
        for (int c = 0; c < 3; ++c) {
          if (!k_.has({f, which}) || k_.surface_vertex({f, which}, c) != v) continue;
          if (const auto at = old_side({f, which})) old.push_back(SurfaceVertexId((*at)[static_cast<std::size_t>(c)]));
        }
    std::sort(old.begin(), old.end());
    old.erase(std::unique(old.begin(), old.end()), old.end());
    if (old.empty()) return;
    const auto position = [&](SurfaceVertexId w) { return in_.positions[w.index()]; };
    if (std::all_of(old.begin(), old.end(), [&](auto w) { return position(w) == position(old[0]); }))
      return place(v, position(old[0]), old[0]);
    Vec3 sum = Vec3::Zero();
    for (const auto w : old) sum += position(w);
    place(v, sum / double(old.size()), old[0]);
    joined_.push_back(v);
  }

  // A part of a divided face gives its new corners their place in the face; the lowest face with
  // such a part decides. A corner on an edge is placed by the two ends of the edge alone, so that
  // copies coincide wherever the ends do.
  void place_on_divided_faces() {
    const CrackDelta& crack = in_.crack;
    std::vector<FaceId> parents = crack.removed_faces, parts;
    std::sort(parents.begin(), parents.end());
    std::set_difference(crack.new_faces.begin(), crack.new_faces.end(), crack.new_crack_faces.begin(),
                        crack.new_crack_faces.end(), std::back_inserter(parts));
    // Tolerances 1e-12 and 1e-10 of the diagonal only find parents: new corners are rounded points.
    const double size = k_.extent().diagonal();
    std::vector<std::pair<FaceId, FaceId>> part_of;  // parent, part
    // By site: the corners that all parents of its parts have; two if the site lies on their edge.
    std::map<VertexId, std::vector<VertexId>> common;
    for (const FaceId g : parents) {
      const auto corners = k_.corners(g);
      const Box3 box = box_of(corners[0], corners[1], corners[2]).grown(1e-12 * size);
      for (const FaceId f : parts) {
        if (k_.face(f).crack != k_.face(g).crack || !box.meets(k_.box(f))) continue;
        const auto part = k_.corners(f);
        const Vec3 centroid = (part[0] + part[1] + part[2]) / 3;
        if ((closest_point_on_triangle(centroid, corners[0], corners[1], corners[2]) - centroid).norm() > 1e-10 * size)
          continue;
        part_of.push_back({g, f});
        const auto& own = k_.face(g).v;
        for (const VertexId v : k_.face(f).v) {
          auto& of = common.try_emplace(v, own.begin(), own.end()).first->second;
          std::erase_if(of, [&](VertexId c) { return std::find(own.begin(), own.end(), c) == own.end(); });
        }
      }
    }
    std::map<VertexId, std::vector<OnEdge>> on_edges;
    for (const auto& [g, f] : part_of)
      for (int which = 0; which < 2; ++which)
        if (const auto at = old_side({g, which}); at && k_.has({f, which}))
          for (int c = 0; c < 3; ++c)
            if (const auto v = k_.surface_vertex({f, which}, c); !placed_[v.index()])
              place_on_part(v, k_.face(f).v[static_cast<std::size_t>(c)], g, *at, common, on_edges);
  }

  // A point of a divided edge: the positions of the ends of the edge, and its own.
  struct OnEdge {
    Vec3 ends[2], at;
  };

  // Places v, a corner at `site` of a part of `parent`. `at`: the old vertices of the parent's
  // side.
  void place_on_part(SurfaceVertexId v, VertexId site, FaceId parent, const Triangle& at,
                     const std::map<VertexId, std::vector<VertexId>>& common,
                     std::map<VertexId, std::vector<OnEdge>>& on_edges) {
    const auto corners = k_.corners(parent);
    const auto& own = k_.face(parent).v;
    const auto corner = [&](VertexId c) {
      return static_cast<std::size_t>(std::find(own.begin(), own.end(), c) - own.begin());
    };
    if (const auto same = corner(site); same < 3) return place(v, in_.positions[at[same]], SurfaceVertexId(at[same]));
    Vec3 to = carried(k_.point(site), corners, {in_.positions[at[0]], in_.positions[at[1]], in_.positions[at[2]]});
    if (const auto& edge = common.at(site); edge.size() == 2) {
      const Vec3 &a = in_.positions[at[corner(edge[0])]], &b = in_.positions[at[corner(edge[1])]];
      auto& known = on_edges[site];
      const auto same =
          std::find_if(known.begin(), known.end(), [&](const OnEdge& e) { return e.ends[0] == a && e.ends[1] == b; });
      if (same == known.end())
        known.push_back({{a, b}, to});
      else
        to = same->at;
    }
    place(v, to, SurfaceVertexId(at[0]));
  }

  // An old site of which this copy has new faces only: the copy coincides with the one on the
  // other side of such a face.
  void place_across_new_faces() {
    for (bool any = true; any;) {
      any = false;
      for (const FaceId f : in_.crack.new_crack_faces)
        for (int c = 0; c < 3; ++c) {
          auto v = k_.surface_vertex({f, 0}, c), w = k_.surface_vertex({f, 1}, c);
          if (placed_[v.index()] == placed_[w.index()]) continue;
          if (placed_[w.index()]) std::swap(v, w);
          place(w, result_.positions[v.index()], reference_[v.index()]);
          any = true;
        }
    }
  }

  // The closest point of an old face that is visible from a new site: at rest and now.
  struct VisiblePoint {
    Vec3 rest, now;
    SurfaceVertexId reference;
    double distance;  // from the site, at rest
  };

  struct Surroundings {
    double reach = 0;  // longest distance of a corner of the faces at the site
    std::vector<VisiblePoint> points;
  };
  Surroundings surroundings(VertexId site, const std::vector<std::uint8_t>& is_new) const {
    Surroundings result;
    const Vec3& x = k_.point(site);
    for (const FaceId f : k_.faces_at(site))
      for (const Vec3& c : k_.corners(f)) result.reach = std::max(result.reach, (c - x).norm());
    result.points = visible_points(x, 1.01 * result.reach, is_new);  // 1.01: includes the farthest corner
    return result;
  }

  // Vertices inside the material continue the deformed surface. One at a site that has a placed
  // vertex, where a crack touches another sheet at a point, coincides with it: apart by rounding,
  // the triangles around both would cross.
  void place_inside() {
    std::vector<std::uint8_t> is_new(k_.face_count(), 0);
    for (const FaceId f : in_.crack.new_crack_faces) is_new[f.index()] = 1;
    std::vector<std::pair<std::uint32_t, SurfaceVertexId>> waiting;
    for (const auto v : in_.crack.new_surface_vertices)
      if (k_.alive(v) && !placed_[v.index()]) waiting.push_back({result_.surface.site[v.index()], v});
    std::sort(waiting.begin(), waiting.end());
    std::vector<std::size_t> first;  // of each site, and the end
    for (std::size_t i = 0; i < waiting.size(); ++i)
      if (i == 0 || waiting[i].first != waiting[i - 1].first) first.push_back(i);
    std::vector<std::pair<Vec3, SurfaceVertexId>> found(first.size());
    parallel_for(found.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) found[i] = continued_surface(VertexId(waiting[first[i]].first), is_new);
    });
    first.push_back(waiting.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      const SurfaceVertexId touched = nearest_placed(VertexId(waiting[first[i]].first), found[i].first);
      const auto [at, reference] =
          touched.valid() ? std::pair(Vec3(result_.positions[touched.index()]), reference_[touched.index()]) : found[i];
      for (auto j = first[i]; j < first[i + 1]; ++j) place(waiting[j].second, at, reference);
    }
  }

  // The placed surface vertex of a site that is nearest to x: the one in whose material x is. None
  // where no vertex of the site is placed.
  SurfaceVertexId nearest_placed(VertexId site, const Vec3& x) const {
    SurfaceVertexId nearest;
    double least = std::numeric_limits<double>::infinity();
    for (const FaceId f : k_.faces_at(site)) {
      const auto& corners = k_.face(f).v;
      const int c = static_cast<int>(std::find(corners.begin(), corners.end(), site) - corners.begin());
      for (int which = 0; which < 2; ++which) {
        if (!k_.has({f, which})) continue;
        const SurfaceVertexId v = k_.surface_vertex({f, which}, c);
        const double distance = (result_.positions[v.index()] - x).norm();
        if (!placed_[v.index()] || !(distance < least)) continue;
        least = distance;
        nearest = v;
      }
    }
    return nearest;
  }

  // The position of a site inside the material, and its reference: the nearest visible point's.
  // Distance⁻⁴ makes the weight unbounded at old points, so that the surface is continued there.
  std::pair<Vec3, SurfaceVertexId> continued_surface(VertexId site, const std::vector<std::uint8_t>& is_new) const {
    const Vec3& x = k_.point(site);
    const Surroundings visible = surroundings(site, is_new);
    // Many points have the same carrying node, and so the same nodes.
    struct Carrier {
      NodeId node;
      std::vector<NodeId> nodes;
      Vec3 at_site;  // the displacement
    };
    std::vector<Carrier> carriers;
    const auto carrier_of = [&](SurfaceVertexId v) -> const Carrier& {
      const NodeId node = carrying_node(v);
      for (const Carrier& c : carriers)
        if (c.node == node) return c;
      Carrier& c = carriers.emplace_back(Carrier{node, with_neighbors(node), Vec3::Zero()});
      c.at_site = displacement(x, c.nodes);
      return c;
    };
    Vec3 sum = Vec3::Zero();
    SurfaceVertexId reference;
    double total = 0, nearest = std::numeric_limits<double>::infinity();
    for (const VisiblePoint& p : visible.points) {
      const Carrier& carrier = carrier_of(p.reference);
      const double share = p.distance / visible.reach, weight = 1 / (share * share * share * share);
      sum += weight * (p.now + x - p.rest + carrier.at_site - displacement(p.rest, carrier.nodes));
      total += weight;
      if (p.distance < nearest) {
        nearest = p.distance;
        reference = p.reference;
      }
    }
    return {total > 0 ? Vec3(sum / total) : Vec3(x + displacement(x, nodes_near(x))), reference};
  }

  // The visible points of old faces within `reach` of x, at most one a face.
  std::vector<VisiblePoint> visible_points(const Vec3& x, double reach, const std::vector<std::uint8_t>& is_new) const {
    std::vector<FaceId> faces;
    k_.faces_near(Box3{x, x}.grown(reach), faces);
    std::erase_if(faces, [&](FaceId f) { return is_new[f.index()]; });
    std::vector<std::array<Vec3, 3>> corners;
    std::vector<Box3> boxes;
    for (const FaceId f : faces) {
      const auto& [a, b, c] = corners.emplace_back(k_.corners(f));
      boxes.push_back(box_of(a, b, c));
    }
    std::vector<VisiblePoint> result;
    for (std::size_t i = 0; i < faces.size(); ++i) {
      const FaceId f = faces[i];
      const auto& rest = corners[i];
      const Vec3 c = closest_point_on_triangle(x, rest[0], rest[1], rest[2]);
      const double distance = (x - c).norm();
      if (!(distance < reach) || !(distance > 0)) continue;
      const Vec3 almost = x + 0.999 * (c - x);  // just before the face itself
      Box3 segment;
      segment.add(x);
      segment.add(almost);
      const auto blocks = [&](std::size_t j) {
        return j != i && segment.meets(boxes[j]) &&
               segment_meets_triangle(x, almost, corners[j][0], corners[j][1], corners[j][2]);
      };
      bool hidden = false;
      for (std::size_t j = 0; j < faces.size() && !hidden; ++j) hidden = blocks(j);
      if (hidden) continue;
      const Side side{
          f, k_.face(f).crack > 0 && orient3d(rest[0], rest[1], rest[2], x) > 0 ? 1 : 0};  // material is behind side 0
      const Vec3 w = barycentric(c, rest[0], rest[1], rest[2]);
      Vec3 displacement = Vec3::Zero();
      for (int k = 0; k < 3; ++k)
        displacement +=
            w[k] * (result_.positions[k_.surface_vertex(side, k).index()] - rest[static_cast<std::size_t>(k)]);
      result.push_back({.rest = c,
                        .now = c + displacement,
                        .reference = reference_[k_.surface_vertex(side, 0).index()],
                        .distance = distance});
    }
    return result;
  }

  // Parts and new faces are flat and may cross; old triangles do not.
  void untangle_new_triangles() {
    const ContactSurface& s = result_.surface;
    std::vector<std::uint8_t> marked(s.side.size(), 0), fresh = marked;
    const auto mark = [&](const std::vector<FaceId>& faces, std::vector<std::uint8_t>& in) {
      for (const FaceId f : faces)
        for (auto [t, end] = s.triangles_of(f); t < end; ++t) in[t] = 1;
    };
    mark(in_.crack.new_faces, marked);
    for (const auto v : joined_)
      for (const FaceId f : k_.faces_at(k_.site(v))) mark({f}, marked);
    mark(in_.crack.new_crack_faces, fresh);
    const auto rest = [&](std::uint32_t v) { return k_.point(VertexId(s.site[v])); };
    const auto gradient = [&](std::uint32_t v) {
      const auto nodes = reference_[v].valid() ? nodes_of(reference_[v]) : nodes_near(rest(v));
      return nodes.empty() ? Mat3(Mat3::Identity()) : Mat3(Mat3::Identity() + gradient_[nodes[0].index()]);
    };
    const UntangleInput untangling{.surface = s,
                                   .rest = rest,
                                   .gradient = gradient,
                                   .fresh = fresh,
                                   .gap = in_.gap,
                                   .reach = carried_spacings * in_.body.finest_spacing};
    if (!untangle(untangling, result_.positions, marked).empty())
      throw GeometryError("the surface would cross itself where the crack begins to open");
  }

  // None for an invalid node.
  std::vector<NodeId> with_neighbors(NodeId m) const {
    if (!m.valid()) return {};
    std::vector<NodeId> nodes{m};
    for (const auto& n : in_.body.graph.neighbors(in_.body.nodes, m)) nodes.push_back(n.to);
    return nodes;
  }
  std::vector<NodeId> nodes_near(const Vec3& x) const {
    const auto nearest =
        in_.body.cache->grid.nearest(in_.body.nodes.position, x, 1, ~0u, [](std::uint32_t) { return true; });
    return nearest.empty() ? std::vector<NodeId>() : with_neighbors(NodeId(nearest[0]));
  }
  // The node that carries an old surface vertex.
  NodeId carrying_node(SurfaceVertexId v) const { return v.valid() ? geo::carrying_node(in_.body, v) : NodeId(); }
  std::vector<NodeId> nodes_of(SurfaceVertexId v) const { return with_neighbors(carrying_node(v)); }
  // Eq. 1 at x, blended over the nodes of `nodes` whose support contains x; the first if none does.
  Vec3 displacement(const Vec3& x, const std::vector<NodeId>& nodes) const {
    if (nodes.empty()) return Vec3::Zero();
    std::vector<std::pair<NodeId, double>> bound;
    for (const NodeId i : nodes)
      if (const double d = (in_.body.nodes.position[i.index()] - x).norm(); d < in_.body.nodes.radius[i.index()])
        bound.push_back({i, d});
    if (bound.empty()) bound.push_back({nodes[0], 0.0});
    return displacement_at(x, bound, in_.body.nodes, in_.state.displacement, gradient_);
  }

  const EmbeddingInput& in_;
  const Complex& k_;  // after the step
  LazyNodalGradients gradient_;
  EmbeddedSurface result_;
  std::vector<SurfaceVertexId> reference_;  // per vertex, as in place()
  std::vector<std::uint8_t> placed_;        // per vertex
  std::vector<SurfaceVertexId> joined_;     // of several that had positions of their own
};

}  // namespace

EmbeddedSurface embed_new_surface(const EmbeddingInput& input) { return SurfaceEmbedder(input).run(); }

}  // namespace geo
