// Surfaces in formats of other programs (glTF, FBX, COLLADA, 3DS and more), through the library
// assimp.
#pragma once

#include <string>

#include "kerf/mesh.h"

namespace geo {

/// A format that has no reader of Kerf's own.
struct OtherFormat {
  std::string what;    ///< in a message: "a glTF file"
  std::string ending;  ///< by which assimp finds its reader, without the dot; empty: none
};

/// The format of a file by its first bytes; by the ending of `name` where these leave it open.
/// `what` is empty where it is none of these.
OtherFormat other_format(const std::string& bytes, const std::string& name);

/// Reads all meshes of such a file as one, where their nodes place them. Material names become
/// groups, colours sRGB. Polygons become triangles as in add_polygon(). Left out are points, lines,
/// collision shapes (UCX_, -convcolonly), skins and animations. Lengths are the file's. Other files
/// that it names are looked for in the folder of `name` and below. A child process reads, so
/// that a damaged file can do no harm. Throws InputError, in one line.
TriangleMesh parse_other(const std::string& bytes, const std::string& name, const OtherFormat& format);

}  // namespace geo
