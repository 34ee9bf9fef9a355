// fingerprint() of kerf/files.h. xxHash is compiled in here: nothing loads a library for it.
#define XXH_INLINE_ALL
#include <xxhash.h>

#include "kerf/files.h"

namespace geo {

std::uint64_t fingerprint(std::string_view bytes) { return XXH3_64bits(bytes.data(), bytes.size()); }

}  // namespace geo
