// io/assimp_scene.h. The library is opened by dlopen(), under the name that its headers belong to:
// programs that read no such file load neither it nor what it needs.
#include "io/assimp_scene.h"

#include <assimp/cimport.h>
#include <assimp/config.h>
#include <assimp/material.h>
#include <assimp/mesh.h>
#include <assimp/scene.h>
#include <dlfcn.h>

#include <cstring>
#include <map>

#include "io/assimp_files.h"
#include "io/shown.h"
#include "io/surface_assimp.h"
#include "io/surface_formats.h"
#include "kerf/error.h"

namespace geo {
namespace {

// The functions of assimp that are used here; null where the library is missing.
class Library {
 public:
  Library() : handle_(::dlopen(KERF_ASSIMP, RTLD_NOW | RTLD_LOCAL)) {
    find(import, "aiImportFileExWithProperties");
    find(error, "aiGetErrorString");
    find(supports, "aiIsExtensionSupported");
    find(material_string, "aiGetMaterialString");
    find(create_settings, "aiCreatePropertyStore");
    find(set, "aiSetImportPropertyInteger");
  }
  bool complete() const { return import && error && supports && material_string && create_settings && set; }

  decltype(&aiImportFileExWithProperties) import = nullptr;
  decltype(&aiGetErrorString) error = nullptr;
  decltype(&aiIsExtensionSupported) supports = nullptr;
  decltype(&aiGetMaterialString) material_string = nullptr;
  decltype(&aiCreatePropertyStore) create_settings = nullptr;
  decltype(&aiSetImportPropertyInteger) set = nullptr;

 private:
  template <class F>
  void find(F& function, const char* name) {
    if (handle_) function = reinterpret_cast<F>(::dlsym(handle_, name));
  }
  void* handle_;
};

const Library& library() {
  static const Library loaded;
  return loaded;
}

using Transform = Eigen::Matrix<double, 3, 4>;

// Where the transform of a scene's root comes from.
enum class RootTransform { of_file, of_assimp };

Transform transform_of(const aiMatrix4x4& m) {
  Transform result;
  result << m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4;
  return result;
}

Transform after(const Transform& outer, const Transform& inner) {
  Transform result;
  result.leftCols<3>() = outer.leftCols<3>() * inner.leftCols<3>();
  result.col(3) = outer.leftCols<3>() * inner.col(3) + outer.col(3);
  return result;
}

Vec3 vector_of(const aiVector3D& v) { return {v.x, v.y, v.z}; }

// Whether engines (Unreal, Godot) take a node of this name for a collision shape.
bool is_hull(std::string_view name) {
  for (const char* beginning : {"UCX_", "UBX_", "USP_", "UCP_"})
    if (name.starts_with(beginning)) return true;
  return name.ends_with("-colonly") || name.ends_with("-convcolonly");
}

// Adds the meshes of a scene to one mesh, as its nodes place them.
class Collector {
 public:
  Collector(const aiScene& scene, const std::string& name, RootTransform root)
      : scene_(scene), where_(name + ": "), root_(root) {
    for (unsigned i = 0; i < scene.mNumMeshes; ++i) {
      const aiMesh& mesh = *scene.mMeshes[i];
      uv_ = uv_ || mesh.HasTextureCoords(0);
      normal_ = normal_ || mesh.HasNormals();
      color_ = color_ || mesh.HasVertexColors(0);
    }
  }

  SurfaceFile collect() {
    place_nodes();
    for (const Visit& visit : visits_) {
      const bool hull = is_hull(visit.node->mName.C_Str());
      for (unsigned i = 0; i < visit.node->mNumMeshes; ++i) {
        const aiMesh& mesh = *scene_.mMeshes[visit.node->mMeshes[i]];
        if (hull)
          ++hulls_;
        else
          add(mesh, visit.transform);
      }
    }
    // A scene without materials has one of assimp's, with its name or without.
    if (const auto& names = mesh_.attributes.group_names;
        names.size() == 1 && (names[0] == AI_DEFAULT_MATERIAL_NAME || names[0] == "default")) {
      mesh_.attributes.group.clear();
      mesh_.attributes.group_names.clear();
    }
    SurfaceFile file;
    add_notes(file.notes);
    read_unit();
    file.mesh = std::move(mesh_);
    return file;
  }

 private:
  struct Visit {
    const aiNode* node;
    Transform transform;
  };

  // Finds the place of each node, from the root down.
  void place_nodes() {
    Transform same = Transform::Zero();
    same.leftCols<3>().setIdentity();
    std::vector<Visit> open;
    if (scene_.mRootNode) open.push_back({scene_.mRootNode, same});
    while (!open.empty()) {
      const auto [node, outer] = open.back();
      open.pop_back();
      const bool ignored = node == scene_.mRootNode && root_ == RootTransform::of_assimp;
      const Transform own = ignored ? same : after(outer, transform_of(node->mTransformation));
      visits_.push_back({node, own});
      places_.try_emplace(node->mName.C_Str(), own);
      for (unsigned i = node->mNumChildren; i > 0; --i) open.push_back({node->mChildren[i - 1], own});
    }
  }

  // FBX says how many centimetres its unit is.
  void read_unit() {
    double centimetres = 0;
    float single = 0;
    const aiMetadata* about = scene_.mMetaData;
    for (unsigned i = 0; about && i < about->mNumProperties; ++i) {
      if (std::string_view(about->mKeys[i].C_Str()) != "UnitScaleFactor") continue;
      const aiMetadataEntry& entry = about->mValues[i];
      if (entry.mType == AI_DOUBLE) std::memcpy(&centimetres, entry.mData, sizeof centimetres);
      if (entry.mType == AI_FLOAT) {
        std::memcpy(&single, entry.mData, sizeof single);
        centimetres = single;
      }
    }
    constexpr double metres_of_centimetre = 0.01;
    if (centimetres > 0 && std::isfinite(centimetres)) mesh_.unit = metres_of_centimetre * centimetres;
  }

  bool has_textures() const {
    for (unsigned i = 0; i < scene_.mNumMaterials; ++i)
      for (unsigned k = 0; k < scene_.mMaterials[i]->mNumProperties; ++k)
        if (std::string_view(scene_.mMaterials[i]->mProperties[k]->mKey.C_Str()) == "$tex.file") return true;
    return scene_.mNumTextures > 0;
  }

  void add_notes(std::vector<std::string>& notes) const {
    std::vector<std::string> things;
    const auto add = [&](std::size_t n, const std::string& noun) {
      if (n > 0) things.push_back(counted(n, noun));
    };
    if (has_textures()) things.push_back("textures");
    add(scene_.mNumCameras, "camera");
    add(scene_.mNumLights, "light");
    add(scene_.mNumAnimations, "animation");
    if (skinned_) things.push_back("skins (applied)");
    add(hulls_, "collision shape");
    if (thin_faces_ > 0) things.push_back(counted(thin_faces_, "point or line", "points and lines"));
    if (second_uv_) things.push_back("further texture coordinates");
    if (second_color_) things.push_back("further colours");
    add_left_out(notes, things);
    if (unplaced_) notes.push_back("a skin has bones without nodes; its vertices stay where their node places them");
  }

  // The transform of each vertex of a mesh with bones: the weighted mean of what its bones do.
  // Empty without bones.
  std::vector<Transform> bone_places(const aiMesh& mesh, const Transform& node) {
    std::vector<Transform> sum;
    if (mesh.mNumBones == 0) return sum;
    sum.assign(mesh.mNumVertices, Transform::Zero());
    std::vector<double> weights(mesh.mNumVertices, 0);
    for (unsigned b = 0; b < mesh.mNumBones; ++b) {
      const aiBone& bone = *mesh.mBones[b];
      const auto place = places_.find(bone.mName.C_Str());
      if (place == places_.end()) {
        unplaced_ = true;
        return {};
      }
      const Transform own = after(place->second, transform_of(bone.mOffsetMatrix));
      for (unsigned w = 0; w < bone.mNumWeights; ++w) {
        const auto& [v, weight] = bone.mWeights[w];
        if (v >= mesh.mNumVertices || !(weight > 0)) continue;
        sum[v] += weight * own;
        weights[v] += weight;
      }
    }
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) sum[v] = weights[v] > 0 ? Transform(sum[v] / weights[v]) : node;
    return sum;
  }

  std::int32_t group_of(const aiMesh& mesh) {
    aiString text;
    std::string name;
    if (mesh.mMaterialIndex < scene_.mNumMaterials &&
        library().material_string(scene_.mMaterials[mesh.mMaterialIndex], AI_MATKEY_NAME, &text) == AI_SUCCESS)
      name = shown(text.C_Str(), 200);
    if (name.empty()) name = "default";
    auto& names = mesh_.attributes.group_names;
    const auto [entry, fresh] = groups_.try_emplace(name, static_cast<std::int32_t>(names.size()));
    if (fresh) names.push_back(name);
    return entry->second;
  }

  void add(const aiMesh& mesh, const Transform& node) {
    const auto bones = bone_places(mesh, node);
    skinned_ = skinned_ || !bones.empty();
    const Transform& transform = bones.empty() ? node : bones[0];
    second_uv_ = second_uv_ || mesh.HasTextureCoords(1);
    second_color_ = second_color_ || mesh.HasVertexColors(1);
    const Eigen::Matrix3d linear = transform.leftCols<3>();
    // Normals follow the cofactors; a mirrored mesh is turned, so that its outside stays outside.
    Eigen::Matrix3d cofactors;
    for (int k = 0; k < 3; ++k) cofactors.col(k) = linear.col((k + 1) % 3).cross(linear.col((k + 2) % 3));
    const bool mirrored = linear.determinant() < 0;
    if (mirrored) cofactors = -cofactors;
    const bool moved = !(linear.isIdentity(0) && transform.col(3).isZero(0));
    const auto first = static_cast<std::uint32_t>(mesh_.vertices.size());
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
      const Vec3 at = vector_of(mesh.mVertices[v]);
      if (!bones.empty())
        mesh_.vertices.push_back(bones[v].leftCols<3>() * at + bones[v].col(3));
      else
        mesh_.vertices.push_back(moved ? Vec3(linear * at + transform.col(3)) : at);
    }
    const std::int32_t group = group_of(mesh);
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices < 3) {
        ++thin_faces_;
        continue;
      }
      std::vector<std::uint32_t> polygon(face.mIndices, face.mIndices + face.mNumIndices);
      if (mirrored) std::reverse(polygon.begin(), polygon.end());
      for (std::uint32_t& v : polygon) {
        if (v >= mesh.mNumVertices) throw InputError(where_ + "a face names a vertex that its mesh does not have");
        v += first;
      }
      for (const auto& corners : add_polygon(mesh_, polygon, where_)) {
        add_corners(mesh, first, {polygon[corners[0]], polygon[corners[1]], polygon[corners[2]]}, cofactors);
        mesh_.attributes.group.push_back(group);
      }
    }
  }

  // Attributes of a triangle with these vertices, of which the mesh's first is `first`.
  void add_corners(const aiMesh& mesh, std::uint32_t first, const Triangle& triangle,
                   const Eigen::Matrix3d& cofactors) {
    std::array<Vec2, 3> uv;
    std::array<Vec3, 3> normal;
    std::array<Color, 3> color;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = triangle[k] - first;
      uv[k] = mesh.HasTextureCoords(0) ? Vec2(vector_of(mesh.mTextureCoords[0][v]).head<2>()) : Vec2(Vec2::Zero());
      if (!uv[k].allFinite()) uv[k].setZero();
      normal[k].setZero();
      if (mesh.HasNormals()) normal[k] = (cofactors * vector_of(mesh.mNormals[v])).stableNormalized();
      if (!normal[k].allFinite() || normal[k].isZero())
        normal[k] = face_normal(mesh_.vertices[triangle[0]], mesh_.vertices[triangle[1]], mesh_.vertices[triangle[2]]);
      color[k].setOnes();
      if (mesh.HasVertexColors(0)) {
        const aiColor4D& c = mesh.mColors[0][v];
        color[k] = Color(c.r, c.g, c.b, c.a);
      }
      if (!color[k].allFinite()) color[k].setOnes();
    }
    Attributes& a = mesh_.attributes;
    if (uv_) a.uv.push_back(uv);
    if (normal_) a.normal.push_back(normal);
    if (color_) a.color.push_back(color);
  }

  const aiScene& scene_;
  const std::string where_;
  const RootTransform root_;
  std::vector<Visit> visits_;
  std::map<std::string, Transform, std::less<>> places_;  // of nodes by name
  std::size_t hulls_ = 0, thin_faces_ = 0;                // that are left out
  bool second_uv_ = false, second_color_ = false, unplaced_ = false, skinned_ = false;
  bool uv_ = false, normal_ = false, color_ = false;  // whether some mesh has them
  TriangleMesh mesh_;
  std::map<std::string, std::int32_t> groups_;
};

}  // namespace

bool assimp_reads(const std::string& ending) {
  return library().complete() && library().supports(("." + ending).c_str()) == AI_TRUE;
}

void load_assimp() {
  if (!library().complete())
    throw InputError(std::string("needs the library ") + KERF_ASSIMP + " (Debian's libassimp5); install it");
}

SurfaceFile assimp_surface(const std::string& bytes, const std::string& name, const std::string& ending) {
  AssimpFiles files(bytes, name, ending);
  aiPropertyStore* settings = library().create_settings();
  library().set(settings, AI_CONFIG_IMPORT_NO_SKELETON_MESHES, 1);  // a skeleton is no surface
  const aiScene* scene = library().import(files.path().c_str(), 0, &files, settings);
  if (!scene) {
    std::string text = library().error();
    if (const auto at = text.find(files.path()); at != text.npos) text.replace(at, files.path().size(), name);
    throw InputError(name + ": assimp cannot read it: " + shown(text, 200));
  }
  // The roots of these formats have no transform of their own. assimp gives them one that turns and
  // scales the scene.
  const bool added = ending == "dae" || ending == "zae" || ending == "fbx";
  return Collector(*scene, name, added ? RootTransform::of_assimp : RootTransform::of_file).collect();
}

}  // namespace geo
