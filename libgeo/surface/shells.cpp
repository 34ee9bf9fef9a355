// Orientation: the exact sign of the enclosed volume. Nesting: of the shells whose boxes contain
// that of a shell, the smallest one that contains it is its parent. Shells that do not cross form a
// tree.
#include "surface/shells.h"

#include <algorithm>
#include <numeric>
#include <unordered_map>

#include "base/union_find.h"
#include "geometry/box_pairs.h"
#include "geometry/bvh.h"
#include "geometry/predicates.h"
#include "kerf/parallel.h"

namespace geo {
namespace {

constexpr std::uint32_t none = ~0u;

bool strictly_within(const Box3& inner, const Box3& outer) {
  return (outer.lo.array() < inner.lo.array()).all() && (inner.hi.array() < outer.hi.array()).all();
}

// The triangles of each shell, one list after the other.
struct TrianglesByShell {
  std::vector<std::uint32_t> first;  // per shell, and the end
  std::vector<std::array<Vec3, 3>> corners;

  std::span<const std::array<Vec3, 3>> of(std::uint32_t shell) const {
    return std::span(corners).subspan(first[shell], first[shell + 1] - first[shell]);
  }
};

TrianglesByShell sorted_by_shell(const TriangleMesh& mesh, const std::vector<std::uint32_t>& shell_of,
                                 std::uint32_t count) {
  TrianglesByShell sorted;
  sorted.first.assign(count + 1, 0);
  for (const auto s : shell_of) ++sorted.first[s + 1];
  std::partial_sum(sorted.first.begin(), sorted.first.end(), sorted.first.begin());
  std::vector<std::uint32_t> next(sorted.first.begin(), sorted.first.end() - 1);
  sorted.corners.resize(mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    sorted.corners[next[shell_of[t]]++] = {mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]};
  }
  return sorted;
}

bool contains(const TriangleBvh& outer, std::span<const std::array<Vec3, 3>> inner, ShellContainment containment) {
  if (containment == ShellContainment::one_vertex) return outer.inside(inner[0][0]);
  return std::all_of(inner.begin(), inner.end(), [&](const auto& corners) {
    return std::all_of(corners.begin(), corners.end(), [&](const Vec3& p) { return outer.inside(p); });
  });
}

// Per shell, the shells whose boxes contain its own, the smallest box first.
std::vector<std::vector<std::uint32_t>> candidate_parents(const std::vector<Box3>& box) {
  const auto pairs = meeting_pairs(box, [&](AabbTree::Pairs& some) {
    std::erase_if(some, [&](const auto& pair) {
      return !strictly_within(box[pair.first], box[pair.second]) && !strictly_within(box[pair.second], box[pair.first]);
    });
  });
  std::vector<std::vector<std::uint32_t>> candidates(box.size());
  for (const auto& [i, j] : pairs) {
    if (strictly_within(box[i], box[j]))
      candidates[i].push_back(j);
    else
      candidates[j].push_back(i);
  }
  const auto smaller = [&](std::uint32_t a, std::uint32_t b) {
    const double size_a = box[a].diagonal(), size_b = box[b].diagonal();
    return size_a != size_b ? size_a < size_b : a < b;
  };
  for (auto& list : candidates) std::sort(list.begin(), list.end(), smaller);
  return candidates;
}

void find_parents(std::vector<Shell>& shells, const TrianglesByShell& triangles, ShellContainment containment) {
  const auto count = static_cast<std::uint32_t>(shells.size());
  std::vector<Box3> box(count);
  for (std::uint32_t s = 0; s < count; ++s)
    for (const auto& corners : triangles.of(s))
      for (const Vec3& p : corners) box[s].add(p);
  const auto candidates = candidate_parents(box);
  std::vector<std::uint8_t> needed(count, 0);
  for (const auto& list : candidates)
    for (const auto outer : list) needed[outer] = 1;
  std::vector<TriangleBvh> tree(count);
  for (std::uint32_t s = 0; s < count; ++s)
    if (needed[s]) tree[s] = TriangleBvh(triangles.of(s));
  parallel_for(count, 64, [&](std::size_t begin, std::size_t end) {
    for (auto s = static_cast<std::uint32_t>(begin); s < end; ++s)
      for (const auto outer : candidates[s])
        if (contains(tree[outer], triangles.of(s), containment)) {
          shells[s].parent = outer;
          break;
        }
  });
  // A parent has the larger box: in this order it has its depth before its children.
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return box[a].diagonal() > box[b].diagonal(); });
  for (const auto s : order)
    if (shells[s].parent != none) shells[s].depth = shells[shells[s].parent].depth + 1;
}

ShellKind kind_of(const Shell& shell) {
  const bool in_material = shell.depth % 2 == 1;
  if (shell.outwards) return in_material ? ShellKind::hidden : ShellKind::outer;
  return in_material ? ShellKind::cavity : ShellKind::inverted;
}

// "shell 2 (12 triangles from 12)"; numbers of shells count from 1, those of triangles from 0.
std::string name_of(const std::vector<Shell>& shells, std::uint32_t s) {
  return "shell " + std::to_string(s + 1) + " (" + std::to_string(shells[s].triangles) + " triangles, the first is " +
         std::to_string(shells[s].first_triangle) + ")";
}

std::string fault_of(const std::vector<Shell>& shells, std::uint32_t s) {
  if (shells[s].kind == ShellKind::inverted)
    return name_of(shells, s) + " is inside out" +
           (shells[s].depth > 0
                ? ", although it lies in a cavity, that of shell " + std::to_string(shells[s].parent + 1)
                : std::string());
  return name_of(shells, s) + " lies in the material of shell " + std::to_string(shells[s].parent + 1) +
         " and is oriented outwards, so it is no cavity";
}

}  // namespace

std::vector<std::uint32_t> shell_of_triangles(const TriangleMesh& mesh) {
  UnionFind sets(mesh.triangles.size());
  std::unordered_map<std::uint64_t, std::uint32_t> triangle_at;  // per edge
  triangle_at.reserve(mesh.triangles.size() * 3 / 2);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]);
      const auto [at, fresh] = triangle_at.try_emplace(std::uint64_t(low) << 32 | high, t);
      if (!fresh) sets.unite(at->second, t);
    }
  std::vector<std::uint32_t> shell_of(mesh.triangles.size());
  std::uint32_t count = 0;
  for (std::uint32_t t = 0; t < shell_of.size(); ++t) {
    const auto root = sets.find(t);  // the lowest index, hence numbered before
    shell_of[t] = root == t ? count++ : shell_of[root];
  }
  return shell_of;
}

std::vector<Shell> arranged_shells(const TriangleMesh& mesh, const std::vector<std::uint32_t>& shell_of,
                                   std::uint32_t count, ShellContainment containment) {
  std::vector<Shell> shells(count);
  for (std::size_t t = shell_of.size(); t-- > 0;) {
    Shell& shell = shells[shell_of[t]];
    ++shell.triangles;
    shell.first_triangle = static_cast<std::uint32_t>(t);
  }
  const TrianglesByShell triangles = sorted_by_shell(mesh, shell_of, count);
  for (std::uint32_t s = 0; s < count; ++s) shells[s].outwards = volume_sign(triangles.of(s)) >= 0;
  if (count > 1) find_parents(shells, triangles, containment);
  for (Shell& shell : shells) shell.kind = kind_of(shell);
  return shells;
}

std::vector<Shell> find_shells(const TriangleMesh& mesh) {
  const auto shell_of = shell_of_triangles(mesh);
  const std::uint32_t count = shell_of.empty() ? 0 : *std::max_element(shell_of.begin(), shell_of.end()) + 1;
  return arranged_shells(mesh, shell_of, count, ShellContainment::one_vertex);
}

std::string shell_problem(const std::vector<Shell>& shells) {
  std::vector<std::uint32_t> wrong;
  for (std::uint32_t s = 0; s < shells.size(); ++s)
    if (!shells[s].well_oriented()) wrong.push_back(s);
  if (wrong.empty()) return {};
  if (wrong.size() == shells.size())
    return "the surface is inside out: its normals point inwards; reverse its triangles";
  constexpr std::size_t shown = 3;  // so that the message remains one line
  std::string text = std::to_string(wrong.size()) + " of " + std::to_string(shells.size()) +
                     (wrong.size() == 1 ? " shells is oriented wrongly: " : " shells are oriented wrongly: ");
  for (std::size_t i = 0; i < std::min(shown, wrong.size()); ++i)
    text += (i > 0 ? ", " : "") + fault_of(shells, wrong[i]);
  if (wrong.size() > shown) text += ", and " + std::to_string(wrong.size() - shown) + " more";
  return text + "; reverse the triangles of " + (wrong.size() == 1 ? "that shell" : "these shells");
}

}  // namespace geo
