// Median splits along the longest side of the centres' box. Point in surface: parity of crossings
// along a ray with exact predicates; degenerate rays are replaced by others.
#include "geometry/bvh.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "geometry/distance.h"
#include "geometry/predicates.h"
#include "kerf/parallel.h"

namespace geo {
namespace {

constexpr std::uint32_t leaf_size = 4;  // triangles; affects speed alone

double squared_distance(const Box3& box, const Vec3& p) {
  return (box.lo - p).cwiseMax(p - box.hi).cwiseMax(0.0).squaredNorm();
}

}  // namespace

// Splits ranges of triangles at the median along the longest side of their centres' box.
struct TriangleBvh::Builder {
  struct Job {
    std::uint32_t node, begin, end;
  };
  std::vector<Box3> boxes;
  std::vector<Vec3> centers;
  std::vector<std::uint32_t>& order;

  // Builds the subtree of `root` in `nodes`. Ranges with fewer than `least` triangles are
  // deferred: their jobs are appended to `deferred`, if given.
  void build(const Job& root, std::vector<Node>& nodes, std::uint32_t least = 0,
             std::vector<Job>* deferred = nullptr) const {
    std::vector<Job> jobs{root};
    while (!jobs.empty()) {
      const Job job = jobs.back();
      jobs.pop_back();
      if (deferred && job.end - job.begin < least) {
        deferred->push_back(job);
        continue;
      }
      Box3 box, spread;
      for (auto i = job.begin; i < job.end; ++i) {
        box.add(boxes[order[i]]);
        spread.add(centers[order[i]]);
      }
      nodes[job.node].box = box;
      if (job.end - job.begin <= leaf_size) {
        nodes[job.node].first = job.begin;
        nodes[job.node].count = job.end - job.begin;
        continue;
      }
      int axis = 0;
      (spread.hi - spread.lo).maxCoeff(&axis);
      // The left range is a multiple of 16^k triangles, whole blocks of the wide tree: both trees
      // then group the same triangles.
      const auto count = job.end - job.begin;
      std::uint32_t unit = 1;
      while (unit < (count + WideBvh::width - 1) / WideBvh::width) unit *= WideBvh::width;
      const auto middle = job.begin + ((count + unit - 1) / unit + 1) / 2 * unit;
      std::nth_element(order.begin() + job.begin, order.begin() + middle, order.begin() + job.end, [&](auto a, auto b) {
        return centers[a][axis] != centers[b][axis] ? centers[a][axis] < centers[b][axis] : a < b;
      });
      const auto left = static_cast<std::uint32_t>(nodes.size());
      nodes[job.node].first = left;
      nodes.emplace_back();
      nodes.emplace_back();
      jobs.push_back({left, job.begin, middle});
      jobs.push_back({left + 1, middle, job.end});
    }
  }
};

TriangleBvh::TriangleBvh(std::span<const std::array<Vec3, 3>> triangles)
    : corners_(triangles.begin(), triangles.end()) {
  const auto n = static_cast<std::uint32_t>(corners_.size());
  if (n == 0) return;
  Builder builder{std::vector<Box3>(n), std::vector<Vec3>(n), order_};
  for (std::uint32_t i = 0; i < n; ++i) {
    builder.boxes[i] = box_of(corners_[i][0], corners_[i][1], corners_[i][2]);
    builder.centers[i] = builder.boxes[i].center();
    box_.add(builder.boxes[i]);
  }
  order_.resize(n);
  std::iota(order_.begin(), order_.end(), 0u);
  nodes_.reserve(n);
  nodes_.emplace_back();
  // Subtrees below 1/16 of the triangles are built in parallel; small trees serially.
  constexpr std::uint32_t many = 1024, shares = 16;
  std::vector<Builder::Job> deferred;
  builder.build({0, 0, n}, nodes_, std::max(many, n) / shares, n < many ? nullptr : &deferred);
  std::vector<std::vector<Node>> below(deferred.size());
  parallel_for(deferred.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      below[k].emplace_back();
      builder.build({0, deferred[k].begin, deferred[k].end}, below[k]);
    }
  });
  for (std::size_t k = 0; k < deferred.size(); ++k) {
    const auto offset = static_cast<std::uint32_t>(nodes_.size() - 1);
    for (Node& node : below[k])
      if (node.count == 0) node.first += offset;
    nodes_[deferred[k].node] = below[k][0];
    nodes_.insert(nodes_.end(), below[k].begin() + 1, below[k].end());
  }
  wide_ = WideBvh(corners_, order_);
}

bool TriangleBvh::blocks(const Vec3& p, const Vec3& q) const {
  std::uint8_t result = 0;
  blocks(p, {&q, 1}, &result);
  return result != 0;
}

void TriangleBvh::near(const Box3& box, std::vector<std::uint32_t>& triangles) const {
  if (nodes_.empty()) return;
  std::uint32_t stack[64];
  int top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const Node& node = nodes_[stack[--top]];
    if (!node.box.meets(box)) continue;
    if (node.count == 0) {
      stack[top++] = node.first;
      stack[top++] = node.first + 1;
      continue;
    }
    for (auto i = node.first; i < node.first + node.count; ++i) {
      const auto& t = corners_[order_[i]];
      if (box_of(t[0], t[1], t[2]).meets(box)) triangles.push_back(order_[i]);
    }
  }
}

TriangleBvh::Closest TriangleBvh::closest(const Vec3& p, double cutoff, double enough) const {
  Closest best;
  if (nodes_.empty()) return best;
  double reach = cutoff * cutoff;
  std::pair<double, std::uint32_t> stack[64];
  int top = 0;
  stack[top++] = {squared_distance(nodes_[0].box, p), 0};
  while (top > 0) {
    const auto [bound, at] = stack[--top];
    if (bound > reach) continue;
    const Node& node = nodes_[at];
    if (node.count == 0) {
      const double l = squared_distance(nodes_[node.first].box, p), r = squared_distance(nodes_[node.first + 1].box, p);
      // The nearer child is visited first.
      stack[top++] = l < r ? std::pair{r, node.first + 1} : std::pair{l, node.first};
      stack[top++] = l < r ? std::pair{l, node.first} : std::pair{r, node.first + 1};
      continue;
    }
    for (auto i = node.first; i < node.first + node.count; ++i) {
      const auto& t = corners_[order_[i]];
      const Vec3 c = closest_point_on_triangle(p, t[0], t[1], t[2]);
      const double d = (c - p).squaredNorm();
      if (d < reach || (d == reach && (best.triangle == ~0u || order_[i] < best.triangle))) {
        reach = d;
        best = {order_[i], c, std::sqrt(d)};
      }
      if (enough >= 0 && d <= enough * enough) return {order_[i], c, std::min(std::sqrt(d), enough)};
    }
  }
  return best;
}

TriangleBvh::RayCrossings TriangleBvh::count_crossings(const Vec3& p, const Vec3& q, double margin) const {
  RayCrossings result;
  std::uint32_t stack[64];
  int top = 0;
  stack[top++] = 0;
  while (top > 0 && !result.degenerate) {
    const Node& node = nodes_[stack[--top]];
    // Slab test against the box, with a margin for rounding.
    double from = 0, to = 1;
    for (int k = 0; k < 3; ++k) {
      const double step = q[k] - p[k], a = (node.box.lo[k] - margin - p[k]) / step,
                   b = (node.box.hi[k] + margin - p[k]) / step;
      from = std::max(from, std::min(a, b));
      to = std::min(to, std::max(a, b));
    }
    if (from > to) continue;
    if (node.count == 0) {
      stack[top++] = node.first;
      stack[top++] = node.first + 1;
      continue;
    }
    for (auto i = node.first; i < node.first + node.count && !result.degenerate; ++i) {
      const auto& t = corners_[order_[i]];
      const int sp = orient3d(t[0], t[1], t[2], p), sq = orient3d(t[0], t[1], t[2], q);
      if (sp == 0 && segment_meets_triangle(p, p, t[0], t[1], t[2])) {
        result.on_surface = true;
        return result;
      }
      if (sp == 0 && sq == 0) {
        result.degenerate = segment_meets_triangle(p, q, t[0], t[1], t[2]);
        continue;
      }
      if (sp == sq || sp == 0) continue;
      const int e0 = orient3d(p, q, t[0], t[1]), e1 = orient3d(p, q, t[1], t[2]), e2 = orient3d(p, q, t[2], t[0]);
      const bool plus = e0 >= 0 && e1 >= 0 && e2 >= 0, minus = e0 <= 0 && e1 <= 0 && e2 <= 0;
      if (!plus && !minus) continue;
      if (e0 == 0 || e1 == 0 || e2 == 0 || sq == 0)
        result.degenerate = true;
      else
        ++result.count;
    }
  }
  return result;
}

bool TriangleBvh::inside(const Vec3& p) const {
  if (nodes_.empty() || !Box3{p, p}.meets(box_)) return false;
  // Fixed directions without simple ratios: degenerate rays are rare on real models.
  static constexpr double directions[][3] = {
      {0.5377, 0.2713, 0.7981},  {-0.3319, 0.8511, 0.4069},  {0.7129, -0.6133, 0.3403},  {-0.2731, -0.4817, -0.8329},
      {0.9137, 0.1871, -0.3607}, {-0.6469, 0.3539, -0.6757}, {0.1213, -0.9187, -0.3761}, {0.3967, 0.5669, -0.7219}};
  const double reach = 2 * box_.diagonal() + 1e-300;  // beyond the box, whatever the direction
  for (const auto& d : directions) {
    const RayCrossings ray = count_crossings(p, p + reach * Vec3(d), 1e-12 * reach);
    if (ray.on_surface) return false;
    if (!ray.degenerate) return ray.count % 2 == 1;
  }
  // All fixed rays are degenerate, which only a contrived model achieves: the side of the closest
  // triangle decides.
  const Closest c = closest(p);
  const auto& t = corners_[c.triangle];
  return orient3d(t[0], t[1], t[2], p) < 0;
}

}  // namespace geo
