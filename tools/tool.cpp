// CLI11 parses. A thread waits for signals and sets a flag that progress callbacks read; exceptions
// become messages and exit codes in one place.
#include "tool.h"

#include <signal.h>
#include <unistd.h>

#include <poll.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <new>
#include <set>
#include <thread>

#include <kerf/error.h>
#include <kerf/files.h>
#include <kerf/parallel.h>
#include "describe.h"
#include "version.h"

namespace tool {
namespace {

std::atomic<bool> interrupted{false}, bar_shown{false};
std::atomic<const Tool*> running{nullptr};  // the program's tool, which prints notes
constexpr int closed_pipe = 141;            // as shells report programs that SIGPIPE ends

// Removes the bar, so that the next text begins a line.
void clear_bar() {
  if (bar_shown.exchange(false)) std::fputs("\r\033[K", stderr);
}

// Waits for one of the signals, `seconds` at most. Programs that are stopped and continued, or
// traced, go on waiting: the system ends their wait with EINTR.
void wait_for(const sigset_t& signals, double seconds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(std::min(seconds, 1e9));
  for (bool again = true; again;) {
    const std::chrono::duration<double> left = std::max(end - std::chrono::steady_clock::now(), {});
    timespec wait{};
    wait.tv_sec = static_cast<time_t>(left.count());
    wait.tv_nsec = static_cast<long>((left.count() - double(wait.tv_sec)) * 1e9);
    again = sigtimedwait(&signals, nullptr, &wait) < 0 && errno == EINTR;
  }
}

bool is_ignored(int signal) {
  struct sigaction action {};
  return ::sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

// Starts a thread that waits for Ctrl-C or for the end of the terminal. It requests the work to
// stop; where that takes longer than `patience`, or a second Ctrl-C comes, it removes incomplete
// outputs and ends the program.
void watch_signals(const std::string& name, double patience) {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  if (!is_ignored(SIGHUP)) sigaddset(&signals, SIGHUP);  // nohup has it ignored
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);         // before any other thread starts: all inherit it
  std::thread([signals, name, patience] {
    int signal = 0;
    sigwait(&signals, &signal);
    interrupted = true;
    wait_for(signals, patience);
    geo::discard_temporary_outputs();
    clear_bar();
    const std::string line = name + ": interrupted\n";
    [[maybe_unused]] const auto written = ::write(2, line.data(), line.size());
    ::_exit(130);
  }).detach();
}

// False where standard output failed, as on a full disk.
bool flush_output() { return std::cout.flush().good() && std::fflush(stdout) == 0; }

// True where standard output is a pipe whose reader has ended, as `head` does.
bool reader_gone() {
  pollfd out{1, POLLOUT, 0};
  return ::poll(&out, 1, 0) == 1 && (out.revents & POLLERR) != 0;
}

// Endings with a well-known format: no tool writes another format under such a name.
const std::set<std::string> formats = {".3mf", ".abc",  ".avi",  ".bmp",  ".csv",  ".dae",  ".exr",  ".fbx",  ".front",
                                       ".gif", ".glb",  ".gltf", ".html", ".jpeg", ".jpg",  ".json", ".kerf", ".mov",
                                       ".mp4", ".obj",  ".off",  ".pcd",  ".pdf",  ".ply",  ".png",  ".stl",  ".svg",
                                       ".tif", ".tiff", ".toml", ".usd",  ".usda", ".usdc", ".usdz", ".vdb",  ".vtk",
                                       ".vtp", ".vtu",  ".webm", ".webp", ".xyz",  ".zip"};

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

// The words of the command line. After "--" all are files, whatever they begin with. Throws
// UsageError for unknown long options.
std::vector<std::string> words_of(int argc, char** argv, const CLI::App& app) {
  std::vector<std::string> words(argv + 1, argv + argc), known;
  for (const CLI::Option* option : app.get_options())
    for (const auto& name : option->get_lnames()) known.push_back("--" + name);
  const auto end = std::find(words.begin(), words.end(), "--");
  for (auto word = words.begin(); word != end; ++word) {
    const std::string name = word->substr(0, word->find('='));
    if (name.starts_with("--") && std::find(known.begin(), known.end(), name) == known.end())
      throw UsageError("there is no option " + name + geo::did_you_mean(name, known));
  }
  for (auto word = end == words.end() ? end : end + 1; word != words.end(); ++word)
    if (word->size() > 1 && word->front() == '-') word->insert(0, "./");
  return words;
}

// The words with the tool's file moved to the front, where it follows the values of an option that
// takes several ("--front halve.front bear.off"). Empty where there are several such options.
std::vector<std::string> file_first(const std::vector<std::string>& words, const CLI::App& app) {
  std::vector<std::size_t> last;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const CLI::Option* option = words[i].starts_with("-") ? app.get_option_no_throw(words[i]) : nullptr;
    if (!option || option->get_items_expected_max() < CLI::detail::expected_max_vector_size) continue;
    std::size_t end = i + 1;
    while (end < words.size() && (words[end] == "-" || !words[end].starts_with("-"))) ++end;
    if (end > i + 2) last.push_back(end - 1);
  }
  if (last.size() != 1) return {};
  std::vector<std::string> other = words;
  std::rotate(other.begin(), other.begin() + static_cast<std::ptrdiff_t>(last[0]),
              other.begin() + static_cast<std::ptrdiff_t>(last[0]) + 1);
  return other;
}

void parse(CLI::App& app, std::vector<std::string> words) {
  std::reverse(words.begin(), words.end());  // the order that CLI11 expects
  app.parse(std::move(words));
}

}  // namespace

struct Tool::Parser {
  CLI::App app;
};

Tool::Tool(std::string name, std::string summary, std::string examples)
    : parser_(std::make_unique<Parser>()), name_(std::move(name)) {
  CLI::App& app = parser_->app;
  app.name(name_);
  app.description(std::move(summary));
  app.footer("Examples:\n" + examples +
             "\n\nExit codes: 0 done, 1 a check found something or the processing failed, 2 usage, 65 bad input,\n66 "
             "input missing, 70 internal error, 73 output cannot be made, 130 interrupted, 141 closed pipe.");
  app.set_version_flag("--version", name_ + " (kerf) " KERF_VERSION);
  app.set_config("--config", "", "Read options from this TOML or INI file");
  app.allow_config_extras(false);
  app.add_option("-j,--threads", threads_, "Threads; 0: all cores")->check(CLI::Range(0, 4096));
  app.add_option("--seed", seed, "Seed of everything random");
  app.add_flag("-q,--quiet", quiet, "No words on standard error but errors");
  app.add_flag("-v,--verbose", verbose, "More words on standard error");
  app.add_flag("--json", json, "Figures as JSON");
  app.add_option("--progress", progress_, "Progress bar: auto, always, never")
      ->check(CLI::IsMember({"auto", "always", "never"}));
}
Tool::~Tool() = default;

void Tool::argument(const std::string& name, std::string& value, const std::string& help, bool required) {
  auto* option = parser_->app.add_option(name, value, help);
  if (required) option->required();
}
void Tool::argument(const std::string& name, std::optional<std::string>& value, const std::string& help) {
  parser_->app.add_option_function<std::string>(
      name, [&value](const std::string& text) { value = text; }, help);
}
void Tool::argument(const std::string& name, std::vector<std::string>& values, const std::string& help) {
  parser_->app.add_option(name, values, help);
}
void Tool::option(const std::string& names, std::string& value, const std::string& help) {
  parser_->app.add_option(names, value, help);
}
void Tool::option(const std::string& names, std::vector<std::string>& values, const std::string& help) {
  parser_->app.add_option(names, values, help);
}
void Tool::option(const std::string& names, double& value, const std::string& help) {
  parser_->app.add_option(names, value, help)->capture_default_str()->check([](const std::string& text) {
    double x = 0;
    return CLI::detail::lexical_cast(text, x) && std::isfinite(x) ? std::string()
                                                                  : "'" + text + "' is not a finite number";
  });
}
void Tool::option(const std::string& names, int& value, const std::string& help) {
  parser_->app.add_option(names, value, help)->capture_default_str();
}
void Tool::choice(const std::string& names, std::string& value, const std::vector<std::string>& choices,
                  const std::string& help) {
  parser_->app.add_option(names, value, help)->capture_default_str()->check(CLI::IsMember(choices));
}
void Tool::flag(const std::string& names, bool& value, const std::string& help) {
  parser_->app.add_flag(names, value, help);
}
void Tool::output_option(const std::string& names, std::string& path, const std::string& help) {
  parser_->app.add_option(names, path, help)->check([](const std::string& text) {
    return std::string(text.empty() ? "the name is empty; give one, or leave the option out" : "");
  });
}
void Tool::output(const std::string& help, std::vector<std::string> endings) {
  output_option("-o,--output", output_path, help);
  endings_ = std::move(endings);
}

void Tool::unit_option(double& metres, const std::string& help) {
  parser_->app
      .add_option_function<std::string>(
          "--unit", [&metres](const std::string& name) { metres = geo::length_unit(name).value_or(0); }, help)
      ->check([](const std::string& name) {
        return geo::length_unit(name) ? std::string()
                                      : "'" + name + "' is no unit of length; give one of " + geo::length_unit_names();
      });
}

bool Tool::given(const std::string& option) const { return parser_->app.count(option) > 0; }

void Tool::require(const std::string& option, const std::string& companion) const {
  if (given(option) && !given(companion))
    throw UsageError(option + " changes nothing without " + companion + "; give both");
}

int Tool::run(int argc, char** argv, const std::function<void()>& work) {
  running = this;
  try {
    if (argc == 3 && std::string_view(argv[1]) == "--describe") {
      std::cout << describe(parser_->app, argv[2]);
      return flush_output() ? 0 : 73;
    }
    const auto words = words_of(argc, argv, parser_->app);
    try {
      parse(parser_->app, words);
    } catch (const CLI::RequiredError&) {
      const auto other = file_first(words, parser_->app);
      if (other.empty()) throw;
      parse(parser_->app, other);
    }
  } catch (const UsageError& e) {
    std::cerr << name_ << ": " << e.what() << "; see " << name_ << " --help\n";
    return 2;
  } catch (const CLI::FileError& e) {
    std::cerr << name_ << ": " << e.what() << "; check the name\n";
    return 66;
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) {
      parser_->app.exit(e);
      if (flush_output()) return 0;
      if (reader_gone()) return closed_pipe;
      std::cerr << name_ << ": -: cannot be written; is the disk full?\n";
      return 73;
    }
    std::cerr << name_ << ": " << e.what() << "; see " << name_ << " --help\n";
    return 2;
  }
  ::signal(SIGPIPE, SIG_IGN);
  watch_signals(name_, patience);
  if (threads_ > 0) geo::set_threads(threads_);
  const auto fail = [&](const std::string& what, int code) {
    clear_bar();
    std::cerr << name_ << ": " << what << '\n';
    return code;
  };
  try {
    work();
    clear_bar();
    if (!flush_output()) throw geo::OutputError("-: cannot be written; is the disk full?");
    return 0;
  } catch (const UsageError& e) {
    return fail(std::string(e.what()) + "; see " + name_ + " --help", 2);
  } catch (const Failure& e) {
    return fail(e.what(), 1);
  } catch (const geo::MissingInputError& e) {
    return fail(e.what(), 66);
  } catch (const geo::InputError& e) {
    return fail(e.what(), 65);
  } catch (const geo::GeometryError& e) {
    return fail(e.what(), 1);
  } catch (const geo::OutputError& e) {
    if (std::string_view(e.what()).starts_with("-:") && reader_gone()) return closed_pipe;
    return fail(e.what(), 73);
  } catch (const geo::Interrupted&) {
    return fail("interrupted", 130);
  } catch (const std::bad_alloc&) {
    return fail("not enough memory", 70);
  } catch (const std::exception& e) {
    return fail(std::string("internal error: ") + e.what(), 70);
  }
}

std::string Tool::target(bool binary) const {
  const std::string path = output_path.empty() ? "-" : output_path;
  if (path == "-" && binary && ::isatty(1))
    throw UsageError("binary output does not go to a terminal: give -o FILE or a pipe");
  require_ending();
  geo::require_writable(path);
  return path;
}

void Tool::require_ending() const {
  const std::string ending = std::filesystem::path(output_path).extension().string();
  if (endings_.empty() || std::find(endings_.begin(), endings_.end(), ending) != endings_.end() ||
      !formats.contains(lower(ending)))
    return;
  std::string known = endings_[0];
  for (std::size_t i = 1; i < endings_.size(); ++i) known += (i + 1 < endings_.size() ? ", " : " or ") + endings_[i];
  throw UsageError("'" + output_path + "': " + name_ + " writes " + known + ", not " + ending);
}

geo::Progress Tool::progress() const {
  const bool bar = !quiet && (progress_ == "always" || (progress_ == "auto" && ::isatty(2)));
  return [bar](std::string_view phase, std::size_t done, std::size_t total) {
    if (bar) {
      const int percent = total > 0 ? static_cast<int>(100 * done / total) : 0;
      std::fprintf(stderr, "\r\033[K%3d %% %.*s%s", percent, static_cast<int>(phase.size()), phase.data(),
                   done == total ? "\r\033[K" : "");
      bar_shown = done != total;
    }
    return goes_on();
  };
}

bool Tool::goes_on() { return !interrupted; }

void Tool::say(const std::string& line) const {
  if (quiet) return;
  clear_bar();
  std::cerr << line << '\n';
}

void say_notes(const geo::SurfaceFile& file, const std::string& path) {
  if (const Tool* tool = running)
    for (const std::string& note : file.notes) tool->say(tool->name() + ": " + path + ": " + note);
}

geo::SurfaceFile parse_surface(const std::string& bytes, const std::string& path) {
  geo::SurfaceFile file = geo::parse_surface(bytes, path);
  say_notes(file, path);
  return file;
}

geo::SurfaceFile read_surface(const std::string& path) { return parse_surface(geo::read_all(path), path); }

std::string named_hash(const std::string& path, std::uint64_t fingerprint) {
  char hash[24];
  std::snprintf(hash, sizeof hash, "%016llx", static_cast<unsigned long long>(fingerprint));
  return path.substr(path.find_last_of('/') + 1) + " xxh3:" + hash;
}

std::string number(double x) {
  char text[32];
#ifdef __cpp_lib_to_chars
  return std::string(text, std::to_chars(text, text + sizeof text, x).ptr);
#else  // libc++ before 14
  for (int digits = 1; digits <= 17; ++digits) {
    std::snprintf(text, sizeof text, "%.*g", digits, x);
    if (std::strtod(text, nullptr) == x) break;
  }
  return text;
#endif
}

std::string rounded(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", x);
  return text;
}
std::string rounded(const geo::Vec3& p) { return rounded(p.x()) + ", " + rounded(p.y()) + ", " + rounded(p.z()); }

geo::Vec3 parse_vector(const std::string& option, const std::string& text) {
  double x = 0, y = 0, z = 0;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%lf,%lf,%lf%c", &x, &y, &z, &rest) != 3 || !geo::in_range({x, y, z}))
    throw UsageError(option + " '" + text + "' is not X,Y,Z");
  return {x, y, z};
}

std::string counted(std::size_t n, const std::string& noun) {
  return std::to_string(n) + " " + noun + (n == 1 ? "" : "s");
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (static_cast<unsigned char>(c) < 0x20) {
      char code[8];
      std::snprintf(code, sizeof code, "\\u%04x", c);
      out += code;
    } else {
      out += c;
    }
  }
  return out + "\"";
}

}  // namespace tool
