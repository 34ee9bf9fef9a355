// Images stay as their files have them while they fit. Halved ones are written as WebP.
#include "view/page_paint.h"

#include <webp/encode.h>

#include <algorithm>
#include <cmath>

#include <kerf/error.h>
#include "view/pack.h"

namespace view {
namespace {

using json = nlohmann::ordered_json;

Quantised quantised(const std::vector<double>& values) {
  Quantised result;
  if (values.empty()) return result;
  const auto [lo, hi] = std::minmax_element(values.begin(), values.end());
  result.lo = *lo;
  result.step = (*hi - *lo) / 65535;
  for (const double x : values)
    result.steps.push_back(result.step > 0 ? static_cast<std::uint32_t>(std::lround((x - result.lo) / result.step))
                                           : 0);
  return result;
}

// An image as the page has it.
struct Embedded {
  std::string type;
  std::string bytes;
  Texture pixels;
};

Embedded embedded(const PaintImage& image) {
  return {image.file.starts_with("\x89PNG") ? "image/png" : "image/jpeg", image.file, image.pixels};
}

void halve(Embedded& image) {
  constexpr float quality = 85;  // of 100: differences are hard to see
  image.pixels = halved(image.pixels);
  std::uint8_t* out = nullptr;
  const std::size_t size = WebPEncodeRGB(image.pixels.rgb.data(), image.pixels.width, image.pixels.height,
                                         3 * image.pixels.width, quality, &out);
  if (size == 0) throw geo::OutputError("an image of the page cannot be written as WebP");
  image.type = "image/webp";
  image.bytes.assign(reinterpret_cast<const char*>(out), size);
  WebPFree(out);
}

}  // namespace

std::uint32_t PagePaint::number_of(const Material& material) {
  const auto at = std::find(materials_.begin(), materials_.end(), material) - materials_.begin();
  if (at == std::ssize(materials_)) materials_.push_back(material);
  return static_cast<std::uint32_t>(at);
}

PaintArrays PagePaint::of(const geo::TriangleMesh& mesh) {
  const Paint paint = paint_of(mesh, images_);
  complete_ = complete_ && paint.complete;
  std::vector<std::uint32_t> number;  // of the page, per material of the surface
  for (const PaintMaterial& own : paint.materials) {
    Material material;
    if (own.texture != PaintMaterial::no_texture) {
      const auto at = std::find(used_.begin(), used_.end(), paint.textures[own.texture]) - used_.begin();
      if (at == std::ssize(used_)) used_.push_back(paint.textures[own.texture]);
      material = {.image = at, .wrap = own.wrap};
    }
    number.push_back(number_of(material));
  }
  PaintArrays result;
  std::vector<double> u, v;
  for (std::size_t t = 0; t < paint.material.size(); ++t) {
    result.material.push_back(paint.has(t) ? number[paint.material[t]] : Paint::none);
    for (std::size_t k = 0; k < 3; ++k) {
      const bool finite = paint.at[t][k].allFinite();
      u.push_back(finite ? paint.at[t][k].x() : 0);
      v.push_back(finite ? paint.at[t][k].y() : 0);
      for (const float channel : paint.tint[t][k]) result.tint.push_back(srgb_byte(channel));
    }
  }
  result.u = quantised(u);
  result.v = quantised(v);
  return result;
}

json PagePaint::about() const {
  std::vector<Embedded> images;
  std::size_t total = 0;
  for (const auto& image : used_) {
    images.push_back(embedded(*image));
    total += images.back().bytes.size();
  }
  while (total > max_bytes_) {
    const auto largest = std::max_element(images.begin(), images.end(), [](const Embedded& a, const Embedded& b) {
      return a.bytes.size() < b.bytes.size();
    });
    if (largest->pixels.width <= 1 && largest->pixels.height <= 1) break;
    total -= largest->bytes.size();
    halve(*largest);
    total += largest->bytes.size();
  }
  json result = {{"images", json::array()}, {"materials", json::array()}};
  for (const Embedded& image : images)
    result["images"].push_back("data:" + image.type + ";base64," + base64(image.bytes));
  for (const Material& material : materials_)
    result["materials"].push_back({{"image", material.image},
                                   {"wrap", {static_cast<int>(material.wrap[0]), static_cast<int>(material.wrap[1])}}});
  return result;
}

}  // namespace view
