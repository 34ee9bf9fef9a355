// Inside, the motion of the nodes is followed. Where the surface is off it, so are walls nearby.
#include "simulation/broken_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <unordered_map>
#include <utility>

#include "body/binding.h"
#include "kerf/error.h"
#include "kerf/mesh.h"

namespace geo {

Grown::Grown(const Complex& from, const Complex& to) : old(from), now(from) {
  const ComplexEdit edit = old.difference(to);
  now.apply(edit);
  for (std::uint32_t f = 0; f < old.face_count(); ++f) parent.emplace_back(f);
  for (const auto& face : edit.new_faces) parent.push_back(face.parent);
}

void Grown::for_each_side(const std::function<void(Side)>& visit) const {
  for (std::uint32_t f = 0; f < now.face_count(); ++f)
    for (const int which : {0, 1})
      if (now.has({FaceId(f), which})) visit(Side{FaceId(f), which});
}

namespace {

// Barycentric coordinates of a point in the plane of a triangle.
Vec3 barycentric(const Vec3& p, const std::array<Vec3, 3>& t) {
  const Vec3 normal = (t[1] - t[0]).cross(t[2] - t[0]);
  const double area = normal.squaredNorm();
  const double b = (p - t[0]).cross(t[2] - t[0]).dot(normal) / area;
  const double c = (t[1] - t[0]).cross(p - t[0]).dot(normal) / area;
  return {1 - b - c, b, c};
}

// The motion of a piece by its nodes: smooth, and near Eq. 1.
class ByNodes {
 public:
  // `inside`: a node of the piece.
  ByNodes(const Simulation& run, NodeId inside)
      : nodes_(run.body().nodes),
        displacement_(run.state().motion.displacement),
        gradient_(run.solid().gradients(displacement_)) {
    // No edge of the graph passes through a crack.
    const VisibilityGraph& graph = run.body().graph;
    std::vector<bool> seen(nodes_.size(), false);
    seen[inside.index()] = true;
    piece_ = {inside.value};
    for (std::size_t i = 0; i < piece_.size(); ++i)
      for (const NodeId next : graph.edges(NodeId(piece_[i]))) {
        if (next.index() >= nodes_.size() || seen[next.index()]) continue;
        seen[next.index()] = true;
        piece_.push_back(next.value);
      }
  }
  // The place in the world of a point of the material.
  Vec3 operator()(const Vec3& x) const {
    Vec3 sum = Vec3::Zero();
    double weights = 0, nearest = std::numeric_limits<double>::infinity();
    Vec3 by_nearest = Vec3::Zero();
    for (const std::uint32_t j : piece_) {
      const Vec3 way = x - nodes_.position[j];
      const double share = way.squaredNorm() / (nodes_.radius[j] * nodes_.radius[j]);
      const Vec3 moved = displacement_[j] + gradient_[j] * way;
      if (share < nearest) {
        nearest = share;
        by_nearest = moved;
      }
      if (share >= 1) continue;
      const double weight = (1 - share) * (1 - share) * (1 - share);
      sum += weight * moved;
      weights += weight;
    }
    return x + (weights > 0 ? Vec3(sum / weights) : by_nearest);
  }

 private:
  const NodeSet& nodes_;
  const std::vector<Vec3>& displacement_;
  std::vector<Mat3> gradient_;
  std::vector<std::uint32_t> piece_;
};

// Places of surface vertices after a break, in the world.
class Places {
 public:
  // `old`: of living vertices of the complex before, ascending.
  Places(const Grown& grown, const std::vector<Vec3>& old)
      : grown_(grown), old_(grown.old.surface_vertex_count()), now_(grown.now.surface_vertex_count()) {
    std::size_t next = 0;
    for (std::uint32_t v = 0; v < old_.size(); ++v)
      if (grown.old.alive(SurfaceVertexId(v))) old_[v] = old[next++];
    grown.for_each_side([&](Side s) { place_on_old_surface(s); });
  }
  // The place of each living vertex, ascending.
  std::vector<Vec3> with(const ByNodes& motion) {
    place_walls(motion);
    std::vector<Vec3> all;
    for_each_vertex([&](std::uint32_t v, std::uint32_t) { all.push_back(*now_[v]); });
    return all;
  }

 private:
  template <class Visit>
  void for_each_vertex(const Visit& visit) const {
    for (std::uint32_t v = 0; v < now_.size(); ++v)
      if (grown_.now.alive(SurfaceVertexId(v))) visit(v, grown_.now.site(SurfaceVertexId(v)).value);
  }
  void place_on_old_surface(Side s) {
    const FaceId parent = grown_.parent[s.face.index()];
    if (!parent.valid()) return;
    for (int k = 0; k < 3; ++k) {
      const SurfaceVertexId v = grown_.now.surface_vertex(s, k);
      if (now_[v.index()]) continue;
      if (v.index() < old_.size()) {
        now_[v.index()] = old_[v.index()];
        continue;
      }
      const VertexId site = grown_.now.site(v);
      now_[v.index()] = at_site(site, on(parent, s.which, site));
    }
  }
  // The place of a vertex of K in an old side.
  Vec3 on(FaceId face, int which, VertexId site) const {
    const auto& corners = grown_.old.face(face).v;
    const Vec3 weight = barycentric(grown_.now.point(site), grown_.old.corners(face));
    Vec3 sum = Vec3::Zero();
    for (int k = 0; k < 3; ++k) {
      const Vec3& place = old_[grown_.old.surface_vertex({face, which}, k).index()];
      if (corners[static_cast<std::size_t>(k)] == site) return place;
      sum += weight[k] * place;
    }
    return sum;
  }
  // A vertex of K inside of the material that was: all its copies are at one place.
  struct Inner {
    Vec3 by_nodes = Vec3::Zero(), shift = Vec3::Zero();
    std::vector<std::uint32_t> copies = {}, inner = {};  // vertices of the surface; the second: neighbours
    Vec3 outer_shift = Vec3::Zero();                     // sum over neighbours on the old surface
    int outer = 0;                                       // their number
  };
  // The old surface is off the motion of the nodes: it is coarser, and contact holds it. That shift
  // fades into the new walls as heat does.
  void place_walls(const ByNodes& motion) {
    constexpr int sweeps = 60;             // walls are about ten edges wide
    std::map<std::uint32_t, Inner> inner;  // by vertex of K
    std::vector<Inner*> of(now_.size(), nullptr);
    for_each_vertex([&](std::uint32_t v, std::uint32_t site) {
      if (now_[v]) return;
      const auto [here, is_new] = inner.try_emplace(site);
      if (is_new) here->second.by_nodes = motion(grown_.now.point(VertexId(site)));
      here->second.copies.push_back(v);
      of[v] = &here->second;
    });
    const auto meet = [&](SurfaceVertexId a, SurfaceVertexId b) {
      Inner* const here = of[a.index()];
      if (!here) return;
      if (of[b.index()]) return here->inner.push_back(b.value);
      here->outer_shift += *now_[b.index()] - motion(grown_.now.point(grown_.now.site(b)));
      ++here->outer;
    };
    grown_.for_each_side([&](Side s) {
      for (int k = 0; k < 3; ++k) {
        const SurfaceVertexId a = grown_.now.surface_vertex(s, k), b = grown_.now.surface_vertex(s, (k + 1) % 3);
        meet(a, b);
        meet(b, a);
      }
    });
    for (int sweep = 0; sweep < sweeps; ++sweep)
      for (auto& [site, here] : inner) {
        Vec3 sum = here.outer_shift;
        for (const std::uint32_t v : here.inner) sum += of[v]->shift;
        here.shift = sum / (static_cast<double>(here.inner.size()) + here.outer);
      }
    for (const auto& [site, here] : inner)
      for (const std::uint32_t v : here.copies) now_[v] = here.by_nodes + here.shift;
  }
  // Copies of a vertex are at one place, to the bit, unless an older crack is open between them.
  Vec3 at_site(VertexId site, const Vec3& place) {
    const double apart = 1e-9 * grown_.old.extent().diagonal();
    for (const Vec3& other : at_[site.value])
      if ((other - place).norm() < apart) return other;
    at_[site.value].push_back(place);
    return place;
  }

  const Grown& grown_;
  std::vector<Vec3> old_;
  std::vector<std::optional<Vec3>> now_;
  std::unordered_map<std::uint32_t, std::vector<Vec3>> at_;
};

// A node of the piece that is hit.
NodeId node_at(const Simulation& run, const SurfaceHit& hit) {
  const NodeId node = carrying_node(run.body(), hit.nearest);
  if (!node.valid()) throw GeometryError("no node carries this point");
  return node;
}

}  // namespace

std::vector<Vec3> broken_surface(const Simulation& run, const Grown& grown, const SurfaceHit& hit) {
  return Places(grown, run.state().surface).with(ByNodes(run, node_at(run, hit)));
}

}  // namespace geo
