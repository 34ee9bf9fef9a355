// joined_attributes() of kerf/appearance.h. Bodies with the same library share its materials; names
// that stand for different materials get a number.
#include <algorithm>
#include <map>
#include <memory>
#include <sstream>

#include "io/glb_file.h"
#include "io/gltf_materials.h"
#include "kerf/appearance.h"

namespace geo {
namespace {

// Values per triangle of all meshes: those that a mesh lacks are `missing`.
template <class Row>
void join(std::vector<Row>& to, std::span<const TriangleMesh> meshes, std::vector<Row> Attributes::*member,
          const auto& missing) {
  bool any = false;
  for (const TriangleMesh& mesh : meshes) any = any || !(mesh.attributes.*member).empty();
  for (std::size_t m = 0; any && m < meshes.size(); ++m) {
    const std::vector<Row>& own = meshes[m].attributes.*member;
    for (std::size_t t = 0; t < meshes[m].triangles.size(); ++t)
      to.push_back(own.empty() ? missing(meshes[m], t) : own[t]);
  }
}

template <class V>
std::array<V, 3> at_three_corners(const V& value) {
  return {value, value, value};
}

// Names of groups in the joined mesh, and the materials that they stand for.
class JoinedGroups {
 public:
  // The row of a group of a mesh.
  std::int32_t row(const Attributes& of, const std::string& group) {
    const std::string& library = of.library.glb ? *of.library.glb : none_;
    std::string name = group;
    for (int number = 2;; ++number) {
      const auto [at, fresh] = rows_.try_emplace(name, Entry{static_cast<std::int32_t>(names.size()), &library, group});
      if (fresh) names.push_back(name);
      if (fresh || (*at->second.library == library && at->second.group == group)) return at->second.row;
      name = group + " " + std::to_string(number);
    }
  }

  // The materials of all libraries that groups are of, by the names that these have here.
  MaterialLibrary library() const {
    std::map<const std::string*, std::map<std::string, std::string>> renamed;
    for (const auto& [name, entry] : rows_)
      if (!entry.library->empty()) renamed[entry.library][entry.group] = name;
    if (renamed.empty()) return {};
    GlbFile file;
    file.json = {{"asset", {{"version", "2.0"}, {"generator", "kerf"}}}};
    std::vector<const std::string*> done;
    for (const std::string& name : names) {
      const std::string* of = rows_.at(name).library;
      if (of->empty() || std::find(done.begin(), done.end(), of) != done.end()) continue;
      done.push_back(of);
      add_materials(file, *of, renamed.at(of));
    }
    std::ostringstream out;
    file.write(out);
    return {std::make_shared<const std::string>(std::move(out).str())};
  }

  std::vector<std::string> names;

 private:
  struct Entry {
    std::int32_t row;
    const std::string* library;  // empty: none
    std::string group;           // its name there
  };
  std::map<std::string, Entry> rows_;
  const std::string none_;
};

}  // namespace

Attributes joined_attributes(std::span<const TriangleMesh> meshes) {
  Attributes joined;
  const auto no_place = [](const TriangleMesh&, std::size_t) { return at_three_corners<Vec2>(Vec2::Zero()); };
  join(joined.uv, meshes, &Attributes::uv, no_place);
  join(joined.uv2, meshes, &Attributes::uv2, no_place);
  join(joined.color, meshes, &Attributes::color,
       [](const TriangleMesh&, std::size_t) { return at_three_corners<Color>(Color::Ones()); });
  join(joined.normal, meshes, &Attributes::normal, [](const TriangleMesh& mesh, std::size_t t) {
    const auto& [a, b, c] = mesh.triangles[t];
    return at_three_corners<Vec3>(face_normal(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]));
  });
  JoinedGroups groups;
  join(joined.group, meshes, &Attributes::group, [](const TriangleMesh&, std::size_t) { return -1; });
  std::size_t t = 0;
  for (const TriangleMesh& mesh : meshes) {
    const Attributes& own = mesh.attributes;
    for (std::size_t i = 0; !joined.group.empty() && i < mesh.triangles.size(); ++i, ++t)
      joined.group[t] = own.group.empty() ? groups.row({}, "default")
                                          : groups.row(own, own.group_names[static_cast<std::size_t>(own.group[i])]);
  }
  joined.group_names = groups.names;
  joined.library = groups.library();
  return joined;
}

}  // namespace geo
