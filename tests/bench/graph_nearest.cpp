#include <nanoflann.hpp>
#include <cstdio>

#include "base/parallel.h"
#include "graph.h"
#include "graph/nearest.h"
#include "graph/spanning_tree.h"

namespace bench {
namespace {

constexpr int k = 26;

struct Cloud {
  std::span<const geo::Vec3> points;
  std::size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const { return points[i][static_cast<Eigen::Index>(axis)]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const { return false; }
};

}  // namespace

void measure_nearest(const GraphCase& c, const Options& options, Figures& figures) {
  geo::set_threads(1);
  const auto& x = c.nodes.position;
  const double n = double(x.size());
  double ours = 1e300, nano = 1e300, tree_only = 1e300;
  std::vector<geo::NodeId> rows, theirs(x.size() * k);
  for (int round = 0; round < 3; ++round) {
    tree_only = std::min(tree_only, least([] {}, [&] { geo::NodeTree t(x); }, 3));
    ours = std::min(ours, least([] {}, [&] { rows = geo::nearest_nodes(x, k); }, 3));
    nano = std::min(nano, least([] {}, [&] {
      const Cloud cloud{x};
      nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>, Cloud, 3, std::uint32_t> index(3, cloud);
      std::vector<std::uint32_t> found(k + 1);
      std::vector<double> squares(k + 1);
      for (std::size_t i = 0; i < x.size(); ++i) {
        index.knnSearch(x[i].data(), k + 1, found.data(), squares.data());
        std::size_t at = i * k;
        for (const auto j : found)
          if (j != i && at < (i + 1) * k) theirs[at++] = geo::NodeId(j);
      }
    }, 1));
  }
  std::size_t bad = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) bad += rows[i] != theirs[i];
  std::printf("tree %.0f ours %.0f nano %.0f ratio %.2f bad %zu\n", 1e9*tree_only/n, 1e9 * ours / n, 1e9 * nano / n, nano / ours, bad);
}

}  // namespace bench
