// The user's browser, and secrets.
#pragma once

#include <string>

namespace live {

/// Opens an address in a browser, where there is a display and a program to open it with. Whether
/// one was started.
bool open_browser(const std::string& url);

/// 128 random bits of the system, as 32 digits.
std::string random_token();

}  // namespace live
