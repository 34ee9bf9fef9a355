// The planes of triangles, as a quick look at which two they part.
#pragma once

#include <span>
#include <vector>

#include "base/vec.h"

namespace geo {

/// Of all triangles of a surface, where a motion begins and ends. The normals are those of its beginning.
class TrianglePlanes {
 public:
  TrianglePlanes(std::span<const Triangle> triangles, const std::vector<Vec3>& from, const std::vector<Vec3>& to);

  /// After the end of triangle i has changed.
  void renew_end(std::size_t i);

  /// Whether the plane of one of triangles i and j parts them, with the same side, by more than `first` where the motion begins
  /// and by more than `last` where it ends: floating point, to some 1e-15 of coordinates.
  bool part(std::size_t i, std::size_t j, double first, double last) const { return parts(i, j, first, last) || parts(j, i, first, last); }

  /// The farther of the two planes' distances between the triangles where the motion ends, on the side where it begins; negative
  /// when they pass through each other.
  double left(std::size_t i, std::size_t j) const { return std::max(left_by(i, j), left_by(j, i)); }

  /// Whether the way from the middle of j to that of i, where the motion begins, parts them by more than `first` there and by more
  /// than `last` where it ends: of triangles that lie beside each other in a surface it does, where their planes do not.
  bool part_across(std::size_t i, std::size_t j, double first, double last) const {
    const auto &s = triangles_[i], &t = triangles_[j];
    const Vec3 n = planes_[i].middle - planes_[j].middle;
    const double length = n.norm();
    const auto apart = [&](const std::vector<Vec3>& at) {
      return std::min({n.dot(at[s[0]]), n.dot(at[s[1]]), n.dot(at[s[2]])}) - std::max({n.dot(at[t[0]]), n.dot(at[t[1]]), n.dot(at[t[2]])});
    };
    return apart(from_) > first * length && apart(to_) > last * length;
  }

 private:
  struct Plane {
    Vec3 normal;                    // unit; of a triangle without area zero
    Vec3 middle;                    // where the motion begins
    double first_low, first_high;   // of its corners along the normal, at the beginning: of slivers not the same
    double last_low, last_high;     // at the end
  };
  bool parts(std::size_t i, std::size_t j, double first, double last) const {
    const Plane& p = planes_[i];
    const auto& [a, b, c] = triangles_[j];
    const double x = p.normal.dot(from_[a]), y = p.normal.dot(from_[b]), z = p.normal.dot(from_[c]);
    if (std::min({x, y, z}) - p.first_high > first) return std::min({p.normal.dot(to_[a]), p.normal.dot(to_[b]), p.normal.dot(to_[c])}) - p.last_high > last;
    if (p.first_low - std::max({x, y, z}) > first) return p.last_low - std::max({p.normal.dot(to_[a]), p.normal.dot(to_[b]), p.normal.dot(to_[c])}) > last;
    return false;
  }
  double left_by(std::size_t i, std::size_t j) const;

  std::span<const Triangle> triangles_;
  const std::vector<Vec3>&from_, &to_;
  std::vector<Plane> planes_;
};

}  // namespace geo
