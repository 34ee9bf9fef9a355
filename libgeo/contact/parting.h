// Whether one direction parts two simplices at both ends of a straight motion: then they do not meet during it.
#pragma once

#include <vector>

#include "contact/simplex.h"

namespace geo {

/// True when `accept(n, before)` is for one of some directions n from b to a, of any length, that part most, if any does: between
/// the middles, along the normals, between the closest places at either end. `before`: how far n parts them at `from`.
template <class Accept>
bool some_direction(const Simplex& a, const Simplex& b, const std::vector<Vec3>& from, const std::vector<Vec3>& to, const Accept& accept) {
  const auto offer = [&](const Vec3& n) { return accept(n, parted(n, a, b, from)); };
  const auto middle = [&](const Simplex& s) {
    Vec3 sum = from[s.v[0]];
    for (int k = 1; k < s.size; ++k) sum += from[s.v[k]];
    return Vec3(sum / s.size);
  };
  const Vec3 across = middle(a) - middle(b);
  if (offer(across)) return true;
  for (const Simplex* s : {&a, &b}) {
    if (s->size < 3) continue;
    const Vec3 n = (from[s->v[1]] - from[s->v[0]]).cross(from[s->v[2]] - from[s->v[0]]);
    if (offer(n.dot(across) < 0 ? Vec3(-n) : n)) return true;
  }
  for (const std::vector<Vec3>* at : {&from, &to}) {
    Vec3 p[3], q[3];
    for (int k = 0; k < a.size; ++k) p[k] = (*at)[a.v[k]];
    for (int k = 0; k < b.size; ++k) q[k] = (*at)[b.v[k]];
    if (offer(closest_places(p, a.size, q, b.size).apart)) return true;
  }
  return false;
}

}  // namespace geo
