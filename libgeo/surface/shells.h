// Shells of a surface: which of them lie in which others, and how each is oriented. Checks, repair
// and the messages of all tools share this one test.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "kerf/check.h"
#include "kerf/mesh.h"

namespace geo {

/// When a shell counts as inside another one.
enum class ShellContainment {
  one_vertex,    ///< one of its vertices is inside: exact for shells that do not cross
  all_vertices,  ///< all are: for shells that may cross, before a repair
};

/// The shell of each triangle: components joined across edges, numbered by their first triangles.
/// Triangles at an edge of more than two are in one shell.
std::vector<std::uint32_t> shell_of_triangles(const TriangleMesh& mesh);

/// The shells of a surface whose triangles are numbered by shell, 0 … count − 1. Orientation and
/// nesting are exact. Cost: n log n, and a point query for each pair of shells of which one has its
/// box in the other's.
std::vector<Shell> arranged_shells(const TriangleMesh& mesh, const std::vector<std::uint32_t>& shell_of,
                                   std::uint32_t count, ShellContainment containment);

/// One sentence that names the shells whose orientation does not fit their place, and a remedy;
/// empty where there are none.
std::string shell_problem(const std::vector<Shell>& shells);

}  // namespace geo
