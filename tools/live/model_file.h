// A model as a page opens it, with the files that it names.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace live {

/// A file that a model names: a library of materials, an image.
struct BesideFile {
  std::string name, bytes;
};

struct ModelFile {
  std::string name = {}, bytes = {};
  std::optional<std::vector<BesideFile>> beside = {};  ///< that came with it; nothing: they are in its folder
  double tension = 1;                                  ///< stretch of its skin
  char up = 0;                                         ///< vertical axis, 'y' or 'z'; 0: it is not known
  bool from_gallery = false;                           ///< by its name, a page knows what it is made of
};

}  // namespace live
