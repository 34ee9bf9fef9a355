// Scenes of the module: read with overrides, which may be added later.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <utility>

#include "arrays.h"
#include "kerf/files.h"
#include "kerf/scene.h"

namespace kerf_python {

/// The text of a scene and what it says. It never changes.
struct Scene {
  /// Parses the text; files that it names are relative to `f`. Throws geo::InputError. Without the
  /// GIL.
  Scene(std::string t, std::string n, std::string f, geo::SceneOverrides o);
  std::string text, name, folder;
  std::filesystem::path place;  ///< the current folder when it was made
  geo::SceneOverrides overrides;
  geo::Scene scene;
};

/// Overrides from a dict of dotted keys and from keywords such as young=8e4. Throws geo::InputError
/// for a keyword that is no key, with the nearest one.
geo::SceneOverrides overrides_from(py::handle set, const py::kwargs& keys);

/// The scene of an argument, with further overrides: a Scene, the path of a file, or a text of
/// several lines. Throws geo::InputError.
std::shared_ptr<const Scene> scene_argument(py::handle object, geo::SceneOverrides overrides);

/// Keyframes as rows [time, x, y, z, ax, ay, az, degrees], and back; throws geo::InputError.
py::array keys_to(const geo::Motion& motion);
geo::Motion keys_from(py::handle object, const std::string& name);

/// The named fields of the scene's objects.
void bind_scene_objects(py::module_& module);

}  // namespace kerf_python
