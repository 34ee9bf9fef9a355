// From what files hold to what is drawn: colours, cut-away, exploded pieces, nodes and edges.
#pragma once

#include <optional>
#include <string>

#include "body/body.h"
#include "crack/front.h"
#include "sampling/node_set.h"
#include "view/raytrace.h"

namespace view {

/// A cut-away relative to what is drawn: through the middle, moved along the normal by `offset` half diagonals.
struct RelativePlane {
  geo::Vec3 normal;
  double offset = 0;
};

enum class Coloring { patch, piece, plain };

struct Look {
  Coloring coloring = Coloring::patch;
  Color skin{0.80f, 0.36f, 0.10f};
  bool nodes = false, edges = false, wire = false, section = true;
  double opacity = 1;
  bool sheets = false;  ///< sheets of cracks stay opaque in a skin that is not
  double explode = 0;  ///< pieces move apart by this fraction of their distance from the middle
  std::optional<RelativePlane> cutaway;
};

/// "#rrggbb" as linear light. Throws geo::InputError.
Color parse_color(const std::string& text);

/// A perceptual scale from dark blue (0) over green to yellow (1).
Color viridis(double t);

Stage stage_of(const geo::TriangleMesh& surface, const Look& look);
Stage stage_of(const geo::NodeSet& nodes, const Look& look);
Stage stage_of(const geo::Body& body, const Look& look);
Stage stage_of(const std::vector<geo::Front>& fronts, const Look& look);

/// The box of everything on a stage, spheres and sticks included.
geo::Box3 box_of(const Stage& stage);

}  // namespace view
