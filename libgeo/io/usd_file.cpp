// write_usda() of kerf/export.h. USD as text (.usda): a mesh with time samples for each value
// that changes. Frames are read and printed on several threads, and written in order.
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <type_traits>

#include "io/preview_material.h"
#include "io/usd_material.h"
#include "io/usd_names.h"
#include "io/usd_text.h"
#include "kerf/export.h"
#include "kerf/parallel.h"

namespace geo {
namespace {

using namespace usd;

std::string subset_of(const TriangleMesh& m, const auto& holds) {
  std::vector<std::size_t> rows;
  for (std::size_t t = 0; t < m.triangles.size(); ++t)
    if (holds(m, t)) rows.push_back(t);
  std::string text;
  add_list(text, rows.size(), [&](std::size_t i) { add_number(text, rows[i]); });
  return text;
}

bool in_crack(const TriangleMesh& m, std::size_t t) { return patch_of(m, t) != 0; }

// Whether a triangle of the skin is of this group.
bool in_group(const TriangleMesh& m, std::size_t t, const std::string& group) {
  const Attributes& a = m.attributes;
  return !in_crack(m, t) && t < a.group.size() && a.group_names[static_cast<std::size_t>(a.group[t])] == group;
}

// The materials of the model's groups, with the prims that have them; empty without a library.
struct RunMaterials {
  PreviewMaterials library;
  std::vector<std::string> images;  // files
  MaterialNames names;
  std::vector<std::string> groups;  // of the skin
};

RunMaterials materials_of(const Attributes& attributes) {
  RunMaterials made;
  if (!attributes.library.glb || attributes.group.empty()) return made;
  made.library = preview_materials(attributes.library);
  made.images = image_file_names(made.library, "run_");
  for (const char* own : {"crack", "obstacle"}) made.names.of(own);
  for (const std::string& group : attributes.group_names)
    if (group != "crack") made.groups.push_back(group);
  for (const std::string& group : made.groups) made.names.of(group);
  return made;
}

using Frames = std::vector<std::size_t>;

// Calls each(i, make(i)) for some frames in order. `make` runs for a few frames at a time, in
// threads.
template <class Make>
void each_in_order(const Frames& frames, const Make& make, const auto& each) {
  const auto batch = static_cast<std::size_t>(threads());
  for (std::size_t first = 0; first < frames.size(); first += batch) {
    std::vector<std::optional<std::invoke_result_t<Make, std::size_t>>> made(std::min(batch, frames.size() - first));
    parallel_for(made.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) made[k].emplace(make(frames[first + k]));
    });
    for (std::size_t k = 0; k < made.size(); ++k) each(frames[first + k], std::move(*made[k]));
  }
}

// Time samples. A sample holds until the next, so an equal one is left out.
class Samples {
 public:
  Samples(std::ostream& out, std::string margin, const std::string& declaration)
      : out_(out), margin_(std::move(margin)) {
    out_ << margin_ << declaration << ".timeSamples = {\n";
  }
  void add(std::size_t i, std::string text) {
    if (i > 0 && text == last_) return;
    // A repeated sample before each change: else readers interpolate from the last change on.
    if (i > written_ + 1) out_ << margin_ << "    " << i - 1 << ": " << last_ << ",\n";
    out_ << margin_ << "    " << i << ": " << text << ",\n";
    last_ = std::move(text);
    written_ = i;
  }
  ~Samples() { out_ << margin_ << "}\n"; }

 private:
  std::ostream& out_;
  std::string margin_, last_;
  std::size_t written_ = 0;
};

void add_samples(std::ostream& out, const std::string& margin, const std::string& declaration, const Frames& frames,
                 const auto& frame, const auto& text_of) {
  Samples samples(out, margin, declaration);
  each_in_order(
      frames, [&](std::size_t i) { return text_of(frame(i)); },
      [&](std::size_t i, std::string text) { samples.add(i, std::move(text)); });
}

Frames all_frames(const UsdRun& run) {
  Frames all(run.frames);
  std::iota(all.begin(), all.end(), 0);
  return all;
}

bool same_rows(const TriangleMesh& a, const TriangleMesh& b) {
  return a.triangles == b.triangles && a.patch == b.patch && a.attributes.uv == b.attributes.uv &&
         a.attributes.uv2 == b.attributes.uv2 && a.attributes.group == b.attributes.group &&
         a.attributes.group_names == b.attributes.group_names;
}

// The arrays that same_rows() compares.
TriangleMesh rows_of(TriangleMesh&& m) {
  TriangleMesh rows;
  rows.triangles = std::move(m.triangles);
  rows.patch = std::move(m.patch);
  rows.attributes = std::move(m.attributes);
  rows.attributes.normal.clear();
  rows.attributes.color.clear();
  return rows;
}

void add_subset(std::ostream& out, const std::string& name, const Frames& cut, const auto& rows, const auto& holds) {
  out << "\n        def GeomSubset \"" << name
      << "\" (\n            prepend apiSchemas = [\"MaterialBindingAPI\"]\n        )\n        {\n"
      << "            uniform token elementType = \"face\"\n            uniform token familyName = \"materialBind\"\n  "
         "          rel material:binding = </run/materials/"
      << name << ">\n";
  add_samples(out, "            ", "int[] indices", cut, rows,
              [&](const TriangleMesh& m) { return subset_of(m, holds); });
  out << "        }\n";
}

void add_material(std::ostream& out, const std::string& name, const std::string& color) {
  out << "        def Material \"" << name
      << "\"\n        {\n            token outputs:surface.connect = </run/materials/" << name
      << "/preview.outputs:surface>\n\n"
      << "            def Shader \"preview\"\n            {\n                uniform token info:id = "
         "\"UsdPreviewSurface\"\n                color3f inputs:diffuseColor = "
      << color
      << "\n                float inputs:roughness = 0.6\n                token outputs:surface\n            }\n       "
         " }\n";
}

// The materials of the model's groups as preview surfaces.
void add_described(std::ostream& out, RunMaterials& materials) {
  std::size_t depth = 2;
  const auto line = [&](const std::string& text) {
    if (text == "}") --depth;
    out << std::string(4 * depth, ' ') << text << '\n';
    if (text == "{") ++depth;
  };
  std::vector<std::string> all = materials.groups;
  all.push_back("crack");
  for (const std::string& group : all) {
    PreviewMaterial described = plain_material(group);
    for (const PreviewMaterial& known : materials.library.materials)
      if (known.name == group) described = known;
    write_material(line, "/run/materials", materials.names.of(group), described, materials.images);
  }
}

void begin_mesh(std::ostream& out, const std::string& name, const std::string& material) {
  out << "    def Mesh \"" << name
      << "\" (\n        prepend apiSchemas = [\"MaterialBindingAPI\"]\n    )\n    {\n        uniform token "
         "subdivisionScheme = \"none\"\n"
      << "        rel material:binding = </run/materials/" << material << ">\n";
}

}  // namespace

void write_usda(std::ostream& out, const UsdRun& run) {
  out << "#usda 1.0\n(\n    defaultPrim = \"run\"\n    metersPerUnit = 1\n    upAxis = \"" << run.up
      << "\"\n    startTimeCode = 0\n    endTimeCode = " << (run.frames > 0 ? run.frames - 1 : 0)
      << "\n    timeCodesPerSecond = " << run.frame_rate
      << "\n)\n\ndef Xform \"run\" (\n    kind = \"component\"\n)\n{\n";
  const TriangleMesh first_frame = run.frames > 0 ? run.surface(0) : TriangleMesh();
  const Vec3 offset = run.frames > 0 ? single_precision_offset(bounding_box(first_frame)) : Vec3(Vec3::Zero());
  RunMaterials materials = materials_of(first_frame.attributes);
  if (!offset.isZero(0)) {
    std::string text;
    add_translation(text, "    ", offset);
    out << text;
  }
  begin_mesh(out, "body", materials.groups.empty() ? "skin" : materials.names.of(materials.groups[0]));
  out << "        uniform token subsetFamily:materialBind:familyType = \"partition\"\n";
  constexpr std::size_t max_kept = 16;       // larger: more memory, fewer frames are read twice
  Frames cut;                                // whose triangles differ from those of the frame before
  std::map<std::size_t, TriangleMesh> kept;  // of the first of these frames, which are not read again
  TriangleMesh last;
  {
    Samples points(out, "        ", "point3f[] points");
    const auto read = [&](std::size_t i) {
      TriangleMesh m = run.surface(i);
      std::string text = points_of(m, offset);
      return std::pair(std::move(text), std::move(m));
    };
    each_in_order(all_frames(run), read, [&](std::size_t i, auto made) {
      points.add(i, std::move(made.first));
      if (i > 0 && same_rows(made.second, last)) return;
      cut.push_back(i);
      last = rows_of(std::move(made.second));
      if (kept.size() < max_kept) kept.emplace(i, last);
    });
  }
  const auto rows = [&](std::size_t i) { return kept.contains(i) ? kept.at(i) : run.surface(i); };
  const auto body = [&](const std::string& declaration, const auto& text_of) {
    add_samples(out, "        ", declaration, cut, rows, text_of);
  };
  body("int[] faceVertexCounts", counts_of);
  body("int[] faceVertexIndices", corners_of_triangles);
  out << "        int[] primvars:patch (\n            interpolation = \"uniform\"\n        )\n";
  body("int[] primvars:patch", patches_of);
  const auto places = [&](const std::string& name, auto Attributes::*member) {
    if ((last.attributes.*member).empty()) return;
    const std::string declaration = "texCoord2f[] primvars:" + name;
    out << "        " << declaration << " (\n            interpolation = \"faceVarying\"\n        )\n";
    body(declaration, [&](const TriangleMesh& m) { return uv_of(m.attributes.*member); });
  };
  places("st", &Attributes::uv);
  places("st1", &Attributes::uv2);
  if (materials.groups.empty())
    add_subset(out, "skin", cut, rows, [](const TriangleMesh& m, std::size_t t) { return !in_crack(m, t); });
  for (const std::string& group : materials.groups)
    add_subset(out, materials.names.of(group), cut, rows,
               [&](const TriangleMesh& m, std::size_t t) { return in_group(m, t, group); });
  add_subset(out, "crack", cut, rows, in_crack);
  out << "    }\n";
  if (run.frames > 0 && run.obstacles) {
    out << '\n';
    begin_mesh(out, "obstacles", "obstacle");
    const TriangleMesh first = run.obstacles(0);
    out << "        int[] faceVertexCounts = " << counts_of(first)
        << "\n        int[] faceVertexIndices = " << corners_of_triangles(first) << '\n';
    add_samples(out, "        ", "point3f[] points", all_frames(run), run.obstacles,
                [&](const TriangleMesh& m) { return points_of(m, offset); });
    out << "    }\n";
  }
  out << "\n    def Scope \"materials\"\n    {\n";
  if (materials.groups.empty()) {
    add_material(out, "skin", "(0.75, 0.22, 0.04)");
    add_material(out, "crack", "(0.86, 0.66, 0.2)");
  } else {
    add_described(out, materials);
  }
  if (run.obstacles) add_material(out, "obstacle", "(0.42, 0.43, 0.45)");
  out << "    }\n}\n";
}

}  // namespace geo
