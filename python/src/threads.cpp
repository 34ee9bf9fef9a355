// The number of threads that the library uses.
#include "bind.h"
#include "kerf/error.h"
#include "kerf/parallel.h"

namespace kerf_python {

void bind_threads(py::module_& module) {
  module.def("threads", &geo::threads, "Number of threads that the library uses.");
  module.def(
      "set_threads",
      [](int count) {
        if (count < 0 || count > 1024) throw geo::InputError("set_threads: give 0 (one for each core) to 1024");
        geo::set_threads(count);
      },
      py::arg("count"),
      "Sets the number of threads that the library uses; 0: one for each core. Results do not depend on it.\n"
      "Call it while no other call runs. Raises InputError for a count below 0 or above 1024.");
}

}  // namespace kerf_python
