// The content of kerf.picture(), as the renderer of kerf-view takes it.
#pragma once

#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "kerf/progress.h"
#include "view/compose.h"

namespace kerf_python {

/// The nodes of a picture.
struct DrawnNodes {
  std::vector<geo::Vec3> positions;
  std::vector<double> spacing;                             ///< per node, model units: a node's size
  std::vector<double> values;                              ///< per node: colours by a scale; empty: by spacing
  std::vector<std::pair<std::size_t, std::size_t>> edges;  ///< pairs of nodes, drawn as sticks
};

/// A picture: its content, its look, and from where it is seen.
struct Drawing {
  std::vector<const geo::TriangleMesh*> surfaces;   ///< drawn as one
  std::vector<const geo::TriangleMesh*> obstacles;  ///< rigid, grey
  std::vector<double> values;  ///< per vertex of all surfaces: colours by a scale; empty: by look.coloring
  std::optional<std::pair<double, double>> range;  ///< of the scale; without: lowest to highest value
  DrawnNodes nodes;
  bool ground = true;
  view::Look look;
  view::Camera camera;
  view::RenderOptions options;
};

/// Draws it. Throws geo::InputError for values or edges that do not fit the content.
view::Picture draw(const Drawing& drawing, const geo::Progress& progress);

}  // namespace kerf_python
