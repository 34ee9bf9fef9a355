// The class Complex: a cracked model, which changes, with the fronts that cut it and the model that
// it was made of.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "busy.h"
#include "delta.h"
#include "kerf/complex.h"
#include "kerf/crack.h"
#include "kerf/pieces.h"
#include "mesh.h"

namespace kerf_python {

/// A front that cuts a complex, with the options and the work of its steps.
struct FrontRecord {
  geo::FrontState state;
  geo::CrackOptions options;
  geo::CrackStats work;
};

/// A cracked model. Calls read or change it under `busy`, with the GIL or without.
class Complex {
 public:
  /// Takes the complex over. `original`: the surface that it was made of, or null.
  Complex(geo::Complex made, std::shared_ptr<Mesh> original);
  /// A copy with its own fronts. To be made under a Reading of `other`.
  Complex(const Complex& other);
  Complex& operator=(const Complex&) = delete;

  /// Runs `work`, which changes the complex, without the GIL and calls nothing of Python. `fronts`:
  /// those that it may change. `undoable`: it makes one edit at most. Throws BusyError, and what
  /// `work` throws.
  template <class Work>
  std::shared_ptr<Delta> edit(std::vector<std::shared_ptr<FrontRecord>> fronts, bool undoable, const Work& work) {
    const Writing writing(busy);
    return edit_held(std::move(fronts), undoable, [&] { return without_gil(work); });
  }
  /// As edit(), where the caller holds a Writing; `work` runs with the GIL.
  template <class Work>
  std::shared_ptr<Delta> edit_held(std::vector<std::shared_ptr<FrontRecord>> fronts, bool undoable, const Work& work) {
    Undo before{{}, undoable, false};
    for (const auto& front : fronts) before.fronts.emplace_back(front, *front);
    found_.reset();
    if (!undoable) undo_ = {};
    auto delta = std::make_shared<Delta>(Delta{work(), py::dict()});
    before.changed = !delta->delta.empty();
    undo_ = std::move(before);
    return delta;
  }
  /// Reverts the last call. Throws geo::GeometryError where that is impossible.
  void undo();

  /// The pieces; kept until the complex changes. To be called with the GIL, under a Reading.
  std::shared_ptr<const geo::Pieces> found();
  /// The surface with the attributes of the model. To be called without the GIL, under a Reading.
  geo::TriangleMesh surface() const;
  /// A number for a new crack: above those of all cracks and fronts.
  std::int32_t next_crack() const;
  /// The states of all fronts.
  std::vector<geo::FrontState*> states() const;

  geo::Complex complex;                              ///< the complex itself
  const std::shared_ptr<Mesh> model;                 ///< the surface that it was made of; may be null
  std::vector<std::shared_ptr<FrontRecord>> fronts;  ///< fronts that cut it
  Busy busy;                                         ///< the calls that use it

 private:
  struct Undo {
    std::vector<std::pair<std::shared_ptr<FrontRecord>, FrontRecord>> fronts;
    bool possible = false, changed = false;
  };
  Undo undo_;
  std::shared_ptr<const geo::Pieces> found_;
};

/// The complex, without cracks, of a mesh that is a valid model. Throws as model_of().
std::shared_ptr<Complex> uncut_complex(const std::shared_ptr<Mesh>& mesh);

/// The complex of a model that a call reads: of a Complex, a Solid, or a mesh that is a valid
/// solid.
class ModelReading {
 public:
  /// Throws BusyError, and geo::InputError, with the argument's name, for another object.
  ModelReading(py::handle object, const std::string& name);
  /// The complex; valid while this object lives.
  const geo::Complex& complex() const { return cut_ ? cut_->complex : *uncut_; }
  /// The complex of a model without cracks, which never changes; null where a Complex was given.
  const std::shared_ptr<const geo::Complex>& uncut() const { return uncut_; }

 private:
  std::shared_ptr<Complex> cut_;
  std::unique_ptr<Reading> reading_;
  std::shared_ptr<const geo::Complex> uncut_;
};

/// A surface as a complex with its model: of a two-sided surface, or a plain skin. Throws
/// geo::InputError.
std::shared_ptr<Complex> complex_of(std::shared_ptr<Mesh> surface);

}  // namespace kerf_python
