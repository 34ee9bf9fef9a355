#include "io/usd_file.h"

#include <charconv>
#include <numeric>
#include <string>

namespace geo {
namespace {

// In the shortest form that reads back the same.
void add(std::string& text, auto x) {
  char digits[32];
  text.append(digits, std::to_chars(digits, digits + sizeof digits, x).ptr);
}

void add_list(std::string& text, std::size_t count, const auto& item) {
  text += '[';
  for (std::size_t i = 0; i < count; ++i) {
    if (i > 0) text += ", ";
    item(i);
  }
  text += ']';
}

template <class Row>
void add_tuple(std::string& text, const Row& row) {
  text += '(';
  for (int k = 0; k < row.size(); ++k) {
    if (k > 0) text += ", ";
    add(text, float(row[k]));
  }
  text += ')';
}

std::string points_of(const TriangleMesh& m) {
  std::string text;
  add_list(text, m.vertices.size(), [&](std::size_t v) { add_tuple(text, m.vertices[v]); });
  return text;
}

std::string counts_of(const TriangleMesh& m) {
  std::string text;
  add_list(text, m.triangles.size(), [&](std::size_t) { text += '3'; });
  return text;
}

std::string corners_of_triangles(const TriangleMesh& m) {
  std::string text;
  add_list(text, 3 * m.triangles.size(), [&](std::size_t i) { add(text, m.triangles[i / 3][i % 3]); });
  return text;
}

std::int32_t patch_of(const TriangleMesh& m, std::size_t t) { return m.patch.empty() ? 0 : m.patch[t]; }

std::string patches_of(const TriangleMesh& m) {
  std::string text;
  add_list(text, m.triangles.size(), [&](std::size_t t) { add(text, patch_of(m, t)); });
  return text;
}

std::string subset_of(const TriangleMesh& m, bool crack) {
  std::vector<std::size_t> rows;
  for (std::size_t t = 0; t < m.triangles.size(); ++t)
    if ((patch_of(m, t) != 0) == crack) rows.push_back(t);
  std::string text;
  add_list(text, rows.size(), [&](std::size_t i) { add(text, rows[i]); });
  return text;
}

std::string uv_of(const TriangleMesh& m) {
  std::string text;
  const auto& uv = m.attributes.uv;
  add_list(text, 3 * uv.size(), [&](std::size_t i) { add_tuple(text, uv[i / 3][i % 3]); });
  return text;
}

using Frames = std::vector<std::size_t>;

// A sample is what holds until the next: one that says the same is left out. `frames`: the others are like those before them.
void add_samples(std::ostream& out, const std::string& margin, const std::string& declaration, const Frames& frames, const auto& frame, const auto& text_of) {
  out << margin << declaration << ".timeSamples = {\n";
  std::string last;
  std::size_t written = 0;
  for (const std::size_t i : frames) {
    std::string text = text_of(frame(i));
    if (i > 0 && text == last) continue;
    // Points between two samples would be interpolated from where they last changed.
    if (i > written + 1) out << margin << "    " << i - 1 << ": " << last << ",\n";
    out << margin << "    " << i << ": " << text << ",\n";
    last = std::move(text), written = i;
  }
  out << margin << "}\n";
}

Frames all_frames(const UsdRun& run) {
  Frames all(run.frames);
  std::iota(all.begin(), all.end(), 0);
  return all;
}

bool same_rows(const TriangleMesh& a, const TriangleMesh& b) { return a.triangles == b.triangles && a.patch == b.patch && a.attributes.uv == b.attributes.uv; }

void add_subset(std::ostream& out, const std::string& name, const UsdRun& run, const Frames& cut, bool crack) {
  out << "\n        def GeomSubset \"" << name << "\" (\n            prepend apiSchemas = [\"MaterialBindingAPI\"]\n        )\n        {\n"
      << "            uniform token elementType = \"face\"\n            uniform token familyName = \"materialBind\"\n            rel material:binding = </run/materials/" << name << ">\n";
  add_samples(out, "            ", "int[] indices", cut, run.surface, [&](const TriangleMesh& m) { return subset_of(m, crack); });
  out << "        }\n";
}

void add_material(std::ostream& out, const std::string& name, const std::string& color) {
  out << "        def Material \"" << name << "\"\n        {\n            token outputs:surface.connect = </run/materials/" << name << "/preview.outputs:surface>\n\n"
      << "            def Shader \"preview\"\n            {\n                uniform token info:id = \"UsdPreviewSurface\"\n                color3f inputs:diffuseColor = " << color
      << "\n                float inputs:roughness = 0.6\n                token outputs:surface\n            }\n        }\n";
}

void begin_mesh(std::ostream& out, const std::string& name, const std::string& material) {
  out << "    def Mesh \"" << name << "\" (\n        prepend apiSchemas = [\"MaterialBindingAPI\"]\n    )\n    {\n        uniform token subdivisionScheme = \"none\"\n"
      << "        rel material:binding = </run/materials/" << material << ">\n";
}

}  // namespace

void write_usda(std::ostream& out, const UsdRun& run) {
  out << "#usda 1.0\n(\n    defaultPrim = \"run\"\n    metersPerUnit = 1\n    upAxis = \"" << run.up << "\"\n    startTimeCode = 0\n    endTimeCode = " << (run.frames > 0 ? run.frames - 1 : 0)
      << "\n    timeCodesPerSecond = " << run.frame_rate << "\n)\n\ndef Xform \"run\" (\n    kind = \"component\"\n)\n{\n";
  begin_mesh(out, "body", "skin");
  out << "        uniform token subsetFamily:materialBind:familyType = \"partition\"\n";
  Frames cut;  // those with other triangles than the one before
  TriangleMesh last;
  std::size_t next = 0;
  add_samples(out, "        ", "point3f[] points", all_frames(run), run.surface, [&](TriangleMesh m) {
    std::string points = points_of(m);
    if (next == 0 || !same_rows(m, last)) cut.push_back(next), last = std::move(m);
    ++next;
    return points;
  });
  const auto body = [&](const std::string& declaration, const auto& text_of) { add_samples(out, "        ", declaration, cut, run.surface, text_of); };
  body("int[] faceVertexCounts", counts_of);
  body("int[] faceVertexIndices", corners_of_triangles);
  out << "        int[] primvars:patch (\n            interpolation = \"uniform\"\n        )\n";
  body("int[] primvars:patch", patches_of);
  if (!last.attributes.uv.empty()) {
    out << "        texCoord2f[] primvars:st (\n            interpolation = \"faceVarying\"\n        )\n";
    body("texCoord2f[] primvars:st", uv_of);
  }
  add_subset(out, "skin", run, cut, false);
  add_subset(out, "crack", run, cut, true);
  out << "    }\n";
  if (run.frames > 0 && run.obstacles) {
    out << '\n';
    begin_mesh(out, "obstacles", "obstacle");
    const TriangleMesh first = run.obstacles(0);
    out << "        int[] faceVertexCounts = " << counts_of(first) << "\n        int[] faceVertexIndices = " << corners_of_triangles(first) << '\n';
    add_samples(out, "        ", "point3f[] points", all_frames(run), run.obstacles, points_of);
    out << "    }\n";
  }
  out << "\n    def Scope \"materials\"\n    {\n";
  add_material(out, "skin", "(0.75, 0.22, 0.04)");
  add_material(out, "crack", "(0.86, 0.66, 0.2)");
  if (run.obstacles) add_material(out, "obstacle", "(0.42, 0.43, 0.45)");
  out << "    }\n}\n";
}

}  // namespace geo
