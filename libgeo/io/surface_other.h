// Surfaces in formats of other programs (glTF, FBX, COLLADA, 3DS and more), through the library
// assimp.
#pragma once

#include <string>

#include "kerf/files.h"

namespace geo {

/// A format that has no reader of Kerf's own.
struct OtherFormat {
  std::string what;    ///< in a message: "a glTF file"
  std::string ending;  ///< by which assimp finds its reader, without the dot; empty: none
};

/// The format of a file by its first bytes; by the ending of `name` where these leave it open.
/// `what` is empty where it is none of these.
OtherFormat other_format(const std::string& bytes, const std::string& name);

/// Reads all meshes of such a file as one, where their nodes and bones place them. Material names
/// become groups, colours sRGB. Polygons become triangles as in add_polygon(). Left out, with a
/// note, are points, lines, collision shapes (UCX_, -convcolonly) and animations. Coordinates are
/// the file's, with its unit where it has one. Other files that it names are looked for in the
/// folder of `name` and below. glTF is read by parse_gltf(), all others in a child process, so that
/// a damaged file can do no harm. Throws InputError, in one line.
SurfaceFile parse_other(const std::string& bytes, const std::string& name, const OtherFormat& format);

}  // namespace geo
