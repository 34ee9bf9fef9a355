// One step of a crack as a transaction: the whole body has it, or nothing of it.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>

#include "body/binding.h"
#include "kerf/body.h"

namespace geo {

/// Receives the complex as a step leaves it and the step's changes, before any other part of the
/// body is updated. Vetoes the step by throwing, as a rule GeometryError. Any thread may call it,
/// and others read the body meanwhile.
using StepVeto = std::function<void(const Complex& grown, const CrackDelta& crack)>;

/// A step of split() in kerf/body.h. While it is open, the complex has the crack and no other part
/// of the body does. commit() updates the others. Where it has not, the destructor takes the crack
/// back: the complex is as before. It may be moved: what it moves to has the step. One transaction
/// of a body at a time; the body outlives it.
class CrackTransaction {
 public:
  /// Steps 1 to 3 of split(): grows the crack in the complex, and fills the body's cache where it
  /// is empty. Throws as split() does; the body is unchanged then. `stats`, where given, is added
  /// to until the commit.
  CrackTransaction(Body& body, const FrontState& front, std::span<const Vec3> next, const CrackOptions& options,
                   SplitStats* stats);
  /// The same for an edit of another kind: grow(complex) makes it and returns its changes, or throws
  /// and leaves the complex as it was.
  CrackTransaction(Body& body, const std::function<CrackDelta(Complex&)>& grow, SplitStats* stats);
  /// Finds what commit() needs of the surface, now: it costs as much as a veto, and may run beside
  /// other work that reads the body. Called by commit() where it was not before.
  void prepare();
  /// Steps 4 to 7 of split(). `veto`, where not empty, is called before; if it throws, body and
  /// front are as before the transaction. `front` becomes that after the step. Call once.
  BodyDelta commit(FrontState& front, const StepVeto& veto = {});
  /// The same without a front.
  BodyDelta commit(const StepVeto& veto = {});

 private:
  struct TakeBack {
    /// Reverts the last edit.
    void operator()(Complex* grown) const { grown->undo(); }
  };

  Body* body_;
  FrontState front_;  // after the step
  CrackDelta crack_;
  std::unique_ptr<Complex, TakeBack> open_;  // the body's, while it has a crack that is not committed
  std::optional<ClosestVertices> closest_;
  SplitStats* stats_;
};

}  // namespace geo
