// Fronts: whole ones over time, as files give them, and the state of one that cuts a complex.
#pragma once

#include <memory>
#include <vector>

#include "complex.h"

namespace kerf_python {

/// A front of a complex, between two steps.
struct LiveFront {
  std::shared_ptr<Complex> complex;
  std::shared_ptr<FrontRecord> record;
};

/// One step of a front; `next` is resampled to as many points as it has. Throws as geo::advance(),
/// and BusyError.
std::shared_ptr<Delta> step_front(const LiveFront& front, std::vector<geo::Vec3> next);

/// The fronts of an argument: a geo::Front, an array (steps, points, 3), a list of lines, or a list
/// of fronts. Throws geo::InputError, with the name.
std::vector<geo::Front> fronts_from(py::handle object, const std::string& name);

}  // namespace kerf_python
