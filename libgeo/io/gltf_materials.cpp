// io/gltf_materials.h. Descriptions are copied as JSON, so that what this code does not know is
// kept; only indices of textures, samplers and images change.
#include "io/gltf_materials.h"

#include <algorithm>
#include <functional>
#include <map>
#include <set>
#include <sstream>

#include "io/image_type.h"
#include "io/shown.h"
#include "kerf/error.h"

namespace geo {
namespace {

using Json = GlbFile::Json;
using namespace nlohmann::literals;

// Calls `change` for each object of a description, at any depth, with the key that it has.
void for_each_object(Json& value, const std::string& key,
                     const std::function<void(Json&, const std::string&)>& change) {
  if (value.is_object()) change(value, key);
  if (value.is_structured())
    for (auto& [inner, entry] : value.items()) for_each_object(entry, inner, change);
}

bool names_texture(const std::string& key) { return key.ends_with("Texture") || key.ends_with("texture"); }

// Numbers entries in the order in which they are first named.
class Numbers {
 public:
  std::size_t of(std::size_t old) {
    const auto [at, fresh] = numbers_.try_emplace(old, order_.size());
    if (fresh) order_.push_back(old);
    return at->second;
  }
  // The old numbers in the order of the new ones; may grow while it is walked.
  const std::vector<std::size_t>& order() const { return order_; }

 private:
  std::map<std::size_t, std::size_t> numbers_;
  std::vector<std::size_t> order_;
};

std::size_t index_in(const GltfDocument& document, const Json& value, const char* list) {
  if (!value.is_number_unsigned() || value.get<std::size_t>() >= document.count(list))
    document.fail(std::string("has a material that names an entry of its '") + list + "' that is not there");
  return value.get<std::size_t>();
}

// The names of extensions that some descriptions have.
std::vector<std::string> extensions_in(Json& descriptions) {
  std::vector<std::string> names;
  for_each_object(descriptions, "", [&](Json& object, const std::string& key) {
    if (key != "extensions") return;
    for (const auto& entry : object.items())
      if (std::find(names.begin(), names.end(), entry.key()) == names.end()) names.push_back(entry.key());
  });
  return names;
}

// Writes the descriptions that are listed into `file`. `to_texture`, `to_sampler` and `to_image`
// number the textures, samplers and images, which are written as they are named.
class Copier {
 public:
  Copier(GltfDocument& from, GlbFile& to) : from_(from), to_(to) {
    textures_before_ = list("textures").size();
    samplers_before_ = list("samplers").size();
    images_before_ = list("images").size();
  }

  void add_material(std::size_t material, const std::string& name, std::size_t uv_sets) {
    Json description = from_.entry("materials", material);
    description["name"] = name;
    for_each_object(description, "", [&](Json& object, const std::string&) { drop_textures(object, uv_sets); });
    for_each_object(description, "", [&](Json& object, const std::string& key) {
      if (names_texture(key) && object.contains("index"))
        object["index"] = textures_before_ + textures_.of(index_in(from_, object["index"], "textures"));
    });
    list("materials").push_back(std::move(description));
  }

  /// Uses of textures that were left out for their texture coordinates.
  std::size_t dropped() const { return dropped_; }
  /// Images that were left out.
  std::vector<std::string> faults() const { return {faults_.begin(), faults_.end()}; }

  // Writes what the materials name.
  void finish() {
    for (std::size_t i = 0; i < textures_.order().size(); ++i) add_texture(textures_.order()[i]);
    for (std::size_t i = 0; i < samplers_.order().size(); ++i)
      list("samplers").push_back(Json(from_.entry("samplers", samplers_.order()[i])));
    for (std::size_t i = 0; i < images_.order().size(); ++i) add_image(images_.order()[i]);
    for (const char* name : {"textures", "samplers", "images"})
      if (list(name).empty()) to_.json.erase(name);
    name_extensions();
  }

 private:
  Json& list(const char* name) {
    Json& entries = to_.json[name];
    if (entries.is_null()) entries = Json::array();
    return entries;
  }

  // Removes uses of textures, among the members of an object, whose texture coordinates are not
  // there.
  void drop_textures(Json& object, std::size_t uv_sets) {
    std::vector<std::string> gone;
    for (const auto& [key, use] : object.items()) {
      if (!names_texture(key) || !use.is_object() || !use.contains("index")) continue;
      Json set = use.value("texCoord", Json(0u));
      if (use.contains("/extensions/KHR_texture_transform/texCoord"_json_pointer))
        set = use["extensions"]["KHR_texture_transform"]["texCoord"];
      const bool placed = set.is_number_unsigned() && set.get<std::size_t>() < uv_sets;
      if (!placed) ++dropped_;
      if (!placed || has_fault(index_in(from_, use["index"], "textures"))) gone.push_back(key);
    }
    for (const std::string& key : gone) object.erase(key);
  }

  // Whether one of a texture's images cannot be used.
  bool has_fault(std::size_t texture) {
    Json description = from_.entry("textures", texture);
    bool result = false;
    for_each_object(description, "", [&](Json& object, const std::string&) {
      if (object.contains("source")) result = image_has_fault(index_in(from_, object["source"], "images")) || result;
    });
    return result;
  }

  bool image_has_fault(std::size_t image) {
    const auto [at, fresh] = has_fault_.try_emplace(image, false);
    if (!fresh) return at->second;
    const GltfDocument::Json& description = from_.entry("images", image);
    std::string name = GltfDocument::text(description, "name"), fault;
    const std::string uri = GltfDocument::text(description, "uri");
    if (name.empty()) name = uri.empty() || uri.starts_with("data:") ? std::to_string(image) : uri;
    try {
      fault = image_fault(bytes_of(description));
    } catch (const InputError&) {
      if (uri.empty() || uri.starts_with("data:")) throw;
      fault = "is not in its folder";
    }
    if (!fault.empty()) faults_.insert("image " + shown(name) + ", which " + fault);
    return at->second = !fault.empty();
  }

  std::string bytes_of(const GltfDocument::Json& description) {
    const auto view = from_.index(description, "bufferView");
    return view ? std::string(from_.view(*view)) : from_.at_uri(GltfDocument::text(description, "uri"));
  }

  void add_texture(std::size_t texture) {
    Json description = from_.entry("textures", texture);
    if (description.contains("sampler"))
      description["sampler"] = samplers_before_ + samplers_.of(index_in(from_, description["sampler"], "samplers"));
    // Extensions name an image in another format beside, or in place of, that of the texture
    // itself.
    for_each_object(description, "", [&](Json& object, const std::string&) {
      if (object.contains("source"))
        object["source"] = images_before_ + images_.of(index_in(from_, object["source"], "images"));
    });
    list("textures").push_back(std::move(description));
  }

  void add_image(std::size_t image) {
    const GltfDocument::Json& description = from_.entry("images", image);
    const std::string bytes = bytes_of(description);
    Json written = {{"bufferView", to_.bytes(bytes)}, {"mimeType", image_type(bytes)}};
    const std::string name = GltfDocument::text(description, "name");
    if (!name.empty()) written["name"] = name;
    list("images").push_back(std::move(written));
  }

  // Extensions of materials and textures are used; required is what the source requires of them.
  void name_extensions() {
    Json described = {{"materials", list("materials")}};
    if (to_.json.contains("textures")) described["textures"] = to_.json["textures"];
    for (const std::string& name : extensions_in(described)) {
      const auto add = [&](const char* key) {
        Json& names = list(key);
        if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
      };
      add("extensionsUsed");
      const GltfDocument::Json& required = GltfDocument::member(from_.json(), "extensionsRequired");
      if (required.is_array() && std::find(required.begin(), required.end(), name) != required.end())
        add("extensionsRequired");
    }
  }

  GltfDocument& from_;
  GlbFile& to_;
  std::size_t textures_before_, samplers_before_, images_before_, dropped_ = 0;
  std::map<std::size_t, bool> has_fault_;  // by image
  std::set<std::string> faults_;
  Numbers textures_, samplers_, images_;
};

}  // namespace

GltfLibrary materials_of(GltfDocument& document, const std::vector<GltfGroup>& groups, std::size_t uv_sets) {
  GlbFile library;
  library.json = {{"asset", {{"version", "2.0"}, {"generator", "kerf"}}}};
  Copier copier(document, library);
  for (const GltfGroup& group : groups) copier.add_material(group.material, group.name, uv_sets);
  copier.finish();
  std::ostringstream out;
  library.write(out);
  return {std::move(out).str(), copier.dropped(), copier.faults()};
}

std::vector<std::string> add_materials(GlbFile& file, const std::string& materials,
                                       const std::map<std::string, std::string>& renamed) {
  GltfDocument library(materials, "the materials of the surface");
  Copier copier(library, file);
  std::vector<std::string> names;
  for (std::size_t i = 0; i < library.count("materials"); ++i) {
    const std::string name = GltfDocument::text(library.entry("materials", i), "name");
    const auto other = renamed.find(name);
    if (!renamed.empty() && other == renamed.end()) continue;
    names.push_back(renamed.empty() ? name : other->second);
    copier.add_material(i, names.back(), ~std::size_t(0));
  }
  copier.finish();
  return names;
}

}  // namespace geo
