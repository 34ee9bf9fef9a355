// kerf/impact.h. A part with several sites is divided along the walls of their Voronoi cells: along
// all of them where there is time, else along those between two halves of the sites.
//
// The cells of one half alone are those of all sites, as far as the half reaches. So a part is
// divided by its own sites, whose walls pass through it, and need not end on the walls before. They
// would meet those along edges that are there already, but for rounding: so sites move a little.
#include "kerf/impact.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/random.h"
#include "crack/insert.h"
#include "jobs/impact_sites.h"
#include "kerf/check.h"
#include "kerf/complex.h"
#include "kerf/crack.h"
#include "kerf/error.h"
#include "kerf/pieces.h"
#include "kerf/progress.h"

namespace geo {

struct Breakable::Impl {
  TriangleMesh mesh;
  double volume = 0;
  std::optional<Complex> complex;  // of the mesh; made at once for a model, and for a part when it breaks
  std::vector<Vec3> inner;         // points inside; likewise
};

namespace {

// The least volume that a part has, relative to the solid: smaller ones are divided no further.
constexpr double least_volume = 1e-9;

std::vector<Chunk> chunks_of(const Complex& complex, const TriangleMesh& model) {
  constexpr double tile_share = 0.25;  // of the diagonal: a texture tile on inner faces, as in kerf/jobs.h
  return make_chunks(complex, find_pieces(complex), model, tile_share * complex.extent().diagonal());
}

// Inner faces of earlier breaks are skin of the part, and inner faces of the whole.
void mark_inner_faces(TriangleMesh& mesh) {
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (mesh.patch[t] == 0 && mesh.source[t] == ~0u) mesh.patch[t] = 1;
}

// A point inside a closed mesh, just behind its largest triangle; of the skin where it has some.
Vec3 point_inside(const TriangleMesh& mesh) {
  double largest = -1;
  Vec3 point = Vec3::Zero();
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    const Vec3 &p = mesh.vertices[a], u = mesh.vertices[b] - p, v = mesh.vertices[c] - p, n = u.cross(v);
    const double size = n.norm() * (mesh.patch.empty() || mesh.patch[t] == 0 ? 1 : 1e-3);
    if (size <= largest) continue;
    largest = size;
    point = p + (u + v) / 3 - 1e-6 * std::sqrt(n.norm()) * n.stableNormalized();
  }
  return point;
}

// Moves the sites of a part at random, by a hundredth of the distance to the next one: far enough
// that cuts beside an edge leave no needles of rounding's width, and too little to be seen.
void move_sites(std::vector<Vec3>& sites, std::uint64_t seed) {
  constexpr double share = 0.01;
  Random random(seed);
  const std::vector<Vec3> from = sites;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t j = 0; j < from.size(); ++j)
      if (j != i) nearest = std::min(nearest, (from[i] - from[j]).norm());
    sites[i] += share * nearest * random.direction();
  }
}

}  // namespace

Breakable::Breakable(TriangleMesh solid) {
  require_solid(solid);
  if (solid.two_sided())
    throw InputError("the solid has cracks already; break its pieces, or give the model without them");
  auto impl = std::make_shared<Impl>();
  impl->complex = Complex::from_skin(solid);
  impl->inner = inner_points(solid, 1);
  impl->volume = signed_volume(solid);
  if (solid.patch.empty()) solid.patch.assign(solid.triangles.size(), 0);
  impl->mesh = std::move(solid);
  impl_ = std::move(impl);
}

const TriangleMesh& Breakable::mesh() const { return impl_->mesh; }
double Breakable::volume() const { return impl_->volume; }

struct Breaking::Impl {
  // Work that is left on a part: to divide it by its sites, or to make its hulls where it has one.
  struct Job {
    std::size_t part = 0;
    std::vector<Vec3> sites;
    double distance = 0;  // of the nearest site from the impact
  };

  Impact impact;
  ImpactOptions options;
  Mat3 stretch;
  std::vector<BrokenPart> parts;
  std::vector<Job> jobs;
  // Seconds for a unit of work, from the steps so far; at first as kerf-bench break measures them.
  double divide_rate = 2e-6, hull_rate = 1e-6;

  void add_job(std::size_t part, std::vector<Vec3> sites) {
    Job job{part, std::move(sites)};
    job.distance = job.sites.empty() ? 0 : std::numeric_limits<double>::infinity();
    for (const Vec3& site : job.sites) job.distance = std::min(job.distance, (site - impact.point).norm());
    jobs.push_back(std::move(job));
  }

  // Work of a division into groups: a complex is built of the triangles, those along the walls are
  // cut, and parts are read. The number along the walls grows with the square root of all, and with
  // the area of the walls.
  static double division_work(std::size_t triangles, std::size_t groups) {
    const double n = double(triangles);
    return 2 * n + 40 * std::sqrt(n) * std::pow(double(groups), 2.0 / 3);
  }

  // Half of the sites on each side of a plane across the longest extent.
  std::vector<int> halves(const std::vector<Vec3>& sites) const {
    Box3 box;
    for (const Vec3& site : sites) box.add(stretch * site);
    int axis = 0;
    (box.hi - box.lo).maxCoeff(&axis);
    std::vector<double> at;
    for (const Vec3& site : sites) at.push_back((stretch * site)[axis]);
    std::vector<double> sorted = at;
    std::nth_element(sorted.begin(), sorted.begin() + std::ptrdiff_t(sorted.size() / 2), sorted.end());
    std::vector<int> group;
    for (const double x : at) group.push_back(x < sorted[sorted.size() / 2] ? 0 : 1);
    return group;
  }

  static std::vector<int> each(std::size_t count) {
    std::vector<int> group(count);
    for (std::size_t i = 0; i < count; ++i) group[i] = int(i);
    return group;
  }

  void insert(Complex& complex, const TriangleMesh& walls) const {
    if (options.guard == ImpactGuard::none) {
      try {
        return crack::insert_unguarded(complex, walls, 1);
      } catch (const GeometryError&) {
        // One attempt was not enough, and the complex is as it was.
      }
    }
    insert_sheet(complex, walls, 1);
  }

  // The part, cut along the walls between groups of its sites; no chunks where that fails.
  std::vector<Chunk> cut(std::size_t part, const std::vector<Vec3>& sites, const std::vector<int>& group) const {
    const Breakable::Impl& solid = parts[part].solid.impl();
    Complex complex = solid.complex ? *solid.complex : Complex::from_skin(solid.mesh);
    Box3 box = bounding_box(solid.mesh);
    for (const Vec3& site : sites) box.add(site);  // those of other parts that the walls separate
    try {
      const TriangleMesh walls = walls_between(sites, group, box.grown(0.25 * box.diagonal()), stretch);
      if (walls.triangles.empty()) return {};
      insert(complex, walls);
    } catch (const GeometryError&) {
      return {};
    }
    return chunks_of(complex, solid.mesh);
  }

  void divide(const Job& job, bool wholly) {
    const std::vector<int> group = wholly ? each(job.sites.size()) : halves(job.sites);
    std::vector<Chunk> chunks = cut(job.part, job.sites, group);
    if (chunks.size() < 2 && !wholly) return divide(job, true);
    if (chunks.size() < 2) return add_job(job.part, {});
    parts[job.part].divided = true;
    for (Chunk& chunk : chunks) {
      auto impl = std::make_shared<Breakable::Impl>();
      mark_inner_faces(chunk.mesh);
      impl->volume = chunk.volume;
      impl->mesh = std::move(chunk.mesh);
      std::vector<Vec3> own;
      if (!wholly && impl->volume > least_volume * parts[0].solid.volume()) {
        const int here = group[nearest_site(job.sites, point_inside(impl->mesh), stretch)];
        for (std::size_t s = 0; s < job.sites.size(); ++s)
          if (group[s] == here) own.push_back(job.sites[s]);
      }
      parts.push_back({.solid = Breakable(std::move(impl)), .parent = job.part, .divided = false, .whole = false});
      if (own.size() < 2) own.clear();
      move_sites(own, options.seed + parts.size());
      add_job(parts.size() - 1, std::move(own));
    }
  }

  void make_hulls(std::size_t part) {
    parts[part].hulls = convex_decomposition(parts[part].solid.mesh(), options.hull_parts, options.hull_corners);
    parts[part].whole = true;
  }

  // Makes one step, the largest that fits; false where not even the smallest does, unless it must.
  bool step(double seconds, bool must) {
    // Divisions first, the nearest first; hulls of parts that are whole otherwise.
    const auto order = [](const Job& a, const Job& b) {
      return std::pair(a.sites.empty(), a.distance) < std::pair(b.sites.empty(), b.distance);
    };
    const auto next = std::min_element(jobs.begin(), jobs.end(), order);
    const std::size_t triangles = parts[next->part].solid.mesh().triangles.size();
    const bool hulls = next->sites.empty();
    bool wholly = true;
    double work = hulls ? double(triangles * options.hull_parts) : division_work(triangles, next->sites.size());
    double& rate = hulls ? hull_rate : divide_rate;
    if (!hulls && work * rate > seconds) {
      wholly = next->sites.size() == 2;
      work = division_work(triangles, 2);
    }
    if (!must && work * rate > seconds) return false;
    const Job job = std::move(*next);
    jobs.erase(next);
    Stopwatch watch;
    if (hulls)
      make_hulls(job.part);
    else
      divide(job, wholly);
    rate = 0.5 * (rate + watch.lap() / std::max(work, 1.0));
    return true;
  }
};

Breaking::Breaking(const Breakable& solid, const Impact& impact, const ImpactOptions& options)
    : impl_(std::make_unique<Impl>()) {
  if (!in_range(impact.point) || !in_range(impact.direction))
    throw InputError("the impact has a coordinate that is not finite, or too large");
  if (!(impact.energy >= 0 && impact.energy <= 1e30)) throw InputError("the energy must be from 0 to 1e30 J");
  if (!(options.toughness > 0 && options.toughness <= 1e30))
    throw InputError("the toughness must be above 0 and at most 1e30 J per square unit");
  if (options.max_pieces < 2 || options.max_pieces > 10000) throw InputError("pieces at most: give 2 to 10000");
  if (!(options.grading >= 0 && options.grading <= 4)) throw InputError("the grading must be from 0 to 4");
  if (!(options.elongation >= 0.1 && options.elongation <= 10))
    throw InputError("the elongation must be from 0.1 to 10");
  if (options.hull_parts < 1 || options.hull_parts > 100 || options.hull_corners < 4 || options.hull_corners > 10000)
    throw InputError("hulls: give 1 to 100, of 4 to 10000 corners");
  impl_->impact = impact;
  impl_->options = options;
  impl_->stretch = shortened_along(impact.direction, options.elongation);
  impl_->parts.push_back({.solid = solid, .parent = ~std::size_t(0), .divided = false, .whole = false});
  std::vector<Vec3> sites;
  if (const int count = site_count(solid.volume(), impact, options); count >= 2) {
    const auto& known = solid.impl().inner;
    sites = impact_sites(known.empty() ? inner_points(solid.mesh(), 1) : known, count, impact, options, impl_->stretch);
  }
  if (sites.size() < 2) sites.clear();
  impl_->add_job(0, std::move(sites));
}

Breaking::Breaking(Breaking&&) noexcept = default;
Breaking& Breaking::operator=(Breaking&&) noexcept = default;
Breaking::~Breaking() = default;

bool Breaking::advance(double seconds) {
  Stopwatch watch;
  for (double left = seconds; !finished(); left -= watch.lap())
    if (!impl_->step(left, left == seconds)) break;
  return finished();
}

bool Breaking::finished() const { return impl_->jobs.empty(); }

const std::vector<BrokenPart>& Breaking::parts() const { return impl_->parts; }

}  // namespace geo
