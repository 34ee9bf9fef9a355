#include "geometry/affine_motion.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>

#include "kerf/parallel.h"

namespace geo {
namespace {

// Sums of stretches of rows one after the other, the same for any number of threads.
template <class Sums, class Add>
Sums summed(const std::vector<std::uint32_t>& rows, const Add& add) {
  constexpr std::size_t stretch = 1024;
  std::vector<Sums> some((rows.size() + stretch - 1) / stretch);
  parallel_for(some.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s)
      for (std::size_t k = s * stretch; k < std::min(rows.size(), (s + 1) * stretch); ++k) add(some[s], rows[k]);
  });
  Sums all;
  for (const Sums& s : some) all += s;
  return all;
}

struct Middles {
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();
  void operator+=(const Middles& o) { from += o.from, to += o.to; }
};

Middles middles(const std::vector<std::uint32_t>& rows, const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
  auto m = summed<Middles>(rows, [&](Middles& sum, std::uint32_t v) { sum.from += from[v], sum.to += to[v]; });
  m.from /= double(rows.size()), m.to /= double(rows.size());
  return m;
}

struct Spreads {
  Mat3 product = Mat3::Zero(), spread = Mat3::Zero();
  void operator+=(const Spreads& o) { product += o.product, spread += o.spread; }
};

void map_rows(const std::vector<std::uint32_t>& rows, const Middles& m, const Mat3& map, const std::vector<Vec3>& from,
              std::vector<Vec3>& at) {
  parallel_for(rows.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) at[rows[k]] = m.to + map * (from[rows[k]] - m.from);
  });
}

}  // namespace

void move_rigidly(const std::vector<std::uint32_t>& rows, const std::vector<Vec3>& from, const std::vector<Vec3>& to,
                  std::vector<Vec3>& at) {
  const Middles m = middles(rows, from, to);
  Mat3 product = Mat3::Zero();
  for (const auto v : rows) product += (to[v] - m.to) * (from[v] - m.from).transpose();
  const Eigen::JacobiSVD<Mat3> svd(product, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Mat3 flip = Vec3(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1).asDiagonal();
  const Mat3 turn = svd.matrixU() * flip * svd.matrixV().transpose();
  map_rows(rows, m, turn, from, at);
}

void move_affinely(const std::vector<std::uint32_t>& rows, const std::vector<Vec3>& from, const std::vector<Vec3>& to,
                   std::vector<Vec3>& at) {
  const Middles m = middles(rows, from, to);
  const auto sums = summed<Spreads>(rows, [&](Spreads& sum, std::uint32_t v) {
    const Vec3 arm = from[v] - m.from;
    sum.product += (to[v] - m.to) * arm.transpose(), sum.spread += arm * arm.transpose();
  });
  const Mat3 map = sums.product * sums.spread.inverse();
  if (!map.allFinite() || !(map.determinant() > 0.2 && map.norm() < 5)) return move_rigidly(rows, from, to, at);
  map_rows(rows, m, map, from, at);
}

}  // namespace geo
