// The files of a data set beside its shards: what it is, its sets, what failed.
#pragma once

#include <string>
#include <vector>

#include "dataset/plan.h"

namespace dataset {

/// Makes the folder and its dataset.json, or compares with the one that is there. Throws InputError
/// where it holds another data set or other files, OutputError where it cannot be made.
void begin_folder(const std::string& folder, const std::vector<ModelFile>& models, const Settings& settings);

/// False where a shard's record is missing. Else writes the lists of shards or models for each set,
/// failed.txt and summary.json from the records, removes what interrupted runs left, and returns
/// true. Shards and models without a fracture are in no list; `notes` gets a line for each set that
/// is empty. Throws InputError for a record that is damaged.
bool finish_folder(const std::string& folder, const std::vector<ModelFile>& models, const Settings& settings,
                   const std::vector<Shard>& shards, std::vector<std::string>& notes);

}  // namespace dataset
