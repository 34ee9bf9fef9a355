// Faults of a run: results that its scene does not ask for.
#pragma once

#include <string>
#include <vector>

#include <kerf/scene.h>

namespace sim {

/// The figures of a frame that tell whether the run is as asked for.
struct FrameFigures {
  int frame = 0;
  double time = 0;                              ///< s
  std::size_t crossings = 0;                    ///< pairs of triangles
  std::size_t refused = 0;                      ///< crack steps
  std::size_t crumbs = 0;                       ///< pieces
  double lag = 0;                               ///< model units
  double elastic = 0, kinetic = 0, weight = 0;  ///< energies at the frame's end, J
};

/// The figures in the lines of frames.jsonl. Throws geo::InputError where a line is malformed.
std::vector<FrameFigures> read_figures(const std::string& log);

/// Figures of the bodies that faults are measured by.
struct BodyFigures {
  double spacing = 0;       ///< mean, of the nodes, model units
  double least_energy = 0;  ///< J: what is below is noise of the solver
};

/// A sentence for each thing that is not as asked for: triangles that cross, crumbs at the end,
/// refused crack steps, a surface that lags more than a node spacing, and energy that rises without
/// load.
std::vector<std::string> faults_of(const geo::Scene& scene, const std::vector<FrameFigures>& frames,
                                   const BodyFigures& bodies);

}  // namespace sim
