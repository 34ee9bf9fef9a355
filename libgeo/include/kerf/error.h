// The three ways in which a call can fail; legitimate outcomes are return values, never exceptions.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace geo {

/// The input is wrong: malformed, open, self-intersecting, out of range. The message says what is wrong and what to do.
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The input file is not there or cannot be opened.
struct MissingInputError : InputError {
  using InputError::InputError;
};

/// The output cannot be made: folder missing, disk full, no permission.
struct OutputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A geometric operation failed on valid input; what it worked on is unchanged.
struct GeometryError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The caller asked to stop (see Progress); nothing was committed.
struct Interrupted : std::runtime_error {
  Interrupted() : std::runtime_error("interrupted") {}
};

// ---- What somebody may have meant.

/// "; did you mean 'WORD'?" with the first of `known` that is the fewest letters (put in, left out, changed, or
/// exchanged with the next) from `written`, or that begins with it; empty where more than a third of the letters
/// differ.
std::string did_you_mean(std::string_view written, const std::vector<std::string>& known);

}  // namespace geo
