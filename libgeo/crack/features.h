// The surfaces and feature lines on which a vertex of K lies, and thus where a local edit may move
// it.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <unordered_set>
#include <vector>

#include "kerf/crack.h"

namespace geo::crack {

/// Rules for what local edits must preserve.
struct FeatureRules {
  double crease = 0.94;  ///< cosine: edges with a larger dihedral deviation are features
  /// True: vertices stay on the input triangles on which they lie. False: the skin is treated as a
  /// crack.
  bool keep_skin = true;
};

/// The surfaces and feature lines on which a vertex lies.
struct SurfaceLocation {
  std::vector<std::uint32_t> sources;  ///< triangles of the input, ascending
  std::vector<std::int32_t> cracks;    ///< ascending; 0 for skin that is treated as a crack
  std::vector<VertexId> features;      ///< other ends of the feature edges at it
};

/// True for an edge with other than two faces, with faces of different surfaces, or for a crease.
bool is_feature_edge(const Complex& complex, VertexId a, VertexId b, const FeatureRules& rules);
/// The location of a vertex.
SurfaceLocation location_of(const Complex& complex, VertexId v, const FeatureRules& rules);
/// True when each surface of `some` is one of `all`: a vertex at `some` may be merged into one at
/// `all` without leaving its surfaces.
bool lies_within(const SurfaceLocation& some, const SurfaceLocation& all);
/// The next vertex on a feature line through a location, coming from a; empty where the line ends,
/// branches or does not pass.
std::optional<VertexId> next_on_line(const SurfaceLocation& location, VertexId a);
/// The distance of b from its feature line if b, at `location`, were merged into a; 0 without a
/// line, empty where lines end or branch at it.
std::optional<double> distance_off_line(const Complex& complex, const SurfaceLocation& location, VertexId b,
                                        VertexId a);

/// The contacts of fronts, which local edits must preserve.
class FrontContacts {
 public:
  /// The contacts of these fronts, which must outlive the object.
  explicit FrontContacts(std::span<FrontState* const> fronts);
  /// Whether v is a contact.
  bool contains(VertexId v) const { return contacts_.count(v) > 0; }
  /// True when b is no contact, or is between others and next to a on all its fronts: then it can
  /// be omitted.
  bool may_omit(VertexId b, VertexId a) const;
  /// Removes b from the fronts.
  void omit(VertexId b);

 private:
  std::span<FrontState* const> fronts_;
  std::unordered_set<VertexId> contacts_;
};

}  // namespace geo::crack
