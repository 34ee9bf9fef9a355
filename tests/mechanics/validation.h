// Mechanics against what is known of it: each case measures, and says what it should have found.
#pragma once

#include <string>
#include <vector>

namespace validation {

struct Finding {
  std::string what, formula;
  double measured = 0, expected = 0;
  double bound = 0;       ///< of the error
  bool absolute = false;  ///< the error is |measured − expected|, else relative to the expected
  double error() const;
  bool good() const { return error() <= bound; }
};

/// Sizes: 0 those of tests, 1 those of the table in docs/validation.md.
std::vector<Finding> rigid_motion(int size);
std::vector<Finding> patch(int size);
std::vector<Finding> tension(int size);
std::vector<Finding> cantilever(int size);
std::vector<Finding> frequency(int size);
std::vector<Finding> free_fall(int size);
std::vector<Finding> spin(int size);
std::vector<Finding> slit_bar(int size);
std::vector<Finding> notched_bar(int size);
std::vector<Finding> hertz(int size);
std::vector<Finding> brazilian_disk(int size);
std::vector<Finding> energy_at_cuts(int size);
std::vector<Finding> standing(int size);
std::vector<Finding> sliding(int size);
std::vector<Finding> stacking(int size);

}  // namespace validation
