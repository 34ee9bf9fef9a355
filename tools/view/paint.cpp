// Groups name the materials. Colours of corners are sRGB, as files have them, and multiply.
#include "view/paint.h"

#include <kerf/appearance.h>
#include <kerf/error.h>

namespace view {
namespace {

// The materials of all groups, with the images that they use.
struct Painter {
  geo::BaseColors colors;
  std::vector<bool> placed;  // per group: whether the surface has the texture coordinates of its image
};

Painter painter_of(const geo::Attributes& attributes) {
  Painter result;
  result.colors = geo::base_colors(attributes);
  for (const geo::BaseColor& color : result.colors.of_group)
    result.placed.push_back(color.image != geo::BaseColor::no_image &&
                            !(color.uv_set == 0 ? attributes.uv : attributes.uv2).empty() && color.uv_set < 2);
  return result;
}

// An image as its file has it and decoded; null where that fails.
std::shared_ptr<const PaintImage> decoded(const std::string& file) {
  try {
    return std::make_shared<const PaintImage>(PaintImage{file, decode_texture(file, "materials of the surface")});
  } catch (const geo::InputError&) {
    return nullptr;
  }
}

}  // namespace

bool has_paint(const geo::TriangleMesh& mesh) {
  return mesh.attributes.library.glb != nullptr || !mesh.attributes.color.empty();
}

Paint paint_of(const geo::TriangleMesh& mesh) {
  PaintImages none;
  return paint_of(mesh, none);
}

Paint paint_of(const geo::TriangleMesh& mesh, PaintImages& known) {
  Paint paint;
  if (!has_paint(mesh)) return paint;
  const geo::Attributes& a = mesh.attributes;
  const Painter painter = painter_of(a);
  paint.complete = painter.colors.complete;
  for (const std::string& file : painter.colors.images) {
    const auto [at, fresh] = known.try_emplace(file);
    if (fresh) at->second = decoded(file);
    paint.textures.push_back(at->second);
    paint.complete = paint.complete && at->second;
  }
  for (std::size_t g = 0; g < painter.placed.size(); ++g) {
    const geo::BaseColor& color = painter.colors.of_group[g];
    const bool has_place = painter.placed[g];
    paint.materials.push_back(
        {.texture = has_place && paint.textures[color.image] ? color.image : PaintMaterial::no_texture,
         .wrap = color.wrap});
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::size_t group = a.group.empty() ? 0 : static_cast<std::size_t>(a.group[t]);
    paint.material.push_back(group < painter.placed.size() ? static_cast<std::uint32_t>(group) : Paint::none);
    paint.at.push_back({Eigen::Vector2f::Zero(), Eigen::Vector2f::Zero(), Eigen::Vector2f::Zero()});
    paint.tint.emplace_back();
    if (!paint.has(t)) continue;
    const geo::BaseColor& color = painter.colors.of_group[group];
    for (std::size_t k = 0; k < 3; ++k) {
      if (painter.placed[group]) {
        const geo::Vec2& uv = color.uv_set == 0 ? a.uv[t][k] : a.uv2[t][k];
        paint.at[t][k] = (color.placement * uv + color.offset).cast<float>();
      }
      for (std::size_t c = 0; c < 3; ++c) {
        const auto channel = static_cast<Eigen::Index>(c);
        paint.tint[t][k][c] = float(color.factor[channel]);
        if (!a.color.empty()) paint.tint[t][k][c] *= linear_of(float(a.color[t][k][channel]));
      }
    }
  }
  return paint;
}

Color Paint::color(std::size_t triangle, float u, float v) const {
  const float w = 1 - u - v;
  const auto& [a, b, c] = tint[triangle];
  Color result{};
  for (std::size_t k = 0; k < 3; ++k) result[k] = w * a[k] + u * b[k] + v * c[k];
  const PaintMaterial& own = materials[material[triangle]];
  if (own.texture == PaintMaterial::no_texture) return result;
  const Eigen::Vector2f place = w * at[triangle][0] + u * at[triangle][1] + v * at[triangle][2];
  const Color texel = color_at(textures[own.texture]->pixels, place.cast<double>(), own.wrap);
  for (std::size_t k = 0; k < 3; ++k) result[k] *= texel[k];
  return result;
}

void Paint::add(const Paint& other, std::size_t first) {
  if (other.material.empty()) return;
  complete = complete && other.complete;
  const auto first_material = static_cast<std::uint32_t>(materials.size());
  for (PaintMaterial own : other.materials) {
    if (own.texture != PaintMaterial::no_texture) own.texture += textures.size();
    materials.push_back(own);
  }
  textures.insert(textures.end(), other.textures.begin(), other.textures.end());
  material.resize(first, none);
  at.resize(first);
  tint.resize(first);
  for (const std::uint32_t m : other.material) material.push_back(m == none ? none : first_material + m);
  at.insert(at.end(), other.at.begin(), other.at.end());
  tint.insert(tint.end(), other.tint.begin(), other.tint.end());
}

}  // namespace view
