#include "contact/contact_surface.h"

#include "base/parallel.h"

namespace geo {

ContactSurface contact_surface(const Complex& complex) {
  ContactSurface s;
  double length = 0;
  for (std::uint32_t f = 0; f < complex.face_count(); ++f)
    for (int which = 0; which < 2; ++which) {
      const Side side{FaceId(f), which};
      if (!complex.has(side)) continue;
      const auto v = [&](int k) { return complex.surface_vertex(side, k).value; };
      s.triangles.push_back(which == 0 ? Triangle{v(0), v(1), v(2)} : Triangle{v(0), v(2), v(1)});
      s.side.push_back(2 * f + static_cast<std::uint32_t>(which));
      const auto corners = complex.corners(side.face);
      for (int k = 0; k < 3; ++k) length += (corners[(k + 1) % 3] - corners[k]).norm();
    }
  s.edge = s.triangles.empty() ? 0 : length / (3 * double(s.triangles.size()));
  s.site.resize(complex.surface_vertex_count());
  for (std::uint32_t v = 0; v < s.site.size(); ++v) {
    const SurfaceVertexId id(v);
    s.site[v] = complex.alive(id) ? complex.site(id).value : complex.vertex_count() + v;
  }
  return s;
}

double area_about(const Complex& k, SurfaceVertexId v) {
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

std::vector<Vec3> vertex_normals(const ContactSurface& surface, const VertexFans& fans, const Copies& copies, const std::vector<Vec3>& p) {
  std::vector<Vec3> normals(p.size(), Vec3::Zero());
  parallel_for(copies.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      if (copies[v].size() == 1) continue;
      for (const auto one : copies[v])
        for (const auto& l : fans.about(one)) {
          const auto& [a, b, c] = surface.triangles[l.triangle];
          normals[one] += (p[b] - p[a]).cross(p[c] - p[a]);
        }
    }
  });
  return normals;
}

std::vector<Vec3> shared_normals(const ContactSurface& surface, std::span<const std::uint32_t> together, const std::vector<Vec3>& p) {
  std::vector<Vec3> normals(p.size(), Vec3::Zero());
  for (std::size_t t = 1; t < surface.triangles.size(); ++t) {
    if (surface.side[t] / 2 != surface.side[t - 1] / 2) continue;  // the two sides of a face follow each other
    const auto &s = surface.triangles[t - 1], &o = surface.triangles[t];
    if (together[s[0]] != together[o[0]] || together[s[1]] != together[o[2]] || together[s[2]] != together[o[1]]) continue;
    const Vec3 n = (p[s[1]] - p[s[0]]).cross(p[s[2]] - p[s[0]]);
    for (int k = 0; k < 3; ++k) normals[s[static_cast<std::size_t>(k)]] += n, normals[o[static_cast<std::size_t>(k)]] -= n;
  }
  return normals;
}

}  // namespace geo
