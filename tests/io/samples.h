// Small valid files of every kind, made in this process: what fuzzing starts from.
#pragma once

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "kerf/body.h"
#include "kerf/body_file.h"
#include "kerf/files.h"
#include "kerf/mesh.h"
#include "kerf/nodes.h"

template <class Write>
std::string bytes_of(const Write& write) {
  std::ostringstream out;
  write(out);
  return out.str();
}

/// A PLY in any of the three formats, with all that write_ply writes.
class PlyText {
 public:
  enum Format { ascii, little, big };
  static std::string of(Format format, const geo::TriangleMesh& mesh, const std::vector<geo::FrontState>& fronts = {}) {
    PlyText p(format);
    std::string header = bytes_of([&](auto& out) { geo::write_ply(out, mesh, fronts); });
    header.resize(header.find("end_header\n") + 11);
    const std::string written = "binary_little_endian";
    p.out_ = header.replace(header.find(written), written.size(),
                            format == ascii ? "ascii"
                            : format == big ? "binary_big_endian"
                                            : written);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
      p.point(mesh.vertices[v]);
      if (mesh.two_sided()) p.put(mesh.site[v]);
      p.end();
    }
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      p.put<std::uint8_t>(3);
      for (const auto v : mesh.triangles[t]) p.put(v);
      if (!mesh.patch.empty()) p.put(mesh.patch[t]);
      if (!mesh.source.empty()) p.put(mesh.source[t]);
      p.end();
    }
    for (const auto& f : fronts) {
      p.put(f.crack);
      p.put(f.step);
      p.put<std::uint8_t>(f.closed);
      p.end();
    }
    for (std::uint32_t i = 0; i < fronts.size(); ++i)
      for (std::uint32_t s = 0; s < fronts[i].segments.size(); ++s)
        for (const auto& q : fronts[i].segments[s]) {
          p.put(i);
          p.put(s);
          p.put(static_cast<std::int32_t>(q.id.value));
          p.point(q.position);
          p.end();
        }
    return p.out_;
  }

 private:
  explicit PlyText(Format format) : format_(format) {}
  template <class T>
  void put(T value) {
    if (format_ == ascii) {
      std::ostringstream text;
      text.precision(17);
      text << +value << ' ';
      out_ += text.str();
      return;
    }
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    if (format_ == big) std::reverse(raw, raw + sizeof value);
    out_.append(raw, sizeof value);
  }
  void point(const geo::Vec3& p) {
    put(p.x());
    put(p.y());
    put(p.z());
  }
  void end() {
    if (format_ == ascii) out_ += '\n';
  }
  Format format_;
  std::string out_;
};

struct CutSurface {
  geo::Complex complex;
  std::vector<geo::FrontState> fronts;
};

/// A block that one crack halves and another has begun to cut across it.
inline CutSurface cut_block() {
  using geo::Vec3;
  CutSurface cut{geo::Complex::from_skin(geo::make_block({4, 4, 4}, 2)), {}};
  geo::FrontState a = geo::begin_front(std::vector<Vec3>{{-1, -1, 1.3}, {-1, 5, 1.3}}, false, 1);
  a.name = "halve";
  geo::advance(cut.complex, a, std::vector<Vec3>{{5, -1, 1.4}, {5, 5, 1.3}});
  geo::FrontState b = geo::begin_front(std::vector<Vec3>{{1.2, -1, -1}, {1.2, 2, -1}, {1.2, 5, -1}}, false, 2);
  b.name = "across";
  geo::advance(cut.complex, b, std::vector<Vec3>{{1.2, -1, 2.1}, {1.3, 2, 2.2}, {1.2, 5, 2.1}});
  cut.fronts = {a, b};
  return cut;
}

inline std::vector<std::string> sample_surfaces() {
  const geo::TriangleMesh block = geo::make_block({2, 2, 2}, 1), ball = geo::make_sphere(1);
  const CutSurface cut = cut_block();
  const geo::TriangleMesh sides = cut.complex.two_sided();
  std::ostringstream off, stl;
  off << "OFF\n" << ball.vertices.size() << ' ' << ball.triangles.size() << " 0\n";
  for (const auto& v : ball.vertices) off << v.x() << ' ' << v.y() << ' ' << v.z() << '\n';
  for (const auto& t : ball.triangles) off << "3 " << t[0] << ' ' << t[1] << ' ' << t[2] << '\n';
  std::string binary(80, ' ');
  const auto append = [&](auto value) { binary.append(reinterpret_cast<const char*>(&value), sizeof value); };
  append(static_cast<std::uint32_t>(ball.triangles.size()));
  stl << "solid ball\n";
  for (const auto& t : ball.triangles) {
    stl << "facet normal 0 0 0\nouter loop\n";
    for (int i = 0; i < 3; ++i) append(0.0f);
    for (const auto v : t) {
      stl << "vertex " << ball.vertices[v].x() << ' ' << ball.vertices[v].y() << ' ' << ball.vertices[v].z() << '\n';
      for (int i = 0; i < 3; ++i) append(static_cast<float>(ball.vertices[v][i]));
    }
    append(std::uint16_t(0));
    stl << "endloop\nendfacet\n";
  }
  stl << "endsolid ball\n";
  return {PlyText::of(PlyText::ascii, block),
          PlyText::of(PlyText::little, ball),
          PlyText::of(PlyText::big, block),
          bytes_of([&](auto& out) { geo::write_obj(out, ball); }),
          off.str(),
          stl.str(),
          binary,
          PlyText::of(PlyText::ascii, sides, cut.fronts),
          PlyText::of(PlyText::little, sides, cut.fronts),
          PlyText::of(PlyText::big, sides, cut.fronts)};
}

inline std::vector<std::string> sample_fronts() {
  return {
      "# two fronts\nfront knife\nstep 0\n-1 -1 1.3\n-1 5 1.3\nstep 1\n2 -1 1.4\n2 5 1.3\nstep 2\n5 -1 1.5\n5 5 1.3\n"
      "front ring closed\nstep 0\n1 1 -1\n3 1 -1\n2 3 -1\nstep 0.5\n1 1 5\n3 1 5\n2 3 5\n2 2 5\n",
      "sheet two\nv -1 -1 1.3\nv 5 -1 1.4\nv 5 5 1.3\nf 1 2 3\nv -1 5 1.2\nf 1 3 4\nfront a\nstep 0\n1.1 -1 -1\n1.1 -1 "
      "5\nstep 1\n1.1 5 -1\n1.2 5 5\n",
      "v -1 -1 1.3\nv -1 5 1.3\nv 2 -1 1.4\nv 2 5 1.3\no step1\nl 1 2\no step2\nl 3 -1\n",
      "o a\nv 1 1 -1\nv 3 1 -1\nv 2 3 -1\nl 1 2 3 1\no b\nv 1 1 5\nv 3 1 5\nv 2 3 5\nl 4/1 5/2 6 4\n"};
}

inline geo::Body cut_body() {
  const geo::TriangleMesh mesh = geo::make_block({1, 1, 1}, 0.5);
  geo::SampleOptions options;
  options.spacing = 0.3;
  geo::BodyOptions guided;
  guided.guide_spacing = 0.5;
  geo::Body body = geo::build_body(geo::Complex::from_skin(mesh), geo::sample_nodes(mesh, options), guided);
  body.history.push_back({"kerf-graph", "0.1.0", "block.ply", {"block.ply xxh3:0011223344556677"}});
  geo::FrontState front = geo::begin_front(std::vector<geo::Vec3>{{-0.5, -0.5, 0.512}, {-0.5, 1.5, 0.52}}, false, 1);
  geo::split(body, front, {{0.6, -0.5, 0.53}, {0.61, 1.5, 0.5}});
  return body;
}

/// A body as it was built, whole, and the same with a cut appended.
struct BodyFiles {
  std::string whole, appended;
};
inline BodyFiles sample_body_files() {
  geo::Body body = cut_body();
  BodyFiles files;
  files.whole = bytes_of([&](auto& out) { geo::write_body(out, body); });
  const std::string path =
      (std::filesystem::temp_directory_path() / ("kerf-sample-" + std::to_string(std::random_device{}()) + ".kerf"))
          .string();
  geo::write_all(path, [&](std::ostream& out) { out << files.whole; });
  geo::FrontState front = geo::begin_front(std::vector<geo::Vec3>{{0.512, -0.5, -0.5}, {0.52, 1.5, -0.5}}, false, 2);
  geo::split(body, front, {{0.53, -0.5, 0.3}, {0.5, 1.5, 0.31}});
  {
    geo::KerfUpdate update(path);
    geo::write_body(update, body);
  }
  files.appended = geo::read_all(path);
  std::filesystem::remove(path);
  return files;
}

inline std::vector<std::string> sample_nodes_files(const geo::NodeSet& nodes) {
  std::ostringstream pcd, ply;
  pcd << "VERSION 0.7\nFIELDS x y z radius spacing volume\nSIZE 4 4 4 4 4 8\nTYPE F F F F F F\nWIDTH " << nodes.size()
      << "\nHEIGHT 1\nPOINTS " << nodes.size() << "\nDATA ascii\n";
  ply << "ply\nformat ascii 1.0\nelement vertex " << nodes.size() << '\n';
  for (const char* field : {"x", "y", "z", "radius", "spacing", "volume"}) ply << "property double " << field << '\n';
  ply << "end_header\n";
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (auto* out : {&pcd, &ply})
      *out << nodes.position[i].x() << ' ' << nodes.position[i].y() << ' ' << nodes.position[i].z() << ' '
           << nodes.radius[i] << ' ' << nodes.spacing[i] << ' ' << nodes.volume[i] << '\n';
  return {bytes_of([&](auto& out) { geo::write_pcd(out, nodes); }),
          bytes_of([&](auto& out) { geo::write_nodes_ply(out, nodes); }), pcd.str(), ply.str()};
}

inline std::vector<std::string> sample_scenes() {
  return {
      "gravity = [0, 0, -9.81]\n[body]\nmesh = \"block.ply\"\nspacing_percent = 5.0\nlevels = 2\nk = 26\nvelocity = "
      "[0, 0, 1]\n"
      "fixed = [[0, 0, 0, 1, 1, 0.1]]\n[material]\nmodel = \"stvk\"\nyoung = 1e5\npoisson = 0.3\ndensity = "
      "1000\n[ground]\npoint = [0, 0, -1]\n"
      "normal = [0, 0, 1]\nfriction = 0.5\n[time]\nframes = 4\nframe_rate = 24\nstep = 0.01\nintegrator = "
      "\"leapfrog\"\nseed = 3\n"
      "[[blade]]\nname = \"knife\"\npoints = [[0, 0, 0], [0, 1, 0]]\ndivide = 4\nkeys = [[0, -1, 0, 0, 0, 0, 1, 0], "
      "[1, 1, 0, 0, 0, 0, 1, 45]]\n",
      "[body]\nmesh = 'a.off'\nnodes = 500\n[[blade]]\nclosed = true\npoints = [[0, 0, 0], [0, 1, 0], [1, 1, 0]]\n"
      "keys = [[0.5, 0, 0, -1, 0, 0, 1, 0], [1.5, 0, 0, 1, 0, 1, 0, 360]] # ring\n"
      "[[obstacle]]\nnormal = [0, 0.1, 1]\nposition = [0, 0, -1]\nfriction = 0.4\nkeys = [[0, 0, 0, 0, 0, 0, 1, "
      "0]]\n[contact]\nbodies = true\nstiffness = 1e4\n"};
}

inline std::string sample_checkpoint(const geo::Body& body) {
  geo::RunState state;
  state.motion.displacement.assign(body.nodes.size(), {0.1, 0, 0});
  state.motion.velocity.assign(body.nodes.size(), {0, 0, 1});
  state.body_index.assign(body.nodes.size(), 0);
  const geo::FrontState front = cut_block().fronts[1];
  state.fronts = {{}, {{front, std::vector<double>(front.points.size(), 0.5)}}};
  state.time = 0.5;
  state.frame = 12;
  return bytes_of([&](auto& out) { geo::write_checkpoint(out, body, state, 7); });
}
