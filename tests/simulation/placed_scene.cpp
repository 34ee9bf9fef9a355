// Random scenes of placed_scene.h, and their images.
#include "simulation/placed_scene.h"

#include <cmath>
#include <numbers>

#include "base/random.h"

namespace geo {
namespace {

TriangleMesh make_torus(double large, double small, int around, int across) {
  TriangleMesh mesh;
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j) {
      const double a = 2 * std::numbers::pi * i / around, b = 2 * std::numbers::pi * j / across;
      const double r = large + small * std::cos(b);
      mesh.vertices.push_back({r * std::cos(a), r * std::sin(a), small * std::sin(b)});
    }
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>((i % around) * across + j % across); };
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return mesh;
}

// A block about the origin.
TriangleMesh make_centred_block(const Vec3& size, double edge) {
  TriangleMesh mesh = make_block(size, edge);
  for (Vec3& p : mesh.vertices) p -= 0.5 * size;
  return mesh;
}

// A blade in a plane: its edge is a line that moves through the model from one side to the other.
struct CutPlane {
  Vec3 point, along, way;  // a point of the plane; directions of the edge and of its motion
};

// One that does not graze the model, so that small changes do not decide how many pieces there are.
CutPlane random_plane(Random& random, double half) {
  const Vec3 along = random.direction();
  Vec3 way = random.direction();
  way = (way - way.dot(along) * along).normalized();
  const double inner = 0.3 * half;
  return {{random.uniform(-inner, inner), random.uniform(-inner, inner), random.uniform(-inner, inner)}, along, way};
}

// At a coordinate of an axis.
CutPlane axis_plane(std::uint32_t axis, double at, Random& random) {
  const std::uint32_t other = (axis + 1 + random.below(2)) % 3;
  CutPlane plane{Vec3::Zero(), Vec3::Unit(static_cast<int>(other)), Vec3::Unit(static_cast<int>(3 - axis - other))};
  plane.point[static_cast<int>(axis)] = at;
  return plane;
}

Blade blade_in(const CutPlane& plane, double half, double from, double to, std::uint32_t parts) {
  Blade blade;
  for (std::uint32_t i = 0; i <= parts; ++i)
    blade.points.push_back(plane.point + (6.0 * i / parts - 3) * half * plane.along);
  const Vec3 reach = 3 * half * plane.way;
  blade.motion.keys = {{from, reach, Vec3::UnitZ(), 0}, {to, -reach, Vec3::UnitZ(), 0}};
  return blade;
}

}  // namespace

bool Placement::mirrors() const {
  const bool is_even = axis[1] == (axis[0] + 1) % 3;
  return (sign[0] * sign[1] * sign[2] < 0) == is_even;
}

Vec3 Placement::of_vector(const Vec3& v) const {
  return scale * Vec3(sign[0] * v[axis[0]], sign[1] * v[axis[1]], sign[2] * v[axis[2]]);
}

std::array<Placement, 8> placements() {
  return {{{.name = "as it is"},
           {.name = "translated", .offset = {3.0 / 8, -5.0 / 4, 17.0 / 16}},
           {.name = "mirrored in x", .sign = {-1, 1, 1}},
           {.name = "mirrored in y", .sign = {1, -1, 1}},
           {.name = "mirrored in z", .sign = {1, 1, -1}},
           {.name = "axes exchanged", .axis = {1, 2, 0}},
           {.name = "twice as large", .scale = 2},
           {.name = "half as large", .scale = 0.5}}};
}

CutScene random_cut_scene(std::uint64_t seed) {
  Random random(seed);
  CutScene cut;
  double half = 0.5, line = 0;  // half of the model's size; a coordinate of lines of its mesh
  const std::uint32_t shape = random.below(3);
  if (shape == 0) {
    const int squares = 2 + 2 * static_cast<int>(random.below(4));
    const double size = random.below(2) == 0 ? 1 : random.uniform(1.0, 2.0);
    cut.model = make_centred_block({size, size, size}, size / squares);
    half = 0.5 * size;
    line = random.below(2) == 0 ? half : half - size / squares;
  } else if (shape == 1) {
    cut.model = make_sphere(4 + static_cast<int>(random.below(5)));
    half = 1;
  } else {
    cut.model = make_torus(0.7, 0.3, 16, 8);
    half = 0.7;
    line = 0.7;
  }
  Scene& scene = cut.scene;
  scene.bodies.resize(1);
  scene.bodies[0].sampling.count = 120 + random.below(200);
  scene.material.young = std::pow(10.0, random.uniform(4.0, 6.0));
  scene.self_contact = true;
  scene.seed = 1 + random.below(1000);
  scene.gravity = Vec3::Zero();
  const bool hangs = random.below(2) == 0;  // held by its top, so that it is stretched and gapes
  if (hangs) {
    scene.gravity = {0, 0, random.uniform(-4.0, -0.5)};
    double top = 0;
    for (const Vec3& p : cut.model.vertices) top = std::max(top, p.z());
    scene.grips.push_back({.lo = {-4, -4, 0.5 * top}, .hi = {4, 4, 4}});
  }
  const std::uint32_t kind = random.below(5), strokes = 1 + random.below(3);
  const char* kinds[] = {"anywhere", "in a symmetry plane", "along mesh lines", "beside zero", "anywhere"};
  for (std::uint32_t s = 0; s < strokes; ++s) {
    CutPlane plane = random_plane(random, half);
    const std::uint32_t axis = random.below(3);
    const double tiny = std::pow(10.0, -random.uniform(10.0, 40.0));
    if (kind == 1) plane = axis_plane(axis, 0, random);
    if (kind == 2) plane = axis_plane(axis, random.below(2) == 0 ? line : -line, random);
    if (kind == 3) plane = axis_plane(axis, random.below(2) == 0 ? tiny : -tiny, random);
    const double from = 0.05 + 0.25 * s;
    scene.blades.push_back(blade_in(plane, half, from, from + random.uniform(0.15, 0.24), 6 + random.below(12)));
  }
  scene.frames = 8 + 6 * static_cast<int>(strokes);
  const char* shapes[] = {"block", "ball", "torus"};
  cut.about = std::string(shapes[shape]) + (hangs ? " that hangs, " : ", ") + std::to_string(strokes) + " strokes " +
              kinds[kind];
  return cut;
}

CutScene placed(const CutScene& cut, const Placement& way) {
  CutScene result = cut;
  Box3 box;
  for (const Vec3& p : cut.model.vertices) box.add(p);
  const Vec3 offset = way.offset;
  const auto place = [&](const Vec3& p) { return Vec3(way.of_vector(p) + offset); };
  for (Vec3& p : result.model.vertices) p = place(p);
  if (way.mirrors())
    for (Triangle& t : result.model.triangles) std::swap(t[1], t[2]);
  Scene& scene = result.scene;
  scene.material.young *= way.scale * way.scale;
  scene.gravity = way.of_vector(scene.gravity);
  for (Grip& grip : scene.grips) {
    const Vec3 a = place(grip.lo), b = place(grip.hi);
    grip.lo = a.cwiseMin(b);
    grip.hi = a.cwiseMax(b);
  }
  for (Blade& blade : scene.blades) {
    for (Vec3& p : blade.points) p = place(p);
    for (Motion::Key& key : blade.motion.keys) key.position = way.of_vector(key.position);
  }
  result.about += ", " + way.name;
  return result;
}

}  // namespace geo
