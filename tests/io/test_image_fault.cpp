// image_fault() of io/image_type.h, and surfaces whose images have one: left out, named in a line.
#include <catch2/catch.hpp>

#include "io/image_type.h"
#include "io/images.h"

using namespace geo;

TEST_CASE("an image that is empty, cut off or damaged has a fault, a whole one none", "[materials]") {
  const std::string png = whole_png(2, "words"), jpeg = whole_jpeg(" words ");
  CHECK(crc32("123456789") == 0xcbf43926u);  // the check value of this checksum
  CHECK(image_fault(png).empty());
  CHECK(image_fault(jpeg).empty());
  CHECK(image_fault(jpeg + "bytes of a camera").empty());
  CHECK(image_fault("RIFF____WEBP").empty());
  CHECK(image_fault("") == "is empty");
  CHECK(image_fault("a text") == "is no PNG or JPEG");
  // Every beginning from the signature on is cut off, and every flipped bit shows.
  for (std::size_t length = 4; length < png.size(); ++length) {
    CAPTURE(length);
    CHECK(image_fault(png.substr(0, length)) == "is cut off");
  }
  for (std::size_t length = 2; length < jpeg.size(); ++length)
    CHECK(image_fault(jpeg.substr(0, length)) == "is cut off");
  for (std::size_t at = 8; at < png.size(); ++at) {
    std::string flipped = png;
    flipped[at] = static_cast<char>(flipped[at] ^ 4);
    CAPTURE(at);
    CHECK_FALSE(image_fault(flipped).empty());
  }
}
