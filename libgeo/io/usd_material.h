// Materials as USD text: UsdPreviewSurface with its textures.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "io/preview_material.h"

namespace geo::usd {

/// Takes one line of a layer without its indentation.
using Line = std::function<void(const std::string&)>;

/// Writes the prim of a material: a preview surface, a reader for each set of texture coordinates
/// that it uses ("st", "st1"), and a texture for each image.
/// \param path  of the prim above, without a slash at its end
/// \param name  of the prim
/// \param images  file of each image, relative to the layer; empty: no textures
void write_material(const Line& line, const std::string& path, const std::string& name, const PreviewMaterial& material,
                    const std::vector<std::string>& images);

}  // namespace geo::usd
