// The body of a live run as a file in memory.
#pragma once

#include <string>

#include "live/session.h"

namespace live {

/// The formats of saved files, for messages.
constexpr const char* save_formats = "as=kerf, ply, glb, stl, toml or model";
/// Whether a file is saved so.
bool is_save_format(const std::string& format);

/// The body as it is now: "kerf" a body in material coordinates, "ply" and "stl" the deformed
/// surface, "glb" its pieces, "toml" the recording. `folder`: of the recording, for paths in it.
/// The .glb has the colours of the model.
/// Throws InputError for a recording of a scene that cannot be written.
std::string saved_file(const Session& session, const std::string& format, const std::string& folder);

}  // namespace live
