#include "graph.h"

namespace bench {

void measure_nearest(const GraphCase&, const Options&, Figures&) {}

}  // namespace bench
