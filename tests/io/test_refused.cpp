// Files that were once read wrongly, each refused now in one line.
#include <catch2/catch.hpp>

#include "io/kerf_sections.h"
#include "io/samples.h"
#include "kerf/body_file.h"
#include "kerf/check.h"
#include "kerf/error.h"
#include "kerf/files.h"

using namespace geo;

namespace {

template <class Call>
std::string refusal(const Call& call) {
  try {
    call();
  } catch (const InputError& e) {
    return e.what();
  }
  return "read";
}

bool one_line(const std::string& message) {
  return message != "read" && message.size() <= 400 &&
         std::none_of(message.begin(), message.end(), [](unsigned char c) { return c < 32 || c == 127; });
}

// The bytes of a container whose section holds other values.
template <class T>
std::string with_section(const std::string& good, const std::string& section, const std::vector<T>& values) {
  KerfSections sections = parse_kerf(good, "good");
  sections.at(section).bytes.assign(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
  return bytes_of([&](auto& out) { write_kerf(out, sections); });
}

std::string with_about(const std::string& good, const std::string& from, const std::string& to,
                       const std::string& section = "about") {
  KerfSections sections = parse_kerf(good, "good");
  KerfSection& s = sections.at(section);
  const auto at = s.bytes.find(from);
  REQUIRE(at != std::string::npos);
  s.bytes.replace(at, from.size(), to);
  s.shape = {s.bytes.size()};
  return bytes_of([&](auto& out) { write_kerf(out, sections); });
}

}  // namespace

TEST_CASE("what a file says is shown in part and without control characters") {
  CHECK(one_line(refusal([] { parse_fronts("\x1b[31m" + std::string(5000, 'x') + "\n", "f"); })));
  CHECK(one_line(refusal([] { parse_fronts("front a\nstep 0\n0 0 1\v2\n", "f"); })));
  CHECK(one_line(refusal([] { parse_surface("ply\nformat " + std::string(5000, 'x') + "\n", "f"); })));
  CHECK(one_line(refusal([] {
    parse_surface("ply\nformat ascii 1.0\nelement a\x7f" + std::string(5000, 'x') + " 3\nproperty int x\nend_header\n",
                  "f");
  })));
  CHECK(one_line(refusal([] { parse_nodes("VERSION 0.7\nFI\x01" + std::string(5000, 'x') + "\n", "f"); })));
  CHECK(one_line(refusal([] { parse_scene("\"a\\n" + std::string(5000, 'x') + "\" = 1\n", "f"); })));
}

TEST_CASE("letters of all scripts are refused beside a value of a scene, and kept in its strings") {
  for (const std::string letter : {"\u00a1", "\u00b5", "\u00e9", "\u0439", "\u0499", "\u2c00", "\u3042"}) {
    CHECK_THAT(refusal([&] { parse_scene("seed = 3" + letter + "\n", "f"); }), Catch::Contains("f:1:"));
    const Scene scene = parse_scene("[body]\nmesh = \"\"\"a\\\n " + letter + "\"\"\"\n", "f");
    CHECK(scene.bodies[0].mesh == "a" + letter);
  }
}

TEST_CASE("numbers that no crack, site or point has are refused") {
  const auto sides = [](auto change) {
    TriangleMesh mesh = cut_block().complex.two_sided();
    change(mesh);
    return refusal([&] { Complex::from_two_sided(mesh); });
  };
  CHECK_THAT(sides([](auto& m) { m.patch[0] = std::numeric_limits<std::int32_t>::min(); }),
             Catch::Contains("out of range"));
  CHECK_THAT(sides([](auto& m) { m.site[0] = 60000000; }), Catch::Contains("out of range"));
  CHECK_THAT(sides([](auto& m) { m.vertices[0].x() = 1e308; }), Catch::Contains("sensible size"));
  CHECK_THAT(sides([](auto& m) { std::fill(m.vertices.begin(), m.vertices.end(), Vec3::Zero()); }),
             Catch::Contains("no extent"));
  TriangleMesh far = make_block({1, 1, 1}, 1);
  far.vertices[3].y() = -1e200;
  CHECK_THAT(check_surface(far, SelfIntersections::find).first_problem, Catch::Contains("sensible size"));
  TriangleMesh twice = make_block({1, 1, 1}, 1);
  twice.triangles[0] = {0, 0, 0};
  twice.triangles[1] = {0, 0, 1};
  CHECK_THAT(check_surface(twice, SelfIntersections::find).first_problem, Catch::Contains("degenerate"));
  CHECK_THAT(refusal([] { parse_fronts("front a\nstep 0\n0 0 0\n1 0 0\nstep 1\n0 0 1\n1e308 0 1\n", "f"); }),
             Catch::Contains("sensible size"));
}

TEST_CASE("fronts of a surface file that cannot be continued are refused") {
  const CutSurface cut = cut_block();
  const auto with = [&](auto change) {
    auto fronts = cut.fronts;
    change(fronts[0]);
    return refusal([&] { parse_surface(PlyText::of(PlyText::ascii, cut.complex.two_sided(), fronts), "m.ply"); });
  };
  CHECK(with([](auto&) {}) == "read");
  CHECK_THAT(with([](auto& f) { f.closed = true; }), Catch::Contains("fewer than three"));
  CHECK_THAT(with([](auto& f) { f.segments[0][0].position.x() = 1e100; }), Catch::Contains("sensible size"));
  TriangleMesh mesh = cut.complex.two_sided();
  mesh.source.clear();
  std::string text = PlyText::of(PlyText::ascii, mesh);
  const auto at = text.find("property int patch");
  text.replace(at, 18, "property double patch");
  text.replace(text.rfind(" 0 \n"), 4, " 1e308 \n");
  CHECK_THAT(refusal([&] { parse_surface(text, "m.ply"); }), Catch::Contains("32 bits"));
}

TEST_CASE("bodies and checkpoints with impossible numbers are refused") {
  const Body body = cut_body();
  const std::string good = bytes_of([&](auto& out) { write_body(out, body); });
  const auto refused = [](const std::string& bytes) { return refusal([&] { parse_body(bytes, "b.kerf"); }); };
  CHECK(refused(good) == "read");
  const std::size_t rows = body.surface.two_sided().vertices.size();
  CHECK_THAT(refused(with_section(good, "surface/vertices", std::vector<double>(3 * rows, 0.0))),
             Catch::Contains("no extent"));
  CHECK_THAT(refused(with_section(good, "nodes/radius", std::vector<double>(body.nodes.size(), 1e300))),
             Catch::Contains("sensible size"));
  CHECK_THAT(refused(with_about(good, "\"k\":26", "\"k\":1e300")), Catch::Contains("impossible"));
  const std::string run = sample_checkpoint(body);
  const auto run_refused = [](const std::string& bytes) {
    return refusal([&] { read_checkpoint(KerfFile(Input(bytes, "r"))); });
  };
  CHECK(run_refused(run) == "read");
  CHECK_THAT(run_refused(good), Catch::Contains("no checkpoint"));
  CHECK_THAT(run_refused(with_about(run, "\"frame\":12", "\"frame\":1e300", "run/about")),
             Catch::Contains("run/about"));
  CHECK_THAT(run_refused(with_about(run, "\"crack\":2", "\"crack\":99999999999", "run/about")),
             Catch::Contains("run/about"));
}
