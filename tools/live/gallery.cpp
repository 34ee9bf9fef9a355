// Coordinates are rounded to single precision: the files are small, and the same on every machine.
#include "live/gallery.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <sstream>

#include <kerf/error.h>
#include <kerf/files.h>
#include <kerf/mesh.h>

namespace live {
namespace {

constexpr int frequency = 18;   // of a sphere that is deformed: 6480 triangles
constexpr double edge = 0.085;  // of blocks, which are about as fine

// A cylinder with round edges about an axis, as a superellipsoid.
geo::TriangleMesh rounded_cylinder(int axis, double radius, double half_length) {
  constexpr double roundness = 9;  // 2: an ellipsoid; a cylinder with sharp edges has infinity
  return geo::make_star(frequency, [=](const geo::Vec3& d) {
    const double along = std::abs(d[axis]), around = std::sqrt(std::max(0.0, 1 - along * along));
    const double sum = std::pow(around / radius, roundness) + std::pow(along / half_length, roundness);
    return std::pow(sum, -1 / roundness);
  });
}

// A pebble: three waves on a flat ellipsoid.
geo::TriangleMesh make_stone() {
  geo::TriangleMesh mesh = geo::make_star(frequency, [](const geo::Vec3& d) {
    return 1 + 0.09 * std::sin(3.1 * d.x() + 1.3 * d.y()) + 0.07 * std::sin(4.3 * d.y() - 2.2 * d.z()) +
           0.05 * std::sin(5.9 * d.z() + 3.7 * d.x());
  });
  for (geo::Vec3& p : mesh.vertices) p = p.cwiseProduct(geo::Vec3(1.2, 0.95, 0.75));
  return mesh;
}

struct Entry {
  const char* name;
  char up;
  std::function<geo::TriangleMesh()> make;
  double tension = 1;
};

const std::vector<Entry>& entries() {
  static const std::vector<Entry> all{
      {"apple", 'z', [] { return geo::make_apple(frequency); }},
      {"pumpkin", 'z', [] { return geo::make_pumpkin(frequency); }},
      {"cake", 'z', [] { return rounded_cylinder(2, 1, 0.5); }},
      {"jelly", 'z',
       [] {
         return geo::make_block({1, 1, 1}, edge);
       }},
      {"polyp", 'z', [] { return geo::make_polyp(frequency); }},
      {"tissue", 'z',
       [] {
         return geo::make_block({2, 1.6, 0.5}, edge);
       },
       1.35},
      {"board", 'z',
       [] {
         return geo::make_block({2.4, 0.8, 0.3}, edge);
       }},
      {"log", 'z', [] { return rounded_cylinder(0, 0.5, 1.2); }},
      {"stone", 'z', make_stone},
      {"letter", 'y', [] { return geo::make_letter('K', 0.35, 24); }},
  };
  return all;
}

}  // namespace

std::vector<std::string> gallery_names() {
  std::vector<std::string> names;
  for (const Entry& entry : entries()) names.emplace_back(entry.name);
  return names;
}

ModelFile gallery_model(const std::string& name) {
  const auto& all = entries();
  const auto at = std::find_if(all.begin(), all.end(), [&](const Entry& entry) { return entry.name == name; });
  if (at == all.end()) throw geo::InputError("'" + name + "' is not in the gallery");
  geo::TriangleMesh mesh = at->make();
  for (geo::Vec3& p : mesh.vertices) p = p.cast<float>().cast<double>();
  std::ostringstream out;
  geo::write_ply(out, mesh);
  return {
      .name = name + ".ply", .bytes = std::move(out).str(), .tension = at->tension, .up = at->up, .from_gallery = true};
}

}  // namespace live
