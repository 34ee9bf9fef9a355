// Surfaces in formats of other programs: glTF written here and by hand, COLLADA, damaged files.
#include <unistd.h>
#include <algorithm>
#include <catch2/catch.hpp>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "cases.h"
#include "io/in_child.h"
#include "io/mutate.h"
#include "io/samples.h"
#include "kerf/check.h"
#include "kerf/error.h"
#include "kerf/export.h"

using namespace geo;

namespace {

std::string glb_of(const std::vector<Chunk>& chunks, const GlbOptions& options = {}) {
  ChunkLabels labels{"node", {}, 1};
  for (std::size_t i = 0; i < chunks.size(); ++i) labels.names.push_back("piece_" + std::to_string(i));
  return bytes_of([&](auto& out) { write_glb(out, chunks, {}, labels, options); });
}

// A block whose corners have texture coordinates and colours, with a group for each half.
Chunk colored_block() {
  Chunk chunk{make_block({2, 1, 1}, 0.5), 2, {1, 0.5, 0.5}};
  Attributes& a = chunk.mesh.attributes;
  a.group_names = {"left", "right"};
  for (const auto& t : chunk.mesh.triangles) {
    std::array<Vec2, 3> uv;
    std::array<Color, 3> color;
    Vec3 middle = Vec3::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& p = chunk.mesh.vertices[t[k]];
      uv[k] = {p.x() / 4, p.y() + p.z() / 8};
      color[k] = {p.x() / 2, p.y(), p.z(), 1};
      middle += p / 3;
    }
    a.uv.push_back(uv);
    a.color.push_back(color);
    a.group.push_back(middle.x() > 1);
  }
  return chunk;
}

class Folder {
 public:
  Folder() : path(std::filesystem::temp_directory_path() / ("kerf-other-" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(path / "in");
  }
  ~Folder() { std::filesystem::remove_all(path); }
  void write(const std::string& name, const std::string& bytes) const {
    std::ofstream(path / name, std::ios::binary) << bytes;
  }
  const std::filesystem::path path;
};

// A tetrahedron of volume 1/6 as the buffer of a glTF file: four points, then twelve indices.
std::string tetrahedron() {
  const float points[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  const std::uint16_t corners[12] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  std::string bytes(sizeof points + sizeof corners, '\0');
  std::memcpy(bytes.data(), points, sizeof points);
  std::memcpy(bytes.data() + sizeof points, corners, sizeof corners);
  return bytes;
}

// glTF with the nodes given, and the tetrahedron from `buffer` as mesh 0.
std::string gltf(const std::string& nodes, const std::string& buffer) {
  return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [)" + nodes +
         R"(], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0,0,0], "max": [1,1,1]},
                  {"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"}],
    "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 24}],
    "buffers": [{"byteLength": 72, "uri": ")" +
         buffer + "\"}]}";
}

std::string refusal(const std::string& bytes, const std::string& name) {
  try {
    parse_surface(bytes, name);
  } catch (const InputError& e) {
    return e.what();
  }
  return "read";
}

}  // namespace

TEST_CASE("a .glb of pieces is read back: places, texture coordinates, colours, groups, without hulls") {
  const Chunk chunk = colored_block();
  const bool z_up = GENERATE(false, true);
  const TriangleMesh mesh = parse_surface(glb_of({chunk}, {8, 1, z_up}), "a.glb").mesh;
  CHECK(check_surface(mesh, SelfIntersections::find).good());
  CHECK(mesh.vertices.size() == chunk.mesh.vertices.size());
  CHECK(signed_volume(mesh) == Approx(2));
  CHECK(mesh.attributes.group_names == chunk.mesh.attributes.group_names);
  REQUIRE(mesh.triangles.size() == chunk.mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      Vec3 p = mesh.vertices[mesh.triangles[t][k]];
      if (z_up) p = Vec3(p.x(), -p.z(), p.y());
      CHECK((mesh.attributes.uv[t][k] - Vec2(p.x() / 4, p.y() + p.z() / 8)).norm() < 1e-6);
      CHECK((mesh.attributes.color[t][k] - Color(p.x() / 2, p.y(), p.z(), 1)).norm() < 1e-4);
      const double x = (mesh.vertices[mesh.triangles[t][0]].x() + mesh.vertices[mesh.triangles[t][1]].x() +
                        mesh.vertices[mesh.triangles[t][2]].x()) /
                       3;
      CHECK(mesh.attributes.group[t] == (x > 1));
    }
}

TEST_CASE("nodes place their meshes, below each other, several times and mirrored") {
  const Folder folder;
  folder.write("data.bin", tetrahedron());
  // Scaled by 2, volume 8/6; its child is mirrored and moved by (10, 0, 0) before that.
  folder.write("a.gltf", gltf(R"({"mesh": 0, "scale": [2, 2, 2], "children": [1]},
                                 {"mesh": 0, "scale": [-1, 1, 1], "translation": [10, 0, 0]})",
                              "data.bin"));
  const TriangleMesh mesh = read_surface((folder.path / "a.gltf").string()).mesh;
  CHECK(mesh.triangles.size() == 8);
  CHECK(check_surface(mesh, SelfIntersections::find).good());
  CHECK(signed_volume(mesh) == Approx(16.0 / 6));
  CHECK(bounding_box(mesh).hi.isApprox(Vec3(20, 2, 2)));
  CHECK(mesh.attributes.empty());
}

TEST_CASE("a file may name files of its own folder alone") {
  const Folder folder;
  const std::string node = R"({"mesh": 0})";
  folder.write("secret.bin", tetrahedron());
  folder.write("in/beside.bin", tetrahedron());
  const std::string name = (folder.path / "in" / "a.gltf").string();
  CHECK(parse_surface(gltf(node, "beside.bin"), name).mesh.triangles.size() == 4);
  CHECK_THAT(refusal(gltf(node, "../secret.bin"), name), Catch::Contains("secret.bin"));
  CHECK_THAT(refusal(gltf(node, (folder.path / "secret.bin").string()), name), Catch::Contains("secret.bin"));
  CHECK_THAT(refusal(gltf(node, "none.bin"), name), Catch::Contains("none.bin"));
}

TEST_CASE("a format is known by the first bytes, else by the ending") {
  const std::string lines = "0\nSECTION\n2\nENTITIES\n", face = "0\n3DFACE\n8\n0\n", end = "0\nENDSEC\n0\nEOF\n";
  const std::string corners = "10\n0\n20\n0\n30\n0\n11\n1\n21\n0\n31\n0\n12\n0\n22\n1\n32\n0\n13\n0\n23\n1\n33\n0\n";
  CHECK(parse_surface(lines + face + corners + end, "a.dxf").mesh.triangles.size() == 1);
  CHECK_THAT(refusal("BLENDER-v300", "a.blend"), Catch::Contains("a Blender file") && Catch::Contains("save it as"));
  CHECK_THAT(refusal("Kaydara FBX Binary  ", "a"), Catch::Contains("a: assimp cannot read it"));
  CHECK_THAT(refusal("<?xml version=\"1.0\"?><nothing/>", "a.dae"), Catch::Contains("an XML file"));
  CHECK_THAT(refusal("{\"a\": 1}", "a.json"), Catch::Contains("a JSON file"));
}

TEST_CASE("damaged files of other programs are read or refused in one line", "[fuzz]") {
  Random random(2026);
  const std::string glb = glb_of({colored_block()}, {8, 1, true}), text = gltf(R"({"mesh": 0})", "data.bin");
  std::vector<std::string> all = {glb, text};
  for (const auto& entry : std::filesystem::directory_iterator(KERF_IO_CASES "/gltf"))
    all.push_back(read_all(entry.path().string()));
  std::sort(all.begin(), all.end());  // the order in a folder may change
  int refused = 0;
  for (int i = 0; i < 100 * cases(9); ++i) {
    Mutator mutator(random);
    const std::string bytes = mutator.damaged(all[static_cast<std::size_t>(i) % all.size()], all);
    const std::string said = refusal(bytes, "a.glb");
    INFO("case " << i << ": " << said);
    CHECK(said.find('\n') == said.npos);
    CHECK(said.size() < 500);
    refused += said != "read";
  }
  CHECK(refused > 300);
}

TEST_CASE("code in a child process may crash, loop, eat memory and throw") {
  CHECK(in_child([](auto& out) { out << std::string(1 << 20, 'x'); }, {}) == std::string(1 << 20, 'x'));
  CHECK_THROWS_WITH(in_child([](auto&) { std::raise(SIGSEGV); }, {}), Catch::Contains("crashes"));
  CHECK_THROWS_WITH(in_child([](auto&) { throw InputError("told"); }, {}), "told");
  const auto eat = [](auto& out) {
    std::vector<std::string> all;
    for (int i = 0; i < 64; ++i) all.push_back(std::string(64 << 20, 'x'));
    out << all.size();
  };
  CHECK_THROWS_AS(in_child(eat, {256 << 20, 30}), ChildFailure);
  const auto loop = [](auto& out) {
    for (volatile unsigned i = 0;;) {
      const unsigned next = i + 1;
      i = next;
      if (next == 0) out << next;
    }
  };
  CHECK_THROWS_WITH(in_child(loop, {1 << 30, 1}), Catch::Contains("longer than"));
}
