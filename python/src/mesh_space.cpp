// Meshes in space: transformation, points inside, the class Plane.
#include "mesh_space.h"

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>

#include "apart.h"
#include "bind.h"
#include "busy.h"
#include "kerf/complex.h"
#include "kerf/error.h"
#include "kerf/parallel.h"
#include "pieces.h"

namespace kerf_python {
namespace {

using Shared = std::shared_ptr<Mesh>;

// An affine map.
struct Affine {
  geo::Mat3 linear;
  geo::Vec3 offset;
  geo::Vec3 operator()(const geo::Vec3& p) const { return linear * p + offset; }
};

Affine affine_from(const py::object& matrix) {
  const auto [shape, values] = values_from(matrix, "matrix", 2, 2);
  if (shape[0] != 4 || shape[1] != 4) throw geo::InputError("matrix: give 4 rows of 4 numbers");
  if (values[12] != 0 || values[13] != 0 || values[14] != 0 || values[15] != 1)
    throw geo::InputError("matrix: its last row is not 0, 0, 0, 1; give an affine map of columns (p, 1)");
  Affine out;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      out.linear(row, column) = values[static_cast<std::size_t>(4 * row + column)];
    out.offset[row] = values[static_cast<std::size_t>(4 * row + 3)];
  }
  const double volume = out.linear.determinant();
  if (!(std::abs(volume) > 0) || !std::isfinite(volume))
    throw geo::InputError("matrix: maps space to a plane, or beyond all numbers; give one that can be inverted");
  return out;
}

template <class Value>
void reverse_corners(std::vector<std::array<Value, 3>>& corners) {
  for (auto& of_triangle : corners) std::swap(of_triangle[1], of_triangle[2]);
}

// The mesh moved. A mirrored one has the corners of its triangles in the other order, so that
// normals stay outside.
geo::TriangleMesh transformed(const geo::TriangleMesh& mesh, const Affine& map) {
  geo::TriangleMesh out = mesh;
  for (geo::Vec3& p : out.vertices) {
    p = map(p);
    if (!geo::in_range(p)) throw geo::InputError("matrix: moves a vertex out of the range of coordinates, 1e60");
  }
  const geo::Mat3 of_normals = map.linear.inverse().transpose();
  for (auto& corners : out.attributes.normal)
    for (geo::Vec3& n : corners) n = (of_normals * n).normalized();
  if (map.linear.determinant() < 0) {
    reverse_corners(out.triangles);
    reverse_corners(out.attributes.uv);
    reverse_corners(out.attributes.uv2);
    reverse_corners(out.attributes.normal);
    reverse_corners(out.attributes.color);
  }
  return out;
}

std::shared_ptr<Piece> transformed_piece(const Piece& piece, const py::object& matrix) {
  const Affine map = affine_from(matrix);
  return without_gil([&] {
    geo::Chunk chunk{transformed(piece.mesh, map), piece.volume * std::abs(map.linear.determinant()),
                     map(piece.centroid)};
    auto out = std::make_shared<Piece>(std::move(chunk), piece.index);
    for (const auto& hull : piece.hulls) out->hulls.push_back(std::make_shared<Mesh>(transformed(hull->mesh, map)));
    return out;
  });
}

// Ways out of the box from p: to the nearest sides first, each aslant so that it is parallel to no
// usual face. They are short, and thin boxes hold them.
std::array<geo::Vec3, 3> ways_out(const geo::Box3& box, const geo::Vec3& p) {
  struct Side {
    double distance;
    geo::Vec3 end;
  };
  std::vector<Side> sides;
  const double slant = 0.01 * box.diagonal();
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) {
      const double side = sign < 0 ? box.lo[axis] : box.hi[axis];
      geo::Vec3 end = p + slant * geo::Vec3(0.577, 0.211, 0.789);
      end[axis] = side + sign * slant;
      sides.push_back({std::abs(side - p[axis]), end});
    }
  std::stable_sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) { return a.distance < b.distance; });
  return {sides[0].end, sides[1].end, sides[2].end};
}

// Whether the material is left on the way from p to a point outside, by the parity of the faces.
bool leaves(const geo::Complex& complex, const geo::Vec3& p, const geo::Vec3& outside) {
  return geo::faces_on_segment(complex, p, outside).size() % 2 == 1;
}

// Points between two looks for Ctrl-C: some 0.1 s.
constexpr std::size_t contains_block = 1u << 16;

// Whether p is inside. A way that touches an edge counts its two faces. The third decides where two
// differ.
bool is_inside(const geo::Complex& complex, const geo::Vec3& p) {
  const auto& box = complex.extent();
  if ((p.array() < box.lo.array()).any() || (p.array() > box.hi.array()).any()) return false;
  const auto ways = ways_out(box, p);
  const bool first = leaves(complex, p, ways[0]);
  const bool second = leaves(complex, p, ways[1]);
  return first == second ? first : leaves(complex, p, ways[2]);
}

py::array contains(const Shared& self, const py::object& points, const py::object& progress) {
  auto given = points_from(points, "points");
  const auto complex = model_of(self)->uncut();
  auto inside = stoppable(
      "contains",
      [complex, at = std::move(given)](const geo::Progress& own) {
        std::vector<std::uint8_t> out(at.size());
        for (std::size_t from = 0; from < at.size(); from += contains_block) {
          geo::report(own, "contains", from, at.size());
          geo::parallel_for(std::min(contains_block, at.size() - from), 64, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = from + begin; i < from + end; ++i) out[i] = is_inside(*complex, at[i]);
          });
        }
        return out;
      },
      progress);
  return moved<bool>(std::move(inside));
}

// Vertices that triangles use, less edges, plus triangles.
std::int64_t euler_number(const Mesh& self) {
  const auto& mesh = self.mesh;
  std::vector<std::uint8_t> used(mesh.vertices.size());
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      used[t[k]] = 1;
      edges.push_back(std::minmax(t[k], t[(k + 1) % 3]));
    }
  std::sort(edges.begin(), edges.end());
  const auto distinct = std::unique(edges.begin(), edges.end()) - edges.begin();
  return std::count(used.begin(), used.end(), 1) - distinct + std::ssize(mesh.triangles);
}

std::shared_ptr<Plane> plane_from(const py::object& at, const py::object& normal) {
  const geo::Vec3 n = point_from(normal, "normal");
  const double length = n.stableNorm();
  if (!(length > 0)) throw geo::InputError("normal: has no length; give a direction");
  return std::make_shared<Plane>(Plane{point_from(at, "point"), n / length});
}

constexpr const char* transformed_doc =
    "matrix: (4, 4), an affine map of columns (p, 1): the last row is 0, 0, 0, 1. A mirrored mesh keeps its outside.\n"
    "Raises InputError for a matrix that cannot be inverted.";

void bind_plane(py::module_& module) {
  py::class_<Plane, std::shared_ptr<Plane>>(module, "Plane",
                                            "A plane, for crack() and split(). kerf.plane() makes one.")
      .def_property_readonly(
          "point", [](const Plane& self) { return point(self.point); }, "A point of it, (3,) float64.")
      .def_property_readonly(
          "normal", [](const Plane& self) { return point(self.normal); }, "Its unit normal, (3,) float64.")
      .def("__repr__",
           [](const Plane& self) { return "<kerf.Plane " + py::repr(point(self.normal)).cast<std::string>() + ">"; })
      .def(py::pickle([](const Plane& self) { return py::make_tuple(point(self.point), point(self.normal)); },
                      [](const py::tuple& state) {
                        if (state.size() != 2) throw geo::InputError("the pickle is of another version");
                        return plane_from(state[0], state[1]);
                      }));
  module.def("plane", &plane_from, py::arg("point"), py::arg("normal"),
             "The plane through a point, three numbers, with a normal, three numbers of any length: a Plane. Raises\n"
             "InputError.");
}

}  // namespace

geo::TriangleMesh sheet_across(const Plane& plane, const geo::Box3& box) {
  // The part of the plane in the box is in a circle about the foot of the box's middle, of half
  // the box's diagonal: a square of 3/4 of the diagonal on each side covers it.
  const double reach = 0.75 * box.diagonal();
  const geo::Vec3 middle = box.center() - plane.normal.dot(box.center() - plane.point) * plane.normal;
  const geo::Vec3 u = plane.normal.unitOrthogonal();
  const geo::Vec3 v = plane.normal.cross(u);
  geo::TriangleMesh sheet;
  for (const auto& [a, b] : {std::pair(-1, -1), std::pair(1, -1), std::pair(1, 1), std::pair(-1, 1)})
    sheet.vertices.push_back(middle + reach * (a * u + b * v));
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  return sheet;
}

void bind_mesh_space(py::module_& module) {
  bind_plane(module);
  static const std::string of_mesh = std::string("The mesh moved by an affine map, a Mesh.\n\n") + transformed_doc;
  static const std::string of_solid =
      std::string("The model moved by an affine map, a Solid, which is checked again.\n\n") + transformed_doc;
  static const std::string of_piece =
      std::string("The piece moved by an affine map, with its hulls, a Piece.\n\n") + transformed_doc;
  py::class_<Mesh, Shared>(module.attr("Mesh"))
      .def(
          "transformed",
          [](const Mesh& self, const py::object& matrix) {
            const Affine map = affine_from(matrix);
            return without_gil([&] { return std::make_shared<Mesh>(transformed(self.mesh, map)); });
          },
          py::arg("matrix"), of_mesh.c_str())
      .def("contains", &contains, py::arg("points"), py::arg_v("progress", py::none()),
           "Whether each point, (n, 3), is inside: (n,) bool. On the surface itself it may be either. Raises "
           "InputError\n"
           "where the mesh is no valid model, Interrupted.")
      .def(
          "copy", [](const Shared& self) { return self; }, "The mesh itself: it never changes.")
      .def_property_readonly(
          "centroid", [](const Mesh& self) { return point(geo::mass_properties(self.mesh).centroid); },
          "Centroid of the enclosed material, (3,) float64; the middle of the box where the volume is not positive.")
      .def_property_readonly("euler_number", &euler_number,
                             "Vertices less edges plus faces: 2 for each shell, less 2 for each of its handles.");
  py::class_<Solid, Mesh, std::shared_ptr<Solid>>(module.attr("Solid"))
      .def(
          "transformed",
          [](const Solid& self, const py::object& matrix) {
            return std::make_shared<Solid>(transformed(self.mesh, affine_from(matrix)));
          },
          py::arg("matrix"), of_solid.c_str());
  py::class_<Piece, Solid, std::shared_ptr<Piece>>(module.attr("Piece"))
      .def("transformed", &transformed_piece, py::arg("matrix"), of_piece.c_str());
}

}  // namespace kerf_python
