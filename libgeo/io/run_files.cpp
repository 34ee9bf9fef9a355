#include "io/run_files.h"

#include <cstring>

#include "base/error.h"
#include "io/json_internal.h"
#include "io/kerf_container.h"
#include "io/stream.h"

namespace geo {
namespace {

KerfSection rows_of(const std::vector<double>& values, std::uint64_t columns) {
  KerfSection s{"f8", {values.size() / columns, columns}, {}};
  s.bytes.assign(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double));
  return s;
}

std::vector<double> flat(const std::vector<Vec3>& points) {
  std::vector<double> values;
  for (const Vec3& p : points) values.insert(values.end(), {p.x(), p.y(), p.z()});
  return values;
}

}  // namespace

void write_run_state(std::ostream& out, const RunState& state) {
  KerfSections s;
  s["motion/displacement"] = rows_of(flat(state.motion.displacement), 3);
  s["motion/velocity"] = rows_of(flat(state.motion.velocity), 3);
  nlohmann::ordered_json about = {{"frame", state.frame}, {"fronts", nlohmann::ordered_json::array()}};
  std::vector<double> points;
  const auto written = [&](const FrontState& front) {
    nlohmann::ordered_json segments = nlohmann::ordered_json::array();
    for (const auto& segment : front.segments) {
      nlohmann::ordered_json ids = nlohmann::ordered_json::array();
      for (const auto& p : segment) {
        ids.push_back(p.id.valid() ? static_cast<std::int64_t>(p.id.value) : -1);
        points.insert(points.end(), {p.position.x(), p.position.y(), p.position.z()});
      }
      segments.push_back(ids);
    }
    return nlohmann::ordered_json{{"name", front.name}, {"closed", front.closed}, {"crack", front.crack}, {"step", front.step}, {"segments", segments}};
  };
  for (const auto& front : state.fronts) about["fronts"].push_back(front ? written(*front) : nlohmann::ordered_json(nullptr));
  about["cracks"] = state.fracture.cracks;
  about["growing"] = nlohmann::ordered_json::array();
  std::vector<double> normals, owed;  // rows of normals; rows (owed, ended, the front's length)
  for (const auto& g : state.fracture.fronts) {
    about["growing"].push_back(written(g.front));
    for (std::size_t i = 0; i < g.size(); ++i) {
      normals.insert(normals.end(), {g.normal[i].x(), g.normal[i].y(), g.normal[i].z()});
      owed.insert(owed.end(), {g.owed[i], double(g.ended[i]), g.length});
    }
  }
  s["fronts/normals"] = rows_of(normals, 3);
  s["fronts/owed"] = rows_of(owed, 3);
  s["fronts/points"] = rows_of(points, 3);
  const auto time = std::vector<double>{state.time, 0, 0};
  s["time"] = rows_of(time, 3);
  const std::string text = about.dump();
  s["about"] = {"json", {text.size()}, text};
  write_kerf(out, s);
}

RunState read_run_state(const std::string& path) { return parse_run_state(read_all(path), path); }

RunState parse_run_state(const std::string& bytes, const std::string& name) {
  const KerfSections sections = parse_kerf(bytes, name);
  const auto fail = [&]() -> void { throw InputError(name + ": is not a run's checkpoint, or is damaged"); };
  const auto points = [&](const std::string& section) {
    const auto it = sections.find(section);
    if (it == sections.end() || it->second.dtype != "f8" || it->second.shape.size() != 2 || it->second.shape[1] != 3) fail();
    std::vector<Vec3> result(it->second.bytes.size() / 24);
    for (std::size_t i = 0; i < result.size(); ++i) std::memcpy(result[i].data(), it->second.bytes.data() + 24 * i, 24);
    for (const auto& p : result)
      if (!in_range(p)) fail();
    return result;
  };
  RunState state;
  state.motion.displacement = points("motion/displacement");
  state.motion.velocity = points("motion/velocity");
  const auto time = points("time");
  const auto places = points("fronts/points"), normals = points("fronts/normals"), owed = points("fronts/owed");
  if (time.size() != 1) fail();
  state.time = time[0].x();
  const auto about_section = sections.find("about");
  if (about_section == sections.end()) fail();
  const auto about = nlohmann::json::parse(about_section->second.bytes, nullptr, false);
  std::size_t at = 0;
  try {
    state.frame = whole<int>(about.at("frame"));
    const auto read = [&](const nlohmann::json& f) {
      FrontState front;
      front.name = f.at("name").get<std::string>(), front.closed = f.at("closed").get<bool>();
      front.crack = whole<std::int32_t>(f.at("crack")), front.step = whole<std::uint32_t>(f.at("step"));
      for (const auto& segment : f.at("segments")) {
        front.segments.emplace_back();
        for (const auto& id : segment) {
          if (at >= places.size()) fail();
          const auto v = whole<std::int64_t>(id);
          front.segments.back().push_back({places[at++], v < 0 || v > ~0u ? VertexId() : VertexId(static_cast<std::uint32_t>(v))});
        }
        if (front.segments.back().size() < 2) fail();
        front.points.push_back(front.segments.back().front());
      }
      if (front.segments.empty()) fail();
      if (!front.closed) front.points.push_back(front.segments.back().back());
      return front;
    };
    for (const auto& f : about.at("fronts")) {
      state.fronts.emplace_back();
      if (!f.is_null()) state.fronts.back() = read(f);
    }
    state.fracture.cracks = whole<std::int32_t>(about.at("cracks"));
    std::size_t row = 0;
    for (const auto& f : about.at("growing")) {
      FrontState front = read(f);
      const std::size_t n = front.points.size();
      if (row + n > normals.size() || row + n > owed.size()) fail();
      GrowingFront g = growing(std::move(front), {normals.begin() + std::ptrdiff_t(row), normals.begin() + std::ptrdiff_t(row + n)});
      for (std::size_t i = 0; i < n; ++i) g.owed[i] = owed[row + i].x(), g.ended[i] = owed[row + i].y() != 0, g.length = owed[row + i].z();
      state.fracture.fronts.push_back(std::move(g));
      row += n;
    }
  } catch (const nlohmann::json::exception&) {
    fail();
  } catch (const std::out_of_range&) {
    fail();
  }
  return state;
}

void write_pvd(std::ostream& out, const std::vector<std::string>& frames, double frame_rate) {
  out << "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n  <Collection>\n";
  for (std::size_t i = 0; i < frames.size(); ++i) out << "    <DataSet timestep=\"" << double(i) / frame_rate << "\" file=\"" << frames[i] << "\"/>\n";
  out << "  </Collection>\n</VTKFile>\n";
}

void write_usda(std::ostream& out, const std::vector<TriangleMesh>& frames, double frame_rate) {
  out << "#usda 1.0\n(\n    defaultPrim = \"body\"\n    upAxis = \"Z\"\n    startTimeCode = 0\n    endTimeCode = " << (frames.empty() ? 0 : frames.size() - 1)
      << "\n    timeCodesPerSecond = " << frame_rate << "\n)\n\ndef Mesh \"body\"\n{\n    uniform token subdivisionScheme = \"none\"\n";
  out.precision(9);
  const auto samples = [&](const char* declaration, const auto& write) {
    out << "    " << declaration << ".timeSamples = {\n";
    for (std::size_t i = 0; i < frames.size(); ++i) {
      out << "        " << i << ": [";
      write(frames[i]);
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
