// write_vtkhdf() of kerf/export.h in a build without HDF5.
#include "kerf/error.h"
#include "kerf/export.h"

namespace geo {

void write_vtkhdf(std::ostream&, const Body&) {
  throw OutputError("VTKHDF needs the HDF5 library, without which this build of Kerf was made; export .vtu instead");
}

}  // namespace geo
