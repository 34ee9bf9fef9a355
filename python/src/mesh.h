// The classes Mesh and Solid: immutable triangle meshes whose arrays Python sees without a copy.
#pragma once

#include <memory>
#include <string>

#include "arrays.h"
#include "kerf/complex.h"
#include "kerf/mesh.h"

namespace kerf_python {

struct Solid;

/// A mesh that never changes after it was made: views of its arrays stay valid as long as they
/// live.
struct Mesh {
  /// Takes the mesh over.
  explicit Mesh(geo::TriangleMesh m) : mesh(std::move(m)) {}
  virtual ~Mesh() = default;
  const geo::TriangleMesh mesh;     ///< as given
  std::shared_ptr<Solid> as_model;  ///< kept by model_of(); null until then
  /// Whether it was found to be a valid model without a patch.
  virtual bool is_model() const { return false; }
};

/// A valid model: closed, manifold, oriented outwards, free of self-intersection.
struct Solid : Mesh {
  /// Checks the mesh with geo::require_solid() unless it is known to be one; throws InputError.
  explicit Solid(geo::TriangleMesh m, bool known = false);
  /// Its crack complex without cracks, made at the first call. To be called with the GIL.
  std::shared_ptr<const geo::Complex> uncut();
  bool is_model() const override { return true; }

 private:
  std::shared_ptr<const geo::Complex> uncut_;
};

/// The model of a mesh. Throws InputError, whose message names the remedy of the module, where it
/// is none.
std::shared_ptr<Solid> solid_or_remedy(geo::TriangleMesh mesh);

/// The model of a mesh: itself where it is_model(), else a Solid of its triangles and attributes,
/// checked once. Throws as solid_or_remedy(), and for a cut surface. To be called with the GIL.
std::shared_ptr<Solid> model_of(const std::shared_ptr<Mesh>& mesh);

/// The mesh with edges of at most `longest`, model units. Throws InputError for a two-sided mesh,
/// and where that would make more than 20 million triangles, and Interrupted. To be called with the
/// GIL.
geo::TriangleMesh refined_mesh(const std::shared_ptr<Mesh>& mesh, double longest, const py::object& progress);

/// The arrays of a mesh as Python gives them; None where there is none.
struct MeshArguments {
  py::object vertices, faces, uv, normals, colors, groups, group_names, patch, site, source;
  std::string materials;  ///< the file that describes materials, or empty
};

/// Checks and copies the arrays of a mesh. Attributes may have one value per vertex or per corner.
/// Throws geo::InputError in one sentence.
geo::TriangleMesh mesh_from(const MeshArguments& arguments);

/// The mesh of an argument that is a Mesh, or an object with `vertices` and `faces`. Throws
/// InputError for any other object.
std::shared_ptr<Mesh> mesh_argument(py::handle object, const std::string& name);

}  // namespace kerf_python
