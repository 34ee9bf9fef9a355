// Errors keep the name of their class; numbers are checked before the library sees them.
#include "bind.h"

#include <array>
#include <cmath>
#include <cstdio>

#include <kerf/parallel.h>

namespace kerf_js {
namespace {

val failure_of(const char* kind, const std::string& message) {
  val result = val::object();
  result.set("failure", std::string(kind));
  result.set("message", message);
  return result;
}

// As people write it: "0.01", "20000".
std::string written(double x) {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), "%.16g", x);
  return text.data();
}

double number(const val& options, const char* name, double least, double most) {
  const val given = options[name];
  const double value = given.isNumber() ? given.as<double>() : std::nan("");
  if (!(value >= least && value <= most))
    throw geo::InputError(std::string(name) + ": give a number from " + written(least) + " to " + written(most));
  return value;
}

}  // namespace

val failure() {
  try {
    throw;
  } catch (const geo::InputError& e) {
    return failure_of("InputError", e.what());
  } catch (const geo::GeometryError& e) {
    return failure_of("GeometryError", e.what());
  } catch (const geo::Interrupted& e) {
    return failure_of("Interrupted", e.what());
  } catch (const std::bad_alloc&) {
    return failure_of("RangeError", "the memory of a WebAssembly module is used up: take a smaller model");
  } catch (const std::exception& e) {
    return failure_of("Error", e.what());
  }
}

geo::Progress progress_to(val function) {
  if (function.isUndefined() || function.isNull()) return {};
  return [function](std::string_view phase, std::size_t done, std::size_t total) {
    return function(std::string(phase), double(done), double(total)).as<bool>();
  };
}

std::vector<geo::Vec3> points_from(const val& array, const std::string& name) {
  const auto length = array["length"].as<std::size_t>();
  if (length % 3 != 0)
    throw geo::InputError(name + ": give three numbers for each point, not " + std::to_string(length));
  std::vector<geo::Vec3> points(length / 3);
  if (!points.empty()) val(emscripten::typed_memory_view(length, points.data()->data())).call<void>("set", array);
  for (const geo::Vec3& p : points)
    if (!p.allFinite()) throw geo::InputError(name + ": a coordinate is no finite number");
  return points;
}

geo::Vec3 point_from(const val& array, const std::string& name) {
  if (!array.isArray() && !array["BYTES_PER_ELEMENT"].isNumber()) throw geo::InputError(name + ": give three numbers");
  if (array["length"].as<std::size_t>() != 3) throw geo::InputError(name + ": give three numbers");
  geo::Vec3 point;
  for (int k = 0; k < 3; ++k) {
    const val x = array[k];
    point[k] = x.isNumber() ? x.as<double>() : std::nan("");
  }
  if (!point.allFinite()) throw geo::InputError(name + ": a coordinate is no finite number");
  return point;
}

std::string text_from(const val& bytes) {
  std::string text(bytes["length"].as<std::size_t>(), '\0');
  val(emscripten::typed_memory_view(text.size(), reinterpret_cast<std::uint8_t*>(text.data())))
      .call<void>("set", bytes);
  return text;
}

bool has(const val& options, const char* name) {
  if (options.isUndefined() || options.isNull()) return false;
  const val value = options[name];
  return !value.isUndefined() && !value.isNull();
}

void take(const val& options, const char* name, double& out, double least, double most) {
  if (has(options, name)) out = number(options, name, least, most);
}

void take(const val& options, const char* name, int& out, int least, int most) {
  if (!has(options, name)) return;
  const double value = number(options, name, least, most);
  if (value != std::floor(value)) throw geo::InputError(std::string(name) + ": give a whole number");
  out = static_cast<int>(value);
}

void take_seed(const val& options, const char* name, std::uint64_t& out) {
  if (!has(options, name)) return;
  const double value = number(options, name, 0, 0x1p53);
  if (value != std::floor(value)) throw geo::InputError(std::string(name) + ": give a whole number");
  out = static_cast<std::uint64_t>(value);
}

geo::CrackOptions crack_options(const val& options) {
  geo::CrackOptions o;
  take(options, "snap", o.snap, 0, 1);
  take(options, "snapEdges", o.snap_edges, 0, 1);
  take(options, "faceOffset", o.face_offset, 0, 1);
  take(options, "clearance", o.clearance, 0, 1);
  take(options, "jitter", o.jitter, 0, 1);
  take(options, "attempts", o.attempts, 1, 1000);
  take_seed(options, "seed", o.seed);
  return o;
}

// The modules have one thread.
EMSCRIPTEN_BINDINGS(kerf_threads) { geo::set_threads(1); }

}  // namespace kerf_js
