// Impacts: a solid breaks where it is hit, while a game or a trainer runs. Pieces are small at the
// impact and large away from it, and come within a budget of time for each call.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "kerf/mesh.h"
#include "kerf/vec.h"

namespace geo {

/// A solid, prepared to be broken. Copies share it; it never changes. Making it is the slow part of
/// an impact, and best done when a model is loaded.
class Breakable {
 public:
  /// \param solid  a valid model (require_solid()); attributes stay with its triangles
  /// \throws InputError where it is not valid, or has cracks already
  explicit Breakable(TriangleMesh solid);
  /// The solid. Faces of breaks have the group crack_group, and a patch other than 0.
  const TriangleMesh& mesh() const;
  /// Volume, model units³.
  double volume() const;

  struct Impl;
  /// For Breaking alone.
  explicit Breakable(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}
  /// For Breaking alone.
  const Impl& impl() const { return *impl_; }

 private:
  std::shared_ptr<const Impl> impl_;
};

/// A blow.
struct Impact {
  Vec3 point = Vec3::Zero();      ///< model units; inside the solid, or near it
  Vec3 direction = Vec3::Zero();  ///< pieces are longer along it; zero: they are not
  double energy = 0;              ///< J: the more, the more pieces
};

/// Whether a break checks, as cracks of other kinds do, that no faces cross where coordinates are
/// rounded. How faces are joined is exact in any case. The check takes up to two thirds of a break.
enum class ImpactGuard {
  none,  ///< faces of a piece may cross by some ulps, though none did in tests
  full,  ///< none cross: pieces are valid models (require_solid())
};

/// The material, and what becomes of the pieces.
struct ImpactOptions {
  /// Energy that a new wall takes, J per square model unit. Voronoi cells of n sites in a volume V
  /// have walls of about 2.91 ∛n V^⅔ (as those of a Poisson process), hence n from the energy.
  double toughness = 100;
  int max_pieces = 64;            ///< sites at most
  double grading = 1;             ///< spacing of sites over distance from the impact, as a power; 0: even
  double elongation = 2;          ///< length along the direction over width
  std::size_t hull_parts = 1;     ///< convex hulls of a piece, at most
  std::size_t hull_corners = 32;  ///< of a hull, at most
  std::uint64_t seed = 1;
  ImpactGuard guard = ImpactGuard::none;
};

/// A part of a solid that breaks.
struct BrokenPart {
  Breakable solid;                       ///< may be broken again once it is whole
  std::size_t parent = ~std::size_t(0);  ///< the part that it came out of; none: the solid itself
  bool divided = false;                  ///< it broke further: other parts have taken its place
  bool whole = false;                    ///< it breaks no further in this impact, and has its hulls
  std::vector<TriangleMesh> hulls = {};
};

/// A break that goes on from call to call. After each, the parts that are not divided fill the
/// solid. Those near the impact are divided first.
class Breaking {
 public:
  /// Chooses where the solid breaks, and breaks nothing yet.
  ///
  /// \throws InputError for options out of range, and coordinates that are not finite
  Breaking(const Breakable& solid, const Impact& impact, const ImpactOptions& options = {});
  /// Takes the break of another, which must not be used afterwards.
  Breaking(Breaking&&) noexcept;
  /// Likewise.
  Breaking& operator=(Breaking&&) noexcept;
  ~Breaking();

  /// Goes on for about `seconds`, for one step at least, and returns whether it is finished. Steps
  /// are chosen to fit; the smallest divides a part in two, or makes the hulls of one. The result
  /// depends on the steps, and with enough time for all at once on the arguments alone.
  bool advance(double seconds);
  /// Whether nothing is left to do.
  bool finished() const;
  /// All parts, in the order in which they came out; the first is the solid.
  const std::vector<BrokenPart>& parts() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace geo
