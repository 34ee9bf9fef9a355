// Writing `.kerf` files: arrays one after another, each from where it is, never the whole file in memory.
#pragma once

#include <cstdint>
#include <cstring>
#include <functional>
#include <ostream>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace geo {

/// Takes the bytes of one array in order and passes them on in blocks.
class KerfSink {
 public:
  using Take = std::function<void(std::span<const std::byte>)>;
  /// `take` gets blocks of one size, the last one shorter.
  explicit KerfSink(Take take);
  template <class T>
  void put(T value) {
    static_assert(std::is_trivially_copyable_v<T>);
    if (block_.size() - used_ < sizeof value) return write(std::as_bytes(std::span<const T, 1>(&value, 1)));
    std::memcpy(block_.data() + used_, &value, sizeof value);
    used_ += sizeof value;
  }
  void write(std::span<const std::byte> bytes);
  /// Passes on what is left. Bytes taken in all.
  std::uint64_t finish();

 private:
  Take take_;
  std::vector<std::byte> block_;
  std::size_t used_ = 0;
  std::uint64_t taken_ = 0;
};

/// One array to be written: dtype f8, f4, u8, u4, i4, u2, u1 or json, and its shape; rows are the first dimension.
/// `fill` puts exactly the bytes that these make, each time it is called.
struct KerfArray {
  std::string name, dtype;
  std::vector<std::uint64_t> shape;
  std::function<void(KerfSink&)> fill;
};

template <class T>
constexpr const char* kerf_dtype() {
  if constexpr (std::is_same_v<T, double>)
    return "f8";
  else if constexpr (std::is_same_v<T, float>)
    return "f4";
  else if constexpr (std::is_same_v<T, std::uint64_t>)
    return "u8";
  else if constexpr (std::is_same_v<T, std::uint32_t>)
    return "u4";
  else if constexpr (std::is_same_v<T, std::int32_t>)
    return "i4";
  else if constexpr (std::is_same_v<T, std::uint16_t>)
    return "u2";
  else {
    static_assert(std::is_same_v<T, std::uint8_t>);
    return "u1";
  }
}

/// An array of `rows` × `columns` numbers of type T that `fill` puts, or that are in memory until they are written.
template <class T>
KerfArray kerf_array(std::string name, std::uint64_t rows, std::uint64_t columns, std::function<void(KerfSink&)> fill) {
  KerfArray a{std::move(name), kerf_dtype<T>(), {rows}, std::move(fill)};
  if (columns > 1) a.shape.push_back(columns);
  return a;
}
template <class T>
KerfArray kerf_array(std::string name, std::span<const T> values, std::uint64_t columns = 1) {
  return kerf_array<T>(std::move(name), values.size() / columns, columns,
                       [values](KerfSink& sink) { sink.write(std::as_bytes(values)); });
}

/// A whole file, in one pass, to a pipe as well. Deterministic. Memory: one block, whatever the size.
void write_kerf(std::ostream& out, const std::vector<KerfArray>& arrays);

}  // namespace geo
