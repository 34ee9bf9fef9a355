// refined() of kerf/mesh.h. Passes of edge bisection: all edges that are too long are divided at
// once. Each triangle follows the pattern of its 1, 2 or 3 divided edges; with two, the shorter
// diagonal divides the quad.
#include "kerf/mesh.h"

#include <algorithm>
#include <utility>

#include "kerf/error.h"

namespace geo {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;  // lower vertex first

// Limits memory: an edge length in the wrong unit fails early.
constexpr std::size_t max_triangles = 20'000'000;
constexpr std::uint32_t none = ~0u;

Edge edge(const Triangle& t, int k) { return std::minmax(t[k], t[(k + 1) % 3]); }

// One pass: bisects each edge that is too long once.
class Pass {
 public:
  Pass(TriangleMesh& mesh, double longest) : mesh_(mesh) {
    for (const Triangle& t : mesh.triangles)
      for (int k = 0; k < 3; ++k) {
        const Vec3 &a = mesh.vertices[t[k]], &b = mesh.vertices[t[(k + 1) % 3]], m = middle(edge(t, k));
        if ((b - a).norm() > longest && m != a && m != b) long_.push_back(edge(t, k));
      }
    std::sort(long_.begin(), long_.end());
    long_.erase(std::unique(long_.begin(), long_.end()), long_.end());
  }

  // False when no edge is too long.
  bool divide() {
    if (long_.empty()) return false;
    first_ = static_cast<std::uint32_t>(mesh_.vertices.size());
    for (const Edge& e : long_) mesh_.vertices.push_back(middle(e));
    std::vector<Triangle> triangles;
    std::vector<std::uint32_t> source;
    for (std::size_t i = 0; i < mesh_.triangles.size(); ++i) {
      divide(mesh_.triangles[i], triangles);
      source.resize(triangles.size(), mesh_.source[i]);
      if (triangles.size() > max_triangles)
        throw InputError("edges so short would make more than 20 million triangles; let them be longer");
    }
    mesh_.triangles.swap(triangles);
    mesh_.source.swap(source);
    return true;
  }

 private:
  Vec3 middle(const Edge& e) const { return 0.5 * (mesh_.vertices[e.first] + mesh_.vertices[e.second]); }
  std::uint32_t vertex_of(const Edge& e) const {
    const auto at = std::lower_bound(long_.begin(), long_.end(), e);
    return at != long_.end() && *at == e ? first_ + static_cast<std::uint32_t>(at - long_.begin()) : none;
  }

  void divide(const Triangle& t, std::vector<Triangle>& children) const {
    std::array<std::uint32_t, 3> m{};
    for (int k = 0; k < 3; ++k) m[k] = vertex_of(edge(t, k));
    const auto whole = std::count(m.begin(), m.end(), none);
    if (whole == 3) return children.push_back(t);
    // Rotated so that edge 0–1 is divided, and, of two divided edges, 1–2 as well.
    int k = 0;
    while (m[k] == none || (whole == 1 && m[(k + 1) % 3] == none)) ++k;
    const std::uint32_t a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3], ab = m[k], bc = m[(k + 1) % 3],
                        ca = m[(k + 2) % 3];
    if (whole == 2) {
      children.insert(children.end(), {{a, ab, c}, {ab, b, c}});
    } else if (whole == 0) {
      children.insert(children.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    } else {
      children.push_back({ab, b, bc});
      const auto length = [&](std::uint32_t i, std::uint32_t j) {
        return (mesh_.vertices[i] - mesh_.vertices[j]).squaredNorm();
      };
      if (length(a, bc) < length(ab, c))
        children.insert(children.end(), {{a, ab, bc}, {a, bc, c}});
      else
        children.insert(children.end(), {{a, ab, c}, {ab, bc, c}});
    }
  }

  TriangleMesh& mesh_;
  std::vector<Edge> long_;
  std::uint32_t first_ = 0;
};

}  // namespace

TriangleMesh refined(const TriangleMesh& mesh, double longest) {
  TriangleMesh fine;
  fine.vertices = mesh.vertices;
  fine.triangles = mesh.triangles;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) fine.source.push_back(i);
  while (Pass(fine, longest).divide()) {
  }
  transfer_attributes(mesh, fine);
  if (mesh.source.empty()) fine.source.clear();
  return fine;
}

}  // namespace geo
