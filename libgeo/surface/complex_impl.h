// Private state of the crack complex K, and the grouping of sides into fans that building and
// committing share.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "geometry/triangle_index.h"
#include "kerf/complex.h"

namespace geo {

/// Members of Complex that no inline accessor reads.
struct Complex::Impl {
  /// The state that a commit overwrote, for undo().
  struct UndoLog {
    /// A vertex of S_A as it was.
    struct Fan {
      SurfaceVertexId v;
      VertexId site;
      Side side;
      std::uint8_t corner;
    };
    std::uint32_t vertices, faces, surface_vertices;  ///< counts before the commit
    std::int32_t cracks;
    std::vector<FaceId> removed;
    std::vector<std::pair<std::size_t, FaceId>> radial;            ///< index into radial_, old value
    std::vector<std::pair<std::size_t, SurfaceVertexId>> corners;  ///< index into corner_vertex_, old value
    std::vector<Fan> fans;
  };

  TriangleIndex index;               ///< living faces
  std::vector<std::uint32_t> marks;  ///< per vertex: the last commit that touched it
  std::uint32_t epoch = 0;           ///< number of the last commit
  std::vector<UndoLog> logs;         ///< of the last commit, or of the commits of the last group
  /// The kind of the next commit: the first of a group follows no other.
  enum class Next { single, first_of_group, further_of_group } next = Next::single;
};

/// Groups the sides at a vertex of K into fans and gives each fan a vertex of S_A. Holds scratch
/// memory: use one for many vertices.
class Complex::FanBuilder {
 public:
  /// For the fans of `complex`.
  explicit FanBuilder(Complex& complex) : k_(complex) {}
  /// Rebuilds the fans at v from the radial cycles. A fan keeps an id that one of its corners had,
  /// if no other fan has claimed it. `old_ids`: surface vertices of v whose corners are gone; it is
  /// overwritten. `delta`, where given, receives the changes.
  void rebuild(VertexId v, std::vector<SurfaceVertexId>& old_ids, CrackDelta* delta);

 private:
  struct Fan {
    Side lowest;
    int corner;  // of the lowest side
    std::size_t first_corner, end_corner, first_candidate, end_candidate;
  };
  void collect_fans(VertexId v, std::vector<SurfaceVertexId>& old_ids);
  void walk_fan(Side start, VertexId v, std::vector<SurfaceVertexId>& old_ids);
  void claim_id(const Fan& fan, VertexId v, CrackDelta* delta);

  Complex& k_;
  std::vector<std::pair<Side, int>> corners_;  // of the fans at hand, side by side
  std::vector<SurfaceVertexId> candidates_;    // ids that a fan's corners had
  std::vector<Fan> fans_;
  std::vector<SurfaceVertexId> claimed_;
};

}  // namespace geo
