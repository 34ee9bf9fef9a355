#include "contact/affine_motion.h"

#include <Eigen/LU>
#include <Eigen/SVD>

namespace geo {
namespace {

struct Middles {
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();
};

Middles middles(const std::vector<std::uint32_t>& rows, const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
  Middles m;
  for (const auto v : rows) m.from += from[v], m.to += to[v];
  m.from /= double(rows.size()), m.to /= double(rows.size());
  return m;
}

}  // namespace

void move_rigidly(const std::vector<std::uint32_t>& rows, const std::vector<Vec3>& from, const std::vector<Vec3>& to, std::vector<Vec3>& at) {
  const Middles m = middles(rows, from, to);
  Mat3 product = Mat3::Zero();
  for (const auto v : rows) product += (to[v] - m.to) * (from[v] - m.from).transpose();
  const Eigen::JacobiSVD<Mat3> svd(product, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Mat3 flip = Vec3(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1).asDiagonal();
  const Mat3 turn = svd.matrixU() * flip * svd.matrixV().transpose();
  for (const auto v : rows) at[v] = m.to + turn * (from[v] - m.from);
}

void move_affinely(const std::vector<std::uint32_t>& rows, const std::vector<Vec3>& from, const std::vector<Vec3>& to, std::vector<Vec3>& at) {
  const Middles m = middles(rows, from, to);
  Mat3 product = Mat3::Zero(), spread = Mat3::Zero();
  for (const auto v : rows) product += (to[v] - m.to) * (from[v] - m.from).transpose(), spread += (from[v] - m.from) * (from[v] - m.from).transpose();
  const Mat3 map = product * spread.inverse();
  if (!map.allFinite() || !(map.determinant() > 0.2 && map.norm() < 5)) return move_rigidly(rows, from, to, at);
  for (const auto v : rows) at[v] = m.to + map * (from[v] - m.from);
}

}  // namespace geo
