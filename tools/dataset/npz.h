// NumPy archives with compressed arrays.
#pragma once

#include <cstdint>
#include <ostream>
#include <span>
#include <string>
#include <vector>

namespace dataset {

/// Type of an array's elements as .npy names it, little-endian.
template <class T>
constexpr const char* npy_type = nullptr;
template <>
inline constexpr const char* npy_type<double> = "<f8";
template <>
inline constexpr const char* npy_type<float> = "<f4";
template <>
inline constexpr const char* npy_type<std::int64_t> = "<i8";
template <>
inline constexpr const char* npy_type<std::int32_t> = "<i4";

/// Writes a .npz: a zip archive (APPNOTE 6.3) of .npy arrays (NEP 1). The same arrays give the same
/// bytes with the same zlib.
class NpzWriter {
 public:
  /// The archive goes to `out`, from its present position on.
  explicit NpzWriter(std::ostream& out) : out_(out) {}
  /// Appends an array of `columns` columns; 1: without a second dimension. Throws std::length_error
  /// beyond 4 GB.
  template <class T>
  void add(const std::string& name, std::span<const T> values, std::uint64_t columns = 1) {
    std::string shape = std::to_string(values.size() / columns) + ",";
    if (columns > 1) shape += " " + std::to_string(columns);
    add(name, npy_type<T>, shape, std::as_bytes(values));
  }
  /// Writes the directory: call once, last.
  void finish();

 private:
  void add(const std::string& name, const std::string& type, const std::string& shape,
           std::span<const std::byte> bytes);

  std::ostream& out_;
  std::string directory_;
  std::uint64_t at_ = 0, entries_ = 0;
};

}  // namespace dataset
