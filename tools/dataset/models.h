// The models of a data set: their names and files, from the command line and from lists.
#pragma once

#include <string>
#include <vector>

namespace dataset {

struct ModelFile {
  std::string name;  ///< names files of the data set; '/' makes folders
  std::string path;
};

/// The models that arguments name: a model's file, whose name is the file's without ending; or a
/// list, a text file (.txt) with a path on each line, after a name and a tab where it is not to
/// have the file's. Paths of a list are relative to its folder; # begins a comment. Throws
/// MissingInputError for a file that is not there, InputError for two models of one name, and for
/// names that cannot be those of files.
std::vector<ModelFile> list_models(const std::vector<std::string>& arguments);

}  // namespace dataset
