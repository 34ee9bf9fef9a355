// A campaign of damaged files: each must be read, or refused in one line that begins with its name.
#pragma once

#include <sys/resource.h>
#include <sys/time.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <functional>
#include <map>
#include <string>

#include "base/random.h"
#include "cases.h"
#include "io/mutate.h"
#include "kerf/error.h"
#include "kerf/files.h"

// Callback of the sanitizers, if any: reports the case that they stop.
extern "C" __attribute__((weak)) void __sanitizer_set_death_callback(void (*)());
extern "C" const char* __ubsan_default_options();
extern "C" __attribute__((used)) inline const char* __ubsan_default_options() {
  return "abort_on_error=1:print_stacktrace=1";
}

namespace fuzz {

#if defined(__SANITIZE_ADDRESS__)
constexpr double slower = 10, larger = 4;
#else
constexpr double slower = 1, larger = 1;
#endif

/// A case, for error reports.
struct Case {
  std::string family, bytes;
  std::uint64_t seed = 0;
  std::string save() const {
    const std::string path = "fuzz-" + family + "-" + std::to_string(seed);
    if (std::FILE* file = std::fopen(path.c_str(), "wb")) {
      std::fwrite(bytes.data(), 1, bytes.size(), file);
      std::fclose(file);
    }
    return path;
  }
};
/// The current one. It is never destroyed: sanitizers report at the very end of the program.
inline Case& current = *new Case;

inline void tell_and_die() {
  std::fprintf(stderr, "fuzz: %s, seed %llu: crashed or hangs; its bytes are in %s\n", current.family.c_str(),
               static_cast<unsigned long long>(current.seed), current.save().c_str());
}

inline void on_signal(int signal) {
  tell_and_die();
  std::signal(signal, SIG_DFL);
  std::raise(signal);
  _exit(1);
}

// A case that does not end is stopped after twenty seconds of processor time.
inline void guard_time() {
  const itimerval limit{{0, 0}, {static_cast<time_t>(20 * slower), 0}};
  setitimer(ITIMER_PROF, &limit, nullptr);
}

inline double peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;  // MB
}

inline std::string fault_of_message(const std::string& message, const std::string& name) {
  if (message.size() <= name.size() + 2 || message.compare(0, name.size() + 1, name + ":") != 0)
    return "a message that does not begin with the file's name: ";
  if (message.size() > 400) return "a message of " + std::to_string(message.size()) + " characters: ";
  for (const char c : message)
    if (static_cast<unsigned char>(c) < 32 || c == 127) return "a message with a control character: ";
  return {};
}

using Use = std::function<void()>;                                                   ///< use of the value that was read
using Read = std::function<Use(const std::string& bytes, const std::string& name)>;  ///< may throw InputError only
using Damage = std::function<std::string(geo::Random&)>;

struct Outcome {
  std::string fault;
  bool read = false, used = false;
};

inline Outcome outcome_of(const std::string& bytes, const std::string& name, const Read& read) {
  Outcome o;
  const std::clock_t start = std::clock();
  const auto seconds = [&] { return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC; };
  double read_by = 0;
  try {
    Use use;
    try {
      use = read(bytes, name);
      o.read = true;
    } catch (const geo::InputError& e) {
      if (const auto f = fault_of_message(e.what(), name); !f.empty()) o.fault = f + e.what();
    }
    read_by = seconds();
    try {
      if (o.read) use();
      o.used = o.read;
    } catch (const geo::InputError& e) {
      if (const auto f = fault_of_message(name + ": " + e.what(), name); !f.empty()) o.fault = f + e.what();
    } catch (const geo::GeometryError&) {
    }
  } catch (const std::exception& e) {
    o.fault = std::string(o.read ? "in use: " : "in reading: ") + e.what();
  }
  // Cutting the value may take longer than any reading.
  const double done = seconds();
  if (o.fault.empty() && (read_by > 2 * slower || done > 8 * slower))
    o.fault = "took " + std::to_string(read_by) + " s to read, " + std::to_string(done) + " s in all";
  if (o.fault.empty() && peak_memory() > 1000 * larger) o.fault = "took " + std::to_string(peak_memory()) + " MB";
  return o;
}

/// Whether a reader refuses damaged files, or takes from each what it understands.
enum class Refusals { some, none };

/// `base` cases of one family of files.
inline void campaign(const std::string& family, int base, const Read& read, const Damage& damage,
                     Refusals refusals = Refusals::some) {
  if (__sanitizer_set_death_callback) __sanitizer_set_death_callback(tell_and_die);
  std::map<int, void (*)(int)> before;
  for (const int s : {SIGSEGV, SIGABRT, SIGFPE, SIGBUS, SIGPROF})
    if (!__sanitizer_set_death_callback || s == SIGPROF || s == SIGABRT) before[s] = std::signal(s, on_signal);
  const Seeds which = seeds(base);
  int read_count = 0, used_count = 0;
  for (int c = 0; c < which.count; ++c) {
    current.family = family;
    current.seed = which.first + static_cast<std::uint64_t>(c);
    geo::Random random(current.seed ^ geo::fingerprint(family));
    current.bytes = damage(random);
    guard_time();
    const Outcome o = outcome_of(current.bytes, "damaged." + family, read);
    read_count += o.read;
    used_count += o.used;
    if (!o.fault.empty())
      FAIL_CHECK(family << ", seed " << current.seed << ": " << o.fault << "; the bytes are in " << current.save());
  }
  const itimerval none{};
  setitimer(ITIMER_PROF, &none, nullptr);
  for (const auto& [s, handler] : before) std::signal(s, handler);
  // If no damaged file were read, only the first check of each reader would be tested.
  if (which.count >= 100) {
    CHECK(read_count * 50 > which.count);
    CHECK(used_count * 100 > which.count);
    CHECK((read_count < which.count) == (refusals == Refusals::some));
  }
  if (std::getenv("KERF_CASES"))
    WARN(family << ": " << which.count << " cases, " << read_count << " read, " << used_count << " of use");
}

}  // namespace fuzz
