// scan/scan.h: the module is beside the program, or where packages have it.
#include <dlfcn.h>
#include <unistd.h>

#include <array>
#include <filesystem>

#include <kerf/error.h>
#include "scan/module.h"

namespace scan {
namespace {

namespace fs = std::filesystem;

void* open_module() {
  std::error_code failed;
  const fs::path folder = fs::read_symlink("/proc/self/exe", failed).parent_path();
  for (const fs::path& path : {folder / "kerf-scan.so", folder.parent_path() / KERF_SCAN_FOLDER / "kerf-scan.so"})
    if (fs::exists(path, failed))
      if (void* module = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL)) return module;
  return nullptr;
}

}  // namespace

Result reconstruct(const geo::PointCloud& cloud, const Options& options) {
  static void* const module = open_module();
  using Function = decltype(&kerf_scan_reconstruct);
  const auto function = module ? reinterpret_cast<Function>(::dlsym(module, "kerf_scan_reconstruct")) : nullptr;
  if (!function)
    throw geo::InputError(
        "scans need kerf-scan.so beside the program, and PCL (Debian's libpcl-surface1.13); install them");
  Result result;
  std::string message;
  if (!function(&cloud, &options, &result, &message)) throw geo::InputError(message);
  return result;
}

}  // namespace scan
