// write_npz() of kerf/export.h. The zip format is PKWARE's APPNOTE 6.3, with the 64-bit fields of
// its § 4.5.3 in every entry; .npy is NumPy's NEP 1.
#include "base/crc32.h"
#include "io/kerf_layout.h"
#include "io/kerf_writer.h"
#include "kerf/export.h"

namespace geo {
namespace {

// Little-endian fields of fixed width, one after another.
class Fields {
 public:
  Fields& u2(std::uint64_t x) { return add(x, 2); }
  Fields& u4(std::uint64_t x) { return add(x, 4); }
  Fields& u8(std::uint64_t x) { return add(x, 8); }
  Fields& text(const std::string& s) {
    bytes += s;
    return *this;
  }
  std::string bytes;

 private:
  Fields& add(std::uint64_t x, int width) {
    for (; width-- > 0; x >>= 8) bytes += static_cast<char>(x & 255);
    return *this;
  }
};

// Header of a .npy array, padded with spaces to a multiple of 64.
std::string npy_header(const KerfFile::Section& s) {
  std::string shape;
  for (const auto d : s.shape) shape += std::to_string(d) + ",";
  std::string text = "{'descr': '" + std::string(s.dtype == "u1" ? "|" : "<") + s.dtype +
                     "', 'fortran_order': False, 'shape': (" + shape + "), }";
  text.resize(kerf::aligned(10 + text.size() + 1) - 11, ' ');
  text += '\n';
  return Fields().text("\x93NUMPY\x01").text(std::string(1, '\0')).u2(text.size()).text(text).bytes;
}

}  // namespace

void write_npz(std::ostream& out, const KerfFile& file) {
  constexpr std::uint64_t elsewhere = 0xffffffff, first_of_january_1980 = 1 << 5 | 1;
  std::uint64_t at = 0;
  std::string directory;
  std::uint64_t entries = 0;
  for (const auto& item : file.sections()) {
    const auto& [key, section] = item;
    if (kerf::size_of(section.dtype) == 0) continue;
    const bool json = section.dtype == "json";
    const std::string name = key + (json ? ".json" : ".npy"), header = json ? std::string() : npy_header(section);
    // The checksum precedes the bytes, so they are read twice.
    std::uint32_t crc = ~0u;
    const auto sum = [&](std::span<const std::byte> bytes) {
      for (const std::byte b : bytes) crc = crc32_after(crc, static_cast<std::uint8_t>(b));
    };
    const auto pass = [&](const KerfSink::Take& take) {
      KerfSink sink(take);
      sink.write(std::as_bytes(std::span(header)));
      file.stream(item.first, into(sink));
      return sink.finish();
    };
    const std::uint64_t size = pass(sum);
    const auto common = [&](Fields& f) -> Fields& {
      return f.u2(45).u2(0).u2(0).u2(0).u2(first_of_january_1980).u4(~crc).u4(elsewhere).u4(elsewhere).u2(name.size());
    };
    Fields local, central;
    common(local.u4(0x04034b50)).u2(20).text(name).u2(1).u2(16).u8(size).u8(size);
    common(central.u4(0x02014b50).u2(45))
        .u2(28)
        .u2(0)
        .u2(0)
        .u2(0)
        .u4(0)
        .u4(elsewhere)
        .text(name)
        .u2(1)
        .u2(24)
        .u8(size)
        .u8(size)
        .u8(at);
    directory += central.bytes;
    out << local.bytes;
    at += local.bytes.size() + pass([&](std::span<const std::byte> bytes) {
            out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
          });
    ++entries;
  }
  Fields end;
  end.u4(0x06064b50).u8(44).u2(45).u2(45).u4(0).u4(0).u8(entries).u8(entries).u8(directory.size()).u8(at);
  end.u4(0x07064b50).u4(0).u8(at + directory.size()).u4(1);
  end.u4(0x06054b50).u2(0).u2(0).u2(0xffff).u2(0xffff).u4(elsewhere).u4(elsewhere).u2(0);
  out << directory << end.bytes;
}

}  // namespace geo
