// What the handles of meshes, bytes, complexes and pieces stand for.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "handle.h"
#include "kerf.h"
#include "kerf/complex.h"
#include "kerf/crack.h"
#include "kerf/error.h"
#include "kerf/export.h"
#include "kerf/mesh.h"
#include "kerf/score.h"

namespace kerf_c {

/// A file in memory.
struct BytesObject : Object {
  static constexpr Kind kind = Kind::bytes;  ///< of this object
  /// Of these bytes.
  explicit BytesObject(std::string data) : Object(kind), bytes(std::move(data)) {}
  const std::string bytes;
};

/// A mesh, which never changes.
struct MeshObject : Object {
  static constexpr Kind kind = Kind::mesh;  ///< of this object
  /// Of this mesh.
  explicit MeshObject(std::shared_ptr<const geo::TriangleMesh> of) : Object(kind), kept(std::move(of)), mesh(*kept) {
    for (const std::string& name : mesh.attributes.group_names) group_names.push_back(name.c_str());
  }
  const std::shared_ptr<const geo::TriangleMesh> kept;
  const geo::TriangleMesh& mesh;
  std::vector<const char*> group_names;  ///< of mesh.attributes
};

/// The result of a call that needs a solid. Where it throws InputError, the message names the
/// function that makes one.
template <class Call>
auto of_solid(const Call& call) {
  try {
    return call();
  } catch (const geo::InputError& e) {
    throw geo::InputError(std::string(e.what()) + ", or try kerf_mesh_repaired()");
  }
}

struct FrontObject;

/// A model with its cracks.
struct ComplexObject : Object {
  static constexpr Kind kind = Kind::complex;  ///< of this object
  /// Of a surface, whose attributes pieces take.
  ComplexObject(geo::Complex of, std::shared_ptr<const geo::TriangleMesh> surface)
      : Object(kind), complex(std::move(of)), model(std::move(surface)), numbers(complex) {}
  geo::Complex complex;
  std::shared_ptr<const geo::TriangleMesh> model;
  geo::CrackNumbers numbers;
  std::weak_ptr<FrontObject> moved;  ///< the front that made the last edit
  geo::FrontState before;            ///< of `moved`, before that edit
  std::uint64_t healed = 0;          ///< how often all of it was changed: fronts have ended
  bool changed_whole = false;        ///< by the last edit, of many steps: it cannot be taken back
};

/// A front that cuts a complex. Whoever uses it uses the complex.
struct FrontObject : Object {
  static constexpr Kind kind = Kind::front;  ///< of this object
  /// In this complex.
  FrontObject(std::shared_ptr<ComplexObject> in, geo::FrontState at)
      : Object(kind), complex(std::move(in)), state(std::move(at)), healed(complex->healed) {}
  std::shared_ptr<ComplexObject> complex;
  geo::FrontState state;
  std::uint64_t healed;  ///< of the complex, when the front began
};

/// Pieces with their bonds, which never change.
struct PiecesObject : Object {
  static constexpr Kind kind = Kind::pieces;  ///< of this object
  /// Of these pieces.
  explicit PiecesObject(geo::PieceSet of);
  const geo::PieceSet set;
  std::vector<kerf_bond> bonds;  ///< of `set`
};

/// A handle for a mesh.
std::shared_ptr<Object> object_for(geo::TriangleMesh mesh);
/// The mesh as a model that can be cut, and its complex. Throws InputError where it is no solid.
std::shared_ptr<ComplexObject> complex_for(const std::shared_ptr<const geo::TriangleMesh>& mesh);
/// Options of the C interface as the library has them. Throws ArgumentError.
geo::ScoreOptions score_options_of(const kerf_score_options* options);

}  // namespace kerf_c
