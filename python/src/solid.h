// The deforming solid of the module, and its motion.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "body.h"
#include "busy.h"
#include "kerf/solid.h"

namespace kerf_python {

/// The motion of a solid, and the arrays that were taken since its last change.
class State {
 public:
  /// Takes the motion over.
  explicit State(geo::State s) : state(std::move(s)) {}
  /// Drops the arrays; to be called by every change.
  void changed() { displacement = velocity = acceleration = plastic = prestretch = py::object(); }

  geo::State state;
  Busy busy;
  py::object displacement, velocity, acceleration, plastic, prestretch;  ///< null until made
};

/// A discretised solid, with what is needed to tell which steps of its body it has followed.
struct DeformingSolid {
  explicit DeformingSolid(geo::Solid s, std::uint64_t of = 0, std::uint64_t at = 0)
      : solid(std::move(s)), body(of), version(at) {}
  geo::Solid solid;
  Busy busy;
  std::uint64_t body, version;  ///< of the body; 0: made of nodes and graph alone
  bool points_due = false;      ///< update_points() must come before energy, forces, stress and steps
};

/// The motion of one state as an array of vectors per node, (n, 3); throws geo::InputError for
/// another number of rows.
std::vector<geo::Vec3> vectors_from(py::handle object, const std::string& name, std::size_t nodes);

/// Adds the parts of DeformingSolid that compute without changing it.
void add_fields(py::class_<DeformingSolid, std::shared_ptr<DeformingSolid>>& solid);
/// Adds what advances a state.
void add_steps(py::class_<DeformingSolid, std::shared_ptr<DeformingSolid>>& solid);

/// Throws geo::InputError unless the solid's points are up to date.
void require_points(const DeformingSolid& solid);
/// Throws geo::InputError unless the state has a row for each node of the solid, and the solid's
/// points are up to date.
void require_fit(const DeformingSolid& solid, const State& state);

}  // namespace kerf_python
