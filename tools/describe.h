// Completion scripts for shells, and the frame of a manual page, made from a tool's options.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace tool {

/// A completion script for `what` = "bash" or "zsh"; for "man" the manual page in roff. There, a
/// line @DESCRIPTION@ stands for the description. Throws UsageError for any other word.
std::string describe(const CLI::App& app, const std::string& what);

}  // namespace tool
