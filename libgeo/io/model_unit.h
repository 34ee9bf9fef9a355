// The unit of length that a file of another program states, for formats whose reader does not pass
// it on.
#pragma once

#include <string>

namespace geo {

/// The metres of one unit of the coordinates of a COLLADA, X3D, AMF or 3MF file, from its text or,
/// in an archive, from the text of its model; 0 where `ending` stands for another format or the
/// file is damaged. Where such a file states no unit, that of the format's specification.
double unit_in(const std::string& bytes, const std::string& ending);

}  // namespace geo
