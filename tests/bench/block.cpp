// Hundreds of partial cuts through one block: what a step costs for each face it meets, and what
// angles are left.
#include <cmath>
#include <cstdio>
#include <iostream>

#include "../crack/block_cuts.h"
#include "bench.h"
#include "kerf/error.h"
#include "kerf/mesh.h"

namespace bench {
namespace {

struct Window {
  double cut = 0, remesh = 0;  // CPU seconds
  std::size_t met = 0;
  double per_face() const { return 1e6 * (cut + remesh) / double(std::max<std::size_t>(met, 1)); }
};

}  // namespace

int block(const Options& options) {
  geo::Random random(1);
  geo::Complex k = geo::Complex::from_skin(geo::make_block({1, 1, 1}, 0.1));
  const int cuts = options.cuts, edge = std::max(1, cuts / 50);
  Window first, last, here;
  int refused = 0;
  if (!options.json)
    std::printf("%5s %8s %9s | %9s %9s %10s\n", "cuts", "faces", "1% angle", "met", "cut us", "remesh us");
  for (int c = 1; c <= cuts; ++c) {
    const auto rows = block_cut(random);
    geo::FrontState front = geo::begin_front(rows[0], false, c);
    geo::FrontState* const fronts[] = {&front};
    Window one;
    try {
      for (std::size_t s = 1; s < rows.size(); ++s) {
        geo::CrackStats work;
        const double start = cpu_seconds();
        const auto delta = geo::advance(k, front, rows[s], {}, &work);
        const double middle = cpu_seconds();
        geo::remesh(k, delta.new_faces, fronts);
        one.cut += middle - start;
        one.remesh += cpu_seconds() - middle;
        one.met += work.triangles_cut;
      }
    } catch (const geo::GeometryError&) {
      ++refused;
    }
    for (Window* w : {&here, c <= edge ? &first : nullptr, c > cuts - edge ? &last : nullptr})
      if (w) {
        w->cut += one.cut;
        w->remesh += one.remesh;
        w->met += one.met;
      }
    if (!options.json && c % (5 * edge) == 0) {
      const double met = double(std::max<std::size_t>(here.met, 1));
      std::printf("%5d %8u %9.2f | %9zu %9.1f %10.1f\n", c, k.live_face_count(), low_angle(k), here.met,
                  1e6 * here.cut / met, 1e6 * here.remesh / met);
      std::fflush(stdout);
      here = {};
    }
  }
  const double ratio = last.per_face() / first.per_face();
  if (options.json)
    std::cout << "{\"block_faces\":" << k.live_face_count() << ",\"block_low_angle\":" << low_angle(k)
              << ",\"block_last_to_first\":" << ratio << ",\"block_refused\":" << refused << "}\n";
  else
    std::printf("the last %d cuts cost %.2f times the first %d for each face met; %d refused\n", edge, ratio, edge,
                refused);
  return 0;
}

}  // namespace bench
