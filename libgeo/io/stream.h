// Bytes in and out: whole inputs from a file or standard input, outputs written aside and renamed.
#pragma once

#include <functional>
#include <ostream>
#include <string>

namespace geo {

/// The whole of a file, or of standard input where `path` is "-". Throws MissingInputError, or InputError when empty.
std::string read_all(const std::string& path);

/// Writes a file through `write`: aside in the same folder, flushed, then renamed; on any failure nothing is left
/// behind and what was there before stays. "-" writes to standard output. Throws OutputError.
void write_all(const std::string& path, const std::function<void(std::ostream&)>& write);

}  // namespace geo
