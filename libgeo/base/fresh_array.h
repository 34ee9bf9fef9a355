// Arrays that nobody has written to yet.
#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <span>
#include <type_traits>

namespace geo {

/// Asks the system for large pages where memory spans many of them: it has fewer to give, and addresses are looked up
/// faster.
void give_in_large_pages(void* at, std::size_t bytes);

/// An array of fixed size whose elements hold anything until they are written. The system gives memory where it is
/// first touched, which takes as long as filling it; this way all threads that fill it share that.
template <class T>
class FreshArray {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

  static constexpr std::align_val_t alignment{alignof(T) > alignof(std::max_align_t) ? alignof(T)
                                                                                     : alignof(std::max_align_t)};

 public:
  FreshArray() = default;
  explicit FreshArray(std::size_t size)
      : at_(static_cast<T*>(::operator new(size * sizeof(T), alignment))), size_(size) {
    give_in_large_pages(data(), size * sizeof(T));
  }
  std::size_t size() const { return size_; }
  T* data() { return at_.get(); }
  const T* data() const { return at_.get(); }
  T& operator[](std::size_t i) { return at_.get()[i]; }
  const T& operator[](std::size_t i) const { return at_.get()[i]; }
  T* begin() { return data(); }
  T* end() { return data() + size_; }
  const T* begin() const { return data(); }
  const T* end() const { return data() + size_; }
  operator std::span<const T>() const { return {data(), size_}; }

 private:
  struct Release {
    void operator()(T* at) const { ::operator delete(at, alignment); }
  };
  std::unique_ptr<T, Release> at_;
  std::size_t size_ = 0;
};

}  // namespace geo
