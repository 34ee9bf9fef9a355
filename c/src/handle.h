// Handles of kerf.h: numbers that stand for objects. None is ever used twice, and none is an
// address, so that a handle which was freed or made up is found out without being read.
#pragma once

#include <memory>
#include <mutex>
#include <shared_mutex>
#include <stdexcept>
#include <string>

#include "kerf.h"

namespace kerf_c {

/// A handle is null, of another kind, or freed.
struct HandleError : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// Another call uses the handle now.
struct BusyError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The kinds of handle.
enum class Kind { bytes, mesh, complex, front, pieces, simulation, solid, breaking };

/// The name of a kind, with its article, for messages.
const char* name_of(Kind kind);

/// What a handle stands for.
class Object {
 public:
  /// An object of that kind.
  explicit Object(Kind kind) : kind_(kind) {}
  Object(const Object&) = delete;
  Object& operator=(const Object&) = delete;
  virtual ~Object() = default;
  /// Its kind.
  Kind kind() const { return kind_; }
  /// Held by each call that uses the object: shared by those that only read.
  std::shared_mutex& in_use() { return in_use_; }

 private:
  Kind kind_;
  std::shared_mutex in_use_;
};

/// Gives an object a handle.
void* handle_for(std::shared_ptr<Object> object);
/// The object of a handle. Throws HandleError unless it is of that kind.
std::shared_ptr<Object> object_of(const void* handle, Kind kind);
/// Ends a handle. Calls that use its object go on. Throws HandleError for one that is none.
void end_handle(const void* handle);

/// An object that a call uses. Throws HandleError, and BusyError where another call is in the way.
template <class T, class Lock>
class Use {
 public:
  /// Of this handle.
  explicit Use(const void* handle) : Use(std::static_pointer_cast<T>(object_of(handle, T::kind))) {}
  /// Of this object.
  explicit Use(std::shared_ptr<T> object) : object_(std::move(object)), lock_(object_->in_use(), std::try_to_lock) {
    if (!lock_) throw BusyError(std::string(name_of(T::kind)) + " is in use by another call; wait until that returns");
  }
  /// The object.
  T& operator*() const { return *object_; }
  /// The object.
  T* operator->() const { return object_.get(); }
  /// The object, to be kept.
  const std::shared_ptr<T>& shared() const { return object_; }

 private:
  std::shared_ptr<T> object_;
  Lock lock_;
};
/// Use that changes the object.
template <class T>
using Writing = Use<T, std::unique_lock<std::shared_mutex>>;
/// Use that only reads the object.
template <class T>
using Reading = Use<T, std::shared_lock<std::shared_mutex>>;

}  // namespace kerf_c
