// write_stl() and write_off() of kerf/files.h. STL as by 3D Systems (1989), little-endian; OFF as
// by Geomview.
#include <array>
#include <cstring>
#include <string>

#include "base/number_text.h"
#include "kerf/files.h"

namespace geo {
namespace {

// Appends the shortest text from which a number returns to the bit.
void append(std::string& text, double number) {
  std::array<char, 32> digits;
  text.append(digits.data(), write_number(digits.data(), number));
}

}  // namespace

void write_stl(std::ostream& out, const TriangleMesh& mesh) {
  std::string header = "binary STL";
  header.resize(80, ' ');
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  header.append(reinterpret_cast<const char*>(&count), 4);
  out << header;
  std::array<char, 50> record{};  // the last two bytes are attributes, of which there are none
  for (const auto& corners : corners_of(mesh)) {
    const Vec3 normal = face_normal(corners[0], corners[1], corners[2]);
    std::size_t at = 0;
    for (const Vec3& v : {normal, corners[0], corners[1], corners[2]})
      for (int axis = 0; axis < 3; ++axis, at += 4) {
        const auto value = static_cast<float>(v[axis]);
        std::memcpy(record.data() + at, &value, 4);
      }
    out.write(record.data(), record.size());
  }
}

void write_off(std::ostream& out, const TriangleMesh& mesh) {
  out << "OFF\n" << mesh.vertices.size() << ' ' << mesh.triangles.size() << " 0\n";
  for (const Vec3& p : mesh.vertices) {
    std::string line;
    for (int axis = 0; axis < 3; ++axis) {
      append(line, p[axis]);
      line += axis < 2 ? ' ' : '\n';
    }
    out << line;
  }
  for (const auto& [a, b, c] : mesh.triangles) out << "3 " << a << ' ' << b << ' ' << c << '\n';
}

}  // namespace geo
