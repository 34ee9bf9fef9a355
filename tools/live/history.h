// States of a run as bytes, which undo and redo go back to: the newest is whole, each other one is
// its difference from the next newer one.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace live {

/// The difference that leads from the bytes `from` to the bytes `to`. It is short where `to`
/// consists of long parts of `from`, wherever these stand.
std::string difference(std::string_view from, std::string_view to);
/// The bytes that a difference() leads to. Precondition: it was made for the same `from`.
std::string follow_difference(std::string_view from, std::string_view difference);

/// A stack of states.
class StateStack {
 public:
  /// Puts a state on top.
  void push(std::string state);
  /// Takes the state on top. Precondition: there is one.
  std::string pop();
  /// Removes a state; 0 is the oldest one.
  void erase(std::size_t index);
  /// Removes all states.
  void clear();
  /// Number of states.
  std::size_t size() const { return states_.size(); }
  /// Bytes of all states, as they are kept.
  std::size_t bytes() const { return bytes_; }

 private:
  void put(std::size_t index, std::string bytes);
  std::vector<std::string> states_;  // the last one whole
  std::size_t bytes_ = 0;
};

}  // namespace live
