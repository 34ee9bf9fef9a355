// The state of a run after a frame, for the network thread. It is never changed afterwards.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <kerf/vec.h>
#include "live/topology.h"

namespace live {

using ClientId = std::uint64_t;  ///< of a page; never used again

struct Snapshot {
  std::uint64_t number = 0;  ///< grows from snapshot to snapshot
  double time = 0;           ///< of the simulation, s
  std::shared_ptr<const Topology> topology;
  std::vector<geo::Vec3> positions;  ///< per vertex slot
  std::vector<geo::Vec3> nodes;      ///< empty unless a page wants them
  std::vector<double> stress;        ///< per node, Pa; empty unless a page wants it
  std::vector<double> skin_stress;   ///< per vertex slot, likewise
  std::size_t node_count = 0;
  std::string statistics;                    ///< JSON, without the last brace
  std::map<ClientId, std::uint64_t> taken;   ///< per page: number of the last input
  std::shared_ptr<const std::string> scene;  ///< JSON of STATE
  std::shared_ptr<const std::string> look;   ///< content of LOOK; null where the model has no colours
  /// Edges of the graph; null unless a page has asked.
  std::shared_ptr<const std::vector<std::pair<std::uint32_t, std::uint32_t>>> graph;
  std::uint64_t graph_number = 0;  ///< of the graph, grows
};

}  // namespace live
