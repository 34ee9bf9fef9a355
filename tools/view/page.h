// The interactive page: one HTML file with everything in it (page/), three.js included.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include <kerf/progress.h>
#include "view/subject.h"

namespace view {

struct PageOptions {
  double megabytes = 20;              ///< upper bound of the size; larger content is made coarser
  const geo::Body* before = nullptr;  ///< an earlier state of the body, for the edges that were cut; see cut_edges()
  double frame_rate = 24;
  bool y_up = false;            ///< the model's y axis is vertical, not z
  std::string color = "model";  ///< what is coloured at first; without "model", materials are left out
};

/// A page for one subject, or for a run with what its checkpoint holds.
struct Page {
  std::string html;
  std::vector<std::string> notices;  ///< one line for each reduction of the content; also shown on the page
};
Page page_of(const Subject& subject, const PageOptions& options = {}, const geo::Progress& progress = {});
Page page_of(const Run& run, const PageOptions& options = {}, const geo::Progress& progress = {});

}  // namespace view
