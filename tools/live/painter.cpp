// Attributes follow the triangles of a cut surface by transfer_attributes(), for new ones only.
#include "live/painter.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

namespace live {
namespace {

using Json = nlohmann::ordered_json;

// IEC 61966-2-1.
double linear_of(double srgb) { return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4); }
std::uint32_t srgb_byte(double linear) {
  const double x = std::clamp(linear, 0.0, 1.0);
  const double srgb = x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
  return static_cast<std::uint32_t>(std::lround(255 * srgb));
}

// The coordinates that a material uses, or null.
const std::vector<std::array<geo::Vec2, 3>>* places(const geo::Attributes& a, const geo::BaseColor& color) {
  if (color.image == geo::BaseColor::no_image || color.uv_set > 1) return nullptr;
  const auto& uv = color.uv_set == 0 ? a.uv : a.uv2;
  return uv.empty() ? nullptr : &uv;
}

std::string type_of(const std::string& image) { return image.starts_with("\x89PNG") ? "image/png" : "image/jpeg"; }

}  // namespace

Painter::Painter(geo::TriangleMesh model, geo::MaterialLibrary library) {
  if (!library.glb && model.attributes.color.empty()) return;
  model.attributes.library = std::move(library);
  model.attributes.normal.clear();
  colors_ = geo::base_colors(model.attributes);
  model.attributes.library = {};
  model_ = std::make_shared<const geo::TriangleMesh>(std::move(model));
}

TrianglePaint Painter::of_triangle(const geo::Attributes& a, std::size_t triangle) const {
  TrianglePaint paint;
  const std::size_t group = a.group.empty() ? 0 : static_cast<std::size_t>(a.group[triangle]);
  if (group >= colors_.of_group.size() || group >= TrianglePaint::none) return paint;
  const geo::BaseColor& color = colors_.of_group[group];
  const auto* uv = places(a, color);
  paint.material = static_cast<std::uint16_t>(group);
  for (std::size_t k = 0; k < 3; ++k) {
    if (uv) {
      const Eigen::Vector2f at = (color.placement * (*uv)[triangle][k] + color.offset).cast<float>();
      if (at.allFinite()) paint.at[k] = at;
    }
    for (Eigen::Index c = 0; c < 3; ++c) {
      const double own = a.color.empty() ? 1 : linear_of(a.color[triangle][k][c]);
      paint.tint[k] |= srgb_byte(color.factor[c] * own) << (8 * c);
    }
  }
  return paint;
}

std::vector<TrianglePaint> Painter::paint(const geo::Complex& surface, std::span<const geo::Side> sides) const {
  std::vector<TrianglePaint> result(sides.size());
  if (empty()) return result;
  geo::TriangleMesh skin;
  std::vector<std::size_t> row;  // of the result, per triangle of the skin
  for (std::size_t i = 0; i < sides.size(); ++i) {
    const geo::Complex::Face& face = surface.face(sides[i].face);
    if (face.crack != 0 || face.source == ~0u) continue;
    const auto first = static_cast<std::uint32_t>(skin.vertices.size());
    for (const geo::Vec3& p : surface.corners(sides[i].face)) skin.vertices.push_back(p);
    skin.triangles.push_back({first, first + 1, first + 2});
    skin.source.push_back(face.source);
    row.push_back(i);
  }
  geo::transfer_attributes(*model_, skin);
  for (std::size_t t = 0; t < row.size(); ++t) result[row[t]] = of_triangle(skin.attributes, t);
  return result;
}

std::shared_ptr<const std::string> Painter::look() const {
  if (empty()) return nullptr;
  Json about{{"materials", Json::array()}, {"images", Json::array()}};
  for (const geo::BaseColor& color : colors_.of_group) {
    const bool has_image = places(model_->attributes, color) != nullptr;
    about["materials"].push_back({{"image", has_image ? static_cast<std::int64_t>(color.image) : -1},
                                  {"wrap", {static_cast<int>(color.wrap[0]), static_cast<int>(color.wrap[1])}}});
  }
  for (const std::string& image : colors_.images)
    about["images"].push_back({{"type", type_of(image)}, {"bytes", image.size()}});
  std::string text = about.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const auto size = static_cast<std::uint32_t>(text.size());
  std::string result(reinterpret_cast<const char*>(&size), sizeof size);
  result += text;
  for (const std::string& image : colors_.images) result += image;
  return std::make_shared<const std::string>(std::move(result));
}

}  // namespace live
