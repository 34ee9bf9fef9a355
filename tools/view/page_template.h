// The page without content: page/ and three.js as one text, joined by page/assemble.cmake.
#pragma once

#include <string>

namespace view {

/// HTML with one @ABOUT@ (JSON) and, behind it, one @DATA@ (base64).
std::string page_template();

}  // namespace view
