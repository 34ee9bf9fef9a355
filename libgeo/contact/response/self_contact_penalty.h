// What surfaces of one body that touch do to each other within an implicit step: a penalty on how
// far places pass each other, with Coulomb friction (§ 3.3).
#pragma once

#include "contact/response/impulses.h"
#include "mechanics/terms/potential.h"

namespace geo {

struct SelfContactPenaltyOptions {
  double friction = 0.3;  ///< Coulomb's coefficient
  double slow = 0;        ///< way along each other, model units, below which friction is smooth
};

/// ½ stiffness depth² for each couple of places that passes its normal's limit. Friction acts on
/// the way since the step began, with the normal force of that moment, as friction.h has it.
class SelfContactPenalty : public Potential {
 public:
  explicit SelfContactPenalty(const SelfContactPenaltyOptions& options) : options_(options) {}
  /// As if it were new; the memory is kept.
  void restart(const SelfContactPenaltyOptions& options) { options_ = options, rows_.clear(), entries_.clear(); }

  /// A couple whose places, along its normal, have passed the limit by `depth` (negative: not yet)
  /// at displacements u, those at which the step begins.
  void add(const RelativeStencil& row, const Vec3& normal, double depth, double stiffness, const std::vector<Vec3>& u) {
    add(row, normal, depth, stiffness, weighted_sum(row.entries, u));
  }
  /// The same, given the row's relative displacement.
  void add(const RelativeStencil& row, const Vec3& normal, double depth, double stiffness, const Vec3& start);
  /// Room for as many more.
  void reserve(std::span<const RelativeStencil> rows);
  /// How many press on each other, where each was last asked for its derivatives().
  std::size_t pressing() const;

  std::size_t size() const override { return rows_.size(); }
  Stencil stencil(std::size_t k) const override {
    return {entries_.data() + rows_[k].first, entries_.data() + rows_[k].end};
  }
  void begin_substep(const std::vector<Vec3>&, double from, double) override { begun_ = from <= 0; }
  double activation_distance(std::size_t k) const override { return begun_ ? rows_[k].reach : 0; }
  double energy(std::size_t k, const Vec3& d) const override;
  Derivatives derivatives(std::size_t k, const Vec3& d) override;

 private:
  struct Row {
    std::size_t first, end;  // of its entries
    Vec3 normal;
    double depth;      // when the step began
    double stiffness;  // N/m
    double reach;      // how far nodes may go since then before the couple can press
    Vec3 start;        // relative displacement then
    bool pressing;     // at the last derivatives()
  };
  double most_friction(const Row& row) const { return options_.friction * row.stiffness * row.depth; }

  SelfContactPenaltyOptions options_;
  bool begun_ = false;  // rows' starts are where nodes were at begin()
  std::vector<Row> rows_;
  std::vector<SurfaceWeights::Entry> entries_;
};

}  // namespace geo
