// Local edits: remeshing between steps, jagged cracks, decimation.
#include <algorithm>
#include <catch2/catch.hpp>
#include <numeric>

#include "base/random.h"
#include "cases.h"
#include "crack/block_cuts.h"
#include "geometry/distance.h"
#include "kerf/check.h"
#include "kerf/crack.h"
#include "kerf/error.h"
#include "kerf/mesh.h"
#include "kerf/pieces.h"
#include "surface/delta_sum.h"

using namespace geo;

namespace {

double volume_of(const Complex& k) {
  const Pieces pieces = find_pieces(k);
  return std::accumulate(pieces.volume.begin(), pieces.volume.end(), 0.0);
}
double skin_area(const Complex& k) {
  double sum = 0;
  for (std::uint32_t f = 0; f < k.face_count(); ++f)
    if (k.alive(FaceId(f)) && k.face(FaceId(f)).crack == 0) {
      const auto c = k.corners(FaceId(f));
      sum += 0.5 * (c[1] - c[0]).cross(c[2] - c[0]).norm();
    }
  return sum;
}
std::vector<FaceId> alive(const Complex& k) {
  std::vector<FaceId> faces;
  for (std::uint32_t f = 0; f < k.face_count(); ++f)
    if (k.alive(FaceId(f))) faces.push_back(FaceId(f));
  return faces;
}

// A partial cut from somewhere on the block's skin, remeshed after each of its steps; false when it
// was refused.
bool cut_block(Complex& k, Random& random, std::int32_t crack, bool remeshed) {
  const auto rows = block_cut(random);
  FrontState front = begin_front(rows[0], false, crack);
  FrontState* const fronts[] = {&front};
  try {
    for (std::size_t s = 1; s < rows.size(); ++s) {
      const CrackDelta delta = advance(k, front, rows[s]);
      if (remeshed) remesh(k, delta.new_faces, fronts);
    }
  } catch (const GeometryError&) {
    return false;
  }
  return true;
}

std::vector<Vec3> wavy(double s) {
  std::vector<Vec3> points;
  for (int i = 0; i <= 12; ++i) {
    const double a = 3.4 * (s - 0.5), b = 3.4 * (i / 12.0 - 0.5);
    points.push_back({a, 0.2 * std::sin(1.3 * a) + 0.1 * std::cos(2 * b) + 0.03, b});
  }
  return points;
}

}  // namespace

TEST_CASE("many partial cuts through one block, remeshed, keep their angles and every invariant") {
  // All 500: KERF_CASES=10 test_crack 'many partial cuts*'.
  Complex k = Complex::from_skin(make_block({1, 1, 1}, 0.1));
  Random random(1);
  int refused = 0;
  const int cuts = cases(50);
  for (int c = 1; c <= cuts; ++c) {
    refused += !cut_block(k, random, c, true);
    if (c % 25 != 0) continue;
    CAPTURE(c, refused);
    const auto report = check_complex(k, SelfIntersections::find);
    CHECK(report.first_problem == "");
    CHECK(std::abs(volume_of(k) - 1) <= 1e-12);
    CHECK(std::abs(skin_area(k) - 6) <= 6e-12);
    CHECK(low_angle(k) > 5);
  }
  CHECK(refused * 50 <= cuts);
  Complex bare = Complex::from_skin(make_block({1, 1, 1}, 0.1));
  Random same(1);
  for (int c = 1; c <= 20; ++c) cut_block(bare, same, c, false);
  CHECK(low_angle(bare) < 1);  // what it is without
}

TEST_CASE("a front goes on after remeshing and separates what it would have separated") {
  for (const int f : {6, 12}) {
    const TriangleMesh model = make_pumpkin(f);
    for (const double angle : {15.0, 25.0}) {
      CAPTURE(f, angle);
      Complex plain = Complex::from_skin(model), better = plain;
      FrontState a = begin_front(wavy(0), false, 1), b = a;
      FrontState* const fronts[] = {&b};
      RemeshOptions options;
      options.angle = angle;
      RemeshStats work;
      for (int s = 1; s <= 10; ++s) {
        advance(plain, a, wavy(s / 10.0));
        const CrackDelta delta = advance(better, b, wavy(s / 10.0));
        const auto before = alive(better);
        const CrackDelta change = remesh(better, delta.new_faces, fronts, options, &work);
        // The delta of all edits says what is there now.
        std::vector<FaceId> now;
        for (const FaceId face : before)
          if (!std::binary_search(change.removed_faces.begin(), change.removed_faces.end(), face)) now.push_back(face);
        now.insert(now.end(), change.new_faces.begin(), change.new_faces.end());
        REQUIRE(now == alive(better));
        for (const auto& segment : b.segments)
          for (const auto& p : segment)
            if (p.id.valid()) REQUIRE(better.point(p.id) == p.position);
      }
      CHECK(check_complex(better, SelfIntersections::find).first_problem == "");
      CHECK(find_pieces(better).count == find_pieces(plain).count);
      CHECK(find_pieces(plain).count >= 2);
      CHECK(volume_of(better) == Approx(signed_volume(model)).epsilon(1e-12));
      CHECK(skin_area(better) == Approx(area(model)).epsilon(1e-12));
      CHECK(low_angle(better) > low_angle(plain));
      CHECK(work.flips + work.collapses + work.moves > 0);
      // As far from where the crack was as one may be, and no farther.
      const Pieces p = find_pieces(plain), q = find_pieces(better);
      for (std::size_t i = 0; i < p.count && i < 2; ++i)
        CHECK(std::abs(p.volume[i] - q.volume[i]) < 1e-3 * signed_volume(model));
    }
  }
}

TEST_CASE("jagged cracks leave the skin to the bit, and the same seed gives the same bumps") {
  const TriangleMesh model = make_pumpkin(8);
  for (int seed = 1; seed <= cases(3); ++seed) {
    CAPTURE(seed);
    Complex k = Complex::from_skin(model);
    FrontState front = begin_front(wavy(0), false, 1);
    const int last = seed % 2 ? 10 : 6;  // through, or with its tip inside
    for (int s = 1; s <= last; ++s) advance(k, front, wavy(s / 10.0));
    Complex again = k;
    const auto skin = [](const Complex& c) {
      std::vector<std::array<VertexId, 3>> faces;
      for (const FaceId f : alive(c))
        if (c.face(f).crack == 0) faces.push_back(c.face(f).v);
      return faces;
    };
    const auto before = skin(k);
    RoughenOptions options;
    options.seed = static_cast<std::uint64_t>(seed);
    FrontState* const fronts[] = {&front};
    RoughenStats work;
    const double flat = [&] {
      double sum = 0;
      for (const FaceId f : alive(k))
        if (k.face(f).crack > 0) {
          const auto c = k.corners(f);
          sum += (c[1] - c[0]).cross(c[2] - c[0]).norm();
        }
      return sum;
    }();
    roughen(k, fronts, options, &work);
    roughen(again, fronts, options);
    CHECK(skin(k) == before);
    CHECK(check_complex(k, SelfIntersections::find).first_problem == "");
    CHECK(find_pieces(k).count == find_pieces(again).count);
    CHECK(volume_of(k) == Approx(signed_volume(model)).epsilon(1e-12));
    CHECK(k.two_sided().vertices == again.two_sided().vertices);
    CHECK(work.moves > 100);
    double rough = 0;
    for (const FaceId f : alive(k))
      if (k.face(f).crack > 0) {
        const auto c = k.corners(f);
        rough += (c[1] - c[0]).cross(c[2] - c[0]).norm();
      }
    CHECK(rough > 1.005 * flat);
    if (last == 10) continue;
    for (int s = last + 1; s <= 10; ++s) advance(k, front, wavy(s / 10.0));  // the tip is where it was
    CHECK(find_pieces(k).count >= 2);
    CHECK(check_complex(k, SelfIntersections::find).first_problem == "");
  }
  RoughenOptions wrong;
  wrong.frequency = 0;
  Complex k = Complex::from_skin(model);
  CHECK_THROWS_AS(roughen(k, {}, wrong), InputError);
}

TEST_CASE("decimation stays as close as it is told, closed and free of crossings") {
  const TriangleMesh model = make_pumpkin(14);
  for (const double deviation : {3e-4, 3e-3}) {
    CAPTURE(deviation);
    Complex k = Complex::from_skin(model);
    FrontState front = begin_front(wavy(0), false, 1);
    for (int s = 1; s <= 10; ++s) advance(k, front, wavy(s / 10.0));
    const auto pieces = find_pieces(k).count;
    const double diagonal = k.extent().diagonal();
    const auto faces = k.live_face_count();
    DecimateOptions options;
    options.deviation = deviation;
    decimate(k, {}, options);
    CHECK(check_complex(k, SelfIntersections::find).first_problem == "");
    CHECK(k.live_face_count() < (deviation > 1e-3 ? 0.8 : 0.98) * faces);
    CHECK(find_pieces(k).count == pieces);
    CHECK(std::abs(volume_of(k) - signed_volume(model)) <= deviation * diagonal * area(model));
    // Every vertex of the model is that close to what is left.
    double most = 0;
    for (std::size_t v = 0; v < model.vertices.size(); v += 7) {
      double nearest = 1e300;
      for (const FaceId f : alive(k)) {
        if (k.face(f).crack > 0) continue;
        const auto c = k.corners(f);
        nearest = std::min(nearest,
                           (closest_point_on_triangle(model.vertices[v], c[0], c[1], c[2]) - model.vertices[v]).norm());
      }
      most = std::max(most, nearest);
    }
    CHECK(most <= deviation * diagonal);
    const auto few = static_cast<std::size_t>(0.8 * k.live_face_count());
    options.faces = few;
    options.deviation = 0.05;
    decimate(k, {}, options);
    CHECK(k.live_face_count() <= few + 1);
    CHECK(check_complex(k, SelfIntersections::find).first_problem == "");
  }
}
