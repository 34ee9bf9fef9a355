// What surfaces of one body that touch do to each other within an implicit step: a penalty on how far places pass each
// other, with Coulomb friction (§ 3.3).
#pragma once

#include "contact/response/impulses.h"
#include "mechanics/terms/potential.h"

namespace geo {

struct SelfContactPenaltyOptions {
  double friction = 0.3;  ///< Coulomb's coefficient
  double slow = 0;        ///< way along each other, model units, below which friction is smooth
};

/// ½ stiffness depth² for each couple of places that passes its normal's limit. Friction acts on the way since the step
/// began, with the normal force of that moment, as friction.h has it.
class SelfContactPenalty : public Potential {
 public:
  explicit SelfContactPenalty(const SelfContactPenaltyOptions& options) : options_(options) {}
  /// As if it were new; the memory is kept.
  void restart(const SelfContactPenaltyOptions& options) { options_ = options, rows_.clear(), entries_.clear(); }

  /// A couple whose places, along its normal, have passed the limit by `depth` (negative: not yet) at displacements u,
  /// those at which the step begins.
  void add(const RelativeStencil& row, const Vec3& normal, double depth, double stiffness, const std::vector<Vec3>& u) {
    add(row, normal, depth, stiffness, weighed(row.entries, u));
  }
  /// The same, given the row's relative displacement.
  void add(const RelativeStencil& row, const Vec3& normal, double depth, double stiffness, const Vec3& start);
  /// Room for as many more.
  void reserve(std::span<const RelativeStencil> rows);
  /// How many press on each other, where each was last asked for its push().
  std::size_t pressing() const;

  std::size_t size() const override { return rows_.size(); }
  std::span<const NodeWeight> row(std::size_t r) const override {
    return {entries_.data() + rows_[r].first, entries_.data() + rows_[r].end};
  }
  void begin(const std::vector<Vec3>&, double from, double) override { begun_ = from <= 0; }
  double reach(std::size_t r) const override { return begun_ ? rows_[r].reach : 0; }
  double energy(std::size_t r, const Vec3& way) const override;
  Push push(std::size_t r, const Vec3& way) override;

 private:
  struct Row {
    std::size_t first, end;  // of its entries
    Vec3 normal;
    double depth;      // when the step began
    double stiffness;  // N/m
    double reach;      // how far nodes may go since then before the couple can press
    Vec3 start;        // relative displacement then
    bool pressing;     // at the last push()
  };
  double most_friction(const Row& row) const { return options_.friction * row.stiffness * row.depth; }

  SelfContactPenaltyOptions options_;
  bool begun_ = false;  // rows' starts are where nodes were at begin()
  std::vector<Row> rows_;
  std::vector<SurfaceWeights::Entry> entries_;
};

}  // namespace geo
