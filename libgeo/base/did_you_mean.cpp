// Spelling suggestions for error messages (declared in kerf/error.h).
#include <algorithm>

#include "kerf/error.h"

namespace geo {
namespace {

// Optimal string alignment distance: the number of insertions, deletions, substitutions and
// transpositions of adjacent letters.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  // Three consecutive rows of the dynamic programme.
  std::vector<std::size_t> before_previous, previous(b.size() + 1), current(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) current[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before_previous = previous;
    previous = current;
    current[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      current[j] = std::min({previous[j] + 1, current[j - 1] + 1, previous[j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        current[j] = std::min(current[j], before_previous[j - 2] + 1);
    }
  }
  return current[b.size()];
}

}  // namespace

std::string did_you_mean(std::string_view written, const std::vector<std::string>& known) {
  constexpr std::size_t longest = 100;  // longer words are not misspelt names, and the cost is quadratic
  const std::string* best = nullptr;
  std::size_t least = std::string::npos;
  if (written.empty() || written.size() > longest) return {};
  for (const auto& word : known) {
    const std::size_t distance = word.starts_with(written) ? 1 : edit_distance(written, word);
    // At most a third of the letters may differ, one in short words. A prefix counts as distance 1.
    if (distance < least && 3 * distance <= std::max<std::size_t>(3, word.size())) {
      least = distance;
      best = &word;
    }
  }
  return best ? "; did you mean '" + *best + "'?" : std::string();
}

}  // namespace geo
