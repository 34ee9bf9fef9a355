// Near-parallel segments have no one closest pair: points come first, the ends of either segment
// beside the other, and pairs of inner points only where there are none.
#include "crack/near_edges.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "crack/guard.h"
#include "geometry/coordinate_order.h"
#include "geometry/distance.h"

namespace geo::crack {
namespace {

// A strip through edges of the skin meets one or two with each of its triangles. One that lies in a
// sheet is near all edges of that, and each division makes more of them.
constexpr std::size_t max_places_per_triangle = 2;

// Least distance of places, in reaches. Nearer ones would move the strip to and fro by as much as
// it is long between them.
constexpr double places_apart = 3;

// An edge of K, from the end that is before the other by coordinates: ids of a complex that was
// read back are others.
struct Edge {
  VertexId a, b;
  Vec3 from, to;

  bool operator<(const Edge& other) const {
    return from != other.from ? is_before(from, other.from) : is_before(to, other.to);
  }
  bool operator==(const Edge& other) const { return a == other.a && b == other.b; }
};

Edge edge_between(const Complex& complex, VertexId a, VertexId b) {
  if (is_before(complex.point(b), complex.point(a))) std::swap(a, b);
  return {.a = a, .b = b, .from = complex.point(a), .to = complex.point(b)};
}

// The parameter of the point of a segment closest to p, in 0 … 1.
double parameter_near(const Vec3& p, const Vec3& from, const Vec3& to) {
  const Vec3 along = to - from;
  const double length = along.squaredNorm();
  return length > 0 ? std::clamp(along.dot(p - from) / length, 0.0, 1.0) : 0.0;
}

// Finds where edges of K are to be divided.
class NearEdges {
 public:
  NearEdges(const Complex& complex, const Strip& strip, double reach)
      : complex_(complex), strip_(strip), reach_(reach) {}

  // Parameters of the places on each edge, ascending.
  std::map<Edge, std::vector<double>> run() {
    for (std::size_t t = 0; t < strip_.triangles.size(); ++t) {
      const auto& p = strip_.triangles[t].p;
      for (const Edge& edge : edges_near(t)) {
        if (strip_.is_on_old_front(edge.from, edge.to)) continue;
        for (std::size_t k = 0; k < 3; ++k) {
          if (!strip_.fixed[p[k]]) add_near_point(edge, strip_.points[p[k]]);
          add_near_edge(edge, strip_.points[p[k]], strip_.points[p[(k + 1) % 3]]);
        }
      }
    }
    for (auto& [edge, at] : places_) thin_out(edge, at);
    std::erase_if(places_, [](const auto& entry) { return entry.second.empty(); });
    return std::move(places_);
  }

 private:
  // Edges of the faces near strip triangle t.
  std::vector<Edge> edges_near(std::size_t t) const {
    std::vector<Edge> edges;
    for (auto f = strip_.near_begin[t]; f < strip_.near_begin[t + 1]; ++f) {
      const auto& v = complex_.face(strip_.near[f]).v;
      for (std::size_t k = 0; k < 3; ++k) edges.push_back(edge_between(complex_, v[k], v[(k + 1) % 3]));
    }
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    return edges;
  }

  bool is_near_segment(const Vec3& p, const Vec3& from, const Vec3& to) const {
    return (from + parameter_near(p, from, to) * (to - from) - p).squaredNorm() <= reach_ * reach_;
  }

  void add_near_point(const Edge& edge, const Vec3& p) {
    const Vec3 &a = edge.from, &b = edge.to;
    if (p != a && p != b && is_near_segment(p, a, b)) places_[edge].push_back(parameter_near(p, a, b));
  }

  // An edge of the strip from p to q.
  void add_near_edge(const Edge& edge, const Vec3& p, const Vec3& q) {
    const Vec3 &a = edge.from, &b = edge.to;
    if (is_near_segment(p, a, b) || is_near_segment(q, a, b)) return;
    if (is_near_segment(a, p, q) || is_near_segment(b, p, q)) return;
    if (distance_between_segments(a, b, p, q) > reach_) return;
    const Vec3 u = b - a, v = q - p, w = a - p;
    const double parallel = u.squaredNorm() * v.squaredNorm() - u.dot(v) * u.dot(v);
    if (parallel > 0) places_[edge].push_back((u.dot(v) * v.dot(w) - u.dot(w) * v.squaredNorm()) / parallel);
  }

  // Leaves out places near each other, of any edge, and near the edge's ends.
  void thin_out(const Edge& edge, std::vector<double>& at) {
    const Vec3 &a = edge.from, &b = edge.to;
    const double apart = places_apart * reach_;
    std::sort(at.begin(), at.end());
    std::erase_if(at, [&](double t) {
      const Vec3 place = a + t * (b - a);
      const auto is_near = [&](const Vec3& p) { return (p - place).norm() < apart; };
      if (is_near(a) || is_near(b) || std::any_of(taken_.begin(), taken_.end(), is_near)) return true;
      taken_.push_back(place);
      return false;
    });
  }

  const Complex& complex_;
  const Strip& strip_;
  double reach_;
  std::map<Edge, std::vector<double>> places_;
  std::vector<Vec3> taken_;  // places that are not left out
};

// Divides edges of K, and the faces at them, in one edit.
class EdgeDivider {
 public:
  explicit EdgeDivider(const Complex& complex) : complex_(complex) {}

  // At parameters, ascending.
  void divide(const Edge& edge, const std::vector<double>& at) {
    const Vec3 &a = edge.from, &b = edge.to;
    std::vector<VertexId> chain{edge.a};
    for (const double t : at) {
      chain.push_back(VertexId(complex_.vertex_count() + static_cast<std::uint32_t>(edit_.new_vertices.size())));
      edit_.new_vertices.push_back(a + t * (b - a));
    }
    chain.push_back(edge.b);
    const RadialCycle around = complex_.faces_around(edge.a, edge.b);
    for (const FaceId f : around) divide_face(f, chain);
    if (around.size() > 2) chains_.push_back(std::move(chain));
  }

  ComplexEdit edit() {
    for (const auto& [f, parts] : parts_) {
      edit_.removed_faces.push_back(f);
      for (const auto& v : parts) edit_.new_faces.push_back({.v = v, .crack = complex_.face(f).crack, .parent = f});
    }
    for (const auto& chain : chains_)
      for (std::size_t i = 0; i + 1 < chain.size(); ++i) add_radial_order(chain, i);
    return std::move(edit_);
  }

 private:
  // The corner of a triangle at which edge ab starts, in either direction; 3: it has no such edge.
  static std::size_t edge_of(const std::array<VertexId, 3>& v, VertexId a, VertexId b) {
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexId p = v[k], q = v[(k + 1) % 3];
      if ((p == a && q == b) || (p == b && q == a)) return k;
    }
    return 3;
  }

  void divide_face(FaceId f, const std::vector<VertexId>& chain) {
    auto& parts = parts_.try_emplace(f, std::vector{complex_.face(f).v}).first->second;
    for (std::size_t i = 1; i + 1 < chain.size(); ++i)
      for (std::size_t p = 0; p < parts.size(); ++p) {
        const std::size_t k = edge_of(parts[p], chain[i - 1], chain.back());
        if (k == 3) continue;
        auto rest = parts[p];
        parts[p][(k + 1) % 3] = chain[i];
        rest[k] = chain[i];
        parts.push_back(rest);
        break;
      }
  }

  // That of part i of a divided edge: children take the places of their parents.
  void add_radial_order(const std::vector<VertexId>& chain, std::size_t i) {
    ComplexEdit::RadialOrder order{.a = chain[i], .b = chain[i + 1], .faces = {}};
    for (const FaceId f : complex_.faces_around(chain.front(), chain.back()))
      for (std::uint32_t n = 0; n < edit_.new_faces.size(); ++n)
        if (edit_.new_faces[n].parent == f && edge_of(edit_.new_faces[n].v, order.a, order.b) < 3)
          order.faces.push_back(FaceId(complex_.face_count() + n));
    // faces_around() has them about the direction from the lower id to the higher one.
    if (chain.back() < chain.front()) std::reverse(order.faces.begin(), order.faces.end());
    edit_.radial_orders.push_back(std::move(order));
  }

  const Complex& complex_;
  ComplexEdit edit_;
  std::map<FaceId, std::vector<std::array<VertexId, 3>>> parts_;  // of each divided face
  std::vector<std::vector<VertexId>> chains_;                     // of divided edges with more than two faces
};

// Whether the edit is valid once its points are rounded, where needed after a repair.
bool is_valid(const Complex& complex, ComplexEdit& edit) {
  std::vector<Family> families;
  for (std::uint32_t i = 0; i < edit.new_faces.size();) {
    const FaceId parent = edit.new_faces[i].parent;
    std::uint32_t end = i;
    while (end < edit.new_faces.size() && edit.new_faces[end].parent == parent) ++end;
    families.push_back(
        {.plane = complex.corners(parent), .first = i, .end = end, .near = {}, .near_known = false, .whole = true});
    i = end;
  }
  const std::vector<std::uint8_t> moved(edit.new_vertices.size(), 1);
  std::size_t repairs = 0;
  return !snap_repair(complex, edit, {.families = families, .moved = moved}, repairs);
}

}  // namespace

ComplexEdit divide_near_edges(const Complex& complex, const Strip& strip, double reach) {
  const auto places = NearEdges(complex, strip, reach).run();
  std::size_t count = 0;
  for (const auto& [edge, at] : places) count += at.size();
  if (count > max_places_per_triangle * strip.triangles.size()) return {};
  EdgeDivider edges(complex);
  for (const auto& [edge, at] : places) edges.divide(edge, at);
  ComplexEdit edit = edges.edit();
  if (edit.empty() || !is_valid(complex, edit)) return {};
  return edit;
}

}  // namespace geo::crack
