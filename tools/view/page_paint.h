// The colours of a model for a page: images as data URLs, and arrays of numbers for its triangles.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "view/paint.h"

namespace view {

/// Numbers in 65536 steps: lo + step * k.
struct Quantised {
  std::vector<std::uint32_t> steps;
  double lo = 0, step = 0;
};

/// The paint of a surface. Numbers of materials are those of PagePaint::about(), ~0u: none.
struct PaintArrays {
  std::vector<std::uint32_t> material;  ///< per triangle
  Quantised u, v;                       ///< per corner: the place in the image
  std::vector<std::uint32_t> tint;      ///< per corner: red, green, blue, sRGB, 0 to 255
};

/// Collects materials and images of all surfaces of a page.
class PagePaint {
 public:
  /// \param max_bytes  of all images together; larger ones are halved until they fit
  explicit PagePaint(std::size_t max_bytes) : max_bytes_(max_bytes) {}

  /// The paint of a surface. Throws geo::InputError for a texture that cannot be read.
  PaintArrays of(const geo::TriangleMesh& mesh);

  /// Images as data URLs, and for each material its image (-1: none) and how it goes on beyond its
  /// borders: 0 repeats, 1 mirrors, 2 clamps. Throws geo::OutputError where an image cannot be
  /// written.
  nlohmann::ordered_json about() const;

  /// Whether no image was left out.
  bool complete() const { return complete_; }

 private:
  struct Material {
    std::int64_t image = -1;
    std::array<geo::TextureWrap, 2> wrap{};
    friend bool operator==(const Material&, const Material&) = default;
  };
  std::uint32_t number_of(const Material& material);

  std::size_t max_bytes_;
  bool complete_ = true;
  PaintImages images_;
  std::vector<std::shared_ptr<const PaintImage>> used_;
  std::vector<Material> materials_;
};

}  // namespace view
