#include <catch2/catch.hpp>
#include <map>

#include "invariants/random_cuts.h"
#include "kerf/error.h"
#include "kerf/mesh.h"

using namespace geo;
using random_cuts::cases;

namespace {

Vec2 affine_uv(const Vec3& p) {
  return {0.3 + 0.21 * p.x() - 0.4 * p.y() + 0.05 * p.z(), -0.1 + 0.33 * p.z() + 0.17 * p.x()};
}
Color affine_color(const Vec3& p) {
  return {0.5 + 0.1 * p.x(), 0.4 - 0.12 * p.y(), 0.5 + 0.2 * p.z(), 0.75 + 0.01 * (p.x() + p.y())};
}

// Affine texture coordinates and colours, smooth normals, groups in three stripes.
TriangleMesh dressed(TriangleMesh mesh) {
  Attributes& a = mesh.attributes;
  std::vector<Vec3> normal(mesh.vertices.size(), Vec3::Zero());
  for (const auto& [i, j, k] : mesh.triangles)
    for (const auto v : {i, j, k}) normal[v] += face_normal(mesh.vertices[i], mesh.vertices[j], mesh.vertices[k]);
  a.group_names = {"skin", "lid", "stripe"};
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    a.group.push_back(static_cast<std::int32_t>(t % 3));
    a.uv.emplace_back();
    a.normal.emplace_back();
    a.color.emplace_back();
    for (int k = 0; k < 3; ++k) {
      const auto v = mesh.triangles[t][k];
      a.uv[t][k] = affine_uv(mesh.vertices[v]);
      a.color[t][k] = affine_color(mesh.vertices[v]);
      a.normal[t][k] = normal[v].normalized();
    }
  }
  return mesh;
}

void cut(Complex& complex, Random& random, std::int32_t crack) {
  const auto sheet = random_cuts::make_cut(complex.extent(), random);
  const int steps = 1 + static_cast<int>(random.below(3));
  FrontState front = begin_front(sheet.at(0), false, crack);
  for (int s = 1; s <= steps; ++s) advance(complex, front, sheet.at(double(s) / steps));
}

std::array<Vec3, 3> corners(const TriangleMesh& mesh, std::size_t t) {
  return {mesh.vertices[mesh.triangles[t][0]], mesh.vertices[mesh.triangles[t][1]],
          mesh.vertices[mesh.triangles[t][2]]};
}

// How far p is from being inside triangle t.
double outside(const std::array<Vec3, 3>& t, const Vec3& p) {
  const Vec3 n = face_normal(t[0], t[1], t[2]);
  double worst = std::abs(n.dot(p - t[0]));
  for (int k = 0; k < 3; ++k) worst = std::max(worst, n.cross((t[(k + 1) % 3] - t[k]).normalized()).dot(t[k] - p));
  return worst;
}

struct Seen {
  std::size_t corners_kept = 0, corners_mixed = 0, crack = 0;
};

// Checks all guarantees of transfer_attributes() for a surface that was cut from `model` and whose
// sources are composed already.
Seen require_carried(const TriangleMesh& model, const TriangleMesh& surface) {
  Seen seen;
  const Attributes &a = surface.attributes, &b = model.attributes;
  REQUIRE(surface.source.size() == surface.triangles.size());
  REQUIRE(a.uv.size() == surface.triangles.size());
  std::map<std::uint32_t, std::pair<Vec2, Vec3>> at_vertex;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    CAPTURE(t);
    const auto c = corners(surface, t);
    REQUIRE((surface.source[t] == ~0u) == (surface.patch[t] != 0));
    if (surface.source[t] == ~0u) {
      ++seen.crack;
      REQUIRE(a.group_names.at(static_cast<std::size_t>(a.group[t])) == crack_group);
      for (int k = 0; k < 3; ++k) {
        REQUIRE(a.uv[t][k] == Vec2(0, 0));
        REQUIRE(a.color[t][k] == crack_color);
        REQUIRE(a.normal[t][k] == face_normal(c[0], c[1], c[2]));
      }
      continue;
    }
    const auto s = surface.source[t];
    REQUIRE(s < model.triangles.size());
    const auto source = corners(model, s);
    REQUIRE(outside(source, (c[0] + c[1] + c[2]) / 3) < 1e-9);
    REQUIRE(a.group[t] == b.group[s]);
    for (int k = 0; k < 3; ++k) {
      REQUIRE((a.uv[t][k] - affine_uv(c[k])).norm() < 1e-12);
      REQUIRE((a.color[t][k] - affine_color(c[k])).norm() < 1e-12);
      REQUIRE(std::abs(a.normal[t][k].norm() - 1) < 1e-14);
      const auto same = std::find(source.begin(), source.end(), c[k]) - source.begin();
      if (same < 3) {
        ++seen.corners_kept;
        REQUIRE(a.uv[t][k] == b.uv[s][static_cast<std::size_t>(same)]);
        REQUIRE(a.color[t][k] == b.color[s][static_cast<std::size_t>(same)]);
        REQUIRE(a.normal[t][k] == b.normal[s][static_cast<std::size_t>(same)]);
      } else {
        ++seen.corners_mixed;
      }
      // Smooth before, smooth after: the skin's triangles agree at each vertex, to the bit.
      const auto [it, fresh] = at_vertex.try_emplace(surface.triangles[t][k], a.uv[t][k], a.normal[t][k]);
      if (!fresh) {
        REQUIRE(it->second.first == a.uv[t][k]);
        REQUIRE(it->second.second == a.normal[t][k]);
      }
    }
  }
  return seen;
}

}  // namespace

TEST_CASE("affine attributes of the skin stay affine under any cut, and what is not cut keeps its bits") {
  const TriangleMesh models[] = {dressed(make_pumpkin(6)), dressed(make_block({2, 1, 1.5}, 0.25)),
                                 dressed(make_letter('B', 0.3, 14))};
  Random random(20240711);
  Seen all;
  for (int i = 0; i < cases(30); ++i) {
    CAPTURE(i);
    const TriangleMesh& model = models[i % 3];
    Complex complex = Complex::from_skin(model);
    cut(complex, random, 1);
    cut(complex, random, 2);
    TriangleMesh surface = complex.two_sided();
    transfer_attributes(model, surface);
    const Seen seen = require_carried(model, surface);
    all.corners_kept += seen.corners_kept;
    all.corners_mixed += seen.corners_mixed;
    all.crack += seen.crack;
  }
  CHECK(all.corners_kept > 1000);
  CHECK(all.corners_mixed > 1000);
  CHECK(all.crack > 100);
}

TEST_CASE("a surface that is cut again names triangles of the first one, and old cracks keep what they have") {
  const TriangleMesh model = dressed(make_pumpkin(6));
  Random random(77);
  for (int i = 0; i < cases(10); ++i) {
    CAPTURE(i);
    Complex first = Complex::from_skin(model);
    cut(first, random, 1);
    TriangleMesh once = first.two_sided();
    transfer_attributes(model, once);
    Complex second = Complex::from_two_sided(once);
    cut(second, random, 2);
    TriangleMesh twice = second.two_sided();
    const auto rows = twice.source;
    // Paint both sides of the first crack, each in its own colour, before the second cut is
    // carried.
    TriangleMesh painted = once;
    for (std::size_t t = 0; t < once.triangles.size(); ++t)
      if (once.patch[t] != 0)
        painted.attributes.color[t].fill(once.patch[t] > 0 ? Color(1, 0, 0, 1) : Color(0, 0, 1, 1));
    TriangleMesh again = twice;
    transfer_attributes(painted, again);
    for (std::size_t t = 0; t < again.triangles.size(); ++t)
      if (std::abs(again.patch[t]) == 1)
        REQUIRE(again.attributes.color[t][1] == (again.patch[t] > 0 ? Color(1, 0, 0, 1) : Color(0, 0, 1, 1)));
    transfer_attributes(once, twice);
    for (std::size_t t = 0; t < twice.triangles.size(); ++t) {
      REQUIRE((twice.source[t] == ~0u) == (twice.patch[t] != 0));
      if (twice.source[t] == ~0u) {
        const auto c = corners(twice, t);
        for (const Vec3& n : twice.attributes.normal[t]) REQUIRE((n - face_normal(c[0], c[1], c[2])).norm() < 1e-6);
        continue;
      }
      REQUIRE(twice.source[t] == once.source[rows[t]]);
      for (int k = 0; k < 3; ++k) REQUIRE((twice.attributes.uv[t][k] - affine_uv(corners(twice, t)[k])).norm() < 1e-12);
    }
  }
}

TEST_CASE(
    "where the sides of a crack are not in pairs of rows, the negative one has the other's normals turned round") {
  const TriangleMesh model = dressed(make_block({1, 1, 1}, 0.5));
  Complex complex = Complex::from_skin(model);
  FrontState front = begin_front(std::vector<Vec3>{{-1, -1, 0.3}, {-1, 2, 0.3}}, false, 1);
  advance(complex, front, std::vector<Vec3>{{2, -1, 0.31}, {2, 2, 0.32}});
  TriangleMesh once = complex.two_sided();
  transfer_attributes(model, once);
  TriangleMesh sorted = once;  // all negative sides last
  const auto order = [&](auto& rows) {
    auto copy = rows;
    rows.clear();
    for (const bool negative : {false, true})
      for (std::size_t t = 0; t < copy.size(); ++t)
        if ((once.patch[t] < 0) == negative) rows.push_back(copy[t]);
  };
  order(sorted.triangles);
  order(sorted.patch);
  order(sorted.source);
  order(sorted.attributes.uv);
  order(sorted.attributes.normal);
  order(sorted.attributes.color);
  order(sorted.attributes.group);
  TriangleMesh again = Complex::from_two_sided(sorted).two_sided();
  transfer_attributes(sorted, again);
  for (std::size_t t = 0; t < again.triangles.size(); ++t) {
    if (again.patch[t] == 0) continue;
    const auto c = corners(again, t);
    for (const Vec3& n : again.attributes.normal[t]) CHECK((n - face_normal(c[0], c[1], c[2])).norm() < 1e-14);
  }
}

TEST_CASE("pieces have the attributes of their part of the skin") {
  const TriangleMesh model = dressed(make_pumpkin(5));
  Complex complex = Complex::from_skin(model);
  FrontState front = begin_front(std::vector<Vec3>{{-3, -3, 0.113}, {-3, 3, 0.1}}, false, 1);
  advance(complex, front, std::vector<Vec3>{{3, -3, 0.12}, {3, 3, 0.09}});
  const Pieces pieces = find_pieces(complex);
  REQUIRE(pieces.count == 2);
  for (std::uint32_t p = 0; p < 2; ++p) {
    TriangleMesh piece = piece_mesh(complex, pieces, p);
    transfer_attributes(model, piece);
    const Seen seen = require_carried(model, piece);
    CHECK(seen.crack > 0);
    CHECK(seen.corners_kept > 0);
  }
}

TEST_CASE("seams of the texture stay: each triangle has the values of its own source") {
  TriangleMesh model = make_block({1, 1, 1}, 0.2);
  for (std::size_t t = 0; t < model.triangles.size(); ++t) {
    const auto x = static_cast<double>(t);
    model.attributes.uv.push_back({Vec2(x, 0.1), Vec2(x, 0.1), Vec2(x, 0.1)});
  }
  Random random(5);
  for (int i = 0; i < cases(5); ++i) {
    Complex complex = Complex::from_skin(model);
    cut(complex, random, 1);
    TriangleMesh surface = complex.two_sided();
    transfer_attributes(model, surface);
    CHECK(surface.attributes.names() == std::vector<std::string>{"uv"});
    for (std::size_t t = 0; t < surface.triangles.size(); ++t)
      for (const Vec2& uv : surface.attributes.uv[t])
        REQUIRE(uv == (surface.patch[t] == 0 ? Vec2(surface.source[t], 0.1) : Vec2(0, 0)));
  }
}

TEST_CASE("a body's surface that follows a cut one still knows its sources") {
  const TriangleMesh model = make_block({1, 1, 1}, 0.25);
  Complex body = Complex::from_skin(model), cut_one = body;
  FrontState front = begin_front(std::vector<Vec3>{{-1, -1, 0.3}, {-1, 2, 0.3}}, false, 1);
  advance(cut_one, front, std::vector<Vec3>{{2, -1, 0.31}, {2, 2, 0.32}});
  body.apply(body.difference(Complex::from_two_sided(cut_one.two_sided())));
  const TriangleMesh surface = body.two_sided();
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    REQUIRE((surface.source[t] == ~0u) == (surface.patch[t] != 0));
    if (surface.source[t] == ~0u) continue;
    const auto c = corners(surface, t);
    CHECK(outside(corners(model, surface.source[t]), (c[0] + c[1] + c[2]) / 3) < 1e-9);
  }
}

TEST_CASE("a surface that was not cut from the model is refused") {
  TriangleMesh model = make_block({1, 1, 1}, 1), other = Complex::from_skin(make_block({1, 1, 1}, 0.5)).two_sided();
  CHECK_THROWS_WITH(transfer_attributes(model, other), Catch::Contains("give the model that was cut"));
  other.source.clear();
  CHECK_THROWS_AS(transfer_attributes(model, other), InputError);
}
