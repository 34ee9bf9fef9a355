#include "contact/surface/contact_surface.h"

#include <algorithm>

#include "kerf/parallel.h"

namespace geo {
namespace {

Triangle triangle_of(const Complex& complex, std::uint32_t side) {
  const auto v = [&](int k) { return complex.surface_vertex({FaceId(side / 2), static_cast<int>(side % 2)}, k).value; };
  return side % 2 == 0 ? Triangle{v(0), v(1), v(2)} : Triangle{v(0), v(2), v(1)};
}

void add_sides(const Complex& complex, FaceId f, ContactSurface& s) {
  for (int which = 0; which < 2; ++which)
    if (complex.has({f, which}))
      s.side.push_back(2 * f.value + static_cast<std::uint32_t>(which)),
          s.triangles.push_back(triangle_of(complex, s.side.back()));
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

std::pair<std::size_t, std::size_t> ContactSurface::rows_of(FaceId f) const {
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

ContactSurface grown_surface(const ContactSurface& before, const Complex& grown, const CrackDelta& crack) {
  ContactSurface s;
  s.triangles.reserve(before.triangles.size() + 2 * crack.new_faces.size()), s.side.reserve(s.triangles.capacity());
  std::size_t next = 0;  // of the rows before, all up to it are copied or gone
  const auto copy_to = [&](std::size_t row) {
    const auto from = static_cast<std::ptrdiff_t>(next), to = static_cast<std::ptrdiff_t>(row);
    s.triangles.insert(s.triangles.end(), before.triangles.begin() + from, before.triangles.begin() + to);
    s.side.insert(s.side.end(), before.side.begin() + from, before.side.begin() + to);
  };
  for (const FaceId f : ascending(crack.removed_faces)) {
    const auto [row, end] = before.rows_of(f);
    copy_to(row), next = end;
  }
  copy_to(before.side.size());
  for (const FaceId f : ascending(crack.new_faces)) add_sides(grown, f, s);  // numbers of faces are given in turn
  // Other faces have other corners only where surface vertices came or got other triangles.
  for (const auto* vertices : {&crack.new_surface_vertices, &crack.touched_surface_vertices})
    for (const auto v : *vertices) {
      if (!grown.alive(v)) continue;
      for (const FaceId f : grown.faces_at(grown.site(v)))
        for (auto [row, end] = s.rows_of(f); row < end; ++row) s.triangles[row] = triangle_of(grown, s.side[row]);
    }
  set_sites(grown, s);
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

std::vector<Vec3> vertex_normals(const ContactSurface& surface, const VertexFans& fans, const Copies& copies,
                                 const std::vector<Vec3>& p) {
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

std::vector<Vec3> shared_normals(const ContactSurface& surface, std::span<const std::uint32_t> together,
                                 const std::vector<Vec3>& p) {
  std::vector<Vec3> normals(p.size(), Vec3::Zero());
  for (std::size_t t = 1; t < surface.triangles.size(); ++t) {
    if (surface.side[t] / 2 != surface.side[t - 1] / 2) continue;  // the two sides of a face follow each other
    const auto &s = surface.triangles[t - 1], &o = surface.triangles[t];
    if (together[s[0]] != together[o[0]] || together[s[1]] != together[o[2]] || together[s[2]] != together[o[1]])
      continue;
    const Vec3 n = (p[s[1]] - p[s[0]]).cross(p[s[2]] - p[s[0]]);
    for (int k = 0; k < 3; ++k)
      normals[s[static_cast<std::size_t>(k)]] += n, normals[o[static_cast<std::size_t>(k)]] -= n;
  }
  return normals;
}

}  // namespace geo
