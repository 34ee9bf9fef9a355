// Values as USD text: numbers in the shortest form that is read back exactly.
#pragma once

#include <iterator>
#include <string>

#include "base/number_text.h"
#include "kerf/mesh.h"

namespace geo::usd {

/// Appends a number.
inline void add_number(std::string& text, auto x) {
  char digits[32];
  text.append(digits, write_number(digits, x));
}

/// Appends a list; item(i) appends its i-th element.
void add_list(std::string& text, std::size_t count, const auto& item) {
  text += '[';
  for (std::size_t i = 0; i < count; ++i) {
    if (i > 0) text += ", ";
    item(i);
  }
  text += ']';
}

/// Appends an attribute with a translation in double precision, each line after `margin`.
inline void add_translation(std::string& text, const std::string& margin, const Vec3& by) {
  text += margin + "double3 xformOp:translate = (";
  for (int i = 0; i < 3; ++i) {
    if (i > 0) text += ", ";
    add_number(text, by[i]);
  }
  text += ")\n" + margin + "uniform token[] xformOpOrder = [\"xformOp:translate\"]\n";
}

/// Appends a vector in single precision.
template <class Row>
void add_tuple(std::string& text, const Row& row) {
  char chars[32 * Row::SizeAtCompileTime], *at = chars;
  for (int k = 0; k < row.size(); ++k) {
    *at++ = k > 0 ? ',' : '(';
    if (k > 0) *at++ = ' ';
    at = write_number(at, float(row[k]));
  }
  *at++ = ')';
  text.append(chars, at);
}

/// A number in single precision.
inline std::string usd_number(double x) {
  std::string text;
  add_number(text, float(x));
  return text;
}

/// A vector in single precision.
template <class Row>
std::string usd_tuple(const Row& row) {
  std::string text;
  add_tuple(text, row);
  return text;
}

/// The vertices of a mesh, less `offset`.
inline std::string points_of(const TriangleMesh& m, const Vec3& offset = Vec3::Zero()) {
  constexpr std::size_t usual = 40;  // characters
  std::string text;
  text.reserve(usual * m.vertices.size());
  add_list(text, m.vertices.size(), [&](std::size_t v) { add_tuple(text, Vec3(m.vertices[v] - offset)); });
  return text;
}

/// The number of corners of each triangle.
inline std::string counts_of(const TriangleMesh& m) {
  std::string text;
  add_list(text, m.triangles.size(), [&](std::size_t) { text += '3'; });
  return text;
}

/// The vertices of all triangles, by index.
inline std::string corners_of_triangles(const TriangleMesh& m) {
  std::string text;
  add_list(text, 3 * m.triangles.size(), [&](std::size_t i) { add_number(text, m.triangles[i / 3][i % 3]); });
  return text;
}

/// The patch of a triangle; 0 without patches.
inline std::int32_t patch_of(const TriangleMesh& m, std::size_t t) { return m.patch.empty() ? 0 : m.patch[t]; }

/// The patches of all triangles.
inline std::string patches_of(const TriangleMesh& m) {
  std::string text;
  add_list(text, m.triangles.size(), [&](std::size_t t) { add_number(text, patch_of(m, t)); });
  return text;
}

/// Texture coordinates of all corners.
inline std::string uv_of(const std::vector<std::array<Vec2, 3>>& uv) {
  std::string text;
  add_list(text, 3 * uv.size(), [&](std::size_t i) { add_tuple(text, uv[i / 3][i % 3]); });
  return text;
}

}  // namespace geo::usd
