// Makes what is missing of a data set, in a folder that may be shared by many processes.
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <kerf/progress.h>
#include "dataset/plan.h"

namespace dataset {

/// Counts of fractures, for one call.
struct Totals {
  std::size_t made = 0, failed = 0;
  std::size_t found = 0;  ///< in shards that were there before
  std::size_t refused_models = 0;
  std::size_t bytes = 0;  ///< written, records included
  double seconds = 0, cpu_seconds = 0;
  std::vector<std::string> notes;  ///< what repair decided about shells, sets that are empty
  bool complete = false;           ///< no shard of the whole data set is missing
};

/// Makes the shards in the range `part` of the plan's rows that have no record yet. A shard's data
/// is renamed into place, then its record: after an interruption at any moment, the next call makes
/// the shards that are missing, to the same bytes. The call that finds all shards of the plan
/// complete writes the lists of sets, failures and figures. Throws InputError where the folder
/// holds another data set, MissingInputError for a model's file that is not there, OutputError,
/// Interrupted.
Totals run(const std::string& folder, const std::vector<ModelFile>& models, const Settings& settings,
           std::pair<std::size_t, std::size_t> part, const geo::Progress& progress);

}  // namespace dataset
