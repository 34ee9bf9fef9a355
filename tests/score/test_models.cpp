// The guarantees of a score on pieces and bonds, for twenty models and five patterns: the hundred
// cases of CONTRIBUTING.md.
#include <catch2/catch.hpp>
#include <iostream>

#include "cases.h"
#include "kerf/check.h"
#include "kerf/crack.h"
#include "kerf/error.h"
#include "kerf/pieces.h"
#include "kerf/score.h"
#include "score/models.h"

using namespace geo;

namespace {

using score_models::model_of;
const auto& models = score_models::names;
const std::vector<std::string> patterns{"voronoi", "planes", "wood", "bricks", "glass"};

double area_of(const TriangleMesh& mesh, std::size_t t) {
  const auto& c = mesh.triangles[t];
  return 0.5 * (mesh.vertices[c[1]] - mesh.vertices[c[0]]).cross(mesh.vertices[c[2]] - mesh.vertices[c[0]]).norm();
}

// The pieces of a model that was cut: each closed and without self-intersection; their volumes sum
// to the model's, the bonds' areas to half that of all crack sheets, both within 1e-12.
void check_pieces(const TriangleMesh& model, const Complex& cut, const Pieces& pieces) {
  const auto bonds = find_bonds(cut, pieces);
  const double had = signed_volume(model);
  double volume = 0, sheets = 0, shared = 0;
  for (std::uint32_t p = 0; p < pieces.count; ++p) {
    TriangleMesh mesh = piece_mesh(cut, pieces, p);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      if (mesh.patch[t] != 0) sheets += area_of(mesh, t);
    volume += signed_volume(mesh);
    mesh.patch.clear();
    mesh.site.clear();  // as a mesh of its own
    const auto whole = check_surface(mesh, SelfIntersections::find);
    INFO("piece " << p << ": " << whole.first_problem);
    CHECK((whole.closed && whole.manifold && whole.oriented && whole.degenerate_faces == 0 &&
           whole.self_intersections == 0));
  }
  for (const Bond& bond : bonds) {
    CHECK((bond.a < bond.b && bond.b < pieces.count && bond.area > 0));
    shared += bond.area;
  }
  CHECK(std::abs(volume - had) <= 1e-12 * had);
  CHECK(std::abs(shared - 0.5 * sheets) <= 1e-12 * shared);
}

}  // namespace

TEST_CASE("Models fall into whole pieces", "[score][models]") {
  const auto only = std::getenv("KERF_CASE");
  const std::size_t all = models.size() * patterns.size(), first = only ? std::stoul(only) - 1 : 0;
  const std::size_t end = only ? first + 1 : std::min<std::size_t>(all, static_cast<std::size_t>(cases(5)));
  REQUIRE(end <= all);
  for (std::size_t c = first; c < end; ++c) {
    const auto& name = models[c % models.size()];
    const auto& pattern = patterns[(c + c / models.size()) % patterns.size()];
    INFO("case " << c + 1 << ": " << name << ", " << pattern);
    const TriangleMesh mesh = model_of(name);
    REQUIRE_NOTHROW(require_solid(mesh));
    Complex cut = Complex::from_skin(mesh);
    ScoreOptions options;
    options.pattern.pattern = pattern_named(pattern);
    options.pattern.seed = options.jagged.seed = c + 1;
    options.pieces = 20;
    options.jagged.amplitude = 0.01;
    const Score score = make_score(cut, options);
    insert_sheet(cut, score.sheet, 1);
    CHECK(check_complex(cut, SelfIntersections::find).first_problem == "");
    const Pieces pieces = find_pieces(cut);
    CHECK(pieces.count == score.pieces);
    CHECK(pieces.count > 1);
    check_pieces(mesh, cut, pieces);
    if (std::getenv("KERF_TELL"))
      std::cout << "case " << c + 1 << ": " << name << ", " << pattern << ": " << pieces.count << " pieces"
                << std::endl;
  }
}
