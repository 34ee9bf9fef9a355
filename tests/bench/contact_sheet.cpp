// A folded sheet whose folds are pressed together: time to find the pairs of boxes that meet, and
// to move the sheet without crossing.
#include <cmath>

#include "contact/detection/find_crossings.h"
#include "contact/motion/bounded_motion.h"
#include "contact_peers.h"

namespace bench {
namespace {

constexpr std::size_t folds = 8;

// A sheet of n × n squares of edge 1 / n, bent in a zigzag. Folds open by `width`; the middle of
// each bulges by `bulge` towards the next one.
std::vector<geo::Vec3> folded(std::size_t n, double width, double bulge) {
  const auto hump = [](double part) { return 0.5 - 0.5 * std::cos(2 * M_PI * part); };
  std::vector<geo::Vec3> at;
  for (std::size_t i = 0; i <= n; ++i)
    for (std::size_t j = 0; j <= n; ++j) {
      const double s = double(i * folds) / double(n), part = s - std::floor(s),
                   up = std::size_t(s) % 2 == 0 ? part : 1 - part;
      const double y = double(j) / double(n);
      at.push_back(
          {0.5 * width * s + (std::size_t(s) % 2 == 0 ? bulge : -bulge) * hump(part) * hump(y), y, up / double(folds)});
    }
  return at;
}

}  // namespace

void contact_of_sheet(const Options& options) {
  for (const std::size_t n : {64u, 160u}) {
    std::vector<geo::Triangle> triangles;
    const auto row = [&](std::size_t i, std::size_t j) { return static_cast<std::uint32_t>(i * (n + 1) + j); };
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) {
        triangles.push_back({row(i, j), row(i + 1, j), row(i, j + 1)});
        triangles.push_back({row(i + 1, j), row(i + 1, j + 1), row(i, j + 1)});
      }
    const double edge = 1.0 / double(n), gap = 1e-4 * edge;
    // Folds half an edge apart where they open widest bulge into each other; all of it falls as
    // well.
    const std::vector<geo::Vec3> from = folded(n, 0.5 * edge, 0);
    std::vector<geo::Vec3> to = folded(n, 0.5 * edge, 0.2 * edge);
    for (auto& p : to) p.z() -= 0.1;
    const std::vector<std::uint32_t> representative = geo::coincident_representatives({}, from);
    std::vector<geo::Box3> boxes;
    for (const auto& [a, b, c] : triangles) boxes.push_back(geo::box_of(from[a], from[b], from[c]).grown(0.1 * edge));
    std::size_t own_pairs = 0, cgal_pairs = 0;
    const double own = own_pairs_seconds(boxes, own_pairs), cgal = cgal_pairs_seconds(boxes, cgal_pairs);
    geo::BoundedMotionStats report;
    std::vector<geo::Vec3> at;
    const geo::SurfaceMotion motion{triangles, representative, from, to, gap, 2 * gap};
    const auto move = [&] {
      report = {};
      at = geo::move_without_crossing(motion, false, &report);
    };
    const double moving = least([] {}, move, 5);
    print({{"triangles", double(triangles.size())},
           {"pairs", double(own_pairs)},
           {"pairs_cgal", double(cgal_pairs)},
           {"million_pairs_a_second", 1e-6 * double(own_pairs) / own},
           {"million_pairs_a_second_cgal", 1e-6 * double(cgal_pairs) / cgal},
           {"move_ms", 1e3 * moving},
           {"move_us_a_triangle", 1e6 * moving / double(triangles.size())},
           {"planes", double(report.planes)},
           {"in_zones", double(report.in_zones)},
           {"crossings_wanted", double(geo::find_crossings(triangles, to, representative, false).size())},
           {"crossings", double(geo::find_crossings(triangles, at, representative, false).size())},
           {"move_two_threads_speedup", threads_speedup(move)}},
          options.json);
  }
}

}  // namespace bench
