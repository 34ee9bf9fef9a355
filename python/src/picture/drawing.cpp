// The stage is composed as kerf-view does; values and nodes, which come as arrays, are added to it.
#include "drawing.h"

#include <algorithm>
#include <limits>

#include "kerf/error.h"

namespace kerf_python {
namespace {

geo::TriangleMesh joined(const std::vector<const geo::TriangleMesh*>& meshes) {
  geo::TriangleMesh all;
  const bool patches = std::any_of(meshes.begin(), meshes.end(), [](const auto* m) { return !m->patch.empty(); });
  for (const auto* mesh : meshes) {
    const auto first = static_cast<std::uint32_t>(all.vertices.size());
    all.vertices.insert(all.vertices.end(), mesh->vertices.begin(), mesh->vertices.end());
    for (const auto& [a, b, c] : mesh->triangles) all.triangles.push_back({first + a, first + b, first + c});
    if (!patches) continue;
    all.patch.insert(all.patch.end(), mesh->patch.begin(), mesh->patch.end());
    all.patch.resize(all.triangles.size(), 0);
  }
  return all;
}

// A scale from the lowest to the highest value, or the one given.
class Scale {
 public:
  Scale(const std::vector<double>& values, const std::optional<std::pair<double, double>>& range) {
    if (range) {
      low_ = range->first;
      high_ = range->second;
    } else if (!values.empty()) {
      const auto [lo, hi] = std::minmax_element(values.begin(), values.end());
      low_ = *lo;
      high_ = *hi;
    }
  }
  view::Color color(double value) const { return view::viridis(high_ > low_ ? (value - low_) / (high_ - low_) : 0.5); }

 private:
  double low_ = 0, high_ = 1;
};

// A triangle has the mean value of its corners.
void color_triangles(view::Stage& stage, const Drawing& drawing, const geo::TriangleMesh& surface) {
  if (drawing.values.empty()) return;
  if (drawing.values.size() != surface.vertices.size())
    throw geo::InputError("color: " + std::to_string(drawing.values.size()) + " values for " +
                          std::to_string(surface.vertices.size()) + " vertices; give one per vertex");
  const Scale scale(drawing.values, drawing.range);
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    double sum = 0;
    for (const auto v : surface.triangles[t]) sum += drawing.values[v] / 3;
    stage.triangle_colors[t] = stage.back_colors[t] = scale.color(sum);
  }
}

// Surfaces lie in the stage one after another, without their attributes.
void paint_triangles(view::Stage& stage, const Drawing& drawing) {
  std::size_t first = 0;
  for (const auto* mesh : drawing.surfaces) {
    stage.paint.add(view::paint_of(*mesh), first);
    first += mesh->triangles.size();
  }
}

// Nodes and edges that a cut-away does not remove.
void add_nodes(view::Stage& stage, const Drawing& drawing) {
  constexpr view::Color blue{0.10f, 0.22f, 0.55f};  // of edges, as kerf-view draws them
  const auto& nodes = drawing.nodes;
  const auto& values = nodes.values.empty() ? nodes.spacing : nodes.values;
  const auto count = nodes.positions.size();
  if (nodes.spacing.size() != count || values.size() != count)
    throw geo::InputError("nodes: " + std::to_string(values.size()) + " values for " + std::to_string(count) +
                          " nodes; give one per node");
  const auto gone = [&](const geo::Vec3& p) {
    return stage.cutaway && (p - stage.cutaway->point).dot(stage.cutaway->normal) > 0;
  };
  const Scale scale(values, drawing.range && !nodes.values.empty() ? drawing.range : std::nullopt);
  for (std::size_t i = 0; i < count; ++i)
    if (!gone(nodes.positions[i]))
      stage.spheres.push_back({nodes.positions[i], 0.14 * nodes.spacing[i], scale.color(values[i])});
  for (const auto& [i, j] : nodes.edges) {
    if (i >= count || j >= count)
      throw geo::InputError("edges: a node above " + std::to_string(count) + "; correct it");
    if (gone(nodes.positions[i]) || gone(nodes.positions[j])) continue;
    stage.sticks.push_back(
        {nodes.positions[i], nodes.positions[j], 0.016 * std::min(nodes.spacing[i], nodes.spacing[j]), blue});
  }
}

}  // namespace

view::Picture draw(const Drawing& drawing, const geo::Progress& progress) {
  view::Subject subject;
  subject.surface = joined(drawing.surfaces);
  subject.obstacles = joined(drawing.obstacles);
  const auto pause = [&] { geo::report(progress, "render", 0, 1); };
  pause();
  view::Stage stage = view::stage_of(subject, drawing.look);
  pause();
  stage.ground = drawing.ground;
  if (drawing.look.coloring == view::Coloring::model) paint_triangles(stage, drawing);
  color_triangles(stage, drawing, subject.surface);
  add_nodes(stage, drawing);
  pause();
  view::Camera camera = drawing.camera;
  if (const geo::Box3 frame = view::frame_of(stage); !frame.empty()) {
    camera.box = frame;
    view::add_outermost(stage, camera.box, camera.points);
    pause();
  }
  return view::render(stage, camera, drawing.options, progress);
}

}  // namespace kerf_python
