#include <catch2/catch.hpp>

#include "cases.h"
#include "invariants/random_cuts.h"
#include "kerf/mesh.h"
#include "kerf/pieces.h"

using namespace geo;

TEST_CASE("Pieces and bonds account for all of a cut body", "[chunks]") {
  const auto [first, count] = seeds(20);
  for (int c = 0; c < count; ++c) {
    const auto seed = first + static_cast<std::uint64_t>(c);
    INFO("seed " << seed);
    Random random(seed);
    TriangleMesh model = make_sphere(6);
    if (seed % 2) {
      for (const auto& t : model.triangles) {
        model.attributes.uv.push_back({Vec2(0.5, model.vertices[t[0]].y()), Vec2(0.5, model.vertices[t[1]].y()),
                                       Vec2(0.5, model.vertices[t[2]].y())});
        model.attributes.group.push_back(0);
      }
      model.attributes.group_names = {"peel"};
    }
    Complex complex = Complex::from_skin(model);
    for (std::int32_t crack = 1; crack <= 3; ++crack) {
      const auto cut = random_cuts::make_cut(complex.extent(), random);
      auto front = begin_front(cut.at(0), false, crack);
      advance(complex, front, cut.at(1));
    }
    const Pieces pieces = find_pieces(complex);
    const auto bonds = find_bonds(complex, pieces);
    const auto chunks = make_chunks(complex, pieces, model, 0.5);
    REQUIRE(chunks.size() == pieces.count);

    double between = 0, shared = 0, volume = 0;
    Vec3 moment = Vec3::Zero();
    for (std::uint32_t f = 0; f < complex.face_count(); ++f)
      if (complex.alive(FaceId(f)) && complex.face(FaceId(f)).crack > 0 &&
          pieces.of_side[2 * f] != pieces.of_side[2 * f + 1]) {
        const auto p = complex.corners(FaceId(f));
        between += 0.5 * (p[1] - p[0]).cross(p[2] - p[0]).norm();
      }
    for (const Bond& b : bonds) {
      CHECK(b.a < b.b);
      CHECK(b.b < pieces.count);
      CHECK(b.normal.norm() == Approx(1));
      shared += b.area;
    }
    CHECK(std::abs(shared - between) <= 1e-12 * (between + 1));
    double sheets = 0;
    for (const Chunk& chunk : chunks) {
      const TriangleMesh& mesh = chunk.mesh;
      CHECK(mesh.site.empty());
      CHECK(std::abs(signed_volume(mesh) - chunk.volume) <= 1e-12);
      volume += chunk.volume;
      moment += chunk.volume * chunk.centroid;
      REQUIRE(mesh.attributes.group.size() == mesh.triangles.size());
      REQUIRE(mesh.attributes.uv.size() == mesh.triangles.size());
      for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const std::string& group = mesh.attributes.group_names[std::size_t(mesh.attributes.group[t])];
        CHECK(group == (mesh.patch[t] != 0 ? "crack" : seed % 2 ? "peel" : "skin"));
        for (std::size_t k = 0; k < 3; ++k)
          if (mesh.patch[t] == 0) CHECK(mesh.attributes.uv[t][k].x() == Approx(seed % 2 ? 0.5 : 0));
        if (mesh.patch[t] == 0) continue;
        const Vec3 &p = mesh.vertices[mesh.triangles[t][0]], &q = mesh.vertices[mesh.triangles[t][1]],
                   &r = mesh.vertices[mesh.triangles[t][2]];
        sheets += 0.5 * (q - p).cross(r - p).norm();
        // Lengths along the wall's plane are kept, on the tile's scale, and none becomes longer.
        CHECK((mesh.attributes.uv[t][1] - mesh.attributes.uv[t][0]).norm() <= (q - p).norm() / 0.5 + 1e-12);
      }
    }
    double inside = 0;
    for (std::uint32_t f = 0; f < complex.face_count(); ++f)
      if (complex.alive(FaceId(f)) && complex.face(FaceId(f)).crack > 0) {
        const auto p = complex.corners(FaceId(f));
        inside += 0.5 * (p[1] - p[0]).cross(p[2] - p[0]).norm();
      }
    CHECK(sheets == Approx(2 * inside).epsilon(1e-12));
    CHECK(volume == Approx(signed_volume(model)).epsilon(1e-12));
    CHECK((moment / volume).norm() < 1e-9);  // a ball's centroid, whatever it was cut into
  }
}

TEST_CASE("A flat wall's texture keeps its shape on both sides", "[chunks]") {
  const TriangleMesh block = make_block({2, 1, 1}, 2);
  Complex complex = Complex::from_skin(block);
  auto front = begin_front(std::vector<Vec3>{{0.7, -1, -1}, {0.7, -1, 2}}, false, 1);
  advance(complex, front, std::vector<Vec3>{{0.7, 2, -1}, {0.7, 2, 2}});
  const Pieces pieces = find_pieces(complex);
  const auto bonds = find_bonds(complex, pieces);
  REQUIRE(bonds.size() == 1);
  CHECK(bonds[0].area == Approx(1));
  CHECK((bonds[0].centroid - Vec3(0.7, 0.5, 0.5)).norm() < 1e-12);
  CHECK((bonds[0].normal - Vec3(-1, 0, 0)).norm() < 1e-12);  // the larger piece comes first
  for (const auto& chunk : make_chunks(complex, pieces, block, 0.25)) {
    double area = 0;
    for (std::size_t t = 0; t < chunk.mesh.triangles.size(); ++t) {
      const auto& uv = chunk.mesh.attributes.uv[t];
      if (chunk.mesh.patch[t] == 0) continue;
      const Vec2 a = uv[1] - uv[0], b = uv[2] - uv[0];
      area += 0.5 * (a.x() * b.y() - a.y() * b.x());  // positive: not mirrored on either side
    }
    CHECK(area == Approx(1 / (0.25 * 0.25)));
  }
}

TEST_CASE("Chunks of a deformed body are the same triangles where their vertices are now", "[chunks]") {
  const TriangleMesh block = make_block({2, 1, 1}, 0.5);
  Complex complex = Complex::from_skin(block);
  auto front = begin_front(std::vector<Vec3>{{0.7, -1, -1}, {0.7, -1, 2}}, false, 1);
  advance(complex, front, std::vector<Vec3>{{0.7, 2, -1}, {0.7, 2, 2}});
  const Pieces pieces = find_pieces(complex);
  const auto still = make_chunks(complex, pieces, block, 0.25);
  // Each surface vertex by itself: both are stretched, and the one beyond the crack goes a way off.
  std::vector<Vec3> moved(complex.surface_vertex_count(), Vec3::Zero());
  std::vector<SurfaceVertexId> rows;
  const auto place = [](const Vec3& x, std::uint32_t piece) {
    return Vec3(3 * x.x() + 5 * piece, x.y() + 0.5 * x.x(), 2 * x.z());
  };
  for (std::uint32_t p = 0; p < pieces.count; ++p) {
    const TriangleMesh mesh = piece_mesh(complex, pieces, p, &rows);
    REQUIRE(rows.size() == mesh.vertices.size());
    for (std::size_t v = 0; v < rows.size(); ++v) {
      CHECK(complex.point(complex.site(rows[v])) == mesh.vertices[v]);
      moved[rows[v].index()] = place(mesh.vertices[v], p);
    }
  }
  const auto chunks = make_chunks(complex, pieces, block, 0.25, moved);
  REQUIRE(chunks.size() == 2);
  for (std::uint32_t p = 0; p < 2; ++p) {
    CHECK(chunks[p].mesh.triangles == still[p].mesh.triangles);
    CHECK(chunks[p].mesh.attributes.uv == still[p].mesh.attributes.uv);  // of the undeformed wall
    CHECK(chunks[p].volume == Approx(6 * still[p].volume));
    CHECK((chunks[p].centroid - place(still[p].centroid, p)).norm() < 1e-12);
    for (std::size_t v = 0; v < chunks[p].mesh.vertices.size(); ++v)
      CHECK(chunks[p].mesh.vertices[v] == place(still[p].mesh.vertices[v], p));
  }
  // The bond is half way between its sides, and as strong as the material was.
  const Vec3 on_wall(0.7, 0.5, 0.5), u = place({0.7, 1, 0.5}, 0) - place(on_wall, 0),
                                     v = place({0.7, 0.5, 1}, 0) - place(on_wall, 0);
  const auto bonds = find_bonds(complex, pieces, moved);
  REQUIRE(bonds.size() == 1);
  CHECK(bonds[0].area == Approx(1));
  CHECK((bonds[0].centroid - 0.5 * (place(on_wall, 0) + place(on_wall, 1))).norm() < 1e-12);
  CHECK((bonds[0].normal + u.cross(v).normalized()).norm() <
        1e-12);  // to the smaller piece, on the other side of x = 0.7
}
