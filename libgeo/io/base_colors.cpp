// base_colors() of kerf/appearance.h, from the materials that previews have.
#include <Eigen/Geometry>
#include <map>

#include "io/preview_material.h"
#include "kerf/appearance.h"

namespace geo {
namespace {

// Numbers of glTF; anything else repeats, as the specification wants it.
TextureWrap wrap_of(int number) {
  constexpr int clamps = 33071, mirrors = 33648;
  if (number == clamps) return TextureWrap::clamp;
  return number == mirrors ? TextureWrap::mirror : TextureWrap::repeat;
}

BaseColor base_of(const PreviewMaterial& material) {
  BaseColor result;
  result.factor = material.base;
  const TextureUse& use = material.base_texture;
  if (!use) return result;
  result.image = use.image;
  result.uv_set = use.uv_set;
  result.placement = Eigen::Rotation2Dd(use.turn).toRotationMatrix() * use.scale.asDiagonal();
  result.offset = use.offset;
  result.wrap = {wrap_of(use.wrap[0]), wrap_of(use.wrap[1])};
  return result;
}

}  // namespace

BaseColors base_colors(const Attributes& attributes) {
  const PreviewMaterials found = preview_materials(attributes.library);
  std::vector<std::string> groups = attributes.group_names;
  if (attributes.group.empty() || groups.empty()) groups = {"skin"};
  std::map<std::string, const PreviewMaterial*> by_name;
  for (const PreviewMaterial& material : found.materials) by_name.try_emplace(material.name, &material);
  BaseColors result;
  result.complete = !found.lost.contains(lost_images);
  std::map<std::size_t, std::size_t> taken;  // images of the library, with their places in the result
  for (const std::string& group : groups) {
    const auto own = by_name.find(group);
    BaseColor color;  // white
    if (own != by_name.end()) color = base_of(*own->second);
    if (own == by_name.end() && attributes.color.empty()) color = base_of(plain_material(group));
    if (color.image != BaseColor::no_image) {
      const auto [at, fresh] = taken.try_emplace(color.image, result.images.size());
      if (fresh) result.images.push_back(found.images[color.image].bytes);
      color.image = at->second;
    }
    result.of_group.push_back(color);
  }
  return result;
}

}  // namespace geo
