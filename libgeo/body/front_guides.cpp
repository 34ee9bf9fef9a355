// Edges of new faces are passed to place_guides(). A guide is retired if a new crack face comes
// within radius / 64 of it.
#include "body/front_guides.h"
#include "body/incremental_cache.h"

#include <algorithm>

#include "body/locate.h"
#include "geometry/distance.h"
#include "graph/graph_storage.h"
#include "graph/guide_placement.h"

namespace geo {
namespace {

// The edge from the k-th vertex of a side to the next, and the side across it, as seen from the
// air.
SurfaceEdge edge_of(const Complex& complex, Side side, int k, Side across) {
  const auto& v = complex.face(side.face).v;
  auto a = v[static_cast<std::size_t>(k)], b = v[static_cast<std::size_t>((k + 1) % 3)];
  const auto c = v[static_cast<std::size_t>((k + 2) % 3)];
  VertexId d;
  for (const VertexId w : complex.face(across.face).v)
    if (w != a && w != b) d = w;
  if (side.which == 1) std::swap(a, b);
  return {.a = complex.point(a), .b = complex.point(b), .c = complex.point(c), .d = complex.point(d)};
}

// Edges of the derived surface at some faces (ascending), each once.
std::vector<SurfaceEdge> edges_at(const Complex& complex, const std::vector<FaceId>& faces) {
  std::vector<SurfaceEdge> edges;
  for (const FaceId f : faces)
    for (int which = 0; which < 2; ++which) {
      const Side side{f, which};
      if (!complex.has(side)) continue;
      for (int k = 0; k < 3; ++k) {
        const Side across = complex.neighbor(side, k);
        if (side < across || !std::binary_search(faces.begin(), faces.end(), across.face))
          edges.push_back(edge_of(complex, side, k, across));
      }
    }
  return edges;
}

std::vector<Guide> guides_at(const Body& body, const std::vector<FaceId>& faces, const GuideSet& taken) {
  GuideOptions options;
  options.spacing = body.guide_spacing;
  const auto blocked = [&](const Vec3& p, const Vec3& q) { return is_blocked(body.surface, p, q); };
  return place_guides(edges_at(body.surface, faces), body.nodes, body.cache->grid, blocked, options, taken);
}

}  // namespace

std::vector<Guide> all_guides(const Body& body) {
  std::vector<FaceId> faces;
  for (std::uint32_t f = 0; f < body.surface.face_count(); ++f)
    if (body.surface.alive(FaceId(f))) faces.push_back(FaceId(f));
  return guides_at(body, faces, {});
}

GuideChange guides_after(const Body& body, const CrackDelta& crack) {
  GuideChange change;
  if (body.guide_spacing == 0) return change;
  const GuideSet& guides = GraphStorage::of(body.graph).guides();
  // A guide stands at spacing / 64 < radius / 64 from its edge (guide_placement.cpp). A crack face
  // that near has cut the edge.
  std::vector<std::uint32_t> near, others;
  for (const FaceId f : crack.new_faces) {
    if (!body.surface.alive(f)) continue;
    const auto t = body.surface.corners(f);
    const Ball ball = bounding_ball(t);
    const bool fresh = std::binary_search(crack.new_crack_faces.begin(), crack.new_crack_faces.end(), f);
    near.clear();
    guides.within(ball.center, ball.radius + guides.largest_radius(), near);
    for (const auto g : near) {
      const Vec3& p = guides.position(g);
      if (guides.retired(g)) continue;
      const bool reached =
          fresh && (closest_point_on_triangle(p, t[0], t[1], t[2]) - p).norm() <= guides.radius(g) / 64;
      (reached ? change.retired : others).push_back(GraphStorage::guide_id(g));
    }
  }
  const auto tidy = [](std::vector<std::uint32_t>& ids) {
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  };
  tidy(change.retired);
  tidy(others);
  GuideSet taken;
  for (const auto g : others)
    if (!std::binary_search(change.retired.begin(), change.retired.end(), g))
      taken.add({guides.position(GraphStorage::index_of(g)), guides.radius(GraphStorage::index_of(g))});
  std::vector<FaceId> faces = crack.new_faces;
  std::sort(faces.begin(), faces.end());
  change.added = guides_at(body, faces, taken);
  return change;
}

}  // namespace geo
