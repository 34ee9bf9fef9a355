// What a vertex of K lies on, and so where it may go.
#pragma once

#include <optional>
#include <span>
#include <unordered_set>
#include <utility>
#include <vector>

#include "crack/local_edit.h"
#include "kerf/crack.h"

namespace geo::crack {

/// The cotangent of a triangle's smallest angle: the smaller the better.
double badness(const std::array<Vec3, 3>& t);

struct PlaceRules {
  double crease = 0.94;  ///< cosine: edges that are bent more are features
  bool skin_keeps =
      true;  ///< vertices stay on the triangles of the input that they lie on; else the skin is as a crack
};

struct Place {
  std::vector<std::uint32_t> sources;  ///< triangles of the input, ascending
  std::vector<std::int32_t> cracks;    ///< ascending; 0 for skin that need not keep
  std::vector<VertexId> features;      ///< other ends of the feature edges at it
};

/// An edge where other than two faces meet, or two of different surfaces, or a crease.
bool is_feature(const Complex& complex, VertexId a, VertexId b, const PlaceRules& rules);
Place place_of(const Complex& complex, VertexId v, const PlaceRules& rules);
/// True when the second lies on all that the first lies on, so that the way between them may.
bool lies_within(const Place& some, const Place& all);
/// Where a line of features through a vertex goes on, coming from a; empty where it ends, branches
/// or does not pass.
std::optional<VertexId> opposite(const Place& place, VertexId a);
/// How far b, which is at `place`, would be from its line of features if it went into a; 0 where no
/// line passes it, empty where lines end or branch at it.
std::optional<double> distance_off_line(const Complex& complex, const Place& place, VertexId b, VertexId a);

/// The contacts of fronts, which local edits must keep.
class Contacts {
 public:
  explicit Contacts(std::span<FrontState* const> fronts);
  bool holds(VertexId v) const { return held_.count(v) > 0; }
  /// True when b is no contact, or lies next to a on its fronts, between others: then it can be
  /// left out.
  bool may_leave_out(VertexId b, VertexId a) const;
  void leave_out(VertexId b);

 private:
  std::span<FrontState* const> fronts_;
  std::unordered_set<VertexId> held_;
};

/// How far p is from the new faces of an edit: the largest, over the surfaces that it changes, of
/// the distances to the nearest face. Skin that keeps does not count: it stays in its planes.
double distance_left(const Complex& complex, const LocalEdit& local, const Vec3& p, const PlaceRules& rules);
/// The worst of the faces at v as they are, and if v were moved to p; those that also have `into`
/// would go.
std::pair<double, double> worst_if_moved(const Complex& complex, VertexId v, const Vec3& p, VertexId into = {});
/// The worst of the faces that an edit removes, and of those that it makes.
double worst_old(const Complex& complex, const LocalEdit& local);
double worst_new(const Complex& complex, const LocalEdit& local);

}  // namespace geo::crack
