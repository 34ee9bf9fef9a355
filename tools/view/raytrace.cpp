// Embree finds hits. Light: a soft key light, sky by ambient occlusion, a rim light. A cut-away
// shows its section where the winding number of the surface in the cutting plane is positive.
#include "view/raytrace.h"

#include <embree3/rtcore.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include <kerf/error.h>
#include <kerf/parallel.h>

namespace view {
namespace {

using geo::Vec3;
constexpr double pi = std::numbers::pi;

Color scaled(const Color& c, double s) { return {float(c[0] * s), float(c[1] * s), float(c[2] * s)}; }
Color mixed(const Color& a, const Color& b, double t) {
  return {float(a[0] + (b[0] - a[0]) * t), float(a[1] + (b[1] - a[1]) * t), float(a[2] + (b[2] - a[2]) * t)};
}

// Integer hash of a pixel sample (lowbias32 by C. Wellons, 2018): noise that does not depend on
// threads.
std::uint32_t hash(std::uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  x ^= x >> 16;
  return x;
}

// Random numbers for one sample of a pixel. Rays to lights are stratified over all samples of the
// pixel, so few for each sample are enough: one coordinate has its own stratum, the other follows
// the golden ratio.
class Dice {
 public:
  Dice(std::uint32_t pixel, int sample, int samples, int rays)
      : state_(hash(pixel * 64u + static_cast<std::uint32_t>(sample))),
        sample_(sample),
        samples_(samples),
        rays_(rays) {
    std::uint32_t turn = hash(pixel);
    turn_ = unit(turn);
  }
  int rays() const { return rays_; }
  /// The i-th ray from a surface, about z, distributed by the cosine of its angle to z.
  Vec3 ray(int i) {
    const int k = i * samples_ + sample_;
    const double u = (k + unit(state_)) / (rays_ * samples_), r = std::sqrt(u), phi = 2 * pi * (turn_ + golden * k);
    return {r * std::cos(phi), r * std::sin(phi), std::sqrt(1 - u)};
  }
  /// A direction to the key light, within its width.
  Vec3 key(double wide) {
    const double u = (sample_ + unit(state_)) / samples_, v = turn_ + golden * sample_;
    return Vec3(-0.45 + wide * u, -0.55 + wide * (v - std::floor(v)), 0.85).normalized();
  }

 private:
  // The inverse of the golden ratio, whose multiples are evenly spread modulo 1.
  static constexpr double golden = 0.6180339887498949;
  static double unit(std::uint32_t& state) { return (state = hash(state + 0x9e3779b9u)) * 0x1p-32; }
  std::uint32_t state_;
  int sample_, samples_, rays_;
  double turn_;
};

// Corner normals, smoothed over faces that meet at less than 40 degrees around the same row.
std::vector<std::array<Eigen::Vector3f, 3>> smooth_normals(const geo::TriangleMesh& mesh,
                                                           const geo::Progress& progress) {
  constexpr std::uint32_t few = 1 << 14;  // some ten milliseconds
  const auto pause_before = [&](std::uint32_t t) {
    if (t % few == 0) geo::report(progress, "render", 0, 1);
  };
  std::vector<Vec3> face(mesh.triangles.size());
  std::vector<std::vector<std::uint32_t>> at(mesh.vertices.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    pause_before(t);
    const auto& [a, b, c] = mesh.triangles[t];
    face[t] = (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]);
    for (const auto v : mesh.triangles[t]) at[v].push_back(t);
  }
  std::vector<std::array<Eigen::Vector3f, 3>> normals(mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    pause_before(t);
    const Vec3 own = face[t].normalized();
    for (int k = 0; k < 3; ++k) {
      Vec3 sum = Vec3::Zero();
      for (const auto other : at[mesh.triangles[t][k]])
        if (face[other].normalized().dot(own) > 0.766) sum += face[other];
      const Vec3 n = sum.squaredNorm() > 0 ? sum.normalized() : own;
      normals[t][k] = n.cast<float>();
    }
  }
  return normals;
}

struct Crossings {
  RTCIntersectContext context;  // first member: Embree returns a pointer to it
  int winding = 0;
};

void count_crossing(const RTCFilterFunctionNArguments* args) {
  for (unsigned i = 0; i < args->N; ++i) {
    if (args->valid[i] != -1) continue;
    const double along = RTCRayN_dir_x(args->ray, args->N, i) * RTCHitN_Ng_x(args->hit, args->N, i) +
                         RTCRayN_dir_y(args->ray, args->N, i) * RTCHitN_Ng_y(args->hit, args->N, i) +
                         RTCRayN_dir_z(args->ray, args->N, i) * RTCHitN_Ng_z(args->hit, args->N, i);
    reinterpret_cast<Crossings*>(args->context)->winding += along > 0 ? 1 : -1;
    args->valid[i] = 0;
  }
}

// The device and its scenes: the surface, spheres and sticks, the surface for winding numbers.
struct Embree {
  Embree() {
    if (!device) throw geo::OutputError("the ray tracer cannot start");
    for (RTCScene* scene : {&surface, &things, &counter}) {
      *scene = rtcNewScene(device);
      rtcSetSceneFlags(*scene, RTC_SCENE_FLAG_ROBUST);
    }
  }
  ~Embree() {
    for (RTCScene scene : {surface, things, counter}) rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }
  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;

  RTCDevice device = rtcNewDevice("threads=1,set_affinity=0");
  RTCScene surface = nullptr, things = nullptr, counter = nullptr;
};

// Builds a scene's tree; throws Interrupted where `progress` stops it.
void commit(RTCScene scene, const geo::Progress& progress) {
  struct Monitor {
    const geo::Progress& progress;
    bool stopped = false;
  } monitor{progress};
  rtcSetSceneProgressMonitorFunction(
      scene,
      [](void* to, double) {
        auto& of = *static_cast<Monitor*>(to);
        of.stopped = of.stopped || (of.progress && !of.progress("render", 0, 1));
        return !of.stopped;
      },
      &monitor);
  rtcCommitScene(scene);
  rtcSetSceneProgressMonitorFunction(scene, nullptr, nullptr);
  if (monitor.stopped) throw geo::Interrupted();
}

class Tracer {
 public:
  Tracer(const Stage& stage, const geo::Progress& progress)
      : stage_(stage), normals_(smooth_normals(stage.surface, progress)) {
    add_surface(surface_, false);
    if (stage.cutaway) add_surface(counter_, true);
    add_spheres();
    add_sticks();
    for (RTCScene scene : {surface_, things_, counter_}) commit(scene, progress);
    geo::Box3 box;
    for (const auto& t : stage.surface.triangles)
      for (const auto v : t) box.add(stage.surface.vertices[v]);
    for (const auto& s : stage.spheres) box.add(s.center);
    scale_ = std::max(box.diagonal(), 1e-300);
    floor_ = stage.ground_level.value_or(box.empty() ? 0 : box.lo.z() - 1e-4 * scale_);
  }

  Color shade(const Vec3& eye, const Vec3& d, Dice& dice) const {
    double from = 0, until = 1e30;
    bool at_plane = false;
    if (stage_.cutaway) {
      // Where the eye is in the removed part, the ray begins at the plane, or hits nothing. Else it
      // ends at the plane.
      const double height = (eye - stage_.cutaway->point).dot(stage_.cutaway->normal);
      const double rate = d.dot(stage_.cutaway->normal);
      if (height > 0) {
        from = rate < 0 ? -height / rate : 1e30;
        at_plane = rate < 0;
      } else if (rate > 0) {
        until = -height / rate;
      }
    }
    const Hit thing = trace(things_, eye, d, 0);  // objects that the plane cuts are drawn whole
    Hit skin = trace(surface_, eye, d, from);
    if (skin.t > until) skin = {};
    Color behind = thing.t < 1e29 ? lit(thing, d, dice) : background(eye, d, dice);
    if (at_plane && stage_.section && winding(eye + from * d, d) > 0 && from <= thing.t) {
      Hit cap;
      cap.t = from;
      cap.point = eye + from * d;
      cap.normal = stage_.cutaway->normal;
      cap.color = {0.93f, 0.70f, 0.42f};
      const double lines = std::abs(std::remainder(cap.point.sum() / scale_ * 60, 1.0));
      if (lines < 0.06) cap.color = scaled(cap.color, 0.93);
      return lit(cap, d, dice);
    }
    // Follows the ray to the first opaque hit; the transparent layers before it are blended from
    // behind.
    std::vector<std::pair<Color, double>> layers;
    while (skin.t < thing.t && skin.t < 1e29) {
      const double opacity =
          stage_.surface_opacity >= 1 || skin.opaque ? 1 : std::min(1.0, stage_.surface_opacity * rim(skin, d));
      layers.push_back({lit(skin, d, dice), opacity});
      if (opacity >= 1 || layers.size() == 6) break;
      // Only the first layer, where no opaque part of the surface is behind it.
      if (!stage_.sheets_opaque) break;
      skin = trace(surface_, eye, d, skin.t + 1e-6 * scale_);
    }
    for (auto layer = layers.rbegin(); layer != layers.rend(); ++layer)
      behind = mixed(behind, layer->first, layer->second);
    return behind;
  }

 private:
  struct Hit {
    double t = 1e30;
    Vec3 point = Vec3::Zero(), normal = Vec3::Zero();
    Color color{};
    bool opaque = false;  ///< independently of the opacity of the surface
  };

  // The surface is more opaque at glancing angles, so that a transparent body keeps its outline.
  static double rim(const Hit& hit, const Vec3& d) {
    const double facing = std::abs(hit.normal.dot(d));
    return std::min(4.0, 0.6 + 2.0 * std::pow(1 - facing, 3));
  }

  void add_surface(RTCScene scene, bool counting) {
    if (stage_.surface.triangles.empty()) return;
    RTCGeometry g = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* p = static_cast<float*>(
        rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, stage_.surface.vertices.size()));
    for (const auto& v : stage_.surface.vertices)
      for (int c = 0; c < 3; ++c) *p++ = static_cast<float>(v[c]);
    auto* i = static_cast<std::uint32_t*>(
        rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, stage_.surface.triangles.size()));
    for (const auto& t : stage_.surface.triangles)
      for (const auto v : t) *i++ = v;
    if (counting) rtcSetGeometryIntersectFilterFunction(g, count_crossing);
    rtcCommitGeometry(g);
    rtcAttachGeometryByID(scene, g, 0);
    rtcReleaseGeometry(g);
  }

  void add_spheres() {
    if (stage_.spheres.empty()) return;
    RTCGeometry g = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_SPHERE_POINT);
    auto* p = static_cast<float*>(
        rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 16, stage_.spheres.size()));
    for (const auto& s : stage_.spheres) {
      for (int c = 0; c < 3; ++c) *p++ = static_cast<float>(s.center[c]);
      *p++ = static_cast<float>(s.radius);
    }
    rtcCommitGeometry(g);
    rtcAttachGeometryByID(things_, g, 1);
    rtcReleaseGeometry(g);
  }

  void add_sticks() {
    if (stage_.sticks.empty()) return;
    RTCGeometry g = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE);
    auto* p = static_cast<float*>(
        rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 16, 2 * stage_.sticks.size()));
    auto* i = static_cast<std::uint32_t*>(
        rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, 4, stage_.sticks.size()));
    std::uint32_t row = 0;
    for (const auto& s : stage_.sticks) {
      for (const Vec3* end : {&s.a, &s.b}) {
        for (int c = 0; c < 3; ++c) *p++ = static_cast<float>((*end)[c]);
        *p++ = static_cast<float>(s.radius);
      }
      *i++ = row;
      row += 2;
    }
    rtcCommitGeometry(g);
    rtcAttachGeometryByID(things_, g, 2);
    rtcReleaseGeometry(g);
  }

  static RTCRayHit make_ray(const Vec3& o, const Vec3& d, double from, double to) {
    RTCRayHit r{};
    r.ray.org_x = float(o.x());
    r.ray.org_y = float(o.y());
    r.ray.org_z = float(o.z());
    r.ray.dir_x = float(d.x());
    r.ray.dir_y = float(d.y());
    r.ray.dir_z = float(d.z());
    r.ray.tnear = float(from);
    r.ray.tfar = float(to);
    r.ray.mask = ~0u;
    r.hit.geomID = r.hit.primID = RTC_INVALID_GEOMETRY_ID;
    return r;
  }

  Hit trace(RTCScene scene, const Vec3& o, const Vec3& d, double from) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit r = make_ray(o, d, from, 1e30);
    rtcIntersect1(scene, &context, &r);
    Hit hit;
    if (r.hit.geomID == RTC_INVALID_GEOMETRY_ID) return hit;
    hit.t = r.ray.tfar;
    hit.point = o + hit.t * d;
    if (r.hit.geomID == 0) {
      const auto& n = normals_[r.hit.primID];
      hit.normal = ((1 - r.hit.u - r.hit.v) * n[0] + r.hit.u * n[1] + r.hit.v * n[2]).cast<double>().normalized();
      hit.color = stage_.triangle_colors[r.hit.primID];
      // Two coincident sheets: each is visible from its own side, whichever the ray hits first.
      const Vec3 flat(r.hit.Ng_x, r.hit.Ng_y, r.hit.Ng_z);
      if (!stage_.back_colors.empty() && flat.dot(d) > 0) hit.color = stage_.back_colors[r.hit.primID];
      if (stage_.paint.has(r.hit.primID)) hit.color = stage_.paint.color(r.hit.primID, r.hit.u, r.hit.v);
      hit.opaque = stage_.sheets_opaque && stage_.surface.patch[r.hit.primID] != 0;
      if (stage_.wire && std::min({r.hit.u, r.hit.v, 1 - r.hit.u - r.hit.v}) < 0.035f)
        hit.color = scaled(hit.color, 0.45);
    } else {
      hit.normal = Vec3(r.hit.Ng_x, r.hit.Ng_y, r.hit.Ng_z).normalized();
      hit.color = r.hit.geomID == 1 ? stage_.spheres[r.hit.primID].color : stage_.sticks[r.hit.primID].color;
    }
    if (hit.normal.dot(d) > 0) hit.normal = -hit.normal;
    return hit;
  }

  int winding(const Vec3& o, const Vec3& d) const {
    Crossings crossings;
    rtcInitIntersectContext(&crossings.context);
    RTCRayHit r = make_ray(o, d, 0, 1e30);
    rtcIntersect1(counter_, &crossings.context, &r);
    return crossings.winding;
  }

  bool blocked(const Vec3& o, const Vec3& d, double reach) const {
    RTCIntersectContext context;
    for (RTCScene scene : {surface_, things_}) {
      if (scene == surface_ && stage_.surface_opacity < 1) continue;
      double to = reach, from = 1e-4 * scale_;
      if (stage_.cutaway && scene == surface_) {
        // The removed part casts no shadow.
        const double height = (o - stage_.cutaway->point).dot(stage_.cutaway->normal);
        const double rate = d.dot(stage_.cutaway->normal);
        if (height > 1e-6 * scale_) {
          if (rate >= 0) continue;
          from = std::max(from, -height / rate);
        } else if (rate > 0) {
          to = std::min(to, -height / rate);
        }
        if (to <= from) continue;
      }
      rtcInitIntersectContext(&context);
      RTCRayHit r = make_ray(o, d, from, to);
      rtcOccluded1(scene, &context, &r.ray);
      if (r.ray.tfar < 0) return true;
    }
    return false;
  }

  double openness(const Vec3& p, const Vec3& n, Dice& dice, double reach) const {
    if (dice.rays() == 0) return 1;
    const Vec3 t = (std::abs(n.x()) > 0.6 ? Vec3::UnitY() : Vec3::UnitX()).cross(n).normalized(), b = n.cross(t);
    int open = 0;
    for (int i = 0; i < dice.rays(); ++i) {
      const Vec3 local = dice.ray(i);
      open += !blocked(p + 1e-4 * scale_ * n, local.x() * t + local.y() * b + local.z() * n, reach);
    }
    return double(open) / dice.rays();
  }

  Color lit(const Hit& hit, const Vec3& d, Dice& dice) const {
    // Shares of light: key 0.72, sky 0.42, rim 0.10. They set the look of pictures only.
    const Vec3 key = dice.key(0.12);
    const Vec3 rim_light = Vec3(0.7, 0.5, 0.25).normalized();
    const double facing = hit.normal.dot(key);
    const double direct = facing > 0 && !blocked(hit.point + 1e-4 * scale_ * hit.normal, key, 1e30) ? facing : 0;
    const double sky = openness(hit.point, hit.normal, dice, 0.35 * scale_) * (0.75 + 0.25 * hit.normal.z());
    const Vec3 half = (key - d).normalized();
    const double gloss = direct > 0 ? 0.16 * std::pow(std::max(0.0, hit.normal.dot(half)), 40) : 0;
    const double light = 0.72 * direct + 0.42 * sky + 0.10 * std::max(0.0, hit.normal.dot(rim_light));
    const Color c = scaled(hit.color, light);
    return {float(c[0] + gloss), float(c[1] + gloss), float(c[2] + gloss)};
  }

  Color background(const Vec3& eye, const Vec3& d, Dice& dice) const {
    const Color sky = mixed({0.90f, 0.92f, 0.95f}, {0.72f, 0.78f, 0.86f}, std::clamp(0.5 + d.z(), 0.0, 1.0));
    if (!stage_.ground || d.z() >= -1e-6 || eye.z() <= floor_) return sky;
    const double t = (floor_ - eye.z()) / d.z();
    const Vec3 p = eye + t * d;
    const Vec3 key = dice.key(0.25);
    const bool dark = blocked(p, key, 1e30);
    const double sky_light = openness(p, Vec3::UnitZ(), dice, 0.5 * scale_);
    const Color floor = scaled({0.86f, 0.87f, 0.88f}, (dark ? 0.55 : 0.92) * (0.45 + 0.55 * sky_light) + 0.08);
    const double far = std::clamp((p - Vec3(eye.x(), eye.y(), floor_)).norm() / (9 * scale_), 0.0, 1.0);
    return mixed(floor, sky, far * far);
  }

  const Stage& stage_;
  std::vector<std::array<Eigen::Vector3f, 3>> normals_;
  const Embree embree_;
  const RTCDevice device_ = embree_.device;
  const RTCScene surface_ = embree_.surface, things_ = embree_.things, counter_ = embree_.counter;
  double scale_ = 1, floor_ = 0;
};

// Rotates the content so that z is vertical.
Vec3 stood_up(const Vec3& v, bool y_up) { return y_up ? Vec3(v.x(), -v.z(), v.y()) : v; }

// Rays have single precision, so the content is moved to the origin and scaled to size 1.
Stage placed(Stage stage, const Vec3& middle, double scale, bool y_up) {
  const auto place = [&](Vec3& p) { p = stood_up((p - middle) * scale, y_up); };
  for (Vec3& p : stage.surface.vertices) place(p);
  for (Sphere& s : stage.spheres) {
    place(s.center);
    s.radius *= scale;
  }
  for (Stick& s : stage.sticks) {
    place(s.a);
    place(s.b);
    s.radius *= scale;
  }
  if (stage.cutaway) {
    place(stage.cutaway->point);
    stage.cutaway->normal = stood_up(stage.cutaway->normal, y_up);
  }
  if (stage.ground_level) *stage.ground_level = (*stage.ground_level - middle[y_up ? 1 : 2]) * scale;
  return stage;
}

// The points that the camera shows, as placed() maps them; all rotations of them for `all_round`.
std::vector<Vec3> to_be_seen(const Camera& camera, double scale) {
  if (camera.points.empty()) return {-Vec3::Ones(), Vec3::Ones()};
  std::vector<Vec3> points;
  for (const Vec3& p : camera.points) points.push_back(stood_up(scale * (p - camera.box.center()), camera.y_up));
  const std::size_t count = points.size();
  constexpr int turns = 72;
  for (int turn = 1; turn < turns && camera.all_round; ++turn)
    for (std::size_t i = 0; i < count; ++i)
      points.push_back(Eigen::AngleAxisd(2 * pi * turn / turns, Vec3::UnitZ()) * points[i]);
  return points;
}

// Distance of an eye that sees all points along `axis`, for a picture that extends by `slope` to
// either side at distance 1. A point at (a, f) along axis and view is visible from (m, −d) where |a
// − m| ≤ slope (d + f).
double distance_to_see(const std::vector<Vec3>& points, const Vec3& axis, const Vec3& forward, double slope) {
  double most = -1e300, least = 1e300;
  for (const Vec3& p : points) {
    most = std::max(most, axis.dot(p) - slope * forward.dot(p));
    least = std::min(least, axis.dot(p) + slope * forward.dot(p));
  }
  return (most - least) / (2 * slope);
}

// Position of the eye along `axis`, at distance `back`, that centres the points.
double middle_of_view(const std::vector<Vec3>& points, const Vec3& axis, const Vec3& forward, double distance) {
  double low = -10, high = 10;  // the content has size 1
  for (int halving = 0; halving < 60; ++halving) {
    const double m = 0.5 * (low + high);
    double most = -1e300, least = 1e300;
    for (const Vec3& p : points) {
      const double seen = (axis.dot(p) - m) / (distance + forward.dot(p));
      most = std::max(most, seen);
      least = std::min(least, seen);
    }
    (most + least > 0 ? low : high) = m;
  }
  return 0.5 * (low + high);
}

}  // namespace

Picture render(const Stage& stage, const Camera& camera, const RenderOptions& options, const geo::Progress& progress) {
  const double radius = std::max(0.5 * camera.box.diagonal(), 1e-300);
  const Stage near =
      placed(stage, camera.box.empty() ? Vec3(Vec3::Zero()) : camera.box.center(), 1 / radius, camera.y_up);
  const Tracer tracer(near, progress);
  const double azimuth = camera.azimuth * pi / 180, elevation = camera.elevation * pi / 180;
  const Vec3 forward(std::sin(azimuth) * std::cos(elevation), std::cos(azimuth) * std::cos(elevation),
                     -std::sin(elevation));
  const Vec3 right = Vec3(std::cos(azimuth), -std::sin(azimuth), 0), up = right.cross(forward);
  const double all = std::tan(17 * pi / 180),
               field = all / camera.zoom;  // half the vertical field of view, from the distance that shows all
  const double aspect = double(options.width) / options.height;
  const double filled = 0.84;  // share of the picture, with space for shadows
  const std::vector<Vec3> points = to_be_seen(camera, 1 / radius);
  const double distance = std::max({distance_to_see(points, right, forward, filled * all * aspect),
                                    distance_to_see(points, up, forward, filled * all), 1e-3});
  Vec3 eye = -distance * forward;
  if (!camera.on_box)
    eye +=
        middle_of_view(points, right, forward, distance) * right + middle_of_view(points, up, forward, distance) * up;

  const int samples = options.samples * options.samples, rays = (options.occlusion + samples - 1) / samples;
  Picture picture(options.width, options.height);
  const auto draw_rows = [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y)
      for (int x = 0; x < options.width; ++x) {
        Color sum{};
        for (int s = 0; s < samples; ++s) {
          Dice dice(
              static_cast<std::uint32_t>(y) * static_cast<std::uint32_t>(options.width) + static_cast<std::uint32_t>(x),
              s, samples, rays);
          const double px = x + (s % options.samples + 0.5) / options.samples,
                       py = double(y) + (s / options.samples + 0.5) / options.samples;
          const Vec3 d = (forward + (2 * px / options.width - 1) * field * aspect * right +
                          (1 - 2 * py / options.height) * field * up)
                             .normalized();
          const Color c = tracer.shade(eye, d, dice);
          for (int k = 0; k < 3; ++k) sum[k] += c[k];
        }
        picture.at(x, static_cast<int>(y)) = scaled(sum, 1.0 / samples);
      }
  };
  const auto height = static_cast<std::size_t>(options.height);
  // Bands last a fiftieth to a tenth of a second, so that progress may stop them; pixels do not
  // depend on them.
  std::size_t band = 4;
  geo::Stopwatch watch;
  for (std::size_t top = 0; top < height;) {
    geo::report(progress, "render", top, height);
    const std::size_t rows = std::min(band, height - top);
    watch.lap();
    geo::parallel_for(rows, 1, [&](std::size_t begin, std::size_t end) { draw_rows(top + begin, top + end); });
    const double seconds = watch.lap();
    top += rows;
    if (seconds < 0.02) band *= 2;
    if (seconds > 0.1 && band > 1) band /= 2;
  }
  return picture;
}

}  // namespace view
