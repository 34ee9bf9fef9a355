// Distinct integer ids: a vertex of the crack complex cannot be passed where a node is meant.
#pragma once

#include <compare>
#include <cstdint>
#include <functional>
#include <limits>

namespace geo {

/// A 32-bit index that only converts to other types by `.value`. Default-constructed it is invalid.
template <class Tag>
struct Id {
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t value = none;

  constexpr Id() = default;
  constexpr explicit Id(std::uint32_t v) : value(v) {}
  constexpr explicit Id(std::size_t v) : value(static_cast<std::uint32_t>(v)) {}
  constexpr bool valid() const { return value != none; }
  constexpr std::size_t index() const { return value; }
  friend constexpr auto operator<=>(Id, Id) = default;
};

using VertexId = Id<struct VertexTag>;                ///< a vertex of the crack complex K (a "site")
using FaceId = Id<struct FaceTag>;                    ///< a face of the crack complex K
using SurfaceVertexId = Id<struct SurfaceVertexTag>;  ///< a vertex of the derived two-sided surface (a fan)
using NodeId = Id<struct NodeTag>;                    ///< a simulation node

}  // namespace geo

template <class Tag>
struct std::hash<geo::Id<Tag>> {
  std::size_t operator()(geo::Id<Tag> id) const noexcept { return std::hash<std::uint32_t>{}(id.value); }
};
