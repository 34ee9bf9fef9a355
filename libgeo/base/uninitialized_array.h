// Arrays of fixed size that are allocated without being initialised.
#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <span>
#include <type_traits>

namespace geo {

/// Advises the operating system to back the memory [at, at + bytes) with huge pages (2 MiB) if it
/// spans at least four of them. Huge pages cost fewer page faults and fewer TLB misses. Only Linux
/// takes the advice.
void advise_huge_pages(void* at, std::size_t bytes);

/// Forbids huge pages there, before memory that was so advised is freed. The heap may use it for
/// small objects, and each of them would then occupy a huge page.
void forbid_huge_pages(void* at, std::size_t bytes);

/// An array of fixed size with indeterminate elements. The operating system maps a page when it is
/// first written, which takes as long as filling it; without an initialising pass, all threads that
/// fill the array share this cost.
template <class T>
class UninitializedArray {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

  static constexpr std::align_val_t alignment{alignof(T) > alignof(std::max_align_t) ? alignof(T)
                                                                                     : alignof(std::max_align_t)};

 public:
  /// An empty array.
  UninitializedArray() = default;
  /// Allocates `size` elements, aligned for T. Throws std::bad_alloc.
  explicit UninitializedArray(std::size_t size)
      : at_(static_cast<T*>(::operator new(size * sizeof(T), alignment)), Release{size * sizeof(T)}), size_(size) {
    advise_huge_pages(data(), size * sizeof(T));
  }
  /// Number of elements.
  std::size_t size() const { return size_; }
  /// The first element; null if the array was default-constructed.
  T* data() { return at_.get(); }
  /// The first element; null if the array was default-constructed.
  const T* data() const { return at_.get(); }
  /// Element i < size().
  T& operator[](std::size_t i) { return at_.get()[i]; }
  /// Element i < size(), which must have been written.
  const T& operator[](std::size_t i) const { return at_.get()[i]; }
  /// The first element, for range-based loops.
  T* begin() { return data(); }
  /// One past the last element.
  T* end() { return data() + size_; }
  /// The first element, for range-based loops.
  const T* begin() const { return data(); }
  /// One past the last element.
  const T* end() const { return data() + size_; }
  /// A view of all elements.
  operator std::span<const T>() const { return {data(), size_}; }

 private:
  struct Release {
    std::size_t bytes = 0;
    /// Frees the elements.
    void operator()(T* at) const {
      forbid_huge_pages(at, bytes);
      ::operator delete(at, alignment);
    }
  };
  std::unique_ptr<T, Release> at_;
  std::size_t size_ = 0;
};

}  // namespace geo
