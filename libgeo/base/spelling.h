// What somebody may have meant.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace geo {

/// "; did you mean 'WORD'?" with the first of `known` that is the fewest letters (put in, left out, changed, or exchanged with the next)
/// from `written`, or that begins with it; empty where more than a third of the letters differ.
std::string did_you_mean(std::string_view written, const std::vector<std::string>& known);

}  // namespace geo
