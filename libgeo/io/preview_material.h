// Materials as formats other than glTF hold them: factors and textures of a surface, taken from the
// library of a mesh.
#pragma once

#include <array>
#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "kerf/mesh.h"

namespace geo {

/// A use of an image. Texture coordinates are multiplied by `scale`, turned counterclockwise and
/// moved by `offset`, with v upwards.
struct TextureUse {
  std::size_t image = none;  ///< index into PreviewMaterials::images
  std::size_t uv_set = 0;    ///< which set of texture coordinates places it
  Vec2 scale = Vec2::Ones();
  double turn = 0;  ///< radians
  Vec2 offset = Vec2::Zero();
  std::array<int, 2> wrap{10497, 10497};  ///< along u and v, as glTF numbers it: 10497 repeats, 33071 clamps
  double strength = 1;                    ///< of a normal or occlusion texture

  static constexpr std::size_t none = ~std::size_t(0);
  /// Whether there is an image.
  explicit operator bool() const { return image != none; }
  /// Whether texture coordinates change before the image is read.
  bool moved() const { return scale != Vec2::Ones() || turn != 0 || !offset.isZero(0); }
};

/// A material of metal and roughness. Colours are linear. A texture is multiplied by its factor.
struct PreviewMaterial {
  enum class Alpha { opaque, mask, blend };

  std::string name;
  Color base = Color(0.8, 0.8, 0.8, 1);
  double metallic = 0;
  double roughness = 0.9;
  Vec3 emissive = Vec3::Zero();
  double clearcoat = 0;
  double clearcoat_roughness = 0;
  double ior = 1.5;
  Alpha alpha = Alpha::opaque;
  double cutoff = 0.5;  ///< of Alpha::mask
  bool double_sided = false;
  TextureUse base_texture;
  TextureUse surface_texture;  ///< roughness in green, metal in blue
  TextureUse normal_texture;
  TextureUse occlusion_texture;  ///< in red
  TextureUse emissive_texture;
};

/// An image with a name that is none of a file's: "brick".
struct PreviewImage {
  std::string name;
  std::string ending;  ///< ".png"
  std::string bytes;
};

/// The entry of PreviewMaterials::lost for images that are neither PNG nor JPEG.
inline constexpr const char* lost_images = "textures in other formats than PNG and JPEG";

/// The materials of a library.
struct PreviewMaterials {
  std::vector<PreviewMaterial> materials;
  std::vector<PreviewImage> images;
  std::set<std::string> lost;  ///< what a library says beyond these members: "KHR_materials_sheen"
};

/// The materials of a library; none without one. Images in formats other than PNG and JPEG are
/// lost. Throws InputError where the library is damaged.
PreviewMaterials preview_materials(const MaterialLibrary& library);

/// A material for groups that no library describes: grey, and darker on cracks.
PreviewMaterial plain_material(const std::string& group);

/// The names of the files that hold the images, in order: `prefix`, the image's name, its ending.
std::vector<std::string> image_file_names(const PreviewMaterials& materials, const std::string& prefix);

}  // namespace geo
