#include "contact/watch.h"

#include <algorithm>

#include "base/parallel.h"
#include "contact/close_pairs.h"

namespace geo {
namespace {

// The parts of two triangles that must not meet: none has a corner of the other.
int parts_apart(const std::array<std::uint32_t, 3>& s, const std::array<std::uint32_t, 3>& t, std::pair<Simplex, Simplex> (&parts)[2]) {
  Simplex s_own{{}, 0}, t_own{{}, 0};
  for (int k = 0; k < 3; ++k) {
    if (s[k] != t[0] && s[k] != t[1] && s[k] != t[2]) s_own.v[s_own.size++] = s[k];
    if (t[k] != s[0] && t[k] != s[1] && t[k] != s[2]) t_own.v[t_own.size++] = t[k];
  }
  if (s_own.size == 0 || t_own.size == 0) return 0;
  const Simplex s_all{{s[0], s[1], s[2]}, 3}, t_all{{t[0], t[1], t[2]}, 3};
  parts[0] = {s_own, t_all}, parts[1] = {s_all, t_own};
  return s_own.size == 3 ? 1 : 2;
}

Vec3 normal_of(const Simplex& s, const std::vector<Vec3>& at) {
  return s.size < 3 ? Vec3(Vec3::Zero()) : Vec3((at[s.v[1]] - at[s.v[0]]).cross(at[s.v[2]] - at[s.v[0]]));
}

Vec3 middle_of(const Simplex& s, const std::vector<Vec3>& at) {
  Vec3 sum = at[s.v[0]];
  for (int k = 1; k < s.size; ++k) sum += at[s.v[k]];
  return sum / s.size;
}

// True when the pair is to be watched.
bool examine(const SurfaceMotion& m, Watched& w, bool adjacent) {
  const auto unit = [](const Vec3& d) {
    const double length = d.norm();
    return length > 0 ? Vec3(d / length) : Vec3(Vec3::Zero());
  };
  const Vec3 across = middle_of(w.a, m.from) - middle_of(w.b, m.from);
  const auto oriented = [&](const Vec3& n) { return n.dot(across) < 0 ? unit(-n) : unit(n); };
  const Vec3 quick[3] = {unit(across), oriented(normal_of(w.a, m.from)), oriented(normal_of(w.b, m.from))};
  for (const Vec3& d : quick)
    if (parted(d, w.a, w.b, m.from) >= m.gap && parted(d, w.a, w.b, m.to) >= m.reach) return false;
  Vec3 a[3], b[3];
  const auto apart = [&](const std::vector<Vec3>& at) {
    for (int k = 0; k < w.a.size; ++k) a[k] = at[w.a.v[k]];
    for (int k = 0; k < w.b.size; ++k) b[k] = at[w.b.v[k]];
    return closest_places(a, w.a.size, b, w.b.size).apart;
  };
  const Vec3 now = apart(m.from);
  const double distance = now.norm();
  if (!(distance > 0)) return false;
  w.first = now / distance;
  double best = parted(w.first, w.a, w.b, m.to);
  if (distance >= m.gap && best >= m.reach) return false;
  // Another direction, if it parts them about as well at the beginning and better at the end.
  const Vec3 others[4] = {quick[0], quick[1], quick[2], unit(apart(m.to))};
  for (const Vec3& d : others) {
    if (!(parted(d, w.a, w.b, m.from) >= 0.5 * std::min(distance, m.gap))) continue;
    if (const double after = parted(d, w.a, w.b, m.to); after > best) best = after, w.first = d;
  }
  // Parts of neighbours may become thinner as the body is squeezed, but never flat; sheets in contact keep their distance.
  w.gap = distance > m.gap ? m.gap : adjacent ? 0.5 * distance : distance;
  w.gap = std::min(w.gap, std::max(0.0, parted(w.first, w.a, w.b, m.from)));
  w.normal = w.first;
  turn_to_part(w.normal, w.a, w.b, m.to);
  return true;
}

}  // namespace

std::vector<Watched> watch(const SurfaceMotion& m) {
  // All boxes in a frame that moves as the surface does on average.
  Vec3 drift = Vec3::Zero();
  std::vector<std::array<std::uint32_t, 3>> corners(m.triangles.size());
  for (std::size_t t = 0; t < m.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const auto v = corners[t][k] = m.together[m.triangles[t][k]];
      drift += m.to[v] - m.from[v];
    }
  if (!corners.empty()) drift /= 3 * double(corners.size());
  std::vector<Box3> boxes(corners.size());
  for (std::size_t t = 0; t < corners.size(); ++t) {
    for (const auto v : corners[t]) boxes[t].add(m.from[v] + drift), boxes[t].add(m.to[v]);
    boxes[t] = boxes[t].grown(0.5 * m.reach);
  }
  const auto pairs = close_pairs(boxes);
  constexpr std::size_t stretch = 1024;
  std::vector<std::vector<Watched>> found((pairs.size() + stretch - 1) / stretch);
  parallel_for(found.size(), 1, [&](std::size_t begin, std::size_t end) {
    std::pair<Simplex, Simplex> parts[2];
    for (std::size_t s = begin; s < end; ++s)
      for (std::size_t i = s * stretch; i < std::min(pairs.size(), (s + 1) * stretch); ++i) {
        if (std::binary_search(m.crossing.begin(), m.crossing.end(), pairs[i])) continue;
        const int count = parts_apart(corners[pairs[i].first], corners[pairs[i].second], parts);
        for (int k = 0; k < count; ++k) {
          Watched w{parts[k].first, parts[k].second, Vec3::Zero(), Vec3::Zero(), 0};
          if (examine(m, w, count == 2)) found[s].push_back(w);
        }
      }
  });
  std::vector<Watched> result;
  for (const auto& f : found) result.insert(result.end(), f.begin(), f.end());
  return result;
}

void turn_to_end(std::vector<Watched>& watched, const SurfaceMotion& m) {
  parallel_for(watched.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) watched[i].normal = watched[i].first, turn_to_part(watched[i].normal, watched[i].a, watched[i].b, m.to);
  });
}

}  // namespace geo
