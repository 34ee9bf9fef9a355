// Sides of the complex in ascending order (2 · face + side). An update copies unchanged runs of
// triangles, appends those of new faces and rewrites triangles at changed vertices.
#include "contact/surface/contact_surface.h"

#include <algorithm>

#include "kerf/parallel.h"

namespace geo {
namespace {

// The triangle of a side, counter-clockwise from outside.
Triangle triangle_of(const Complex& complex, std::uint32_t side) {
  const auto v = [&](int k) { return complex.surface_vertex({FaceId(side / 2), static_cast<int>(side % 2)}, k).value; };
  return side % 2 == 0 ? Triangle{v(0), v(1), v(2)} : Triangle{v(0), v(2), v(1)};
}

void add_sides(const Complex& complex, FaceId f, ContactSurface& s) {
  for (int which = 0; which < 2; ++which)
    if (complex.has({f, which})) {
      s.side.push_back(2 * f.value + static_cast<std::uint32_t>(which));
      s.triangles.push_back(triangle_of(complex, s.side.back()));
    }
}

void set_sites(const Complex& complex, ContactSurface& s) {
  s.site.resize(complex.surface_vertex_count());
  for (std::uint32_t v = 0; v < s.site.size(); ++v) {
    const SurfaceVertexId id(v);
    s.site[v] = complex.alive(id) ? complex.site(id).value : complex.vertex_count() + v;
  }
}

std::vector<FaceId> ascending(std::vector<FaceId> faces) {
  std::sort(faces.begin(), faces.end());
  return faces;
}

}  // namespace

std::pair<std::size_t, std::size_t> ContactSurface::triangles_of(FaceId f) const {
  const auto first = std::lower_bound(side.begin(), side.end(), 2 * f.value),
             last = std::find_if(first, side.end(), [&](auto s) { return s / 2 != f.value; });
  return {static_cast<std::size_t>(first - side.begin()), static_cast<std::size_t>(last - side.begin())};
}

ContactSurface contact_surface(const Complex& complex) {
  ContactSurface s;
  for (std::uint32_t f = 0; f < complex.face_count(); ++f) add_sides(complex, FaceId(f), s);
  set_sites(complex, s);
  s.edge = mean_edge(s, complex);
  return s;
}

ContactSurface updated_contact_surface(const ContactSurface& before, const Complex& after, const CrackDelta& crack) {
  ContactSurface s;
  s.triangles.reserve(before.triangles.size() + 2 * crack.new_faces.size());
  s.side.reserve(s.triangles.capacity());
  std::size_t next = 0;  // triangles of `before` up to this one are copied or removed
  const auto copy_until = [&](std::size_t last) {
    const auto from = static_cast<std::ptrdiff_t>(next), to = static_cast<std::ptrdiff_t>(last);
    s.triangles.insert(s.triangles.end(), before.triangles.begin() + from, before.triangles.begin() + to);
    s.side.insert(s.side.end(), before.side.begin() + from, before.side.begin() + to);
  };
  for (const FaceId f : ascending(crack.removed_faces)) {
    const auto [first, end] = before.triangles_of(f);
    copy_until(first);
    next = end;
  }
  copy_until(before.side.size());
  for (const FaceId f : ascending(crack.new_faces)) add_sides(after, f, s);  // new faces have the highest numbers
  // Other faces change vertices only next to new or changed surface vertices.
  for (const auto* vertices : {&crack.new_surface_vertices, &crack.touched_surface_vertices})
    for (const auto v : *vertices) {
      if (!after.alive(v)) continue;
      for (const FaceId f : after.faces_at(after.site(v)))
        for (auto [t, end] = s.triangles_of(f); t < end; ++t) s.triangles[t] = triangle_of(after, s.side[t]);
    }
  set_sites(after, s);
  return s;
}

double mean_edge(const ContactSurface& surface, const Complex& complex) {
  double length = 0;
  for (const auto side : surface.side) {
    const auto corners = complex.corners(FaceId(side / 2));
    for (int k = 0; k < 3; ++k) length += (corners[(k + 1) % 3] - corners[k]).norm();
  }
  return surface.side.empty() ? 0 : length / (3 * double(surface.side.size()));
}

double vertex_area(const Complex& k, SurfaceVertexId v) {
  double area = 0;
  for (const FaceId f : k.faces_at(k.site(v)))
    for (int which = 0; which < 2; ++which)
      for (int c = 0; c < 3; ++c)
        if (k.has({f, which}) && k.surface_vertex({f, which}, c) == v) {
          const auto corners = k.corners(f);
          area += (corners[1] - corners[0]).cross(corners[2] - corners[0]).norm() / 6;
        }
  return area;
}

std::vector<Vec3> vertex_normals(const ContactSurface& surface, const VertexFans& fans,
                                 const CoincidentVertices& coincident, const std::vector<Vec3>& p) {
  std::vector<Vec3> normals(p.size(), Vec3::Zero());
  parallel_for(coincident.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      if (coincident[v].size() == 1) continue;
      for (const auto one : coincident[v])
        for (const auto& l : fans.fan(one)) {
          const auto& [a, b, c] = surface.triangles[l.triangle];
          normals[one] += (p[b] - p[a]).cross(p[c] - p[a]);
        }
    }
  });
  return normals;
}

std::vector<Vec3> coincident_side_normals(const ContactSurface& surface, std::span<const std::uint32_t> representative,
                                          const std::vector<Vec3>& p) {
  std::vector<Vec3> normals(p.size(), Vec3::Zero());
  for (std::size_t t = 1; t < surface.triangles.size(); ++t) {
    if (surface.side[t] / 2 != surface.side[t - 1] / 2) continue;  // not the two sides of one face
    const auto &s = surface.triangles[t - 1], &o = surface.triangles[t];
    if (representative[s[0]] != representative[o[0]] || representative[s[1]] != representative[o[2]] ||
        representative[s[2]] != representative[o[1]])
      continue;
    const Vec3 n = (p[s[1]] - p[s[0]]).cross(p[s[2]] - p[s[0]]);
    for (int k = 0; k < 3; ++k) {
      normals[s[static_cast<std::size_t>(k)]] += n;
      normals[o[static_cast<std::size_t>(k)]] -= n;
    }
  }
  return normals;
}

namespace {

// Per vertex the sum of the normals of its triangles on faces with two sides.
std::vector<Vec3> wall_normals(const ContactSurface& surface, const std::vector<Vec3>& p) {
  std::vector<Vec3> normals(p.size(), Vec3::Zero());
  for (std::size_t t = 1; t < surface.triangles.size(); ++t) {
    if (surface.side[t] / 2 != surface.side[t - 1] / 2) continue;
    for (const auto& [a, b, c] : {surface.triangles[t - 1], surface.triangles[t]}) {
      const Vec3 n = (p[b] - p[a]).cross(p[c] - p[a]);
      for (const auto v : {a, b, c}) normals[v] += n;
    }
  }
  return normals;
}

}  // namespace

std::vector<Vec3> normals_across_sheets(const ContactSurface& surface, std::span<const std::uint32_t> representative,
                                        const std::vector<Vec3>& of_all, const std::vector<Vec3>& positions) {
  std::vector<Vec3> normals = coincident_side_normals(surface, representative, positions);
  const std::vector<Vec3> of_walls = wall_normals(surface, positions);
  for (std::size_t v = 0; v < normals.size(); ++v)
    if (normals[v].isZero(0)) normals[v] = of_walls[v].isZero(0) ? of_all[v] : of_walls[v];
  return normals;
}

}  // namespace geo
