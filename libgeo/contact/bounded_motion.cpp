#include "contact/bounded_motion.h"

#include <Eigen/SVD>
#include <algorithm>
#include <map>
#include <numeric>

#include "contact/crossing.h"

namespace geo {
namespace {

// Vertices that move as rigid bodies.
class Zones {
 public:
  explicit Zones(std::size_t vertices) : parent_(vertices), in_(vertices, 0) { std::iota(parent_.begin(), parent_.end(), 0u); }

  bool has(std::uint32_t v) const { return in_[v]; }
  bool same(std::uint32_t v, std::uint32_t w) { return in_[v] && in_[w] && root(v) == root(w); }
  std::size_t count() const { return static_cast<std::size_t>(std::count(in_.begin(), in_.end(), 1)); }
  /// Returns true when this is new.
  bool join(std::uint32_t v, std::uint32_t w) {
    const bool is_new = !same(v, w);
    in_[v] = in_[w] = 1;
    const auto a = root(v), b = root(w);
    parent_[std::max(a, b)] = std::min(a, b);
    return is_new;
  }
  void place(const SurfaceMotion& m, std::vector<Vec3>& at) {
    std::map<std::uint32_t, std::vector<std::uint32_t>> members;
    for (std::uint32_t v = 0; v < in_.size(); ++v)
      if (in_[v]) members[root(v)].push_back(v);
    for (const auto& [zone, rows] : members) move_rigidly(m, rows, at);
  }
  /// The rigid motion that is closest to what the rows want (Kabsch 1976).
  static void move_rigidly(const SurfaceMotion& m, const std::vector<std::uint32_t>& rows, std::vector<Vec3>& at) {
    Vec3 from = Vec3::Zero(), to = Vec3::Zero();
    for (const auto v : rows) from += m.from[v], to += m.to[v];
    from /= double(rows.size()), to /= double(rows.size());
    Mat3 product = Mat3::Zero();
    for (const auto v : rows) product += (m.to[v] - to) * (m.from[v] - from).transpose();
    const Eigen::JacobiSVD<Mat3> svd(product, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Mat3 flip = Vec3(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1).asDiagonal();
    const Mat3 turn = svd.matrixU() * flip * svd.matrixV().transpose();
    for (const auto v : rows) at[v] = to + turn * (m.from[v] - from);
  }

 private:
  std::uint32_t root(std::uint32_t v) {
    while (parent_[v] != v) v = parent_[v] = parent_[parent_[v]];
    return v;
  }
  std::vector<std::uint32_t> parent_;
  std::vector<std::uint8_t> in_;
};

// Pushes the parts of a pair to either side of the plane in the middle of where they want to be. True when that moved them.
bool push(const Watched& w, const SurfaceMotion& m, const Zones& zones, std::vector<Vec3>& at, std::vector<std::uint8_t>& moved) {
  double a_least = std::numeric_limits<double>::infinity(), b_most = -a_least;
  bool a_free = true, b_free = true;
  for (int k = 0; k < w.a.size; ++k) a_least = std::min(a_least, w.normal.dot(at[w.a.v[k]])), a_free = a_free && !zones.has(w.a.v[k]);
  for (int k = 0; k < w.b.size; ++k) b_most = std::max(b_most, w.normal.dot(at[w.b.v[k]])), b_free = b_free && !zones.has(w.b.v[k]);
  const double gap = std::min(1.5 * w.gap, std::max(w.gap, m.gap));
  double plane = 0.5 * (a_least + b_most);
  if (!a_free && b_free) plane = a_least - 0.5 * gap;
  if (!b_free && a_free) plane = b_most + 0.5 * gap;
  bool far = false;
  const auto shift = [&](std::uint32_t v, double bound, double sign) {
    const double lack = sign * (bound - w.normal.dot(at[v]));
    if (!(lack > 0) || zones.has(v)) return;
    at[v] += sign * lack * w.normal, moved[v] = 1;
    far = far || lack > 1e-3 * gap;
  };
  for (int k = 0; k < w.a.size; ++k) shift(w.a.v[k], plane + 0.5 * gap, 1);
  for (int k = 0; k < w.b.size; ++k) shift(w.b.v[k], plane - 0.5 * gap, -1);
  return far;
}

constexpr std::size_t most_sweeps = 24, most_growths = 10;

// Sweeps through the pairs until all are parted; the rows of those that are not.
std::vector<std::size_t> part(std::vector<Watched>& watched, const SurfaceMotion& m, Zones& zones, std::vector<Vec3>& at, BoundedMotion& report) {
  std::vector<std::uint8_t> moved(at.size(), 1), moving(at.size(), 0);
  std::vector<std::size_t> failing;
  for (std::size_t sweep = 0; sweep < most_sweeps; ++sweep, ++report.sweeps) {
    failing.clear();
    bool far = false;
    std::fill(moving.begin(), moving.end(), 0);
    for (std::size_t i = 0; i < watched.size(); ++i) {
      Watched& w = watched[i];
      bool touched = false;
      for (int k = 0; k < w.a.size; ++k) touched = touched || moved[w.a.v[k]] || moving[w.a.v[k]];
      for (int k = 0; k < w.b.size; ++k) touched = touched || moved[w.b.v[k]] || moving[w.b.v[k]];
      if (!touched || parted(w.normal, w.a, w.b, at) >= 0.99 * w.gap) continue;
      bool rigid = true;  // a zone keeps what is inside it apart
      for (int k = 0; k < w.a.size; ++k) rigid = rigid && zones.same(w.a.v[0], w.a.v[k]);
      for (int k = 0; k < w.b.size; ++k) rigid = rigid && zones.same(w.a.v[0], w.b.v[k]);
      if (rigid) continue;
      Vec3 turned = w.first;  // the pair may have turned since the beginning
      if (turn_to_part(turned, w.a, w.b, at) >= 0.99 * w.gap) {
        w.normal = turned;
        continue;
      }
      failing.push_back(i);
      far |= push(w, m, zones, at, moving);
      // A pair that cannot be pushed (zones on both sides) must be met again.
      for (int k = 0; k < w.a.size; ++k) moving[w.a.v[k]] = 1;
    }
    if (failing.empty() || !far) break;
    moved.swap(moving);
  }
  return failing;
}

}  // namespace

std::vector<Vec3> move_without_crossing(const SurfaceMotion& m, bool two_sided, BoundedMotion* told) {
  BoundedMotion own, &report = told ? *told : own;
  auto watched = watch(m);
  report.watched = watched.size();
  Zones zones(m.to.size());
  std::vector<Vec3> at = m.to;
  const auto follow = [&] {
    for (std::size_t v = 0; v < at.size(); ++v) at[v] = at[m.together[v]];
  };
  // What crosses now and did not at the beginning.
  const auto made = [&] {
    auto crossings = find_crossings(m.triangles, at, m.together, two_sided);
    std::erase_if(crossings, [&](const auto& pair) { return std::binary_search(m.crossing.begin(), m.crossing.end(), pair); });
    return crossings;
  };
  for (std::size_t growth = 0; growth < most_growths; ++growth) {
    bool grown = false;
    const auto failing = part(watched, m, zones, at, report);
    for (const std::size_t i : failing) {
      const Watched& w = watched[i];
      for (int k = 0; k < w.a.size; ++k) grown |= zones.join(w.a.v[0], w.a.v[k]);
      for (int k = 0; k < w.b.size; ++k) grown |= zones.join(w.a.v[0], w.b.v[k]);
    }
    if (failing.empty()) {
      follow();
      const auto crossings = made();
      if (crossings.empty()) {
        report.in_zones = zones.count();
        return at;
      }
      for (const auto& [s, t] : crossings) {
        const auto first = m.together[m.triangles[s][0]];
        for (const auto v : m.triangles[s]) grown |= zones.join(first, m.together[v]);
        for (const auto v : m.triangles[t]) grown |= zones.join(first, m.together[v]);
      }
    }
    if (!grown) break;
    zones.place(m, at);
  }
  std::vector<std::uint32_t> all;
  for (const auto& t : m.triangles)
    for (const auto v : t) all.push_back(m.together[v]);
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  report.in_zones = all.size();
  at = m.from;
  if (!all.empty()) Zones::move_rigidly(m, all, at);
  follow();
  if (made().empty()) return at;
  report.held = true;
  return m.from;
}

}  // namespace geo
