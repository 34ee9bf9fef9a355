#include "contact/birth/birth.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "body/incremental_cache.h"
#include "contact/birth/untangle.h"
#include "geometry/distance.h"
#include "geometry/predicates.h"
#include "kerf/error.h"
#include "kerf/parallel.h"
#include "mechanics/discretisation/deformation.h"

namespace geo {
namespace {

// An orthonormal frame on a triangle.
Mat3 frame_of(const std::array<Vec3, 3>& t) {
  Mat3 frame;
  frame.col(0) = (t[1] - t[0]).normalized();
  frame.col(2) = (t[1] - t[0]).cross(t[2] - t[0]).normalized();
  frame.col(1) = frame.col(2).cross(frame.col(0));
  return frame;
}

// Where a triangle that moved from `rest` to `now` carries x, which is on it but for last places:
// these make the difference between slivers that cross and such that do not, so they turn with it.
Vec3 carried(const Vec3& x, const std::array<Vec3, 3>& rest, const std::array<Vec3, 3>& now) {
  const Vec3 w = barycentric(x, rest[0], rest[1], rest[2]);
  const Vec3 off = x - (w[0] * rest[0] + w[1] * rest[1] + w[2] * rest[2]);
  const Vec3 moved = w[0] * (now[0] - rest[0]) + w[1] * (now[1] - rest[1]) + w[2] * (now[2] - rest[2]);
  const Vec3 turned = frame_of(now) * (frame_of(rest).transpose() * off) - off;
  return x + moved + (turned.allFinite() ? turned : Vec3(Vec3::Zero()));
}

class Midwife {
 public:
  Midwife(const Body& body, const Solid& solid, const State& state, const ContactSurface& before,
          const std::vector<Vec3>& positions, const Complex& grown, const CrackDelta& crack)
      : body_(body),
        state_(state),
        before_(before),
        old_(positions),
        k_(grown),
        gradient_(solid.gradients_when_asked(state.displacement)) {
    birth_.surface = grown_surface(before, grown, crack);
    birth_.positions = positions;
    birth_.positions.resize(birth_.surface.site.size(), Vec3::Zero());
    like_.resize(birth_.positions.size());
    for (std::uint32_t v = 0; v < like_.size(); ++v)
      like_[v] = v < positions.size() ? SurfaceVertexId(v) : SurfaceVertexId();
    placed_.assign(birth_.positions.size(), 1);
  }

  Birth run(const CrackDelta& crack, double gap) {
    parallel_invoke([&] { birth_.surface.edge = mean_edge(birth_.surface, k_); },
                    [&] {
                      for (const auto v : crack.new_surface_vertices) placed_[v.index()] = 0;
                      on_old_sides(crack);
                      on_parts(crack);
                      across(crack);
                      inside(crack);
                      part(crack, gap);
                    });
    return std::move(birth_);
  }

 private:
  void place(SurfaceVertexId v, const Vec3& at, SurfaceVertexId like) {
    birth_.positions[v.index()] = at, placed_[v.index()] = 1, like_[v.index()] = like;
  }

  // Where the corners of a side were that was there.
  std::optional<Triangle> old_side(Side side) const {
    for (auto [row, end] = before_.rows_of(side.face); row < end; ++row)
      if (const auto& [a, b, c] = before_.triangles[row];
          before_.side[row] % 2 == static_cast<std::uint32_t>(side.which))
        return side.which == 0 ? Triangle{a, b, c} : Triangle{a, c, b};
    return {};
  }

  // A side that is still there has its corners where they were: the lowest one about a new vertex
  // says where it is.
  void on_old_sides(const CrackDelta& crack) {
    for (const auto v : crack.new_surface_vertices) {
      if (!k_.alive(v)) continue;
      for (const FaceId f : k_.faces_at(k_.site(v)))
        for (int which = 0; which < 2; ++which)
          for (int c = 0; c < 3; ++c) {
            if (placed_[v.index()] || !k_.has({f, which}) || k_.surface_vertex({f, which}, c) != v) continue;
            if (const auto at = old_side({f, which})) {
              const auto w = (*at)[static_cast<std::size_t>(c)];
              place(v, old_[w], SurfaceVertexId(w));
            }
          }
    }
  }

  // On old faces: each part of one gives its new corners their place in it, the lowest face that
  // has one first. What is on an edge is placed by its two ends, so that copies are together where
  // these are.
  void on_parts(const CrackDelta& crack) {
    std::vector<FaceId> parents = crack.removed_faces, parts;
    std::sort(parents.begin(), parents.end());
    std::set_difference(crack.new_faces.begin(), crack.new_faces.end(), crack.new_crack_faces.begin(),
                        crack.new_crack_faces.end(), std::back_inserter(parts));
    const double size = k_.extent().diagonal();
    std::vector<std::pair<FaceId, FaceId>> part_of;    // parent, part
    std::map<VertexId, std::vector<VertexId>> common;  // by site the corners that all of its parents have
    for (const FaceId g : parents) {
      const auto corners = k_.corners(g);
      const Box3 box = box_of(corners[0], corners[1], corners[2]).grown(1e-12 * size);
      for (const FaceId f : parts) {
        if (k_.face(f).crack != k_.face(g).crack || !box.meets(k_.box(f))) continue;
        const auto part = k_.corners(f);
        const Vec3 middle = (part[0] + part[1] + part[2]) / 3;
        if ((closest_point_on_triangle(middle, corners[0], corners[1], corners[2]) - middle).norm() > 1e-10 * size)
          continue;
        part_of.push_back({g, f});
        const auto& own = k_.face(g).v;
        for (const VertexId v : k_.face(f).v) {
          auto& of = common.try_emplace(v, own.begin(), own.end()).first->second;
          std::erase_if(of, [&](VertexId c) { return std::find(own.begin(), own.end(), c) == own.end(); });
        }
      }
    }
    std::map<VertexId, std::vector<OnEdge>> on_edges;
    for (const auto& [g, f] : part_of)
      for (int which = 0; which < 2; ++which)
        if (const auto at = old_side({g, which}); at && k_.has({f, which}))
          for (int c = 0; c < 3; ++c)
            if (const auto v = k_.surface_vertex({f, which}, c); !placed_[v.index()])
              place_on_part(v, k_.face(f).v[static_cast<std::size_t>(c)], g, *at, common, on_edges);
  }

  struct OnEdge {
    Vec3 ends[2], at;
  };

  // `at`: where the parent's corners were.
  void place_on_part(SurfaceVertexId v, VertexId site, FaceId parent, const Triangle& at,
                     const std::map<VertexId, std::vector<VertexId>>& common,
                     std::map<VertexId, std::vector<OnEdge>>& on_edges) {
    const auto corners = k_.corners(parent);
    const auto& own = k_.face(parent).v;
    const auto row = [&](VertexId c) {
      return static_cast<std::size_t>(std::find(own.begin(), own.end(), c) - own.begin());
    };
    if (const auto same = row(site); same < 3) return place(v, old_[at[same]], SurfaceVertexId(at[same]));
    Vec3 to = carried(k_.point(site), corners, {old_[at[0]], old_[at[1]], old_[at[2]]});
    if (const auto& edge = common.at(site); edge.size() == 2) {
      const Vec3 &a = old_[at[row(edge[0])]], &b = old_[at[row(edge[1])]];
      auto& known = on_edges[site];
      const auto same =
          std::find_if(known.begin(), known.end(), [&](const OnEdge& e) { return e.ends[0] == a && e.ends[1] == b; });
      if (same == known.end())
        known.push_back({{a, b}, to});
      else
        to = same->at;
    }
    place(v, to, SurfaceVertexId(at[0]));
  }

  // Between new faces only, at a site that was there: where the other side of one of these is, as
  // the two are together.
  void across(const CrackDelta& crack) {
    for (bool any = true; any;) {
      any = false;
      for (const FaceId f : crack.new_crack_faces)
        for (int c = 0; c < 3; ++c) {
          auto v = k_.surface_vertex({f, 0}, c), w = k_.surface_vertex({f, 1}, c);
          if (placed_[v.index()] == placed_[w.index()]) continue;
          if (placed_[w.index()]) std::swap(v, w);
          place(w, birth_.positions[v.index()], like_[v.index()]), any = true;
        }
    }
  }

  // Places on what is there that x sees, and how far away they are.
  struct Near {
    Vec3 rest, now;
    SurfaceVertexId like;
    double distance;
  };

  struct Surroundings {
    double reach = 0;  // as far as the new faces go
    std::vector<Near> near;
  };
  Surroundings surroundings(VertexId site, const std::vector<std::uint8_t>& is_new) const {
    Surroundings result;
    const Vec3& x = k_.point(site);
    for (const FaceId f : k_.faces_at(site))
      for (const Vec3& c : k_.corners(f)) result.reach = std::max(result.reach, (c - x).norm());
    result.near = near(x, 1.01 * result.reach, is_new);
    return result;
  }

  // Inside, the deformed surface goes on: what is nearest says most.
  void inside(const CrackDelta& crack) {
    std::vector<std::uint8_t> is_new(k_.face_count(), 0);
    for (const FaceId f : crack.new_crack_faces) is_new[f.index()] = 1;
    std::vector<std::pair<std::uint32_t, SurfaceVertexId>> waiting;
    for (const auto v : crack.new_surface_vertices)
      if (k_.alive(v) && !placed_[v.index()]) waiting.push_back({birth_.surface.site[v.index()], v});
    std::sort(waiting.begin(), waiting.end());
    std::vector<std::size_t> first;  // of each site, and the end
    for (std::size_t i = 0; i < waiting.size(); ++i)
      if (i == 0 || waiting[i].first != waiting[i - 1].first) first.push_back(i);
    std::vector<std::pair<Vec3, SurfaceVertexId>> found(first.size());
    parallel_for(found.size(), 4, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) found[i] = place_inside(VertexId(waiting[first[i]].first), is_new);
    });
    first.push_back(waiting.size());
    for (std::size_t i = 0; i < found.size(); ++i)
      for (auto j = first[i]; j < first[i + 1]; ++j) place(waiting[j].second, found[i].first, found[i].second);
  }

  // Where a site inside is, and like which vertex it moves.
  std::pair<Vec3, SurfaceVertexId> place_inside(VertexId site, const std::vector<std::uint8_t>& is_new) const {
    const Vec3& x = k_.point(site);
    const Surroundings about = surroundings(site, is_new);
    Vec3 sum = Vec3::Zero();
    SurfaceVertexId like;
    double total = 0, nearest = std::numeric_limits<double>::infinity();
    for (const Near& n : about.near) {
      const auto nodes = nodes_of(n.like);
      const double weight = std::pow(n.distance / about.reach, -4);
      sum += weight * (n.now + x - n.rest + displacement(x, nodes) - displacement(n.rest, nodes)), total += weight;
      if (n.distance < nearest) nearest = n.distance, like = n.like;
    }
    return {total > 0 ? Vec3(sum / total) : Vec3(x + displacement(x, nodes_near(x))), like};
  }

  std::vector<Near> near(const Vec3& x, double reach, const std::vector<std::uint8_t>& is_new) const {
    std::vector<FaceId> faces;
    k_.faces_near(Box3{x, x}.grown(reach), faces);
    std::erase_if(faces, [&](FaceId f) { return is_new[f.index()]; });
    std::vector<std::array<Vec3, 3>> corners;
    std::vector<Box3> boxes;
    for (const FaceId f : faces) {
      const auto& [a, b, c] = corners.emplace_back(k_.corners(f));
      boxes.push_back(box_of(a, b, c));
    }
    std::vector<Near> result;
    for (std::size_t i = 0; i < faces.size(); ++i) {
      const FaceId f = faces[i];
      const auto& rest = corners[i];
      const Vec3 c = closest_point_on_triangle(x, rest[0], rest[1], rest[2]);
      const double distance = (x - c).norm();
      if (!(distance < reach) || !(distance > 0)) continue;
      const Vec3 almost = x + 0.999 * (c - x);
      Box3 way;
      way.add(x), way.add(almost);
      const auto is_in_the_way = [&](std::size_t j) {
        return j != i && way.meets(boxes[j]) &&
               segment_meets_triangle(x, almost, corners[j][0], corners[j][1], corners[j][2]);
      };
      bool hidden = false;
      for (std::size_t j = 0; j < faces.size() && !hidden; ++j) hidden = is_in_the_way(j);
      if (hidden) continue;
      const Side side{
          f, k_.face(f).crack > 0 && orient3d(rest[0], rest[1], rest[2], x) > 0 ? 1 : 0};  // material is behind side 0
      const Vec3 w = barycentric(c, rest[0], rest[1], rest[2]);
      Vec3 by = Vec3::Zero();
      for (int k = 0; k < 3; ++k)
        by += w[k] * (birth_.positions[k_.surface_vertex(side, k).index()] - rest[static_cast<std::size_t>(k)]);
      result.push_back({c, c + by, like_[k_.surface_vertex(side, 0).index()], distance});
    }
    return result;
  }

  void part(const CrackDelta& crack, double gap) {
    const ContactSurface& s = birth_.surface;
    std::vector<std::uint8_t> marked(s.side.size(), 0), fresh = marked;
    const auto mark = [&](const std::vector<FaceId>& faces, std::vector<std::uint8_t>& in) {
      for (const FaceId f : faces)
        for (auto [row, end] = s.rows_of(f); row < end; ++row) in[row] = 1;
    };
    mark(crack.new_faces, marked), mark(crack.new_crack_faces, fresh);
    const auto rest = [&](std::uint32_t v) { return k_.point(VertexId(s.site[v])); };
    const auto slope = [&](std::uint32_t v) {
      const auto nodes = like_[v].valid() ? nodes_of(like_[v]) : nodes_near(rest(v));
      return nodes.empty() ? Mat3(Mat3::Identity()) : Mat3(Mat3::Identity() + gradient_[nodes[0].index()]);
    };
    if (!untangle(s, rest, slope, fresh, gap, birth_.positions, marked).empty())
      throw GeometryError("the surface would cross itself where the crack begins to open");
  }

  std::vector<NodeId> with_neighbors(NodeId m) const {
    std::vector<NodeId> nodes{m};
    for (const auto& n : body_.graph.neighbors(body_.nodes, m)) nodes.push_back(n.to);
    return nodes;
  }
  std::vector<NodeId> nodes_near(const Vec3& x) const {
    const auto nearest = body_.cache->grid.nearest(body_.nodes.position, x, 1, ~0u, [](std::uint32_t) { return true; });
    return nearest.empty() ? std::vector<NodeId>() : with_neighbors(NodeId(nearest[0]));
  }
  // Those that carry an old surface vertex.
  std::vector<NodeId> nodes_of(SurfaceVertexId v) const {
    const auto master = v.valid() ? body_.binding.master[v.index()] : SurfaceVertexId();
    return master.valid() ? with_neighbors(body_.binding.master_node[master.index()]) : std::vector<NodeId>();
  }
  Vec3 displacement(const Vec3& x, const std::vector<NodeId>& nodes) const {
    if (nodes.empty()) return Vec3::Zero();
    std::vector<std::pair<NodeId, double>> bound;
    for (const NodeId i : nodes)
      if (const double d = (body_.nodes.position[i.index()] - x).norm(); d < body_.nodes.radius[i.index()])
        bound.push_back({i, d});
    if (bound.empty()) bound.push_back({nodes[0], 0.0});
    return displacement_at(x, bound, body_.nodes, state_.displacement, gradient_);
  }

  const Body& body_;
  const State& state_;
  const ContactSurface& before_;
  const std::vector<Vec3>& old_;
  const Complex& k_;
  LazyNodalGradients gradient_;
  Birth birth_;
  std::vector<SurfaceVertexId> like_;  // the old vertex whose nodes say how the material about a vertex moves
  std::vector<std::uint8_t> placed_;
};

}  // namespace

Birth give_birth(const Body& body, const Solid& solid, const State& state, const ContactSurface& before,
                 const std::vector<Vec3>& positions, const Complex& grown, const CrackDelta& crack, double gap) {
  return Midwife(body, solid, state, before, positions, grown, crack).run(crack, gap);
}

}  // namespace geo
