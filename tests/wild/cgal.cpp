// Makes a solid of one mesh with CGAL's package Polygon Mesh Processing, and cuts it into eight.
//   cgal IN FOLDER     says "done" for a solid and "cut" for pieces, else "refused" and why
// IN: two counts of 32 bits, coordinates as doubles, corners as 32 bits. FOLDER gets solid.out and
// the pieces 0.out … 7.out in the same form: the parts of the solid on both sides of three planes
// near the middle of its box.
//
// The order is that of CGAL's manual: repair and orient the soup, stitch, remove degenerate faces,
// fill holes. Components that overlap are united by corefinement. A component that crosses itself
// goes to the experimental remove_self_intersections().
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/clip.h>
#include <CGAL/Polygon_mesh_processing/connected_components.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Polygon_mesh_processing/manifoldness.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/repair_degeneracies.h>
#include <CGAL/Polygon_mesh_processing/repair_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/repair_self_intersections.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Polygon_mesh_processing/stitch_borders.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/boost/graph/copy_face_graph.h>

#include <cstdint>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
namespace pmp = CGAL::Polygon_mesh_processing;

Mesh read(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::uint32_t counts[2];
  in.read(reinterpret_cast<char*>(counts), sizeof counts);
  std::vector<double> coordinates(3 * std::size_t(counts[0]));
  std::vector<std::uint32_t> corners(3 * std::size_t(counts[1]));
  in.read(reinterpret_cast<char*>(coordinates.data()), std::streamsize(coordinates.size() * sizeof(double)));
  in.read(reinterpret_cast<char*>(corners.data()), std::streamsize(corners.size() * sizeof(std::uint32_t)));
  if (!in) throw std::runtime_error("not read");
  std::vector<Kernel::Point_3> points;
  std::vector<std::vector<std::size_t>> triangles;
  for (std::size_t i = 0; i < coordinates.size(); i += 3)
    points.emplace_back(coordinates[i], coordinates[i + 1], coordinates[i + 2]);
  for (std::size_t i = 0; i < corners.size(); i += 3) triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
  pmp::repair_polygon_soup(points, triangles);
  pmp::orient_polygon_soup(points, triangles);
  Mesh mesh;
  pmp::polygon_soup_to_polygon_mesh(points, triangles, mesh);
  return mesh;
}

void write(const std::string& path, Mesh& mesh) {
  mesh.collect_garbage();
  std::ofstream out(path, std::ios::binary);
  const std::uint32_t counts[2] = {std::uint32_t(mesh.number_of_vertices()), std::uint32_t(mesh.number_of_faces())};
  out.write(reinterpret_cast<const char*>(counts), sizeof counts);
  for (const auto v : mesh.vertices())
    for (int k = 0; k < 3; ++k) {
      const double x = mesh.point(v)[k];
      out.write(reinterpret_cast<const char*>(&x), sizeof x);
    }
  for (const auto f : mesh.faces())
    for (const auto v : mesh.vertices_around_face(mesh.halfedge(f))) {
      const auto corner = std::uint32_t(v.idx());
      out.write(reinterpret_cast<const char*>(&corner), sizeof corner);
    }
}

void close(Mesh& mesh) {
  pmp::stitch_borders(mesh);
  pmp::duplicate_non_manifold_vertices(mesh);
  pmp::remove_degenerate_faces(mesh);
  std::vector<Mesh::Halfedge_index> rims;
  pmp::extract_boundary_cycles(mesh, std::back_inserter(rims));
  for (const auto rim : rims) {
    std::vector<Mesh::Face_index> patch;
    pmp::triangulate_hole(mesh, rim, std::back_inserter(patch));
  }
  if (mesh.is_empty() || !CGAL::is_closed(mesh)) throw std::runtime_error("stays open");
}

// The components as one solid without crossing triangles.
Mesh united(const Mesh& mesh) {
  std::vector<Mesh> parts;
  pmp::split_connected_components(mesh, parts);
  for (Mesh& part : parts) {
    if (pmp::does_self_intersect(part)) pmp::experimental::remove_self_intersections(part);
    if (!CGAL::is_closed(part) || pmp::does_self_intersect(part)) throw std::runtime_error("crosses itself");
    pmp::orient_to_bound_a_volume(part);
  }
  Mesh whole = parts.front();
  for (std::size_t i = 1; i < parts.size(); ++i)
    if (!pmp::corefine_and_compute_union(whole, parts[i], whole)) throw std::runtime_error("has no union");
  return whole;
}

Mesh solid_of(Mesh mesh) {
  close(mesh);
  if (pmp::does_self_intersect(mesh)) mesh = united(mesh);
  pmp::orient_to_bound_a_volume(mesh);
  return mesh;
}

Mesh octant(Mesh piece, const Kernel::Point_3& middle, unsigned which) {
  for (int k = 0; k < 3; ++k) {
    double normal[3] = {0, 0, 0};
    normal[k] = which >> k & 1 ? 1 : -1;
    const Kernel::Plane_3 plane(middle, Kernel::Vector_3(normal[0], normal[1], normal[2]));
    pmp::clip(piece, plane, CGAL::parameters::clip_volume(true));
    if (piece.is_empty()) break;
  }
  return piece;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: cgal IN FOLDER\n";
    return 2;
  }
  const std::string folder = std::string(argv[2]) + "/";
  try {
    Mesh solid = solid_of(read(argv[1]));
    write(folder + "solid.out", solid);
    std::cout << "done" << std::endl;
    const auto box = pmp::bbox(solid);
    // Beside the middle, where planes would pass through the vertices of symmetric models.
    const auto near_middle = [&](int k, double at) { return box.min(k) + at * (box.max(k) - box.min(k)); };
    const Kernel::Point_3 middle(near_middle(0, 0.4871), near_middle(1, 0.5093), near_middle(2, 0.5167));
    for (unsigned which = 0; which < 8; ++which) {
      Mesh piece = octant(solid, middle, which);
      if (!piece.is_empty()) write(folder + std::to_string(which) + ".out", piece);
    }
    std::cout << "cut\n";
  } catch (const std::exception& e) {
    const std::string what = e.what();
    std::cout << "refused " << what.substr(0, what.find('\n')) << "\n";
  }
}
