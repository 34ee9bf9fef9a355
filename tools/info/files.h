// A report for each kind of file. Each returns what `check` finds wrong first, empty when all is
// well.
#pragma once

#include <kerf/body.h>
#include <kerf/body_file.h>
#include <kerf/crack.h>
#include <kerf/surface_file.h>
#include "info/report.h"

namespace info {

struct Wishes {
  bool check = false, histograms = false;
};

std::string report_surface(const geo::SurfaceFile& file, const Wishes& wishes, Report& report);
/// `file`, of that many `bytes`: where the body is from; a run's checkpoint has more to tell.
std::string report_body(const geo::KerfFile& file, const geo::Body& body, std::size_t bytes, const Wishes& wishes,
                        Report& report);
std::string report_nodes(const geo::NodeSet& nodes, const Wishes& wishes, Report& report);
/// Reading has found all that can be wrong with fronts.
void report_fronts(const std::vector<geo::Front>& fronts, const Wishes& wishes, Report& report);
/// A scene; `check` reads and checks its models too.
std::string report_scene(const std::string& path, const Wishes& wishes, Report& report);
/// The folder of a run, or one of numbered surfaces; `check` looks at every frame and the
/// checkpoint.
std::string report_run(const std::string& folder, const Wishes& wishes, Report& report);

}  // namespace info
