// The base colours and images of a surface's materials, for programs that draw it; attributes of
// several surfaces as one.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "kerf/mesh.h"

namespace geo {

/// How an image goes on beyond its borders.
enum class TextureWrap { repeat, mirror, clamp };

/// The base colour of a material: a factor, and an image that it is multiplied by. Texture
/// coordinates p become `placement` · p + `offset` in the image, whose lower left corner is (0, 0)
/// and whose upper right one is (1, 1).
struct BaseColor {
  static constexpr std::size_t no_image = ~std::size_t(0);

  Color factor = Color::Ones();  ///< linear
  std::size_t image = no_image;  ///< index into BaseColors::images
  std::size_t uv_set = 0;        ///< 0: Attributes::uv, 1: Attributes::uv2
  Eigen::Matrix2d placement = Eigen::Matrix2d::Identity();
  Vec2 offset = Vec2::Zero();
  std::array<TextureWrap, 2> wrap{};  ///< along u and v
};

/// Base colours of groups, with the images that they use.
struct BaseColors {
  std::vector<BaseColor> of_group;
  std::vector<std::string> images;  ///< bytes of PNG or JPEG files, colours in sRGB
  bool complete = true;             ///< false: images of other formats are left out
};

/// The base colour of each of the surface's groups, and of one group "skin" where it has none: that
/// of the library. Where the library has none it is white if corners have colours, which multiply,
/// else grey, darker for cracks. Images in other formats than PNG and JPEG are left out. Throws
/// InputError where the library is damaged.
BaseColors base_colors(const Attributes& attributes);

/// The attributes of several meshes as one whose triangles follow each other. Where a mesh lacks
/// some they are filled: places 0, white, normals of triangles, the group "default". Groups of one
/// name with different materials get a number: "wood", "wood 2". Throws InputError where a library
/// is damaged.
Attributes joined_attributes(std::span<const TriangleMesh> meshes);

}  // namespace geo
