// Solids are tested once, when they are made, without the GIL.
#include "apart.h"
#include "gil.h"
#include "kerf/check.h"
#include "kerf/error.h"
#include "mesh.h"

namespace kerf_python {
namespace {

// A smaller mesh is tested in less time than Ctrl-C may take.
constexpr std::size_t small_mesh = 20'000;

// The mesh, if it is a valid model; else throws InputError. A large one can be stopped.
geo::TriangleMesh tested(geo::TriangleMesh&& mesh) {
  if (mesh.triangles.size() <= small_mesh) {
    const GilRelease release;
    geo::require_solid(mesh);
    return std::move(mesh);
  }
  const auto shared = std::make_shared<geo::TriangleMesh>(std::move(mesh));
  stoppable("check", [shared](const geo::Progress&) {
    geo::require_solid(*shared);
    return true;
  });
  return std::move(*shared);
}

}  // namespace

Solid::Solid(geo::TriangleMesh m, bool known) : Mesh(known ? std::move(m) : tested(std::move(m))) {}

std::shared_ptr<Solid> solid_or_remedy(geo::TriangleMesh mesh) {
  try {
    return std::make_shared<Solid>(std::move(mesh));
  } catch (const geo::InputError& e) {
    throw geo::InputError(std::string(e.what()) + ", or try kerf.Solid.repaired()");
  }
}

std::shared_ptr<Solid> model_of(const std::shared_ptr<Mesh>& mesh) {
  if (mesh->is_model()) return std::static_pointer_cast<Solid>(mesh);
  if (mesh->mesh.two_sided()) throw geo::InputError("the mesh is cut already; give it to kerf.Complex()");
  if (!mesh->as_model) {
    geo::TriangleMesh whole = mesh->mesh;
    whole.patch.clear();
    whole.source.clear();
    auto made = solid_or_remedy(std::move(whole));
    if (!mesh->as_model) mesh->as_model = std::move(made);
  }
  return mesh->as_model;
}

std::shared_ptr<const geo::Complex> Solid::uncut() {
  if (!uncut_) {
    std::shared_ptr<const geo::Complex> made;
    {
      const GilRelease release;
      made = std::make_shared<const geo::Complex>(geo::Complex::from_skin(mesh));
    }
    if (!uncut_) uncut_ = std::move(made);
  }
  return uncut_;
}

}  // namespace kerf_python
