#include "io/run_files.h"

namespace geo {

void write_pvd(std::ostream& out, const std::vector<std::string>& frames, double frame_rate) {
  out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n  <Collection>\n";
  for (std::size_t i = 0; i < frames.size(); ++i) out << "    <DataSet timestep=\"" << double(i) / frame_rate << "\" file=\"" << frames[i] << "\"/>\n";
  out << "  </Collection>\n</VTKFile>\n";
}

void write_usda(std::ostream& out, std::size_t count, const std::function<TriangleMesh(std::size_t)>& frame, double frame_rate) {
  out << "#usda 1.0\n(\n    defaultPrim = \"body\"\n    upAxis = \"Z\"\n    startTimeCode = 0\n    endTimeCode = " << (count > 0 ? count - 1 : 0)
      << "\n    timeCodesPerSecond = " << frame_rate << "\n)\n\ndef Mesh \"body\"\n{\n    uniform token subdivisionScheme = \"none\"\n";
  out.precision(9);
  const auto samples = [&](const char* declaration, const auto& write) {
    out << "    " << declaration << ".timeSamples = {\n";
    for (std::size_t i = 0; i < count; ++i) {
      out << "        " << i << ": [";
      write(frame(i));
      out << "],\n";
    }
    out << "    }\n";
  };
  samples("int[] faceVertexCounts", [&](const TriangleMesh& m) {
    for (std::size_t t = 0; t < m.triangles.size(); ++t) out << (t ? ", 3" : "3");
  });
  samples("int[] faceVertexIndices", [&](const TriangleMesh& m) {
    for (std::size_t t = 0; t < m.triangles.size(); ++t) out << (t ? ", " : "") << m.triangles[t][0] << ", " << m.triangles[t][1] << ", " << m.triangles[t][2];
  });
  samples("point3f[] points", [&](const TriangleMesh& m) {
    for (std::size_t v = 0; v < m.vertices.size(); ++v) out << (v ? ", (" : "(") << float(m.vertices[v].x()) << ", " << float(m.vertices[v].y()) << ", " << float(m.vertices[v].z()) << ")";
  });
  out << "}\n";
}

}  // namespace geo
