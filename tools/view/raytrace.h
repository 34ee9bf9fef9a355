// A small ray tracer (Embree): a surface with coloured crack sheets, nodes, edges, and a cut-away
// with filled section.
#pragma once

#include <optional>
#include <vector>

#include <kerf/mesh.h>
#include <kerf/progress.h>
#include "view/paint.h"
#include "view/picture.h"

namespace view {

struct Sphere {
  geo::Vec3 center;
  double radius;
  Color color;
};
struct Stick {
  geo::Vec3 a, b;
  double radius;
  Color color;
};
/// The side of the plane through `point` that `normal` points to is cut away.
struct Plane {
  geo::Vec3 point, normal;
};

/// The content of a picture. A filled section requires a closed surface.
struct Stage {
  geo::TriangleMesh surface;
  std::vector<Color> triangle_colors;  ///< per triangle
  std::vector<Color> back_colors;      ///< per triangle, seen from behind; empty: the same
  Paint paint;                         ///< of triangles; those that have it have no other colour
  std::vector<Sphere> spheres;
  std::vector<Stick> sticks;
  std::size_t obstacles = 0;  ///< number of triangles of obstacles, the last ones
  std::optional<Plane> cutaway;
  double surface_opacity = 1;  ///< below 1, nodes and edges inside are visible
  bool sheets_opaque = false;  ///< crack sheets (surface.patch) are opaque, whatever the skin is
  bool section = true;         ///< fill the section of the cut-away
  bool ground = true;          ///< draw a floor with a soft shadow
  bool wire = false;           ///< draw the edges of triangles
  std::optional<double> ground_level;
};

/// Angles in degrees: azimuth about z (0 looks along +y), elevation above the horizon. `zoom` 1
/// shows all `points`, centred and as large as possible; a larger zoom shows less from the same
/// position. With `y_up` the content is rotated first: y to z, z to −y.
struct Camera {
  double azimuth = 30, elevation = 22, zoom = 1;
  bool y_up = false;
  bool all_round = false;         ///< the same distance for every azimuth, in steps of 5°
  bool on_box = false;            ///< the centre of the box is in the centre of the picture
  std::vector<geo::Vec3> points;  ///< within the box
  geo::Box3 box;
};

struct RenderOptions {
  int width = 960, height = 720;
  int samples = 3;     ///< rays for each pixel and direction, samples² in all
  int occlusion = 36;  ///< rays for each pixel for ambient light, at least one for each sample
};

/// Draws a stage. The picture does not depend on the number of threads. Throws geo::Interrupted
/// where `progress` requests it.
Picture render(const Stage& stage, const Camera& camera, const RenderOptions& options,
               const geo::Progress& progress = {});

}  // namespace view
