// Materials and images of a glTF file that travel with a surface, as a .glb of their own without
// nodes and meshes.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "io/glb_file.h"
#include "io/gltf_document.h"

namespace geo {

/// A material of a document, and the group of the surface that has it.
struct GltfGroup {
  std::size_t material = 0;
  std::string name;
};

/// Materials as bytes of a .glb.
struct GltfLibrary {
  std::string glb;
  std::size_t dropped = 0;          ///< uses of textures that name texture coordinates which the surface lacks
  std::vector<std::string> faults;  ///< images that are left out: "image brick, which is cut off"
};
/// A .glb with these materials, named as their groups, and the textures, samplers and images that
/// they use. Images are copied byte by byte. `uv_sets`: the number of sets of texture coordinates
/// that the surface has. Images with an image_fault(), or that are not there, are left out with the
/// textures that use them.
GltfLibrary materials_of(GltfDocument& document, const std::vector<GltfGroup>& groups, std::size_t uv_sets);

/// Adds the materials, textures, samplers and images of such a .glb to a file. Returns the names of
/// the materials, which stand in the file's list in this order. Throws InputError where the bytes
/// are no such .glb.
/// With `renamed`, adds those that are its keys, by the names that are its values.
std::vector<std::string> add_materials(GlbFile& file, const std::string& materials,
                                       const std::map<std::string, std::string>& renamed = {});

}  // namespace geo
