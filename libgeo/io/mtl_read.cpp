// io/mtl.h. Statements of the MTL specification with those of its extension for metal and
// roughness (Pr, Pm, Pc, Ke, norm), as entries of a glTF library.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <sstream>

#include "base/number_text.h"
#include "io/glb_file.h"
#include "io/image_type.h"
#include "io/line_reader.h"
#include "io/mtl.h"
#include "io/surface_formats.h"
#include "kerf/error.h"
#include "kerf/files.h"

namespace geo {
namespace {

namespace fs = std::filesystem;
using Json = GlbFile::Json;

// A map_… statement.
struct Map {
  std::string file;
  Vec2 scale = Vec2::Ones(), offset = Vec2::Zero();
  bool clamp = false;
  char channel = 0;  // 'r', 'g', 'b', 'm', 'l', 'z'; 0: none named
  double strength = 1;
  explicit operator bool() const { return !file.empty(); }
};

// The statements of a material; empty members have none.
struct Statements {
  std::string name;
  std::optional<Vec3> kd, ke;
  std::optional<double> ns, d, tr, pr, pm, pc, pcr;
  Map map_kd, map_d, map_ke, map_pr, map_pm, norm, bump;
};

std::optional<double> number_of(std::string_view word) {
  double value = 0;
  const auto [end, good] = read_number(word.data(), word.data() + word.size(), value);
  if (!good || end != word.data() + word.size() || !std::isfinite(value)) return {};
  return value;
}

double share(double x) { return std::clamp(x, 0.0, 1.0); }

using Words = std::vector<std::string_view>;

// Reads the statements of .mtl files.
class MtlReader {
 public:
  void read(const std::string& bytes) {
    LineReader lines(bytes, "");
    for (Words words; lines.next(words);) read_line(words);
  }
  std::vector<Statements> materials;
  std::set<std::string> lost;  // statements that the library cannot say

 private:
  static std::string rest(const Words& words, std::size_t from) {
    std::string text;
    for (std::size_t i = from; i < words.size(); ++i) text += (i > from ? " " : "") + std::string(words[i]);
    return text;
  }

  void read_line(const Words& words) {
    const std::string key(words[0]);
    if (key == "newmtl") {
      materials.emplace_back();
      materials.back().name = rest(words, 1);
    }
    if (materials.empty() || key == "newmtl") return;
    Statements& m = materials.back();
    const std::map<std::string, std::optional<double>*> numbers{
        {"Ns", &m.ns}, {"d", &m.d}, {"Tr", &m.tr}, {"Pr", &m.pr}, {"Pm", &m.pm}, {"Pc", &m.pc}, {"Pcr", &m.pcr}};
    const std::map<std::string, Map*> maps{{"map_Kd", &m.map_kd}, {"map_d", &m.map_d},   {"map_Ke", &m.map_ke},
                                           {"map_Pr", &m.map_pr}, {"map_Pm", &m.map_pm}, {"norm", &m.norm},
                                           {"map_Bump", &m.bump}, {"map_bump", &m.bump}, {"bump", &m.bump}};
    if (const auto at = numbers.find(key); at != numbers.end()) {
      // "d -halo 0.5": the number is the last word.
      if (const auto value = words.size() > 1 ? number_of(words.back()) : std::nullopt) *at->second = value;
    } else if (const auto map = maps.find(key); map != maps.end()) {
      *map->second = map_of(words);
    } else if (key == "Kd" || key == "Ke") {
      (key == "Kd" ? m.kd : m.ke) = color_of(words);
    } else if (key.starts_with("map_") || key == "disp" || key == "decal" || key == "refl") {
      if (key != "map_Ka" && key != "map_aat") lost.insert(key);
    }
  }

  std::optional<Vec3> color_of(const Words& words) {
    std::array<double, 3> c{};
    if (words.size() < 2 || words[1] == "spectral" || words[1] == "xyz") {
      lost.insert(std::string(words[0]) + " of a spectrum");
      return {};
    }
    for (std::size_t k = 0; k < 3; ++k) {
      // One number stands for three equal ones.
      const auto value = number_of(words[std::min(1 + k, words.size() - 1)]);
      if (!value || *value < 0) return {};
      c[k] = *value;
    }
    return Vec3(c[0], c[1], c[2]);
  }

  // Options stand before the name of the file, which may have blanks.
  static Map map_of(const Words& words) {
    static const std::set<std::string_view> with_word = {"-blendu", "-blendv", "-cc", "-texres", "-boost", "-type"};
    Map map;
    std::size_t i = 1;
    while (i + 1 < words.size() && words[i].size() > 1 && words[i][0] == '-') {
      const std::string_view option = words[i];
      if (option == "-o" || option == "-s" || option == "-t") {
        std::size_t n = 0;
        for (; n < 3 && i + 2 + n < words.size(); ++n) {
          const auto value = number_of(words[i + 1 + n]);
          if (!value) break;
          if (n < 2 && option != "-t") (option == "-o" ? map.offset : map.scale)[static_cast<Eigen::Index>(n)] = *value;
        }
        i += 1 + n;
      } else if (option == "-mm") {
        i += 3;
      } else if (option == "-clamp" || option == "-imfchan" || option == "-bm" || with_word.contains(option)) {
        const std::string_view value = words[i + 1];
        if (option == "-clamp") map.clamp = value == "on";
        if (option == "-imfchan") map.channel = value[0];
        if (option == "-bm") map.strength = number_of(value).value_or(1);
        i += 2;
      } else {
        break;
      }
    }
    map.file = rest(words, i);
    std::replace(map.file.begin(), map.file.end(), '\\', '/');
    return map;
  }
};

// A regular file in a folder or below it; empty where `path` names none.
std::optional<fs::path> inside(const fs::path& top, const fs::path& path) {
  const fs::path root = top.empty() ? fs::path(".") : top.lexically_normal();
  const fs::path relative = path.lexically_normal().lexically_relative(root);
  std::error_code failed;
  if (relative.empty() || *relative.begin() == ".." || !fs::is_regular_file(path, failed)) return {};
  return path;
}

// Makes entries of the library.
class LibraryMaker {
 public:
  LibraryMaker(const std::string& name, std::set<std::string>& lost)
      : top_(fs::path(name).parent_path()), stem_(fs::path(name).stem().string()), lost_(lost) {
    library_.json = {{"asset", {{"version", "2.0"}, {"generator", "kerf"}}}};
  }

  // `folder`: of the .mtl. `textured`: whether the surface has texture coordinates.
  void add(const Statements& m, const fs::path& folder, bool textured) {
    folder_ = folder;
    textured_ = textured;
    const bool image = m.map_kd && found(m.map_kd).usable();
    const Vec3 kd = m.kd.value_or(Vec3::Constant(image ? 1 : 0.8));
    // Some programs write black beside a texture, which would blacken it.
    const Vec3 color = image && kd.isZero(0) ? Vec3(Vec3::Ones()) : kd;
    const double alpha = share(m.d ? *m.d : m.tr ? 1 - *m.tr : 1);
    Json pbr = {{"baseColorFactor", {share(color.x()), share(color.y()), share(color.z()), alpha}},
                {"metallicFactor", share(m.pm.value_or(0))},
                {"roughnessFactor", roughness_of(m)}};
    Json material = {{"name", m.name}};
    add_texture(pbr, "baseColorTexture", m.map_kd);
    if (pbr.contains("baseColorTexture") && m.map_d && m.map_d.file == m.map_kd.file)
      material["alphaMode"] = "BLEND";
    else if (m.map_d)
      lost_.insert("map_d");
    if (alpha < 1) material["alphaMode"] = "BLEND";
    add_surface_texture(pbr, m);
    material["pbrMetallicRoughness"] = std::move(pbr);
    add_normal_texture(material, m);
    add_emission(material, m);
    if (m.pc.value_or(0) > 0)
      extension(material, "KHR_materials_clearcoat") = {{"clearcoatFactor", share(*m.pc)},
                                                        {"clearcoatRoughnessFactor", share(m.pcr.value_or(0))}};
    library_.json["materials"].push_back(std::move(material));
  }

  std::string bytes() {
    if (!used_.empty()) library_.json["extensionsUsed"] = used_;
    std::ostringstream out;
    library_.write(out);
    return std::move(out).str();
  }
  // Images that are named and could not be opened.
  const std::set<std::string>& missing() const { return missing_; }

 private:
  // Without a roughness, that by which Blender reads the exponent of a highlight.
  static double roughness_of(const Statements& m) {
    constexpr double matt = 0.9, max_exponent = 1000;
    if (m.pr) return share(*m.pr);
    if (m.map_pr) return 1;
    return m.ns ? 1 - std::sqrt(std::clamp(*m.ns, 0.0, max_exponent) / max_exponent) : matt;
  }

  Json& extension(Json& object, const std::string& name) {
    used_.insert(name);
    return object["extensions"][name];
  }

  // One image with roughness in green and metal in blue is all that glTF takes.
  void add_surface_texture(Json& pbr, const Statements& m) {
    if (!m.map_pr && !m.map_pm) return;
    const bool green = !m.map_pr || m.map_pr.channel == 'g', blue = !m.map_pm || m.map_pm.channel == 'b';
    const bool same = m.map_pr && m.map_pm && m.map_pr.file == m.map_pm.file;
    if (!(same || (green && blue && !(m.map_pr && m.map_pm)))) {
      lost_.insert(m.map_pr && m.map_pm ? "map_Pr and map_Pm of two images" : m.map_pr ? "map_Pr" : "map_Pm");
      if (!m.pr && m.map_pr) pbr["roughnessFactor"] = 0.5;
      return;
    }
    if (!m.pm && m.map_pm) pbr["metallicFactor"] = 1.0;
    add_texture(pbr, "metallicRoughnessTexture", m.map_pr ? m.map_pr : m.map_pm);
  }

  // "bump" names a normal map where the image is coloured, as exporters use it, else heights.
  void add_normal_texture(Json& material, const Statements& m) {
    if (!m.norm && m.bump && grey(m.bump)) {
      lost_.insert("bump of heights");
      return;
    }
    const Map& map = m.norm ? m.norm : m.bump;
    add_texture(material, "normalTexture", map);
    if (material.contains("normalTexture") && map.strength != 1) material["normalTexture"]["scale"] = map.strength;
  }

  void add_emission(Json& material, const Statements& m) {
    Vec3 ke = m.ke.value_or(Vec3::Zero());
    add_texture(material, "emissiveTexture", m.map_ke);
    if (m.map_ke && ke.isZero(0)) ke = Vec3::Ones();
    if (ke.isZero(0)) return;
    const double brightest = ke.maxCoeff();
    if (brightest > 1) {
      extension(material, "KHR_materials_emissive_strength") = {{"emissiveStrength", brightest}};
      ke /= brightest;
    }
    material["emissiveFactor"] = {ke.x(), ke.y(), ke.z()};
  }

  void add_texture(Json& object, const char* key, const Map& map) {
    if (!map) return;
    if (!textured_) {
      lost_.insert("textures, as it has no texture coordinates");
      return;
    }
    const auto image = image_of(map);
    if (!image) return;
    Json texture = {{"source", *image}};
    if (map.clamp) {
      if (!library_.json.contains("samplers")) library_.json["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33071}}};
      texture["sampler"] = 0;
    }
    Json& textures = library_.json["textures"];
    const auto same = std::find(textures.begin(), textures.end(), texture);
    const auto index = static_cast<std::size_t>(same - textures.begin());
    if (same == textures.end()) textures.push_back(std::move(texture));
    Json use = {{"index", index}};
    if (map.scale != Vec2::Ones() || !map.offset.isZero(0)) {
      // In glTF v points downwards.
      extension(use, "KHR_texture_transform") = {{"scale", {map.scale.x(), map.scale.y()}},
                                                 {"offset", {map.offset.x(), 1 - map.scale.y() - map.offset.y()}}};
    }
    object[key] = std::move(use);
  }

  // A path of another machine is looked for by its last name.
  std::optional<fs::path> find(const std::string& file) const {
    const fs::path path(file);
    if (path.is_relative())
      if (const auto found = inside(top_, folder_ / path)) return found;
    for (const fs::path& folder : {folder_, folder_ / "textures"})
      if (const auto found = inside(top_, folder / path.filename())) return found;
    return {};
  }

  // An image file; without a type it could not be opened, or is none that glTF holds.
  struct Found {
    std::string name, type, bytes;
    std::optional<std::size_t> index;  // in the library, once a texture uses it
    bool usable() const { return !type.empty(); }
  };

  Found load(const Map& map) {
    const auto path = find(map.file);
    if (!path) {
      missing_.insert(shown(map.file));
      return {};
    }
    std::string bytes;
    try {
      bytes = read_all(path->string());
    } catch (const InputError&) {
      std::error_code failed;
      if (fs::file_size(*path, failed) > 0 || failed) {
        missing_.insert(shown(map.file));
        return {};
      }
      bytes.clear();  // empty files are refused
    }
    const std::string type = image_type(bytes);
    std::string fault = image_fault(bytes);
    if (fault.empty() && type != "image/png" && type != "image/jpeg") fault = "is no PNG or JPEG";
    if (!fault.empty()) {
      lost_.insert("image " + shown(map.file) + ", which " + fault);
      return {};
    }
    // Names of images that a surface of this name was written with begin with it.
    std::string name = path->stem().string();
    if (name.starts_with(stem_ + "_") && name.size() > stem_.size() + 1) name.erase(0, stem_.size() + 1);
    return {.name = name, .type = type, .bytes = std::move(bytes), .index = {}};
  }

  Found& found(const Map& map) {
    const std::string key = (folder_ / map.file).lexically_normal().string();
    const auto [at, fresh] = images_.try_emplace(key);
    if (fresh) at->second = load(map);
    return at->second;
  }

  std::optional<std::size_t> image_of(const Map& map) {
    Found& image = found(map);
    if (!image.usable() || image.index) return image.index;
    const std::size_t view = library_.bytes(image.bytes);  // first, as a new list of the file moves the others
    Json& images = library_.json["images"];
    images.push_back({{"name", image.name}, {"bufferView", view}, {"mimeType", image.type}});
    return image.index = images.size() - 1;
  }

  // Byte 25 of a PNG says whether it is grey, without alpha or with it.
  bool grey(const Map& map) {
    const Found& image = found(map);
    return image.type == "image/png" && image.bytes.size() > 25 && (image.bytes[25] == 0 || image.bytes[25] == 4);
  }

  const fs::path top_;
  const std::string stem_;
  std::set<std::string>& lost_;
  GlbFile library_;
  fs::path folder_;
  bool textured_ = false;
  std::set<std::string> used_, missing_;
  std::map<std::string, Found> images_;
};

// The .mtl files that "mtllib" statements name: a statement is one name with blanks, or several.
std::vector<fs::path> named_files(const std::vector<std::string>& statements, const fs::path& folder,
                                  std::set<std::string>& missing) {
  std::vector<fs::path> files;
  for (const std::string& statement : statements) {
    if (const auto whole = inside(folder, folder / statement)) {
      files.push_back(*whole);
      continue;
    }
    std::istringstream words(statement);
    for (std::string word; words >> word;) {
      if (const auto one = inside(folder, folder / word))
        files.push_back(*one);
      else
        missing.insert(shown(statement));
    }
  }
  return files;
}

std::string listed(const std::set<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

}  // namespace

void add_mtl_library(TriangleMesh& mesh, const std::vector<std::string>& files, const std::string& name,
                     std::vector<std::string>& notes) {
  Attributes& a = mesh.attributes;
  if (a.group.empty() || a.library.glb || files.empty()) return;
  const fs::path folder = fs::path(name).parent_path();
  std::set<std::string> missing, lost, taken;
  LibraryMaker library(name, lost);
  for (const fs::path& file : named_files(files, folder, missing)) {
    MtlReader reader;
    try {
      reader.read(read_all(file.string()));
    } catch (const InputError&) {
      missing.insert(shown(file.filename().string()));
      continue;
    }
    lost.merge(reader.lost);
    for (const Statements& m : reader.materials) {
      const bool used = std::find(a.group_names.begin(), a.group_names.end(), m.name) != a.group_names.end();
      if (used && taken.insert(m.name).second) library.add(m, file.parent_path(), !a.uv.empty());
    }
  }
  if (!missing.empty())
    notes.push_back("names " + listed(missing) + ", not in its folder; materials of it have names only");
  if (!taken.empty()) a.library.glb = std::make_shared<const std::string>(library.bytes());
  if (!library.missing().empty()) notes.push_back("left out: textures not in its folder: " + listed(library.missing()));
  if (!lost.empty()) notes.push_back("left out of its materials: " + listed(lost));
  std::set<std::string> unknown;
  for (const std::string& group : a.group_names)
    if (!taken.contains(group)) unknown.insert(shown(group));
  unknown.erase("default");  // faces before the first statement
  if (missing.empty() && !unknown.empty())
    notes.push_back("names materials that its .mtl does not describe, and which stay names: " + listed(unknown));
}

}  // namespace geo
