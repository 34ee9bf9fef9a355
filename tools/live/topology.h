// The triangles of a deforming, cut surface as a page stores them: in slots that are used again, so
// that a cut is a short list of slots that changed.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <kerf/complex.h>
#include "live/painter.h"

namespace live {

/// The triangles at one time. An empty slot has three equal vertices.
struct Topology {
  std::uint32_t revision = 0;           ///< grows with every change
  std::uint32_t vertices = 0;           ///< slots of vertices
  std::vector<geo::Triangle> triangle;  ///< per slot: vertex slots
  std::vector<std::uint8_t> patch;      ///< per slot: 0 skin, else the crack, at most 255
  std::vector<Eigen::Vector3f> rest;    ///< per vertex slot: its place in the material
  std::vector<TrianglePaint> paint;     ///< per slot; empty where the model has no colours
};

/// Changes from one topology to a later one.
struct TopologyChange {
  std::vector<std::uint32_t> removed, added;  ///< slots: now empty; of a new triangle. Ascending
  std::vector<std::uint32_t> placed;          ///< vertex slots: new, or at another place of the material. Ascending
};
TopologyChange change_between(const Topology& from, const Topology& to);

/// Follows the complex of a run.
class Slots {
 public:
  /// Brings the slots up to date; ids of the complex only grow between two calls. Whether anything
  /// changed. `painter` is the same in all calls, up to clear().
  bool update(const geo::Complex& complex, const Painter& painter = {});
  /// Forgets the complex: the next update() may be of any other one.
  void clear();
  /// The triangles now. The object stays as it is when the slots change.
  std::shared_ptr<const Topology> topology() const { return topology_; }
  /// Per living surface vertex, in ascending order: its slot.
  const std::vector<std::uint32_t>& slot_of_living() const { return living_; }
  /// The slot of a surface vertex; none where it does not live, or has none yet.
  std::optional<std::uint32_t> slot(geo::SurfaceVertexId vertex) const;
  /// The side of a face in a slot; invalid where the slot is empty or does not exist.
  geo::Side side(std::uint32_t slot) const;

 private:
  void fill(Topology& next, const geo::Complex& complex, const Painter& painter) const;

  static constexpr std::uint32_t none = ~0u;
  std::array<std::uint32_t, 3> seen_{none, none, none};  // counts of the complex at the last update
  std::vector<std::uint32_t> vertex_slot_, living_;      // per surface vertex; see slot_of_living()
  std::vector<std::uint32_t> side_slot_;                 // per side: 2 · face + which
  std::vector<std::uint32_t> side_of_slot_;              // per slot
  std::vector<std::uint32_t> painted_side_;              // per slot: as in the last topology
  std::vector<std::uint32_t> free_vertices_, free_faces_;
  std::uint32_t vertex_slots_ = 0, revision_ = 0;
  std::shared_ptr<const Topology> topology_;
};

}  // namespace live
