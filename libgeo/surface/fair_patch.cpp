// Liepa 2003: a triangle is divided at its centroid m where √2 |x_i − m| > max(size_m, size_i) for
// each corner i; edges are flipped; then Σ_v |Δx_v|² is minimised over the inner positions (sparse
// LDLᵀ). Δx_v = Σ_w x_w / |x_w − x_v| / Σ_w 1 / |x_w − x_v| − x_v, w: the neighbours of v.
#include "surface/fair_patch.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <set>

#include "surface/polygon.h"

namespace geo {
namespace {

using Corners = std::array<std::uint32_t, 3>;
using Edge = std::pair<std::uint32_t, std::uint32_t>;  // lower corner first
// Limits memory and time only; coarser patches do not depend on it.
constexpr double max_triangles = 1e6;

// The cosine of a triangle's smallest angle; 1 for a degenerate one.
double sharpness(const Vec3& a, const Vec3& b, const Vec3& c) {
  const auto cosine = [](const Vec3& u, const Vec3& v) {
    const double length = u.norm() * v.norm();
    return length > 0 ? u.dot(v) / length : 1.0;
  };
  return std::max({cosine(b - a, c - a), cosine(c - b, a - b), cosine(a - c, b - c)});
}

class Patch {
 public:
  Patch(const std::vector<Vec3>& rim, const std::vector<std::vector<Vec3>>& beyond,
        const std::function<bool(std::uint32_t, std::uint32_t)>& joined)
      : beyond_(beyond), joined_(joined), rim_(rim.size()), at_(rim), size_(rim.size()) {
    std::vector<std::uint32_t> polygon(rim_);
    std::iota(polygon.begin(), polygon.end(), 0u);
    triangles_ = triangles_of(rim, polygon);
    for (std::size_t i = 0; i < rim_; ++i)
      size_[i] = 0.5 * ((rim[i] - rim[(i + 1) % rim_]).norm() + (rim[i] - rim[(i + rim_ - 1) % rim_]).norm());
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) link(t);
  }

  void refine() {
    for (relax(); divide(); relax()) {
    }
  }
  void fair();
  /// Whether there are too many triangles, or will be, to judge by their areas.
  bool too_fine() const {
    double count = 0;
    for (const auto& [a, b, c] : triangles_) {
      const double size = (size_[a] + size_[b] + size_[c]) / 3;  // edge length of equilateral triangles
      count += std::max(1.0, 2 / std::numbers::sqrt3 * (at_[b] - at_[a]).cross(at_[c] - at_[a]).norm() / (size * size));
    }
    return !(count <= max_triangles);
  }

  FairPatch result() const {
    return {{at_.begin() + static_cast<std::ptrdiff_t>(rim_), at_.end()}, between_, triangles_};
  }

 private:
  // Enters a triangle at its edges.
  void link(std::uint32_t t) {
    for (int k = 0; k < 3; ++k) sides_[std::minmax(triangles_[t][k], triangles_[t][(k + 1) % 3])].push_back(t);
  }
  void unlink(std::uint32_t t) {
    for (int k = 0; k < 3; ++k) {
      const auto at = sides_.find(std::minmax(triangles_[t][k], triangles_[t][(k + 1) % 3]));
      std::erase(at->second, t);
      if (at->second.empty()) sides_.erase(at);
    }
  }
  double sharpness_of(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    return sharpness(at_[a], at_[b], at_[c]);
  }
  bool flip(const Edge& edge);
  void relax();
  bool divide();

  const std::vector<std::vector<Vec3>>& beyond_;
  const std::function<bool(std::uint32_t, std::uint32_t)>& joined_;
  std::uint32_t rim_;
  std::vector<Vec3> at_;
  std::vector<double> size_;  // per corner: the wanted edge length
  std::vector<Corners> between_, triangles_;
  std::map<Edge, std::vector<std::uint32_t>> sides_;  // the triangles at each edge
};

// Flips an edge where that makes the smallest angle of both triangles larger, or the edge must not
// exist. Repeated flips terminate.
bool Patch::flip(const Edge& edge) {
  const auto at = sides_.find(edge);
  if (at == sides_.end() || at->second.size() != 2) return false;
  const auto s = at->second[0], t = at->second[1];
  const auto& one = triangles_[s];
  const int k = static_cast<int>(
      std::find_if(one.begin(), one.end(), [&](auto v) { return v != edge.first && v != edge.second; }) - one.begin());
  const std::uint32_t c = one[k], a = one[(k + 1) % 3], b = one[(k + 2) % 3];
  const auto& other = triangles_[t];
  const std::uint32_t d = *std::find_if(other.begin(), other.end(), [&](auto v) { return v != a && v != b; });
  if (c == d || sides_.count(std::minmax(c, d)) || (c < rim_ && d < rim_ && joined_(c, d))) return false;
  // The quad must be convex seen along its normal, or the flip would fold it.
  const Vec3 normal = (at_[d] - at_[c]).cross(at_[b] - at_[a]);
  const auto faces = [&](std::uint32_t i, std::uint32_t j, std::uint32_t k) {
    return (at_[j] - at_[i]).cross(at_[k] - at_[i]).dot(normal) > 0;
  };
  if (!faces(a, d, c) || !faces(d, b, c)) return false;
  const bool there = edge.second < rim_ && joined_(edge.first, edge.second);  // the surface has it already
  if (!there && !(std::max(sharpness_of(a, d, c), sharpness_of(d, b, c)) <
                  std::max(sharpness_of(a, b, c), sharpness_of(b, a, d))))
    return false;
  unlink(s);
  unlink(t);
  triangles_[s] = {a, d, c};
  triangles_[t] = {d, b, c};
  link(s);
  link(t);
  return true;
}

void Patch::relax() {
  std::set<Edge> open;
  for (const auto& [edge, triangles] : sides_) open.insert(edge);
  while (!open.empty()) {
    const Edge edge = *open.begin();
    open.erase(open.begin());
    const auto at = sides_.find(edge);
    if (at == sides_.end()) continue;
    const auto beside = at->second;
    if (!flip(edge)) continue;
    for (const auto t : beside)
      for (int k = 0; k < 3; ++k) open.insert(std::minmax(triangles_[t][k], triangles_[t][(k + 1) % 3]));
  }
}

bool Patch::divide() {
  bool divided = false;
  for (std::uint32_t t = 0, count = static_cast<std::uint32_t>(triangles_.size()); t < count; ++t) {
    const auto [a, b, c] = triangles_[t];
    const Vec3 middle = (at_[a] + at_[b] + at_[c]) / 3;
    const double size = (size_[a] + size_[b] + size_[c]) / 3;
    const auto far = [&](std::uint32_t v) {
      return 2 * (at_[v] - middle).squaredNorm() > std::max(size * size, size_[v] * size_[v]);
    };
    if (!far(a) || !far(b) || !far(c)) continue;
    const auto m = static_cast<std::uint32_t>(at_.size());
    at_.push_back(middle);
    size_.push_back(size);
    between_.push_back({a, b, c});
    unlink(t);
    triangles_[t] = {a, b, m};
    triangles_.insert(triangles_.end(), {{b, c, m}, {c, a, m}});
    link(t);
    link(static_cast<std::uint32_t>(triangles_.size()) - 2);
    link(static_cast<std::uint32_t>(triangles_.size()) - 1);
    if (double(triangles_.size()) > max_triangles) return false;
    divided = true;
  }
  return divided;
}

// Minimises the sum of squared distances of each vertex, on the rim or inside, from the weighted
// mean of its neighbours.
void Patch::fair() {
  const auto inner = static_cast<Eigen::Index>(at_.size() - rim_);
  if (inner == 0) return;
  std::vector<std::vector<std::uint32_t>> around(at_.size());
  for (const auto& [edge, triangles] : sides_) {
    around[edge.first].push_back(edge.second);
    around[edge.second].push_back(edge.first);
  }
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixX3d fixed = Eigen::MatrixX3d::Zero(static_cast<Eigen::Index>(at_.size()), 3);
  for (std::uint32_t v = 0; v < at_.size(); ++v) {
    const auto weight = [&](const Vec3& p) { return 1 / (p - at_[v]).norm(); };
    double sum = 0;
    for (const auto w : around[v]) sum += weight(at_[w]);
    if (v < rim_)
      for (const Vec3& p : beyond_[v]) sum += weight(p);
    if (!std::isfinite(sum) || !(sum > 0)) continue;  // coincident corners have no mean
    const auto add = [&](std::uint32_t w, double share) {
      if (w >= rim_)
        entries.emplace_back(v, w - rim_, share);
      else
        fixed.row(v) += share * at_[w].transpose();
    };
    add(v, -1);
    for (const auto w : around[v]) add(w, weight(at_[w]) / sum);
    if (v < rim_)
      for (const Vec3& p : beyond_[v]) fixed.row(v) += weight(p) / sum * p.transpose();
  }
  Eigen::SparseMatrix<double> matrix(static_cast<Eigen::Index>(at_.size()), inner);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SparseMatrix<double> transposed = matrix.transpose();
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(transposed * matrix);
  if (solver.info() != Eigen::Success) return;
  const Eigen::MatrixX3d found = solver.solve(transposed * -fixed);
  if (solver.info() != Eigen::Success || !found.allFinite()) return;
  for (Eigen::Index i = 0; i < inner; ++i) at_[rim_ + static_cast<std::size_t>(i)] = found.row(i);
}

}  // namespace

FairPatch fair_patch(const std::vector<Vec3>& rim, const std::vector<std::vector<Vec3>>& beyond,
                     const std::function<bool(std::uint32_t, std::uint32_t)>& joined) {
  Patch patch(rim, beyond, joined);
  for (int round = 0; round < 2; ++round) {  // fairing lengthens the edges of a flat patch
    if (patch.too_fine()) return {};
    patch.refine();
    if (patch.too_fine()) return {};
    patch.fair();
  }
  return patch.result();
}

}  // namespace geo
