// A small ray tracer (Embree): surface with both crack sheets coloured, nodes, edges, cut-away with filled section.
#pragma once

#include <optional>
#include <vector>

#include <kerf/mesh.h>
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
/// What is on the side that `normal` points to, beyond the plane through `point`, is cut away.
struct Plane {
  geo::Vec3 point, normal;
};

/// What is drawn. The surface must be closed where a cut-away is to show a filled section.
struct Stage {
  geo::TriangleMesh surface;
  std::vector<Color> triangle_colors;  ///< one a triangle
  std::vector<Color> back_colors;      ///< the same, seen from behind; empty: no difference
  std::vector<Sphere> spheres;
  std::vector<Stick> sticks;
  std::size_t obstacles = 0;  ///< so many triangles, the last ones, are of obstacles
  std::optional<Plane> cutaway;
  double surface_opacity = 1;  ///< below 1 nodes and edges inside show through
  bool sheets_opaque = false;  ///< the opacity is the skin's; sheets of cracks (surface.patch) stay opaque
  bool section = true;         ///< fill the cut-away's section; false: look into the body
  bool ground = true;          ///< a floor below that catches a soft shadow
  bool wire = false;           ///< draw the triangles' edges
  std::optional<double> ground_level;
};

/// Degrees: azimuth turns about z (0 looks along +y), elevation lifts the eye. `zoom` 1 shows `points`, as large as
/// they can be seen from there, in the middle; above it less, from where it stands. With `y_up` all that is seen is
/// stood up first: its y goes to z, its z to −y.
struct Camera {
  double azimuth = 30, elevation = 22, zoom = 1;
  bool y_up = false;
  bool all_round = false;         ///< from the same distance for every azimuth, to 5°
  bool on_box = false;            ///< the box's middle is in the middle
  std::vector<geo::Vec3> points;  ///< within the box
  geo::Box3 box;
};

struct RenderOptions {
  int width = 960, height = 720;
  int samples = 3;     ///< rays a pixel and direction: samples² in all
  int occlusion = 36;  ///< rays a pixel for ambient light, one a sample or more
};

/// The same picture for any number of threads.
Picture render(const Stage& stage, const Camera& camera, const RenderOptions& options);

}  // namespace view
