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

// The image of each part of a scene.
class Placer {
 public:
  explicit Placer(const Placement& way) : way_(way), matrix_(way.matrix()), hand_(matrix_.determinant()) {}

  Vec3 vector(const Vec3& v) const { return way_.scale * (matrix_ * v); }
  Vec3 point(const Vec3& p) const { return vector(p) + way_.offset; }
  Vec3 axis(const Vec3& a) const { return hand_ * (matrix_ * a); }
  void mesh(TriangleMesh& mesh) const {
    for (Vec3& p : mesh.vertices) p = point(p);
    turn_over(mesh);
  }
  void box(Vec3& lo, Vec3& hi) const {
    const Vec3 a = point(lo), b = point(hi);
    lo = a.cwiseMin(b);
    hi = a.cwiseMax(b);
  }
  // The key of an object whose own coordinates are mapped as vectors: position ↦ image + offset.
  void key_about(Motion::Key& key, const Vec3& offset) const {
    key.position = vector(key.position) + offset;
    key.axis = axis(key.axis);
  }
  void material(Material& material) const { material.young *= way_.scale * way_.scale; }
  // world = motion(place(scale · mesh)): the motion is conjugated, so that it turns about the image
  // of the origin.
  void obstacle(SceneObstacle& obstacle) const {
    for (Vec3& p : obstacle.mesh.vertices) p = matrix_ * p;
    turn_over(obstacle.mesh);
    obstacle.normal = matrix_ * obstacle.normal;
    obstacle.scale *= way_.scale;
    obstacle.place.position = point(obstacle.place.position);
    const Eigen::AngleAxisd turn(obstacle.place.rotation);
    obstacle.place.rotation = Eigen::AngleAxisd(turn.angle(), axis(turn.axis()));
    for (Motion::Key& key : obstacle.motion.keys) {
      key_about(key, way_.offset);
      key.position -= Eigen::AngleAxisd(key.angle * std::numbers::pi / 180, key.axis.normalized()) * way_.offset;
    }
  }
  void fracture(FractureOptions& fracture) const {
    strength(fracture);
    for (Strength& own : fracture.per_body) strength(own);
    for (auto& [lo, hi] : fracture.off) box(lo, hi);
  }

 private:
  void turn_over(TriangleMesh& mesh) const {
    if (hand_ > 0) return;
    for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  }
  void strength(Strength& strength) const {
    strength.strength *= way_.scale * way_.scale;
    strength.toughness *= way_.scale * way_.scale * std::sqrt(way_.scale);
    strength.grain *= way_.scale;
  }

  const Placement& way_;
  Mat3 matrix_;
  double hand_;  // −1: it turns right hands into left ones
};

}  // namespace

Mat3 Placement::matrix() const {
  Mat3 m = Mat3::Zero();
  for (int i = 0; i < 3; ++i) m(i, axis[static_cast<std::size_t>(i)]) = sign[static_cast<std::size_t>(i)];
  return m;
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
  TriangleMesh mesh;
  double half = 0.5, line = 0;  // half of the model's size; a coordinate of lines of its mesh
  const std::uint32_t shape = random.below(3);
  if (shape == 0) {
    const int squares = 2 + 2 * static_cast<int>(random.below(4));
    const double size = random.below(2) == 0 ? 1 : random.uniform(1.0, 2.0);
    mesh = make_centred_block({size, size, size}, size / squares);
    half = 0.5 * size;
    line = random.below(2) == 0 ? half : half - size / squares;
  } else if (shape == 1) {
    mesh = make_sphere(4 + static_cast<int>(random.below(5)));
    half = 1;
  } else {
    mesh = make_torus(0.7, 0.3, 16, 8);
    half = 0.7;
    line = 0.7;
    cut.is_thin = true;
  }
  cut.models = {.all = mesh, .bodies = {mesh}};
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
    // Weight strains the material by a thousandth to a fiftieth: where it is stretched by a third,
    // what a blade meets depends on each node.
    const double strain = std::pow(10.0, random.uniform(-3.0, -1.7));
    scene.material.young = scene.material.density * -scene.gravity.z() * 2 * half / strain;
    double top = 0;
    for (const Vec3& p : mesh.vertices) top = std::max(top, p.z());
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
  const Placer place(way);
  place.mesh(result.models.all);
  for (TriangleMesh& mesh : result.models.bodies) place.mesh(mesh);
  Scene& scene = result.scene;
  const double scale = way.scale;
  place.material(scene.material);
  for (SceneBody& body : scene.bodies) {
    body.velocity = place.vector(body.velocity);
    body.spin = place.axis(body.spin);
    body.sampling.spacing *= scale;
    if (body.material) place.material(*body.material);
  }
  for (SceneScore& score : scene.scores)
    for (auto& step : score.front.steps)
      for (Vec3& p : step) p = place.point(p);
  scene.gravity = place.vector(scene.gravity);
  scene.ground_point = place.point(scene.ground_point);
  scene.ground_normal = way.matrix() * scene.ground_normal;
  for (Grip& grip : scene.grips) {
    place.box(grip.lo, grip.hi);
    for (Motion::Key& key : grip.motion.keys) place.key_about(key, Vec3::Zero());
  }
  for (Blade& blade : scene.blades) {
    for (Vec3& p : blade.points) p = place.vector(p);
    blade.back = place.vector(blade.back);
    blade.thickness *= scale;
    for (Motion::Key& key : blade.motion.keys) place.key_about(key, way.offset);
  }
  for (SceneObstacle& obstacle : scene.obstacles) place.obstacle(obstacle);
  place.fracture(scene.fracture);
  result.about += ", " + way.name;
  return result;
}

NodeSet placed(const NodeSet& nodes, const Placement& way) {
  NodeSet result = nodes;
  const Placer place(way);
  for (Vec3& p : result.position) p = place.point(p);
  for (double& r : result.radius) r *= way.scale;
  for (double& h : result.spacing) h *= way.scale;
  for (double& v : result.volume) v *= way.scale * way.scale * way.scale;
  return result;
}

}  // namespace geo
