// Composes a stage from a subject: colours, cut-away, exploded pieces, nodes and edges.
#pragma once

#include <optional>
#include <string>

#include "view/raytrace.h"
#include "view/subject.h"

namespace view {

/// A cut-away relative to the stage: through its centre, moved along the normal by `offset` half
/// diagonals.
struct RelativePlane {
  geo::Vec3 normal;
  double offset = 0;
};

/// `model`: as the model's materials and colours say, where it has them, else as `patch`.
enum class Coloring { model, patch, piece, plain };

struct Look {
  Coloring coloring = Coloring::model;
  Color skin{0.80f, 0.36f, 0.10f};
  bool nodes = false, edges = false, wire = false, section = true;
  std::string field = "radius";       ///< colours the nodes, see fields.h
  bool cut_edges = false;             ///< draw the edges that cracks have cut, in red
  bool seams = false;                 ///< where cracks meet the skin (green) and where they end (red)
  bool trees = false;                 ///< masters and their trees of slaves
  std::optional<std::uint32_t> node;  ///< this node's neighbourhood
  std::size_t first_step = 0, last_step = ~std::size_t(0);  ///< of fronts
  const geo::Body* before =
      nullptr;  ///< an earlier state of the body: cut edges are those it had, updated nodes are red
  double opacity = 1;
  bool sheets = false;  ///< sheets of cracks stay opaque in a skin that is not
  double explode = 0;   ///< pieces move apart by this fraction of their distance from the middle
  std::optional<RelativePlane> cutaway;
  bool inside() const {
    return nodes || edges || cut_edges || trees || node;
  }  ///< something within the surface is drawn
};

/// The colouring of this name: "model", "patch", "piece" or "plain".
Coloring coloring_of(const std::string& name);

/// "#rrggbb" as linear light. Throws geo::InputError.
Color parse_color(const std::string& text);

/// A perceptual scale from dark blue (0) over green to yellow (1).
Color viridis(double t);

/// Throws InputError for a node or field that the subject does not have.
Stage stage_of(const Subject& subject, const Look& look);

/// The box of everything on a stage, spheres and sticks included.
geo::Box3 box_of(const Stage& stage);
/// The box that a picture shows: the same, but of obstacles only parts within a quarter of its
/// diagonal.
geo::Box3 frame_of(const Stage& stage);
/// Adds to `points` the points of the stage, clamped to `frame`, that are extreme in one of some
/// hundred directions.
void add_outermost(const Stage& stage, const geo::Box3& frame, std::vector<geo::Vec3>& points);

}  // namespace view
