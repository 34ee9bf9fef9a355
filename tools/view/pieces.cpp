// Connected shells by union-find over triangles. A shell with signed volume ≤ 0 belongs to the
// smallest shell whose box contains its box.
#include "view/pieces.h"

#include <limits>
#include <numeric>

namespace view {
namespace {

using geo::Vec3;

// Connected components: the shell of each vertex, and the number of shells.
std::uint32_t shells_of(const geo::TriangleMesh& mesh, std::vector<std::uint32_t>& shell) {
  std::vector<std::uint32_t> root(mesh.vertices.size());
  std::iota(root.begin(), root.end(), 0u);
  const auto find = [&](std::uint32_t v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  for (const auto& [a, b, c] : mesh.triangles) {
    root[std::max(find(a), find(b))] = std::min(find(a), find(b));
    root[std::max(find(b), find(c))] = std::min(find(b), find(c));
  }
  std::uint32_t count = 0;
  shell.assign(root.size(), 0);
  for (std::uint32_t v = 0; v < root.size(); ++v) shell[v] = find(v) == v ? count++ : shell[find(v)];
  return count;
}

bool contains(const geo::Box3& outer, const geo::Box3& inner) {
  return (outer.lo.array() <= inner.lo.array()).all() && (outer.hi.array() >= inner.hi.array()).all();
}

}  // namespace

PieceMap pieces_of(const geo::TriangleMesh& mesh) {
  std::vector<std::uint32_t> shell;
  const std::uint32_t shells = shells_of(mesh, shell);
  std::vector<geo::Box3> box(shells);
  std::vector<double> volume(shells), terms(shells);
  for (std::size_t v = 0; v < shell.size(); ++v) box[shell[v]].add(mesh.vertices[v]);
  for (const auto& [a, b, c] : mesh.triangles) {
    const std::uint32_t s = shell[a];
    const Vec3 o = box[s].center();
    const double part = (mesh.vertices[a] - o).dot((mesh.vertices[b] - o).cross(mesh.vertices[c] - o));
    volume[s] += part;
    terms[s] += std::abs(part) + 1e-3 * std::pow(box[s].diagonal(), 3);
  }
  // A shell without positive volume, beyond rounding, bounds a cavity or an inner crack. It belongs
  // to the smallest shell around it.
  std::vector<std::uint32_t> outer(shells);
  for (std::uint32_t s = 0; s < shells; ++s) {
    outer[s] = s;
    if (volume[s] > 64 * std::numeric_limits<double>::epsilon() * terms[s]) continue;
    for (std::uint32_t o = 0; o < shells; ++o)
      if (o != s && volume[o] > 0 && contains(box[o], box[s]) && (outer[s] == s || volume[o] < volume[outer[s]]))
        outer[s] = o;
  }
  PieceMap pieces;
  std::vector<std::uint32_t> number(shells);
  for (std::uint32_t s = 0; s < shells; ++s)
    if (outer[s] == s) {
      number[s] = static_cast<std::uint32_t>(pieces.center.size());
      pieces.center.push_back(box[s].center());
    }
  for (const std::uint32_t s : shell) pieces.of_row.push_back(number[outer[s]]);
  return pieces;
}

std::vector<std::uint32_t> pieces_of_nodes(const Subject& subject, const PieceMap& pieces) {
  const geo::Body& body = *subject.body;
  std::vector<std::uint32_t> component;
  std::vector<std::uint32_t> piece_of(body.graph.components(component), 0);
  for (std::uint32_t v = 0; v < subject.row_of.size(); ++v)
    if (subject.row_of[v] != ~0u && body.binding.master_node[v].valid())
      piece_of[component[body.binding.master_node[v].index()]] = pieces.of_row[subject.row_of[v]];
  for (auto& c : component) c = piece_of[c];
  return component;
}

}  // namespace view
