// A page receives places at rest, colours, and stress at the skin; the gallery has whole bodies.
#include <unistd.h>
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>

#include <kerf/check.h>
#include <kerf/error.h>
#include <kerf/files.h>
#include "live/bare_model.h"
#include "live/encode.h"
#include "live/gallery.h"
#include "live/save.h"
#include "live/scene_text.h"
#include "page_model.h"
#include "setup.h"

namespace live {
namespace {

namespace fs = std::filesystem;

Snapshot shown(Session& session, bool stress = false) {
  static std::uint64_t number = 0;
  Snapshot s;
  s.number = ++number;
  session.show(s, stress);
  s.scene = std::make_shared<std::string>(scene_text(session, "cube"));
  s.statistics = statistics_text(session, {});
  return s;
}

// An empty folder that is the program's own for a while.
class CurrentFolder {
 public:
  CurrentFolder()
      : before_(fs::current_path()), path_(fs::temp_directory_path() / ("kerf-test-" + std::to_string(getpid()))) {
    fs::create_directory(path_);
    fs::current_path(path_);
  }
  CurrentFolder(const CurrentFolder&) = delete;
  CurrentFolder& operator=(const CurrentFolder&) = delete;
  ~CurrentFolder() {
    fs::current_path(before_);
    fs::remove_all(path_);
  }

 private:
  fs::path before_, path_;
};

// A block whose corners are as red as x is large.
geo::TriangleMesh painted_block() {
  geo::TriangleMesh mesh = geo::make_block({1, 1, 1}, 0.25);
  for (const auto& corners : geo::corners_of(mesh)) {
    mesh.attributes.color.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const geo::Vec3& p = corners[k];
      mesh.attributes.color.back()[k] = {p.x(), 1, 0, 1};
    }
  }
  return mesh;
}

sim::Setup setup() {
  return setup_of("gravity = [0, 0, 0]\n[body]\nmesh = \"b.ply\"\nnodes = 80\n[material]\nyoung = 1e4\n",
                  painted_block());
}

// The page knows where all triangles are in the material, and how their corners are painted.
void require_rest(const PageModel& page, const geo::Complex& complex) {
  std::size_t skin = 0;
  std::vector<std::array<float, 3>> places;
  for (std::size_t s = 0; s < page.triangles.size(); ++s) {
    const auto& t = page.triangles[s];
    if (t[0] == t[1]) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& p = page.rest.at(t[k]);
      places.push_back(p);
      if (page.patch[s] != 0) continue;
      CHECK(std::abs(double(page.paint.at(s).tint[k] & 255) - 255.0 * double(p[0])) <= 2);
      CHECK((page.paint[s].tint[k] >> 8) == 255);
    }
    skin += page.patch[s] == 0;
    if (page.patch[s] != 0) CHECK(page.paint.at(s).material == TrianglePaint::none);
  }
  CHECK(skin > 100);
  std::vector<std::array<float, 3>> real;
  const geo::TriangleMesh surface = complex.two_sided();
  for (const auto& t : surface.triangles)
    for (const auto v : t) {
      const Eigen::Vector3f p = surface.vertices[v].cast<float>();
      real.push_back({p.x(), p.y(), p.z()});
    }
  std::sort(places.begin(), places.end());
  std::sort(real.begin(), real.end());
  CHECK(places == real);
}

}  // namespace

TEST_CASE("a page that asks for it knows places in the material and colours, through a cut and undo") {
  Session session(setup(), {});
  PageModel page;
  Snapshot s = shown(session);
  Content content{.sequence = 1, .rest = true};
  page.take(encode_state(s, content));
  require_rest(page, session.run().body().surface);
  REQUIRE(s.look);
  page.take(encode_look(s, 2));
  CHECK(page.look["materials"].size() == 1);
  CHECK(page.look["materials"][0]["image"] == -1);
  CHECK(page.images.empty());
  auto known = s.topology;
  Stroke stroke{.id = 1, .input = 1, .origin = {-0.4, 0.43, 2}, .direction = {0, 0, -1}, .depth = 4};
  std::size_t deltas = 0;
  for (int i = 0; i <= 12; ++i) {
    stroke.phase = i == 0 ? Phase::begin : i == 12 ? Phase::end : Phase::move;
    stroke.origin.x() = -0.4 + 1.8 * i / 12;
    session.obey(1, stroke);
    REQUIRE(session.advance().empty());
    s = shown(session);
    page.take(encode_frame(s, *known, content));
    deltas += page.kind == 2;
    known = s.topology;
  }
  CHECK(deltas > 3);
  CHECK(session.pieces() == 2);
  require_rest(page, session.run().body().surface);
  session.undo();
  s = shown(session);
  page.take(encode_frame(s, *known, content));
  require_rest(page, session.run().body().surface);
  content.rest = false;
  page.take(encode_state(s, content));
  CHECK((page.flags & (4 | 8 | 16)) == 0);
}

TEST_CASE("the stress at the skin is between those of the nodes, and equal where these are") {
  Session session(setup(), {});
  shown(session);
  session.obey(1, Grab{.id = 1, .input = 1, .spot = {0, {0.3, 0.3, 0.4}}, .to = {2, 2, 2}});
  Grab move{.id = 1, .input = 2, .phase = Phase::move, .spot = {}, .to = {2, 2, 2.1}};
  for (int i = 0; i < 4; ++i) {
    session.obey(1, move);
    session.advance();
  }
  const Snapshot s = shown(session, true);
  REQUIRE(s.skin_stress.size() == s.positions.size());
  const auto [least, most] = std::minmax_element(s.stress.begin(), s.stress.end());
  CHECK(*most > 0);
  for (const double x : s.skin_stress) CHECK((x >= *least * (1 - 1e-12) && x <= *most * (1 + 1e-12)));
  SurfaceView view;
  view.update(session.run());
  SurfaceStress stress;
  for (const double x : stress.at_vertices(session.run(), std::vector<double>(s.stress.size(), 7.0), view))
    CHECK(std::abs(x - 7) < 1e-11);
  PageModel page;
  page.take(encode_state(s, {.sequence = 1, .stress = true, .rest = true}));
  REQUIRE(page.skin_stress.size() == s.skin_stress.size());
  for (std::size_t v = 0; v < s.skin_stress.size(); ++v)
    CHECK(std::abs(page.skin_stress[v] - s.skin_stress[v]) <= 2e-5 * *most);
}

TEST_CASE("every body of the gallery is a solid, and the same each time") {
  CHECK(gallery_names().size() == 10);
  for (const std::string& name : gallery_names()) {
    INFO(name);
    const ModelFile file = gallery_model(name);
    CHECK(file.name == name + ".ply");
    CHECK(gallery_model(name).bytes == file.bytes);
    const geo::TriangleMesh mesh = geo::parse_surface(file.bytes, file.name).mesh;
    CHECK_NOTHROW(geo::require_solid(mesh));
    CHECK((mesh.triangles.size() > 1000 && mesh.triangles.size() < 12000));
  }
  CHECK_THROWS_AS(gallery_model("pear"), geo::InputError);
}

TEST_CASE("an OBJ that comes with its materials and image has both, also in a saved .glb") {
  // A PNG of one red pixel.
  const std::string image(
      "\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\1\0\0\0\1\10\2\0\0\0\x90wS\xde\0\0\0\x0cIDATx\x9c"
      "c\xf8\xcf\xc0\0\0\3\1\1\0\xc9\xfe\x92\xef\0\0\0\0IEND\xae"
      "B`\x82",
      69);
  std::string obj = "mtllib box.mtl\nvt 0 0\nvt 1 0\nvt 1 1\nusemtl red\n";
  const geo::TriangleMesh block = geo::make_block({1, 1, 1}, 0.125);  // fine enough for its nodes: it stays as it is
  for (const geo::Vec3& p : block.vertices)
    obj += "v " + std::to_string(p.x()) + " " + std::to_string(p.y()) + " " + std::to_string(p.z()) + "\n";
  for (const geo::Triangle& t : block.triangles) {
    obj += "f";
    for (std::size_t k = 0; k < 3; ++k) obj += " " + std::to_string(t[k] + 1) + "/" + std::to_string(k + 1);
    obj += "\n";
  }
  const BesideFile library{"box.mtl", "newmtl red\nKd 1 1 1\nmap_Kd red.png\n"};
  const BareModel model = bare_model("box.obj", obj, 60, 'z', {}, std::vector<BesideFile>{library, {"red.png", image}});
  CHECK(model.notes.empty());
  REQUIRE(model.setup.materials.glb);
  Session session(model.setup, {});
  PageModel page;
  const Snapshot s = shown(session);
  page.take(encode_look(s, 1));
  CHECK(page.look["materials"][0]["image"] == 0);
  CHECK(page.look["images"][0]["type"] == "image/png");
  CHECK(page.images == image);
  page.take(encode_state(s, {.sequence = 1, .rest = true}));
  for (const PageModel::Paint& paint : page.paint) {
    CHECK(paint.tint == std::array<std::uint32_t, 3>{0xffffff, 0xffffff, 0xffffff});
    CHECK(paint.at == std::array<std::array<float, 2>, 3>{{{0, 0}, {1, 0}, {1, 1}}});
  }
  CHECK(saved_file(session, "glb", {}).find(image) != std::string::npos);
  const BareModel bare = bare_model("box.obj", obj, 60, 'z', {}, std::vector<BesideFile>{library});
  REQUIRE(bare.notes.size() == 1);
  CHECK(bare.notes[0] == "box.obj: left out: textures not in its folder: red.png");
  // A model that came alone has none of the files that are in the program's folder.
  const CurrentFolder here;
  geo::write_all(library.name, [&](std::ostream& out) { out << library.bytes; });
  const BareModel alone = bare_model("box.obj", obj, 60, 'z', {}, std::vector<BesideFile>{});
  REQUIRE(alone.notes.size() == 1);
  CHECK(alone.notes[0].starts_with("box.obj: names box.mtl, not in its folder"));
  CHECK(bare_model("box.obj", obj, 60, 'z', {}).setup.materials.glb);
  for (const std::string name : {"../evil.mtl", "a/b", "..", "."})
    CHECK_THROWS_AS(bare_model("box.obj", obj, 60, 'z', {}, std::vector<BesideFile>{{name, "x"}}), geo::InputError);
}

}  // namespace live
