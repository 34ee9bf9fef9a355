// Bodies of the module: they change, and hand out snapshots of their parts.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "busy.h"
#include "graph.h"
#include "kerf/body.h"
#include "kerf/complex.h"

namespace kerf_python {

/// A body and the snapshots that were taken since its last change. Every use holds `busy`.
class Body : public std::enable_shared_from_this<Body> {
 public:
  /// Takes the body over. `m`: the surface that was cut, whose attributes the derived surface gets;
  /// null if unknown.
  explicit Body(geo::Body b, std::shared_ptr<Mesh> m = nullptr);

  /// Drops the snapshots; to be called by every change.
  void changed();
  /// A crack number that neither the complex nor a front uses.
  std::int32_t unused_crack();

  geo::Body body;
  std::shared_ptr<Mesh> model;
  Busy busy;
  std::uint64_t id;           ///< differs for all bodies
  std::uint64_t version = 0;  ///< number of changes

  py::object nodes, graph, binding, surface;  ///< snapshots; null until made

 private:
  std::int32_t last_crack_ = 0;
};

/// The changes of one step, with what is needed to tell whether they fit a solid.
struct BodyDelta {
  geo::BodyDelta delta;
  geo::SplitStats stats;
  std::uint64_t body = 0, version = 0;  ///< the body after the step
};

/// A front that cuts a body.
struct BodyFront {
  std::shared_ptr<Body> body;
  geo::FrontState state;
};

/// A surface with its cracks, and the model that it was made of.
struct Subject {
  geo::Complex complex;
  std::shared_ptr<Mesh> model;
};

/// A copy of a Complex, or the complex of a Solid or a two-sided mesh. Throws geo::InputError.
Subject subject_from(py::handle object, const std::string& name);

/// Adds the parts of the class Body that change it.
void add_changes(py::class_<Body, std::shared_ptr<Body>>& body);
/// Adds what reads and writes files.
void add_files(py::class_<Body, std::shared_ptr<Body>>& body);

}  // namespace kerf_python
