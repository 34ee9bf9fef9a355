// What surfaces of one body that touch do to each other within an implicit step: a penalty on how far places pass each other,
// with Coulomb friction (§ 3.3).
#pragma once

#include "contact/impulses.h"
#include "mechanics/potential.h"

namespace geo {

struct TouchPenaltyOptions {
  double friction = 0.3;  ///< Coulomb's coefficient
  double slow = 0;        ///< way along each other, model units, below which friction is smooth
};

/// ½ stiffness depth² for each couple of places that passes its normal's limit. Friction acts on the way since the step began,
/// with the normal force of that moment, as friction.h has it.
class TouchPenalty : public Potential {
 public:
  explicit TouchPenalty(const TouchPenaltyOptions& options) : options_(options) {}
  /// As if it were new; the memory is kept.
  void restart(const TouchPenaltyOptions& options) { options_ = options, rows_.clear(), entries_.clear(); }

  /// A couple whose places, along its normal, have passed the limit by `depth` (negative: not yet) at displacements u.
  void add(const RelativeRow& row, const Vec3& normal, double depth, double stiffness, const std::vector<Vec3>& u) {
    add(row, normal, depth, stiffness, weighed(row.entries, u));
  }
  /// The same, given the row's relative displacement.
  void add(const RelativeRow& row, const Vec3& normal, double depth, double stiffness, const Vec3& start);
  /// Room for as many more.
  void reserve(std::span<const RelativeRow> rows);
  std::size_t size() const { return rows_.size(); }
  /// How many press on each other, at the displacements of the last force() call.
  std::size_t pressing() const;

  void each_row(const VisitRow& visit) const override;
  void add_energy(const std::vector<Vec3>& u, std::span<const std::uint32_t> part, std::vector<double>& sum) const override;
  void force(const std::vector<Vec3>& u, std::vector<Vec3>& out) override;

 private:
  struct Row {
    std::size_t first, end;  // of its entries
    Vec3 normal;
    double depth;            // when the step began
    double stiffness;        // N/m
    Vec3 start;              // relative displacement then
    Mat3 curvature;          // of the last force()
    bool pressing;           // then
  };
  std::span<const NodeWeight> entries(const Row& row) const { return {entries_.data() + row.first, entries_.data() + row.end}; }
  Vec3 at(const Row& row, const std::vector<Vec3>& values) const { return weighed(entries(row), values); }
  double most_friction(const Row& row) const { return options_.friction * row.stiffness * row.depth; }

  TouchPenaltyOptions options_;
  std::vector<Row> rows_;
  std::vector<SurfaceWeights::Entry> entries_;
};

}  // namespace geo
