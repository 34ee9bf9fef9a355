// io/surface_assimp.h: assimp in a child process, whose result comes back as PLY.
#include "io/surface_assimp.h"

#include <algorithm>
#include <sstream>

#include "io/assimp_scene.h"
#include "io/in_child.h"
#include "io/model_unit.h"
#include "kerf/error.h"

namespace geo {

SurfaceFile parse_by_assimp(const std::string& bytes, const std::string& name, const OtherFormat& format) {
  const std::string save = "; save it as PLY, OBJ, STL or OFF";
  try {
    load_assimp();
  } catch (const InputError& missing) {
    throw InputError(name + ": is " + format.what + " and " + missing.what() + ", or save it as PLY, OBJ, STL or OFF");
  }
  const std::size_t megabytes = bytes.size() >> 20;
  const ChildLimits limits{(1ull << 30) + 200 * bytes.size(),
                           static_cast<unsigned>(15 + std::min<std::size_t>(megabytes, 3600))};
  std::string result;
  const auto work = [&](std::ostream& out) {
    const SurfaceFile file = assimp_surface(bytes, name, format.ending);
    for (const std::string& note : file.notes) out << note << '\n';
    out << '\n';  // a line without text ends the notes
    write_ply(out, file.mesh);
  };
  try {
    result = in_child(work, limits);
  } catch (const ChildFailure& failure) {
    throw InputError(name + ": is " + format.what + ", and assimp, which reads such files, " + failure.what() +
                     " on it; it may be damaged" + save);
  } catch (const InputError& error) {
    throw InputError(error.what() + save);
  }
  std::vector<std::string> notes;
  std::size_t at = 0;
  for (std::size_t end; (end = result.find('\n', at)) != at; at = end + 1) notes.push_back(result.substr(at, end - at));
  SurfaceFile file = parse_surface(result.substr(at + 1), name);
  file.notes.insert(file.notes.end(), notes.begin(), notes.end());
  if (const double unit = unit_in(bytes, format.ending); unit > 0) file.mesh.unit = unit;
  return file;
}

}  // namespace geo
