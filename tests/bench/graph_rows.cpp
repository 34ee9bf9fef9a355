#include "graph.h"

namespace bench {

void measure_rows(const GraphCase&, const Options&, Figures&) {}

}  // namespace bench
