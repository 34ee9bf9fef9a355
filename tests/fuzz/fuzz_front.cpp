#include "fuzz/entry.h"
#include "io/samples.h"

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  fuzz::begin_with(*argc, *argv, sample_fronts());
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz::attempt(data, size,
                       [](const std::string& bytes, const std::string& name) { geo::parse_fronts(bytes, name); });
}
