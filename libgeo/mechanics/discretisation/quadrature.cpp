// Whole cell of edge a: four alternate corners of the cube of half edge a/√12, half of the 2³ Gauss
// rule; beside finer cells, eight corners of the cube of half edge a/4. Cut cell: stratified
// samples give volume, mean m and covariance C.
//
// The points of a cut cell are m + C^½ t_k, with t_k the alternate corners of [−1, 1]³.
#include "mechanics/discretisation/quadrature.h"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "base/random.h"
#include "sampling/walk.h"
#include "surface/skin.h"

namespace geo {
namespace {

constexpr int subcells = 6;  // per axis of a cut cell; one random sample in each (stratified sampling)
constexpr int samples = subcells * subcells * subcells;

// The k-th of four alternate corners of the cube [−1, 1]³, a regular tetrahedron; `mirrored`: of
// the other four. Cells alternate between the two, like a checkerboard.
Vec3 tetrahedron_corner(int k, bool mirrored) {
  const int corner = std::array{0, 3, 5, 6}[static_cast<std::size_t>(k)] ^ (mirrored ? 7 : 0);
  return {corner & 1 ? 1.0 : -1.0, corner & 2 ? 1.0 : -1.0, corner & 4 ? 1.0 : -1.0};
}

// The even lattice of 2³ points in a whole cell beside finer ones. Shape functions of finer nodes
// are smooth and end inside the cell; equal distances of points integrate such functions better
// than Gauss points (docs/decisions/061).
std::array<QuadratureCell, 2> make_halves(const Lattice& lattice, const Region& region) {
  const double edge = lattice.edge(region.cell.level);
  std::array<QuadratureCell, 2> halves;
  for (std::uint8_t h = 0; h < 2; ++h) {
    halves[h] = {.cell = region.cell,
                 .whole = true,
                 .half = static_cast<std::uint8_t>(h + 1),
                 .volume = 0.5 * edge * edge * edge,
                 .point = {}};
    for (int k = 0; k < 4; ++k)
      halves[h].point[static_cast<std::size_t>(k)] = region.probe + 0.25 * edge * tetrahedron_corner(k, h == 1);
  }
  return halves;
}

// Calls visit() for each of the 26 neighbours of a cell inside the root cell.
template <class Visit>
void each_neighbor(const Cell& cell, int root, const Visit& visit) {
  const std::int32_t edge = std::int32_t(1) << cell.level, end = std::int32_t(1) << root;
  for (int k = 0; k < 27; ++k) {
    Cell n = cell;
    n.corner[0] += (k % 3 - 1) * edge;
    n.corner[1] += (k / 3 % 3 - 1) * edge;
    n.corner[2] += (k / 9 - 1) * edge;
    if (k != 13 && std::all_of(n.corner.begin(), n.corner.end(), [&](auto c) { return c >= 0 && c < end; })) visit(n);
  }
}

// Whether one of the cells of a level contains the cell of a Morton code.
bool covers(const Divisions& cells, int level, std::uint64_t code) {
  const auto& codes = cells[static_cast<std::size_t>(level)];
  return std::binary_search(codes.begin(), codes.end(), code >> 3 * level << 3 * level);
}

// A cell with its points; its volume is zero if no sample is inside.
QuadratureCell make_cell(const RegionTree& tree, const Lattice& lattice, const Region& region) {
  const double edge = lattice.edge(region.cell.level);
  const auto& c = region.cell.corner;
  const bool mirrored = (c[0] ^ c[1] ^ c[2]) >> region.cell.level & 1;
  QuadratureCell cell{
      .cell = region.cell, .whole = !region.cut(), .half = 0, .volume = edge * edge * edge, .point = {}};
  if (cell.whole) {
    for (int k = 0; k < 4; ++k)
      cell.point[static_cast<std::size_t>(k)] = region.probe + edge / std::sqrt(12.0) * tetrahedron_corner(k, mirrored);
    return cell;
  }
  const Box3 box = lattice.box(region.cell);
  Random random(morton(c) ^ std::uint64_t(region.cell.level) << 60);
  std::vector<Vec3> sample(samples);
  std::vector<char> is_inside(samples);
  for (int i = 0; i < samples; ++i) {
    const double x = random.uniform(), y = random.uniform(), z = random.uniform();
    sample[static_cast<std::size_t>(i)] =
        box.lo + edge / subcells * Vec3(i % subcells + x, i / subcells % subcells + y, i / (subcells * subcells) + z);
  }
  tree.inside(region, sample, is_inside);
  std::vector<Vec3> inside;
  for (std::size_t i = 0; i < samples; ++i)
    if (is_inside[i]) inside.push_back(sample[i]);
  cell.volume *= double(inside.size()) / samples;
  if (inside.empty()) return cell;
  Vec3 mean = Vec3::Zero();
  for (const Vec3& p : inside) mean += p;
  mean /= double(inside.size());
  Mat3 covariance = Mat3::Zero();
  for (const Vec3& p : inside) covariance += (p - mean) * (p - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(covariance / double(inside.size()));
  // Points at mean ± covariance^½ have the samples' second moments. A point outside moves towards
  // the mean; failing that, it goes to the nearest sample.
  const Mat3 root = eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal() *
                    eigen.eigenvectors().transpose();
  for (int k = 0; k < 4; ++k) {
    Vec3 p = mean;
    bool found = false;
    for (double t = 1; t > 0.2 && !found; t -= 0.25) {
      p = mean + t * (root * tetrahedron_corner(k, mirrored));
      found = box.meets({p, p}) && tree.inside(region, p);
    }
    if (!found)
      p = *std::min_element(inside.begin(), inside.end(), [&](const Vec3& a, const Vec3& b) {
        return (a - p).squaredNorm() < (b - p).squaredNorm();
      });
    cell.point[static_cast<std::size_t>(k)] = p;
  }
  return cell;
}

// The exact sum of node volumes in fixed-point arithmetic, which no order of summation changes:
// inserted nodes take volume exactly, too. Each term is below 2⁹⁰: 2³⁷ of them fit.
double exact_sum(const std::vector<double>& volumes) {
  int exponent;
  std::frexp(*std::max_element(volumes.begin(), volumes.end()), &exponent);
  __extension__ typedef __int128 Wide;
  Wide sum = 0;
  for (const double v : volumes) sum += static_cast<Wide>(std::ldexp(v, 90 - exponent));
  return std::ldexp(static_cast<double>(sum), exponent - 90);
}

}  // namespace

QuadratureCells::QuadratureCells(const Body& body) {
  // The lattice of the sampler, as far as the nodes tell: centred on the body, in units of the
  // coarsest cells. The first node always exists, and so does its spacing.
  const NodeSet& nodes = body.nodes;
  const Box3& extent = body.surface.extent();
  const double spacing = nodes.spacing[0],
               coarse = spacing * std::exp2(std::round(std::log2(
                                      *std::max_element(nodes.spacing.begin(), nodes.spacing.end()) / spacing)));
  Vec3 cells;
  for (int a = 0; a < 3; ++a)
    cells[a] = std::max(1.0, std::ceil((extent.hi[a] - extent.lo[a] + 0.02 * spacing) / coarse));
  const int levels_above =
      static_cast<int>(std::ceil(std::log2(cells.maxCoeff())));           // levels of the root over the coarsest
  const int levels_below = std::max(0, std::min(10, 20 - levels_above));  // and of the coarsest over the finest
  lattice_ = {extent.center() - 0.5 * coarse * cells, std::ldexp(coarse, -levels_below)};
  root_ = levels_above + levels_below;
  divided_ = divisions(nodes);
  skin_ = std::make_shared<const RegionTree>(skin_of(body.surface));
  for (const auto& list : walk<QuadratureCell>(*skin_, lattice_, {{0, 0, 0}, root_}, "quadrature", {}, visitor()))
    unscaled_.insert(unscaled_.end(), list.begin(), list.end());
  scale_volumes(nodes);
}

// Descends into divided cells, and makes quadrature cells of the others.
std::function<bool(const Region&, std::vector<QuadratureCell>&)> QuadratureCells::visitor() const {
  return [this](const Region& region, std::vector<QuadratureCell>& found) {
    if (region.cell.level > 0 && is_divided(divided_, region.cell)) return true;
    if (!region.cut() && is_beside_divided(region.cell)) {
      for (const QuadratureCell& half : make_halves(lattice_, region)) found.push_back(half);
      return false;
    }
    if (const QuadratureCell cell = make_cell(*skin_, lattice_, region); cell.volume > 0) found.push_back(cell);
    return false;
  };
}

// Whether a neighbour of the same size, corners included, is divided.
bool QuadratureCells::is_beside_divided(const Cell& cell) const {
  if (divided_[static_cast<std::size_t>(cell.level)].empty()) return false;
  bool found = false;
  each_neighbor(cell, root_, [&](const Cell& n) { found = found || is_divided(divided_, n); });
  return found;
}

// Per level, the Morton codes of cells that hold a node of a finer spacing.
Divisions QuadratureCells::divisions(const NodeSet& nodes) const {
  Divisions divided(static_cast<std::size_t>(root_) + 1);
  std::vector<std::uint64_t> last(divided.size(), ~std::uint64_t(0));
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    std::array<std::int32_t, 3> at;
    for (int a = 0; a < 3; ++a)
      at[static_cast<std::size_t>(a)] = std::clamp(
          static_cast<std::int32_t>((nodes.position[i][a] - lattice_.origin[a]) / lattice_.size), 0, (1 << root_) - 1);
    const std::uint64_t code = morton(at);
    for (int level = std::max(0, static_cast<int>(std::lround(std::log2(nodes.spacing[i] / lattice_.size)))) + 1;
         level <= root_; ++level) {
      const auto l = static_cast<std::size_t>(level);
      const std::uint64_t cell = code >> 3 * level << 3 * level;
      if (last[l] != cell) divided[l].push_back(last[l] = cell);
    }
  }
  for (auto& codes : divided) {
    std::sort(codes.begin(), codes.end());
    codes.erase(std::unique(codes.begin(), codes.end()), codes.end());
  }
  return divided;
}

// Volumes of cut cells are estimates, scaled by (V − whole) / cut to sum to the nodes' volume V.
// Where that is not positive, all cells are scaled by V / (whole + cut).
void QuadratureCells::scale_volumes(const NodeSet& nodes) {
  cells_ = unscaled_;
  double whole = 0, cut = 0;
  for (auto& c : cells_) (c.whole ? whole : cut) += c.unscaled_volume = c.volume;
  const double volume = exact_sum(nodes.volume);
  const bool cut_only = cut > 0 && whole < volume;
  const double scale = cut_only ? (volume - whole) / cut : volume / (whole + cut);
  for (auto& c : cells_)
    if (!cut_only || !c.whole) c.volume *= scale;
}

// Cells to visit again: those whose division differs from `before`, and their neighbours, the
// points of which depend on it. No cell lies in another one. A neighbour in an undivided cell is no
// cell of the octree.
Divisions QuadratureCells::changed_cells(const Divisions& before) const {
  Divisions changed(divided_.size());
  for (int level = root_; level > 0; --level) {
    const auto l = static_cast<std::size_t>(level);
    std::vector<std::uint64_t> codes, all;
    std::set_symmetric_difference(before[l].begin(), before[l].end(), divided_[l].begin(), divided_[l].end(),
                                  std::back_inserter(codes));
    all = codes;
    for (const auto code : codes)
      each_neighbor({corner_of(code), level}, root_, [&](const Cell& n) {
        if (!is_divided(divided_, n)) all.push_back(morton(n.corner));
      });
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    std::erase_if(all, [&](auto code) {
      if (level < root_ && !covers(divided_, level + 1, code)) return true;
      for (int above = level + 1; above <= root_; ++above)
        if (covers(changed, above, code)) return true;
      return false;
    });
    changed[l] = std::move(all);
  }
  return changed;
}

bool QuadratureCells::update(const Body& body) {
  const Divisions before = std::exchange(divided_, divisions(body.nodes));
  if (divided_ == before) return false;
  std::vector<Cell> changed;
  const Divisions codes = changed_cells(before);
  for (int level = 0; level <= root_; ++level)
    for (const auto code : codes[static_cast<std::size_t>(level)]) changed.push_back({corner_of(code), level});
  std::sort(changed.begin(), changed.end(),
            [](const Cell& a, const Cell& b) { return morton(a.corner) < morton(b.corner); });
  std::vector<QuadratureCell> merged;
  auto old = unscaled_.begin();
  const auto skip_to = [&](std::uint64_t code, bool keep) {
    for (; old != unscaled_.end() && morton(old->cell.corner) < code; ++old)
      if (keep) merged.push_back(*old);
  };
  const auto visit = visitor();
  const auto descend = [&](const auto& self, const Region& region) -> void {
    if (visit(region, merged)) skin_->divide(lattice_, region, [&](Region&& child) { self(self, child); });
  };
  for (const Cell& c : changed) {
    skip_to(morton(c.corner), true);
    skip_to(morton(c.corner) + (std::uint64_t(1) << 3 * c.level), false);
    if (const Region region = skin_->at(lattice_, c); region.cut() || region.inside) descend(descend, region);
  }
  skip_to(~std::uint64_t(0), true);
  unscaled_ = std::move(merged);
  scale_volumes(body.nodes);
  return true;
}

std::vector<std::size_t> QuadratureCells::groups(std::size_t max_cells) const {
  std::vector<std::size_t> first;
  const auto code = [&](std::size_t i) { return morton(cells_[i].cell.corner); };
  const auto divide = [&](const auto& self, std::size_t begin, std::size_t end, std::uint64_t corner,
                          int level) -> void {
    if (begin == end) return;
    if (end - begin <= max_cells || level == 0) {
      first.push_back(begin);
      return;
    }
    const std::uint64_t child = std::uint64_t(1) << 3 * (level - 1);
    std::size_t pending = begin;  // first cell of the children that are in no group yet
    for (std::uint64_t k = 0; k < 8; ++k) {
      std::size_t to = begin;
      for (std::size_t step = end - begin; step > 0; step /= 2)
        while (to + step <= end && code(to + step - 1) < corner + (k + 1) * child) to += step;
      if (to - pending > max_cells) {
        if (pending < begin) first.push_back(pending);
        pending = begin;
        if (to - begin > max_cells) {
          self(self, begin, to, corner + k * child, level - 1);
          pending = to;
        }
      }
      begin = to;
    }
    if (pending < end) first.push_back(pending);
  };
  divide(divide, 0, cells_.size(), 0, root_);
  first.push_back(cells_.size());
  return first;
}

}  // namespace geo
