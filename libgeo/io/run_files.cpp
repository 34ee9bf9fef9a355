// write_frame_nodes() of kerf/files.h, write_series() of kerf/export.h. Nodes of a frame are binary
// PLY in single precision, far from the origin with positions in double precision; a series is the
// JSON that ParaView reads (.series).
#include "kerf/export.h"
#include "kerf/files.h"

#include <cmath>
#include <string>

#include "io/ply.h"
#include "kerf/error.h"

namespace geo {

void write_frame_nodes(std::ostream& out, const FrameNodes& frame) {
  const NodeSet& n = frame.nodes;
  Box3 box;
  for (const Vec3& p : n.position) box.add(p);
  const bool far = !single_precision_offset(box).isZero(0);
  out << "ply\nformat binary_little_endian 1.0\nelement vertex " << n.size() << '\n';
  for (const char* field : {"x", "y", "z"}) out << "property " << (far ? "double " : "float ") << field << '\n';
  for (const char* field : {"radius", "spacing", "volume", "stress"}) out << "property float " << field << '\n';
  out << "end_header\n";
  std::string rows;
  const auto put = [&](auto x) { rows.append(reinterpret_cast<const char*>(&x), sizeof x); };
  for (std::size_t i = 0; i < n.size(); ++i) {
    for (const double x : n.position[i]) far ? put(x) : put(float(x));
    for (const double x : {n.radius[i], n.spacing[i], n.volume[i], frame.stress[i]}) put(float(x));
  }
  out.write(rows.data(), static_cast<std::streamsize>(rows.size()));
}

FrameNodes parse_frame_nodes(const std::string& bytes, const std::string& name) {
  if (bytes.rfind("ply", 0) != 0) throw InputError(name + ": is no PLY file, which a run's nodes are in");
  FrameNodes frame{parse_nodes(bytes, name), {}};
  const Ply ply = parse_ply(bytes, name);
  require_no_rest(ply, name);
  const PlyProperty* stress = ply.find("vertex")->find("stress");
  if (!stress || stress->count_type) throw InputError(name + ": has no field 'stress'; kerf-sim writes it");
  for (const double s : stress->values)
    if (!std::isfinite(s)) throw InputError(name + ": a stress is not a finite number; repair the file");
  frame.stress = stress->values;
  return frame;
}

void write_series(std::ostream& out, const std::vector<std::string>& frames, double frame_rate) {
  out << "{\n  \"file-series-version\": \"1.0\",\n  \"files\": [\n";
  for (std::size_t i = 0; i < frames.size(); ++i)
    out << "    {\"name\": \"" << frames[i] << "\", \"time\": " << double(i) / frame_rate
        << (i + 1 < frames.size() ? "},\n" : "}\n");
  out << "  ]\n}\n";
}

}  // namespace geo
