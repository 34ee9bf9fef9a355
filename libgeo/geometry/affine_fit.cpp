// With x, y about their centroids: affine map A = (Σ y xᵀ) (Σ x xᵀ)⁻¹; rigid map: the rotation
// nearest to Σ y xᵀ (Kabsch 1976).
#include "geometry/affine_fit.h"

#include <Eigen/LU>
#include <algorithm>

#include "geometry/nearest_rotation.h"
#include "kerf/parallel.h"

namespace geo {
namespace {

using Indices = std::vector<std::uint32_t>;
using Points = std::vector<Vec3>;

// Sums over chunks of fixed size, added in order: the result is the same for any number of threads.
template <class Sums, class Add>
Sums chunked_sum(const Indices& indices, const Add& add) {
  constexpr std::size_t chunk = 1024;
  std::vector<Sums> partial((indices.size() + chunk - 1) / chunk);
  parallel_for(partial.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c)
      for (std::size_t k = c * chunk; k < std::min(indices.size(), (c + 1) * chunk); ++k) add(partial[c], indices[k]);
  });
  Sums total;
  for (const Sums& s : partial) total += s;
  return total;
}

struct Centroids {
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();
  void operator+=(const Centroids& o) {
    from += o.from;
    to += o.to;
  }
};

Centroids centroids_of(const Indices& indices, const Points& from, const Points& to) {
  auto m = chunked_sum<Centroids>(indices, [&](Centroids& sum, std::uint32_t v) {
    sum.from += from[v];
    sum.to += to[v];
  });
  m.from /= double(indices.size());
  m.to /= double(indices.size());
  return m;
}

// With x = from − centroid and y = to − centroid: Σ y xᵀ and Σ x xᵀ.
struct Covariances {
  Mat3 cross = Mat3::Zero(), own = Mat3::Zero();
  void operator+=(const Covariances& o) {
    cross += o.cross;
    own += o.own;
  }
};

void apply_map(const Indices& indices, const Centroids& m, const Mat3& map, const Points& from, Points& at) {
  parallel_for(indices.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) at[indices[k]] = m.to + map * (from[indices[k]] - m.from);
  });
}

}  // namespace

Mat3 linear_fit(const Mat3& cross, const Mat3& own, double regularisation) {
  if (!(regularisation > 0)) return cross * own.inverse();
  const Mat3 regularised = own + regularisation * own.trace() * Mat3::Identity();
  return cross * regularised.inverse();
}

void apply_rigid_fit(const Indices& indices, const Points& from, const Points& to, Points& at) {
  const Centroids m = centroids_of(indices, from, to);
  Mat3 cross = Mat3::Zero();
  for (const auto v : indices) cross += (to[v] - m.to) * (from[v] - m.from).transpose();
  apply_map(indices, m, nearest_rotation(cross).rotation, from, at);
}

void apply_affine_fit(const Indices& indices, const Points& from, const Points& to, Points& at) {
  // A map outside these bounds tells more about outliers or a flat set than about a common motion.
  // The rigid fit replaces it. The bounds choose a start or a frame of contact's motions, which are
  // certified afterwards.
  constexpr double least_determinant = 0.2, largest_norm = 5;
  const Centroids m = centroids_of(indices, from, to);
  const auto sums = chunked_sum<Covariances>(indices, [&](Covariances& sum, std::uint32_t v) {
    const Vec3 arm = from[v] - m.from;
    sum.cross += (to[v] - m.to) * arm.transpose();
    sum.own += arm * arm.transpose();
  });
  const Mat3 map = linear_fit(sums.cross, sums.own);
  if (!map.allFinite() || !(map.determinant() > least_determinant && map.norm() < largest_norm))
    return apply_rigid_fit(indices, from, to, at);
  apply_map(indices, m, map, from, at);
}

}  // namespace geo
