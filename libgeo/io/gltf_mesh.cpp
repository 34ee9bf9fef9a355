// io/gltf_mesh.h, after sections 3.5 and 3.7 of the specification.
#include "io/gltf_mesh.h"

#include <algorithm>
#include <cmath>

#include "kerf/error.h"

namespace geo {
namespace {

using Description = GltfDocument::Json;

enum class Mode : std::size_t { triangles = 4, strip = 5, fan = 6 };

double srgb(double c) {  // IEC 61966-2-1, from a linear value
  c = std::clamp(c, 0.0, 1.0);
  return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
}

Vec3 vector_at(const GltfRows& rows, std::size_t i) {
  const double* row = rows.row(i);
  return {row[0], row[1], row[2]};
}

class PrimitiveReader {
 public:
  PrimitiveReader(GltfDocument& document, const Description& primitive)
      : document_(document), primitive_(primitive), attributes_(GltfDocument::member(primitive, "attributes")) {
    require_uncompressed();
  }

  GltfPrimitive read(const std::vector<double>& morph) {
    const GltfRows* positions = rows("POSITION", 3, 3);
    if (!positions) document_.fail("has a mesh without positions");
    vertices_ = positions->count;
    for (std::size_t v = 0; v < vertices_; ++v) out_.position.push_back(vector_at(*positions, v));
    if (const GltfRows* normals = rows("NORMAL", 3, 3))
      for (std::size_t v = 0; v < vertices_; ++v) out_.normal.push_back(vector_at(*normals, v));
    move(morph);
    read_uv("TEXCOORD_0", out_.uv);
    read_uv("TEXCOORD_1", out_.uv2);
    read_color();
    read_joints();
    read_triangles();
    drop_unused();
    return std::move(out_);
  }

 private:
  // Compressed data may stand beside uncompressed ones, which then are read. An accessor without
  // any is not all zero.
  void require_uncompressed() {
    if (GltfDocument::extension(primitive_, "KHR_draco_mesh_compression").is_null()) return;
    std::vector<std::size_t> accessors;
    if (const auto at = document_.index(primitive_, "indices")) accessors.push_back(*at);
    if (attributes_.is_object())
      for (const auto& entry : attributes_.items())
        accessors.push_back(document_.size(attributes_, entry.key().c_str(), 0));
    for (const std::size_t at : accessors)
      if (!document_.index(document_.entry("accessors", at), "bufferView"))
        document_.fail(
            "holds a mesh with the glTF extension KHR_draco_mesh_compression alone, which is not read here; save it "
            "without compression");
  }

  // The rows of an attribute with as many numbers as that, one for each vertex; null where there is
  // none.
  const GltfRows* rows(const std::string& name, std::size_t least, std::size_t most) {
    const auto at = document_.index(attributes_, name.c_str());
    if (!at) return nullptr;
    const GltfRows& result = document_.rows(*at);
    if (result.width < least || result.width > most) document_.fail("its attribute " + name + " has an unknown type");
    if (vertices_ != 0 && result.count != vertices_)
      document_.fail("its attribute " + name + " has " + std::to_string(result.count) + " rows, but the mesh has " +
                     std::to_string(vertices_) + " vertices");
    return &result;
  }

  // Adds the displacements of morph targets, by weight (section 3.7.2.2).
  void move(const std::vector<double>& morph) {
    const Description& targets = GltfDocument::member(primitive_, "targets");
    for (std::size_t i = 0; i < morph.size() && targets.is_array() && i < targets.size(); ++i) {
      if (morph[i] == 0) continue;
      add(targets[i], "POSITION", morph[i], out_.position);
      add(targets[i], "NORMAL", morph[i], out_.normal);
    }
  }
  void add(const Description& target, const char* name, double weight, std::vector<Vec3>& to) {
    const auto at = document_.index(target, name);
    if (!at || to.empty()) return;
    const GltfRows& change = document_.rows(*at);
    if (change.width != 3 || change.count != vertices_) document_.fail("has a morph target that does not fit its mesh");
    for (std::size_t v = 0; v < vertices_; ++v) to[v] += weight * vector_at(change, v);
  }

  void read_uv(const char* name, std::vector<Vec2>& to) {
    const GltfRows* uv = rows(name, 2, 2);
    if (!uv) return;
    for (std::size_t v = 0; v < vertices_; ++v) {
      const Vec2 at(uv->row(v)[0], 1 - uv->row(v)[1]);  // v points downwards in glTF
      to.push_back(at.allFinite() ? at : Vec2(Vec2::Zero()));
    }
  }

  void read_color() {
    const GltfRows* color = rows("COLOR_0", 3, 4);
    if (!color) return;
    for (std::size_t v = 0; v < vertices_; ++v) {
      const double* c = color->row(v);
      const Color at(srgb(c[0]), srgb(c[1]), srgb(c[2]), color->width == 4 ? c[3] : 1.0);
      out_.color.push_back(at.allFinite() ? at : Color(Color::Ones()));
    }
  }

  // Joints in sets of four: JOINTS_0 with WEIGHTS_0 and so on.
  void read_joints() {
    constexpr std::size_t max_sets = 16;
    std::vector<std::pair<const GltfRows*, const GltfRows*>> sets;
    for (std::size_t k = 0; k < max_sets; ++k) {
      const std::string number = std::to_string(k);
      const GltfRows *joints = rows("JOINTS_" + number, 4, 4), *weights = rows("WEIGHTS_" + number, 4, 4);
      if (!joints || !weights) break;
      sets.push_back({joints, weights});
    }
    out_.joint_count = 4 * sets.size();
    for (std::size_t v = 0; v < vertices_; ++v)
      for (const auto& [joints, weights] : sets)
        for (std::size_t k = 0; k < 4; ++k) {
          out_.joint.push_back(static_cast<std::size_t>(std::max(0.0, std::min(joints->row(v)[k], 65535.0))));
          out_.weight.push_back(weights->row(v)[k]);
        }
  }

  void read_triangles() {
    std::vector<std::uint32_t> corners;
    if (const auto at = document_.index(primitive_, "indices")) {
      const GltfRows& indices = document_.rows(*at);
      if (indices.width != 1) document_.fail("has indices that are no single numbers");
      for (const double i : indices.values) {
        if (!(i >= 0 && i < static_cast<double>(vertices_)))
          document_.fail("a face names a vertex that its mesh does not have");
        corners.push_back(static_cast<std::uint32_t>(i));
      }
    } else {
      for (std::size_t v = 0; v < vertices_; ++v) corners.push_back(static_cast<std::uint32_t>(v));
    }
    const Mode mode = static_cast<Mode>(document_.size(primitive_, "mode", std::size_t(Mode::triangles)));
    if (mode == Mode::triangles) {
      if (corners.size() % 3 != 0) document_.fail("has a mesh whose number of corners is no multiple of three");
      for (std::size_t i = 0; i < corners.size(); i += 3) add_triangle(corners[i], corners[i + 1], corners[i + 2]);
      return;
    }
    for (std::size_t i = 0; i + 2 < corners.size(); ++i) {
      const std::uint32_t a = corners[i], b = corners[i + 1], c = corners[i + 2];
      // Triangles with two equal corners join strips.
      if (mode == Mode::strip && (a == b || b == c || c == a)) continue;
      if (mode == Mode::fan)
        add_triangle(b, c, corners[0]);
      else if (i % 2 == 0)
        add_triangle(a, b, c);
      else
        add_triangle(b, a, c);
    }
  }
  void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) { out_.triangles.push_back({a, b, c}); }

  // Primitives often share the vertices of a whole file.
  void drop_unused() {
    std::vector<std::uint32_t> row(vertices_, ~0u);
    for (const auto& t : out_.triangles)
      for (const auto v : t) row[v] = 0;
    std::uint32_t kept = 0;
    for (std::uint32_t& r : row)
      if (r == 0) r = kept++;
    const auto filter = [&](auto& values, std::size_t each) {
      if (values.empty()) return;
      for (std::size_t v = 0; v < vertices_; ++v)
        if (row[v] != ~0u)
          for (std::size_t k = 0; k < each; ++k) values[row[v] * each + k] = values[v * each + k];
      values.resize(kept * each);
    };
    filter(out_.position, 1);
    filter(out_.normal, 1);
    filter(out_.uv, 1);
    filter(out_.uv2, 1);
    filter(out_.color, 1);
    filter(out_.joint, out_.joint_count);
    filter(out_.weight, out_.joint_count);
    for (auto& t : out_.triangles)
      for (auto& v : t) v = row[v];
  }

  GltfDocument& document_;
  const Description &primitive_, &attributes_;
  std::size_t vertices_ = 0;
  GltfPrimitive out_;
};

Eigen::Affine3d composed(const Vec3& translation, const double* q, const Vec3& scale) {
  Eigen::Affine3d result = Eigen::Affine3d::Identity();
  result.translate(translation);
  const Eigen::Quaterniond rotation(q[3], q[0], q[1], q[2]);
  if (rotation.norm() > 0) result.rotate(rotation.normalized());
  result.scale(scale);
  return result;
}

}  // namespace

bool has_triangles(const GltfDocument& document, const Description& primitive) {
  const std::size_t mode = document.size(primitive, "mode", std::size_t(Mode::triangles));
  if (mode > std::size_t(Mode::fan)) document.fail("has a primitive of an unknown mode");
  return mode >= std::size_t(Mode::triangles);
}

GltfPrimitive read_primitive(GltfDocument& document, const Description& primitive, const std::vector<double>& morph) {
  return PrimitiveReader(document, primitive).read(morph);
}

Eigen::Affine3d transform_of(const GltfDocument& document, const Description& node) {
  const auto matrix = document.numbers(node, "matrix", 16);
  if (!matrix.empty()) {
    Eigen::Affine3d result;
    result.matrix() = Eigen::Map<const Eigen::Matrix4d>(matrix.data());  // both by columns
    return result;
  }
  auto t = document.numbers(node, "translation", 3), q = document.numbers(node, "rotation", 4),
       s = document.numbers(node, "scale", 3);
  if (t.empty()) t = {0, 0, 0};
  if (q.empty()) q = {0, 0, 0, 1};
  if (s.empty()) s = {1, 1, 1};
  return composed({t[0], t[1], t[2]}, q.data(), {s[0], s[1], s[2]});
}

std::vector<Eigen::Affine3d> instances_of(GltfDocument& document, const Description& node) {
  const Description& extension = GltfDocument::extension(node, "EXT_mesh_gpu_instancing");
  if (extension.is_null()) return {Eigen::Affine3d::Identity()};
  const Description& attributes = GltfDocument::member(extension, "attributes");
  std::optional<std::size_t> count;
  const auto rows = [&](const char* name, std::size_t width) -> const GltfRows* {
    const auto at = document.index(attributes, name);
    if (!at) return nullptr;
    const GltfRows& result = document.rows(*at);
    if (result.width != width || result.count != count.value_or(result.count))
      document.fail("has instances (EXT_mesh_gpu_instancing) whose attributes do not fit");
    count = result.count;
    return &result;
  };
  const GltfRows *t = rows("TRANSLATION", 3), *q = rows("ROTATION", 4), *s = rows("SCALE", 3);
  if (!count) document.fail("has instances (EXT_mesh_gpu_instancing) without a place");
  static constexpr double straight[4] = {0, 0, 0, 1};
  std::vector<Eigen::Affine3d> result;
  for (std::size_t i = 0; i < *count; ++i)
    result.push_back(composed(t ? vector_at(*t, i) : Vec3(Vec3::Zero()), q ? q->row(i) : straight,
                              s ? vector_at(*s, i) : Vec3(Vec3::Ones())));
  return result;
}

}  // namespace geo
