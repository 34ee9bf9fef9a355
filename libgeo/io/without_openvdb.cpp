// The functions of kerf/files.h and kerf/repair.h that need OpenVDB, in a build without it.
#include "kerf/error.h"
#include "kerf/files.h"
#include "kerf/repair.h"

namespace geo {
namespace {

[[noreturn]] void refuse_wrapping() {
  throw InputError(
      "a new surface around the model needs OpenVDB, without which this build of Kerf was made; mend the "
      "triangles that are there (repaired_solid)");
}

}  // namespace

TriangleMesh read_volume(const std::string& path, const VolumeOptions&) {
  throw InputError(path +
                   ": volumes (.vdb) need OpenVDB, without which this build of Kerf was made; convert it to a mesh "
                   "with a build that has it");
}

void write_level_set(const std::string& path, const TriangleMesh&, double, bool) {
  throw OutputError(path +
                    ": volumes (.vdb) need OpenVDB, without which this build of Kerf was made; write a mesh instead");
}

TriangleMesh wrapped(const TriangleMesh&, double, OpenParts, const Progress&) { refuse_wrapping(); }

TriangleMesh wrapped_solid(TriangleMesh, double, const RepairOptions&, OpenParts, WrapStats*, const Progress&) {
  refuse_wrapping();
}

}  // namespace geo
