// write_usda() of kerf/export.h. USD as text (.usda): a mesh with time samples for each value
// that changes. Frames are read and printed on several threads, and written in order.
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <type_traits>

#include "io/usd_text.h"
#include "kerf/export.h"
#include "kerf/parallel.h"

namespace geo {
namespace {

using namespace usd;

std::string subset_of(const TriangleMesh& m, bool crack) {
  std::vector<std::size_t> rows;
  for (std::size_t t = 0; t < m.triangles.size(); ++t)
    if ((patch_of(m, t) != 0) == crack) rows.push_back(t);
  std::string text;
  add_list(text, rows.size(), [&](std::size_t i) { add_number(text, rows[i]); });
  return text;
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
  return a.triangles == b.triangles && a.patch == b.patch && a.attributes.uv == b.attributes.uv;
}

// The arrays that same_rows() compares.
TriangleMesh rows_of(TriangleMesh&& m) {
  TriangleMesh rows;
  rows.triangles = std::move(m.triangles);
  rows.patch = std::move(m.patch);
  rows.attributes.uv = std::move(m.attributes.uv);
  return rows;
}

void add_subset(std::ostream& out, const std::string& name, const Frames& cut, const auto& rows, bool crack) {
  out << "\n        def GeomSubset \"" << name
      << "\" (\n            prepend apiSchemas = [\"MaterialBindingAPI\"]\n        )\n        {\n"
      << "            uniform token elementType = \"face\"\n            uniform token familyName = \"materialBind\"\n  "
         "          rel material:binding = </run/materials/"
      << name << ">\n";
  add_samples(out, "            ", "int[] indices", cut, rows,
              [&](const TriangleMesh& m) { return subset_of(m, crack); });
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
  const Vec3 offset = run.frames > 0 ? single_precision_offset(bounding_box(run.surface(0))) : Vec3(Vec3::Zero());
  if (!offset.isZero(0)) {
    std::string text;
    add_translation(text, "    ", offset);
    out << text;
  }
  begin_mesh(out, "body", "skin");
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
  if (!last.attributes.uv.empty()) {
    out << "        texCoord2f[] primvars:st (\n            interpolation = \"faceVarying\"\n        )\n";
    body("texCoord2f[] primvars:st", [](const TriangleMesh& m) { return uv_of(m.attributes.uv); });
  }
  add_subset(out, "skin", cut, rows, false);
  add_subset(out, "crack", cut, rows, true);
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
  add_material(out, "skin", "(0.75, 0.22, 0.04)");
  add_material(out, "crack", "(0.86, 0.66, 0.2)");
  if (run.obstacles) add_material(out, "obstacle", "(0.42, 0.43, 0.45)");
  out << "    }\n}\n";
}

}  // namespace geo
