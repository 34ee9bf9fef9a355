// Linear colours become sRGB (IEC 61966-2-1), written by libpng. Labels use a font of 5 × 7 dots.
#include "view/picture.h"

#include <png.h>

#include <algorithm>
#include <cmath>

#include <kerf/error.h>

namespace view {
namespace {

void png_failed(png_structp, png_const_charp message) {
  throw geo::OutputError(std::string("PNG cannot be written: ") + message);
}
void png_warned(png_structp, png_const_charp) {}
void png_put(png_structp png, png_bytep data, png_size_t size) {
  static_cast<std::ostream*>(png_get_io_ptr(png))
      ->write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
}
void png_flush_nothing(png_structp) {}

// Rows of five dots, top to bottom, bit 4 leftmost.
struct Glyph {
  char character;
  std::uint8_t rows[7];
};
constexpr Glyph glyphs[] = {
    {'0', {14, 17, 19, 21, 25, 17, 14}}, {'1', {4, 12, 4, 4, 4, 4, 14}},      {'2', {14, 17, 1, 6, 8, 16, 31}},
    {'3', {14, 17, 1, 6, 1, 17, 14}},    {'4', {2, 6, 10, 18, 31, 2, 2}},     {'5', {31, 16, 30, 1, 1, 17, 14}},
    {'6', {6, 8, 16, 30, 17, 17, 14}},   {'7', {31, 1, 2, 4, 8, 8, 8}},       {'8', {14, 17, 17, 14, 17, 17, 14}},
    {'9', {14, 17, 17, 15, 1, 2, 12}},   {'.', {0, 0, 0, 0, 0, 12, 12}},      {'-', {0, 0, 0, 14, 0, 0, 0}},
    {'a', {0, 0, 14, 1, 15, 17, 15}},    {'b', {16, 16, 22, 25, 17, 17, 30}}, {'c', {0, 0, 14, 16, 16, 17, 14}},
    {'d', {1, 1, 13, 19, 17, 17, 15}},   {'e', {0, 0, 14, 17, 31, 16, 14}},   {'f', {6, 9, 8, 28, 8, 8, 8}},
    {'g', {0, 15, 17, 17, 15, 1, 14}},   {'h', {16, 16, 22, 25, 17, 17, 17}}, {'i', {4, 0, 12, 4, 4, 4, 14}},
    {'j', {2, 0, 6, 2, 2, 18, 12}},      {'k', {16, 16, 18, 20, 24, 20, 18}}, {'l', {12, 4, 4, 4, 4, 4, 14}},
    {'m', {0, 0, 26, 21, 21, 17, 17}},   {'n', {0, 0, 22, 25, 17, 17, 17}},   {'o', {0, 0, 14, 17, 17, 17, 14}},
    {'p', {0, 0, 30, 17, 30, 16, 16}},   {'q', {0, 0, 13, 19, 15, 1, 1}},     {'r', {0, 0, 22, 25, 16, 16, 16}},
    {'s', {0, 0, 14, 16, 14, 1, 30}},    {'t', {8, 8, 28, 8, 8, 9, 6}},       {'u', {0, 0, 17, 17, 17, 19, 13}},
    {'v', {0, 0, 17, 17, 17, 10, 4}},    {'w', {0, 0, 17, 17, 21, 21, 10}},   {'x', {0, 0, 17, 10, 4, 10, 17}},
    {'y', {0, 0, 17, 17, 15, 1, 14}},    {'z', {0, 0, 31, 2, 4, 8, 31}},      {':', {0, 12, 12, 0, 12, 12, 0}},
    {'_', {0, 0, 0, 0, 0, 0, 31}},       {'/', {0, 1, 2, 4, 8, 16, 0}},       {'%', {24, 25, 2, 4, 8, 19, 3}}};

}  // namespace

std::uint8_t srgb_byte(float linear) {
  const float c = std::clamp(linear, 0.0f, 1.0f);
  const float s = c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1 / 2.4f) - 0.055f;
  return static_cast<std::uint8_t>(std::lround(255 * s));
}

std::vector<std::uint8_t> rgb_bytes(const Picture& picture) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(3 * picture.pixels.size());
  for (const Color& pixel : picture.pixels)
    for (const float channel : pixel) bytes.push_back(srgb_byte(channel));
  return bytes;
}

void write_png(std::ostream& out, const Picture& picture) {
  write_png(out, rgb_bytes(picture).data(), picture.width, picture.height);
}

void write_png(std::ostream& out, const std::uint8_t* rgb, int width, int height) {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, png_failed, png_warned);
  if (!png) throw geo::OutputError("PNG cannot be written: out of memory");
  png_infop info = png_create_info_struct(png);
  try {
    if (!info) throw geo::OutputError("PNG cannot be written: out of memory");
    png_set_write_fn(png, &out, png_put, png_flush_nothing);
    png_set_IHDR(png, info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), 8, PNG_COLOR_TYPE_RGB,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
    png_write_info(png, info);
    for (int y = 0; y < height; ++y)
      png_write_row(png, rgb + static_cast<std::size_t>(y) * static_cast<std::size_t>(width) * 3);
    png_write_end(png, info);
  } catch (...) {
    png_destroy_write_struct(&png, &info);
    throw;
  }
  png_destroy_write_struct(&png, &info);
}

Picture contact_sheet(const std::vector<Picture>& pictures, const std::vector<std::string>& labels, int columns) {
  if (pictures.empty()) return {};
  constexpr int margin = 4;
  const int n = static_cast<int>(pictures.size()), w = pictures[0].width, h = pictures[0].height;
  columns = std::clamp(columns, 1, n);
  const int rows = (n + columns - 1) / columns;
  Picture sheet(columns * (w + margin) + margin, rows * (h + margin) + margin, {1, 1, 1});
  for (int i = 0; i < n; ++i) {
    const int x0 = margin + i % columns * (w + margin), y0 = margin + i / columns * (h + margin);
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) sheet.at(x0 + x, y0 + y) = pictures[i].at(x, y);
    const int scale = std::max(1, h / 200);
    if (i < static_cast<int>(labels.size()))
      draw_text(sheet, x0 + 4 * scale, y0 + h - 11 * scale, labels[i], scale, {0.12f, 0.13f, 0.16f});
  }
  return sheet;
}

void draw_text(Picture& picture, int x, int y, const std::string& text, int scale, Color color) {
  for (std::size_t i = 0; i < text.size(); ++i)
    for (const Glyph& glyph : glyphs)
      if (glyph.character == text[i])
        for (int dot = 0; dot < 35 * scale * scale; ++dot) {
          const int dx = dot % (5 * scale), dy = dot / (5 * scale);
          if (!(glyph.rows[dy / scale] >> (4 - dx / scale) & 1)) continue;
          const int px = x + static_cast<int>(i) * 6 * scale + dx, py = y + dy;
          if (px >= 0 && py >= 0 && px < picture.width && py < picture.height) picture.at(px, py) = color;
        }
}

}  // namespace view
