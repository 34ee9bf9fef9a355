// parse_surface_ply() of io/surface_formats.h. Reading a surface from PLY: cut or plain, with its
// attributes and fronts.
#include <algorithm>
#include <initializer_list>
#include <map>

#include "io/line_reader.h"
#include "io/ply.h"
#include "io/surface_formats.h"

namespace geo {
namespace {

// The face that a triangle is a part of, and the triangle's corners among the face's.
struct Part {
  std::uint32_t face;
  std::array<std::uint32_t, 3> corner;
};

// The properties of these names where the element has all of them and none is a list; else empty.
std::vector<const PlyProperty*> scalars(const PlyElement& e, std::initializer_list<const char*> names) {
  std::vector<const PlyProperty*> found;
  for (const auto* name : names)
    if (const auto* p = e.find(name); p && !p->count_type) found.push_back(p);
  if (found.size() != names.size()) found.clear();
  return found;
}

const PlyProperty* integers(const PlyElement& e, const char* name) {
  const auto* p = e.find(name);
  return p && !p->count_type && p->type != 'f' && p->type != 'd' ? p : nullptr;
}

// Value of full intensity in colours of this type.
double full(char type) { return type == 'f' || type == 'd' ? 1 : type == 'S' ? 65535 : 255; }

template <class V>
std::vector<V> rows_of(const std::vector<const PlyProperty*>& columns, std::size_t count) {
  std::vector<V> rows(columns.empty() ? 0 : count);
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (std::size_t k = 0; k < columns.size(); ++k) rows[i][static_cast<int>(k)] = columns[k]->values[i];
  return rows;
}

std::vector<Color> colors_of(const PlyElement& e) {
  const auto columns = scalars(e, {"red", "green", "blue"}), alpha = scalars(e, {"alpha"});
  std::vector<Color> rows(columns.empty() ? 0 : e.count, Color::Ones());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (int k = 0; k < 3; ++k)
      rows[i][k] = columns[static_cast<std::size_t>(k)]->values[i] / full(columns[static_cast<std::size_t>(k)]->type);
    if (!alpha.empty()) rows[i][3] = alpha[0]->values[i] / full(alpha[0]->type);
  }
  return rows;
}

class Reader {
 public:
  Reader(const Ply& ply, const std::string& name) : ply_(ply), name_(name) {
    vertex_ = ply.find("vertex");
    face_ = ply.find("face");
    if (const PlyElement* strips = ply.find("tristrips")) read_strips(*strips);
    if (!vertex_ || !face_)
      throw InputError(name + ": has no " + (vertex_ ? "faces; it is not a surface" : "vertices"));
  }

  SurfaceFile read() {
    shape();
    rest();
    attributes();
    groups();
    unit();
    library();
    fronts();
    return std::move(file_);
  }

 private:
  TriangleMesh& mesh() { return file_.mesh; }

  static const PlyProperty* indices_of(const PlyElement& element) {
    const PlyProperty* indices = element.find("vertex_indices");
    if (!indices) indices = element.find("vertex_index");
    return indices && indices->count_type ? indices : nullptr;
  }

  // Makes faces of triangle strips, behind the faces that there are. A negative index ends a strip.
  // Each second triangle has its first two corners exchanged, and one with two equal corners only
  // joins strips.
  void read_strips(const PlyElement& strips) {
    const PlyProperty* from = indices_of(strips);
    if (!from) throw InputError(name_ + ": its tristrips have no vertex_indices");
    PlyProperty to{.name = "vertex_indices", .type = 'I', .count_type = 'C', .values = {}, .ends = {}};
    if (face_) {
      const PlyProperty* faces = indices_of(*face_);
      if (!faces) throw InputError(name_ + ": its faces have no vertex_indices");
      to.values = faces->values;
      to.ends = faces->ends;
      if (face_->properties.size() > 1)
        add_left_out(file_.notes, {"properties of faces, as triangle strips have none"});
    }
    for (std::size_t s = 0; s < strips.count; ++s) {
      std::size_t first = s > 0 ? from->ends[s - 1] : 0;
      for (std::size_t i = first; i < from->ends[s]; ++i) {
        if (from->values[i] < 0) {
          first = i + 1;
          continue;
        }
        if (i < first + 2) continue;
        const double a = from->values[i - 2], b = from->values[i - 1], c = from->values[i];
        if (a == b || b == c || c == a) continue;
        const bool odd = (i - first) % 2 == 1;
        to.values.insert(to.values.end(), {odd ? b : a, odd ? a : b, c});
        to.ends.push_back(static_cast<std::uint32_t>(to.values.size()));
      }
    }
    strip_faces_.name = "face";
    strip_faces_.count = to.ends.size();
    strip_faces_.properties.push_back(std::move(to));
    face_ = &strip_faces_;
  }

  // Notes of what no part of this reader reads.
  void rest() {
    static constexpr std::string_view elements[] = {"vertex",     "face",         "tristrips",
                                                    "kerf_front", "kerf_contact", "kerf_library"};
    static constexpr std::string_view at_vertices[] = {"x",   "y",     "z",         "nx",        "ny",  "nz",
                                                       "red", "green", "blue",      "alpha",     "s",   "t",
                                                       "u",   "v",     "texture_u", "texture_v", "site"};
    static constexpr std::string_view at_faces[] = {"vertex_indices", "vertex_index", "patch",  "source", "group",
                                                    "texcoord",       "texcoord2",    "normal", "color",  "red",
                                                    "green",          "blue",         "alpha"};
    const auto known = [](const auto& names, std::string_view name) {
      return std::find(std::begin(names), std::end(names), name) != std::end(names);
    };
    std::vector<std::string> things;
    for (const PlyElement& e : ply_.elements)
      if (!known(elements, e.name) && e.count > 0) things.push_back("element '" + shown(e.name, 40) + "'");
    for (const PlyProperty& p : vertex_->properties)
      if (!known(at_vertices, p.name)) things.push_back("'" + shown(p.name, 40) + "' of vertices");
    for (const PlyProperty& p : face_->properties)
      if (!known(at_faces, p.name)) things.push_back("'" + shown(p.name, 40) + "' of faces");
    constexpr std::size_t most = 8;  // things that a line names
    for (const std::string& c : ply_.comments)
      if (c.starts_with("TextureFile ")) things.push_back("texture '" + shown(c.substr(12), 40) + "'");
    if (things.size() > most) {
      things.resize(most);
      things.push_back("and more");
    }
    add_left_out(file_.notes, things);
    if (!ply_.has_rest) return;
    if (mesh().two_sided()) require_no_rest(ply_, name_);
    file_.notes.push_back("what follows its last element is left out");
  }

  std::int32_t whole(double x, const char* property) const {
    if (!(std::abs(x) <= 2147483647.0) || x != static_cast<std::int32_t>(x))
      throw InputError(name_ + ": a '" + property + "' is not an integer of 32 bits");
    return static_cast<std::int32_t>(x);
  }

  void shape() {
    const auto xyz = scalars(*vertex_, {"x", "y", "z"});
    if (xyz.empty()) throw InputError(name_ + ": its vertices have no x, y, z");
    mesh().vertices = rows_of<Vec3>(xyz, vertex_->count);
    const auto* site = vertex_->find("site");
    patch_ = face_->find("patch");
    indices_ = indices_of(*face_);
    if (!indices_) throw InputError(name_ + ": its faces have no vertex_indices");
    if ((site && site->count_type) || (patch_ && patch_->count_type))
      throw InputError(name_ + ": 'site' and 'patch' must not be lists");
    parts_.reserve(face_->count);
    mesh().triangles.reserve(face_->count);
    std::vector<std::uint32_t> polygon;
    const auto vertices = static_cast<std::uint32_t>(mesh().vertices.size());
    for (std::uint32_t i = 0; i < face_->count; ++i) {
      const auto begin = i ? indices_->ends[i - 1] : 0, end = indices_->ends[i];
      if (end - begin == 3) {
        const Triangle t{row_of(indices_->values[begin]), row_of(indices_->values[begin + 1]),
                         row_of(indices_->values[begin + 2])};
        if (std::max({t[0], t[1], t[2]}) < vertices) {
          mesh().triangles.push_back(t);
          parts_.push_back({i, {0, 1, 2}});
          continue;
        }
      }
      polygon.clear();
      for (auto j = begin; j < end; ++j) polygon.push_back(row_of(indices_->values[j]));
      for (const auto& corner : add_polygon(mesh(), polygon, name_ + ": face " + std::to_string(i) + ": "))
        parts_.push_back({i, corner});
    }
    if (patch_ && site) {
      mesh().patch.reserve(parts_.size());
      mesh().site.reserve(vertices);
      for (const Part& part : parts_) mesh().patch.push_back(whole(patch_->values[part.face], "patch"));
      for (const double s : site->values) {
        if (row_of(s) == ~0u) throw InputError(name_ + ": a site is not an id");
        mesh().site.push_back(row_of(s));
      }
    }
    if (const auto* source = integers(*face_, "source")) {
      mesh().source.reserve(parts_.size());
      for (const Part& part : parts_) mesh().source.push_back(row_of(source->values[part.face]));
    }
  }

  // Values of corners: from the face's list; without one, that of the face (`at_face`), else that
  // of the vertex. `fallback` gives the value on cracks, and where a number is not finite.
  template <class V, class Fallback>
  void fill(std::vector<std::array<V, 3>>& out, const char* list_name, const std::vector<V>& at_face,
            const std::vector<V>& at_vertex, const Fallback& fallback) {
    constexpr std::uint32_t size = V::SizeAtCompileTime;
    const auto* list = face_->find(list_name);
    if (list && !list->count_type) list = nullptr;
    if (!list && at_face.empty() && at_vertex.empty()) return;
    if (list)
      for (std::size_t i = 0; i < face_->count; ++i) {
        const auto begin = i ? list->ends[i - 1] : 0, first = i ? indices_->ends[i - 1] : 0;
        const auto corners = indices_->ends[i] - first, given = list->ends[i] - begin;
        if (given != size * corners)
          throw InputError(name_ + ": face " + std::to_string(i) + ": its list '" + list_name + "' has " +
                           std::to_string(given) + " numbers, but its " + std::to_string(corners) + " corners need " +
                           std::to_string(size * corners));
      }
    const double scale = list && size == 4 ? full(list->type) : 1;
    for (std::size_t t = 0; t < parts_.size(); ++t) {
      const auto& [face, corner] = parts_[t];
      std::array<V, 3> row;
      for (int k = 0; k < 3; ++k) {
        if (list)
          for (std::uint32_t c = 0; c < size; ++c)
            row[k][c] = list->values[(face ? list->ends[face - 1] : 0) + size * corner[k] + c] / scale;
        else if (!at_face.empty())
          row[k] = at_face[face];
        else if (patch_ && patch_->values[face] != 0)
          row[k] = fallback(t);
        else
          row[k] = at_vertex[mesh().triangles[t][k]];
      }
      for (int k = 0; k < 3; ++k)
        if (size != 2 && !row[k].allFinite()) row[k] = fallback(t);  // parse_surface() tells of others
      out.push_back(row);
    }
  }

  void attributes() {
    Attributes& a = mesh().attributes;
    auto uv = scalars(*vertex_, {"s", "t"});
    if (uv.empty()) uv = scalars(*vertex_, {"u", "v"});
    if (uv.empty()) uv = scalars(*vertex_, {"texture_u", "texture_v"});
    const auto at_vertex = colors_of(*vertex_);
    fill<Vec2>(a.uv, "texcoord", {}, rows_of<Vec2>(uv, vertex_->count), [](std::size_t) { return Vec2(Vec2::Zero()); });
    fill<Vec2>(a.uv2, "texcoord2", {}, {}, [](std::size_t) { return Vec2(Vec2::Zero()); });
    fill<Vec3>(a.normal, "normal", {}, rows_of<Vec3>(scalars(*vertex_, {"nx", "ny", "nz"}), vertex_->count),
               [&](std::size_t t) {
                 const auto& [i, j, k] = mesh().triangles[t];
                 return face_normal(mesh().vertices[i], mesh().vertices[j], mesh().vertices[k]);
               });
    fill<Color>(a.color, "color", at_vertex.empty() ? colors_of(*face_) : std::vector<Color>(), at_vertex,
                [&](std::size_t t) {
                  return patch_ && patch_->values[parts_[t].face] != 0 ? crack_color : Color(Color::Ones());
                });
  }

  // Comments name groups in order; without them any integers are groups.
  void groups() {
    Attributes& a = mesh().attributes;
    for (const auto& c : ply_.comments) {
      if (c == "kerf_group" || c.rfind("kerf_group ", 0) == 0)
        a.group_names.push_back(c.size() > 11 ? c.substr(11) : "default");
      if (c.rfind("kerf_materials ", 0) == 0) a.materials = c.substr(15);
    }
    const auto* group = integers(*face_, "group");
    if (!group) {
      a.group_names.clear();
      return;
    }
    if (a.group_names.empty()) {
      std::map<double, std::int32_t> rows;
      for (const double g : group->values) rows.try_emplace(g, 0);
      for (auto& [g, row] : rows) {
        row = static_cast<std::int32_t>(a.group_names.size());
        a.group_names.push_back("group_" + std::to_string(static_cast<long long>(g)));
      }
      for (const Part& part : parts_) a.group.push_back(rows.at(group->values[part.face]));
      return;
    }
    for (std::size_t i = 0; i < face_->count; ++i)
      if (group->values[i] < 0 || group->values[i] >= static_cast<double>(a.group_names.size()))
        throw InputError(name_ + ": face " + std::to_string(i) + " is of group " +
                         std::to_string(static_cast<long long>(group->values[i])) + ", but " +
                         std::to_string(a.group_names.size()) + " groups are named");
    for (const Part& part : parts_) a.group.push_back(static_cast<std::int32_t>(group->values[part.face]));
  }

  // Metres, as a comment.
  void unit() {
    constexpr std::string_view key = "kerf_unit ";
    for (const std::string& c : ply_.comments) {
      if (!c.starts_with(key)) continue;
      const LineReader lines(c, name_, 0);
      mesh().unit = lines.real(std::string_view(c).substr(key.size()));
      if (!(mesh().unit > 0)) throw InputError(name_ + ": its kerf_unit is not above 0; repair the file");
    }
  }

  void library() {
    const PlyElement* element = ply_.find("kerf_library");
    const PlyProperty* bytes = element ? element->find("glb") : nullptr;
    if (!bytes || bytes->type != 'C' || bytes->values.empty() || mesh().attributes.group.empty()) return;
    std::string glb(bytes->values.size(), '\0');
    for (std::size_t i = 0; i < glb.size(); ++i)
      glb[i] = static_cast<char>(static_cast<unsigned char>(bytes->values[i]));
    mesh().attributes.library.glb = std::make_shared<const std::string>(std::move(glb));
  }

  // An element row for each front, and one for each of its points and contacts.
  void fronts();

  const Ply& ply_;
  const std::string& name_;
  const PlyElement *vertex_ = nullptr, *face_ = nullptr;
  const PlyProperty *patch_ = nullptr, *indices_ = nullptr;
  PlyElement strip_faces_;  // faces of triangle strips
  std::vector<Part> parts_;
  SurfaceFile file_;
};

void Reader::fronts() {
  const auto *fronts = ply_.find("kerf_front"), *contacts = ply_.find("kerf_contact");
  if (!fronts || !contacts) return;
  const auto column = [&](const PlyElement& e, const char* property) -> const std::vector<double>& {
    const auto* p = e.find(property);
    if (!p || p->count_type) throw InputError(name_ + ": element '" + e.name + "' has no '" + property + "'");
    return p->values;
  };
  std::vector<std::string> names;
  for (const auto& c : ply_.comments)
    if (c.rfind("kerf_front ", 0) == 0) names.push_back(c.substr(11));
  for (std::size_t i = 0; i < fronts->count; ++i) {
    FrontState f;
    f.crack = whole(column(*fronts, "crack")[i], "crack");
    f.step = static_cast<std::uint32_t>(std::max(0, whole(column(*fronts, "step")[i], "step")));
    f.has_moved = f.step > 0;
    f.closed = column(*fronts, "closed")[i] != 0;
    if (i < names.size()) f.name = names[i];
    if (f.crack < 1) throw InputError(name_ + ": a front has no crack");
    file_.fronts.push_back(f);
  }
  const auto &front = column(*contacts, "front"), &segment = column(*contacts, "segment"),
             &at = column(*contacts, "site");
  const auto &x = column(*contacts, "x"), &y = column(*contacts, "y"), &z = column(*contacts, "z");
  for (std::size_t i = 0; i < contacts->count; ++i) {
    const auto f = row_of(front[i]), s = row_of(segment[i]);
    if (f >= file_.fronts.size() || s > file_.fronts[f].segments.size())
      throw InputError(name_ + ": contact " + std::to_string(i) + " is out of order");
    if (!in_range({x[i], y[i], z[i]}))
      throw InputError(name_ + ": contact " + std::to_string(i) +
                       " has a coordinate of no sensible size; repair the file");
    auto& segments = file_.fronts[f].segments;
    if (s == segments.size()) segments.emplace_back();
    segments[s].push_back({{x[i], y[i], z[i]}, at[i] < 0 ? VertexId() : VertexId(row_of(at[i]))});
  }
  for (auto& f : file_.fronts) {
    if (f.segments.empty()) throw InputError(name_ + ": a front has no contacts");
    for (std::size_t s = 0; s < f.segments.size(); ++s) {
      if (f.segments[s].size() < 2) throw InputError(name_ + ": a front's segment has fewer than two points");
      for (const auto& p : f.segments[s])
        if (p.id.valid() &&
            std::find(file_.mesh.site.begin(), file_.mesh.site.end(), p.id.value) == file_.mesh.site.end())
          throw InputError(name_ + ": a front's contact names a site that is not there");
      f.points.push_back(f.segments[s].front());
    }
    if (!f.closed) f.points.push_back(f.segments.back().back());
    if (f.closed && f.points.size() < 3) throw InputError(name_ + ": a closed front has fewer than three points");
  }
}

}  // namespace

SurfaceFile parse_surface_ply(const std::string& bytes, const std::string& name) {
  const Ply ply = parse_ply(bytes, name);
  return Reader(ply, name).read();
}

}  // namespace geo
