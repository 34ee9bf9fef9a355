// Set-up of the tests of motion: two sheets of squares above each other, and their crossings.
#pragma once

#include <cstdint>
#include <numeric>
#include <vector>

#include "contact/detection/find_crossings.h"

namespace geo {

/// Two sheets of n × n squares, two triangles each. Vertices are in the order of sheet, i and j.
inline std::vector<Triangle> triangles_of_two_sheets(std::uint32_t n) {
  std::vector<Triangle> triangles;
  for (const std::uint32_t sheet : {0u, 1u}) {
    const auto v = [&](std::uint32_t i, std::uint32_t j) { return (sheet * (n + 1) + i) * (n + 1) + j; };
    for (std::uint32_t i = 0; i < n; ++i)
      for (std::uint32_t j = 0; j < n; ++j) {
        triangles.push_back({v(i, j), v(i + 1, j), v(i + 1, j + 1)});
        triangles.push_back({v(i, j), v(i + 1, j + 1), v(i, j + 1)});
      }
  }
  return triangles;
}

/// Positions of their vertices: `place(sheet, i, j)`, called in their order.
template <class Place>
std::vector<Vec3> place_two_sheets(std::uint32_t n, const Place& place) {
  std::vector<Vec3> at;
  for (const std::uint32_t sheet : {0u, 1u})
    for (std::uint32_t i = 0; i <= n; ++i)
      for (std::uint32_t j = 0; j <= n; ++j) at.push_back(place(sheet, i, j));
  return at;
}

/// The representatives of vertices that are all apart: 0, 1, …, count − 1.
inline std::vector<std::uint32_t> all_apart(std::size_t count) {
  std::vector<std::uint32_t> representative(count);
  std::iota(representative.begin(), representative.end(), 0u);
  return representative;
}

/// The number of crossings, pair by pair rather than from a tree of all triangles.
inline std::size_t crossings_pair_by_pair(const std::vector<Triangle>& triangles, const std::vector<Vec3>& at,
                                          std::span<const std::uint32_t> representative) {
  const std::vector<std::uint8_t> all(triangles.size(), 1);
  return find_crossings(triangles, at, representative, false, &all).size();
}

}  // namespace geo
