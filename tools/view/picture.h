// Pictures: rows of RGB pixels, written as PNG; several of them on one sheet.
#pragma once

#include <array>
#include <cstdint>
#include <ostream>
#include <string>
#include <vector>

namespace view {

using Color = std::array<float, 3>;  ///< linear light, 0 to 1

struct Picture {
  int width = 0, height = 0;
  std::vector<Color> pixels;  ///< row by row from the top

  Picture() = default;
  Picture(int w, int h, Color c = {1, 1, 1}) : width(w), height(h), pixels(static_cast<std::size_t>(w) * h, c) {}
  Color& at(int x, int y) { return pixels[static_cast<std::size_t>(y) * width + x]; }
  const Color& at(int x, int y) const { return pixels[static_cast<std::size_t>(y) * width + x]; }
};

/// Linear light, 0 to 1, as 8-bit sRGB.
std::uint8_t srgb_byte(float linear);

/// 8-bit sRGB, three bytes a pixel, row by row from the top.
std::vector<std::uint8_t> rgb_bytes(const Picture& picture);

/// 8-bit sRGB PNG. Throws geo::OutputError.
void write_png(std::ostream& out, const Picture& picture);
/// The same from three bytes a pixel, row by row from the top, as rgb_bytes() gives them.
void write_png(std::ostream& out, const std::uint8_t* rgb, int width, int height);

/// Pictures of one size in rows of `columns`, with thin margins, each labelled at the lower left.
Picture contact_sheet(const std::vector<Picture>& pictures, const std::vector<std::string>& labels, int columns);

/// Draws text (digits, letters, a few signs; 5 × 7 dots, enlarged `scale` times) from the upper
/// left corner x, y.
void draw_text(Picture& picture, int x, int y, const std::string& text, int scale, Color color);

}  // namespace view
