// Materials in formats other than glTF: .mtl files read and written, USD's preview surfaces.
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "io/fuzz.h"
#include "io/images.h"
#include "io/preview_material.h"
#include "kerf/appearance.h"
#include "kerf/check.h"
#include "kerf/error.h"
#include "kerf/export.h"
#include "kerf/files.h"
#include "samples.h"

using namespace geo;

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

// A folder that is removed at the end.
class Folder {
 public:
  Folder() : path_(fs::temp_directory_path() / ("kerf-materials-" + std::to_string(::getpid()))) {
    fs::remove_all(path_);
    fs::create_directories(path_ / "model" / "textures");
  }
  ~Folder() { fs::remove_all(path_); }
  std::string at(const std::string& name) const { return (path_ / "model" / name).string(); }
  void write(const std::string& name, const std::string& bytes) const { std::ofstream(at(name)) << bytes; }

 private:
  fs::path path_;
};

std::string obj_with(const std::string& statements) {
  return statements +
         "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl bark\nf 1/1 3/3 2/2\nf 1/1 2/2 4/3\n"
         "usemtl old leaf\nf 2/1 3/2 4/3\nf 3/1 1/2 4/3\n";
}

Json library_json(const TriangleMesh& mesh) {
  REQUIRE(mesh.attributes.library.glb);
  const std::string& glb = *mesh.attributes.library.glb;
  std::uint32_t length = 0;
  std::memcpy(&length, glb.data() + 12, 4);
  return Json::parse(glb.substr(20, length));
}

std::string lines(const std::vector<std::string>& notes) {
  std::string text;
  for (const std::string& note : notes) text += note + '\n';
  return text;
}

const std::string tree_mtl =
    "newmtl bark\nKd 0.25 0.5 0.75\nNs 250\nPm 0.125\nd 0.5\nKe 2 1 0\nPc 0.5\nPcr 0.25\n"
    "map_Kd -s 2 3 -o 0.25 0.5 0 -clamp on textures\\big bark.png\nmap_d -imfchan m textures\\big bark.png\n"
    "map_Pr -imfchan g surface.png\nmap_Pm -imfchan b surface.png\nnorm -bm 0.5 bumps.png\n"
    "newmtl old leaf\nKd 0 1 0\nPr 0.3\nmap_Ks none.png\nbump heights.png\n"
    "newmtl unused\nmap_Kd missing.png\n";

void write_tree(const Folder& folder) {
  folder.write("textures/big bark.png", whole_png(2, "bark"));
  folder.write("surface.png", whole_png(2, "surface"));
  folder.write("bumps.png", whole_png(2, "bumps"));
  folder.write("heights.png", whole_png(0, "heights"));
  folder.write("tree.mtl", tree_mtl);
  folder.write("tree.obj", obj_with("mtllib tree.mtl\n"));
}

std::set<std::string> names_in(const std::string& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename().string());
  return names;
}

}  // namespace

TEST_CASE("an .mtl becomes a library with factors, textures and images", "[materials]") {
  const Folder folder;
  write_tree(folder);
  const SurfaceFile file = read_surface(folder.at("tree.obj"));
  CHECK(lines(file.notes) == "left out of its materials: bump of heights, map_Ks\n");
  const Json json = library_json(file.mesh);
  REQUIRE(json["materials"].size() == 2);  // nothing has the third one
  const Json &bark = json["materials"][0], &pbr = bark["pbrMetallicRoughness"];
  CHECK(bark["name"] == "bark");
  CHECK(pbr["baseColorFactor"] == Json({0.25, 0.5, 0.75, 0.5}));
  CHECK(pbr["metallicFactor"] == 0.125);
  CHECK(pbr["roughnessFactor"] == 1);  // the texture's own
  CHECK(bark["alphaMode"] == "BLEND");
  CHECK(bark["emissiveFactor"] == Json({1, 0.5, 0}));
  CHECK(bark["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] == 2);
  CHECK(bark["extensions"]["KHR_materials_clearcoat"]["clearcoatFactor"] == 0.5);
  CHECK(bark["normalTexture"]["scale"] == 0.5);
  // v is turned: 1 - (3 (1 - v) + 0.5) = 3 v - 2.5.
  const Json& moved = pbr["baseColorTexture"]["extensions"]["KHR_texture_transform"];
  CHECK(moved["scale"] == Json({2, 3}));
  CHECK(moved["offset"] == Json({0.25, -2.5}));
  const Json& base = json["textures"][pbr["baseColorTexture"]["index"].get<std::size_t>()];
  CHECK(json["samplers"][base["sampler"].get<std::size_t>()]["wrapS"] == 33071);
  CHECK(json["images"][base["source"].get<std::size_t>()]["name"] == "big bark");
  CHECK(json["images"].size() == 3);  // without the grey one
  const std::set<std::string> used = json["extensionsUsed"];
  CHECK(used ==
        std::set<std::string>{"KHR_materials_clearcoat", "KHR_materials_emissive_strength", "KHR_texture_transform"});
  const Json& leaf = json["materials"][1];
  CHECK(leaf["name"] == "old leaf");
  CHECK(leaf["pbrMetallicRoughness"]["roughnessFactor"] == 0.3);
  CHECK_FALSE(leaf.contains("normalTexture"));
}

TEST_CASE("roughness without a statement of it follows the highlight", "[materials]") {
  const Folder folder;
  folder.write("tree.mtl", "newmtl bark\nNs 250\nnewmtl old leaf\nTr 0.25\n");
  folder.write("tree.obj", obj_with("mtllib tree.mtl\n"));
  const Json json = library_json(read_surface(folder.at("tree.obj")).mesh);
  CHECK(json["materials"][0]["pbrMetallicRoughness"]["roughnessFactor"] == 0.5);
  CHECK(json["materials"][1]["pbrMetallicRoughness"]["baseColorFactor"][3] == 0.75);
}

TEST_CASE("files that are not there, or not in the folder, are told in a line", "[materials]") {
  const Folder folder;
  folder.write("tree.obj", obj_with("mtllib gone.mtl\n"));
  const SurfaceFile none = read_surface(folder.at("tree.obj"));
  CHECK(lines(none.notes) == "names gone.mtl, not in its folder; materials of it have names only\n");
  CHECK_FALSE(none.mesh.attributes.library.glb);
  CHECK(none.mesh.attributes.group_names == std::vector<std::string>{"bark", "old leaf"});

  folder.write("../outside.png", whole_png(2, "secret"));
  folder.write("../outside.mtl", "newmtl bark\nKd 1 0 0\n");
  folder.write("tree.obj", obj_with("mtllib ../outside.mtl\n"));
  CHECK_FALSE(read_surface(folder.at("tree.obj")).mesh.attributes.library.glb);
  folder.write("tree.mtl", "newmtl bark\nKd 1 0 0\nmap_Kd ../outside.png\nnewmtl old leaf\n");
  folder.write("tree.obj", obj_with("mtllib tree.mtl\n"));
  const SurfaceFile outside = read_surface(folder.at("tree.obj"));
  CHECK(lines(outside.notes) == "left out: textures not in its folder: ../outside.png\n");
  CHECK(outside.mesh.attributes.library.glb->find("secret") == std::string::npos);
  // A path of another machine is looked for by its last name, in the folder and in textures/.
  folder.write("tree.mtl", "newmtl bark\nmap_Kd C:\\work\\bark.png\n");
  folder.write("textures/bark.png", whole_png(2, "bark"));
  CHECK(library_json(read_surface(folder.at("tree.obj")).mesh)["images"].size() == 1);
}

TEST_CASE("an image that is damaged or empty, and a material without a description, are named", "[materials]") {
  const Folder folder;
  const std::string whole = whole_png(2, "bark");
  folder.write("tree.mtl", "newmtl bark\nmap_Kd bark.png\n");
  folder.write("tree.obj", obj_with("mtllib tree.mtl\n"));
  const std::string unknown = "names materials that its .mtl does not describe, and which stay names: old leaf\n";
  folder.write("bark.png", whole);
  CHECK(lines(read_surface(folder.at("tree.obj")).notes) == unknown);
  for (const auto& [bytes, fault] : std::vector<std::pair<std::string, std::string>>{
           {whole.substr(0, whole.size() - 9), "is cut off"}, {"", "is empty"}, {"text", "is no PNG or JPEG"}}) {
    folder.write("bark.png", bytes);
    const SurfaceFile file = read_surface(folder.at("tree.obj"));
    CHECK(lines(file.notes) == "left out of its materials: image bark.png, which " + fault + "\n" + unknown);
    CHECK_FALSE(library_json(file.mesh).contains("images"));
  }
}

TEST_CASE("texture coordinates that name no place are put at 0 and counted", "[materials]") {
  const Folder folder;
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0.5 0.25\n";
  for (const char* wild : {"nan 0", "0 inf", "1e30 0", "0 -2e7"}) {
    folder.write("wild.obj", corners + "vt " + wild + "\nf 1/1 3/2 2/1\nf 1/1 2/1 4/1\nf 1/1 4/1 3/1\nf 2/1 3/2 4/1\n");
    const SurfaceFile file = read_surface(folder.at("wild.obj"));
    CHECK(lines(file.notes) ==
          "has 2 corners with texture coordinates that are not finite or above 2^24; they are put at 0, 0\n");
    for (const auto& row : file.mesh.attributes.uv)
      for (const Vec2& uv : row) CHECK((uv == Vec2(0.5, 0.25) || uv == Vec2(0, 0)));
  }
  folder.write("far.obj", corners + "vt 16777216 0\nf 1/1 3/2 2/1\nf 1/1 2/1 4/1\nf 1/1 4/1 3/1\nf 2/1 3/2 4/1\n");
  CHECK(read_surface(folder.at("far.obj")).notes.empty());
}

TEST_CASE("damaged lines of an .mtl have no effect, and images of other formats are told", "[materials]") {
  const Folder folder;
  folder.write("tree.obj", obj_with("mtllib a.mtl b.mtl\n"));
  folder.write("a.mtl",
               "Kd 1 0 0\nnewmtl bark\nKd\nKd one\nPr x\nmap_Kd\nmap_Kd -s 1\nd\nKe spectral file.rfl\nnewmtl\n");
  folder.write("b.mtl", "newmtl old leaf\nKd 0.5\nmap_Kd leaf.tga\n");
  folder.write("leaf.tga", "no image that glTF holds");
  const SurfaceFile file = read_surface(folder.at("tree.obj"));
  const Json json = library_json(file.mesh);
  CHECK(json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] == Json({0.8, 0.8, 0.8, 1}));
  CHECK(json["materials"][1]["pbrMetallicRoughness"]["baseColorFactor"] == Json({0.5, 0.5, 0.5, 1}));
  CHECK_THAT(lines(file.notes), Catch::Contains("image leaf.tga, which is no PNG or JPEG"));
}

TEST_CASE("materials and images return from an OBJ that was written, and from folders of PLY", "[materials]") {
  const Folder folder;
  write_tree(folder);
  const TriangleMesh mesh = read_surface(folder.at("tree.obj")).mesh;
  fs::create_directories(folder.at("out"));
  CHECK(save_obj(folder.at("out/cut.obj"), mesh).empty());
  CHECK(names_in(folder.at("out")) ==
        std::set<std::string>{"cut.mtl", "cut.obj", "cut_big_bark.png", "cut_bumps.png", "cut_surface.png"});
  CHECK(read_all(folder.at("out/cut_surface.png")) == whole_png(2, "surface"));
  const SurfaceFile again = read_surface(folder.at("out/cut.obj"));
  CHECK(again.notes.empty());
  CHECK(library_json(again.mesh)["materials"] == library_json(mesh)["materials"]);
  // Written again under the same name, the files keep their names.
  CHECK(save_obj(folder.at("out/cut.obj"), again.mesh).empty());
  CHECK(names_in(folder.at("out")).size() == 5);

  TriangleMesh named = again.mesh;
  named.attributes.library = {};
  named.attributes.materials = "cut.mtl";
  write_all(folder.at("out/piece.ply"), [&](auto& out) { write_ply(out, named); });
  CHECK(library_json(read_surface(folder.at("out/piece.ply")).mesh)["materials"] == library_json(mesh)["materials"]);
}

TEST_CASE("an OBJ says what it leaves out, and names no .mtl that is not there", "[materials]") {
  const Folder folder;
  write_tree(folder);
  TriangleMesh mesh = read_surface(folder.at("tree.obj")).mesh;
  mesh.attributes.uv2 = mesh.attributes.uv;
  mesh.unit = 0.001;
  CHECK(save_obj(folder.at("cut.obj"), mesh) == std::vector<std::string>{"second texture coordinates", "the unit"});
  mesh.attributes.library = {};
  mesh.attributes.materials = "gone.mtl";
  save_obj(folder.at("plain.obj"), mesh);
  CHECK(read_all(folder.at("plain.obj")).find("mtllib") == std::string::npos);
  mesh.attributes.materials = "tree.mtl";
  save_obj(folder.at("plain.obj"), mesh);
  CHECK(read_all(folder.at("plain.obj")).starts_with("mtllib tree.mtl\n"));
}

TEST_CASE("materials of pieces in USD have the values and textures of the library", "[materials]") {
  const Folder folder;
  write_tree(folder);
  TriangleMesh mesh = read_surface(folder.at("tree.obj")).mesh;
  mesh.attributes.uv2 = mesh.attributes.uv;
  const Chunk chunk{mesh, signed_volume(mesh), Vec3::Zero()};
  ChunkLabels labels{.kind = "node", .names = piece_names(1)};
  const auto stage = [&](const std::string& prefix) {
    UsdOptions options;
    options.image_prefix = prefix;
    return bytes_of([&](auto& out) { write_usd_pieces(out, {chunk}, {}, labels, options); });
  };
  const std::string text = stage("tree_"), bare = stage("");
  for (const char* line :
       {"asset inputs:file = @./tree_big_bark.png@", "float4 inputs:scale = (0.25, 0.5, 0.75, 0.5)",
        "float inputs:opacity.connect = </pieces/materials/bark/base.outputs:a>", "float2 inputs:scale = (2, 3)",
        "float2 inputs:translation = (0.25, 0.5)", "float inputs:roughness.connect", "float inputs:clearcoat = 0.5",
        "color3f inputs:emissiveColor = (2, 1, 0)", "color3f inputs:diffuseColor = (0, 1, 0)",
        "texCoord2f[] primvars:st1 = ", "token inputs:wrapS = \"clamp\"", "float4 inputs:scale = (1, 1, 2, 1)"})
    CHECK_THAT(text, Catch::Contains(line));
  CHECK(bare.find("asset") == std::string::npos);
  CHECK_THAT(bare, Catch::Contains("color3f inputs:diffuseColor = (0.25, 0.5, 0.75)"));
  const ImageFiles files = image_files(mesh.attributes.library, "tree_");
  CHECK(files.images.size() == 3);
  for (const BesideFile& image : files.images) CHECK_THAT(text, Catch::Contains("@./" + image.name + "@"));
}

TEST_CASE("the turn of a texture is that of glTF, with v upwards", "[materials]") {
  // A library with a quarter turn, an offset, and a second set of texture coordinates.
  const Folder folder;
  Json json = {
      {"asset", {{"version", "2.0"}}},
      {"materials",
       {{{"name", "bark"},
         {"doubleSided", true},
         {"pbrMetallicRoughness",
          {{"baseColorTexture",
            {{"index", 0},
             {"texCoord", 1},
             {"extensions",
              {{"KHR_texture_transform", {{"rotation", 0.5}, {"offset", {0.125, 0.25}}, {"scale", {2, 3}}}}}}}}}},
         {"extensions", {{"KHR_materials_sheen", Json::object()}}}}}},
      {"textures", {{{"source", 0}}}},
      {"images", {{{"uri", "data:image/png;base64,iVBORw0KGgo="}}}}};
  const PreviewMaterials read = preview_materials({std::make_shared<const std::string>(json.dump())});
  REQUIRE(read.materials.size() == 1);
  const TextureUse& use = read.materials[0].base_texture;
  CHECK(use.uv_set == 1);
  const double c = std::cos(0.5), s = std::sin(0.5);
  for (const Vec2& at : {Vec2(0, 0), Vec2(1, 0), Vec2(0.25, 0.75)}) {
    // The specification: translation · rotation · scale, v downwards.
    const double u = 2 * at.x(), v = 3 * (1 - at.y());
    const Vec2 expected(c * u + s * v + 0.125, 1 - (-s * u + c * v + 0.25));
    const double x = 2 * at.x(), y = 3 * at.y();
    const Vec2 found =
        Vec2(std::cos(use.turn) * x - std::sin(use.turn) * y, std::sin(use.turn) * x + std::cos(use.turn) * y) +
        use.offset;
    CHECK((found - expected).norm() < 1e-12);
  }
  const MtlFiles files = mtl_files({"bark"}, {std::make_shared<const std::string>(json.dump())}, "x_");
  CHECK(files.images.empty());  // OBJ has one set of texture coordinates
  CHECK(files.left_out ==
        std::vector<std::string>{"KHR_materials_sheen", "doubleSided", "textures on the second texture coordinates"});
  CHECK(read.lost == std::set<std::string>{"KHR_materials_sheen"});
}

TEST_CASE("STL and OFF return the triangles", "[materials]") {
  const TriangleMesh ball = make_sphere(3);
  const TriangleMesh off = parse_surface(bytes_of([&](auto& out) { write_off(out, ball); }), "a.off").mesh;
  CHECK(off.vertices == ball.vertices);
  CHECK(off.triangles == ball.triangles);
  const TriangleMesh stl = parse_surface(bytes_of([&](auto& out) { write_stl(out, ball); }), "a.stl").mesh;
  REQUIRE(stl.triangles.size() == ball.triangles.size());
  CHECK(stl.vertices.size() == ball.vertices.size());
  CHECK(signed_volume(stl) == Approx(signed_volume(ball)).epsilon(1e-6));
}

TEST_CASE("base colours are factors, images and their places", "[materials]") {
  const Folder folder;
  write_tree(folder);
  Attributes a = read_surface(folder.at("tree.obj")).mesh.attributes;
  a.group_names = {"old leaf", "bark", crack_group, "unknown"};
  const BaseColors colors = base_colors(a);
  REQUIRE(colors.of_group.size() == 4);
  CHECK(colors.of_group[0].factor == Color(0, 1, 0, 1));
  CHECK(colors.of_group[0].image == BaseColor::no_image);
  const BaseColor& bark = colors.of_group[1];
  CHECK(bark.factor == Color(0.25, 0.5, 0.75, 0.5));
  REQUIRE(colors.images.size() == 1);
  CHECK(bark.image == 0);
  CHECK(colors.images[0] == whole_png(2, "bark"));
  CHECK(bark.uv_set == 0);
  CHECK(bark.wrap == std::array<TextureWrap, 2>{TextureWrap::clamp, TextureWrap::clamp});
  // As the .mtl says it: a coordinate is multiplied, then moved.
  CHECK((bark.placement * Vec2(0.5, 0.25) + bark.offset - Vec2(1.25, 1.25)).norm() < 1e-12);
  CHECK(colors.of_group[2].factor == Color(0.42, 0.36, 0.31, 1));
  CHECK(colors.of_group[3].factor == Color(0.8, 0.8, 0.8, 1));
  CHECK(colors.complete);
  // Colours of corners are all that is known of a group without a material.
  a.color.resize(a.group.size());
  CHECK(base_colors(a).of_group[1].factor == bark.factor);
  CHECK(base_colors(a).of_group[2].factor == Color(1, 1, 1, 1));
  CHECK(base_colors({}).of_group.at(0).factor == Color(0.8, 0.8, 0.8, 1));
}

TEST_CASE("damaged .mtl files give what is understood of them", "[materials][fuzz]") {
  const Folder folder;
  write_tree(folder);
  const std::string obj = obj_with("mtllib damaged.mtl\n"), name = folder.at("tree.obj");
  const std::vector<std::string> files{
      tree_mtl, "newmtl bark\nKd 0.5\nmap_Kd -t 1 2 3 -mm 0 1 -cc on surface.png\nmap_Bump -bm 2 bumps.png\nTr 0.25\n",
      "# Blender\r\nnewmtl old leaf\r\nKa 1 1 1\r\nKd spectral a.rfl 1\r\nKe xyz 1 2 3\r\nd -halo 0.5\r\nillum "
      "2\r\nmap_Ke "
      "textures/big bark.png\r\n"};
  fuzz::campaign(
      "mtl", 1000,
      [&](const auto& bytes, const auto&) -> fuzz::Use {
        folder.write("damaged.mtl", bytes);
        return [mesh = parse_surface(obj, name).mesh] {
          const Attributes& a = mesh.attributes;
          for (const BaseColor& color : base_colors(a).of_group)
            if (!color.factor.allFinite() || !color.placement.allFinite() || !color.offset.allFinite())
              throw std::logic_error("a base colour that is not finite");
          mtl_files(a.group_names, a.library, "x_");
          image_files(a.library, "x_");
          const std::string ply = bytes_of([&](auto& out) { write_ply(out, mesh); });
          if (parse_surface(ply, "again.ply").mesh.attributes.library != a.library)
            throw std::logic_error("another library after writing and reading");
        };
      },
      [files](Random& random) {
        const std::string& file = files[random.below(static_cast<std::uint32_t>(files.size()))];
        return Mutator(random).damaged(file, files);
      },
      fuzz::Refusals::none);
}
