#include "io/surface_file.h"

#include <algorithm>
#include <cstring>
#include <map>

#include "io/ply_internal.h"
#include "io/stream.h"
#include "io/text_internal.h"

namespace geo {
namespace {

void add_polygon(TriangleMesh& mesh, const std::vector<std::uint32_t>& polygon, const std::string& where) {
  if (polygon.size() < 3) throw InputError(where + "a face has fewer than three vertices");
  for (const auto v : polygon)
    if (v >= mesh.vertices.size())
      throw InputError(where + "a face names vertex " + std::to_string(v) + ", but there are " + std::to_string(mesh.vertices.size()));
  for (std::size_t k = 1; k + 1 < polygon.size(); ++k) mesh.triangles.push_back({polygon[0], polygon[k], polygon[k + 1]});
}

std::uint32_t row_of(double x) { return x >= 0 && x < 4294967295.0 && x == std::floor(x) ? static_cast<std::uint32_t>(x) : ~0u; }

SurfaceFile from_ply(const std::string& bytes, const std::string& name) {
  const Ply ply = parse_ply(bytes, name);
  SurfaceFile file;
  const auto *vertex = ply.find("vertex"), *face = ply.find("face");
  if (!vertex || !face) throw InputError(name + ": has no " + (vertex ? "faces; it is not a surface" : "vertices"));
  const PlyProperty* xyz[3] = {vertex->find("x"), vertex->find("y"), vertex->find("z")};
  for (const auto* p : xyz)
    if (!p || p->count_type) throw InputError(name + ": its vertices have no x, y, z");
  for (std::size_t i = 0; i < vertex->count; ++i) file.mesh.vertices.push_back({xyz[0]->values[i], xyz[1]->values[i], xyz[2]->values[i]});
  const auto* site = vertex->find("site");
  const auto* patch = face->find("patch");
  const auto* indices = face->find("vertex_indices");
  if (!indices) indices = face->find("vertex_index");
  if (!indices || !indices->count_type) throw InputError(name + ": its faces have no vertex_indices");
  if ((site && site->count_type) || (patch && patch->count_type)) throw InputError(name + ": 'site' and 'patch' must not be lists");
  const auto whole = [&](double x, const char* property) {
    if (!(std::abs(x) <= 2147483647.0) || x != std::floor(x)) throw InputError(name + ": a '" + property + "' is not an integer of 32 bits");
    return static_cast<std::int32_t>(x);
  };
  std::vector<std::uint32_t> polygon;
  for (std::size_t i = 0; i < face->count; ++i) {
    polygon.clear();
    for (auto j = i ? indices->ends[i - 1] : 0; j < indices->ends[i]; ++j) polygon.push_back(row_of(indices->values[j]));
    const std::size_t before = file.mesh.triangles.size();
    add_polygon(file.mesh, polygon, name + ": face " + std::to_string(i) + ": ");
    if (patch && site) file.mesh.patch.resize(file.mesh.patch.size() + file.mesh.triangles.size() - before, whole(patch->values[i], "patch"));
  }
  if (patch && site)
    for (const double s : site->values) {
      if (row_of(s) == ~0u) throw InputError(name + ": a site is not an id");
      file.mesh.site.push_back(row_of(s));
    }
  // Fronts: one row each, and one row for each of their points and contacts.
  const auto *fronts = ply.find("kerf_front"), *contacts = ply.find("kerf_contact");
  if (!fronts || !contacts) return file;
  const auto column = [&](const PlyElement& e, const char* property) -> const std::vector<double>& {
    const auto* p = e.find(property);
    if (!p || p->count_type) throw InputError(name + ": element '" + e.name + "' has no '" + property + "'");
    return p->values;
  };
  std::vector<std::string> names;
  for (const auto& c : ply.comments)
    if (c.rfind("kerf_front ", 0) == 0) names.push_back(c.substr(11));
  for (std::size_t i = 0; i < fronts->count; ++i) {
    FrontState f;
    f.crack = whole(column(*fronts, "crack")[i], "crack");
    f.step = static_cast<std::uint32_t>(std::max(0, whole(column(*fronts, "step")[i], "step")));
    f.closed = column(*fronts, "closed")[i] != 0;
    if (i < names.size()) f.name = names[i];
    if (f.crack < 1) throw InputError(name + ": a front has no crack");
    file.fronts.push_back(f);
  }
  const auto &front = column(*contacts, "front"), &segment = column(*contacts, "segment"), &at = column(*contacts, "site");
  const auto &x = column(*contacts, "x"), &y = column(*contacts, "y"), &z = column(*contacts, "z");
  for (std::size_t i = 0; i < contacts->count; ++i) {
    const auto f = row_of(front[i]), s = row_of(segment[i]);
    if (f >= file.fronts.size() || s > file.fronts[f].segments.size()) throw InputError(name + ": contact " + std::to_string(i) + " is out of order");
    if (!in_range({x[i], y[i], z[i]})) throw InputError(name + ": contact " + std::to_string(i) + " has a coordinate of no sensible size; repair the file");
    auto& segments = file.fronts[f].segments;
    if (s == segments.size()) segments.emplace_back();
    segments[s].push_back({{x[i], y[i], z[i]}, at[i] < 0 ? VertexId() : VertexId(row_of(at[i]))});
  }
  for (auto& f : file.fronts) {
    if (f.segments.empty()) throw InputError(name + ": a front has no contacts");
    for (std::size_t s = 0; s < f.segments.size(); ++s) {
      if (f.segments[s].size() < 2) throw InputError(name + ": a front's segment has fewer than two points");
      for (const auto& p : f.segments[s])
        if (p.id.valid() && std::find(file.mesh.site.begin(), file.mesh.site.end(), p.id.value) == file.mesh.site.end())
          throw InputError(name + ": a front's contact names a site that is not there");
      f.points.push_back(f.segments[s].front());
    }
    if (!f.closed) f.points.push_back(f.segments.back().back());
    if (f.closed && f.points.size() < 3) throw InputError(name + ": a closed front has fewer than three points");
  }
  return file;
}

TriangleMesh from_off(const std::string& bytes, const std::string& name) {
  Lines lines(bytes, name);
  std::vector<std::string_view> words;
  if (!lines.next(words)) lines.fail("is empty");
  words.erase(words.begin());
  if (words.empty() && !lines.next(words)) lines.fail("ends before its counts");
  if (words.size() < 2) lines.fail("the counts of vertices and faces are missing");
  const auto nv = lines.integer(words[0]), nf = lines.integer(words[1]);
  if (nv < 0 || nf < 0 || static_cast<std::size_t>(nv) + static_cast<std::size_t>(nf) > bytes.size()) lines.fail("the file is too short for its counts; it is truncated");
  TriangleMesh mesh;
  for (long long i = 0; i < nv; ++i) {
    if (!lines.next(words)) lines.fail("ends after " + std::to_string(i) + " of " + std::to_string(nv) + " vertices; the file is truncated");
    if (words.size() < 3) lines.fail("a vertex needs three coordinates");
    mesh.vertices.push_back({lines.real(words[0]), lines.real(words[1]), lines.real(words[2])});
  }
  std::vector<std::uint32_t> polygon;
  for (long long i = 0; i < nf; ++i) {
    if (!lines.next(words)) lines.fail("ends after " + std::to_string(i) + " of " + std::to_string(nf) + " faces; the file is truncated");
    const auto n = lines.integer(words[0]);
    if (n < 0 || static_cast<std::size_t>(n) + 1 > words.size()) lines.fail("a face has fewer vertices than it says");
    polygon.clear();
    for (long long k = 1; k <= n; ++k) polygon.push_back(row_of(static_cast<double>(lines.integer(words[static_cast<std::size_t>(k)]))));
    add_polygon(mesh, polygon, name + ": face " + std::to_string(i) + ": ");
  }
  if (lines.next(words)) lines.fail("has lines after its last face; the file is damaged");
  return mesh;
}

TriangleMesh from_obj(const std::string& bytes, const std::string& name) {
  Lines lines(bytes, name);
  std::vector<std::string_view> words;
  TriangleMesh mesh;
  std::vector<std::uint32_t> polygon;
  while (lines.next(words)) {
    if (words[0] == "v") {
      if (words.size() < 4) lines.fail("a vertex needs three coordinates");
      mesh.vertices.push_back({lines.real(words[1]), lines.real(words[2]), lines.real(words[3])});
    } else if (words[0] == "f") {
      polygon.clear();
      for (std::size_t k = 1; k < words.size(); ++k) {
        const auto i = lines.integer(words[k].substr(0, words[k].find('/')));
        polygon.push_back(row_of(static_cast<double>(i > 0 ? i - 1 : static_cast<long long>(mesh.vertices.size()) + i)));
      }
      add_polygon(mesh, polygon, name + ": ");
    }
  }
  return mesh;
}

class Welder {
 public:
  TriangleMesh mesh;
  void add(const std::array<Vec3, 3>& corners) {
    Triangle t;
    for (int k = 0; k < 3; ++k) {
      const std::array<double, 3> key{corners[k].x() + 0.0, corners[k].y() + 0.0, corners[k].z() + 0.0};
      const auto [it, fresh] = rows_.try_emplace(key, static_cast<std::uint32_t>(mesh.vertices.size()));
      if (fresh) mesh.vertices.push_back(corners[k]);
      t[k] = it->second;
    }
    mesh.triangles.push_back(t);
  }

 private:
  std::map<std::array<double, 3>, std::uint32_t> rows_;
};

TriangleMesh from_stl(const std::string& bytes, const std::string& name) {
  Welder welder;
  std::uint32_t count = 0;
  if (bytes.size() >= 84) std::memcpy(&count, bytes.data() + 80, 4);
  const bool binary = bytes.size() >= 84 && bytes.size() == 84 + 50 * static_cast<std::size_t>(count);
  if (!binary && bytes.rfind("solid", 0) != 0) throw InputError(name + ": is no surface file that is known here, or an STL file that is truncated");
  if (binary) {
    for (std::size_t t = 0; t < count; ++t) {
      float f[12];
      std::memcpy(f, bytes.data() + 84 + 50 * t, sizeof f);
      std::array<Vec3, 3> c;
      for (int k = 0; k < 3; ++k) c[k] = Vec3(f[3 + 3 * k], f[4 + 3 * k], f[5 + 3 * k]);
      for (const auto& p : c)
        if (!p.allFinite()) throw InputError(name + ": triangle " + std::to_string(t) + " has a coordinate that is not a finite number; repair the file");
      welder.add(c);
    }
    return std::move(welder.mesh);
  }
  Lines lines(bytes, name, 0);
  std::vector<std::string_view> words;
  std::vector<Vec3> corners;
  bool ended = false;
  while (lines.next(words)) {
    if (words[0] == "vertex") {
      if (words.size() != 4) lines.fail("a vertex needs three coordinates");
      corners.push_back({lines.real(words[1]), lines.real(words[2]), lines.real(words[3])});
    } else if (words[0] == "endfacet") {
      if (corners.size() != 3) lines.fail("a facet needs three vertices");
      welder.add({corners[0], corners[1], corners[2]});
      corners.clear();
    } else if (words[0] == "endsolid") {
      ended = true;
    }
  }
  if (!ended || !corners.empty()) lines.fail("ends without 'endsolid'; the file is truncated");
  return std::move(welder.mesh);
}

bool looks_like_obj(const std::string& bytes) {
  Lines lines(bytes, "");
  std::vector<std::string_view> words;
  for (int i = 0; i < 200 && lines.next(words); ++i)
    if (words[0] == "v" || words[0] == "vn" || words[0] == "f") return true;
  return false;
}

bool looks_like_off(const std::string& bytes) {
  Lines lines(std::string_view(bytes).substr(0, 4096), "");
  std::vector<std::string_view> words;
  // COFF and NOFF carry colours and normals behind the coordinates; other prefixes change what a coordinate is.
  return lines.next(words) && (words[0] == "OFF" || words[0] == "COFF" || words[0] == "NOFF" || words[0] == "CNOFF");
}

template <class T>
void put(std::string& row, T value) {
  row.append(reinterpret_cast<const char*>(&value), sizeof value);
}

}  // namespace

SurfaceFile read_surface(const std::string& path) { return parse_surface(read_all(path), path); }

SurfaceFile parse_surface(const std::string& bytes, const std::string& name) {
  SurfaceFile file;
  if (bytes.rfind("ply", 0) == 0)
    file = from_ply(bytes, name);
  else if (looks_like_off(bytes))
    file.mesh = from_off(bytes, name);
  else if (looks_like_obj(bytes))
    file.mesh = from_obj(bytes, name);
  else
    file.mesh = from_stl(bytes, name);
  if (file.mesh.triangles.empty()) throw InputError(name + ": has no triangles; give a closed triangle mesh");
  return file;
}

void write_ply(std::ostream& out, const TriangleMesh& mesh, const std::vector<FrontState>& fronts, const std::string& comment) {
  std::size_t contacts = 0;
  for (const auto& f : fronts)
    for (const auto& s : f.segments) contacts += s.size();
  out << "ply\nformat binary_little_endian 1.0\n";
  if (!comment.empty()) out << "comment " << comment << '\n';
  for (const auto& f : fronts) out << "comment kerf_front " << f.name << '\n';
  out << "element vertex " << mesh.vertices.size() << "\nproperty double x\nproperty double y\nproperty double z\n";
  if (mesh.two_sided()) out << "property uint site\n";
  out << "element face " << mesh.triangles.size() << "\nproperty list uchar uint vertex_indices\n";
  if (!mesh.patch.empty()) out << "property int patch\n";
  if (!fronts.empty())
    out << "element kerf_front " << fronts.size() << "\nproperty int crack\nproperty uint step\nproperty uchar closed\nelement kerf_contact "
        << contacts << "\nproperty uint front\nproperty uint segment\nproperty int site\nproperty double x\nproperty double y\nproperty double z\n";
  out << "end_header\n";
  std::string row;
  const auto flush = [&](bool last) {
    if (row.size() < (1 << 16) && !last) return;
    out.write(row.data(), static_cast<std::streamsize>(row.size()));
    row.clear();
  };
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    for (int c = 0; c < 3; ++c) put(row, mesh.vertices[v][c]);
    if (mesh.two_sided()) put(row, mesh.site[v]);
    flush(false);
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    put<std::uint8_t>(row, 3);
    for (const auto v : mesh.triangles[t]) put(row, v);
    if (!mesh.patch.empty()) put(row, mesh.patch[t]);
    flush(false);
  }
  for (const auto& f : fronts) put(row, f.crack), put(row, f.step), put<std::uint8_t>(row, f.closed);
  for (std::uint32_t i = 0; i < fronts.size(); ++i)
    for (std::uint32_t s = 0; s < fronts[i].segments.size(); ++s)
      for (const auto& p : fronts[i].segments[s]) {
        put(row, i), put(row, s), put<std::int32_t>(row, p.id.valid() ? static_cast<std::int32_t>(p.id.value) : -1);
        for (int c = 0; c < 3; ++c) put(row, p.position[c]);
      }
  flush(true);
}

void write_obj(std::ostream& out, const TriangleMesh& mesh) {
  out.precision(17);
  for (const auto& v : mesh.vertices) out << "v " << v.x() << ' ' << v.y() << ' ' << v.z() << '\n';
  std::map<std::int32_t, std::vector<std::size_t>> groups;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) groups[mesh.patch.empty() ? 0 : mesh.patch[t]].push_back(t);
  for (const auto& [patch, triangles] : groups) {
    if (!mesh.patch.empty()) out << "g patch_" << patch << '\n';
    for (const auto t : triangles) out << "f " << mesh.triangles[t][0] + 1 << ' ' << mesh.triangles[t][1] + 1 << ' ' << mesh.triangles[t][2] + 1 << '\n';
  }
}

}  // namespace geo
