// Node sets of the module.
#pragma once

#include <memory>
#include <utility>

#include "kerf/nodes.h"
#include "mesh.h"

namespace kerf_python {

/// Nodes that never change after they were made.
struct NodeSet {
  /// Takes the nodes over.
  explicit NodeSet(geo::NodeSet n) : nodes(std::make_shared<const geo::NodeSet>(std::move(n))) {}
  /// Shares the nodes.
  explicit NodeSet(std::shared_ptr<const geo::NodeSet> n) : nodes(std::move(n)) {}
  std::shared_ptr<const geo::NodeSet> nodes;  ///< never empty
};

/// The options of a sampling as Python gives them.
struct SampleArguments {
  py::object spacing, count;  ///< None where they are not given
  int levels = 2;
  double jitter = 0.15, support = 1.8;
  std::uint64_t seed = 1;
  std::string pattern = "jitter";
  int across = 0;
};

/// The options of a sampling of a model with this diagonal. Throws geo::InputError.
geo::SampleOptions sample_options(const SampleArguments& arguments, double diagonal);

/// The mesh of an argument that is a valid model: a Solid, a Complex, or another mesh, which is
/// checked. Throws geo::InputError.
std::shared_ptr<const Mesh> solid_argument(py::handle object, const std::string& name);

}  // namespace kerf_python
