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

/// Grows cracks in the complex by one edit, or by several in a Complex::EditGroup, and returns what
/// has changed. Throws where it cannot; the complex is unchanged then. `stats`, where given, is
/// added to.
using CrackEdit = std::function<CrackDelta(Complex& complex, CrackStats* stats)>;

/// A crack step of a body. While it is open, the complex has the crack and no other part of the
/// body does. commit() updates the others. Where it has not, the destructor takes the crack back:
/// the complex is as before. It may be moved: what it moves to has the step. One transaction of a
/// body at a time; the body outlives it.
class CrackTransaction {
 public:
  /// Steps 1 to 3 of split(): calls `edit`, whose exceptions pass; the body is unchanged then. Also
  /// fills the body's cache where it is empty. `stats`, where given, is added to until the commit.
  CrackTransaction(Body& body, const CrackEdit& edit, SplitStats* stats);
  /// Finds what commit() needs of the surface, now: it costs as much as a veto, and may run beside
  /// other work that reads the body. Called by commit() where it was not before.
  void prepare();
  /// Steps 4 to 7 of split(). `veto`, where not empty, is called before; if it throws, the body is
  /// as before the transaction. Call once.
  BodyDelta commit(const StepVeto& veto = {});

 private:
  struct TakeBack {
    /// Reverts the last edit.
    void operator()(Complex* grown) const { grown->undo(); }
  };

  Body* body_;
  CrackDelta crack_;
  std::unique_ptr<Complex, TakeBack> open_;  // the body's, while it has a crack that is not committed
  std::optional<ClosestVertices> closest_;
  SplitStats* stats_;
};

/// The edit by which a front advances: advance() of kerf/crack.h. `front` becomes that after the
/// step, which is of use only where the step is committed. Refers to `front` and `next`.
CrackEdit advance_of(FrontState& front, std::span<const Vec3> next, const CrackOptions& options);

}  // namespace geo
