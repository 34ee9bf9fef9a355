// io/surface_other.h. Most formats begin with words of their own.
#include "io/surface_other.h"

#include <algorithm>
#include <array>
#include <filesystem>

#include "io/surface_assimp.h"
#include "io/surface_formats.h"
#include "kerf/error.h"
#include "kerf/files.h"

namespace geo {
namespace {

struct Beginning {
  const char *text, *what, *ending;
};
constexpr std::array<Beginning, 17> beginnings = {{{"glTF", "a glTF file", "glb"},
                                                   {"Kaydara FBX", "an FBX file", "fbx"},
                                                   {"; FBX", "an FBX file", "fbx"},
                                                   {"FORM", "a LightWave file", "lwo"},
                                                   {"AC3D", "an AC3D file", "ac"},
                                                   {"xof 0", "a DirectX file", "x"},
                                                   {"IDP2", "an MD2 file", "md2"},
                                                   {"MS3D000000", "a MilkShape file", "ms3d"},
                                                   {"BB3D", "a Blitz3D file", "b3d"},
                                                   {"Caligari", "a trueSpace file", "cob"},
                                                   {"*3DSMAX", "an ASE file", "ase"},
                                                   {"BLENDER", "a Blender file", ""},
                                                   {"\x1f\x8b", "a compressed file", ""},
                                                   {"(\xb5/\xfd", "a compressed file", ""},
                                                   {"PXR-USDC", "a USD file", ""},
                                                   {"#usda", "a USD file", ""},
                                                   {"ISO-10303-21", "a STEP or IFC file", ""}}};

// The first bytes without leading blanks.
std::string_view head_of(const std::string& bytes) {
  const auto at = std::min(bytes.find_first_not_of(" \t\r\n"), bytes.size());
  return std::string_view(bytes).substr(at, 4096);
}

OtherFormat by_xml(std::string_view head) {
  const auto has = [&](const char* text) { return head.find(text) != head.npos; };
  if (has("<COLLADA")) return {"a COLLADA file", "dae"};
  if (has("<X3D")) return {"an X3D file", "x3d"};
  if (has("<amf")) return {"an AMF file", "amf"};
  return {"an XML file", ""};
}

// The main chunk of 3D Studio is as long as the file, or shorter.
bool looks_like_3ds(const std::string& bytes) {
  if (bytes.size() < 16 || bytes[0] != 'M' || bytes[1] != 'M') return false;
  std::uint32_t length = 0;
  for (std::size_t i = 0; i < 4; ++i) length |= std::uint32_t(static_cast<unsigned char>(bytes[2 + i])) << (8 * i);
  return length > 6 && length <= bytes.size();
}

std::string ending_of(const std::string& name) {
  std::string ending = std::filesystem::path(name).extension().string();
  if (!ending.empty()) ending.erase(0, 1);
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

// Endings of formats that Kerf reads itself, or that assimp reads badly.
bool left_out(const std::string& ending) {
  static constexpr const char* endings[] = {"obj",  "ply", "stl", "off", "blend", "ifc", "ifczip",
                                            "step", "stp", "raw", "xml", "zip",   "pk3"};
  return ending.empty() || std::find(std::begin(endings), std::end(endings), ending) != std::end(endings);
}

}  // namespace

OtherFormat other_format(const std::string& bytes, const std::string& name) {
  const std::string ending = ending_of(name);
  for (const auto& [text, what, by] : beginnings)
    if (bytes.rfind(text, 0) == 0) return {what, by};
  if (bytes.rfind("PK\3\4", 0) == 0)
    return ending == "3mf" || ending == "zae" ? OtherFormat{"a " + ending + " file", ending}
                                              : OtherFormat{"a zipped file", ""};
  if (looks_like_3ds(bytes)) return {"a 3DS file", "3ds"};
  const std::string_view head = head_of(bytes);
  if (head.starts_with("<?xml") || head.starts_with("<COLLADA")) return by_xml(head);
  if (head.starts_with("{")) {
    const bool gltf = bytes.find("\"asset\"") != bytes.npos || bytes.find("\"scenes\"") != bytes.npos;
    return gltf ? OtherFormat{"a glTF file", "gltf"} : OtherFormat{"a JSON file", ""};
  }
  if (!left_out(ending) && assimp_reads(ending)) return {"a file in ." + ending, ending};
  return {};
}

SurfaceFile parse_other(const std::string& bytes, const std::string& name, const OtherFormat& format) {
  const std::string save = "; save it as glTF, PLY, OBJ, STL or OFF";
  if (format.ending.empty()) throw InputError(name + ": is " + format.what + ", which is not read here" + save);
  if (format.ending == "glb" || format.ending == "gltf") return parse_gltf(bytes, name);
  return parse_by_assimp(bytes, name, format);
}

}  // namespace geo
