#include "graph.h"

namespace bench {

void measure_visibility(const GraphCase&, const Options&, Figures&) {}

}  // namespace bench
