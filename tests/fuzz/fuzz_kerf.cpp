#include "fuzz/entry.h"
#include "io/kerf_bytes.h"
#include "io/samples.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed);

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  const BodyFiles body = sample_body_files();
  fuzz::begin_with(*argc, *argv, {body.whole, body.appended, sample_checkpoint(cut_body())});
  return 0;
}

// Hashes detect every change, so most are recomputed.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed) {
  size = LLVMFuzzerMutate(data, size, most);
  if (seed % 8 == 0) return size;
  const std::string bytes = resealed(std::string(reinterpret_cast<const char*>(data), size));
  std::copy(bytes.begin(), bytes.end(), data);
  return bytes.size();
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz::attempt(data, size, [](const std::string& bytes, const std::string& name) {
    geo::read_body(geo::KerfFile(geo::Input(bytes, name)));
  });
}
