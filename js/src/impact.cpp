// Impacts (kerf/impact.h): solids that break where they are hit.
#include <cmath>

#include <kerf/impact.h>
#include <kerf/pieces.h>
#include "bind.h"

namespace kerf_js {
namespace {

using Breakable = geo::Breakable;
using BreakableHandle = std::shared_ptr<Breakable>;
using BreakingHandle = std::shared_ptr<geo::Breaking>;

val make_breakable(const MeshHandle& solid) {
  return guarded([&] {
    try {
      return std::make_shared<Breakable>(solid->mesh);
    } catch (const geo::InputError& e) {
      throw geo::InputError(std::string(e.what()) + ", or try Solid.repaired()");
    }
  });
}

val breakable_mesh(const BreakableHandle& solid) {
  return guarded([&] { return handle(solid->mesh()); });
}

double breakable_volume(const BreakableHandle& solid) { return solid->volume(); }

geo::ImpactOptions impact_options(const val& options) {
  geo::ImpactOptions o;
  int parts = static_cast<int>(o.hull_parts), corners = static_cast<int>(o.hull_corners);
  take(options, "toughness", o.toughness, 1e-30, 1e30);
  take(options, "maxPieces", o.max_pieces, 2, 10000);
  take(options, "grading", o.grading, 0, 4);
  take(options, "elongation", o.elongation, 0.1, 10);
  take(options, "hullParts", parts, 1, 100);
  take(options, "hullCorners", corners, 4, 10000);
  take_seed(options, "seed", o.seed);
  o.hull_parts = static_cast<std::size_t>(parts);
  o.hull_corners = static_cast<std::size_t>(corners);
  if (has(options, "guard") && options["guard"].as<bool>()) o.guard = geo::ImpactGuard::full;
  return o;
}

// Chooses where it breaks, and breaks nothing yet.
val strike(const BreakableHandle& solid, const val& point, const val& energy, const val& options) {
  return guarded([&] {
    geo::Impact impact{.point = point_from(point, "point"), .direction = geo::Vec3::Zero(), .energy = 0};
    if (has(options, "direction")) impact.direction = point_from(options["direction"], "direction");
    impact.energy = energy.isNumber() ? energy.as<double>() : std::nan("");
    return std::make_shared<geo::Breaking>(*solid, impact, impact_options(options));
  });
}

val advance_breaking(const BreakingHandle& breaking, double milliseconds) {
  return guarded([&] {
    if (!(milliseconds >= 0)) throw geo::InputError("milliseconds: give a number that is not negative");
    return breaking->advance(1e-3 * milliseconds);
  });
}

// What a part is from the start: {solid, parent, volume, centroid}; parent −1: it is the solid.
val part_made(const BreakingHandle& breaking, std::size_t index) {
  return guarded([&] {
    const geo::BrokenPart& part = breaking->parts().at(index);
    val made = val::object();
    made.set("solid", std::make_shared<Breakable>(part.solid));
    made.set("parent", part.parent < breaking->parts().size() ? static_cast<int>(part.parent) : -1);
    made.set("volume", part.solid.volume());
    made.set("centroid", array_of(geo::mass_properties(part.solid.mesh()).centroid));
    return made;
  });
}

// What may change: bit 0 of each: divided; bit 1: whole.
val part_states(const BreakingHandle& breaking) {
  std::vector<std::uint8_t> states;
  for (const geo::BrokenPart& part : breaking->parts())
    states.push_back(static_cast<std::uint8_t>((part.divided ? 1 : 0) | (part.whole ? 2 : 0)));
  return array_of(states);
}

val part_hulls(const BreakingHandle& breaking, std::size_t index) {
  return guarded([&] {
    val hulls = val::array();
    for (const geo::TriangleMesh& hull : breaking->parts().at(index).hulls) append(hulls, val(handle(hull)));
    return hulls;
  });
}

}  // namespace

EMSCRIPTEN_BINDINGS(kerf_impact) {
  emscripten::class_<Breakable>("BreakableHandle").smart_ptr<BreakableHandle>("BreakableHandle");
  emscripten::class_<geo::Breaking>("BreakingHandle").smart_ptr<BreakingHandle>("BreakingHandle");
  emscripten::function("makeBreakable", &make_breakable);
  emscripten::function("breakableMesh", &breakable_mesh);
  emscripten::function("breakableVolume", &breakable_volume);
  emscripten::function("strike", &strike);
  emscripten::function("advanceBreaking", &advance_breaking);
  emscripten::function("partMade", &part_made);
  emscripten::function("partStates", &part_states);
  emscripten::function("partHulls", &part_hulls);
}

}  // namespace kerf_js
