// Common to all tools: command line (by CLI11, which stays hidden), options, exit codes, progress,
// and one place that catches exceptions.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <kerf/files.h>
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

/// The command line of a tool: bind options to variables, then call run().
class Tool {
 public:
  /// `examples`: lines shown at the end of --help.
  Tool(std::string name, std::string summary, std::string examples);
  ~Tool();
  Tool(const Tool&) = delete;
  Tool& operator=(const Tool&) = delete;

  void argument(const std::string& name, std::string& value, const std::string& help, bool required = true);
  /// One that may be left out; an empty text is a value.
  void argument(const std::string& name, std::optional<std::string>& value, const std::string& help);
  void argument(const std::string& name, std::vector<std::string>& values, const std::string& help);
  void option(const std::string& names, std::string& value, const std::string& help);
  void option(const std::string& names, std::vector<std::string>& values, const std::string& help);
  void option(const std::string& names, double& value, const std::string& help);
  void option(const std::string& names, int& value, const std::string& help);
  /// An option that takes one of `choices`; `value` holds the default.
  void choice(const std::string& names, std::string& value, const std::vector<std::string>& choices,
              const std::string& help);
  void flag(const std::string& names, bool& value, const std::string& help);
  /// --unit: the unit of length of the model's coordinates; `metres` becomes that of one unit, and
  /// stays 0 where the option is not given.
  void unit_option(double& metres, const std::string& help);
  /// For the name of a file or folder to be written. An empty one, as of a shell variable that is
  /// not set, is refused.
  void output_option(const std::string& names, std::string& path, const std::string& help);
  /// -o/--output. Without it, output goes to standard output, binary output only where that is no
  /// terminal. With `endings`, such as ".ply", names with the ending of another format are refused.
  void output(const std::string& help, std::vector<std::string> endings = {});

  /// Whether the command line, or the file of --config, has an option; for the work of run().
  bool given(const std::string& option) const;
  /// Throws UsageError where an option is given that changes nothing without its companion.
  void require(const std::string& option, const std::string& companion) const;

  /// Parses the command line, sets threads and signal handlers, calls `work`, and returns the exit
  /// code for its outcome. For `--describe bash|zsh|man`, prints describe() instead.
  int run(int argc, char** argv, const std::function<void()>& work);

  bool quiet = false, verbose = false, json = false;
  /// Seconds that the work has to stop by itself after a first Ctrl-C (see progress()), before the
  /// program ends.
  double patience = 0.3;
  std::uint64_t seed = 1;
  std::string output_path;

  /// The output path, or "-". Throws before any work is done: UsageError for binary output to a
  /// terminal, OutputError where the file cannot be written.
  std::string target(bool binary) const;
  /// Throws UsageError for an output with the ending of another format, see output().
  void require_ending() const;
  /// A progress bar on standard error, if that is a terminal or as --progress says. Its result
  /// stops the work after Ctrl-C.
  geo::Progress progress() const;
  /// Whether the work is to go on: there was no Ctrl-C.
  static bool goes_on();
  /// The program's name.
  const std::string& name() const { return name_; }
  /// Prints a line to standard error unless -q is given.
  void say(const std::string& line) const;

 private:
  struct Parser;
  std::unique_ptr<Parser> parser_;
  std::string name_, progress_ = "auto";
  std::vector<std::string> endings_;
  int threads_ = 0;
};

/// Prints what a reader left out or assumed, a line for each note, as Tool::say() of the program's
/// tool.
void say_notes(const geo::SurfaceFile& file, const std::string& path);
/// Reads a surface as geo::parse_surface(), and prints its notes.
geo::SurfaceFile parse_surface(const std::string& bytes, const std::string& path);
/// Reads a surface as geo::read_surface(), and prints its notes.
geo::SurfaceFile read_surface(const std::string& path);

/// "name xxh3:…" of an input, for the history of a file. The name is without its folder, so moving
/// files does not change the bytes.
std::string named_hash(const std::string& path, std::uint64_t fingerprint);
/// Shortest text of a number that is read back exactly.
std::string number(double x);
/// A number for people, rounded to four digits; for a point three, separated by commas.
std::string rounded(double x);
std::string rounded(const geo::Vec3& p);
/// The vector that an option gives as X,Y,Z. Throws UsageError.
geo::Vec3 parse_vector(const std::string& option, const std::string& text);
/// "1 piece", "3 pieces".
std::string counted(std::size_t n, const std::string& noun);
/// Text as a JSON string, quotes included.
std::string quoted(const std::string& text);

}  // namespace tool
