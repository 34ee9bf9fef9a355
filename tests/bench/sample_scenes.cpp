// Models by the generators of kerf/mesh.h.
#include "sample_scenes.h"

#include <stdexcept>

namespace bench {

geo::Scene sample_scene(const std::string& name, const geo::SceneOverrides& overrides) {
  const std::string folder = KERF_SCENES;
  return geo::parse_scene(geo::read_all(folder + "/" + name + ".toml"), name, overrides, folder);
}

std::vector<geo::TriangleMesh> sample_models(const std::string& name, int fineness) {
  const auto or_else = [&](int own) { return fineness > 0 ? fineness : own; };
  if (name == "apple") return {geo::make_apple(or_else(18))};
  if (name == "polyp") return {geo::make_polyp(or_else(8))};
  if (name == "jello") return {geo::make_block({2, 1, 1}, 0.08)};
  if (name == "halve") return {geo::make_pumpkin(or_else(22))};
  if (name != "letters") throw std::invalid_argument("the models of scene '" + name + "' are not known");
  std::vector<geo::TriangleMesh> letters;
  for (const char letter : {'K', 'E', 'R', 'F'}) letters.push_back(geo::make_letter(letter, 0.25, or_else(24)));
  return letters;
}

}  // namespace bench
