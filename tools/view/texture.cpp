// libpng and libjpeg decode to 8 bits a channel. Colours are interpolated as linear light.
#include "view/texture.h"

#include <cstdio>

#include <jpeglib.h>
#include <png.h>

#include <algorithm>
#include <cmath>

#include <kerf/error.h>

namespace view {
namespace {

constexpr std::size_t max_pixels = std::size_t(1) << 28;  // an image of 16384 x 16384

[[noreturn]] void refuse(const std::string& name, const std::string& what) {
  throw geo::InputError(name + ": a texture cannot be read: " + what + "; save the image again as PNG or JPEG");
}

void require_size(std::size_t width, std::size_t height, const std::string& name) {
  if (width == 0 || height == 0 || width > max_pixels / height)
    refuse(name, "it has " + std::to_string(width) + " x " + std::to_string(height) + " pixels");
}

Texture decode_png(const std::string& bytes, const std::string& name) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_memory(&image, bytes.data(), bytes.size())) refuse(name, image.message);
  try {
    require_size(image.width, image.height, name);
  } catch (...) {
    png_image_free(&image);
    throw;
  }
  // Four channels: libpng would blend alpha with a background in three.
  image.format = PNG_FORMAT_RGBA;
  std::vector<std::uint8_t> rgba(PNG_IMAGE_SIZE(image));
  if (!png_image_finish_read(&image, nullptr, rgba.data(), 0, nullptr)) refuse(name, image.message);
  Texture result{.width = static_cast<int>(image.width), .height = static_cast<int>(image.height), .rgb = {}};
  result.rgb.reserve(rgba.size() / 4 * 3);
  for (std::size_t i = 0; i < rgba.size(); i += 4)
    result.rgb.insert(result.rgb.end(), rgba.begin() + std::ptrdiff_t(i), rgba.begin() + std::ptrdiff_t(i) + 3);
  return result;
}

struct JpegFailure {
  std::string what;
};

void jpeg_failed(j_common_ptr jpeg) {
  char message[JMSG_LENGTH_MAX];
  jpeg->err->format_message(jpeg, message);
  throw JpegFailure{message};
}
void jpeg_warned(j_common_ptr) {}

Texture decode_jpeg(const std::string& bytes, const std::string& name) {
  jpeg_decompress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg.err = jpeg_std_error(&errors);
  errors.error_exit = jpeg_failed;
  errors.output_message = jpeg_warned;
  Texture result;
  try {
    jpeg_create_decompress(&jpeg);
    jpeg_mem_src(&jpeg, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
    jpeg_read_header(&jpeg, TRUE);
    require_size(jpeg.image_width, jpeg.image_height, name);
    jpeg.out_color_space = JCS_RGB;
    jpeg_start_decompress(&jpeg);
    const std::size_t row = std::size_t(3) * jpeg.output_width;
    result.width = static_cast<int>(jpeg.output_width);
    result.height = static_cast<int>(jpeg.output_height);
    result.rgb.resize(row * jpeg.output_height);
    while (jpeg.output_scanline < jpeg.output_height) {
      JSAMPROW to = result.rgb.data() + row * jpeg.output_scanline;
      jpeg_read_scanlines(&jpeg, &to, 1);
    }
    jpeg_finish_decompress(&jpeg);
  } catch (const JpegFailure& failure) {
    jpeg_destroy_decompress(&jpeg);
    refuse(name, failure.what);
  } catch (...) {
    jpeg_destroy_decompress(&jpeg);
    throw;
  }
  jpeg_destroy_decompress(&jpeg);
  return result;
}

// The index of a pixel that may be beyond the borders.
int wrapped(double index, int count, geo::TextureWrap wrap) {
  if (wrap == geo::TextureWrap::clamp) return static_cast<int>(std::clamp(index, 0.0, count - 1.0));
  const double period = wrap == geo::TextureWrap::mirror ? 2.0 * count : count;
  const double within = index - period * std::floor(index / period);  // 0 to the period, which rounding may give
  const int i = std::min(static_cast<int>(within), static_cast<int>(period) - 1);
  return i < count ? i : 2 * count - 1 - i;
}

}  // namespace

float linear_of(float srgb) { return srgb <= 0.04045f ? srgb / 12.92f : std::pow((srgb + 0.055f) / 1.055f, 2.4f); }

Texture decode_texture(const std::string& bytes, const std::string& name) {
  if (bytes.starts_with("\x89PNG")) return decode_png(bytes, name);
  if (bytes.starts_with("\xff\xd8")) return decode_jpeg(bytes, name);
  refuse(name, "it is neither PNG nor JPEG");
}

Color color_at(const Texture& texture, const geo::Vec2& at, const std::array<geo::TextureWrap, 2>& wrap) {
  static const std::vector<float> linear = [] {
    std::vector<float> table(256);
    for (int i = 0; i < 256; ++i) table[static_cast<std::size_t>(i)] = linear_of(float(i) / 255);
    return table;
  }();
  if (!at.allFinite()) return {1, 1, 1};
  const double x = at.x() * texture.width - 0.5, y = (1 - at.y()) * texture.height - 0.5;
  const double left = std::floor(x), top = std::floor(y);
  Color sum{};
  for (int dy = 0; dy < 2; ++dy)
    for (int dx = 0; dx < 2; ++dx) {
      const double share = (dx ? x - left : 1 - x + left) * (dy ? y - top : 1 - y + top);
      const auto column = static_cast<std::size_t>(wrapped(left + dx, texture.width, wrap[0]));
      const auto row = static_cast<std::size_t>(wrapped(top + dy, texture.height, wrap[1]));
      const std::uint8_t* pixel = &texture.rgb[3 * (row * static_cast<std::size_t>(texture.width) + column)];
      for (std::size_t c = 0; c < 3; ++c) sum[c] += float(share) * linear[pixel[c]];
    }
  return sum;
}

Texture halved(const Texture& texture) {
  Texture result{.width = (texture.width + 1) / 2, .height = (texture.height + 1) / 2, .rgb = {}};
  for (int y = 0; y < result.height; ++y)
    for (int x = 0; x < result.width; ++x)
      for (int c = 0; c < 3; ++c) {
        int sum = 0, count = 0;
        for (int b = 2 * y; b < std::min(2 * y + 2, texture.height); ++b)
          for (int a = 2 * x; a < std::min(2 * x + 2, texture.width); ++a) {
            sum += texture.rgb[static_cast<std::size_t>(3) * (static_cast<std::size_t>(b) * texture.width + a) + c];
            ++count;
          }
        result.rgb.push_back(static_cast<std::uint8_t>((sum + count / 2) / count));
      }
  return result;
}

}  // namespace view
