// Breaks a ball along a Voronoi pattern; writes the pieces for a game engine: meshes, bonds, convex
// hulls.
#include <cstdio>
#include <fstream>
#include <string>

#include <kerf/crack.h>
#include <kerf/export.h>
#include <kerf/mesh.h>
#include <kerf/pieces.h>
#include <kerf/score.h>

int main() {
  const geo::TriangleMesh ball = geo::make_sphere(8);
  geo::Complex complex = geo::Complex::from_skin(ball);

  geo::ScoreOptions options;
  options.pattern.pattern = geo::Pattern::voronoi;
  options.pieces = 6;
  options.jagged.amplitude = 0;  // flat walls; roughen() below makes them jagged
  const geo::Score score = geo::make_score(complex, options);

  const geo::CrackDelta cut = geo::insert_sheet(complex, score.sheet, 1);
  geo::remesh(complex, cut.new_crack_faces, {});
  geo::roughen(complex, {}, {.amplitude = 0.005});

  const geo::Pieces pieces = geo::find_pieces(complex);
  const std::vector<geo::Chunk> chunks = geo::make_chunks(complex, pieces, ball, 0.5);
  const std::vector<geo::Bond> bonds = geo::find_bonds(complex, pieces);
  for (const geo::Bond& bond : bonds) std::printf("pieces %u and %u share %.4f\n", bond.a, bond.b, bond.area);
  const auto hulls = geo::convex_decomposition(chunks[0].mesh, 4, 32);
  std::printf("%u pieces; the largest in %zu convex hulls\n", pieces.count, hulls.size());

  const geo::ChunkLabels labels{.kind = "node", .names = geo::piece_names(pieces.count)};
  std::ofstream out("pieces.glb", std::ios::binary);
  geo::write_glb(out, chunks, bonds, labels, {.hull_corners = 32});
  return pieces.count == score.pieces && !bonds.empty() && !hulls.empty() ? 0 : 1;
}
