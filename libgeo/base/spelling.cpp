#include "kerf/error.h"

#include <algorithm>

namespace geo {
namespace {

// Letters put in, left out, changed, or exchanged with their neighbour (optimal string alignment).
std::size_t letters_between(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before, last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before = last, last = row;
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) row[j] = std::min(row[j], before[j - 2] + 1);
    }
  }
  return row[b.size()];
}

}  // namespace

std::string did_you_mean(std::string_view written, const std::vector<std::string>& known) {
  const std::string* best = nullptr;
  std::size_t least = std::string::npos;
  if (written.empty() || written.size() > 100) return {};
  for (const auto& word : known) {
    const std::size_t letters = word.starts_with(written) ? 1 : letters_between(written, word);
    if (letters < least && 3 * letters <= std::max<std::size_t>(3, word.size())) least = letters, best = &word;
  }
  return best ? "; did you mean '" + *best + "'?" : std::string();
}

}  // namespace geo
