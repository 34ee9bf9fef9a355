// Writing `.kerf` files array by array, without the whole file in memory.
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

/// Collects the bytes of one array in order, and passes them on in blocks.
class KerfSink {
 public:
  using Take = std::function<void(std::span<const std::byte>)>;
  /// `take` receives blocks of equal size, the last one shorter.
  explicit KerfSink(Take take);
  /// Appends the bytes of a value.
  template <class T>
  void put(T value) {
    static_assert(std::is_trivially_copyable_v<T>);
    if (block_.size() - used_ < sizeof value) return write(std::as_bytes(std::span<const T, 1>(&value, 1)));
    std::memcpy(block_.data() + used_, &value, sizeof value);
    used_ += sizeof value;
  }
  /// Appends bytes.
  void write(std::span<const std::byte> bytes);
  /// Passes on the last block. Returns the number of bytes in all.
  std::uint64_t finish();

 private:
  Take take_;
  std::vector<std::byte> block_;
  std::size_t used_ = 0;
  std::uint64_t taken_ = 0;
};

/// A function that writes what it is given to a sink, as KerfFile::stream() takes it.
inline KerfSink::Take into(KerfSink& sink) {
  return [&sink](std::span<const std::byte> bytes) { sink.write(bytes); };
}

/// An array to write: type f8, f4, u8, u4, i4, u2, u1 or json, and shape; rows are the first
/// dimension. `fill` puts exactly the bytes of that shape, each time it is called.
struct KerfArray {
  std::string name, dtype;
  std::vector<std::uint64_t> shape;
  std::function<void(KerfSink&)> fill;
};

/// Name of a type in the file.
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

/// An array of `rows` × `columns` numbers of type T, which `fill` puts.
template <class T>
KerfArray kerf_array(std::string name, std::uint64_t rows, std::uint64_t columns, std::function<void(KerfSink&)> fill) {
  KerfArray a{.name = std::move(name), .dtype = kerf_dtype<T>(), .shape = {rows}, .fill = std::move(fill)};
  if (columns > 1) a.shape.push_back(columns);
  return a;
}
/// An array of the given values, which must outlive it.
template <class T>
KerfArray kerf_array(std::string name, std::span<const T> values, std::uint64_t columns = 1) {
  return kerf_array<T>(std::move(name), values.size() / columns, columns,
                       [values](KerfSink& sink) { sink.write(std::as_bytes(values)); });
}

/// Writes a new file in one pass, to any stream. The same arrays give the same bytes. Memory: one
/// block.
void write_kerf(std::ostream& out, const std::vector<KerfArray>& arrays);

}  // namespace geo
