// fracture(), cut(), pieces_of() and save() of kerf/jobs.h.
#include <ostream>
#include <span>

#include "crack/insert.h"
#include "kerf/check.h"
#include "kerf/complex.h"
#include "kerf/error.h"
#include "kerf/files.h"
#include "kerf/jobs.h"
#include "kerf/pieces.h"

namespace geo {
namespace {

// A texture tile on inner faces is a quarter of the diagonal: the default of kerf-pieces.
constexpr double tile_share = 0.25;
// Most corners of a hull: the default of kerf-pieces, and what engines take.
constexpr std::size_t hull_corners = 64;

Complex complex_of(const TriangleMesh& model) {
  require_solid(model);
  return model.two_sided() ? Complex::from_two_sided(model) : Complex::from_skin(model);
}

TriangleMesh sheet_of(const Front& front) {
  TriangleMesh sheet;
  sheet.vertices = front.steps[0];
  sheet.triangles = front.triangles;
  return sheet;
}

}  // namespace

PieceSet pieces_of(const Complex& complex, const TriangleMesh& model) {
  const Pieces pieces = find_pieces(complex);
  PieceSet set;
  set.chunks = make_chunks(complex, pieces, model, tile_share * complex.extent().diagonal());
  set.bonds = find_bonds(complex, pieces);
  set.labels.kind = "node";
  set.labels.names = piece_names(pieces.count);
  return set;
}

PieceSet fracture(const TriangleMesh& model, const ScoreOptions& options, const Progress& progress) {
  Complex cut;
  make_score(complex_of(model), options, progress, &cut);
  return pieces_of(cut, model);
}

CrackDelta insert_sheet(Complex& complex, const TriangleMesh& sheet, std::int32_t crack, const CrackOptions& options,
                        CrackStats* stats, const Progress& progress) {
  return crack::insert_sheet_with_pauses(complex, sheet, crack, options, stats,
                                         [&] { report(progress, "crack", 0, 1); });
}

PieceSet cut(const TriangleMesh& model, const TriangleMesh& sheet, const CrackOptions& options,
             const Progress& progress) {
  Complex complex = complex_of(model);
  insert_sheet(complex, sheet, complex.crack_count() + 1, options, nullptr, progress);
  return pieces_of(complex, model);
}

PieceSet cut(const TriangleMesh& model, const Front& front, const CrackOptions& options, const Progress& progress) {
  if (front.steps.empty()) throw InputError("the front '" + front.name + "' has no points");
  if (front.is_sheet()) return cut(model, sheet_of(front), options, progress);
  if (front.steps.size() < 2) throw InputError("the front '" + front.name + "' has one step; give two at least");
  Complex complex = complex_of(model);
  FrontState state = begin_front(front.steps[0], front.closed, complex.crack_count() + 1);
  for (std::size_t step = 1; step < front.steps.size(); ++step) {
    report(progress, "crack", step - 1, front.steps.size() - 1);
    std::vector<Vec3> present;
    for (const FrontState::Point& p : state.points) present.push_back(p.position);
    advance(complex, state, resample_front(present, front.steps[step], front.closed), options);
  }
  return pieces_of(complex, model);
}

void save(const std::string& path, const PieceSet& pieces) {
  if (!path.ends_with(".glb") && !path.ends_with(".usda"))
    throw InputError(path + ": pieces are saved as .glb or .usda; give the name one of these endings");
  write_all(path, [&](std::ostream& out) {
    if (path.ends_with(".usda")) return write_usd_pieces(out, pieces.chunks, pieces.bonds, pieces.labels);
    write_glb(out, pieces.chunks, pieces.bonds, pieces.labels, {.hull_corners = hull_corners});
  });
}

}  // namespace geo
