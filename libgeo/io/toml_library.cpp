// io/toml.h: the implementation of toml++, compiled here once, so that nothing loads a library for
// it.
#define TOML_IMPLEMENTATION
#include "io/toml.h"
