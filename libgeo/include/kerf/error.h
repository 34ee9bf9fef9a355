// The exceptions that calls throw. Legitimate outcomes are return values, never exceptions.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace geo {

/// The input is invalid: malformed, open, self-intersecting or out of range. The message says what
/// is wrong and how to correct it.
struct InputError : std::runtime_error {
  /// With the message `what`.
  using std::runtime_error::runtime_error;
};

/// The input file does not exist or cannot be opened.
struct MissingInputError : InputError {
  /// With the message `what`.
  using InputError::InputError;
};

/// The output cannot be written: the folder is missing, the disk full, or permission denied.
struct OutputError : std::runtime_error {
  /// With the message `what`.
  using std::runtime_error::runtime_error;
};

/// A geometric operation failed on valid input; its operands are unchanged.
struct GeometryError : std::runtime_error {
  /// With the message `what`.
  using std::runtime_error::runtime_error;
};

/// The caller cancelled the work (see Progress); nothing was committed.
struct Interrupted : std::runtime_error {
  /// With the message "interrupted".
  Interrupted() : std::runtime_error("interrupted") {}
};

/// Returns "; did you mean 'WORD'?" for the first of the `known` words with the least edit distance
/// to `written` (insertions, deletions, substitutions, transpositions of adjacent letters). A word
/// that begins with `written` has distance 1. Returns "" if the distance exceeds a third of the
/// word's length.
std::string did_you_mean(std::string_view written, const std::vector<std::string>& known);

}  // namespace geo
