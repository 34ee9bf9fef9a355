#include "body/nodes.h"

#include <algorithm>
#include <map>

#include "body/locate.h"
#include "geometry/distance.h"
#include "geometry/predicates.h"
#include "sampling/resample.h"
#include "surface/pieces.h"

namespace geo {
namespace {

// True when p is on the given side of the face and nothing else touches the segment from there to `base` on the face:
// then p is in the material before that side. The face itself is left out because its own point is rounded.
bool stands_before(const Complex& k, Side s, const Vec3& base, const Vec3& p) {
  const auto own = k.corners(s.face);
  if (!k.has(s) || orient3d(own[0], own[1], own[2], p) != (s.which ? 1 : -1)) return false;
  Box3 box{base, base};
  box.add(p);
  std::vector<FaceId> faces;
  k.near(box, faces);
  return std::none_of(faces.begin(), faces.end(), [&](FaceId f) {
    const auto t = k.corners(f);
    return f != s.face && segment_meets_triangle(base, p, t[0], t[1], t[2]);
  });
}

// Nodes along the surface from where i looks at it to where j does, in the wedges of the edges passed on the way: what
// the material joins is joined beside its boundary, however narrow. Nothing when the two look at different shells.
void insert_along(Body& body, NodeId i, NodeId j, double spacing) {
  const Complex& k = body.surface;
  const auto side_of = [&](NodeId n) { return side_seen_from(k, body.nodes.position[n.index()], spacing); };
  const Side from = side_of(i), to = side_of(j);
  std::map<Side, std::pair<Side, int>> before{{from, {from, 0}}};
  std::vector<Side> queue{from};
  for (std::size_t q = 0; q < queue.size() && !before.count(to); ++q)
    for (int e = 0; e < 3; ++e)
      if (const Side n = k.neighbor(queue[q], e); before.try_emplace(n, queue[q], e).second) queue.push_back(n);
  if (!before.count(to)) return;
  const auto inwards = [&](Side s) {
    const auto t = k.corners(s.face);
    return Vec3((s.which ? 1.0 : -1.0) * (t[1] - t[0]).cross(t[2] - t[0]).normalized());
  };
  Vec3 last = body.nodes.position[j.index()];
  for (Side s = to; s != from; s = before.at(s).first) {
    const auto [previous, e] = before.at(s);
    const auto t = k.corners(previous.face);
    const Vec3 middle = 0.5 * (t[e] + t[(e + 1) % 3]);
    Vec3 way = inwards(s) + inwards(previous);
    if (way.norm() < 1e-3) way = middle - t[(e + 2) % 3];  // around a crack's front
    way.normalize();
    double step = 0.5 * spacing;
    while (step > 1e-6 * spacing && (is_blocked(k, middle + 1e-6 * step * way, middle + step * way) ||
                                     !is_inside(k, middle + step * way, spacing)))
      step *= 0.5;
    const Vec3 x = middle + step * way;
    if (step <= 1e-6 * spacing || ((x - last).norm() < 0.5 * spacing && s != to && !is_blocked(k, x, last))) continue;
    insert_node(body, x, i, spacing);
    last = x;
  }
}

}  // namespace

NodeId insert_node(Body& body, const Vec3& x, NodeId donor, double spacing) {
  const NodeId id(body.nodes.size());
  NodeSet& nodes = body.nodes;
  nodes.position.push_back(x);
  nodes.spacing.push_back(spacing);
  nodes.radius.push_back(double(nodes.radius[donor.index()]));
  nodes.volume[donor.index()] *= 0.5;  // exact, so the sum is conserved to the bit
  nodes.volume.push_back(double(nodes.volume[donor.index()]));
  body.debris.push_back(0);
  body.donors.push_back(donor);
  body.grid.insert(id.value, x);
  return id;
}

std::size_t insert_near(Body& body, const std::vector<FaceId>& faces, double spacing, std::uint64_t seed,
                        std::size_t limit) {
  if (faces.empty()) return 0;
  const auto all = [](std::uint32_t) { return true; };
  std::vector<std::array<Vec3, 3>> soup;
  for (const FaceId f : faces) soup.push_back(body.surface.corners(f));
  const Vec3 middle = (soup[0][0] + soup[0][1] + soup[0][2]) / 3;
  const auto nearest = body.grid.nearest(body.nodes.position, middle, 1, ~0u, all);
  if (spacing == 0) spacing = body.nodes.spacing[nearest[0]];
  std::size_t count = 0;
  std::vector<std::uint32_t> near;
  for (const auto& s : offset_samples(soup, spacing, seed)) {
    if (!stands_before(body.surface, {faces[s.face], s.side}, s.base, s.position)) continue;
    near.clear();
    body.grid.within(body.nodes.position, s.position, 0.6 * spacing, near);
    if (std::any_of(near.begin(), near.end(),
                    [&](std::uint32_t i) { return !is_blocked(body.surface, body.nodes.position[i], s.position); }))
      continue;
    // The donor is the nearest node that sees it; else, in a fresh sliver, the nearest of all.
    const auto candidates = body.grid.nearest(body.nodes.position, s.position, 8, ~0u, all);
    NodeId donor(candidates[0]);
    for (const auto i : candidates)
      if (!is_blocked(body.surface, body.nodes.position[i], s.position)) {
        donor = NodeId(i);
        break;
      }
    insert_node(body, s.position, donor, spacing);
    if (++count == limit) break;
  }
  return count;
}

std::vector<NodeId> move_off(Body& body, const std::vector<FaceId>& faces) {
  std::vector<NodeId> moved;
  std::vector<std::uint32_t> near;
  for (const FaceId f : faces) {
    const auto t = body.surface.corners(f);
    const Vec3 middle = (t[0] + t[1] + t[2]) / 3;
    const double size = std::max({(t[0] - middle).norm(), (t[1] - middle).norm(), (t[2] - middle).norm()});
    near.clear();
    body.grid.within(body.nodes.position, middle, size + 0.1 * body.grid.cell(), near);
    for (const auto i : near) {
      const Vec3 x = body.nodes.position[i];
      const double spacing = body.nodes.spacing[i];
      const double d = (closest_point_on_triangle(x, t[0], t[1], t[2]) - x).norm();
      if (d > 0.02 * spacing) continue;
      const int above = orient3d(t[0], t[1], t[2], x);
      Vec3 away = (t[1] - t[0]).cross(t[2] - t[0]).normalized();
      if (above < 0) away = -away;
      // As far as there is room, at most a tenth of the spacing.
      for (double step = 0.1 * spacing; step > 1e-6 * spacing; step *= 0.5) {
        const Vec3 to = x + step * away, from = above == 0 ? Vec3(x + 1e-3 * step * away) : x;
        if (is_blocked(body.surface, from, to)) continue;
        body.grid.erase(i, x);
        body.nodes.position[i] = to;
        body.grid.insert(i, to);
        moved.push_back(NodeId(i));
        break;
      }
    }
  }
  std::sort(moved.begin(), moved.end());
  moved.erase(std::unique(moved.begin(), moved.end()), moved.end());
  return moved;
}

void connect_pieces(Body& body, const std::function<void(NodeId)>& after) {
  double scale = 0.7;
  for (int round = 0; round < 6; ++round, scale *= 0.6) {
    std::vector<std::uint32_t> component;
    const auto count = body.graph.components(component);
    const Pieces pieces = find_pieces(body.surface);
    const auto piece_of = [&](std::uint32_t i) {
      const Side s = side_seen_from(body.surface, body.nodes.position[i], body.nodes.spacing[i]);
      return pieces.of_side[s.face.index() * 2 + static_cast<std::size_t>(s.which)];
    };
    // The largest component of each piece stands for it; the others want a way to it.
    std::vector<std::uint32_t> size(count, 0), first(count, ~0u);
    for (std::uint32_t i = 0; i < component.size(); ++i)
      if (size[component[i]]++ == 0) first[component[i]] = i;
    std::vector<std::int32_t> piece(count);
    std::vector<std::uint32_t> main(pieces.count, ~0u);
    for (std::uint32_t c = 0; c < count; ++c) {
      piece[c] = piece_of(first[c]);
      if (piece[c] < 0) continue;
      auto& m = main[static_cast<std::size_t>(piece[c])];
      if (m == ~0u || size[c] > size[m]) m = c;
    }
    const NodeId first_new(body.nodes.size());
    for (std::uint32_t p = 0; p < pieces.count; ++p) {
      if (main[p] != ~0u) continue;
      // No node at all: one on the line from the middle of its largest face straight into it, half way to what comes
      // next.
      Side best;
      double most = -1;
      for (std::uint32_t f = 0; f < body.surface.face_count(); ++f)
        for (int which = 0; which < 2; ++which)
          if (pieces.of_side[f * 2 + static_cast<std::uint32_t>(which)] == static_cast<std::int32_t>(p)) {
            const auto t = body.surface.corners(FaceId(f));
            const double a = (t[1] - t[0]).cross(t[2] - t[0]).norm();
            if (a > most) most = a, best = {FaceId(f), which};
          }
      const auto t = body.surface.corners(best.face);
      const Vec3 middle = (t[0] + t[1] + t[2]) / 3;
      const Vec3 inwards = (best.which ? 1.0 : -1.0) * (t[1] - t[0]).cross(t[2] - t[0]).normalized();
      const auto donor = body.grid.nearest(body.nodes.position, middle, 1, ~0u, [](auto) { return true; });
      double step = body.nodes.spacing[donor[0]];
      while (step > 1e-12 * body.surface.extent().diagonal() &&
             !stands_before(body.surface, best, middle, middle + step * inwards))
        step *= 0.6;
      insert_node(body, middle + 0.5 * step * inwards, NodeId(donor[0]), body.nodes.spacing[donor[0]]);
    }
    std::vector<FaceId> narrow;
    for (std::uint32_t i = 0; i < component.size(); ++i) {
      const auto c = component[i];
      if (piece[c] < 0 || main[static_cast<std::size_t>(piece[c])] == c) continue;
      body.surface.near(Box3{body.nodes.position[i], body.nodes.position[i]}.grown(1.5 * body.nodes.spacing[i]),
                        narrow);
    }
    std::sort(narrow.begin(), narrow.end());
    narrow.erase(std::unique(narrow.begin(), narrow.end()), narrow.end());
    // Bounded, so that a passage that stays closed costs little; the spacing shrinks with the rounds alone.
    insert_near(body, narrow, scale * body.grid.cell(), 0x6b657266u + static_cast<std::uint64_t>(round), 100);
    if (round >= 2)
      for (std::uint32_t c = 0; c < count; ++c) {
        if (piece[c] < 0 || main[static_cast<std::size_t>(piece[c])] == c) continue;
        const auto target = main[static_cast<std::size_t>(piece[c])];
        const auto near =
            body.grid.nearest(body.nodes.position, body.nodes.position[first[c]], 1, first[c],
                              [&](std::uint32_t i) { return i < component.size() && component[i] == target; });
        if (!near.empty()) insert_along(body, NodeId(first[c]), NodeId(near[0]), scale * body.grid.cell());
      }
    if (first_new.index() == body.nodes.size()) return;
    after(first_new);
  }
}

void mark_debris(Body& body, const std::vector<NodeId>& nodes) {
  // Four nodes in general position carry a linear field; fewer move as a rigid crumb.
  for (const NodeId i : nodes) body.debris[i.index()] = body.neighbors.of(i).size() < 4;
}

}  // namespace geo
