// The door to the library assimp, which is loaded when a file first needs it.
#pragma once

#include <string>

#include "kerf/files.h"

namespace geo {

/// Loads the library. Throws InputError, which says what to install.
void load_assimp();

/// Reads bytes of the format that `ending` stands for. `name`: of the file, whose folder holds what
/// it names. To be called in a child process: damaged files crash assimp. Throws InputError with
/// what assimp says. Precondition: load_assimp() has returned.
SurfaceFile assimp_surface(const std::string& bytes, const std::string& name, const std::string& ending);

}  // namespace geo
