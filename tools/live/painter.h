// The colours of a model on a page: a place in an image and a tint for each corner of its
// triangles, through all cuts.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <kerf/appearance.h>
#include <kerf/complex.h>
#include <kerf/mesh.h>

namespace live {

/// The paint of a triangle, corners in the order of its slot.
struct TrianglePaint {
  static constexpr std::uint16_t none = 0xffff;
  std::array<Eigen::Vector2f, 3> at{Eigen::Vector2f::Zero(), Eigen::Vector2f::Zero(),
                                    Eigen::Vector2f::Zero()};  ///< the place in the image, (0, 0) its lower left corner
  std::array<std::uint32_t, 3> tint{};                         ///< sRGB: red + 256 green + 65536 blue, 0 to 255 each
  std::uint16_t material = none;                               ///< index into the materials of look(); none: a wall
};

class Painter {
 public:
  /// No colours.
  Painter() = default;
  /// The colours of a model, the surface that a run begins with.
  /// \param library  materials of the model's groups
  /// \throws geo::InputError where the library is damaged
  Painter(geo::TriangleMesh model, geo::MaterialLibrary library);

  /// Whether the model has no colours.
  bool empty() const { return model_ == nullptr; }
  /// Whether no image was left out.
  bool complete() const { return colors_.complete; }
  /// The paint of sides, in their order.
  std::vector<TrianglePaint> paint(const geo::Complex& surface, std::span<const geo::Side> sides) const;
  /// The content of the message LOOK: materials and images (docs/live-protocol.md). Null where the
  /// model has no colours.
  std::shared_ptr<const std::string> look() const;

 private:
  TrianglePaint of_triangle(const geo::Attributes& attributes, std::size_t triangle) const;

  std::shared_ptr<const geo::TriangleMesh> model_;
  geo::BaseColors colors_;
};

}  // namespace live
