// The number of nodes n falls about as a power of the spacing s: log n is interpolated piecewise
// linearly in log s over all spacings tried, and solved for the wanted number (regula falsi). A
// selection among leaves with little material gives the exact number.
#include "sampling/count.h"

#include <cmath>

#include "base/elementary.h"
#include "base/random.h"
#include "kerf/error.h"
#include "kerf/progress.h"

namespace geo {
namespace {

// For a wanted number of nodes, cells with a share of material above `surely` always have one and
// those below `hardly` never. Between them some have, so that the number is met. Models with flat
// faces across the axes gain or lose all cells of a face at once, half filled; as a last resort
// (`at_worst`) some of those have none.
//
// A face across the axes leaves shares between 0 and 1 with equal probability. So `surely` and
// `hardly` make 32 % of the cells at the surface optional, which is the range within which the
// number can be met at one spacing. Below 3 %, a node would stand within a thirtieth of a cell of
// the surface. `at_worst` is above a half, so that half filled cells become optional.
constexpr float surely = 0.35f, at_worst = 0.6f, hardly = 0.03f;

std::size_t count_above(const LeafLists& lists, float share) {
  std::size_t n = 0;
  for (const auto& list : lists)
    for (const Leaf& leaf : list) n += leaf.node && leaf.share > share;
  return n;
}

/// The selection of `count` leaves, or of the nearest number possible.
NodeSelection select_count(const LeafLists& lists, std::size_t count, float surely) {
  const std::size_t sure = count_above(lists, surely);
  std::vector<std::pair<float, std::uint64_t>> rest;
  for (const auto& list : lists)
    for (const Leaf& leaf : list)
      if (leaf.node && leaf.share <= surely && leaf.share >= hardly)
        rest.push_back({leaf.share, NodeSelection::ticket_of(leaf)});
  if (count <= sure) return {surely, ~std::uint64_t(0)};
  if (count - sure >= rest.size()) return {hardly, 0};
  const auto least = rest.begin() + static_cast<std::ptrdiff_t>(count - sure - 1);
  std::nth_element(rest.begin(), least, rest.end(), std::greater<>());
  return {least->first, least->second};
}

/// Numbers of nodes by spacing, as measured, with a piecewise power law between and beyond them.
class CountCurve {
 public:
  void add(double spacing, double count) {
    points_.insert(std::upper_bound(points_.begin(), points_.end(), std::pair{logarithm(spacing), 0.0}),
                   {logarithm(spacing), logarithm(count + 0.5)});
  }
  double guess(double count) const {
    const double y = logarithm(count + 0.5);
    std::size_t i = 0;  // the first with fewer nodes
    while (i < points_.size() && points_[i].second > y) ++i;
    const bool between = i > 0 && i < points_.size();
    const std::size_t a = between  ? i - 1
                          : i == 0 ? 0
                                   : points_.size() - 1,
                      b = between  ? i
                          : i == 0 ? 1
                                   : points_.size() - 2;
    // The slope d log n / d log s is −3 for a full volume and −2 for a shell. The first guess is
    // −2.8; extrapolation is bounded to −4 to −1.5.
    double slope = -2.8;
    if (points_.size() > 1) slope = (points_[b].second - points_[a].second) / (points_[b].first - points_[a].first);
    if (!between) slope = std::clamp(slope, -4.0, -1.5);
    double x = points_[a].first + (y - points_[a].second) / slope;
    if (between) {  // well inside the bracket, or a step in the curve would be approached from one side for ever
      const double lo = points_[a].first, hi = points_[b].first;
      x = std::clamp(x, lo + 0.1 * (hi - lo), hi - 0.1 * (hi - lo));
    }
    return exponential(x);
  }

 private:
  std::vector<std::pair<double, double>> points_;
};

}  // namespace

std::uint64_t NodeSelection::ticket_of(const Leaf& leaf) { return Random(morton(leaf.cell.corner)).bits(); }

std::optional<SpacedLeaves> LeafFinder::at(double spacing, int thin_levels, std::size_t most,
                                           SampleReport& report) const {
  if (!(spacing > box_.diagonal() * 1e-4))
    throw InputError("the spacing is less than 0.01 % of the model's diagonal; choose a larger one");
  Stopwatch clock;
  // The cells are centred on the body, so that a symmetric model is sampled symmetrically.
  OctreeShape shape{.lattice = {box_.lo, std::ldexp(spacing, -thin_levels)},
                    .root = 0,
                    .top = thin_levels + options_.levels - 1,
                    .regular = thin_levels,
                    .across = options_.across};
  shape.root = shape.top;
  const double coarse = shape.lattice.edge(shape.top);
  for (int i = 0; i < 3; ++i) {
    // 2 % of the spacing keep the surface off the boundary of the lattice.
    const double length = box_.hi[i] - box_.lo[i] + 0.02 * spacing, cells = std::max(1.0, std::ceil(length / coarse));
    shape.lattice.origin[i] = box_.center()[i] - 0.5 * cells * coarse;
    while (std::ldexp(1.0, shape.root - shape.top) < cells) ++shape.root;
  }
  SpacedLeaves found{.lists = {}, .lattice = shape.lattice, .thin = {}, .selection = {}};
  report.spacing = spacing;
  const auto divided = plan_octree(tree_, shape, most, found.thin, progress_);
  report.octree_seconds += clock.lap();
  if (!divided) return std::nullopt;
  found.lists = find_leaves(tree_, shape, *divided, options_, progress_);
  report.node_seconds += clock.lap();
  return found;
}

SpacedLeaves LeafFinder::with_count(std::size_t count, double volume, SampleReport& report) const {
  // A trial that would divide more than `most` cells is given up: it costs time and memory.
  const double target = double(count), most = 4 * target + 1000;
  CountCurve curve;
  int thin = thin_levels();
  // A large spacing first: it costs little, and it shows how fine thin material may be.
  double spacing = 2.5 * cube_root(volume / target);
  std::optional<SpacedLeaves> found;
  std::size_t nodes = 0;
  const auto look = [&] {
    found.reset();
    found = at(spacing, thin, static_cast<std::size_t>(most), report);
    nodes = found ? count_above(found->lists, float(least_leaf_share)) : static_cast<std::size_t>(2 * most);
  };
  for (look(); thin > 0 && nodes > count; look()) --thin;
  float sure = surely;
  // Rounds are bounded: where symmetry makes counts jump, no spacing may give the number.
  for (int round = 0; round < 30; ++round) {
    curve.add(spacing, double(nodes));
    if (round == 6) sure = at_worst;
    if (found && count_above(found->lists, sure) <= count && count_above(found->lists, hardly) >= count) break;
    // A quarter of a large number costs less and brackets it.
    spacing = curve.guess(target > 20000 && round == 0 && nodes < target / 8 ? target / 4 : target);
    look();
  }
  if (!found) throw InputError("no spacing gives " + std::to_string(count) + " nodes; ask for more");
  found->selection = select_count(found->lists, count, sure);
  return std::move(*found);
}

}  // namespace geo
