// parse_gltf() of io/surface_formats.h: all meshes of the scene, as its nodes, instances and skins
// place them.
#include <algorithm>
#include <map>
#include <set>
#include <sstream>

#include "io/gltf_document.h"
#include "io/gltf_materials.h"
#include "io/gltf_mesh.h"
#include "io/shown.h"
#include "io/surface_formats.h"
#include "kerf/error.h"

namespace geo {
namespace {

using Description = GltfDocument::Json;

// Whether engines (Unreal, Godot) take a node of this name for a collision shape.
bool is_hull(std::string_view name) {
  for (const char* beginning : {"UCX_", "UBX_", "USP_", "UCP_"})
    if (name.starts_with(beginning)) return true;
  return name.ends_with("-colonly") || name.ends_with("-convcolonly");
}

// Text formats divide lines into words, so that only single blanks come back.
std::string with_single_blanks(const std::string& text) {
  std::istringstream words(text);
  std::string result;
  for (std::string word; words >> word;) result += (result.empty() ? "" : " ") + word;
  return result;
}

class GltfReader {
 public:
  GltfReader(const std::string& bytes, const std::string& name)
      : document_(bytes, name), max_triangles_(5'000'000 + bytes.size()) {
    const std::size_t meshes = document_.count("meshes");
    for (std::size_t i = 0; i < meshes; ++i)
      for (const Description& primitive : primitives_of(i)) look_at(primitive);
  }

  SurfaceFile read() {
    std::vector<std::size_t> roots = scene_roots();
    place_nodes(roots);
    for (const Placed& visit : places_) add_node(visit);
    finish_groups();
    mesh().unit = 1;
    add_notes();
    return std::move(file_);
  }

 private:
  // A visit of a node.
  struct Placed {
    std::size_t node;
    Eigen::Affine3d place;
    bool hidden;
  };

  struct Part {
    GltfPrimitive primitive;
    std::vector<double> morph;
    bool read = false;
  };

  TriangleMesh& mesh() { return file_.mesh; }

  const Description& primitives_of(std::size_t mesh_index) const {
    const Description& list = GltfDocument::member(document_.entry("meshes", mesh_index), "primitives");
    if (!list.is_array()) document_.fail("mesh " + std::to_string(mesh_index) + " has no primitives");
    return list;
  }

  // Notes which attributes there are: all triangles get them.
  void look_at(const Description& primitive) {
    const Description& attributes = GltfDocument::member(primitive, "attributes");
    if (!has_triangles(document_, primitive) || !attributes.is_object()) return;
    for (const auto& entry : attributes.items()) {
      const std::string& key = entry.key();
      uv_ = uv_ || key == "TEXCOORD_0";
      uv2_ = uv2_ || key == "TEXCOORD_1";
      normal_ = normal_ || key == "NORMAL";
      color_ = color_ || key == "COLOR_0";
      const bool first_uv = key == "TEXCOORD_0" || key == "TEXCOORD_1";
      if ((key.starts_with("TEXCOORD_") && !first_uv) || (key.starts_with("COLOR_") && key != "COLOR_0") ||
          key.starts_with("_"))
        others_.insert(shown(key, 40));
    }
  }

  // The roots of the scene that the file shows by default, else of its first one. Without scenes,
  // all nodes that are no other's children.
  std::vector<std::size_t> scene_roots() {
    const std::size_t scenes = document_.count("scenes"), nodes = document_.count("nodes");
    if (scenes > 0) {
      if (scenes > 1) left_out_.push_back(counted(scenes - 1, "other scene"));
      return document_.indices(document_.entry("scenes", document_.size(document_.json(), "scene", 0)), "nodes");
    }
    std::vector<bool> is_child(nodes, false);
    for (std::size_t i = 0; i < nodes; ++i)
      for (const std::size_t child : document_.indices(document_.entry("nodes", i), "children"))
        if (child < nodes) is_child[child] = true;
    std::vector<std::size_t> roots;
    for (std::size_t i = 0; i < nodes; ++i)
      if (!is_child[i]) roots.push_back(i);
    return roots;
  }

  // Finds the place of each visit of a node. A node that several name counts as often; one below
  // itself is refused.
  void place_nodes(const std::vector<std::size_t>& roots) {
    struct Visit {
      std::size_t node, depth;
      Eigen::Affine3d outer;
      bool hidden;
    };
    const std::size_t nodes = document_.count("nodes");
    const std::size_t max_visits = 1'000'000 + nodes;  // of nodes that others share; more than files have
    std::vector<Visit> open;
    for (std::size_t i = roots.size(); i > 0; --i)
      open.push_back({.node = roots[i - 1], .depth = 0, .outer = Eigen::Affine3d::Identity(), .hidden = false});
    while (!open.empty()) {
      const Visit visit = open.back();
      open.pop_back();
      const Description& node = document_.entry("nodes", visit.node);
      if (visit.depth > nodes) document_.fail("has a node that is below itself");
      if (places_.size() > max_visits) document_.fail("places more than a million nodes");
      const Eigen::Affine3d place = visit.outer * transform_of(document_, node);
      const bool hidden = visit.hidden || GltfDocument::member(GltfDocument::extension(node, "KHR_node_visibility"),
                                                               "visible") == false;
      first_place_.try_emplace(visit.node, place);
      places_.push_back({visit.node, place, hidden});
      const auto children = document_.indices(node, "children");
      for (std::size_t i = children.size(); i > 0; --i)
        open.push_back({.node = children[i - 1], .depth = visit.depth + 1, .outer = place, .hidden = hidden});
    }
  }

  void add_node(const Placed& visit) {
    const auto& [index, place, hidden] = visit;
    const Description& node = document_.entry("nodes", index);
    const auto mesh_index = document_.index(node, "mesh");
    if (!mesh_index) return;
    if (is_hull(GltfDocument::text(node, "name"))) {
      ++hulls_;
      return;
    }
    if (hidden) {
      ++hidden_;
      return;
    }
    const auto morph = morph_weights(node, *mesh_index);
    const auto skin = document_.index(node, "skin");
    const auto instances = instances_of(document_, node);
    if (skin && instances.size() != 1)
      document_.fail("has instances (EXT_mesh_gpu_instancing) of a mesh with a skin, which have no defined place");
    for (const Description& primitive : primitives_of(*mesh_index)) {
      if (!has_triangles(document_, primitive)) {
        ++(document_.size(primitive, "mode", 4) == 0 ? points_ : lines_);
        continue;
      }
      const GltfPrimitive& part = part_of(primitive, morph);
      const std::int32_t group = group_of(primitive);
      const Description& targets = GltfDocument::member(primitive, "targets");
      for (std::size_t i = 0; targets.is_array() && i < targets.size(); ++i)
        unmoved_ += i >= morph.size() || morph[i] == 0;
      // The place of a node with a skin has no effect (section 3.7.3.3): its joints place the
      // vertices.
      if (skin && part.joint_count > 0)
        add_skinned(part, *skin, group);
      else
        for (const Eigen::Affine3d& instance : instances) add(part, place * instance, group);
    }
  }

  // A primitive is read once for all nodes that name it, unless they have weights of their own.
  const GltfPrimitive& part_of(const Description& primitive, const std::vector<double>& morph) {
    Part& part = parts_[&primitive];
    if (!part.read || part.morph != morph) part = {read_primitive(document_, primitive, morph), morph, true};
    return part.primitive;
  }

  std::vector<double> morph_weights(const Description& node, std::size_t mesh_index) {
    const Description& own = GltfDocument::member(node, "weights");
    const Description& given =
        own.is_null() ? GltfDocument::member(document_.entry("meshes", mesh_index), "weights") : own;
    std::vector<double> weights;
    if (given.is_array())
      for (const Description& w : given) weights.push_back(w.is_number() ? w.get<double>() : 0.0);
    return weights;
  }

  // Materials have names that are no other's: names are groups.
  std::int32_t group_of(const Description& primitive) {
    const auto material = document_.index(primitive, "material");
    const std::size_t key = material ? *material : ~std::size_t(0);
    auto& names = mesh().attributes.group_names;
    const auto [at, fresh] = groups_.try_emplace(key, static_cast<std::int32_t>(names.size()));
    if (!fresh) return at->second;
    std::string name = "default";
    if (material) {
      name = shown(with_single_blanks(GltfDocument::text(document_.entry("materials", *material), "name")), 200);
      if (name.empty()) name = "material_" + std::to_string(*material);
    }
    const std::string beginning = name;
    for (int i = 2; std::find(names.begin(), names.end(), name) != names.end(); ++i)
      name = beginning + "_" + std::to_string(i);
    names.push_back(name);
    if (material) materials_.push_back({*material, name});
    return at->second;
  }

  void add(const GltfPrimitive& part, const Eigen::Affine3d& place, std::int32_t group) {
    const Eigen::Matrix3d linear = place.linear();
    const bool moved = !(linear.isIdentity(0) && place.translation().isZero(0));
    std::vector<Vec3> at = part.position, normal = part.normal;
    if (moved)
      for (Vec3& p : at) p = place * p;
    const Eigen::Matrix3d cofactors = cofactors_of(linear);
    if (moved)
      for (Vec3& n : normal) n = cofactors * n;
    add_placed(part, at, normal, linear.determinant() < 0, group);
  }

  // Normals follow the cofactors, which are turned with a mirrored mesh.
  static Eigen::Matrix3d cofactors_of(const Eigen::Matrix3d& linear) {
    Eigen::Matrix3d cofactors;
    for (int k = 0; k < 3; ++k) cofactors.col(k) = linear.col((k + 1) % 3).cross(linear.col((k + 2) % 3));
    return linear.determinant() < 0 ? Eigen::Matrix3d(-cofactors) : cofactors;
  }

  // Each vertex is moved by the weighted mean of its joints' matrices.
  void add_skinned(const GltfPrimitive& part, std::size_t skin_index, std::int32_t group) {
    const auto& joints = joints_of(skin_index);
    std::vector<Vec3> at = part.position, normal = part.normal;
    double mirrored = 0;
    for (std::size_t v = 0; v < at.size(); ++v) {
      Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();
      double weights = 0;
      for (std::size_t k = 0; k < part.joint_count; ++k) {
        const double w = part.weight[v * part.joint_count + k];
        const std::size_t joint = part.joint[v * part.joint_count + k];
        if (w == 0) continue;
        if (joint >= joints.size()) document_.fail("has a vertex whose joint its skin does not have");
        sum += w * joints[joint];
        weights += w;
      }
      if (!(std::abs(weights) > 0)) document_.fail("has a vertex with a skin whose weights are all zero");
      const Eigen::Affine3d place(Eigen::Matrix4d(sum / weights));
      at[v] = place * at[v];
      if (!normal.empty()) normal[v] = cofactors_of(place.linear()) * normal[v];
      mirrored += place.linear().determinant() < 0 ? 1 : -1;
    }
    add_placed(part, at, normal, mirrored > 0, group);
  }

  const std::vector<Eigen::Matrix4d>& joints_of(std::size_t skin_index) {
    const auto [at, fresh] = skins_.try_emplace(skin_index);
    if (!fresh) return at->second;
    const Description& skin = document_.entry("skins", skin_index);
    const auto joints = document_.indices(skin, "joints");
    const auto inverse = document_.index(skin, "inverseBindMatrices");
    const GltfRows* rows = inverse ? &document_.rows(*inverse) : nullptr;
    if (rows && (rows->width != 16 || rows->count < joints.size()))
      document_.fail("has a skin whose matrices do not fit its joints");
    for (std::size_t j = 0; j < joints.size(); ++j) {
      const auto place = first_place_.find(joints[j]);
      if (place == first_place_.end()) document_.fail("has a skin with a joint that is not in the scene");
      Eigen::Matrix4d bind = Eigen::Matrix4d::Identity();
      if (rows) bind = Eigen::Map<const Eigen::Matrix4d>(rows->row(j));
      at->second.push_back(place->second.matrix() * bind);
    }
    return at->second;
  }

  void add_placed(const GltfPrimitive& part, const std::vector<Vec3>& at, const std::vector<Vec3>& normal,
                  bool mirrored, std::int32_t group) {
    if (mesh().triangles.size() + part.triangles.size() > max_triangles_)
      document_.fail("places more than " + std::to_string(max_triangles_) + " triangles");
    const auto first = static_cast<std::uint32_t>(mesh().vertices.size());
    mesh().vertices.insert(mesh().vertices.end(), at.begin(), at.end());
    Attributes& a = mesh().attributes;
    for (Triangle t : part.triangles) {
      if (mirrored) std::swap(t[1], t[2]);  // so that its outside stays outside
      const Triangle placed{first + t[0], first + t[1], first + t[2]};
      mesh().triangles.push_back(placed);
      a.group.push_back(group);
      std::array<Vec2, 3> uv, uv2;
      std::array<Vec3, 3> normals;
      std::array<Color, 3> color;
      for (std::size_t k = 0; k < 3; ++k) {
        uv[k] = part.uv.empty() ? Vec2(Vec2::Zero()) : part.uv[t[k]];
        uv2[k] = part.uv2.empty() ? Vec2(Vec2::Zero()) : part.uv2[t[k]];
        color[k] = part.color.empty() ? Color(Color::Ones()) : part.color[t[k]];
        normals[k] = normal.empty() ? Vec3(Vec3::Zero()) : Vec3(normal[t[k]].stableNormalized());
        if (!normals[k].allFinite() || normals[k].isZero()) normals[k] = face_normal(at[t[0]], at[t[1]], at[t[2]]);
      }
      if (uv_) a.uv.push_back(uv);
      if (uv2_) a.uv2.push_back(uv2);
      if (normal_) a.normal.push_back(normals);
      if (color_) a.color.push_back(color);
    }
  }

  void finish_groups() {
    Attributes& a = mesh().attributes;
    if (materials_.empty()) {
      a.group.clear();
      a.group_names.clear();
      return;
    }
    const std::size_t sets = uv2_ ? 2 : uv_ ? 1 : 0;
    auto library = materials_of(document_, materials_, sets);
    if (library.dropped > 0) left_out_.push_back(counted(library.dropped, "texture") + " without texture coordinates");
    left_out_.insert(left_out_.end(), library.faults.begin(), library.faults.end());
    a.library.glb = std::make_shared<const std::string>(std::move(library.glb));
  }

  void add_notes() {
    const auto add = [&](std::size_t n, const std::string& noun) {
      if (n > 0) left_out_.push_back(counted(n, noun));
    };
    add(points_, "mesh of points");
    add(lines_, "mesh of lines");
    add(hulls_, "collision shape");
    add(hidden_, "hidden mesh");
    add(document_.count("cameras"), "camera");
    const Description& lights =
        GltfDocument::member(GltfDocument::extension(document_.json(), "KHR_lights_punctual"), "lights");
    add(lights.is_array() ? lights.size() : 0, "light");
    add(document_.count("animations"), "animation");
    if (unmoved_ > 0)
      left_out_.push_back(counted(unmoved_, "morph target without weight", "morph targets without weight"));
    if (skins_.size() > 0) left_out_.push_back(counted(skins_.size(), "skin (applied)", "skins (applied)"));
    for (const std::string& name : others_) left_out_.push_back("attribute " + name);
    for (const std::string& name : document_.unknown_extensions()) left_out_.push_back("extension " + name);
    if (!GltfDocument::extension(document_.json(), "KHR_materials_variants").is_null())
      left_out_.push_back("variants of materials");
    add_left_out(file_.notes, left_out_);
  }

  GltfDocument document_;
  // Nodes and instances may repeat triangles: 1 GB, with some 200 bytes for each. A triangle that
  // the file stores has a byte at least.
  const std::size_t max_triangles_;
  bool uv_ = false, uv2_ = false, normal_ = false, color_ = false;  // whether some mesh has them
  std::set<std::string> others_;                                    // attributes that are left out
  std::vector<Placed> places_;
  std::map<std::size_t, Eigen::Affine3d> first_place_;  // of nodes
  std::map<std::size_t, std::vector<Eigen::Matrix4d>> skins_;
  std::map<const Description*, Part> parts_;    // by their descriptions, which do not move
  std::map<std::size_t, std::int32_t> groups_;  // of materials
  std::vector<GltfGroup> materials_;
  std::size_t hulls_ = 0, hidden_ = 0, points_ = 0, lines_ = 0, unmoved_ = 0;
  std::vector<std::string> left_out_;
  SurfaceFile file_;
};

}  // namespace

SurfaceFile parse_gltf(const std::string& bytes, const std::string& name) {
  try {
    return GltfReader(bytes, name).read();
  } catch (const Description::exception&) {
    throw InputError(name + ": is a glTF file with a description of an unexpected type; it is damaged");
  }
}

}  // namespace geo
