#include "io/run_files.h"

#include <array>
#include <charconv>

#include "base/error.h"
#include "io/node_file.h"
#include "io/ply_internal.h"

namespace geo {

void write_frame_nodes(std::ostream& out, const FrameNodes& frame) {
  const NodeSet& n = frame.nodes;
  out << "ply\nformat binary_little_endian 1.0\nelement vertex " << n.size() << '\n';
  for (const char* field : {"x", "y", "z", "radius", "spacing", "volume", "stress"}) out << "property float " << field << '\n';
  out << "end_header\n";
  std::vector<std::array<float, 7>> rows;
  for (std::size_t i = 0; i < n.size(); ++i)
    rows.push_back({float(n.position[i].x()), float(n.position[i].y()), float(n.position[i].z()), float(n.radius[i]), float(n.spacing[i]), float(n.volume[i]), float(frame.stress[i])});
  out.write(reinterpret_cast<const char*>(rows.data()), static_cast<std::streamsize>(rows.size() * sizeof rows[0]));
}

FrameNodes parse_frame_nodes(const std::string& bytes, const std::string& name) {
  if (bytes.rfind("ply", 0) != 0) throw InputError(name + ": is no PLY file, which a run's nodes are in");
  FrameNodes frame{parse_nodes(bytes, name), {}};
  const Ply ply = parse_ply(bytes, name);
  const PlyProperty* stress = ply.find("vertex")->find("stress");
  if (!stress || stress->count_type) throw InputError(name + ": has no field 'stress'; kerf-sim writes it");
  frame.stress = stress->values;
  return frame;
}

void write_pvd(std::ostream& out, const std::vector<std::string>& frames, double frame_rate) {
  out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n  <Collection>\n";
  for (std::size_t i = 0; i < frames.size(); ++i) out << "    <DataSet timestep=\"" << double(i) / frame_rate << "\" file=\"" << frames[i] << "\"/>\n";
  out << "  </Collection>\n</VTKFile>\n";
}

void write_usda(std::ostream& out, std::size_t count, const std::function<TriangleMesh(std::size_t)>& frame, double frame_rate) {
  out << "#usda 1.0\n(\n    defaultPrim = \"body\"\n    upAxis = \"Z\"\n    startTimeCode = 0\n    endTimeCode = " << (count > 0 ? count - 1 : 0)
      << "\n    timeCodesPerSecond = " << frame_rate << "\n)\n\ndef Mesh \"body\"\n{\n    uniform token subdivisionScheme = \"none\"\n";
  const auto samples = [&](const char* declaration, const auto& add) {
    out << "    " << declaration << ".timeSamples = {\n";
    std::string text;
    for (std::size_t i = 0; i < count; ++i) {
      text = "        " + std::to_string(i) + ": [";
      add(frame(i), text);
      out << text << "],\n";
    }
    out << "    }\n";
  };
  // In the shortest form that reads back the same.
  const auto number = [](auto x, std::string& text) {
    char digits[32];
    text.append(digits, std::to_chars(digits, digits + sizeof digits, x).ptr);
  };
  const auto row = [&](const auto& values, std::string& text) {
    for (int k = 0; k < 3; ++k) {
      if (k > 0) text += ", ";
      number(values[k], text);
    }
  };
  samples("int[] faceVertexCounts", [&](const TriangleMesh& m, std::string& text) {
    for (std::size_t t = 0; t < m.triangles.size(); ++t) text += t ? ", 3" : "3";
  });
  samples("int[] faceVertexIndices", [&](const TriangleMesh& m, std::string& text) {
    for (std::size_t t = 0; t < m.triangles.size(); ++t) {
      if (t > 0) text += ", ";
      row(m.triangles[t], text);
    }
  });
  samples("point3f[] points", [&](const TriangleMesh& m, std::string& text) {
    for (std::size_t v = 0; v < m.vertices.size(); ++v) {
      text += v > 0 ? ", (" : "(";
      row(Eigen::Vector3f(m.vertices[v].cast<float>()), text);
      text += ')';
    }
  });
  out << "}\n";
}

}  // namespace geo
