// zlib's level 1: higher ones gain little on coordinates, and take a multiple of the time.
#include "dataset/npz.h"

#include <zlib.h>

#include <stdexcept>

namespace dataset {
namespace {

// Appends little-endian fields of fixed width.
void put(std::string& bytes, std::uint64_t value, int width) {
  for (; width-- > 0; value >>= 8) bytes += static_cast<char>(value & 255);
}

// Raw deflate of two parts, one after another.
std::string deflated(const std::string& header, std::span<const std::byte> bytes) {
  z_stream z{};
  if (deflateInit2(&z, 1, Z_DEFLATED, -15, 9, Z_DEFAULT_STRATEGY) != Z_OK) throw std::bad_alloc();
  std::string out(deflateBound(&z, header.size() + bytes.size()) + 64, '\0');
  z.next_out = reinterpret_cast<Bytef*>(out.data());
  z.avail_out = static_cast<uInt>(out.size());
  const auto pass = [&](const void* data, std::size_t size, int flush) {
    z.next_in = static_cast<Bytef*>(const_cast<void*>(data));  // zlib reads it alone
    z.avail_in = static_cast<uInt>(size);
    return deflate(&z, flush);
  };
  pass(header.data(), header.size(), Z_NO_FLUSH);
  const bool done = pass(bytes.data(), bytes.size(), Z_FINISH) == Z_STREAM_END;
  out.resize(z.total_out);
  deflateEnd(&z);
  if (!done) throw std::logic_error("zlib needs more than its own bound");
  return out;
}

}  // namespace

void NpzWriter::add(const std::string& name, const std::string& type, const std::string& shape,
                    std::span<const std::byte> bytes) {
  std::string text = "{'descr': '" + type + "', 'fortran_order': False, 'shape': (" + shape + "), }";
  text.resize((10 + text.size() + 1 + 63) / 64 * 64 - 11, ' ');
  text += '\n';
  std::string header("\x93NUMPY\x01\0", 8);
  put(header, text.size(), 2);
  header += text;
  const std::uint64_t size = header.size() + bytes.size();
  if (size >= 0xff000000u) throw std::length_error("an array of a shard has more than 4 GB; give less --per-shard");
  auto crc = crc32_z(0, reinterpret_cast<const Bytef*>(header.data()), header.size());
  // With a null pointer, crc32_z() returns its initial value, not the sum so far.
  if (!bytes.empty()) crc = crc32_z(crc, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
  const std::string packed = deflated(header, bytes);

  // From "version needed" to "extra length"; sizes and place are in a 64-bit extra field of the
  // directory alone.
  const auto common = [&](std::string& to) {
    put(to, 45, 2);
    put(to, 0, 2);
    put(to, 8, 2);
    put(to, 0, 2);
    put(to, 1 << 5 | 1, 2);  // 1 January 1980
    put(to, crc, 4);
    put(to, packed.size(), 4);
    put(to, size, 4);
    put(to, name.size() + 4, 2);
  };
  std::string local;
  put(local, 0x04034b50, 4);
  common(local);
  put(local, 0, 2);
  local += name + ".npy";
  put(directory_, 0x02014b50, 4);
  put(directory_, 45, 2);
  common(directory_);
  put(directory_, 12, 2);
  put(directory_, 0, 6);
  put(directory_, 0, 4);
  put(directory_, 0xffffffff, 4);
  directory_ += name + ".npy";
  put(directory_, 1, 2);
  put(directory_, 8, 2);
  put(directory_, at_, 8);
  out_ << local << packed;
  at_ += local.size() + packed.size();
  ++entries_;
}

void NpzWriter::finish() {
  std::string end;
  put(end, 0x06064b50, 4);
  put(end, 44, 8);
  put(end, 45, 2);
  put(end, 45, 2);
  put(end, 0, 8);
  put(end, entries_, 8);
  put(end, entries_, 8);
  put(end, directory_.size(), 8);
  put(end, at_, 8);
  put(end, 0x07064b50, 4);
  put(end, 0, 4);
  put(end, at_ + directory_.size(), 8);
  put(end, 1, 4);
  put(end, 0x06054b50, 4);
  put(end, 0, 4);
  put(end, 0xffff, 2);
  put(end, 0xffff, 2);
  put(end, 0xffffffff, 4);
  put(end, 0xffffffff, 4);
  put(end, 0, 2);
  out_ << directory_ << end;
}

}  // namespace dataset
