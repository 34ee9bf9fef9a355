#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

#include "base/random.h"
#include "cases.h"
#include "graph/graph_storage.h"
#include "io/kerf_layout.h"
#include "io/kerf_sections.h"
#include "kerf/body.h"
#include "kerf/body_file.h"
#include "kerf/error.h"
#include "kerf/export.h"
#include "kerf/files.h"
#include "kerf/mesh.h"
#include "kerf/nodes.h"

using namespace geo;

namespace {

template <class Write>
std::string bytes_of(const Write& write) {
  std::ostringstream out;
  write(out);
  return out.str();
}

Body small_body(double guides = 0) {
  const TriangleMesh mesh = make_block({1, 1, 1}, 0.25);
  SampleOptions options;
  options.spacing = 0.15;
  BodyOptions guided;
  guided.guide_spacing = guides;
  Body body = build_body(Complex::from_skin(mesh), sample_nodes(mesh, options), guided);
  FrontState front = begin_front(std::vector<Vec3>{{-0.5, -0.5, 0.512}, {-0.5, 1.5, 0.52}}, false, 1);
  split(body, front, {{0.6, -0.5, 0.53}, {0.61, 1.5, 0.5}});
  return body;
}

// Truncations at many places and random changes: an InputError or a result, nothing else.
template <class Parse>
void mutate(const std::string& good, const Parse& parse, int count) {
  const auto attempt = [&](const std::string& bytes) {
    try {
      parse(bytes);
    } catch (const InputError& e) {
      REQUIRE(std::string(e.what()).find('\n') == std::string::npos);
    }
  };
  attempt(good);
  const std::size_t step = std::max<std::size_t>(1, good.size() / 300);
  for (std::size_t n = 0; n < good.size(); n += step) attempt(good.substr(0, n));
  Random random(4242);
  for (int i = 0; i < cases(count); ++i) {
    std::string bytes = good;
    const int changes = 1 + static_cast<int>(random.below(3));
    // Half of the changes hit the header, where sizes are.
    for (int c = 0; c < changes; ++c)
      bytes[random.below(
          static_cast<std::uint32_t>(random.below(2) ? std::min<std::size_t>(bytes.size(), 400) : bytes.size()))] =
          static_cast<char>(random.bits());
    CAPTURE(i);
    attempt(bytes);
  }
}

}  // namespace

TEST_CASE("surfaces are read back to the bit, from every format") {
  const TriangleMesh mesh = make_pumpkin(3);
  const auto ply = parse_surface(bytes_of([&](auto& out) { write_ply(out, mesh); }), "a.ply").mesh;
  CHECK(ply.vertices == mesh.vertices);
  CHECK(ply.triangles == mesh.triangles);
  const auto obj = parse_surface(bytes_of([&](auto& out) { write_obj(out, mesh); }), "a.obj").mesh;
  CHECK(obj.vertices == mesh.vertices);
  CHECK(obj.triangles == mesh.triangles);
  const auto off =
      parse_surface("OFF # a comment\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3 255 0 0\n3 0 3 2\n",
                    "a.off")
          .mesh;
  CHECK(off.triangles.size() == 4);
  const auto stl = parse_surface(
                       "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
                       "0\nendloop\nendfacet\nendsolid x\n",
                       "a.stl")
                       .mesh;
  CHECK(stl.vertices.size() == 3);
  const auto ascii =
      parse_surface(
          "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face "
          "1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n",
          "q.ply")
          .mesh;
  CHECK(ascii.triangles.size() == 2);
}

TEST_CASE("fronts, with their contacts, travel in the surface file") {
  Complex k = Complex::from_skin(make_block({4, 4, 4}, 1));
  FrontState front = begin_front(std::vector<Vec3>{{-1, -1, 1.3}, {-1, 5, 1.3}}, false, 1);
  front.name = "halve";
  advance(k, front, std::vector<Vec3>{{2.2, -1, 1.3}, {2.2, 5, 1.3}});
  const std::string bytes = bytes_of([&](auto& out) { write_ply(out, k.two_sided(), {front}); });
  const SurfaceFile file = parse_surface(bytes, "cut.ply");
  REQUIRE(file.fronts.size() == 1);
  CHECK(file.fronts[0].name == "halve");
  CHECK(file.fronts[0].step == 1);
  REQUIRE(file.fronts[0].segments.size() == front.segments.size());
  for (std::size_t i = 0; i < front.segments[0].size(); ++i)
    CHECK(file.fronts[0].segments[0][i].id == front.segments[0][i].id);
  TriangleMesh again = Complex::from_two_sided(file.mesh).two_sided();
  transfer_attributes(file.mesh, again);
  CHECK(bytes_of([&](auto& out) { write_ply(out, again, file.fronts); }) == bytes);
}

TEST_CASE("nodes and bodies are read back to the bit") {
  const double guides = GENERATE(0.0, 1.0);
  const Body body = small_body(guides);
  CHECK((GraphStorage::of(body.graph).guides().size() > 0) == (guides > 0));
  const std::string pcd = bytes_of([&](auto& out) { write_pcd(out, body.nodes); });
  CHECK(parse_nodes(pcd, "n.pcd").position == body.nodes.position);
  CHECK(parse_nodes(pcd, "n.pcd").volume == body.nodes.volume);
  CHECK(parse_nodes(bytes_of([&](auto& out) { write_nodes_ply(out, body.nodes); }), "n.ply").radius ==
        body.nodes.radius);
  const std::string kerf = bytes_of([&](auto& out) { write_body(out, body); });
  const Body again = parse_body(kerf, "b.kerf");
  CHECK(again.graph == body.graph);
  CHECK(again.guide_spacing == guides);
  CHECK(again.surface.two_sided().source == body.surface.two_sided().source);
  CHECK(check_body(again).first_problem == "");
  CHECK(bytes_of([&](auto& out) { write_body(out, again); }) == kerf);
}

TEST_CASE("nodes of a frame are a node file with a stress") {
  FrameNodes frame{small_body().nodes, {}};
  for (std::size_t i = 0; i < frame.nodes.size(); ++i) frame.stress.push_back(0.5 * double(i));
  const std::string ply = bytes_of([&](auto& out) { write_frame_nodes(out, frame); });
  const FrameNodes again = parse_frame_nodes(ply, "n.ply");
  CHECK(again.stress == frame.stress);
  REQUIRE(again.nodes.size() == frame.nodes.size());
  for (std::size_t i = 0; i < again.nodes.size(); ++i)
    CHECK((again.nodes.position[i] - frame.nodes.position[i]).norm() < 1e-6);
  CHECK(parse_nodes(ply, "n.ply").spacing == again.nodes.spacing);
  CHECK_THROWS_WITH(parse_frame_nodes(bytes_of([&](auto& out) { write_nodes_ply(out, frame.nodes); }), "n.ply"),
                    Catch::Contains("stress"));
  CHECK_THROWS_WITH(parse_frame_nodes(bytes_of([&](auto& out) { write_pcd(out, frame.nodes); }), "n.pcd"),
                    Catch::Contains("no PLY"));
  CHECK_THROWS_AS(parse_frame_nodes(ply.substr(0, ply.size() - 1), "n.ply"), InputError);
}

TEST_CASE("a body of version 1 is read, and written whole when it is updated") {
  const Body body = small_body();
  const std::string kerf = bytes_of([&](auto& out) { write_body(out, body); });
  std::string old = kerf.substr(0, 20);
  old[12] = 1;
  old.resize(64);
  nlohmann::json table = nlohmann::json::array();
  auto sections = parse_kerf(kerf, "b.kerf");
  for (const char* name : {"graph/count", "graph/to", "graph/bits", "graph/paths"}) sections.erase(name);
  const auto put = [&](const std::string& name, const char* dtype, const auto& values) {
    auto& s = sections[name];
    s.dtype = dtype;
    s.shape = {values.size()};
    s.bytes.assign(reinterpret_cast<const char*>(values.data()), values.size() * sizeof values[0]);
  };
  std::vector<std::uint32_t> edge, edge_ends, to, warped, ends;
  std::vector<float> distance;
  for (std::uint32_t i = 0; i < body.nodes.size(); ++i) {
    for (const NodeId j : body.graph.edges(NodeId(i)))
      if (j.value > i) edge.push_back(j.value);
    for (const auto& n : body.graph.neighbors(body.nodes, NodeId(i))) {
      to.push_back(n.to.value);
      warped.push_back(n.warped);
      distance.push_back(n.distance);
    }
    edge_ends.push_back(static_cast<std::uint32_t>(edge.size()));
    ends.push_back(static_cast<std::uint32_t>(to.size()));
  }
  put("graph/ends", "u4", edge_ends);
  put("graph/to", "u4", edge);
  put("neighbors/ends", "u4", ends);
  put("neighbors/to", "u4", to);
  put("neighbors/warped", "u4", warped);
  put("neighbors/distance", "f4", distance);
  for (auto& [key, s] : sections) {
    table.push_back({{"name", key},
                     {"dtype", s.dtype},
                     {"shape", s.shape},
                     {"offset", old.size()},
                     {"length", s.bytes.size()},
                     {"xxh3", kerf::hex(fingerprint(s.bytes))}});
    old += s.bytes;
    old.resize(kerf::aligned(old.size()));
  }
  const std::string text = table.dump();
  const std::uint64_t record[] = {old.size(), text.size(), fingerprint(text)};
  old += text;
  old.resize(kerf::aligned(old.size()));
  old.append("KCOMMIT\n").append(reinterpret_cast<const char*>(record), sizeof record);
  CHECK(bytes_of([&](auto& out) { write_body(out, parse_body(old, "old.kerf")); }) == kerf);
  CHECK_THROWS_WITH(parse_body(old.substr(0, old.size() - 1), "old.kerf"), Catch::Contains("truncated"));
  const auto path =
      (std::filesystem::temp_directory_path() / ("kerf-old-" + std::to_string(std::random_device{}()) + ".kerf"))
          .string();
  write_all(path, [&](std::ostream& out) { out << old; });
  write_body(*std::make_unique<KerfUpdate>(path), body);
  const std::string updated = read_all(path);
  std::filesystem::remove(path);
  CHECK(updated == kerf);
  std::size_t refused = 0;
  for (std::size_t at = 64; at < old.size(); at += 997) {
    std::string damaged = old;
    damaged[at] = static_cast<char>(damaged[at] ^ 4);
    std::string again = kerf;  // where it is read: between two sections
    try {
      again = bytes_of([&](auto& out) { write_body(out, parse_body(damaged, "old.kerf")); });
    } catch (const InputError&) {
      ++refused;
    }
    CHECK(again == kerf);
  }
  CHECK(refused > old.size() / 997 - 10);
}

TEST_CASE("a body is updated in its own file") {
  Body body = small_body(GENERATE(0.0, 1.0));
  const auto path =
      (std::filesystem::temp_directory_path() / ("kerf-own-" + std::to_string(std::random_device{}()) + ".kerf"))
          .string();
  write_all(path, [&](std::ostream& out) { write_body(out, body); });
  FrontState front = begin_front(std::vector<Vec3>{{0.512, -0.5, -0.5}, {0.52, 1.5, -0.5}}, false, 2);
  for (const double z : {0.2, 0.4}) {
    split(body, front, {{0.512, -0.5, z}, {0.52, 1.5, z}});
    const auto before = std::filesystem::file_size(path);
    KerfUpdate update(path);
    const auto written = write_body(update, body);
    CHECK(std::filesystem::file_size(path) == before + written);
    CHECK(bytes_of([&](auto& out) { write_body(out, read_body(path)); }) ==
          bytes_of([&](auto& out) { write_body(out, body); }));
  }
  CHECK(KerfFile(Input(path)).updates() == 2);
  std::filesystem::remove(path);
}

TEST_CASE("other radii are appended to a body's file, and a body that is read goes on as the one that was written") {
  Body body = small_body(GENERATE(0.0, 1.0));
  const double widest = body.widest_radius;
  const auto path =
      (std::filesystem::temp_directory_path() / ("kerf-radii-" + std::to_string(std::random_device{}()) + ".kerf"))
          .string();
  write_all(path, [&](std::ostream& out) { write_body(out, body); });
  std::vector<std::pair<NodeId, double>> radii;  // none is as wide any more
  for (std::uint32_t i = 0; i < body.nodes.size(); ++i) radii.push_back({NodeId(i), 0.9 * body.nodes.radius[i]});
  CHECK(resize_nodes(body, radii).resized_nodes.size() == body.nodes.size());
  const auto all = write_body(*std::make_unique<KerfUpdate>(path), body);
  for (const double none : {0.0, -1.0, std::nan("")})
    CHECK_THROWS_AS(resize_nodes(body, std::vector{std::pair(NodeId(0u), none)}), InputError);
  radii = {{NodeId(0u), 0.8 * widest}, {NodeId(3u), body.nodes.radius[3]}};
  CHECK(resize_nodes(body, radii).resized_nodes.size() == 1);
  CHECK(2 * write_body(*std::make_unique<KerfUpdate>(path), body) < all);
  Body again = read_body(path);
  CHECK(KerfFile(Input(path)).updates() == 2);
  std::filesystem::remove(path);
  CHECK(again.widest_radius == widest);
  CHECK(again.nodes.radius == body.nodes.radius);
  CHECK(again.graph == body.graph);
  const auto bytes = [&](const Body& b) { return bytes_of([&](auto& out) { write_body(out, b); }); };
  CHECK(bytes(again) == bytes(body));
  for (Body* b : {&again, &body}) {
    FrontState front = begin_front(std::vector<Vec3>{{0.512, -0.5, -0.5}, {0.52, 1.5, -0.5}}, false, 2);
    split(*b, front, {{0.512, -0.5, 0.4}, {0.52, 1.5, 0.4}});
  }
  CHECK(bytes(again) == bytes(body));
}

TEST_CASE("a newer version, a text transfer and another kind of file are told apart") {
  std::string kerf = bytes_of([&](auto& out) { write_body(out, small_body()); });
  std::string newer = kerf;
  newer[12] = 9;
  CHECK_THROWS_WITH(parse_body(newer, "b.kerf"), Catch::Contains("newer"));
  std::string text = kerf;
  text.erase(5, 1);
  CHECK_THROWS_WITH(parse_body(text, "b.kerf"), Catch::Contains("text transfer"));
  CHECK_THROWS_WITH(parse_body("OFF\n", "b.kerf"), Catch::Contains("not a .kerf"));
}

TEST_CASE("fronts are read, and refused with file and line") {
  const auto fronts = parse_fronts(
      "# a comment\nfront a\nstep 0\n0 0 0\n1 0 0\nstep 1\n0 0 1\n1 0 1\nfront b closed\nstep 0\n0 0 0\n1 0 0\n0 1 "
      "0\nstep 1\n0 0 1\n1 0 1\n0 1 1\n",
      "f.front");
  REQUIRE(fronts.size() == 2);
  CHECK(fronts[1].closed);
  CHECK(parse_fronts(bytes_of([&](auto& out) { write_fronts(out, fronts); }), "f").at(0).steps == fronts[0].steps);
  CHECK_THROWS_WITH(parse_fronts("front a\nstep 0\n0 0 0\nstep 1\n0 0 1\n", "f.front"), Catch::Contains("1 point"));
  CHECK_THROWS_WITH(parse_fronts("front a\nstep 0\n0 0 zero\n", "f.front"), Catch::Contains("f.front:3:"));
  CHECK_THROWS_WITH(parse_fronts("front a\nstep 0\n0 0 nan\n", "f.front"), Catch::Contains("finite"));
  const auto obj = parse_fronts("v 0 0 0\nv 1 0 0\nv 0 0 1\nv 1 0 1\no s0\nl 1 2\no s1\nl 3 4\n", "f.obj");
  CHECK(obj.at(0).steps.size() == 2);
  const auto sheets = parse_fronts(
      "sheet s\nv 0 0 0.1\nv 1 0 0\nv 0 1 0\nf 1 2 3\nfront a\nstep 0\n0 0 0\n1 0 0\nstep 1\n0 0 1\n1 0 1\n",
      "f.front");
  REQUIRE(sheets.size() == 2);
  CHECK((sheets[0].is_sheet() && !sheets[1].is_sheet()));
  const auto again = parse_fronts(bytes_of([&](auto& out) { write_fronts(out, sheets); }), "f");
  CHECK((again.at(0).steps == sheets[0].steps && again.at(0).triangles == sheets[0].triangles &&
         again.at(1).steps == sheets[1].steps));
  CHECK_THROWS_WITH(parse_fronts("sheet s\nv 0 0 0\nv 1 0 0\nf 1 2 3\n", "f.front"), Catch::Contains("f.front:4:"));
  CHECK_THROWS_WITH(parse_fronts("sheet s\nv 0 0 0\nv 1 0 0\nf 0 1 2\n", "f.front"),
                    Catch::Contains("numbered from 1"));
  CHECK_THROWS_WITH(parse_fronts("sheet s\nv 0 0 0\nv 1 0 0\nv 1 1 0\n", "f.front"), Catch::Contains("triangles"));
  CHECK_THROWS_WITH(parse_fronts("sheet s\nv 0 0 0\n1 0 0\n", "f.front"), Catch::Contains("f a b c"));
}

TEST_CASE("any change to a file gives an error or a result") {
  const TriangleMesh mesh = make_sphere(2);
  mutate(
      bytes_of([&](auto& out) { write_ply(out, mesh); }), [](const std::string& b) { parse_surface(b, "m.ply"); },
      1500);
  mutate(
      bytes_of([&](auto& out) { write_obj(out, mesh); }), [](const std::string& b) { parse_surface(b, "m.obj"); }, 800);
  const Body body = small_body();
  mutate(
      bytes_of([&](auto& out) { write_ply(out, body.surface.two_sided()); }),
      [](const std::string& b) { Complex::from_two_sided(parse_surface(b, "m.ply").mesh); }, 300);
  mutate(
      bytes_of([&](auto& out) { write_pcd(out, body.nodes); }), [](const std::string& b) { parse_nodes(b, "n.pcd"); },
      1500);
  mutate(
      bytes_of([&](auto& out) { write_body(out, body); }), [](const std::string& b) { parse_body(b, "b.kerf"); }, 300);
  mutate(
      "front a\nstep 0\n0 0 0\n1 0 0\nstep 1\n0 0 1\n1 0 1\n", [](const std::string& b) { parse_fronts(b, "f.front"); },
      1500);
}

TEST_CASE("an output appears whole or not at all") {
  const auto folder = std::filesystem::temp_directory_path() / ("kerf-io-" + std::to_string(std::random_device{}()));
  std::filesystem::create_directory(folder);
  const std::string path = (folder / "out").string();
  write_all(path, [](std::ostream& out) { out << "first"; });
  CHECK_THROWS_AS(write_all(path,
                            [](std::ostream& out) {
                              out << "second";
                              throw GeometryError("no");
                            }),
                  GeometryError);
  CHECK(read_all(path) == "first");
  CHECK(std::distance(std::filesystem::directory_iterator(folder), {}) == 1);
  write_all(
      path, [](std::ostream& out) { out << "third"; }, Sync::by_system);
  CHECK(read_all(path) == "third");
  CHECK(std::distance(std::filesystem::directory_iterator(folder), {}) == 1);
  CHECK_NOTHROW(flush_to_disk(std::vector<std::string>{path, (folder / "taken away").string()}));
  CHECK_THROWS_AS(flush_to_disk(std::vector<std::string>{path + "/none"}), OutputError);
  CHECK_THROWS_AS(write_all("/dev/full", [](std::ostream& out) { out << "x"; }), OutputError);
  CHECK_THROWS_AS(write_all((folder / "none" / "out").string(), [](std::ostream& out) { out << "x"; }), OutputError);
  CHECK_THROWS_AS(read_all((folder / "missing").string()), MissingInputError);
  std::filesystem::remove_all(folder);
}

TEST_CASE("a level set is read as a closed surface") {
  const auto path =
      (std::filesystem::temp_directory_path() / ("kerf-" + std::to_string(std::random_device{}()) + ".vdb")).string();
  const TriangleMesh sphere = make_sphere(8);
  write_level_set(path, sphere, 0.08);
  const TriangleMesh read = read_volume(path);
  std::filesystem::remove(path);
  CHECK(signed_volume(read) == Approx(signed_volume(sphere)).epsilon(0.03));
  CHECK_NOTHROW(Complex::from_skin(read));
}

TEST_CASE("a run as USD has each frame's triangles where they are others than before, however many frames that is") {
  const auto [first, count] = seeds(20);
  for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(count); ++seed) {
    INFO("KERF_CASE=" << seed);
    Random random(seed);
    std::vector<TriangleMesh> frames(1 + random.below(50));
    for (std::size_t i = 0; i < frames.size(); ++i) {
      if (i == 0 || random.below(2) == 0) {
        for (std::size_t t = 0, triangles = 1 + random.below(3); t < triangles; ++t) {
          const auto a = static_cast<std::uint32_t>(random.below(3));
          frames[i].triangles.push_back({a, (a + 1) % 3, (a + 2) % 3});
          frames[i].patch.push_back(static_cast<std::int32_t>(random.below(2)));
        }
      } else {
        frames[i] = frames[i - 1];
      }
      frames[i].vertices.assign(3, Vec3(double(i), 0.5, -1e-3));
    }
    // The samples of each list at frames with new triangles. Equal samples are left out, and the
    // last one is repeated before the next change.
    std::string indices, patches, last[2];
    std::size_t written[2] = {0, 0};
    const auto add = [&](int which, std::string& text, std::size_t i, const std::string& list) {
      if (i > 0 && list == last[which]) return;
      if (i > written[which] + 1) text += "            " + std::to_string(i - 1) + ": [" + last[which] + "],\n";
      text += "            " + std::to_string(i) + ": [" + list + "],\n";
      last[which] = list;
      written[which] = i;
    };
    std::string points;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      std::string corners, patch;
      for (const Triangle& t : frames[i].triangles)
        for (const auto v : t) corners += (corners.empty() ? "" : ", ") + std::to_string(v);
      for (const auto one : frames[i].patch) patch += (patch.empty() ? "" : ", ") + std::to_string(one);
      add(0, indices, i, corners);
      add(1, patches, i, patch);
      const std::string point = "(" + std::to_string(i) + ", 0.5, -0.001)";
      points += "            " + std::to_string(i) + ": [" + point + ", " + point + ", " + point + "],\n";
    }
    const std::string text = bytes_of([&](std::ostream& out) {
      write_usda(out, {frames.size(), 24, 'Z', [&](std::size_t i) { return frames[i]; }, {}});
    });
    const auto has = [&](const std::string& declaration, const std::string& samples) {
      return text.find(declaration + ".timeSamples = {\n" + samples + "        }\n") != std::string::npos;
    };
    CHECK(has("point3f[] points", points));
    CHECK(has("int[] faceVertexIndices", indices));
    CHECK(has("int[] primvars:patch", patches));
  }
}
