// The crack complex K: every triangle of skin and cracks stored once, with the two-sided surface
// derived from it.
//
// K is a non-manifold triangle complex in Weiler's radial-edge form: each edge stores its faces in
// radial order. Exact predicates decide that order once, when faces are inserted. From then on the
// order is authoritative: no rounded coordinate re-sorts it (compare B. Levy, "Exact predicates,
// exact constructions and combinatorics for mesh CSG", 2024).
//
// Terms and the paper's symbols:
//   K        the crack complex; skin faces bound the solid, crack faces lie inside it
//   side     a face seen from material on one side; skin faces have one side, crack faces two
//   wedge    the space between consecutive faces around an edge: all material, or all air
//   fan      sides at a vertex of K, connected through wedges of material: one vertex of S_A
//   S_A      the derived surface: all sides, joined across wedges; closed, oriented, manifold
//   site     the vertex of K at which a vertex of S_A stands; the fans of one site coincide
#pragma once

#include <array>
#include <cstdint>
#include <iterator>
#include <utility>
#include <vector>

#include "kerf/indirect.h"
#include "kerf/mesh.h"
#include "kerf/vec.h"

namespace geo {

/// A face of K seen from one of its material sides. Side 0 is the material behind the face
/// (opposite to its normal), side 1 the material before it. A skin face has side 0 only; a crack
/// face has both.
struct Side {
  FaceId face;
  int which = 0;  ///< 0 or 1
  /// By face, then by side.
  friend auto operator<=>(const Side&, const Side&) = default;
};

/// The faces around one edge in radial order (Weiler's radial cycle). Up to six need no allocation:
/// few edges have more than two faces.
class RadialCycle {
 public:
  /// Appends a face behind the last one.
  void push_back(FaceId f) {
    if (count_ < few)
      inline_[count_] = f;
    else {
      if (count_ == few) many_.assign(inline_.begin(), inline_.end());
      many_.push_back(f);
    }
    ++count_;
  }
  /// Number of faces.
  std::size_t size() const { return count_; }
  /// True without faces: there is no such edge.
  bool empty() const { return count_ == 0; }
  /// The first face of the cycle.
  const FaceId* begin() const { return count_ <= few ? inline_.data() : many_.data(); }
  /// Behind the last face.
  const FaceId* end() const { return begin() + count_; }
  /// The i-th face; i < size().
  FaceId operator[](std::size_t i) const { return begin()[i]; }

 private:
  static constexpr std::size_t few = 6;
  std::array<FaceId, few> inline_;
  std::vector<FaceId> many_;
  std::size_t count_ = 0;
};

/// The changes of one commit. Ids refer to K as it is before the commit.
struct ComplexEdit {
  struct NewFace {
    std::array<VertexId, 3> v;  ///< existing ids, or vertex_count() + i for new_vertices[i]
    std::int32_t crack = 0;     ///< 0: skin, c > 0: crack c
    FaceId parent;              ///< the removed face that contains this one, or invalid
  };
  /// The faces around an edge of three or more faces, counter-clockwise about a→b (seen with b
  /// towards the eye).
  struct RadialOrder {
    VertexId a, b;
    std::vector<FaceId> faces;  ///< kept faces by id, new_faces[i] as face_count() + i
  };
  std::vector<Vec3> new_vertices;
  std::vector<FaceId> removed_faces;
  std::vector<NewFace> new_faces;
  /// One for every edge with three or more faces after the commit that gains a face other than the
  /// child of one that it had. At other edges children take their parents' places.
  std::vector<RadialOrder> radial_orders;
  /// True for an edit that changes nothing.
  bool empty() const { return removed_faces.empty() && new_faces.empty() && new_vertices.empty(); }
};

/// The changes that a commit made: everything that graph, binding, contact and viewers need to
/// update incrementally.
struct CrackDelta {
  std::vector<VertexId> new_vertices;
  std::vector<FaceId> removed_faces, new_faces;  ///< new_faces: children of divided faces, and crack faces
  std::vector<FaceId> new_crack_faces;           ///< crack faces that are no child of an earlier face
  std::vector<SurfaceVertexId> removed_surface_vertices, new_surface_vertices;
  std::vector<SurfaceVertexId> touched_surface_vertices;  ///< kept ones whose triangles changed
  /// new_surface_vertices[i] appeared at the site of copied_from[i], or at a new site (invalid).
  std::vector<SurfaceVertexId> copied_from;
  /// True when no face changed.
  bool empty() const { return removed_faces.empty() && new_faces.empty(); }
};

/// The crack complex K. Ids are stable: faces and vertices are appended and never renumbered, and
/// the entries of removed faces stay, marked dead. Const methods may run on several threads at
/// once.
class Complex {
 public:
  struct Face {
    std::array<VertexId, 3> v;  ///< counter-clockwise seen from the side that the normal points to
    std::int32_t crack = 0;     ///< 0: skin, c > 0: crack c
    bool alive = false;         ///< false once the face is removed
    /// Index of the triangle that contains this face in the original surface of the complex (for a
    /// crack of that surface: the triangle on its positive side). ~0u: none, the crack is newer.
    std::uint32_t source = ~0u;
  };

  /// An empty complex.
  Complex();
  /// K of a closed, consistently oriented, outward skin (several components allowed). Two skin
  /// faces share each edge. Throws InputError, with vertex indices, for a mesh that is open,
  /// non-manifold at an edge, inconsistently oriented or inside out, or has degenerate or duplicate
  /// triangles. Self-intersection is not tested: see check_surface().
  static Complex from_skin(const TriangleMesh& skin);
  /// Reads K back from a two-sided surface as two_sided() writes it, with the same vertex and
  /// radial orders, or from a plain skin. Throws InputError when the sides do not pair up.
  static Complex from_two_sided(const TriangleMesh& surface);

  // ---- Vertices and faces of K

  /// Number of vertices, those without faces included.
  std::uint32_t vertex_count() const { return static_cast<std::uint32_t>(points_.size()); }
  /// Number of face ids, dead ones included.
  std::uint32_t face_count() const { return static_cast<std::uint32_t>(faces_.size()); }
  /// Number of living faces.
  std::uint32_t live_face_count() const { return live_faces_; }
  /// Position of a vertex, material coordinates.
  const Vec3& point(VertexId v) const { return points_[v.index()]; }
  /// A face, dead or alive.
  const Face& face(FaceId f) const { return faces_[f.index()]; }
  /// Whether the face has not been removed.
  bool alive(FaceId f) const { return faces_[f.index()].alive; }
  /// Positions of a face's vertices.
  std::array<Vec3, 3> corners(FaceId f) const {
    const auto& v = face(f).v;
    return {point(v[0]), point(v[1]), point(v[2])};
  }
  /// Bounding box of a living face.
  const Box3& box(FaceId f) const;
  /// Bounding box of the skin as first given; never changes. Tolerances are relative to its
  /// diagonal.
  const Box3& extent() const { return extent_; }
  /// The largest crack number in use.
  std::int32_t crack_count() const { return crack_count_; }

  // ---- Incidence and proximity

  /// The faces around edge ab, counter-clockwise about a→b when a < b (and in that same order when
  /// a > b). Empty when there is no such edge.
  RadialCycle faces_around(VertexId a, VertexId b) const;
  class FacesAt;
  /// The living faces at a vertex, ascending. The range is valid until the next edit.
  FacesAt faces_at(VertexId v) const;
  /// Appends to `out`, ascending, the living faces whose boxes meet `box`.
  void faces_near(const Box3& box, std::vector<FaceId>& out) const;
  /// Appends to `out`, ascending, the living faces near triangle abc. Conditions: the face's box
  /// meets the box of abc grown by `reach` (model units), and is not farther than `reach` from the
  /// plane of abc.
  void faces_near_triangle(const Vec3& a, const Vec3& b, const Vec3& c, double reach, std::vector<FaceId>& out) const;

  // ---- The derived surface S_A: closed, oriented, manifold by construction

  /// Whether the side exists: its face lives, and side 1 only for cracks.
  bool has(Side s) const { return alive(s.face) && (s.which == 0 || face(s.face).crack > 0); }
  /// The vertex of S_A at the k-th corner (0, 1, 2: at the face's k-th vertex) of a side.
  SurfaceVertexId surface_vertex(Side s, int k) const { return corner_vertex_[s.face.index() * 6 + s.which * 3 + k]; }
  /// The neighbour on S_A across the edge from the face's k-th vertex to its (k+1)-th: it bounds
  /// the same wedge.
  Side neighbor(Side s, int k) const;
  /// Number of ids of vertices of S_A, dead ones included.
  std::uint32_t surface_vertex_count() const { return static_cast<std::uint32_t>(site_.size()); }
  /// The vertex of K at which a vertex of S_A stands; invalid for a dead one.
  VertexId site(SurfaceVertexId v) const { return site_[v.index()]; }
  /// Whether the vertex of S_A has not been removed.
  bool alive(SurfaceVertexId v) const { return site_[v.index()].valid(); }
  /// A corner (a side and k) of a living vertex of S_A: where a walk around its fan can start.
  std::pair<Side, int> corner_of(SurfaceVertexId v) const { return {fan_side_[v.index()], fan_corner_[v.index()]}; }
  /// Appends to `out`, ascending, the vertices one edge away on S_A. No such edge passes through a
  /// crack.
  void surface_neighbors(SurfaceVertexId v, std::vector<SurfaceVertexId>& out) const;
  /// S_A as a mesh with patch, site and source: living vertices ascending, triangles in order of
  /// sides. `vertex_index`, where given, receives for each vertex id its index in the mesh, ~0u for
  /// dead ones.
  TriangleMesh two_sided(std::vector<std::uint32_t>* vertex_index = nullptr) const;

  // ---- Edits

  /// Applies an edit: all or nothing. Stores the radial orders given, rebuilds the fans at the
  /// vertices touched, updates the spatial index. Cost follows the edit. Throws GeometryError, K
  /// unchanged, for an edit that breaks a structural rule: an edge with a single skin face, a
  /// radial order that does not list its edge's faces, a wedge with material on one side and air on
  /// the other.
  CrackDelta apply(const ComplexEdit& edit);
  /// Reverts the last edit: the complex is as before it, down to the ids that the next edit
  /// assigns. Cost follows the edit. Throws GeometryError when no edit is left to revert (one at
  /// most is).
  void undo();
  class EditGroup;  // edits that count as one; see surface/edit_group.h
  /// The edit that turns this complex into `other`, which must have grown from it (same ids for the
  /// same vertices). Throws InputError when it has not.
  ComplexEdit difference(const Complex& other) const;
  /// Replaces the source s of each face by sources[s]: composes the map to a surface that was read
  /// back with that surface's own map to its original. Throws InputError when an index is out of
  /// range.
  void map_sources(const std::vector<std::uint32_t>& sources);

 private:
  class Builder;     // makes a complex from a mesh
  class Commit;      // the phases of apply()
  class FanBuilder;  // groups the sides at a vertex into fans
  struct Impl;       // spatial index, undo log, marks

  static constexpr std::uint32_t no_corner = ~0u;
  static std::uint64_t edge_key(VertexId a, VertexId b) {
    const auto lo = std::min(a.value, b.value), hi = std::max(a.value, b.value);
    return std::uint64_t(lo) << 32 | hi;
  }
  FaceId any_face_at(VertexId a, VertexId b) const;  // invalid without an edge ab
  static int edge_in(const Face& f, VertexId a, VertexId b);
  FaceId next_around(FaceId f, VertexId a, VertexId b) const {
    return radial_[f.index() * 3 + static_cast<std::size_t>(edge_in(face(f), a, b))];
  }
  void link_corners(FaceId f);
  void unlink_corners(FaceId f);
  void link_radial_cycle(VertexId a, VertexId b, const FaceId* faces, std::size_t count);

  std::vector<Vec3> points_;
  std::vector<Face> faces_;
  std::uint32_t live_faces_ = 0;
  std::int32_t crack_count_ = 0;
  Box3 extent_;
  std::vector<FaceId> radial_;  // three per face: next face around its edge k, ccw about lower→higher vertex
  std::vector<std::uint32_t> first_corner_;     // per vertex: corner 3 f + k of the lowest face at it
  std::vector<std::uint32_t> next_corner_;      // three per face: the next corner at the same vertex
  std::vector<SurfaceVertexId> corner_vertex_;  // six per face: [side][corner]
  std::vector<VertexId> site_;                  // per vertex of S_A
  std::vector<Side> fan_side_;                  // per vertex of S_A: the lowest side of its fan
  std::vector<std::uint8_t> fan_corner_;        // per vertex of S_A: its corner on that side
  Indirect<Impl> impl_;
};

/// The living faces at a vertex of K, ascending: a forward range.
class Complex::FacesAt {
 public:
  class iterator {
   public:
    using iterator_category = std::forward_iterator_tag;
    using value_type = FaceId;
    using difference_type = std::ptrdiff_t;
    using pointer = const FaceId*;
    using reference = FaceId;
    /// Singular: only to be assigned to.
    iterator() = default;
    /// At corner `at` of the linked list `next`.
    iterator(const std::uint32_t* next, std::uint32_t at) : next_(next), at_(at) {}
    /// The face.
    FaceId operator*() const { return FaceId(at_ / 3); }
    /// To the next face.
    iterator& operator++() {
      at_ = next_[at_];
      return *this;
    }
    /// To the next face; returns where it was.
    iterator operator++(int) {
      const auto old = *this;
      ++*this;
      return old;
    }
    /// Whether both are at the same face.
    friend bool operator==(const iterator& a, const iterator& b) { return a.at_ == b.at_; }

   private:
    const std::uint32_t* next_ = nullptr;
    std::uint32_t at_ = no_corner;
  };
  /// The corners from `first` on in the linked list `next`.
  FacesAt(const std::uint32_t* next, std::uint32_t first) : next_(next), first_(first) {}
  /// The lowest face.
  iterator begin() const { return {next_, first_}; }
  /// Behind the highest face.
  iterator end() const { return {next_, no_corner}; }
  /// True for a vertex without faces.
  bool empty() const { return first_ == no_corner; }

 private:
  const std::uint32_t* next_;
  std::uint32_t first_;
};

/// Declared in the class: needs FacesAt to be complete.
inline Complex::FacesAt Complex::faces_at(VertexId v) const { return {next_corner_.data(), first_corner_[v.index()]}; }

// ---- Queries

/// The living faces that the closed segment pq touches, ascending. Exact.
std::vector<FaceId> faces_on_segment(const Complex& complex, const Vec3& p, const Vec3& q);

}  // namespace geo
