#include "fuzz/entry.h"
#include "live/command.h"
#include "live/messages.h"

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  fuzz::begin_with(*argc, *argv, sample_messages());
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    live::read_command({reinterpret_cast<const char*>(data), size});
  } catch (const live::BadMessage&) {
  }
  return 0;
}
