// Readers below the formats: lines and numbers, PLY elements, JSON integers, layout of `.kerf`
// files, overrides of scene keys.
#include <catch2/catch.hpp>

#include "io/json_integer.h"
#include "io/kerf_layout.h"
#include "io/kerf_segment.h"
#include "io/kerf_values.h"
#include "io/line_reader.h"
#include "io/ply.h"
#include "io/scene_keys.h"
#include "kerf/error.h"

using namespace geo;

TEST_CASE("lines are split into words, and errors have their number", "[text]") {
  LineReader lines("# comment\n\n  a\tb 12 # end\r\n+1.5 nan", "f.txt");
  std::vector<std::string_view> words;
  REQUIRE(lines.next(words));
  CHECK(words == std::vector<std::string_view>{"a", "b", "12"});
  CHECK(lines.integer(words[2]) == 12);
  CHECK(refusal([&] { lines.integer(words[0]); }) == "f.txt:3: 'a' is not an integer");
  REQUIRE(lines.next(words));
  CHECK(lines.real(words[0]) == 1.5);
  CHECK_THAT(refusal([&] { lines.real(words[1]); }), Catch::StartsWith("f.txt:4: 'nan' is not a finite number"));
  CHECK_FALSE(lines.next(words));
  CHECK(lines.position() == 35);  // all of the text
}

TEST_CASE("text in messages is short, without control characters, and not cut within a character", "[text]") {
  CHECK(shown("a\nb\x7f") == "a?b?");
  CHECK(shown("abcdef", 3) == "abc...");
  CHECK(shown("ab\xc3\xa4z", 3) == "ab...");  // ä has two bytes
}

TEST_CASE("PLY elements have the values of text and of either byte order", "[text]") {
  const std::string header = "element v 2\nproperty uchar n\nproperty list uchar short l\nend_header\n";
  const std::string text = "ply\nformat ascii 1.0\ncomment a b\n" + header + "7 2 -1 300\n8 0\n";
  const std::string little =
      "ply\nformat binary_little_endian 1.0\n" + header + std::string("\x07\x02\xff\xff\x2c\x01\x08\x00", 8);
  const std::string big =
      "ply\nformat binary_big_endian 1.0\n" + header + std::string("\x07\x02\xff\xff\x01\x2c\x08\x00", 8);
  for (const std::string& bytes : {text, little, big}) {
    const Ply ply = parse_ply(bytes, "a.ply");
    const PlyElement* v = ply.find("v");
    REQUIRE(v);
    CHECK(ply.find("w") == nullptr);
    CHECK(v->count == 2);
    CHECK(v->find("n")->values == std::vector<double>{7, 8});
    CHECK(v->find("l")->values == std::vector<double>{-1, 300});
    CHECK(v->find("l")->ends == std::vector<std::uint32_t>{2, 2});
    CHECK_FALSE(ply.has_rest);
    CHECK(parse_ply(bytes + "x", "a.ply").has_rest);
    CHECK_THAT(refusal([&] { require_no_rest(parse_ply(bytes + "x", "a.ply"), "a.ply"); }),
               Catch::Contains("after its last element"));
    CHECK_THAT(refusal([&] { parse_ply(bytes.substr(0, bytes.size() - 3), "a.ply"); }), Catch::StartsWith("a.ply"));
  }
  CHECK(parse_ply(text, "a.ply").comments == std::vector<std::string>{"a b"});
}

TEST_CASE("JSON integers outside of a type's range are refused", "[text]") {
  CHECK(json_integer<std::uint8_t>(nlohmann::json::parse("255")) == 255);
  CHECK_THROWS_AS(json_integer<std::uint8_t>(nlohmann::json::parse("256")), std::out_of_range);
  CHECK_THROWS_AS(json_integer<std::uint8_t>(nlohmann::json::parse("-1")), std::out_of_range);
  CHECK_THROWS_AS(json_integer<int>(nlohmann::json::parse("1.5")), std::out_of_range);
  CHECK(json_integer<int>(nlohmann::json::parse("-2147483648")) == -2147483647 - 1);
}

TEST_CASE("segments of .kerf files have the size that is computed for them", "[text]") {
  CHECK(kerf::aligned(0) == 0);
  CHECK(kerf::aligned(1) == 64);
  CHECK(kerf::aligned(64) == 64);
  CHECK(kerf::hex(0x1234567890abcdefULL) == "1234567890abcdef");
  CHECK(kerf::size_of("f8") == 8);
  CHECK(kerf::size_of("f16") == 0);
  CHECK(kerf::row_bytes("f4", {10, 3}) == 12);
  CHECK(kerf::row_bytes("u2", {10}) == 2);
  const std::vector<double> values(5, 1.5);
  const std::vector<kerf::Stored> sections{{kerf_array("x", std::span<const double>(values)), {}, 0, 0}};
  for (const std::uint64_t start : {0, 640}) {
    std::uint64_t written = 0;
    const auto commit =
        kerf::write_segment([&](std::span<const std::byte> b) { written += b.size(); }, start, 0, 0, sections);
    CHECK(written + sizeof commit == kerf::segment_size(start, sections));
    CHECK(commit.hash == commit.own_hash());
  }
}

TEST_CASE("dotted keys set values in tables and lists", "[text]") {
  toml::table root = toml::parse("[material]\nyoung = 1.0\n[[blade]]\nthickness = 0.1\n");
  override_key(root, "material.young", "2e5");
  override_key(root, "blade.0.thickness", "0.25");
  override_key(root, "body.mesh", "bear.off");  // a word without quotes is text
  CHECK(root["material"]["young"].value<double>() == 2e5);
  CHECK(root["blade"][0]["thickness"].value<double>() == 0.25);
  CHECK(root["body"]["mesh"].value<std::string>() == std::string("bear.off"));
  CHECK_THROWS_AS(override_key(root, "blade.7.thickness", "1"), InputError);
  const Motion::Key first, second{.time = 1}, without_axis{.axis = Vec3::Zero()};
  CHECK(unfit({first, second}).empty());
  CHECK_FALSE(unfit({second, first}).empty());  // not ascending
  CHECK_FALSE(unfit({without_axis}).empty());
}
