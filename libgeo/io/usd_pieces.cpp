// write_usd_pieces() of kerf/export.h. USD text with the schema of UsdPhysics: rigid bodies with
// masses and convex hulls, and a fixed joint for each bond.
//
// Axes of joints and bodies are those of the stage, as nodes of pieces are translated only. So both
// local rotations of a joint are the identity.
#include <algorithm>
#include <map>

#include "io/piece_json.h"
#include "io/preview_material.h"
#include "io/usd_material.h"
#include "io/usd_names.h"
#include "io/usd_text.h"
#include "kerf/error.h"
#include "kerf/export.h"

namespace geo {
namespace {

using namespace usd;

// The text of a stage: prims with braces, each line indented by its depth.
class UsdStage {
 public:
  explicit UsdStage(std::ostream& out) : out_(out) {}
  /// A brace alone begins or ends a level.
  void line(const std::string& text) {
    if (text == "}") --depth_;
    out_ << std::string(4 * depth_, ' ') << text << '\n';
    if (text == "{") ++depth_;
  }
  /// Begins a prim with schemas that are applied to it.
  void begin(const std::string& type, const std::string& name, const std::vector<std::string>& schemas = {}) {
    std::string head = "def " + type + " \"" + name + "\"";
    if (!schemas.empty()) {
      head += " (prepend apiSchemas = ";
      add_list(head, schemas.size(), [&](std::size_t i) { head += '"' + schemas[i] + '"'; });
      head += ")";
    }
    line(head);
    line("{");
  }
  void end() { line("}"); }
  void translate(const Vec3& by) {
    std::string text;
    add_translation(text, std::string(4 * depth_, ' '), by);
    out_ << text;
  }

 private:
  std::ostream& out_;
  std::size_t depth_ = 0;
};

class UsdPieces {
 public:
  UsdPieces(std::ostream& out, const std::vector<Chunk>& chunks, const std::vector<Bond>& bonds,
            const ChunkLabels& labels, const UsdOptions& options)
      : stage_(out),
        chunks_(chunks),
        bonds_(bonds),
        labels_(labels),
        options_(options),
        unit_(!chunks.empty() && chunks[0].mesh.unit > 0 ? chunks[0].mesh.unit : 1),
        offset_(single_precision_offset(bounding_box(chunks))),
        centroids_(cluster_centroids(chunks, labels.levels)),
        paths_(chunks.size()) {
    for (const Chunk& chunk : chunks)
      if (const MaterialLibrary& library = chunk.mesh.attributes.library; library.glb && library_.materials.empty())
        library_ = preview_materials(library);
    for (const PreviewMaterial& material : library_.materials) described_.try_emplace(material.name, &material);
    if (!options.image_prefix.empty()) images_ = image_file_names(library_, options.image_prefix);
    std::string unit;
    add_number(unit, unit_);
    out << "#usda 1.0\n(\n    defaultPrim = \"pieces\"\n    kilogramsPerUnit = 1\n    metersPerUnit = " << unit
        << "\n    upAxis = \"" << (options.z_up ? 'Z' : 'Y') << "\"\n)\n\n";
  }

  void write() {
    for (std::size_t k = 0; k < labels_.levels.size(); ++k) {
      below_.emplace_back(labels_.levels[k].volume.size());
      for (std::size_t i = 0; i < labels_.levels[k].of.size(); ++i) below_[k][labels_.levels[k].of[i]].push_back(i);
    }
    stage_.begin("Xform", "pieces");
    if (!offset_.isZero(0)) stage_.translate(offset_);
    const std::size_t top = labels_.levels.size();
    const std::size_t count = top > 0 ? labels_.levels.back().volume.size() : chunks_.size();
    for (std::size_t i = 0; i < count; ++i) member(top, i, "/pieces/", offset_);
    if (!bonds_.empty()) {
      stage_.begin("Scope", "bonds");
      for (const Bond& bond : bonds_) joint(bond);
      stage_.end();
    }
    stage_.begin("Scope", "materials");
    for (const auto& [group, name] : materials_.all()) {
      const auto at = described_.find(group);
      write_material([&](const std::string& text) { stage_.line(text); }, "/pieces/materials", name,
                     at != described_.end() ? *at->second : plain_material(group), images_);
    }
    stage_.end();
    stage_.end();
  }

 private:
  // A cluster of a level with all that is below it, or a piece (level 0).
  void member(std::size_t level, std::size_t which, const std::string& path, const Vec3& origin) {
    if (level == 0) return piece(which, path, origin);
    const std::string name = cluster_name(level, which);
    stage_.begin("Xform", name);
    stage_.translate(centroids_[level - 1][which] - origin);
    for (const auto i : below_[level - 1][which]) member(level - 1, i, path + name + "/", centroids_[level - 1][which]);
    stage_.end();
  }

  void piece(std::size_t p, const std::string& path, const Vec3& origin) {
    Chunk chunk = completed(chunks_[p]);
    const RigidBody body = rigid_body(chunk, labels_.density * unit_ * unit_ * unit_);
    const std::string name = identifier(labels_.names[p]);
    paths_[p] = path + name;
    stage_.begin("Mesh", name,
                 {"PhysicsRigidBodyAPI", "PhysicsMassAPI", "PhysicsCollisionAPI", "PhysicsMeshCollisionAPI",
                  "MaterialBindingAPI"});
    stage_.translate(chunk.centroid - origin);
    stage_.line("uniform token physics:approximation = \"" +
                std::string(options_.hull_parts > 1 ? "convexDecomposition" : "convexHull") + "\"");
    if (body.mass > 0) {
      stage_.line("float physics:mass = " + usd_number(body.mass));
      stage_.line("point3f physics:centerOfMass = (0, 0, 0)");
      stage_.line("float3 physics:diagonalInertia = " + usd_tuple(body.inertia));
      const auto& q = body.axes;
      stage_.line("quatf physics:principalAxes = " + usd_tuple(Eigen::Vector4d(q.w(), q.x(), q.y(), q.z())));
    }
    for (Vec3& v : chunk.mesh.vertices) v -= chunk.centroid;
    mesh(chunk.mesh);
    stage_.end();
  }

  void mesh(const TriangleMesh& m) {
    Box3 box;
    for (const Vec3& v : m.vertices) box.add(v);
    stage_.line("uniform token subdivisionScheme = \"none\"");
    if (double_sided(m)) stage_.line("uniform bool doubleSided = 1");
    stage_.line("float3[] extent = [" + usd_tuple(box.lo) + ", " + usd_tuple(box.hi) + "]");
    stage_.line("point3f[] points = " + points_of(m));
    stage_.line("int[] faceVertexCounts = " + counts_of(m));
    stage_.line("int[] faceVertexIndices = " + corners_of_triangles(m));
    const auto normals = corner_normals(m);
    std::string text;
    add_list(text, 3 * normals.size(), [&](std::size_t i) { add_tuple(text, normals[i / 3][i % 3]); });
    stage_.line("normal3f[] normals = " + text + " (interpolation = \"faceVarying\")");
    stage_.line("texCoord2f[] primvars:st = " + uv_of(m.attributes.uv) + " (interpolation = \"faceVarying\")");
    if (!m.attributes.uv2.empty())
      stage_.line("texCoord2f[] primvars:st1 = " + uv_of(m.attributes.uv2) + " (interpolation = \"faceVarying\")");
    stage_.line("int[] primvars:patch = " + patches_of(m) + " (interpolation = \"uniform\")");
    if (!m.attributes.color.empty()) {
      text.clear();
      const auto& color = m.attributes.color;
      add_list(text, 3 * color.size(),
               [&](std::size_t i) { add_tuple(text, Vec3(color[i / 3][i % 3].template head<3>())); });
      stage_.line("color3f[] primvars:displayColor = " + text + " (interpolation = \"faceVarying\")");
    }
    stage_.line("uniform token subsetFamily:materialBind:familyType = \"partition\"");
    const Attributes& a = m.attributes;
    for (std::size_t g = 0; g < a.group_names.size(); ++g) {
      std::vector<std::size_t> rows;
      for (std::size_t t = 0; t < a.group.size(); ++t)
        if (a.group[t] == std::int32_t(g)) rows.push_back(t);
      if (rows.empty()) continue;
      const std::string& name = materials_.of(a.group_names[g]);
      text.clear();
      add_list(text, rows.size(), [&](std::size_t i) { add_number(text, rows[i]); });
      stage_.begin("GeomSubset", name, {"MaterialBindingAPI"});
      stage_.line("uniform token elementType = \"face\"");
      stage_.line("uniform token familyName = \"materialBind\"");
      stage_.line("int[] indices = " + text);
      stage_.line("rel material:binding = </pieces/materials/" + name + ">");
      stage_.end();
    }
  }

  // USD has it for meshes, glTF for materials.
  bool double_sided(const TriangleMesh& m) const {
    const auto& names = m.attributes.group_names;
    return std::any_of(names.begin(), names.end(), [&](const std::string& name) {
      const auto at = described_.find(name);
      return at != described_.end() && at->second->double_sided;
    });
  }

  void joint(const Bond& bond) {
    stage_.begin("PhysicsFixedJoint", identifier(labels_.names[bond.a] + "_" + labels_.names[bond.b]));
    stage_.line("rel physics:body0 = <" + paths_[bond.a] + ">");
    stage_.line("rel physics:body1 = <" + paths_[bond.b] + ">");
    stage_.line("point3f physics:localPos0 = " + usd_tuple(Vec3(bond.centroid - chunks_[bond.a].centroid)));
    stage_.line("point3f physics:localPos1 = " + usd_tuple(Vec3(bond.centroid - chunks_[bond.b].centroid)));
    stage_.line("quatf physics:localRot0 = (1, 0, 0, 0)");
    stage_.line("quatf physics:localRot1 = (1, 0, 0, 0)");
    stage_.line("float physics:breakForce = " + usd_number(labels_.strength * unit_ * bond.area));
    stage_.line("float physics:breakTorque = " + usd_number(labels_.strength * unit_ * bond.section));
    // Bonds make loops, which an articulation must not have.
    stage_.line("uniform bool physics:excludeFromArticulation = 1");
    stage_.end();
  }

  UsdStage stage_;
  const std::vector<Chunk>& chunks_;
  const std::vector<Bond>& bonds_;
  const ChunkLabels& labels_;
  const UsdOptions& options_;
  // Numbers are in units of the stage: kg, the model's unit of length, and seconds. So a density of
  // kg/m³ is multiplied by the cube of the unit, and a strength of N/m² = kg/(m s²) by the unit.
  double unit_;
  Vec3 offset_;
  std::vector<std::vector<Vec3>> centroids_;                  // of clusters, by level
  std::vector<std::vector<std::vector<std::size_t>>> below_;  // members of clusters, by level
  std::vector<std::string> paths_;                            // of pieces
  MaterialNames materials_;
  PreviewMaterials library_;
  std::map<std::string, const PreviewMaterial*> described_;  // of the library, by name
  std::vector<std::string> images_;                          // files of the library's images
};

}  // namespace

void write_usd_pieces(std::ostream& out, const std::vector<Chunk>& chunks, const std::vector<Bond>& bonds,
                      const ChunkLabels& labels, const UsdOptions& options) {
  UsdPieces(out, chunks, bonds, labels, options).write();
}

}  // namespace geo
