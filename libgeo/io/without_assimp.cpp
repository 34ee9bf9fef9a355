// io/surface_assimp.h in a build without assimp.
#include "io/surface_assimp.h"
#include "kerf/error.h"

namespace geo {

bool assimp_reads(const std::string&) { return false; }

SurfaceFile parse_by_assimp(const std::string&, const std::string& name, const OtherFormat& format) {
  throw InputError(name + ": is " + format.what +
                   ", which this build of Kerf does not read, as it was made without assimp; save it as GLB, PLY, OBJ, "
                   "STL or OFF");
}

}  // namespace geo
