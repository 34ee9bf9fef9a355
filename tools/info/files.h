// A report for each kind of file. Each function returns the first fault that `check` finds, or an
// empty text.
#pragma once

#include <kerf/body.h>
#include <kerf/body_file.h>
#include <kerf/crack.h>
#include <kerf/files.h>
#include "info/report.h"

namespace info {

struct ReportOptions {
  bool check = false, histograms = false;
};

std::string report_surface(const geo::SurfaceFile& file, const ReportOptions& options, Report& report);
/// A body from `file`, whose size is `bytes`; with the state of the run where it is a checkpoint.
std::string report_body(const geo::KerfFile& file, const geo::Body& body, std::size_t bytes,
                        const ReportOptions& options, Report& report);
std::string report_nodes(const geo::NodeSet& nodes, const ReportOptions& options, Report& report);
/// Fronts, which reading has checked completely.
void report_fronts(const std::vector<geo::Front>& fronts, const ReportOptions& options, Report& report);
/// A scene; `check` also reads and checks its models.
std::string report_scene(const std::string& path, const ReportOptions& options, Report& report);
/// The folder of a run, or of numbered surfaces; `check` checks every frame and the checkpoint.
std::string report_run(const std::string& folder, const ReportOptions& options, Report& report);

}  // namespace info
