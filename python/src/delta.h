// The class CrackDelta: what an edit of a crack complex changed.
#pragma once

#include <memory>

#include "arrays.h"
#include "kerf/complex.h"

namespace kerf_python {

/// The changes of one call, which never change themselves, with its counts and seconds.
struct Delta {
  const geo::CrackDelta delta;
  py::dict stats;  ///< by name; empty where the call has none
};

/// The ids of an argument, each below `count`. Throws geo::InputError.
template <class Id>
std::vector<Id> ids_from(py::handle object, const std::string& name, std::size_t count) {
  std::vector<Id> out;
  for (const auto value : integers_from(object, name, 0, static_cast<std::int64_t>(count) - 1))
    out.push_back(Id(static_cast<std::uint32_t>(value)));
  return out;
}

}  // namespace kerf_python
