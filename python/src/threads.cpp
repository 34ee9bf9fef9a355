// The number of threads that the library uses, and its vectors.
#include "bind.h"
#include "kerf/error.h"
#include "kerf/parallel.h"
#include "kerf/vectors.h"

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
  module.def(
      "set_vectors",
      [](const std::string& kind) {
        if (kind != "widest" && kind != "portable") throw geo::InputError("set_vectors: give 'widest' or 'portable'");
        geo::set_vectors(kind == "portable" ? geo::Vectors::portable : geo::Vectors::widest);
      },
      py::arg("kind"),
      "Sets the vectors that steps of simulations are computed with: the 'widest' of the processor, or 'portable' "
      "ones.\n"
      "The latter give the bytes of any x86 processor, and of WebAssembly. Call it while no other call runs.\n"
      "Raises InputError for other words.");
  module.def(
      "vectors", [] { return geo::vectors() == geo::Vectors::portable ? "portable" : "widest"; },
      "The kind of vectors in use: 'widest' or 'portable'.");
}

}  // namespace kerf_python
