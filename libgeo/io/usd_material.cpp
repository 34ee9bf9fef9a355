// io/usd_material.h. Nodes and inputs are those of the specification of UsdPreviewSurface. Colours
// are linear there, as in glTF.
#include "io/usd_material.h"

#include <numbers>

#include "io/usd_text.h"

namespace geo::usd {
namespace {

const char* wrap_name(int wrap) { return wrap == 33071 ? "clamp" : wrap == 33648 ? "mirror" : "repeat"; }

// Writes one material.
class MaterialWriter {
 public:
  MaterialWriter(const Line& line, std::string path, const PreviewMaterial& m, const std::vector<std::string>& images)
      : line_(line), path_(std::move(path)), m_(m), images_(images) {}

  void write(const std::string& name) {
    open("Material", name);
    line_("token outputs:surface.connect = <" + path_ + "/preview.outputs:surface>");
    surface();
    for (std::size_t i = 0; i < textures_.size(); ++i) texture(i);
    close();
  }

 private:
  // A texture node: `scale` and `bias` map what the image holds to the input.
  struct Node {
    std::string name;
    const TextureUse* use;
    Color scale, bias;
    bool color;  // of colours, in sRGB, else of numbers
  };

  void open(const std::string& type, const std::string& name) {
    line_("def " + type + " \"" + name + "\"");
    line_("{");
  }
  void close() { line_("}"); }

  bool has(const TextureUse& use) const { return use && use.image < images_.size(); }

  std::string output(const std::string& node, const char* channel) const {
    return "<" + path_ + "/" + node + ".outputs:" + channel + ">";
  }

  // An input with the texture of `node`, or with its value.
  void input(const std::string& declaration, const TextureUse& use, const std::string& node, const char* channel,
             const std::string& value) {
    if (has(use))
      line_(declaration + ".connect = " + output(node, channel));
    else
      line_(declaration + " = " + value);
  }

  void surface() {
    open("Shader", "preview");
    line_("uniform token info:id = \"UsdPreviewSurface\"");
    const bool opaque = m_.alpha == PreviewMaterial::Alpha::opaque;
    input("color3f inputs:diffuseColor", m_.base_texture, "base", "rgb", usd_tuple(Vec3(m_.base.head<3>())));
    if (!opaque) input("float inputs:opacity", m_.base_texture, "base", "a", usd_number(m_.base[3]));
    if (m_.alpha == PreviewMaterial::Alpha::mask) line_("float inputs:opacityThreshold = " + usd_number(m_.cutoff));
    input("float inputs:roughness", m_.surface_texture, "surface", "g", usd_number(m_.roughness));
    input("float inputs:metallic", m_.surface_texture, "surface", "b", usd_number(m_.metallic));
    if (!m_.emissive.isZero(0))
      input("color3f inputs:emissiveColor", m_.emissive_texture, "emissive", "rgb", usd_tuple(m_.emissive));
    if (has(m_.normal_texture)) line_("normal3f inputs:normal.connect = " + output("normal", "rgb"));
    if (has(m_.occlusion_texture)) line_("float inputs:occlusion.connect = " + output("occlusion", "r"));
    if (m_.clearcoat > 0) {
      line_("float inputs:clearcoat = " + usd_number(m_.clearcoat));
      line_("float inputs:clearcoatRoughness = " + usd_number(m_.clearcoat_roughness));
    }
    if (m_.ior != 1.5) line_("float inputs:ior = " + usd_number(m_.ior));
    line_("token outputs:surface");
    close();
    list_textures();
  }

  void list_textures() {
    const Color none = Color::Zero();
    const auto add = [&](const std::string& name, const TextureUse& use, const Color& scale, const Color& bias,
                         bool color) {
      if (has(use)) textures_.push_back({.name = name, .use = &use, .scale = scale, .bias = bias, .color = color});
    };
    add("base", m_.base_texture, m_.base, none, true);
    add("surface", m_.surface_texture, Color(1, m_.roughness, m_.metallic, 1), none, false);
    const double n = m_.normal_texture.strength, o = m_.occlusion_texture.strength;
    add("normal", m_.normal_texture, Color(2 * n, 2 * n, 2, 1), Color(-n, -n, -1, 0), false);
    add("occlusion", m_.occlusion_texture, Color(o, o, o, 1), Color(1 - o, 1 - o, 1 - o, 0), false);
    if (!m_.emissive.isZero(0))
      add("emissive", m_.emissive_texture, Color(m_.emissive.x(), m_.emissive.y(), m_.emissive.z(), 1), none, true);
  }

  // A texture, the reader of its coordinates, and their transform where there is one.
  void texture(std::size_t which) {
    const Node& node = textures_[which];
    const TextureUse& use = *node.use;
    const std::string reader = node.name + "_uv", transform = node.name + "_transform";
    open("Shader", reader);
    line_("uniform token info:id = \"UsdPrimvarReader_float2\"");
    line_("string inputs:varname = \"" + std::string(use.uv_set == 0 ? "st" : "st1") + "\"");
    line_("float2 outputs:result");
    close();
    if (use.moved()) {
      open("Shader", transform);
      line_("uniform token info:id = \"UsdTransform2d\"");
      line_("float2 inputs:in.connect = " + output(reader, "result"));
      line_("float inputs:rotation = " + usd_number(use.turn * 180 / std::numbers::pi));
      line_("float2 inputs:scale = " + usd_tuple(use.scale));
      line_("float2 inputs:translation = " + usd_tuple(use.offset));
      line_("float2 outputs:result");
      close();
    }
    open("Shader", node.name);
    line_("uniform token info:id = \"UsdUVTexture\"");
    line_("asset inputs:file = @./" + images_[use.image] + "@");
    line_("float2 inputs:st.connect = " + output(use.moved() ? transform : reader, "result"));
    line_("token inputs:sourceColorSpace = \"" + std::string(node.color ? "sRGB" : "raw") + "\"");
    line_("token inputs:wrapS = \"" + std::string(wrap_name(use.wrap[0])) + "\"");
    line_("token inputs:wrapT = \"" + std::string(wrap_name(use.wrap[1])) + "\"");
    if (node.scale != Color::Ones()) line_("float4 inputs:scale = " + usd_tuple(node.scale));
    if (!node.bias.isZero(0)) line_("float4 inputs:bias = " + usd_tuple(node.bias));
    for (const char* channel : {"r", "g", "b", "a"}) line_("float outputs:" + std::string(channel));
    line_("float3 outputs:rgb");
    close();
  }

  const Line& line_;
  const std::string path_;  // of the material
  const PreviewMaterial& m_;
  const std::vector<std::string>& images_;
  std::vector<Node> textures_;
};

}  // namespace

void write_material(const Line& line, const std::string& path, const std::string& name, const PreviewMaterial& material,
                    const std::vector<std::string>& images) {
  MaterialWriter(line, path + "/" + name, material, images).write(name);
}

}  // namespace geo::usd
