// What all tools share: the command line (CLI11, hidden), the common options, exit codes, progress, one catch.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <kerf/progress.h>
#include <kerf/vec.h>

namespace tool {

/// Wrong use of the command line: exit code 2.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// A check found something, or the processing failed: exit code 1.
struct Failure : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// One tool's command line. Bind options to variables, then `run`.
class Tool {
 public:
  /// `examples`: lines shown at the end of --help.
  Tool(std::string name, std::string summary, std::string examples);
  ~Tool();
  Tool(const Tool&) = delete;
  Tool& operator=(const Tool&) = delete;

  void argument(const std::string& name, std::string& value, const std::string& help, bool required = true);
  void argument(const std::string& name, std::vector<std::string>& values, const std::string& help);
  void option(const std::string& names, std::string& value, const std::string& help);
  void option(const std::string& names, std::vector<std::string>& values, const std::string& help);
  void option(const std::string& names, double& value, const std::string& help);
  void option(const std::string& names, int& value, const std::string& help);
  /// An option that takes one of `choices`; `value` holds the default.
  void choice(const std::string& names, std::string& value, const std::vector<std::string>& choices,
              const std::string& help);
  void flag(const std::string& names, bool& value, const std::string& help);
  /// -o/--output; where it is not given, standard output if that is no terminal (`binary`) or in any case (text). A
  /// name that ends as another format's files do is refused where `endings`, like ".ply", are given.
  void output(const std::string& help, std::vector<std::string> endings = {});

  /// Parses (or, for `--describe bash|zsh|man`, prints what describe() makes of the tool), sets threads and signals,
  /// calls `work`, turns every outcome into the contract's exit code.
  int run(int argc, char** argv, const std::function<void()>& work);

  bool quiet = false, verbose = false, json = false;
  /// How long, in seconds, a first Ctrl-C waits for the work to stop by itself (see progress()) before the program
  /// ends.
  double patience = 0.3;
  std::uint64_t seed = 1;
  std::string output_path;

  /// Where the output goes: the path, or "-". Refuses binary to a terminal (exit 2), and, before any work is done, a
  /// place where no file can be made (exit 73).
  std::string target(bool binary) const;
  /// Refuses an output that ends as another format's files do (exit 2), see output().
  void require_ending() const;
  /// A bar on standard error when that is a terminal (or as --progress says); also what Ctrl-C stops.
  geo::Progress progress() const;
  /// A line on standard error unless -q.
  void say(const std::string& line) const;

 private:
  struct Parser;
  std::unique_ptr<Parser> parser_;
  std::string name_, progress_ = "auto";
  std::vector<std::string> endings_;
  int threads_ = 0;
};

/// "name xxh3:…" of an input, for a file's provenance: the name without its folder, so that moving files changes
/// nothing.
std::string named_hash(const std::string& path, std::uint64_t fingerprint);
/// A number in the shortest form that reads back the same.
std::string number(double x);
/// A number for people, rounded to four digits; a point's three with commas between.
std::string rounded(double x);
std::string rounded(const geo::Vec3& p);
/// "1 piece", "3 pieces".
std::string counted(std::size_t n, const std::string& noun);
/// Text as a JSON string, quotes included.
std::string quoted(const std::string& text);

}  // namespace tool
