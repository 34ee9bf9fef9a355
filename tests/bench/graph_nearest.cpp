// Nearest nodes beside nanoflann, both in doubles, the index and all rows counted; the spanning
// tree.
#include <cstdio>
#include <nanoflann.hpp>

#include "graph.h"
#include "graph/nearest.h"
#include "graph/spanning_tree.h"
#include "kerf/parallel.h"
#include "kerf/progress.h"

namespace bench {
namespace {

constexpr int k = 26;

struct Cloud {
  std::span<const geo::Vec3> points;
  std::size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const { return points[i][static_cast<Eigen::Index>(axis)]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

void by_nanoflann(std::span<const geo::Vec3> x, geo::UninitializedArray<geo::NodeId>& rows) {
  const Cloud cloud{x};
  const nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>, Cloud, 3, std::uint32_t> index(
      3, cloud);
  std::uint32_t found[k + 1];
  double squares[k + 1];
  for (std::size_t i = 0; i < x.size(); ++i) {
    const auto count = index.knnSearch(x[i].data(), k + 1, found, squares);
    std::size_t at = i * k;
    for (std::size_t q = 0; q < count; ++q)
      if (found[q] != i && at < (i + 1) * k) rows[at++] = geo::NodeId(found[q]);
  }
}

}  // namespace

void measure_nearest(const GraphCase& c, const Options& options, Figures& figures) {
  const auto& x = c.nodes.position;
  const double n = double(x.size());
  geo::UninitializedArray<geo::NodeId> ours, theirs(x.size() * k);
  double t_ours = 1e300, t_theirs = 1e300;
  geo::set_threads(1);
  // In turn, and often enough that both meet a moment in which the machine does nothing else.
  geo::Stopwatch watch;
  double spent = 0;
  for (int round = 0; round < 3 || (round < 30 && spent < 4); ++round) {
    t_ours = std::min(t_ours, least([] {}, [&] { ours = geo::nearest_nodes(x, k); }, 3));
    t_theirs = std::min(t_theirs, least([] {}, [&] { by_nanoflann(x, theirs); }, 1));
    spent += watch.lap();
  }
  std::size_t differ = 0;
  for (std::size_t i = 0; i < ours.size(); ++i) differ += ours[i] != theirs[i];
  const geo::NodeTree tree(x);
  std::size_t beyond = 0;
  const double t_tree = least([] {}, [&] { beyond = geo::spanning_tree_beyond(tree, x, ours, k).size(); }, 3);
  const double speedup = threads_speedup([&] { ours = geo::nearest_nodes(x, k); });

  figures["knn_ns"] = 1e9 * t_ours / n;
  figures["knn_vs_nanoflann"] = t_theirs / t_ours;
  figures["emst_ns"] = 1e9 * t_tree / n;
  figures["knn_threads_speedup"] = speedup;
  if (options.json) return;
  std::printf("nearest %d, ns a node: ours %.0f, nanoflann %.0f (%zu entries differ)\n", k, 1e9 * t_ours / n,
              1e9 * t_theirs / n, differ);
  std::printf("spanning tree after them, ns a node: %.0f (%zu edges more)\n", 1e9 * t_tree / n, beyond);
}

}  // namespace bench
