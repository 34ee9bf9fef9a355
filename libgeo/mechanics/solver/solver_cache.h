// Data that implicit steps of one solid reuse. It changes the time of a step, never its result.
#pragma once

#include "mechanics/solver/subdomain_inverses.h"

namespace geo {

/// Owned by a Solid and passed to each of its implicit steps; used by one step at a time.
struct SolverCache {
  SubdomainInverses inverses;  ///< of the last implicit step

  /// An empty cache.
  SolverCache() = default;
  /// An empty cache: a copied solid fills its own.
  SolverCache(const SolverCache&) {}
  SolverCache(SolverCache&&) = default;
};

}  // namespace geo
