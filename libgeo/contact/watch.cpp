#include "contact/watch.h"

#include <algorithm>

#include "base/parallel.h"
#include "contact/affine_motion.h"
#include "contact/close_pairs.h"
#include "contact/dividers.h"

namespace geo {
namespace {

Vec3 normal_of(const Simplex& s, const std::vector<Vec3>& at) {
  return s.size < 3 ? Vec3(Vec3::Zero()) : Vec3((at[s.v[1]] - at[s.v[0]]).cross(at[s.v[2]] - at[s.v[0]]));
}

Vec3 middle_of(const Simplex& s, const std::vector<Vec3>& at) {
  Vec3 sum = at[s.v[0]];
  for (int k = 1; k < s.size; ++k) sum += at[s.v[k]];
  return sum / s.size;
}

// True when the pair is to be watched.
bool examine(const SurfaceMotion& m, Watched& w) {
  const Vec3 across = middle_of(w.a, m.from) - middle_of(w.b, m.from);
  Vec3 quick[3] = {across, normal_of(w.a, m.from), normal_of(w.b, m.from)};
  for (Vec3& d : quick) {
    const double length = d.norm();
    if (!(length > 0)) continue;
    d /= d.dot(across) < 0 ? -length : length;
    if (parted(d, w.a, w.b, m.from) >= m.gap && parted(d, w.a, w.b, m.to) >= m.reach) return false;
  }
  Vec3 a[3], b[3];
  const auto closest_of = [&](const std::vector<Vec3>& at) {
    for (int k = 0; k < w.a.size; ++k) a[k] = at[w.a.v[k]];
    for (int k = 0; k < w.b.size; ++k) b[k] = at[w.b.v[k]];
    return closest_places(a, w.a.size, b, w.b.size);
  };
  w.closest = closest_of(m.from);
  const double distance = w.closest.apart.norm();
  if (!(distance > 0)) return false;
  w.normal = w.closest.apart / distance;
  double best = parted(w.normal, w.a, w.b, m.to);
  if (distance >= m.gap && best >= m.reach) return false;
  // Another direction, if it parts them about as well at the beginning and better at the end.
  for (const Vec3& d : quick) {
    if (!(parted(d, w.a, w.b, m.from) >= 0.5 * std::min(distance, m.gap))) continue;
    if (const double after = parted(d, w.a, w.b, m.to); after > best) best = after, w.normal = d;
  }
  w.gap = std::min({distance, m.gap, std::max(0.0, parted(w.normal, w.a, w.b, m.from))});
  return true;
}

}  // namespace

std::vector<Watched> watch(const SurfaceMotion& m) {
  // All boxes in a frame that moves as the surface does on the whole.
  std::vector<std::array<std::uint32_t, 3>> corners(m.triangles.size());
  std::vector<std::uint8_t> used(m.from.size(), 0);
  for (std::size_t t = 0; t < m.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) used[corners[t][k] = m.together[m.triangles[t][k]]] = 1;
  std::vector<std::uint32_t> rows;
  for (std::uint32_t v = 0; v < used.size(); ++v)
    if (used[v]) rows.push_back(v);
  std::vector<Vec3> carried = m.from;
  if (!rows.empty()) move_affinely(rows, m.from, m.to, carried);
  std::vector<Box3> boxes(corners.size());
  for (std::size_t t = 0; t < corners.size(); ++t) {
    for (const auto v : corners[t]) boxes[t].add(carried[v]), boxes[t].add(m.to[v]);
    boxes[t] = boxes[t].grown(0.5 * m.reach);
  }
  const auto pairs = close_pairs(boxes);
  constexpr std::size_t stretch = 1024;
  std::vector<std::vector<Watched>> found((pairs.size() + stretch - 1) / stretch);
  parallel_for(found.size(), 1, [&](std::size_t begin, std::size_t end) {
    std::pair<Simplex, Simplex> parts[2];
    for (std::size_t s = begin; s < end; ++s)
      for (std::size_t i = s * stretch; i < std::min(pairs.size(), (s + 1) * stretch); ++i) {
        if (parts_apart(corners[pairs[i].first], corners[pairs[i].second], parts) != 1) continue;
        Watched w{parts[0].first, parts[0].second, Vec3::Zero(), {}, 0};
        if (examine(m, w)) found[s].push_back(w);
      }
  });
  std::vector<Watched> result;
  for (const auto& f : found) result.insert(result.end(), f.begin(), f.end());
  return result;
}

}  // namespace geo
