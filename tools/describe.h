// What a tool says of itself to others than its user: completion scripts for shells, and the frame of its manual page.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace tool {

/// A completion script for "bash" or "zsh", or the tool's manual page ("man", roff; the line @DESCRIPTION@ stands where
/// the description belongs). Throws UsageError for another word.
std::string describe(const CLI::App& app, const std::string& what);

}  // namespace tool
