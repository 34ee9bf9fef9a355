// bond_filters() of kerf/peridynamics.h. Each broken bond has a point on the face that breaks it. A
// rectangle around the points of a whole crack is tried first. If it breaks a bond that holds, or
// leaves one whole that it should break, the points are divided.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <span>

#include "geometry/bvh.h"
#include "geometry/predicates.h"
#include "kerf/peridynamics.h"
#include "sampling/node_grid.h"

namespace geo {
namespace {

struct BrokenBond {
  Vec3 p, q, at, normal;  // ends; a point on the face that breaks it, and the face's normal
};

// Where a segment passes through a rectangle, more or less.
enum class Passage { clear, near, through };

// `margin`: clear passes the rectangle at this distance or more, through stays inside by as much.
Passage passage(const BondFilter& f, const Vec3& p, const Vec3& q, double margin) {
  const double above = f.normal.dot(p - f.corner), below = f.normal.dot(q - f.corner);
  if ((above > margin && below > margin) || (above < -margin && below < -margin)) return Passage::clear;
  const Vec3 side = f.bottom.cross(f.normal);
  const auto place = [&](const Vec3& x) { return std::pair(f.bottom.dot(x - f.corner), side.dot(x - f.corner)); };
  if (std::abs(above - below) <= 4 * margin) {  // along the plane
    const auto [a, b] = place(p);
    const auto [c, d] = place(q);
    const bool apart = std::max(a, c) < -margin || std::min(a, c) > f.bottom_length + margin ||
                       std::max(b, d) < -margin || std::min(b, d) > f.side_length + margin;
    return apart ? Passage::clear : Passage::near;
  }
  const double t = std::clamp(above / (above - below), 0.0, 1.0);
  const auto [a, b] = place(p + t * (q - p));
  if (a < -margin || a > f.bottom_length + margin || b < -margin || b > f.side_length + margin) return Passage::clear;
  const bool inside = std::abs(above) > margin && std::abs(below) > margin && (above < 0) != (below < 0) &&
                      a > margin && a < f.bottom_length - margin && b > margin && b < f.side_length - margin;
  return inside ? Passage::through : Passage::near;
}

// The rectangle around the points of some bonds, with the mean normal of their faces, along the
// direction in which the points extend most; larger by `margin` on all sides.
BondFilter rectangle_around(std::span<const BrokenBond> bonds, double margin) {
  BondFilter f;
  Vec3 middle = Vec3::Zero();
  f.normal.setZero();
  for (const BrokenBond& b : bonds) {
    middle += b.at / double(bonds.size());
    f.normal += f.normal.dot(b.normal) < 0 ? -b.normal : b.normal;
  }
  f.normal.normalize();
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const BrokenBond& b : bonds) {
    const Vec3 d = b.at - middle - f.normal.dot(b.at - middle) * f.normal;
    spread += d * d.transpose();
  }
  const Vec3 longest = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(2);
  f.bottom = longest - f.normal.dot(longest) * f.normal;
  f.bottom = f.bottom.norm() > 0.5 ? Vec3(f.bottom.normalized()) : Vec3(f.normal.unitOrthogonal());
  const Vec3 side = f.bottom.cross(f.normal);
  double lo[2] = {0, 0}, hi[2] = {0, 0};
  for (const BrokenBond& b : bonds)
    for (const int k : {0, 1}) {
      const double x = (k == 0 ? f.bottom : side).dot(b.at - middle);
      lo[k] = std::min(lo[k], x);
      hi[k] = std::max(hi[k], x);
    }
  f.corner = middle + (lo[0] - margin) * f.bottom + (lo[1] - margin) * side;
  f.bottom_length = hi[0] - lo[0] + 2 * margin;
  f.side_length = hi[1] - lo[1] + 2 * margin;
  return f;
}

// A square of half width `half` across the bond at its point on the face.
BondFilter square_across(const BrokenBond& bond, double half) {
  BondFilter f;
  f.normal = (bond.q - bond.p).normalized();
  f.bottom = f.normal.unitOrthogonal();
  f.corner = bond.at - half * f.bottom - half * f.bottom.cross(f.normal);
  f.bottom_length = f.side_length = 2 * half;
  return f;
}

class FilterFinder {
 public:
  FilterFinder(const Body& body, const BondModel& model)
      : body_(body), model_(model), grid_(body.nodes.spacing[0], body.nodes.position) {
    horizon_ = model.horizon.back();
    margin_ = 1e-9 * model.horizon.front();
  }

  std::vector<BondFilter> find() {
    auto bonds_of_crack = collect();
    for (auto& [crack, bonds] : bonds_of_crack) cover(bonds);
    return std::move(filters_);
  }

 private:
  // Finds for each broken bond the first face that touches it.
  std::map<std::int32_t, std::vector<BrokenBond>> collect() const {
    const Complex& k = body_.surface;
    std::vector<std::int32_t> crack;
    std::vector<std::array<Vec3, 3>> soup;
    for (std::uint32_t f = 0; f < k.face_count(); ++f)
      if (k.alive(FaceId(f))) {
        crack.push_back(k.face(FaceId(f)).crack);
        soup.push_back(k.corners(FaceId(f)));
      }
    const TriangleBvh tree(soup);
    std::map<std::int32_t, std::vector<BrokenBond>> result;
    std::vector<std::uint32_t> near;
    for (const auto& [i, j] : model_.broken) {
      BrokenBond bond{
          .p = body_.nodes.position[i.index()], .q = body_.nodes.position[j.index()], .at = {}, .normal = {}};
      near.clear();
      tree.near({bond.p.cwiseMin(bond.q), bond.p.cwiseMax(bond.q)}, near);
      std::sort(near.begin(), near.end());
      const auto hit = std::find_if(near.begin(), near.end(), [&](std::uint32_t t) {
        return segment_meets_triangle(bond.p, bond.q, soup[t][0], soup[t][1], soup[t][2]);
      });
      if (hit == near.end()) continue;  // never, as broken bonds touch a face
      const auto& [a, b, c] = soup[*hit];
      bond.normal = face_normal(a, b, c);
      const double above = bond.normal.dot(bond.p - a), below = bond.normal.dot(bond.q - a);
      const double t = above == below ? 0.5 : std::clamp(above / (above - below), 0.0, 1.0);
      bond.at = bond.p + t * (bond.q - bond.p);
      result[crack[*hit]].push_back(bond);
    }
    return result;
  }

  // Whether a rectangle passes no bond of the families.
  bool harmless(const BondFilter& f) {
    const Vec3 side = f.bottom.cross(f.normal);
    const Vec3 middle = f.corner + f.bottom_length / 2 * f.bottom + f.side_length / 2 * side;
    near_.clear();
    grid_.within(body_.nodes.position, middle, std::hypot(f.bottom_length, f.side_length) / 2 + horizon_, near_);
    for (const std::uint32_t i : near_)
      for (auto e = model_.indptr[i]; e < model_.indptr[i + 1]; ++e)
        if (passage(f, body_.nodes.position[i], body_.nodes.position[model_.indices[e]], margin_) != Passage::clear)
          return false;
    return true;
  }

  // Adds rectangles for bonds that one crack breaks.
  void cover(std::span<BrokenBond> bonds) {
    if (bonds.empty()) return;
    const BondFilter f = rectangle_around(bonds, 1e-4 * model_.horizon.front());
    const bool all = std::all_of(bonds.begin(), bonds.end(), [&](const BrokenBond& b) {
      return passage(f, b.p, b.q, margin_) == Passage::through;
    });
    if (all && harmless(f)) return filters_.push_back(f);
    if (bonds.size() == 1) return cross(bonds[0]);
    const auto middle = bonds.begin() + std::ptrdiff_t(bonds.size() / 2);
    std::nth_element(bonds.begin(), middle, bonds.end(),
                     [&](const BrokenBond& a, const BrokenBond& b) { return f.bottom.dot(a.at) < f.bottom.dot(b.at); });
    cover({bonds.begin(), middle});
    cover({middle, bonds.end()});
  }

  // Adds a square for one bond, as large as the bonds around it permit.
  void cross(const BrokenBond& bond) {
    for (double half = 0.01 * model_.horizon.front(); half > 2 * margin_; half /= 4) {
      const BondFilter f = square_across(bond, half);
      if (passage(f, bond.p, bond.q, margin_) == Passage::through && harmless(f)) return filters_.push_back(f);
    }
  }

  const Body& body_;
  const BondModel& model_;
  NodeGrid grid_;
  double horizon_, margin_;  // the longest horizon; how far from a rectangle's edges a bond is to pass
  std::vector<BondFilter> filters_;
  std::vector<std::uint32_t> near_;
};

}  // namespace

std::vector<BondFilter> bond_filters(const Body& body, const BondModel& model) {
  if (model.broken.empty()) return {};
  return FilterFinder(body, model).find();
}

}  // namespace geo
