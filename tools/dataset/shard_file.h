// The files of a shard: an archive of arrays, or a folder of PLY files, and a record of fractures
// and failures.
#pragma once

#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "dataset/fracture.h"
#include "dataset/plan.h"

namespace dataset {

/// A fracture, or why there is none.
struct Outcome {
  std::uint64_t seed = 1;
  std::optional<Fracture> fracture;
  std::string why;
};

/// Writes the fractures of a shard as a NumPy archive (docs/datasets.md lists its arrays).
/// `single`: vertices in single precision, unless the model is too far from the origin for that.
void write_archive(std::ostream& out, const std::vector<Outcome>& outcomes, bool single);

/// Writes a model as the fractures are of, repaired where it was, as PLY. Its triangles are those
/// that sources of faces name.
void write_intact(std::ostream& out, const Model& model);

/// Writes the pieces of a fracture as piece_0.ply, piece_1.ply … into a folder that exists. The
/// property `patch` of faces is the label, `source` the source. Throws OutputError.
void write_folder(const std::string& folder, const Fracture& fracture);

/// Names in a record.
struct RecordOf {
  std::string model, set;
  std::string file;      ///< the intact model's in the data set, for commands
  std::string refused;   ///< why the model cannot be used, or empty
  bool details = false;  ///< also pieces and bonds
};

/// Writes the record of a shard as JSON: recipe, counts and command of each fracture, the reason of
/// each failure.
void write_record(std::ostream& out, const Shard& shard, const std::vector<Outcome>& outcomes, const RecordOf& of);

}  // namespace dataset
