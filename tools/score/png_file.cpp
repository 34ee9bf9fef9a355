// By libpng's simplified interface, which bounds what a file may make it allocate.
#include "score/png_file.h"

#include <png.h>

#include <cstring>
#include <memory>

#include <kerf/error.h>
#include <kerf/files.h>

namespace tool {

geo::GrayImage read_png(const std::string& path) {
  constexpr std::uint64_t max_pixels = 1 << 24;  // 64 MB of brightness
  const std::string bytes = geo::read_all(path);
  png_image image;
  std::memset(&image, 0, sizeof image);
  image.version = PNG_IMAGE_VERSION;
  const std::unique_ptr<png_image, void (*)(png_image*)> ended(&image, png_image_free);
  const auto refuse = [&](const std::string& what) { throw geo::InputError(path + ": " + what); };
  if (bytes.empty() || !png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()))
    refuse("is not a PNG that can be read" + (*image.message ? ", " + std::string(image.message) : "") +
           "; save the image as PNG");
  if (std::uint64_t(image.width) * image.height > max_pixels)
    refuse("has more than 16 million pixels; give a smaller image");
  image.format = PNG_FORMAT_GRAY;
  const png_color white{255, 255, 255};
  std::vector<png_byte> gray(PNG_IMAGE_SIZE(image));
  if (!png_image_finish_read(&image, &white, gray.data(), 0, nullptr))
    refuse("is damaged, " + std::string(image.message) + "; save the image again");
  geo::GrayImage result{
      .width = static_cast<int>(image.width), .height = static_cast<int>(image.height), .brightness = {}};
  result.brightness.reserve(gray.size());
  for (const png_byte g : gray) result.brightness.push_back(static_cast<float>(g) / 255);
  return result;
}

}  // namespace tool
