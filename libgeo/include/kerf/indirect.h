// A value of a type that only sources know: classes keep private members out of public headers with
// it.
#pragma once

#include <memory>
#include <utility>

namespace geo {

/// Owns one T, which may be incomplete where an Indirect<T> is a member. Copies copy the T, moves
/// move the pointer; a const Indirect gives a const T. Empty only after a move. T must be complete
/// where of() is called.
template <class T>
class Indirect {
 public:
  /// One that holds `value`.
  static Indirect of(T value) {
    return Indirect(
        new T(std::move(value)), [](const T& from) { return new T(from); }, [](T* at) { delete at; });
  }
  /// Holds a copy of what `other` holds; empty where `other` is empty.
  Indirect(const Indirect& other)
      : at_(other.at_ ? other.copy_(*other.at_) : nullptr, other.at_.get_deleter()), copy_(other.copy_) {}
  /// Takes what `other` holds; `other` is empty afterwards.
  Indirect(Indirect&& other) noexcept = default;
  /// As the copy constructor; keeps its value where copying throws.
  Indirect& operator=(const Indirect& other) { return *this = Indirect(other); }
  /// As the move constructor.
  Indirect& operator=(Indirect&& other) noexcept = default;
  ~Indirect() = default;

  /// The value. Precondition: not moved from.
  T& operator*() { return *at_; }
  /// The value. Precondition: not moved from.
  const T& operator*() const { return *at_; }
  /// A member of the value. Precondition: not moved from.
  T* operator->() { return at_.get(); }
  /// A member of the value. Precondition: not moved from.
  const T* operator->() const { return at_.get(); }

 private:
  using Copy = T* (*)(const T&);
  using Delete = void (*)(T*);
  Indirect(T* at, Copy copy, Delete remove) : at_(at, remove), copy_(copy) {}

  std::unique_ptr<T, Delete> at_;
  Copy copy_;
};

}  // namespace geo
