// Images of textures: decoded, read at a place, and made smaller.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <kerf/appearance.h>
#include "view/picture.h"

namespace view {

/// An image of 8-bit sRGB, three bytes a pixel, row by row from the top.
struct Texture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};

/// Decodes a PNG or JPEG file; alpha is left out. `name` stands for the file in messages. Throws
/// geo::InputError: damaged, another format, or more than 2^28 pixels.
Texture decode_texture(const std::string& bytes, const std::string& name);

/// The colour at a place of the image, linear light, interpolated between the four nearest pixels.
/// (0, 0) is the lower left corner, (1, 1) the upper right one.
Color color_at(const Texture& texture, const geo::Vec2& at, const std::array<geo::TextureWrap, 2>& wrap);

/// The image with half as many pixels along each side, rounded up; each is the mean of up to four.
Texture halved(const Texture& texture);

/// sRGB, 0 to 1, as linear light.
float linear_of(float srgb);

}  // namespace view
