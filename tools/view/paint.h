// The colours of a model: base colours and textures of its materials, and colours of its corners.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include <kerf/mesh.h>
#include "view/texture.h"

namespace view {

/// How one material is painted.
struct PaintMaterial {
  static constexpr std::size_t no_texture = ~std::size_t(0);
  std::size_t texture = no_texture;  ///< index into Paint::textures
  std::array<geo::TextureWrap, 2> wrap{};
};

/// An image of a texture, as its file has it and decoded.
struct PaintImage {
  std::string file;
  Texture pixels;
};
/// Images by the bytes of their files: those of other frames are not decoded again. Null: one that
/// cannot be decoded.
using PaintImages = std::map<std::string, std::shared_ptr<const PaintImage>>;

/// The line that a picture or page says where Paint::complete is false.
inline constexpr const char* images_left_out =
    "left out: images of materials that are no PNG or JPEG, or that cannot be decoded";

/// Colours of triangles, or nothing where arrays are empty.
struct Paint {
  static constexpr std::uint32_t none = ~0u;
  std::vector<std::shared_ptr<const PaintImage>> textures;
  std::vector<PaintMaterial> materials;
  std::vector<std::uint32_t> material;             ///< per triangle; `none`: it is not painted
  std::vector<std::array<Eigen::Vector2f, 3>> at;  ///< per corner: the place in the image
  std::vector<std::array<Color, 3>> tint;          ///< per corner: a factor, linear
  bool complete = true;                            ///< false: images_left_out

  /// Whether a triangle is painted.
  bool has(std::size_t triangle) const { return triangle < material.size() && material[triangle] != none; }
  /// The colour at barycentric coordinates u, v of a triangle's second and third corner.
  Color color(std::size_t triangle, float u, float v) const;
  /// Adds the paint of triangles that stand in a stage from `first` on. Those before it without a
  /// paint stay so.
  void add(const Paint& other, std::size_t first);
};

/// Whether materials or corners give this surface colours.
bool has_paint(const geo::TriangleMesh& mesh);

/// The paint of a surface; empty where has_paint() is false. Images are taken from `known`, and
/// added to it.
Paint paint_of(const geo::TriangleMesh& mesh, PaintImages& known);
/// The same for a single surface.
Paint paint_of(const geo::TriangleMesh& mesh);

}  // namespace view
