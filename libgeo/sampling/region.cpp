// Parity of crossings: a point is inside if the segment from the probe crosses the surface an odd
// number of times, by exact predicates. A segment that touches an edge or corner, or ends on a
// triangle, falls back to the BVH. Many points are handled as bits of 64-bit words.
#include "sampling/region.h"

#include <algorithm>
#include <bit>

#include "geometry/orientation_lanes.h"
#include "geometry/predicates.h"

namespace geo {
namespace {

/// Crossings of segment pq with a triangle of whose plane the ends are on sides sp and sq: 0 or 1,
/// or −1 where it touches the plane, an edge or a corner.
int crossings(const Vec3& p, const Vec3& q, int sp, int sq, const std::array<Vec3, 3>& t) {
  if (sp == 0 || sq == 0) return segment_meets_triangle(p, q, t[0], t[1], t[2]) ? -1 : 0;
  if (sp == sq) return 0;
  const int e0 = orient3d(p, q, t[0], t[1]), e1 = orient3d(p, q, t[1], t[2]), e2 = orient3d(p, q, t[2], t[0]);
  const bool plus = e0 > 0 || e1 > 0 || e2 > 0, minus = e0 < 0 || e1 < 0 || e2 < 0;
  if (plus && minus) return 0;
  return e0 == 0 || e1 == 0 || e2 == 0 ? -1 : 1;
}

// Whether the triangle has all of its plane that is in the box: seen along the axis that it faces
// most, the box is strictly within it.
bool covers(const std::array<Vec3, 3>& t, const Box3& box) {
  int axis = 0;
  (t[1] - t[0]).cross(t[2] - t[0]).cwiseAbs().maxCoeff(&axis);
  const int turn = orient2d_filtered(t[0], t[1], t[2], axis);
  if (turn == 2) return false;
  for (int k = 0; k < 4; ++k) {
    Vec3 corner = box.lo;
    for (int side = 0; side < 2; ++side)
      if (const int a = (axis + 1 + side) % 3; k >> side & 1) corner[a] = box.hi[a];
    for (int e = 0; e < 3; ++e)
      if (orient2d_filtered(t[static_cast<std::size_t>(e)], t[static_cast<std::size_t>((e + 1) % 3)], corner, axis) !=
          turn)
        return false;
  }
  return true;
}

}  // namespace

bool may_meet(const Box3& box, const Vec3& a, const Vec3& b, const Vec3& c) {
  if (!box_of(a, b, c).meets(box)) return false;
  const auto corner = [&](int k) {
    return Vec3(k & 1 ? box.hi.x() : box.lo.x(), k & 2 ? box.hi.y() : box.lo.y(), k & 4 ? box.hi.z() : box.lo.z());
  };
  // All corners strictly on one side of its plane.
  const int side = orient3d_filtered(a, b, c, corner(0));
  if (side != 2) {
    int k = 1;
    while (k < 8 && orient3d_filtered(a, b, c, corner(k)) == side) ++k;
    if (k == 8) return false;
  }
  // Seen along an axis: all corners strictly on the far side of an edge.
  for (int axis = 0; axis < 3; ++axis) {
    const int turn = orient2d_filtered(a, b, c, axis);
    if (turn == 2) continue;
    const int i = 1 << (axis + 1) % 3, j = 1 << (axis + 2) % 3;
    const auto beyond = [&](const Vec3& p, const Vec3& q) {
      for (const int k : {0, i, j, i | j})
        if (orient2d_filtered(p, q, corner(k), axis) != -turn) return false;
      return true;
    };
    if (beyond(a, b) || beyond(b, c) || beyond(c, a)) return false;
  }
  return true;
}

RegionTree::RegionTree(const TriangleMesh& solid) {
  corners_.reserve(solid.triangles.size());
  for (const auto& [a, b, c] : solid.triangles) {
    corners_.push_back({solid.vertices[a], solid.vertices[b], solid.vertices[c]});
    const auto& t = corners_.back();
    normals_.push_back((t[1] - t[0]).cross(t[2] - t[0]).stableNormalized());
  }
  tree_ = TriangleBvh(corners_);
}

Region RegionTree::root(const Lattice& lattice, const Cell& cell) const {
  Region region{.cell = cell, .probe = lattice.middle(cell), .inside = false, .triangles = {}};
  region.inside = tree_.inside(region.probe);
  region.triangles.resize(corners_.size());
  for (std::uint32_t i = 0; i < region.triangles.size(); ++i) region.triangles[i] = i;
  return region;
}

Region RegionTree::at(const Lattice& lattice, const Cell& cell) const {
  Region region{.cell = cell, .probe = lattice.middle(cell), .inside = false, .triangles = {}};
  region.inside = tree_.inside(region.probe);
  const Box3 box = lattice.box(cell);
  tree_.near(box, region.triangles);
  std::erase_if(region.triangles, [&](auto triangle) {
    return !may_meet(box, corners_[triangle][0], corners_[triangle][1], corners_[triangle][2]);
  });
  std::sort(region.triangles.begin(), region.triangles.end());
  return region;
}

Region RegionTree::child(const Lattice& lattice, const Region& region, const Cell& cell) const {
  Region part{.cell = cell, .probe = lattice.middle(cell), .inside = region.inside, .triangles = {}};
  if (!region.cut()) return part;
  const Box3 box = lattice.box(cell);
  for (const auto triangle : region.triangles)
    if (const auto& t = corners_[triangle]; may_meet(box, t[0], t[1], t[2])) part.triangles.push_back(triangle);
  part.inside = inside(region, part.probe);
  return part;
}

bool RegionTree::inside(const Region& region, const Vec3& p) const {
  bool odd = false;
  for (const auto triangle : region.triangles) {
    const auto& t = corners_[triangle];
    const int n =
        crossings(region.probe, p, orient3d(t[0], t[1], t[2], region.probe), orient3d(t[0], t[1], t[2], p), t);
    if (n < 0) return tree_.inside(p);
    odd ^= n == 1;
  }
  return region.inside != odd;
}

void RegionTree::inside(const Region& region, std::span<const Vec3> points, std::span<char> answers) const {
  // Walks from each point to the next, the first from the probe. A triangle with both on one side
  // of its plane is not between them. One bit a point.
  const std::size_t count = points.size(), words = (count + 63) / 64;
  const auto padded = 64 * words;
  std::vector<double> coordinates(3 * padded);
  const double* const at[3] = {&coordinates[0], &coordinates[padded], &coordinates[2 * padded]};
  Box3 box;
  box.add(region.probe);
  for (std::size_t i = 0; i < padded; ++i) {
    const Vec3& p = points[std::min(i, count - 1)];
    for (std::size_t axis = 0; axis < 3; ++axis) coordinates[axis * padded + i] = p[static_cast<int>(axis)];
    box.add(p);
  }
  std::vector<std::uint64_t> bits(5 * words, 0);
  std::uint64_t *const above = &bits[0], *const below = &bits[words], *const odd = &bits[2 * words],
                       *const unknown = &bits[3 * words], *const ask = &bits[4 * words];
  const auto bit = [](const std::uint64_t* of, std::size_t i) { return int(of[i / 64] >> i % 64 & 1); };
  for (const auto triangle : region.triangles) {
    const auto& t = corners_[triangle];
    const int first = orient3d(t[0], t[1], t[2], region.probe);
    filtered_orientations(t, at, words, above, below);
    bool clear = first != 0;
    for (std::size_t w = 0; w < words; ++w)
      for (std::uint64_t left = ~(above[w] | below[w]); left != 0; left &= left - 1) {
        const auto k = static_cast<std::size_t>(std::countr_zero(left));
        const int side = 64 * w + k < count ? orient3d_exact(t[0], t[1], t[2], points[64 * w + k]) : 1;
        (side < 0 ? below : above)[w] |= std::uint64_t(side != 0) << k;
        clear = clear && side != 0;
      }
    // Bits of points that are in the plane, or on another side of it than the point before them.
    std::uint64_t over = first > 0, under = first < 0;
    for (std::size_t w = 0; w < words; ++w) {
      ask[w] = (above[w] ^ (above[w] << 1 | over)) | (below[w] ^ (below[w] << 1 | under)) | ~(above[w] | below[w]);
      over = above[w] >> 63;
      under = below[w] >> 63;
    }
    if (clear && covers(t, box)) {
      for (std::size_t w = 0; w < words; ++w) odd[w] ^= ask[w];
      continue;
    }
    for (std::size_t w = 0; w < words; ++w)
      for (std::uint64_t left = ask[w]; left != 0; left &= left - 1) {
        const auto i = 64 * w + static_cast<std::size_t>(std::countr_zero(left));
        const std::uint64_t here = left & -left;
        if (i >= count) break;
        const int before = i ? bit(above, i - 1) - bit(below, i - 1) : first;
        const int n = crossings(i ? points[i - 1] : region.probe, points[i], before, bit(above, i) - bit(below, i), t);
        if (n < 0) unknown[w] |= here;
        if (n == 1) odd[w] ^= here;
      }
  }
  bool inside = region.inside;
  for (std::size_t i = 0; i < count; ++i)
    answers[i] = inside = bit(unknown, i) ? tree_.inside(points[i]) : inside != bool(bit(odd, i));
}

}  // namespace geo
