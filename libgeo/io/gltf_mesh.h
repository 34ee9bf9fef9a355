// Primitives of a glTF document as triangles, and the places of its nodes.
#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "io/gltf_document.h"
#include "kerf/mesh.h"

namespace geo {

/// The triangles of one primitive, in its mesh's coordinates. Attributes are empty where it has
/// none.
struct GltfPrimitive {
  std::vector<Vec3> position, normal;
  std::vector<Vec2> uv, uv2;  ///< the first two sets; v from the bottom
  std::vector<Color> color;   ///< sRGB
  std::vector<Triangle> triangles;
  /// For each vertex the joints of its skin with their weights, `joint_count` a vertex.
  std::vector<std::size_t> joint;
  std::vector<double> weight;
  std::size_t joint_count = 0;
};

/// Whether a primitive has triangles, not points or lines.
bool has_triangles(const GltfDocument& document, const GltfDocument::Json& primitive);

/// The triangles of a primitive: lists, strips and fans. `morph`: weights of its morph targets, or
/// empty. Vertices that no triangle names are left out. Throws InputError.
GltfPrimitive read_primitive(GltfDocument& document, const GltfDocument::Json& primitive,
                             const std::vector<double>& morph);

/// The transform of a node within its parent: its matrix, or scale, rotation, translation in this
/// order. Throws InputError.
Eigen::Affine3d transform_of(const GltfDocument& document, const GltfDocument::Json& node);

/// The transforms of the instances of a node (EXT_mesh_gpu_instancing) within it; one, the
/// identity, without the extension. Throws InputError.
std::vector<Eigen::Affine3d> instances_of(GltfDocument& document, const GltfDocument::Json& node);

}  // namespace geo
