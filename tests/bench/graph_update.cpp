#include "graph.h"

namespace bench {

void measure_update(const GraphCase&, const Options&, Figures&) {}

}  // namespace bench
