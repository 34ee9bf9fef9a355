// Impacts of kerf.h.
#include "kerf/impact.h"

#include "call.h"
#include "kerf/pieces.h"
#include "objects.h"

namespace kerf_c {
namespace {

struct SolidObject : Object {
  static constexpr Kind kind = Kind::solid;
  explicit SolidObject(geo::Breakable of) : Object(kind), solid(std::move(of)) {}
  const geo::Breakable solid;
};

struct BreakingObject : Object {
  static constexpr Kind kind = Kind::breaking;
  explicit BreakingObject(geo::Breaking of) : Object(kind), breaking(std::move(of)) {}
  geo::Breaking breaking;
};

// The mesh of a solid, shared with it.
std::shared_ptr<Object> mesh_of(const geo::Breakable& solid) {
  const auto kept = std::make_shared<const geo::Breakable>(solid);
  return std::make_shared<MeshObject>(std::shared_ptr<const geo::TriangleMesh>(kept, &kept->mesh()));
}

const geo::BrokenPart& part_at(const BreakingObject& breaking, std::size_t index) {
  const auto& parts = breaking.breaking.parts();
  if (index >= parts.size())
    throw ArgumentError("index: there is no part " + std::to_string(index) + ", but " + std::to_string(parts.size()) +
                        " from 0 on");
  return parts[index];
}

geo::ImpactOptions options_of(const kerf_impact_options* given) {
  kerf_impact_options from;
  kerf_impact_defaults(&from);
  if (given) from = *given;
  return {.toughness = from.toughness,
          .max_pieces = from.max_pieces,
          .grading = from.grading,
          .elongation = from.elongation,
          .hull_parts = from.hull_parts,
          .hull_corners = from.hull_corners,
          .seed = from.seed,
          .guard = flag_of(from.guard, "guard") ? geo::ImpactGuard::full : geo::ImpactGuard::none};
}

double seconds_of(double budget_ms) { return 1e-3 * number_of(budget_ms, 0, 1e9, "budget_ms"); }

}  // namespace
}  // namespace kerf_c

using namespace kerf_c;

kerf_status kerf_solid_create(kerf_mesh mesh, kerf_solid* solid) {
  return call([&] {
    NewHandle out(solid, "solid");
    const Reading<MeshObject> use(mesh);
    out.set(std::make_shared<SolidObject>(of_solid([&] { return geo::Breakable(use->mesh); })));
  });
}

kerf_status kerf_solid_mesh(kerf_solid solid, kerf_mesh* mesh) {
  return call([&] {
    NewHandle out(mesh, "mesh");
    const Reading<SolidObject> use(solid);
    out.set(mesh_of(use->solid));
  });
}

kerf_status kerf_impact_defaults(kerf_impact_options* options) {
  return call([&] {
    const geo::ImpactOptions from;
    kerf_impact_options to{};
    to.toughness = from.toughness;
    to.max_pieces = from.max_pieces;
    to.grading = from.grading;
    to.elongation = from.elongation;
    to.hull_parts = static_cast<std::uint32_t>(from.hull_parts);
    to.hull_corners = static_cast<std::uint32_t>(from.hull_corners);
    to.seed = from.seed;
    required(options, "options") = to;
  });
}

kerf_status kerf_break(kerf_solid solid, const double point[3], const double direction[3], double energy,
                       double budget_ms, const kerf_impact_options* options, kerf_breaking* breaking,
                       int32_t* finished) {
  return call([&] {
    NewHandle out(breaking, "breaking");
    std::int32_t& done = required(finished, "finished");
    const geo::Impact impact{point_of(point, "point"), point_of(direction, "direction"), energy};
    const double seconds = seconds_of(budget_ms);
    const Reading<SolidObject> use(solid);
    geo::Breaking made(use->solid, impact, options_of(options));
    done = made.advance(seconds) ? 1 : 0;
    out.set(std::make_shared<BreakingObject>(std::move(made)));
  });
}

kerf_status kerf_break_continue(kerf_breaking breaking, double budget_ms, int32_t* finished) {
  return call([&] {
    std::int32_t& done = required(finished, "finished");
    const double seconds = seconds_of(budget_ms);
    const Writing<BreakingObject> use(breaking);
    done = use->breaking.advance(seconds) ? 1 : 0;
  });
}

kerf_status kerf_breaking_count(kerf_breaking breaking, size_t* count) {
  return call([&] {
    std::size_t& to = required(count, "count");
    const Reading<BreakingObject> use(breaking);
    to = use->breaking.parts().size();
  });
}

kerf_status kerf_breaking_part(kerf_breaking breaking, size_t index, kerf_part* part) {
  return call([&] {
    kerf_part& to = required(part, "part");
    const Reading<BreakingObject> use(breaking);
    const geo::BrokenPart& from = part_at(*use, index);
    const geo::MassProperties mass = geo::mass_properties(from.solid.mesh());
    to.parent = from.parent == ~std::size_t(0) ? -1 : static_cast<std::int32_t>(from.parent);
    to.divided = from.divided ? 1 : 0;
    to.whole = from.whole ? 1 : 0;
    to.hulls = static_cast<std::uint32_t>(from.hulls.size());
    to.volume = mass.volume;
    copy_point(mass.centroid, to.centroid);
    copy_matrix(mass.inertia, to.inertia);
  });
}

kerf_status kerf_breaking_mesh(kerf_breaking breaking, size_t index, kerf_mesh* mesh) {
  return call([&] {
    NewHandle out(mesh, "mesh");
    const Reading<BreakingObject> use(breaking);
    out.set(mesh_of(part_at(*use, index).solid));
  });
}

kerf_status kerf_breaking_hull(kerf_breaking breaking, size_t index, size_t hull, kerf_mesh* mesh) {
  return call([&] {
    NewHandle out(mesh, "mesh");
    const Reading<BreakingObject> use(breaking);
    const auto& hulls = part_at(*use, index).hulls;
    if (hull >= hulls.size())
      throw ArgumentError("hull: the part has " + std::to_string(hulls.size()) +
                          " hulls; it has them once it is whole");
    out.set(object_for(hulls[hull]));
  });
}

kerf_status kerf_breaking_solid(kerf_breaking breaking, size_t index, kerf_solid* solid) {
  return call([&] {
    NewHandle out(solid, "solid");
    const Reading<BreakingObject> use(breaking);
    out.set(std::make_shared<SolidObject>(part_at(*use, index).solid));
  });
}
