// The body of a live run as a file in memory.
#pragma once

#include <string>

#include "live/session.h"

namespace live {

/// The body as it is now: "kerf" a body in material coordinates, "ply" and "stl" the deformed
/// surface, "glb" its pieces, "toml" the recording. `folder`: of the recording, for paths in it.
/// Throws InputError for a recording of a scene that cannot be written.
std::string saved_file(const Session& session, const std::string& format, const std::string& folder);

}  // namespace live
