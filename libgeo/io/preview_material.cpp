// io/preview_material.h. Members of a glTF material are read as the specification of glTF 2.0 and
// of its extensions describes them.
#include "io/preview_material.h"

#include <cmath>
#include <map>

#include "io/gltf_document.h"
#include "io/image_type.h"
#include "io/shown.h"

namespace geo {
namespace {

using Json = GltfDocument::Json;

// Extensions whose members a PreviewMaterial has.
constexpr const char* held_extensions[] = {"KHR_texture_transform", "KHR_materials_clearcoat", "KHR_materials_ior",
                                           "KHR_materials_emissive_strength"};

double number_in(const Json& object, const char* key, double fallback) {
  const Json& value = GltfDocument::member(object, key);
  return value.is_number() ? value.get<double>() : fallback;
}

// Letters, digits, dots and dashes of a name: what every file system and every MTL reader takes.
std::string file_stem(const std::string& name, const std::string& ending) {
  std::string stem;
  for (const char c : name) {
    const auto u = static_cast<unsigned char>(c);
    stem += std::isalnum(u) != 0 || c == '-' || c == '_' || c == '.' ? c : '_';
  }
  if (stem.ends_with(ending)) stem.resize(stem.size() - ending.size());
  if (stem.find_first_not_of('.') == stem.npos) stem = "texture";
  constexpr std::size_t max_bytes = 100;
  return stem.substr(0, max_bytes);
}

class PreviewReader {
 public:
  explicit PreviewReader(const std::string& glb) : document_(glb, "the materials of the surface") {}

  PreviewMaterials read() {
    for (std::size_t i = 0; i < document_.count("materials"); ++i) add(document_.entry("materials", i));
    return std::move(result_);
  }

 private:
  void add(const Json& from) {
    PreviewMaterial m;
    m.name = GltfDocument::text(from, "name");
    const Json& pbr = GltfDocument::member(from, "pbrMetallicRoughness");
    const auto base = document_.numbers(pbr, "baseColorFactor", 4);
    m.base = base.empty() ? Color(Color::Ones()) : Color(base[0], base[1], base[2], base[3]);
    m.metallic = number_in(pbr, "metallicFactor", 1);
    m.roughness = number_in(pbr, "roughnessFactor", 1);
    const auto emissive = document_.numbers(from, "emissiveFactor", 3);
    if (!emissive.empty()) m.emissive = Vec3(emissive[0], emissive[1], emissive[2]);
    m.emissive *= number_in(GltfDocument::extension(from, "KHR_materials_emissive_strength"), "emissiveStrength", 1);
    const Json& coat = GltfDocument::extension(from, "KHR_materials_clearcoat");
    m.clearcoat = number_in(coat, "clearcoatFactor", 0);
    m.clearcoat_roughness = number_in(coat, "clearcoatRoughnessFactor", 0);
    for (const char* key : {"clearcoatTexture", "clearcoatRoughnessTexture", "clearcoatNormalTexture"})
      if (!GltfDocument::member(coat, key).is_null()) result_.lost.insert("textures of clear coats");
    m.ior = number_in(GltfDocument::extension(from, "KHR_materials_ior"), "ior", 1.5);
    const std::string alpha = GltfDocument::text(from, "alphaMode");
    if (alpha == "MASK") m.alpha = PreviewMaterial::Alpha::mask;
    if (alpha == "BLEND") m.alpha = PreviewMaterial::Alpha::blend;
    m.cutoff = number_in(from, "alphaCutoff", 0.5);
    m.double_sided = GltfDocument::member(from, "doubleSided") == true;
    m.base_texture = texture(GltfDocument::member(pbr, "baseColorTexture"), "");
    m.surface_texture = texture(GltfDocument::member(pbr, "metallicRoughnessTexture"), "");
    m.normal_texture = texture(GltfDocument::member(from, "normalTexture"), "scale");
    m.occlusion_texture = texture(GltfDocument::member(from, "occlusionTexture"), "strength");
    m.emissive_texture = texture(GltfDocument::member(from, "emissiveTexture"), "");
    lose_extensions(from);
    result_.materials.push_back(std::move(m));
  }

  void lose_extensions(const Json& object) {
    const Json& extensions = GltfDocument::member(object, "extensions");
    if (!extensions.is_object()) return;
    for (const auto& entry : extensions.items())
      if (std::find(std::begin(held_extensions), std::end(held_extensions), entry.key()) == std::end(held_extensions))
        result_.lost.insert(shown(entry.key()));
  }

  // `strength`: the key of the use's own factor.
  TextureUse texture(const Json& use, const char* strength) {
    TextureUse result;
    const auto which = document_.index(use, "index");
    if (!which) return result;
    const Json& description = document_.entry("textures", *which);
    lose_extensions(description);
    lose_extensions(use);
    const auto source = document_.index(description, "source");
    if (!source) {
      result_.lost.insert(lost_images);
      return result;
    }
    result.image = image(*source);
    if (!result) return result;
    result.uv_set = document_.size(use, "texCoord", 0);
    result.strength = number_in(use, strength, 1);
    place(GltfDocument::extension(use, "KHR_texture_transform"), result);
    if (const auto sampler = document_.index(description, "sampler")) {
      const Json& wraps = document_.entry("samplers", *sampler);
      result.wrap = {static_cast<int>(document_.size(wraps, "wrapS", 10497)),
                     static_cast<int>(document_.size(wraps, "wrapT", 10497))};
    }
    return result;
  }

  // The extension's v points downwards. With v upwards the turn is about the lower left corner of
  // the image, in the same sense.
  void place(const Json& transform, TextureUse& use) const {
    if (transform.is_null()) return;
    use.uv_set = document_.size(transform, "texCoord", use.uv_set);
    const auto scale = document_.numbers(transform, "scale", 2), offset = document_.numbers(transform, "offset", 2);
    if (!scale.empty()) use.scale = Vec2(scale[0], scale[1]);
    use.turn = number_in(transform, "rotation", 0);
    const Vec2 at = offset.empty() ? Vec2(Vec2::Zero()) : Vec2(offset[0], offset[1]);
    use.offset = Vec2(at.x() + std::sin(use.turn) * use.scale.y(), 1 - at.y() - std::cos(use.turn) * use.scale.y());
  }

  std::size_t image(std::size_t source) {
    const auto [at, fresh] = images_.try_emplace(source, result_.images.size());
    if (!fresh) return at->second;
    const Json& description = document_.entry("images", source);
    const auto view = document_.index(description, "bufferView");
    std::string bytes =
        view ? std::string(document_.view(*view)) : document_.at_uri(GltfDocument::text(description, "uri"));
    const std::string type = image_type(bytes);
    if (type != "image/png" && type != "image/jpeg") {
      result_.lost.insert(lost_images);
      return at->second = TextureUse::none;
    }
    const std::string ending = type == "image/png" ? ".png" : ".jpg";
    std::string name = GltfDocument::text(description, "name");
    if (name.empty()) name = "texture";
    result_.images.push_back({name, ending, std::move(bytes)});
    return at->second;
  }

  GltfDocument document_;
  std::map<std::size_t, std::size_t> images_;  // of the library, with their places in the result
  PreviewMaterials result_;
};

}  // namespace

PreviewMaterials preview_materials(const MaterialLibrary& library) {
  if (!library.glb) return {};
  return PreviewReader(*library.glb).read();
}

PreviewMaterial plain_material(const std::string& group) {
  PreviewMaterial result;
  result.name = group;
  if (group == crack_group) result.base = Color(0.42, 0.36, 0.31, 1);
  return result;
}

std::vector<std::string> image_file_names(const PreviewMaterials& materials, const std::string& prefix) {
  std::vector<std::string> names;
  for (const PreviewImage& image : materials.images) {
    std::string stem = prefix + file_stem(image.name, image.ending), name = stem + image.ending;
    for (int i = 2; std::find(names.begin(), names.end(), name) != names.end(); ++i)
      name = stem + "_" + std::to_string(i) + image.ending;
    names.push_back(std::move(name));
  }
  return names;
}

}  // namespace geo
