// glTF: extensions that change a shape, skins, instances, quantised numbers, strips, sparse
// accessors; what is left out; materials from one .glb to the next.
#include <catch2/catch.hpp>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "io/images.h"
#include "io/samples.h"
#include "kerf/check.h"
#include "kerf/error.h"
#include "kerf/export.h"
#include "kerf/pieces.h"

using namespace geo;
using Json = nlohmann::json;

namespace {

SurfaceFile case_of(const std::string& name) { return read_surface(KERF_IO_CASES "/gltf/" + name); }

std::string bytes_of_case(const std::string& name) { return read_all(KERF_IO_CASES "/gltf/" + name); }

std::string refusal(const std::string& bytes) {
  try {
    parse_surface(bytes, "a.glb");
  } catch (const InputError& e) {
    return e.what();
  }
  return "read";
}

std::string joined(const std::vector<std::string>& notes) {
  std::string text;
  for (const std::string& note : notes) text += note + "\n";
  return text;
}

// A .glb of JSON and bytes.
std::string glb_of(const Json& json, const std::string& binary) {
  std::string text = json.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::string chunk = binary;
  chunk.resize((chunk.size() + 3) / 4 * 4);
  std::string bytes = "glTF";
  const auto put = [&](std::uint64_t x) {
    const auto word = static_cast<std::uint32_t>(x);
    bytes.append(reinterpret_cast<const char*>(&word), 4);
  };
  put(2);
  put(12 + 8 + text.size() + 8 + chunk.size());
  put(text.size());
  bytes += "JSON" + text;
  put(chunk.size());
  bytes += std::string("BIN\0", 4) + chunk;
  return bytes;
}

Json json_of(const std::string& glb) {
  std::uint32_t length = 0;
  REQUIRE(glb.size() > 20);
  std::memcpy(&length, glb.data() + 12, 4);
  return Json::parse(glb.substr(20, length));
}

// The bytes of a buffer view of a .glb.
std::string view_of(const std::string& glb, std::size_t view) {
  const Json json = json_of(glb);
  std::uint32_t length = 0;
  std::memcpy(&length, glb.data() + 12, 4);
  const Json& v = json["bufferViews"][view];
  return glb.substr(28 + length + v.value("byteOffset", 0u), v["byteLength"].get<std::size_t>());
}

// A glTF file in the making: a tetrahedron of edge 1 about the origin's corner, as mesh 0 of node
// 0.
struct Builder {
  Json json = {{"asset", {{"version", "2.0"}}},
               {"scenes", {{{"nodes", {0}}}}},
               {"nodes", {{{"mesh", 0}}}},
               {"accessors", Json::array()},
               {"bufferViews", Json::array()}};
  std::string binary;

  // Adds an accessor of rows of numbers of a component type; returns its index.
  template <class T>
  std::size_t add(const std::vector<T>& values, int component, const char* type, std::size_t count) {
    binary.resize((binary.size() + 3) / 4 * 4);
    json["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", values.size() * sizeof(T)}});
    binary.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    json["accessors"].push_back({{"bufferView", json["bufferViews"].size() - 1},
                                 {"componentType", component},
                                 {"type", type},
                                 {"count", count}});
    return json["accessors"].size() - 1;
  }
  Builder() {
    add<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, 5126, "VEC3", 4);
    add<std::uint16_t>({0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3}, 5123, "SCALAR", 12);
    json["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"indices", 1}}}}}};
  }
  Json& primitive() { return json["meshes"][0]["primitives"][0]; }
  Json& node(std::size_t i) { return json["nodes"][i]; }
  std::string bytes() {
    json["buffers"] = {{{"byteLength", binary.size()}}};
    return glb_of(json, binary);
  }
  SurfaceFile read() { return parse_surface(bytes(), "a.glb"); }
};

}  // namespace

TEST_CASE("quantised positions have the size that their nodes give them", "[gltf]") {
  const TriangleMesh box = case_of("quantised.glb").mesh;
  CHECK(bounding_box(box).lo.isApprox(Vec3(0, 0, 0)));
  CHECK(bounding_box(box).hi.isApprox(Vec3(2, 1, 1)));
  CHECK(signed_volume(box) == Approx(2));
  CHECK(check_surface(box, SelfIntersections::find).good());
  // Integers that are not normalised, with a scale of 1/8192 in their node, as a packer writes
  // them.
  const TriangleMesh packed = case_of("packq.glb").mesh;
  CHECK(bounding_box(packed).lo.isApprox(Vec3(4, -1, -1)));
  CHECK((bounding_box(packed).hi - Vec3(6, 1, 1)).norm() < 1e-3);
  CHECK(check_surface(packed, SelfIntersections::find).good());
}

TEST_CASE("normalised integers of all types are fractions", "[gltf]") {
  const auto volume = [](auto unit, int component) {
    Builder b;
    using T = decltype(unit);
    const std::size_t at = b.add<T>({0, 0, 0, unit, 0, 0, 0, unit, 0, 0, 0, unit}, component, "VEC3", 4);
    b.json["accessors"][at]["normalized"] = true;
    b.primitive()["attributes"]["POSITION"] = at;
    return signed_volume(b.read().mesh);
  };
  CHECK(volume(std::int8_t(127), 5120) == Approx(1.0 / 6));
  CHECK(volume(std::uint8_t(255), 5121) == Approx(1.0 / 6));
  CHECK(volume(std::int16_t(32767), 5122) == Approx(1.0 / 6));
  CHECK(volume(std::uint16_t(65535), 5123) == Approx(1.0 / 6));
}

TEST_CASE("each instance of a mesh is read, in its place", "[gltf]") {
  const TriangleMesh boxes = case_of("instances.glb").mesh;
  CHECK(boxes.triangles.size() == 36);
  CHECK(signed_volume(boxes) == Approx(3));
  Builder b;
  const double half = std::sqrt(0.5);
  const std::size_t at = b.add<float>({0, 0, 0, 10, 0, 0}, 5126, "VEC3", 2);
  const std::size_t turn = b.add<float>({0, 0, 0, 1, 0, 0, float(half), float(half)}, 5126, "VEC4", 2);
  const std::size_t scale = b.add<float>({1, 1, 1, 2, 2, 2}, 5126, "VEC3", 2);
  b.node(0)["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
      {"TRANSLATION", at}, {"ROTATION", turn}, {"SCALE", scale}};
  b.json["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
  const TriangleMesh two = b.read().mesh;
  CHECK(signed_volume(two) == Approx(1.0 / 6 + 8.0 / 6));
  CHECK((bounding_box(two).hi - Vec3(10, 2, 2)).norm() < 1e-6);  // turned about z: from x to y, from y to −x
  CHECK((bounding_box(two).lo - Vec3(0, 0, 0)).norm() < 1e-6);
}

TEST_CASE("vertices with a skin stand where their joints place them", "[gltf]") {
  const TriangleMesh box = case_of("skin.glb").mesh;  // its node is scaled by 100, which has no effect
  CHECK(bounding_box(box).hi.isApprox(Vec3(1, 1, 1)));
  CHECK(signed_volume(box) == Approx(1));
  Builder b;
  const std::size_t joints = b.add<std::uint8_t>({0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0}, 5121, "VEC4", 4);
  const std::size_t weights = b.add<float>({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0.5f, 0.5f, 0, 0}, 5126, "VEC4", 4);
  const std::size_t inverse = b.add<float>({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -3, 0, 0,  1,  //
                                            1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -3, 0, -4, 1},
                                           5126, "MAT4", 2);
  b.primitive()["attributes"]["JOINTS_0"] = joints;
  b.primitive()["attributes"]["WEIGHTS_0"] = weights;
  b.json["skins"] = {{{"joints", {1, 2}}, {"inverseBindMatrices", inverse}}};
  b.node(0)["skin"] = 0;
  b.node(0)["translation"] = {7, 7, 7};  // has no effect
  // The first joint has moved by 5 along y since the bind pose, the second also by 6 along z.
  b.json["nodes"].push_back({{"translation", {3, 5, 0}}, {"children", {2}}});
  b.json["nodes"].push_back({{"translation", {0, 0, 10}}});
  b.json["scenes"][0]["nodes"] = {0, 1};
  const TriangleMesh moved = b.read().mesh;
  CHECK(b.read().notes == std::vector<std::string>{"left out: 1 skin (applied)"});
  CHECK(bounding_box(moved).lo.isApprox(Vec3(0, 5, 0)));
  CHECK(bounding_box(moved).hi.isApprox(Vec3(1, 6, 4)));  // (0, 0, 1), half way between + 0 and + 6
  b.json["scenes"][0]["nodes"] = {0};
  CHECK_THAT(refusal(b.bytes()), Catch::Contains("joint that is not in the scene"));
}

TEST_CASE("strips, fans, sparse accessors and morph weights", "[gltf]") {
  Builder strip;
  const std::size_t corners = strip.add<std::uint8_t>({0, 2, 1, 3, 0, 2}, 5121, "SCALAR", 6);
  strip.primitive()["indices"] = corners;
  strip.primitive()["mode"] = 5;
  CHECK(signed_volume(strip.read().mesh) == Approx(1.0 / 6));
  CHECK(check_surface(strip.read().mesh, SelfIntersections::find).good());
  Builder fan;
  const std::size_t around = fan.add<std::uint32_t>({0, 2, 1, 3, 2}, 5125, "SCALAR", 5);
  const std::size_t last = fan.add<std::uint32_t>({1, 2, 3}, 5125, "SCALAR", 3);
  fan.primitive()["indices"] = around;
  fan.primitive()["mode"] = 6;
  fan.json["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", 0}}}, {"indices", last}});
  CHECK(signed_volume(fan.read().mesh) == Approx(1.0 / 6));
  CHECK(check_surface(fan.read().mesh, SelfIntersections::find).good());
  Builder sparse;
  const std::size_t which = sparse.add<std::uint8_t>({3}, 5121, "SCALAR", 1);
  const std::size_t values = sparse.add<float>({0, 0, 9}, 5126, "VEC3", 1);
  sparse.json["accessors"][0]["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", sparse.json["accessors"][which]["bufferView"]}, {"componentType", 5121}}},
      {"values", {{"bufferView", sparse.json["accessors"][values]["bufferView"]}}}};
  CHECK(signed_volume(sparse.read().mesh) == Approx(9.0 / 6));
  Builder morph;
  const std::size_t change = morph.add<float>({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 4}, 5126, "VEC3", 4);
  morph.primitive()["targets"] = {{{"POSITION", change}}};
  CHECK(signed_volume(morph.read().mesh) == Approx(1.0 / 6));
  CHECK(morph.read().notes == std::vector<std::string>{"left out: 1 morph target without weight"});
  morph.json["meshes"][0]["weights"] = {0.5};
  CHECK(signed_volume(morph.read().mesh) == Approx(3.0 / 6));
  CHECK(morph.read().notes.empty());
}

TEST_CASE("an extension that is not known is named, compressed files before anything else", "[gltf]") {
  CHECK_THAT(refusal(bytes_of_case("meshopt.glb")),
             Catch::Contains("requires the glTF extension EXT_meshopt_compression") && Catch::Contains("; save it"));
  for (const std::string name : {"KHR_draco_mesh_compression", "VENDOR_new_shapes"}) {
    Builder b;
    b.json["extensionsRequired"] = {name};
    CHECK_THAT(refusal(b.bytes()), Catch::Contains("requires the glTF extension " + name));
    Builder used;
    used.json["extensionsUsed"] = {name};
    CHECK(used.read().mesh.triangles.size() == 4);
  }
  // Without an uncompressed copy, the data are compressed whatever the lists say.
  Builder draco;
  draco.primitive()["extensions"]["KHR_draco_mesh_compression"] = {{"bufferView", 0},
                                                                   {"attributes", {{"POSITION", 0}}}};
  CHECK(draco.read().mesh.triangles.size() == 4);
  draco.json["accessors"][0].erase("bufferView");
  CHECK_THAT(refusal(draco.bytes()), Catch::Contains("KHR_draco_mesh_compression alone"));
  Json json = json_of(bytes_of_case("meshopt.glb"));
  json.erase("extensionsRequired");
  CHECK_THAT(refusal(glb_of(json, std::string(200, '\0'))), Catch::Contains("EXT_meshopt_compression alone"));
}

TEST_CASE("a line says what is left out of a glTF file", "[gltf]") {
  Builder b;
  CHECK(b.read().notes.empty());
  b.json["cameras"] = {{{"type", "perspective"}}, {{"type", "perspective"}}};
  b.json["animations"] = {{{"name", "walk"}}};
  b.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
  b.json["extensionsUsed"] = {"KHR_lights_punctual", "VENDOR_shine"};
  b.json["scenes"].push_back({{"nodes", Json::array()}});
  b.json["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", 0}}}, {"mode", 1}});
  b.json["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", 0}}}, {"mode", 0}});
  b.primitive()["attributes"]["_HEAT"] = 0;
  b.json["nodes"].push_back({{"mesh", 0}, {"name", "UCX_hull"}});
  b.json["nodes"].push_back({{"mesh", 0}, {"extensions", {{"KHR_node_visibility", {{"visible", false}}}}}});
  b.node(0)["children"] = {1, 2};
  const SurfaceFile file = b.read();
  CHECK(file.mesh.triangles.size() == 4);
  CHECK(file.notes ==
        std::vector<std::string>{
            "left out: 1 other scene, 1 mesh of points, 1 mesh of lines, 1 collision shape, 1 hidden mesh, 2 cameras, "
            "1 light, 1 animation, attribute _HEAT, extension VENDOR_shine"});
}

TEST_CASE("damaged descriptions of glTF are refused in one line", "[gltf]") {
  const auto said = [](const char* pointer, const Json& value) {
    Builder b;
    b.bytes();
    b.json[Json::json_pointer(pointer)] = value;
    return refusal(glb_of(b.json, b.binary));
  };
  CHECK_THAT(said("/asset/version", "1.0"), Catch::Contains("version '1.0'; save it as glTF 2.0"));
  CHECK_THAT(said("/accessors/0/count", 5), Catch::Contains("exceeds its buffer view"));
  CHECK_THAT(said("/accessors/0/count", 1e15), Catch::Contains("whole number"));
  CHECK_THAT(said("/accessors/0/count", 1000000000), Catch::Contains("exceeds its buffer view"));
  CHECK_THAT(said("/accessors/0/componentType", 5124), Catch::Contains("unknown type"));
  CHECK_THAT(said("/bufferViews/0/byteLength", 4096), Catch::Contains("exceeds its buffer"));
  CHECK_THAT(said("/bufferViews/0/byteStride", 2), Catch::Contains("byteStride"));
  CHECK_THAT(said("/nodes/0/children", {0}), Catch::Contains("below itself"));
  CHECK_THAT(said("/nodes/0/mesh", 3), Catch::Contains("names entry 3 of its 'meshes', but there are 1"));
  CHECK_THAT(said("/nodes/0/matrix", {1, 2}), Catch::Contains("a list of 16 numbers"));
  CHECK_THAT(said("/meshes/0/primitives/0/mode", 9), Catch::Contains("unknown mode"));
  CHECK_THAT(said("/materials", {3}), Catch::Contains("read"));
}

TEST_CASE("materials, images and both texture coordinates go from one .glb to the next", "[gltf]") {
  const std::string model = bytes_of_case("prop.glb");
  SurfaceFile file = parse_surface(model, "prop.glb");
  CHECK(file.notes.empty());
  CHECK(file.mesh.unit == 1);
  CHECK(file.mesh.attributes.group_names == std::vector<std::string>{"Oak", "Paint"});
  // Through a .ply, a cut, and pieces.
  file = parse_surface(bytes_of([&](auto& out) { write_ply(out, file.mesh); }), "prop.ply");
  const Complex uncut = Complex::from_two_sided(file.mesh);
  Complex complex = uncut;
  TriangleMesh sheet;
  sheet.vertices = {{0.4, -1, -1}, {0.5, 3, -1}, {0.6, -1, 3}};
  sheet.triangles = {{0, 1, 2}};
  insert_sheet(complex, sheet, 1, {});
  const Pieces found = find_pieces(complex);
  REQUIRE(found.count == 2);
  TriangleMesh cut = complex.two_sided();
  transfer_attributes(file.mesh, cut);
  const SurfaceFile broken = parse_surface(bytes_of([&](auto& out) { write_ply(out, cut); }), "broken.ply");
  CHECK(broken.notes.empty());
  const Complex again = Complex::from_two_sided(broken.mesh);
  const Pieces parts = find_pieces(again);
  const auto chunks = make_chunks(again, parts, broken.mesh, 0.25);
  const std::string glb = bytes_of([&](auto& out) {
    write_glb(out, chunks, find_bonds(again, parts), {"node", piece_names(parts.count), 1});
  });
  const Json before = json_of(model), after = json_of(glb);
  REQUIRE(after["materials"].size() == 3);
  for (int i = 0; i < 2; ++i) CHECK(after["materials"][i] == before["materials"][i]);
  CHECK(after["materials"][2]["name"] == "crack");
  REQUIRE(after["images"].size() == 1);
  CHECK(after["images"][0]["mimeType"] == "image/png");
  CHECK(view_of(glb, after["images"][0]["bufferView"]) == view_of(model, 6));
  CHECK(after["textures"][0]["source"] == 0);
  for (const Json& mesh : after["meshes"])
    for (const Json& primitive : mesh["primitives"]) {
      CHECK(primitive["attributes"].contains("TEXCOORD_0"));
      CHECK(primitive["attributes"].contains("TEXCOORD_1"));
      CHECK(primitive["material"].get<std::size_t>() < 3);
    }
  // The written file is read as the model was, and no texture coordinate has changed at an old
  // vertex.
  const TriangleMesh last = parse_surface(glb, "pieces.glb").mesh;
  CHECK(last.attributes.group_names == std::vector<std::string>{"Oak", "Paint", "crack"});
  std::size_t same = 0;
  for (std::size_t t = 0; t < last.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t s = 0; s < file.mesh.triangles.size(); ++s)
        for (std::size_t j = 0; j < 3 && last.attributes.group[t] < 2; ++j) {
          if ((last.vertices[last.triangles[t][k]] - file.mesh.vertices[file.mesh.triangles[s][j]]).norm() > 1e-6)
            continue;
          same += (last.attributes.uv[t][k] - file.mesh.attributes.uv[s][j]).norm() < 1e-6 &&
                  (last.attributes.uv2[t][k] - file.mesh.attributes.uv2[s][j]).norm() < 1e-6;
        }
  CHECK(same > 500);
}

TEST_CASE("all that a material names comes with it: textures, samplers, images, extensions", "[gltf]") {
  Builder b;
  const std::string png = whole_png(2, "first"), jpeg = whole_jpeg(" second "), webp = "RIFF____WEBP third";
  b.primitive()["material"] = 1;
  b.primitive()["attributes"]["TEXCOORD_0"] = b.add<float>({0, 0, 1, 0, 0, 1, 1, 1}, 5126, "VEC2", 4);
  b.primitive()["attributes"]["TEXCOORD_1"] = b.add<float>({0, 0, 1, 0, 0, 1, 1, 1}, 5126, "VEC2", 4);
  b.json["images"] = Json::array();
  for (const std::string& image : {png, jpeg, webp}) {
    b.add(std::vector<char>(image.begin(), image.end()), 5121, "SCALAR", image.size());
    b.json["images"].push_back({{"bufferView", b.json["bufferViews"].size() - 1}});
  }
  b.json["images"][1]["mimeType"] = "image/jpeg";
  b.json["samplers"] = {{{"wrapS", 33071}}, {{"wrapS", 10497}}};
  b.json["textures"] = {{{"source", 0}},
                        {{"source", 1}, {"sampler", 1}, {"name", "bark"}},
                        {{"extensions", {{"EXT_texture_webp", {{"source", 2}}}}}}};
  b.json["materials"] = {
      {{"name", "other"}},
      {{"name", "Tree"},
       {"alphaMode", "MASK"},
       {"alphaCutoff", 0.25},
       {"emissiveFactor", {0.5, 0, 0}},
       {"occlusionTexture", {{"index", 1}, {"texCoord", 1}, {"strength", 0.5}}},
       {"normalTexture", {{"index", 1}, {"scale", 2}}},
       {"extensions",
        {{"KHR_materials_clearcoat", {{"clearcoatTexture", {{"index", 2}}}}}, {"VENDOR_shine", {{"power", 3}}}}}}};
  b.json["extensionsUsed"] = {"EXT_texture_webp", "KHR_materials_clearcoat"};
  b.json["extensionsRequired"] = {"EXT_texture_webp"};
  const SurfaceFile file = b.read();
  CHECK(file.notes.empty());
  const std::string glb = bytes_of([&](auto& out) {
    write_glb(out, {{file.mesh, 1.0 / 6, Vec3(0.25, 0.25, 0.25)}}, {}, {"node", {"piece_000"}, 1});
  });
  const Json json = json_of(glb);
  REQUIRE(json["materials"].size() == 1);
  const Json& tree = json["materials"][0];
  CHECK(tree["alphaCutoff"] == 0.25);
  CHECK(tree["emissiveFactor"] == b.json["materials"][1]["emissiveFactor"]);
  CHECK(tree["normalTexture"]["scale"] == 2);
  CHECK(tree["occlusionTexture"]["texCoord"] == 1);
  CHECK(tree["extensions"]["VENDOR_shine"]["power"] == 3);
  const auto image_of = [&](const Json& source) { return json["images"][source.get<std::size_t>()]; };
  const auto texture_of = [&](const Json& use) { return json["textures"][use["index"].get<std::size_t>()]; };
  const Json bark = texture_of(tree["normalTexture"]);
  CHECK(bark["name"] == "bark");
  CHECK(bark == texture_of(tree["occlusionTexture"]));
  CHECK(json["samplers"][bark["sampler"].get<std::size_t>()]["wrapS"] == 10497);
  CHECK(view_of(glb, image_of(bark["source"])["bufferView"]) == jpeg);
  const Json coat = texture_of(tree["extensions"]["KHR_materials_clearcoat"]["clearcoatTexture"]);
  const Json third = image_of(coat["extensions"]["EXT_texture_webp"]["source"]);
  CHECK(third["mimeType"] == "image/webp");
  CHECK(view_of(glb, third["bufferView"]) == webp);
  CHECK(json["images"].size() == 2);  // nothing names the first one
  CHECK(json["extensionsRequired"] == Json{"EXT_texture_webp"});
  const std::set<std::string> used = json["extensionsUsed"];
  CHECK(used == std::set<std::string>{"EXT_texture_webp", "KHR_materials_clearcoat", "VENDOR_shine"});
}

TEST_CASE("materials of equal or no names are groups of their own, and names survive text formats", "[gltf]") {
  Builder b;
  b.primitive()["material"] = 0;
  b.json["materials"] = {{{"name", " Oak  one\t"}}, {{"name", "Oak one"}}, Json::object(), {{"name", "unused"}}};
  for (const int material : {1, 2})
    b.json["meshes"][0]["primitives"].push_back(
        {{"attributes", {{"POSITION", 0}}}, {"indices", 1}, {"material", material}});
  b.json["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", 0}}}, {"indices", 1}});
  const SurfaceFile file = b.read();
  const std::vector<std::string> names = {"Oak one", "Oak one_2", "material_2", "default"};
  CHECK(file.mesh.attributes.group_names == names);
  CHECK(file.mesh.attributes.group == std::vector<std::int32_t>{0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3});
  const SurfaceFile again = parse_surface(bytes_of([&](auto& out) { write_ply(out, file.mesh); }), "a.ply");
  CHECK(again.mesh.attributes.group_names == names);
  CHECK(again.mesh.attributes.library == file.mesh.attributes.library);
  const Json library = json_of(*file.mesh.attributes.library.glb);
  REQUIRE(library["materials"].size() == 3);
  CHECK(library["materials"][2]["name"] == "material_2");
}

TEST_CASE("many nodes that share a mesh are read once, and their number is bounded", "[gltf]") {
  Builder b;
  const std::size_t count = 3000;
  std::vector<float> at;
  for (std::size_t i = 0; i < count; ++i) at.insert(at.end(), {float(2 * i), 0, 0});
  b.node(0)["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] = b.add(at, 5126, "VEC3", count);
  CHECK(b.read().mesh.triangles.size() == 4 * count);
  // Each node of a chain names the next one twice: 2^30 visits.
  Builder doubled;
  doubled.json["nodes"] = Json::array();
  for (int i = 0; i < 30; ++i) doubled.json["nodes"].push_back({{"children", {i + 1, i + 1}}});
  doubled.json["nodes"].push_back({{"mesh", 0}});
  CHECK_THAT(refusal(doubled.bytes()), Catch::Contains("more than a million nodes"));
}

TEST_CASE("an image that is damaged, or not there, is left out with the textures that use it", "[gltf]") {
  const std::string whole = whole_png(2, "first");
  const auto read = [&](const std::string& bytes) {
    Builder b;
    b.primitive()["material"] = 0;
    b.primitive()["attributes"]["TEXCOORD_0"] = b.add<float>({0, 0, 1, 0, 0, 1, 1, 1}, 5126, "VEC2", 4);
    b.add(std::vector<char>(bytes.begin(), bytes.end()), 5121, "SCALAR", bytes.size());
    b.json["images"] = {{{"bufferView", b.json["bufferViews"].size() - 1}, {"name", "brick"}}, {{"uri", "gone.png"}}};
    b.json["textures"] = {{{"source", 0}}, {{"source", 1}}};
    b.json["materials"] = {{{"name", "Wall"},
                            {"normalTexture", {{"index", 1}}},
                            {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}, {"metallicFactor", 0.5}}}}};
    return b.read();
  };
  CHECK(joined(read(whole).notes) == "left out: image gone.png, which is not in its folder\n");
  for (const auto& [bytes, fault] : std::vector<std::pair<std::string, std::string>>{
           {whole.substr(0, 40), "is cut off"}, {"a text", "is no PNG or JPEG"}}) {
    const SurfaceFile file = read(bytes);
    CHECK(joined(file.notes) ==
          "left out: image brick, which " + fault + ", image gone.png, which is not in its folder\n");
    REQUIRE(file.mesh.attributes.library.glb);
    const Json json = json_of(*file.mesh.attributes.library.glb);
    CHECK(json["materials"][0] == Json{{"name", "Wall"}, {"pbrMetallicRoughness", {{"metallicFactor", 0.5}}}});
    CHECK_FALSE(json.contains("images"));
  }
}

TEST_CASE("a texture that no texture coordinates place is left out with a word", "[gltf]") {
  Builder b;
  b.primitive()["material"] = 0;
  b.json["materials"] = {{{"name", "Wood"}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  b.json["textures"] = {{{"source", 0}}};
  b.json["images"] = {
      {{"uri",
        "data:image/"
        "png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAAAAAA6fptVAAAACklEQVR4nGNoAAAAggCBd81ytgAAAABJRU5ErkJggg=="}}};
  CHECK_THAT(joined(b.read().notes), Catch::Contains("1 texture without texture coordinates"));
  b.primitive()["attributes"]["TEXCOORD_0"] = b.add<float>({0, 0, 1, 0, 0, 1, 1, 1}, 5126, "VEC2", 4);
  const SurfaceFile file = b.read();
  CHECK(file.notes.empty());
  CHECK(file.mesh.attributes.uv[0][1] == Vec2(0, 0));  // of (0, 1): v from the bottom
  REQUIRE(file.mesh.attributes.library.glb);
  CHECK_THAT(*file.mesh.attributes.library.glb, Catch::Contains("\x89PNG"));
}
