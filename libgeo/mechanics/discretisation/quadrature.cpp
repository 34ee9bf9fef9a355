#include "mechanics/discretisation/quadrature.h"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "base/random.h"
#include "sampling/walk.h"

namespace geo {
namespace {

constexpr int across = 6;  // samples across a cell that the surface cuts, one at random in each sub-cell
constexpr int samples = across * across * across;

// Every other corner of a cube, the other four in every other cell: in all directions the pattern is as long as it is
// wide.
Vec3 pattern(int k, bool other) {
  const int corner = std::array{0, 3, 5, 6}[static_cast<std::size_t>(k)] ^ (other ? 7 : 0);
  return {corner & 1 ? 1.0 : -1.0, corner & 2 ? 1.0 : -1.0, corner & 4 ? 1.0 : -1.0};
}

QuadratureCell place(const RegionTree& tree, const Lattice& lattice, const Region& region) {
  const double edge = lattice.edge(region.cell.level);
  const auto& c = region.cell.corner;
  const bool other = (c[0] ^ c[1] ^ c[2]) >> region.cell.level & 1;
  QuadratureCell cell{region.cell, !region.cut(), edge * edge * edge, {}};
  if (cell.whole) {
    for (int k = 0; k < 4; ++k)
      cell.point[static_cast<std::size_t>(k)] = region.probe + edge / std::sqrt(12.0) * pattern(k, other);
    return cell;
  }
  const Box3 box = lattice.box(region.cell);
  Random random(morton(c) ^ std::uint64_t(region.cell.level) << 60);
  std::vector<Vec3> at(samples);
  std::vector<char> in(samples);
  for (int i = 0; i < samples; ++i) {
    const double x = random.uniform(), y = random.uniform(), z = random.uniform();
    at[static_cast<std::size_t>(i)] =
        box.lo + edge / across * Vec3(i % across + x, i / across % across + y, i / (across * across) + z);
  }
  tree.inside(region, at, in);
  std::vector<Vec3> inside;
  for (std::size_t i = 0; i < samples; ++i)
    if (in[i]) inside.push_back(at[i]);
  cell.volume *= double(inside.size()) / samples;
  if (inside.empty()) return cell;
  Vec3 mean = Vec3::Zero();
  for (const Vec3& p : inside) mean += p;
  mean /= double(inside.size());
  Mat3 spread = Mat3::Zero();
  for (const Vec3& p : inside) spread += (p - mean) * (p - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(spread / double(inside.size()));
  const Mat3 root = eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal() *
                    eigen.eigenvectors().transpose();
  for (int k = 0; k < 4; ++k) {
    Vec3 p = mean;
    bool found = false;
    for (double t = 1; t > 0.2 && !found; t -= 0.25) {
      p = mean + t * (root * pattern(k, other));
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

// Exact, so that it does not depend on the order: node volumes are halved, never rounded, when nodes are inserted.
double sum_of(const std::vector<double>& volumes) {
  int exponent;
  std::frexp(*std::max_element(volumes.begin(), volumes.end()), &exponent);
  __extension__ typedef __int128 Wide;
  Wide sum = 0;
  for (const double v : volumes) sum += static_cast<Wide>(std::ldexp(v, 90 - exponent));
  return std::ldexp(static_cast<double>(sum), exponent - 90);
}

TriangleMesh skin_of(const Complex& surface) {
  TriangleMesh skin;
  for (std::uint32_t v = 0; v < surface.vertex_count(); ++v) skin.vertices.push_back(surface.point(VertexId(v)));
  for (std::uint32_t f = 0; f < surface.face_count(); ++f)
    if (const auto& face = surface.face(FaceId(f)); face.alive && face.crack == 0)
      skin.triangles.push_back({face.v[0].value, face.v[1].value, face.v[2].value});
  return skin;
}

}  // namespace

QuadratureCells::QuadratureCells(const Body& body) {
  // As the sampler lays its cells, where that can be told: centred on the body, in units of the coarsest. The first
  // node is always there, and so is its spacing.
  const NodeSet& nodes = body.nodes;
  const Box3& extent = body.surface.extent();
  const double spacing = nodes.spacing[0],
               coarse = spacing * std::exp2(std::round(std::log2(
                                      *std::max_element(nodes.spacing.begin(), nodes.spacing.end()) / spacing)));
  Vec3 cells;
  for (int a = 0; a < 3; ++a)
    cells[a] = std::max(1.0, std::ceil((extent.hi[a] - extent.lo[a] + 0.02 * spacing) / coarse));
  const int above = static_cast<int>(std::ceil(std::log2(cells.maxCoeff())));  // levels of the root over the coarsest
  const int below = std::max(0, std::min(10, 20 - above));                     // and of the coarsest over the finest
  lattice_ = {extent.center() - 0.5 * coarse * cells, std::ldexp(coarse, -below)};
  root_ = above + below;
  divided_ = divisions(nodes);
  skin_ = std::make_shared<const RegionTree>(skin_of(body.surface));
  for (const auto& list : walk<QuadratureCell>(*skin_, lattice_, {{0, 0, 0}, root_}, "quadrature", {}, visit()))
    placed_.insert(placed_.end(), list.begin(), list.end());
  share_volume(nodes);
}

// Goes into cells that are divided, and places points in the others.
std::function<bool(const Region&, std::vector<QuadratureCell>&)> QuadratureCells::visit() const {
  return [this](const Region& region, std::vector<QuadratureCell>& found) {
    if (region.cell.level > 0 && is_divided(divided_, region.cell)) return true;
    if (const QuadratureCell cell = place(*skin_, lattice_, region); cell.volume > 0) found.push_back(cell);
    return false;
  };
}

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

// What cut cells hold is an estimate: all together have the nodes' volume.
void QuadratureCells::share_volume(const NodeSet& nodes) {
  cells_ = placed_;
  double whole = 0, cut = 0;
  for (auto& c : cells_) (c.whole ? whole : cut) += c.measured = c.volume;
  const double volume = sum_of(nodes.volume);
  const bool cut_only = cut > 0 && whole < volume;
  const double scale = cut_only ? (volume - whole) / cut : volume / (whole + cut);
  for (auto& c : cells_)
    if (!cut_only || !c.whole) c.volume *= scale;
}

bool QuadratureCells::follow(const Body& body) {
  const Divisions before = std::exchange(divided_, divisions(body.nodes));
  if (divided_ == before) return false;
  // The coarsest cells that are divided now and were not, or the other way round, are looked at again.
  std::vector<Cell> changed;
  for (int level = root_; level > 0; --level) {
    const auto l = static_cast<std::size_t>(level);
    std::vector<std::uint64_t> codes;
    std::set_symmetric_difference(before[l].begin(), before[l].end(), divided_[l].begin(), divided_[l].end(),
                                  std::back_inserter(codes));
    for (const auto code : codes)
      if (std::none_of(changed.begin(), changed.end(),
                       [&](const Cell& c) { return code >> 3 * c.level == morton(c.corner) >> 3 * c.level; }))
        changed.push_back({corner_of(code), level});
  }
  std::sort(changed.begin(), changed.end(),
            [](const Cell& a, const Cell& b) { return morton(a.corner) < morton(b.corner); });
  std::vector<QuadratureCell> found;
  auto old = placed_.begin();
  const auto up_to = [&](std::uint64_t code, bool keep) {
    for (; old != placed_.end() && morton(old->cell.corner) < code; ++old)
      if (keep) found.push_back(*old);
  };
  const auto look = visit();
  const auto descend = [&](const auto& self, const Region& region) -> void {
    if (look(region, found)) skin_->divide(lattice_, region, [&](Region&& part) { self(self, part); });
  };
  for (const Cell& c : changed) {
    up_to(morton(c.corner), true), up_to(morton(c.corner) + (std::uint64_t(1) << 3 * c.level), false);
    if (const Region region = skin_->at(lattice_, c); region.cut() || region.inside) descend(descend, region);
  }
  up_to(~std::uint64_t(0), true);
  placed_ = std::move(found);
  share_volume(body.nodes);
  return true;
}

std::vector<std::size_t> QuadratureCells::groups(std::size_t most) const {
  std::vector<std::size_t> first;
  const auto code = [&](std::size_t i) { return morton(cells_[i].cell.corner); };
  const auto divide = [&](const auto& self, std::size_t begin, std::size_t end, std::uint64_t corner,
                          int level) -> void {
    if (begin == end) return;
    if (end - begin <= most || level == 0) {
      first.push_back(begin);
      return;
    }
    const std::uint64_t part = std::uint64_t(1) << 3 * (level - 1);
    std::size_t gathered = begin;  // children from here on are not in a group yet
    for (std::uint64_t k = 0; k < 8; ++k) {
      std::size_t to = begin;
      for (std::size_t step = end - begin; step > 0; step /= 2)
        while (to + step <= end && code(to + step - 1) < corner + (k + 1) * part) to += step;
      if (to - gathered > most) {
        if (gathered < begin) first.push_back(gathered);
        gathered = begin;
        if (to - begin > most) self(self, begin, to, corner + k * part, level - 1), gathered = to;
      }
      begin = to;
    }
    if (gathered < end) first.push_back(gathered);
  };
  divide(divide, 0, cells_.size(), 0, root_);
  first.push_back(cells_.size());
  return first;
}

}  // namespace geo
