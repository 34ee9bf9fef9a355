// Entry point of libFuzzer: a reader may refuse its input by InputError only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "kerf/error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv);

namespace fuzz {

template <class Read>
int attempt(const std::uint8_t* data, std::size_t size, const Read& read) {
  try {
    read(std::string(reinterpret_cast<const char*>(data), size), "fuzzed");
  } catch (const geo::InputError& e) {
    if (std::string(e.what()).rfind("fuzzed:", 0) != 0) std::abort();
  }
  return 0;
}

/// Writes samples to the first folder of the command line where it is empty.
inline void begin_with(int argc, char** argv, const std::vector<std::string>& samples) {
  for (int i = 1; i < argc; ++i)
    if (const std::filesystem::path folder = argv[i];
        std::filesystem::is_directory(folder) && std::filesystem::is_empty(folder)) {
      for (std::size_t s = 0; s < samples.size(); ++s)
        std::ofstream(folder / ("sample-" + std::to_string(s)), std::ios::binary) << samples[s];
      return;
    }
}

}  // namespace fuzz
