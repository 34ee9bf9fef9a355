// Grid walls are the rectangles between boxes of different labels; raised walls are extruded
// segments. Polygons become fans around their centroid. Sheets are divided by each other by
// inserting them as one crack into a block.
#include "score/walls.h"

#include <map>

#include "kerf/crack.h"
#include "kerf/error.h"
#include "kerf/mesh.h"

namespace geo {

Mat3 frame_along(const Vec3& axis) {
  if (!(axis.norm() > 0) || !axis.allFinite()) throw InputError("an axis needs a length");
  Mat3 frame;
  const Vec3 z = axis.normalized();
  int least = 0;
  z.cwiseAbs().minCoeff(&least);
  const Vec3 x = (Vec3::Unit(least) - z[least] * z).normalized();
  frame << x, z.cross(x), z;
  return frame;
}

Box3 box_along(const Box3& box, const Mat3& frame) {
  Box3 all;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p(corner & 1 ? box.hi.x() : box.lo.x(), corner & 2 ? box.hi.y() : box.lo.y(),
                 corner & 4 ? box.hi.z() : box.lo.z());
    all.add(frame.transpose() * p);
  }
  return all;
}

void add_wall(TriangleMesh& walls, std::span<const std::uint32_t> corners) {
  if (corners.size() == 3) {
    walls.triangles.push_back({corners[0], corners[1], corners[2]});
    return;
  }
  Vec3 middle = Vec3::Zero();
  for (const auto c : corners) middle += walls.vertices[c] / double(corners.size());
  const auto center = static_cast<std::uint32_t>(walls.vertices.size());
  walls.vertices.push_back(middle);
  for (std::size_t i = 0; i < corners.size(); ++i)
    walls.triangles.push_back({corners[i], corners[(i + 1) % corners.size()], center});
}

TriangleMesh grid_walls(const std::array<std::vector<double>, 3>& at, const std::function<int(int, int, int)>& label,
                        const Mat3& frame) {
  TriangleMesh walls;
  std::map<std::array<int, 3>, std::uint32_t> index;
  const auto vertex = [&](const std::array<int, 3>& c) {
    const auto [entry, fresh] = index.try_emplace(c, static_cast<std::uint32_t>(walls.vertices.size()));
    if (fresh) {
      const Vec3 p(at[0][std::size_t(c[0])], at[1][std::size_t(c[1])], at[2][std::size_t(c[2])]);
      walls.vertices.push_back(frame * p);
    }
    return entry->second;
  };
  const int n[3] = {int(at[0].size()) - 1, int(at[1].size()) - 1, int(at[2].size()) - 1};
  for (int i = 0; i < n[0]; ++i)
    for (int j = 0; j < n[1]; ++j)
      for (int k = 0; k < n[2]; ++k)
        for (int axis = 0; axis < 3; ++axis) {
          std::array<int, 3> next{i, j, k};
          if (++next[std::size_t(axis)] == n[axis] || label(i, j, k) == label(next[0], next[1], next[2])) continue;
          const auto u = std::size_t(axis + 1) % 3, v = std::size_t(axis + 2) % 3;
          std::array<std::array<int, 3>, 4> c{next, next, next, next};
          ++c[1][u];
          ++c[2][u];
          ++c[2][v];
          ++c[3][v];
          const std::array<std::uint32_t, 4> corners{vertex(c[0]), vertex(c[1]), vertex(c[2]), vertex(c[3])};
          add_wall(walls, corners);
        }
  return walls;
}

TriangleMesh raised_walls(std::span<const Vec2> points, std::span<const std::array<std::uint32_t, 2>> segments,
                          double low, double high, const Mat3& frame) {
  TriangleMesh walls;
  for (const Vec2& p : points)
    for (const double height : {low, high}) walls.vertices.push_back(frame * Vec3(p.x(), p.y(), height));
  for (const auto& [a, b] : segments) {
    const std::array<std::uint32_t, 4> corners{2 * a, 2 * b, 2 * b + 1, 2 * a + 1};
    add_wall(walls, corners);
  }
  return walls;
}

TriangleMesh divided_by_each_other(const std::vector<TriangleMesh>& sheets, const Box3& box) {
  TriangleMesh around = make_block(box.hi - box.lo, box.diagonal());
  for (Vec3& p : around.vertices) p += box.lo;
  Complex complex = Complex::from_skin(around);
  TriangleMesh all;
  for (const auto& sheet : sheets) {
    const auto first = static_cast<std::uint32_t>(all.vertices.size());
    all.vertices.insert(all.vertices.end(), sheet.vertices.begin(), sheet.vertices.end());
    for (const auto& t : sheet.triangles) all.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  insert_sheet(complex, all, 1);
  TriangleMesh walls;
  std::vector<std::uint32_t> index(complex.vertex_count(), ~0u);
  for (std::uint32_t f = 0; f < complex.face_count(); ++f) {
    if (!complex.alive(FaceId(f)) || complex.face(FaceId(f)).crack == 0) continue;
    Triangle t;
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexId v = complex.face(FaceId(f)).v[k];
      if (index[v.index()] == ~0u) {
        index[v.index()] = static_cast<std::uint32_t>(walls.vertices.size());
        walls.vertices.push_back(complex.point(v));
      }
      t[k] = index[v.index()];
    }
    walls.triangles.push_back(t);
  }
  return walls;
}

}  // namespace geo
