// The page that kerf-live serves, assembled when Kerf is built.
#pragma once

#include <string>

namespace live {

/// The whole page, three.js included.
std::string page_text();

}  // namespace live
