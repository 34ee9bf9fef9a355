// kerf/jobs.h: each job equals the calls that it is made of.
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <sstream>

#include "kerf/check.h"
#include "kerf/error.h"
#include "kerf/files.h"
#include "kerf/jobs.h"
#include "kerf/pieces.h"

using namespace geo;

namespace {

double volume_of(const PieceSet& pieces) {
  double sum = 0;
  for (const Chunk& c : pieces.chunks) sum += c.volume;
  return sum;
}

std::string glb_of(const PieceSet& pieces) {
  std::ostringstream out;
  write_glb(out, pieces.chunks, pieces.bonds, pieces.labels, {.hull_corners = 64});
  return out.str();
}

Front plane_front(double y) {
  Front front;
  front.steps = {{{-3, y, 2}, {3, y, 2}}, {{-3, y, 0}, {0, y, 0}, {3, y, 0}}, {{-3, y, -2}, {3, y, -2}}};
  return front;
}

Scene small_scene() {
  Scene scene;
  scene.bodies.resize(1);
  scene.bodies[0].sampling.spacing = 0.35;
  scene.dt = 1 / scene.frame_rate;
  scene.frames = 3;
  return scene;
}

}  // namespace

TEST_CASE("fracture() gives the pieces and bonds of a score") {
  const TriangleMesh model = make_pumpkin(8);
  ScoreOptions options;
  options.pieces = 7;
  const PieceSet pieces = fracture(model, options);
  CHECK(pieces.chunks.size() == 7);
  CHECK(pieces.labels.names == piece_names(7));
  CHECK_FALSE(pieces.bonds.empty());
  CHECK(volume_of(pieces) == Approx(signed_volume(model)));
  for (const Chunk& c : pieces.chunks) CHECK(check_surface(c.mesh, SelfIntersections::find).good());

  Complex complex = Complex::from_skin(model);
  insert_sheet(complex, make_score(complex, options).sheet, 1);
  const Pieces found = find_pieces(complex);
  REQUIRE(found.count == pieces.chunks.size());
  for (std::uint32_t i = 0; i < found.count; ++i)
    CHECK(piece_mesh(complex, found, i).vertices == pieces.chunks[i].mesh.vertices);
}

TEST_CASE("cut() takes a sheet or a front, and cuts what is cut again") {
  const TriangleMesh model = make_sphere(6);
  TriangleMesh sheet;
  sheet.vertices = {{-2, 0.1, -2}, {2, 0.1, -2}, {2, 0.1, 2}, {-2, 0.1, 2}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  const PieceSet halves = cut(model, sheet);
  CHECK(halves.chunks.size() == 2);
  CHECK(halves.bonds.size() == 1);
  CHECK(volume_of(halves) == Approx(signed_volume(model)));
  CHECK(halves.bonds[0].area == Approx(3.0).epsilon(0.05));

  CHECK(cut(model, plane_front(0.1)).chunks.size() == 2);
  Front as_sheet;
  as_sheet.steps = {sheet.vertices};
  as_sheet.triangles = sheet.triangles;
  CHECK(glb_of(cut(model, as_sheet)) == glb_of(halves));

  Complex complex = Complex::from_skin(model);
  insert_sheet(complex, sheet, 1);
  CHECK(cut(complex.two_sided(), plane_front(-0.4)).chunks.size() == 3);
}

TEST_CASE("a sheet may be stopped at any report, and the complex is as it was") {
  Complex complex = Complex::from_skin(make_sphere(8));
  ScoreOptions options;
  options.pieces = 6;
  options.jagged.amplitude = 0.02;
  const TriangleMesh sheet = make_score(complex, options).sheet;
  const TriangleMesh before = complex.two_sided();
  Complex whole = complex;
  std::size_t reports = 0;
  const CrackDelta wanted = insert_sheet(whole, sheet, 1, {}, nullptr, [&](auto&&...) { return ++reports > 0; });
  REQUIRE(reports > 20);
  for (std::size_t last = 1; last <= reports; last += 1 + reports / 20) {
    std::size_t now = 0;
    const auto stop = [&](std::string_view, std::size_t, std::size_t) { return ++now < last; };
    CHECK_THROWS_AS(insert_sheet(complex, sheet, 1, {}, nullptr, stop), Interrupted);
    const TriangleMesh after = complex.two_sided();
    CHECK((after.vertices == before.vertices && after.triangles == before.triangles));
  }
  CHECK(insert_sheet(complex, sheet, 1).new_crack_faces == wanted.new_crack_faces);
  CHECK(complex.two_sided().vertices == whole.two_sided().vertices);
}

TEST_CASE("jobs refuse models and fronts that they cannot use") {
  TriangleMesh open = make_sphere(4);
  open.triangles.pop_back();
  CHECK_THROWS_AS(fracture(open), InputError);
  CHECK_THROWS_AS(cut(open, TriangleMesh()), InputError);
  const TriangleMesh model = make_sphere(4);
  CHECK_THROWS_WITH(cut(model, Front()), Catch::Contains("has no points"));
  Front front = plane_front(0);
  front.steps.resize(1);
  CHECK_THROWS_WITH(cut(model, front), Catch::Contains("give two at least"));
  const Progress stop = [](std::string_view, std::size_t, std::size_t) { return false; };
  CHECK_THROWS_AS(fracture(model, {}, stop), Interrupted);
  CHECK_THROWS_AS(cut(model, plane_front(0), {}, stop), Interrupted);
  CHECK_THROWS_AS(cut(model, make_block({3, 3, 0.1}, 1), {}, stop), Interrupted);
}

TEST_CASE("save() writes a .glb or a .usda, and refuses other endings") {
  const PieceSet pieces = cut(make_sphere(4), plane_front(0));
  const auto folder = std::filesystem::temp_directory_path() / "kerf-jobs";
  std::filesystem::create_directories(folder);
  save((folder / "a.glb").string(), pieces);
  CHECK(read_all((folder / "a.glb").string()) == glb_of(pieces));
  save((folder / "a.usda").string(), pieces);
  CHECK(read_all((folder / "a.usda").string()).starts_with("#usda"));
  CHECK_THROWS_WITH(save((folder / "a.obj").string(), pieces), Catch::Contains("as .glb or .usda"));
  std::filesystem::remove_all(folder);
}

TEST_CASE("simulate() makes the frames of a Simulation, and stops where its sink says so") {
  const Scene scene = small_scene();
  const TriangleMesh block = make_block({1, 1, 1}, 0.5);
  std::vector<TriangleMesh> frames;
  const auto keep = [&](const Simulation& run, const FrameStats& stats) {
    CHECK(stats.steps == 1);
    frames.push_back(run.surface());
    return true;
  };
  const Simulation run = simulate(scene, {block}, keep);
  CHECK(run.state().frame == 3);
  REQUIRE(frames.size() == 3);
  Simulation same(scene, block);
  for (const TriangleMesh& frame : frames) {
    same.advance_frame();
    CHECK(frame.vertices == same.surface().vertices);
  }

  CHECK(simulate(scene, {block}, [](const Simulation&, const FrameStats&) { return false; }).state().frame == 1);
  CHECK(simulate(scene, {block}, {}).state().frame == 3);
  CHECK_THROWS_AS(simulate(scene, std::vector<TriangleMesh>{}, {}), InputError);
}

TEST_CASE("simulate() reads the models that a scene names") {
  const auto folder = std::filesystem::temp_directory_path() / "kerf-jobs-scene";
  std::filesystem::create_directories(folder);
  Scene scene = small_scene();
  scene.bodies[0].mesh = (folder / "block.obj").string();
  {
    std::ofstream file(scene.bodies[0].mesh);
    write_obj(file, make_block({1, 1, 1}, 0.5));
  }
  CHECK(simulate(scene, {}).state().frame == 3);
  {
    TriangleMesh open = make_block({1, 1, 1}, 0.5);
    open.triangles.pop_back();
    std::ofstream file(scene.bodies[0].mesh);
    write_obj(file, open);
  }
  CHECK_THROWS_WITH(simulate(scene, {}), Catch::Contains("block.obj: "));
  std::filesystem::remove_all(folder);
}
