// mtl_files() and save_obj() of kerf/files.h. A material is written with the statements of metal
// and roughness that most readers know, and with a highlight for those that do not.
#include <cmath>
#include <filesystem>
#include <map>

#include "io/preview_material.h"
#include "io/usd_text.h"
#include "kerf/error.h"
#include "kerf/files.h"

namespace geo {
namespace {

namespace fs = std::filesystem;

class MtlWriter {
 public:
  MtlWriter(const PreviewMaterials& from, const std::vector<std::string>& files, std::vector<std::string>& left_out)
      : from_(from), files_(files), lost_(from.lost), left_out_(left_out) {}

  std::string write(const std::vector<std::string>& groups) {
    std::map<std::string, const PreviewMaterial*> known;
    for (const PreviewMaterial& m : from_.materials) known.try_emplace(m.name, &m);
    for (const std::string& group : groups) {
      const auto at = known.find(group);
      material(at != known.end() ? *at->second : plain_material(group));
    }
    left_out_.assign(lost_.begin(), lost_.end());
    return std::move(text_);
  }

 private:
  void numbers(const std::string& word, std::initializer_list<double> values) {
    text_ += word;
    for (const double x : values) {
      text_ += ' ';
      usd::add_number(text_, static_cast<float>(x));
    }
    text_ += '\n';
  }

  void map(const std::string& word, const TextureUse& use, const std::string& options = "") {
    if (!use) return;
    if (use.uv_set > 0) {
      lost_.insert("textures on the second texture coordinates");
      return;
    }
    if (use.turn != 0) lost_.insert("turns of textures");
    text_ += word + options;
    // Some readers expect all three numbers.
    const auto row = [&](const char* option, const Vec2& v, const char* third) {
      text_ += option;
      for (int k = 0; k < 2; ++k) {
        text_ += ' ';
        usd::add_number(text_, static_cast<float>(v[k]));
      }
      text_ += third;
    };
    if (use.scale != Vec2::Ones()) row(" -s", use.scale, " 1");
    if (!use.offset.isZero(0)) row(" -o", use.offset, " 0");
    constexpr int clamp = 33071, repeat = 10497;
    if (use.wrap[0] == clamp && use.wrap[1] == clamp)
      text_ += " -clamp on";
    else if (use.wrap[0] != repeat || use.wrap[1] != repeat)
      lost_.insert("mirrored textures");
    text_ += ' ' + files_[use.image] + '\n';
  }

  void material(const PreviewMaterial& m) {
    constexpr double max_exponent = 1000;
    text_ += "\nnewmtl " + m.name + '\n';
    numbers("Kd", {m.base[0], m.base[1], m.base[2]});
    const double smooth = 1 - m.roughness;
    numbers("Ns", {max_exponent * smooth * smooth});
    numbers("Pr", {m.roughness});
    numbers("Pm", {m.metallic});
    const bool opaque = m.alpha == PreviewMaterial::Alpha::opaque;
    numbers("d", {opaque ? 1 : m.base[3]});
    if (!m.emissive.isZero(0)) numbers("Ke", {m.emissive.x(), m.emissive.y(), m.emissive.z()});
    if (m.clearcoat > 0) {
      numbers("Pc", {m.clearcoat});
      numbers("Pcr", {m.clearcoat_roughness});
    }
    text_ += "illum 2\n";
    map("map_Kd", m.base_texture);
    if (!opaque) map("map_d", m.base_texture, " -imfchan m");
    map("map_Pr", m.surface_texture, " -imfchan g");
    map("map_Pm", m.surface_texture, " -imfchan b");
    std::string strength;
    if (m.normal_texture.strength != 1) {
      strength = " -bm ";
      usd::add_number(strength, static_cast<float>(m.normal_texture.strength));
    }
    map("norm", m.normal_texture, strength);
    map("map_Ke", m.emissive_texture);
    if (m.occlusion_texture) lost_.insert("occlusion");
    if (m.alpha == PreviewMaterial::Alpha::mask) lost_.insert("alphaCutoff");
    if (m.double_sided) lost_.insert("doubleSided");
    if (m.ior != 1.5) lost_.insert("KHR_materials_ior");
  }

  const PreviewMaterials& from_;
  const std::vector<std::string>& files_;
  std::set<std::string> lost_;
  std::vector<std::string>& left_out_;
  std::string text_ = "# materials by Kerf\n";
};

}  // namespace

ImageFiles image_files(const MaterialLibrary& library, const std::string& prefix) {
  PreviewMaterials from = preview_materials(library);
  const auto names = image_file_names(from, prefix);
  ImageFiles files;
  for (std::size_t i = 0; i < names.size(); ++i) files.images.push_back({names[i], std::move(from.images[i].bytes)});
  files.left_out.assign(from.lost.begin(), from.lost.end());
  return files;
}

MtlFiles mtl_files(const std::vector<std::string>& groups, const MaterialLibrary& library, const std::string& prefix) {
  PreviewMaterials from = preview_materials(library);
  const auto names = image_file_names(from, prefix);
  MtlFiles files;
  files.mtl = MtlWriter(from, names, files.left_out).write(groups);
  for (std::size_t i = 0; i < names.size(); ++i)
    if (files.mtl.find(' ' + names[i] + '\n') != std::string::npos)
      files.images.push_back({names[i], std::move(from.images[i].bytes)});
  return files;
}

std::vector<std::string> save_obj(const std::string& path, TriangleMesh mesh) {
  std::vector<std::string> left_out;
  Attributes& a = mesh.attributes;
  const bool materials = a.library.glb && !a.group.empty();
  const fs::path folder = fs::path(path).parent_path();
  if (path == "-") {
    if (materials) left_out.push_back("materials but their names");
  } else if (materials) {
    const std::string stem = fs::path(path).stem().string();
    MtlFiles files = mtl_files(a.group_names, a.library, stem + "_");
    for (const BesideFile& image : files.images) write_beside(folder.string(), image);
    a.materials = stem + ".mtl";
    write_beside(folder.string(), {a.materials, files.mtl});
    left_out = std::move(files.left_out);
  } else if (std::error_code failed; !a.materials.empty() && !fs::exists(folder / a.materials, failed)) {
    a.materials.clear();
  }
  if (!a.uv2.empty()) left_out.push_back("second texture coordinates");
  if (mesh.unit > 0 && mesh.unit != 1) left_out.push_back("the unit");
  a.library = {};
  write_all(path, [&](std::ostream& out) { write_obj(out, mesh); });
  return left_out;
}

void write_beside(const std::string& folder, const BesideFile& file) {
  write_all((fs::path(folder) / file.name).string(), [&](std::ostream& out) { out << file.bytes; });
}

}  // namespace geo
