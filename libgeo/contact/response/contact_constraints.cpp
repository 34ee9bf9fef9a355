#include "contact/response/contact_constraints.h"

#include <algorithm>
#include <limits>
#include <tuple>

#include "kerf/parallel.h"

namespace geo {

std::vector<ContactConstraint> contact_constraints(const std::vector<Watched>& watched, const SurfaceMotion& m,
                                                   const ConstraintOptions& how) {
  using Key = std::array<std::uint32_t, 6>;
  using Name = std::pair<Key, Key>;  // of the places; and of the couple that has them, so that it does not depend on
                                     // the couples' order which of several is taken
  constexpr std::size_t stretch = 256;
  std::vector<std::pair<std::vector<ContactConstraint>, std::vector<Name>>> some((watched.size() + stretch - 1) /
                                                                                 stretch);
  const auto look_at = [&](const Watched& w, std::vector<ContactConstraint>& result, std::vector<Name>& names) {
    if (parted(w.normal, w.a, w.b, m.to) >= w.gap + how.reach) return;
    const ClosestPlaces& c = w.closest;
    ContactConstraint t{{{}, {}, 0}, {{}, {}, 0}, w.normal, 0, 0};
    const auto take = [](SurfacePoint& place, const Simplex& s, const Vec3& weights) {
      for (int k = 0; k < s.size; ++k)
        if (weights[k] > 0) place.vertex[place.size] = s.v[k], place.weight[place.size++] = weights[k];
    };
    take(t.a, w.a, c.from), take(t.b, w.b, c.to);
    t.approach = std::max(0.0, w.normal.dot(c.apart) - w.gap) / how.dt;
    Vec3 apart = Vec3::Zero();
    for (int k = 0; k < t.a.size; ++k) apart += t.a.weight[k] * m.to[t.a.vertex[k]];
    for (int k = 0; k < t.b.size; ++k) apart -= t.b.weight[k] * m.to[t.b.vertex[k]];
    t.depth = w.gap - t.normal.dot(apart);
    if (how.share > 0) t.approach = -how.share * std::max(0.0, t.depth) / how.dt;
    // Neighbouring triangles have places in common: they are named by the vertices that carry them.
    Key key;
    key.fill(~0u);
    std::copy(t.a.vertex, t.a.vertex + t.a.size, key.begin()),
        std::copy(t.b.vertex, t.b.vertex + t.b.size, key.begin() + 3);
    std::sort(key.begin(), key.begin() + 3), std::sort(key.begin() + 3, key.end());
    if (std::lexicographical_compare(key.begin() + 3, key.end(), key.begin(), key.begin() + 3))
      std::rotate(key.begin(), key.begin() + 3, key.end());
    names.push_back({key, {w.a.v[0], w.a.v[1], w.a.v[2], w.b.v[0], w.b.v[1], w.b.v[2]}}), result.push_back(t);
  };
  parallel_for(some.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s)
      for (std::size_t i = s * stretch; i < std::min(watched.size(), (s + 1) * stretch); ++i)
        look_at(watched[i], some[s].first, some[s].second);
  });
  std::vector<ContactConstraint> result;
  std::vector<Name> names;
  for (const auto& [places, named] : some)
    result.insert(result.end(), places.begin(), places.end()), names.insert(names.end(), named.begin(), named.end());
  std::vector<std::uint32_t> order(result.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](auto i, auto j) { return std::tie(names[i], i) < std::tie(names[j], j); });
  std::vector<ContactConstraint> once;
  for (std::size_t i = 0; i < order.size(); ++i)
    if (i == 0 || names[order[i]].first != names[order[i - 1]].first) once.push_back(result[order[i]]);
  return once;
}

void add_sheet_constraints(const Copies& copies, const std::vector<Vec3>& targets, const std::vector<Vec3>& normals,
                           double tolerance, const ConstraintOptions& how, std::vector<ContactConstraint>& out) {
  for (std::size_t v = 0; v < copies.size(); ++v)
    for (std::size_t i = 0; i < copies[v].size(); ++i)
      for (std::size_t j = i + 1; j < copies[v].size(); ++j) {
        const auto a = copies[v][i], b = copies[v][j];
        const Vec3 across =
            normals[b].normalized() - normals[a].normalized();  // b's material looks at a along its normal
        if (!(across.norm() > 0.5)) continue;
        const Vec3 n = across.normalized();
        const double apart = n.dot(targets[a] - targets[b]);
        if (apart < -tolerance) out.push_back({{{a}, {1}, 1}, {{b}, {1}, 1}, n, -apart, how.share * apart / how.dt});
      }
}

std::vector<ContactConstraint> deepest_constraints(const std::vector<ContactConstraint>& touching,
                                                   const SurfaceWeights& weights, std::size_t most) {
  const auto node = [&](const SurfacePoint& place) {
    return weights.heaviest()[place.vertex[std::max_element(place.weight, place.weight + place.size) - place.weight]];
  };
  struct Entry {
    std::uint32_t low, high;  // the two nodes
    double depth;
    std::size_t row;
  };
  std::vector<Entry> order(touching.size());
  parallel_for(order.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto a = node(touching[i].a), b = node(touching[i].b);
      order[i] = {std::min(a, b), std::max(a, b), touching[i].depth, i};
    }
  });
  std::sort(order.begin(), order.end(), [](const Entry& p, const Entry& q) {
    return std::tie(p.low, p.high, q.depth, p.row) < std::tie(q.low, q.high, p.depth, q.row);
  });
  std::vector<std::size_t> kept;
  for (std::size_t i = 0, first = 0; i < order.size(); ++i) {
    if (order[i].low != order[first].low || order[i].high != order[first].high) first = i;
    if (i - first < most) kept.push_back(order[i].row);
  }
  std::sort(kept.begin(), kept.end());
  std::vector<ContactConstraint> result;
  for (const auto i : kept) result.push_back(touching[i]);
  return result;
}

}  // namespace geo
