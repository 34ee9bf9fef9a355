// Solids are tested once, when they are made, without the GIL.
#include "gil.h"
#include "kerf/check.h"
#include "kerf/error.h"
#include "mesh.h"

namespace kerf_python {

Solid::Solid(geo::TriangleMesh m, bool known) : Mesh(std::move(m)) {
  if (!known) {
    const GilRelease release;
    geo::require_solid(mesh);
  }
}

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
