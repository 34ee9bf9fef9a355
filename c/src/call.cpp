// call.h; the functions of kerf.h on versions, messages and threads.
#include "call.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "kerf/parallel.h"
#include "kerf/vectors.h"

namespace kerf_c {
namespace {

// Of fixed size, so that a message can be kept where there is no memory.
thread_local std::array<char, 2048> last_message{};

constexpr std::array status_names{"KERF_OK",     "KERF_INPUT",    "KERF_GEOMETRY", "KERF_OUTPUT", "KERF_STOPPED",
                                  "KERF_HANDLE", "KERF_ARGUMENT", "KERF_BUSY",     "KERF_MEMORY", "KERF_INTERNAL"};

}  // namespace

kerf_status failed(kerf_status status, const char* message) noexcept {
  std::strncpy(last_message.data(), message, last_message.size() - 1);
  return status;
}

kerf_status status_of_exception() noexcept {
  try {
    throw;
  } catch (const HandleError& e) {
    return failed(KERF_HANDLE, e.what());
  } catch (const BusyError& e) {
    return failed(KERF_BUSY, e.what());
  } catch (const ArgumentError& e) {
    return failed(KERF_ARGUMENT, e.what());
  } catch (const geo::InputError& e) {
    return failed(KERF_INPUT, e.what());
  } catch (const geo::GeometryError& e) {
    return failed(KERF_GEOMETRY, e.what());
  } catch (const geo::OutputError& e) {
    return failed(KERF_OUTPUT, e.what());
  } catch (const geo::Interrupted&) {
    return failed(KERF_STOPPED, "stopped by the callback");
  } catch (const std::bad_alloc&) {
    return failed(KERF_MEMORY, "there is not enough memory; give a smaller model");
  } catch (const std::length_error&) {
    return failed(KERF_MEMORY, "an array would be larger than memory; give a smaller model");
  } catch (const std::exception& e) {
    return failed(KERF_INTERNAL, e.what());
  } catch (...) {
    return failed(KERF_INTERNAL, "an unknown fault");
  }
}

geo::Vec3 point_of(const double* point, const char* name) {
  required(point, name);
  const geo::Vec3 p(point[0], point[1], point[2]);
  if (!geo::in_range(p)) throw ArgumentError(std::string(name) + ": a coordinate is not finite, or too large");
  return p;
}

std::vector<geo::Vec3> points_of(const double* points, std::size_t length, const char* name) {
  const auto values = array_of(points, length, 3, name);
  std::vector<geo::Vec3> result;
  result.reserve(values.size() / 3);
  for (std::size_t i = 0; i < values.size(); i += 3) {
    result.emplace_back(values[i], values[i + 1], values[i + 2]);
    if (!geo::in_range(result.back()))
      throw ArgumentError(std::string(name) + ": point " + std::to_string(i / 3) +
                          " has a coordinate that is not finite, or too large");
  }
  return result;
}

double number_of(double value, double low, double high, const char* name) {
  if (!(value >= low && value <= high)) {
    std::array<char, 128> range{};
    std::snprintf(range.data(), range.size(), ": give a number from %g to %g", low, high);
    throw ArgumentError(name + std::string(range.data()));
  }
  return value;
}

bool flag_of(std::int32_t value, const char* name) {
  if (value != 0 && value != 1) throw ArgumentError(std::string(name) + ": give 0 or 1");
  return value == 1;
}

geo::Progress progress_of(kerf_progress progress, void* user) {
  if (!progress) return {};
  return [=](std::string_view phase, std::size_t done, std::size_t total) {
    return progress(user, std::string(phase).c_str(), done, total) != 0;
  };
}

void copy_out(std::span<const double> values, double* out, std::size_t length, std::size_t* needed) {
  if (!out && length > 0) throw ArgumentError("the array is null, and its length is not 0");
  if (!out && !needed) throw ArgumentError("both array and needed are null; give one");
  if (needed) *needed = values.size();
  if (!out) return;
  if (length < values.size())
    throw ArgumentError("the array has room for " + std::to_string(length) + " numbers; give one for " +
                        std::to_string(values.size()));
  std::copy(values.begin(), values.end(), out);
}

}  // namespace kerf_c

using namespace kerf_c;

const char* kerf_version(void) { return KERF_VERSION; }
uint32_t kerf_abi(void) { return KERF_ABI; }
const char* kerf_last_message(void) { return last_message.data(); }

const char* kerf_status_name(kerf_status status) {
  const auto index = static_cast<unsigned>(status);
  return index < status_names.size() ? status_names[index] : "";
}

kerf_status kerf_set_threads(int32_t count) {
  return call([&] {
    number_of(count, 0, 1024, "count");
    geo::set_threads(count);
  });
}

kerf_status kerf_set_portable(int32_t portable) {
  return call([&] { geo::set_vectors(flag_of(portable, "portable") ? geo::Vectors::portable : geo::Vectors::widest); });
}

kerf_status kerf_free(void* handle) {
  return call([&] {
    if (handle) end_handle(handle);
  });
}
