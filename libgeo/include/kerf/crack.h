// Crack insertion: a splitting front that sweeps through the material (§ 5.1, 5.2), or a crack
// given as a surface; local edits of what was inserted.
//
// Symbols of the paper:
//   F_i   the splitting front at time step i: a polyline in material coordinates
//   S_S   the strip: triangles swept from F_i to F_(i+1), in the code `Strip`
//   K     the crack complex (kerf/complex.h), into which the strip's material parts are inserted
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "kerf/complex.h"
#include "kerf/mesh.h"
#include "kerf/progress.h"
#include "kerf/vec.h"

namespace geo {

// ---- Fronts as given

/// A front over time: F_0, F_1, … A closed front joins its last point to its first. A sheet is a
/// crack given whole: a single step, and triangles of its points.
struct Front {
  std::string name;                      ///< as in its file; may be empty
  bool closed = false;                   ///< the last point is joined to the first
  std::vector<std::vector<Vec3>> steps;  ///< points per time step, each at least two; material coordinates
  std::vector<Triangle> triangles{};     ///< of a sheet: indices into steps[0]; else none

  /// Whether this is a sheet.
  bool is_sheet() const { return !triangles.empty(); }
};

/// Resamples `next` to as many points as `previous`: unchanged where the counts agree, else at the
/// fractions of arc length of the points of `previous`.
/// \param closed  whether the last point is joined to the first
std::vector<Vec3> resample_front(const std::vector<Vec3>& previous, const std::vector<Vec3>& next, bool closed);

/// The number of substeps, at least 1, that keeps each front point's motion per substep at or below
/// a limit (§ 5.1).
/// \param limit  model units
/// \throws InputError unless `limit` is positive
int substep_count(const std::vector<Vec3>& previous, const std::vector<Vec3>& next, double limit);

// ---- Fronts in a crack complex

/// F_i as the crack complex knows it between two steps. Its contacts with K are kept by id and
/// never recomputed from geometry: each segment lists the vertices of K that lie on it, in order,
/// its ends included.
struct FrontState {
  struct Point {
    Vec3 position;  ///< material coordinates
    VertexId id;    ///< the vertex of K at this point; invalid while the point is outside the material
  };
  bool closed = false;
  std::int32_t crack = 0;                    ///< number of the crack behind this front; at least 1
  std::vector<Point> points;                 ///< the front points as given (or as displaced by a repeated attempt)
  std::vector<std::vector<Point>> segments;  ///< segments[i]: points[i], the contacts, points[i+1]
  bool has_moved = false;                    ///< it has made a step, by advance()
  std::uint32_t step = 0;                    ///< the steps of its file that it has made or passed over
  std::string name;
};

/// Numbers for new cracks of a complex. A front has its number before it has cut anything.
class CrackNumbers {
 public:
  /// Above those of the cracks in a complex.
  explicit CrackNumbers(const Complex& complex) : last_(complex.crack_count()) {}
  /// A front has this number.
  void note(std::int32_t crack) { last_ = crack > last_ ? crack : last_; }
  /// The next free number, which is then taken.
  std::int32_t next() { return ++last_; }

 private:
  std::int32_t last_;
};

/// Tolerances are relative to the diagonal of Complex::extent().
struct CrackOptions {
  /// The strip is snapped to vertices of K nearer than this: its vertices move, edges and triangles
  /// are divided there.
  double snap = 1e-14;
  /// As snap, for edges of K, too: they are divided where the strip passes, and it goes through
  /// them. A refused step, or one that cuts off a speck thinner than this, is repeated with a
  /// shorter way before the front is displaced; at last, specks lose a face and are a part of what
  /// is beside them. 0: edges stay. For advance() in material that deforms, where slivers beside an
  /// edge fold.
  double snap_edges = 0;
  /// New front points off K but nearer to a face than face_offset / 100 move away from it by
  /// face_offset. Otherwise the strip would have needles there.
  double face_offset = 1e-6;
  /// Least distance between features of cracks that do not touch (2⁻⁴⁶ ≈ 1.4e-14). The later half
  /// of the attempts has no such limit.
  double clearance = 0x1p-46;
  /// Displacement of the new front in repeated attempt n = 1, 2, …: jitter · 8^min(n − 1, 4).
  double jitter = 1e-9;
  int attempts = 12;       ///< how often a refused step is repeated with the front displaced
  std::uint64_t seed = 1;  ///< of the displacements
};

/// Counts and seconds of one step, by phase.
struct CrackStats {
  /// faces_near: pairs of a strip triangle and a near face of K; triangles_cut: divided faces of K;
  /// attempts: the first one included; snapped: vertices of K that the strip was snapped to;
  /// repairs: attempts in which displaced points removed a fault of rounding; joined_specks: specks
  /// that lost a face of the crack (CrackOptions::snap_edges).
  std::size_t faces_near = 0, triangles_cut = 0, new_crack_faces = 0, attempts = 0, snapped = 0, repairs = 0,
              joined_specks = 0;
  /// near: sweep, near faces, snapping; meet: intersections; split: triangulation; keep:
  /// classification; stitch: edit and commit; guard: checks and repairs after rounding.
  double near_seconds = 0, meet_seconds = 0, split_seconds = 0, keep_seconds = 0, stitch_seconds = 0, guard_seconds = 0;
  /// Adds all counts and seconds.
  CrackStats& operator+=(const CrackStats& other);
  /// Sum of all phases.
  double seconds() const;
};

/// The front before its first step: F_0, without contacts.
/// \param points  material coordinates, two at least
/// \param closed  whether the last point is joined to the first
/// \param crack  number of the crack that the front will leave, at least 1; a number in use
///   continues that crack
/// \throws InputError for fewer than two points or coordinates that are not finite
FrontState begin_front(std::span<const Vec3> points, bool closed, std::int32_t crack);

/// One step of § 5.2: sweeps the front to `next` and inserts the strip into K. Initiation,
/// branching, merging and termination of cracks need no flags: they follow from the intersection.
/// \param next  material coordinates; as many points as the front has
/// \param options  tolerances, relative to the diagonal of Complex::extent()
/// \param stats  where given, is added to
/// \return the changes of K; cost follows the faces that the strip meets
/// \throws InputError for points that do not fit the front
/// \throws GeometryError when no attempt passes the guard; `complex` and `front` are then unchanged
CrackDelta advance(Complex& complex, FrontState& front, std::span<const Vec3> next, const CrackOptions& options = {},
                   CrackStats* stats = nullptr);

/// Inserts the parts of a sheet in the material as one crack, in one step.
/// \param sheet  any triangles, connected or not, crossing each other or not; patch and site are
///   ignored; material coordinates
/// \param crack  number of the crack, at least 1
/// \param options  tolerances, relative to the diagonal of Complex::extent()
/// \param stats  where given, is added to
/// \return the changes of K
/// \throws InputError for a sheet with indices out of range or coordinates that are not finite
/// \throws GeometryError when no attempt passes the guard; `complex` is then unchanged
CrackDelta insert_sheet(Complex& complex, const TriangleMesh& sheet, std::int32_t crack,
                        const CrackOptions& options = {}, CrackStats* stats = nullptr);

// ---- Local edits of a crack complex (§ 5.2, § 8's first limitation). Each is guarded: K never
// intersects itself and S_A stays closed. Vertices stay on all that they lie on: the skin as given,
// the cracks, and the feature lines where these meet.

// ---- Remeshing

/// Lengths are relative to the diagonal of Complex::extent().
struct RemeshOptions {
  double angle = 15;        ///< degrees: faces with a smaller angle are improved
  double deviation = 1e-4;  ///< how far a crack's surface may move in one edit; the skin never does
  double shortest = 2e-3;   ///< no edge is divided into shorter ones
  double crease = 20;       ///< degrees: an edge of a crack with a larger dihedral deviation is a feature
  /// Where given: refuses edits whose faces sweep a tetrahedron for which this is false (a body's
  /// nodes must stay on their sides of a crack).
  std::function<bool(const std::array<Vec3, 4>&)> may_sweep;
};

struct RemeshStats {
  /// faces: bad faces examined, again each time; then the edits made, by kind.
  std::size_t faces = 0, flips = 0, collapses = 0, moves = 0, divisions = 0;
  std::size_t refused = 0;  ///< edits that the guard or may_sweep refused
  double seconds = 0;
};

/// Improves the faces of `region` (dead ones are skipped) that have a smaller angle than wanted, by
/// flips, collapses, moves and divisions. Kept are the skin's surface, the lines where cracks meet
/// each other and the skin, crack tips, creases, and the contacts of `fronts`. A contact merged
/// with its neighbour is removed from its front. Cost follows the region. Returns all changes.
/// Throws InputError for options out of range,
/// Interrupted: the complex is then as before.
CrackDelta remesh(Complex& complex, std::span<const FaceId> region, std::span<FrontState* const> fronts,
                  const RemeshOptions& options = {}, RemeshStats* stats = nullptr, const Progress& progress = {});

/// The smallest angle of a triangle, in degrees.
double smallest_angle(const std::array<Vec3, 3>& corners);

// ---- Roughening: jagged cracks of brittle fracture

/// Lengths are relative to the diagonal of Complex::extent().
struct RoughenOptions {
  double amplitude = 0.01;  ///< of the largest bumps
  double frequency = 8;     ///< of the largest bumps, per diagonal
  int octaves = 4;          ///< each twice as fine and 0.6 times as high
  double edge = 0;          ///< longest edge inside a crack; 0: 1 / (12 · frequency)
  std::uint64_t seed = 1;
  std::vector<std::int32_t> cracks;  ///< numbers of the cracks to roughen; empty: all
};

struct RoughenStats {
  std::size_t divisions = 0;
  std::size_t moves = 0;    ///< inner vertices
  std::size_t lowered = 0;  ///< vertices that moved less far than wanted: something is in the way
  std::size_t refused = 0;  ///< divisions that the guard refused
  double seconds = 0;
};

/// Divides the inner edges of the cracks and displaces their inner vertices along the normal by
/// fractal noise. The noise fades towards the skin, other cracks and the tips, which stay. Both
/// sides of a crack stay alike and the volumes of the pieces keep their sum. A vertex moves less
/// where it would make faces cross. Contacts of `fronts` stay. Returns all changes. Throws
/// InputError for options out of range,
/// Interrupted: the complex is then as before.
CrackDelta roughen(Complex& complex, std::span<FrontState* const> fronts, const RoughenOptions& options = {},
                   RoughenStats* stats = nullptr, const Progress& progress = {});

// ---- Decimation: fewer faces for interactive use

struct DecimateOptions {
  double deviation = 1e-3;  ///< how far the surface may move, relative to the diagonal of Complex::extent()
  std::size_t faces = 0;    ///< no fewer living faces than this
  double crease = 30;       ///< degrees: edges with a larger dihedral deviation are kept as lines
  double angle = 5;         ///< degrees: no face gets a smaller angle unless it had one
};

struct DecimateStats {
  std::size_t collapses = 0;
  std::size_t refused = 0;  ///< collapses that the guard refused
  double seconds = 0;
};

/// Collapses edges of skin and cracks, the shortest first. Lines where surfaces meet, tips and
/// creases stay lines; contacts of `fronts` stay, or are omitted between their neighbours. Volumes
/// change within the deviation. Cost follows the whole complex. Returns all changes. Throws
/// InputError for options out of range,
/// Interrupted: the complex is then as before.
CrackDelta decimate(Complex& complex, std::span<FrontState* const> fronts, const DecimateOptions& options = {},
                    DecimateStats* stats = nullptr, const Progress& progress = {});

}  // namespace geo
