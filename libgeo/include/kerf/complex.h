// The crack complex K: skin and crack triangles kept once, and the two-sided surface derived from
// them.
//
// Around each edge of K its faces are kept in radial order. That order is decided once, by exact
// predicates, and from then on it is authoritative: rounding a coordinate never re-sorts it. (The
// structure is Weiler's radial edge; see also B. Levy, "Exact predicates, exact constructions and
// combinatorics for mesh CSG", 2024.)
#pragma once

#include <array>
#include <cstdint>
#include <iterator>
#include <vector>

#include "geometry/triangle_index.h"
#include "kerf/mesh.h"
#include "kerf/vec.h"

namespace geo {

/// A face of K seen from one of its material sides. Side 0 is the material behind the face
/// (opposite to its normal), side 1 the material before it. A skin face has side 0 only; a crack
/// face has both.
struct Side {
  FaceId face;
  int which = 0;
  friend auto operator<=>(const Side&, const Side&) = default;
};

/// The faces around one edge, in order. Few edges have more than two.
class FaceRing {
 public:
  void push_back(FaceId f) {
    if (count_ < few)
      inline_[count_] = f;
    else {
      if (count_ == few) many_.assign(inline_.begin(), inline_.end());
      many_.push_back(f);
    }
    ++count_;
  }
  std::size_t size() const { return count_; }
  bool empty() const { return count_ == 0; }
  const FaceId* begin() const { return count_ <= few ? inline_.data() : many_.data(); }
  const FaceId* end() const { return begin() + count_; }
  FaceId operator[](std::size_t i) const { return begin()[i]; }

 private:
  static constexpr std::size_t few = 6;
  std::array<FaceId, few> inline_;
  std::vector<FaceId> many_;
  std::size_t count_ = 0;
};

/// What changes in one commit; rows refer to K as it is before the commit.
struct ComplexEdit {
  struct NewFace {
    std::array<VertexId, 3> v;  ///< existing ids, or vertex_count() + i for new_vertices[i]
    std::int32_t crack = 0;     ///< 0 skin, c > 0 crack c
    FaceId parent;              ///< the removed face that it is a part of, or invalid
  };
  /// The faces around one edge of three or more faces, counter-clockwise about a→b (seen with b
  /// towards the eye).
  struct Ring {
    VertexId a, b;
    std::vector<FaceId> faces;  ///< kept faces by id, new_faces[i] as face_count() + i
  };
  std::vector<Vec3> new_vertices;
  std::vector<FaceId> removed_faces;
  std::vector<NewFace> new_faces;
  std::vector<Ring> rings;  ///< for every edge that has ≥ 3 faces after the commit and gains or loses one in it
  bool empty() const { return removed_faces.empty() && new_faces.empty() && new_vertices.empty(); }
};

/// What a commit did; all that any consumer (graph, binding, contact, viewer) needs to follow.
struct CrackDelta {
  std::vector<VertexId> new_vertices;
  std::vector<FaceId> removed_faces, new_faces;  ///< new_faces holds skin children and crack faces
  std::vector<FaceId> new_crack_faces;           ///< crack faces that are part of no earlier face
  std::vector<SurfaceVertexId> removed_surface_vertices, new_surface_vertices;
  std::vector<SurfaceVertexId> touched_surface_vertices;  ///< kept ones whose triangles changed
  /// new_surface_vertices[i] appeared at the site of copied_from[i], or of no earlier one
  /// (invalid).
  std::vector<SurfaceVertexId> copied_from;
  bool empty() const { return removed_faces.empty() && new_faces.empty(); }
};

class Complex {
 public:
  struct Face {
    std::array<VertexId, 3> v;
    std::int32_t crack = 0;  ///< 0 skin, c > 0 crack c
    bool alive = false;
    /// Row of the triangle that this face is a part of, in the surface that the complex was made
    /// from (of a crack that was there already: on its positive side); ~0u: of a crack made since.
    std::uint32_t source = ~0u;
  };

  Complex() = default;
  /// K of a closed, consistently oriented, outward skin (several components allowed). Two skin
  /// faces share each edge. Throws InputError (with vertex rows) when the mesh is open,
  /// non-manifold at an edge, inconsistently oriented, inside-out, or has degenerate or duplicate
  /// triangles. Self-intersection is check.h's business.
  static Complex from_skin(const TriangleMesh& skin);
  /// Reads K back from a two-sided surface as `two_sided()` writes it, with the same vertex and
  /// radial orders, or from a plain skin. Throws InputError when the sides do not pair up.
  static Complex from_two_sided(const TriangleMesh& surface);

  // ---- K. Ids are stable: faces and vertices are appended and never renumbered; removed faces
  // stay as dead rows.
  std::uint32_t vertex_count() const { return static_cast<std::uint32_t>(points_.size()); }
  std::uint32_t face_count() const { return static_cast<std::uint32_t>(faces_.size()); }  ///< dead rows included
  std::uint32_t live_face_count() const { return live_faces_; }
  const Vec3& point(VertexId v) const { return points_[v.index()]; }
  const Face& face(FaceId f) const { return faces_[f.index()]; }
  bool alive(FaceId f) const { return faces_[f.index()].alive; }
  std::array<Vec3, 3> corners(FaceId f) const {
    const auto& v = face(f).v;
    return {point(v[0]), point(v[1]), point(v[2])};
  }
  const Box3& box(FaceId f) const { return index_.box(f.value); }  ///< of a living face
  /// Bounding box of the skin as first given; never changes. Its diagonal is the length that
  /// tolerances scale with.
  const Box3& extent() const { return extent_; }
  std::int32_t crack_count() const { return crack_count_; }  ///< the largest crack number in use

  /// The faces around edge ab, counter-clockwise about a→b when a < b (and in that same order when
  /// a > b). Empty when there is no such edge.
  FaceRing around(VertexId a, VertexId b) const;
  /// The live faces at a vertex, ascending: a range.
  class FacesAt;
  FacesAt faces_at(VertexId v) const;
  /// Appends to `out`, ascending, the live faces whose boxes meet `box`.
  void near(const Box3& box, std::vector<FaceId>& out) const;
  /// The same for the box of triangle abc, grown by `reach`, without faces that its plane is clear
  /// of.
  void near_triangle(const Vec3& a, const Vec3& b, const Vec3& c, double reach, std::vector<FaceId>& out) const;

  // ---- The derived surface S_A: closed, oriented, manifold by construction.
  bool has(Side s) const { return alive(s.face) && (s.which == 0 || face(s.face).crack > 0); }
  /// The surface vertex at corner k (0, 1, 2: the face's k-th vertex) of a side.
  SurfaceVertexId surface_vertex(Side s, int k) const { return corner_vertex_[s.face.index() * 6 + s.which * 3 + k]; }
  /// The side across the edge from the face's k-th vertex to its (k+1)-th one: the one that bounds
  /// the same wedge.
  Side neighbor(Side s, int k) const;
  std::uint32_t surface_vertex_count() const {
    return static_cast<std::uint32_t>(site_.size());
  }                                                                    ///< dead rows included
  VertexId site(SurfaceVertexId v) const { return site_[v.index()]; }  ///< invalid when v is dead
  bool alive(SurfaceVertexId v) const { return site_[v.index()].valid(); }
  /// One corner (side and k) of a live surface vertex, from which its fan can be walked.
  std::pair<Side, int> corner_of(SurfaceVertexId v) const { return {fan_side_[v.index()], fan_corner_[v.index()]}; }
  /// The surface vertices one edge away along the derived surface, ascending. No crack connects
  /// them.
  void surface_neighbors(SurfaceVertexId v, std::vector<SurfaceVertexId>& out) const;

  /// The derived surface as a mesh, rows in ascending surface vertex and side order; `rows`, where
  /// given, receives the row of each surface vertex id (~0u: dead). Triangles face outwards; patch,
  /// site and source (Face::source) are filled.
  TriangleMesh two_sided(std::vector<std::uint32_t>* rows = nullptr) const;

  /// Replaces each face's source s by rows[s]: for a complex that was read back, where rows tell
  /// what it was made from at first. Throws InputError unless there is a row for each.
  void trace_sources(const std::vector<std::uint32_t>& rows);

  /// Applies an edit: all or nothing. Re-sorts the rings given, re-fans the vertices touched,
  /// updates the index. Cost follows the edit. Throws GeometryError (nothing changed) when the edit
  /// would break a structural rule: an edge with a single skin face, a ring that does not list its
  /// edge's faces, skin and material sides that disagree.
  CrackDelta apply(const ComplexEdit& edit);
  /// Takes the last edit back: everything is as before it, to the ids that the next one gives. Cost
  /// follows the edit. Throws GeometryError when there is none that is not taken back yet.
  void take_back();

  /// The edit that turns this complex into `other`, which must have grown from it (same ids for the
  /// same vertices). Throws InputError when it has not.
  ComplexEdit difference(const Complex& other) const;

 private:
  friend class ComplexBuilder;
  static constexpr std::uint32_t no_corner = ~0u;
  static std::uint64_t key(VertexId a, VertexId b) {
    const auto lo = std::min(a.value, b.value), hi = std::max(a.value, b.value);
    return std::uint64_t(lo) << 32 | hi;
  }
  /// A face at edge ab; invalid when there is none.
  FaceId any_at(VertexId a, VertexId b) const;
  /// Which of its edges ab is, for a face that has it.
  static int edge_in(const Face& f, VertexId a, VertexId b);
  FaceId next_around(FaceId f, VertexId a, VertexId b) const {
    return radial_[f.index() * 3 + static_cast<std::size_t>(edge_in(face(f), a, b))];
  }
  void link_corners(FaceId f);
  void unlink_corners(FaceId f);
  void link_ring(VertexId a, VertexId b, const FaceId* faces, std::size_t count);

  struct Fan {
    Side lowest;
    int corner;  // of the lowest side
    std::size_t first_corner, end_corner, first_candidate, end_candidate;
  };
  struct FanScratch {
    std::vector<std::pair<Side, int>> corners;
    std::vector<SurfaceVertexId> candidates;
    std::vector<Fan> fans;
    std::vector<SurfaceVertexId> claimed;
  };
  /// Renews the fans at v; `old_ids`: surface vertices that stood there and whose corners are gone.
  void refan(VertexId v, std::vector<SurfaceVertexId>& old_ids, CrackDelta* delta, FanScratch& scratch);

  /// What stood where the last edit has changed something that it has not removed.
  struct Undo {
    struct Stand {
      SurfaceVertexId v;
      VertexId site;
      Side side;
      std::uint8_t corner;
    };
    bool possible = false;
    std::uint32_t vertices, faces, surface_vertices;
    std::int32_t cracks;
    std::vector<FaceId> removed;
    std::vector<std::pair<std::size_t, FaceId>> radial;            // places in radial_
    std::vector<std::pair<std::size_t, SurfaceVertexId>> corners;  // in corner_vertex_
    std::vector<Stand> stands;
  };
  /// Keeps what is at v, and the surface vertices whose corners there are gone.
  void remember(VertexId v, const std::vector<SurfaceVertexId>& gone);

  std::vector<Vec3> points_;
  std::vector<Face> faces_;
  std::uint32_t live_faces_ = 0;
  std::int32_t crack_count_ = 0;
  Box3 extent_;
  std::vector<FaceId> radial_;  // 3 a face: the next face around its edge k, ccw about lower→higher vertex
  std::vector<std::uint32_t> first_corner_;     // per vertex: 3 f + k of the lowest face at it
  std::vector<std::uint32_t> next_corner_;      // 3 a face: the next corner at the same vertex
  std::vector<SurfaceVertexId> corner_vertex_;  // 6 a face: [side][corner]
  std::vector<VertexId> site_;                  // per surface vertex
  std::vector<Side> fan_side_;
  std::vector<std::uint8_t> fan_corner_;
  TriangleIndex index_;
  std::vector<std::uint32_t> mark_;  // per vertex: the last commit that touched it
  std::uint32_t epoch_ = 0;
  Undo undo_;
};

class Complex::FacesAt {
 public:
  class iterator {
   public:
    using iterator_category = std::forward_iterator_tag;
    using value_type = FaceId;
    using difference_type = std::ptrdiff_t;
    using pointer = const FaceId*;
    using reference = FaceId;
    iterator() = default;
    iterator(const std::uint32_t* next, std::uint32_t at) : next_(next), at_(at) {}
    FaceId operator*() const { return FaceId(at_ / 3); }
    iterator& operator++() { return at_ = next_[at_], *this; }
    iterator operator++(int) {
      const auto old = *this;
      ++*this;
      return old;
    }
    friend bool operator==(const iterator& a, const iterator& b) { return a.at_ == b.at_; }

   private:
    const std::uint32_t* next_ = nullptr;
    std::uint32_t at_ = no_corner;
  };
  FacesAt(const std::uint32_t* next, std::uint32_t first) : next_(next), first_(first) {}
  iterator begin() const { return {next_, first_}; }
  iterator end() const { return {next_, no_corner}; }
  bool empty() const { return first_ == no_corner; }

 private:
  const std::uint32_t* next_;
  std::uint32_t first_;
};

inline Complex::FacesAt Complex::faces_at(VertexId v) const { return {next_corner_.data(), first_corner_[v.index()]}; }

/// The faces that the closed segment pq touches, by exact predicates.
std::vector<FaceId> faces_on_segment(const Complex& complex, const Vec3& p, const Vec3& q);

}  // namespace geo
