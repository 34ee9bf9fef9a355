// Keys are those of docs/live-protocol.md. Numbers for people are rounded to six digits.
#include "live/scene_text.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>
#include "sim/whole_run.h"

namespace live {
namespace {

using Json = nlohmann::ordered_json;

double six(double x) {
  if (x == 0 || !std::isfinite(x)) return 0;
  const double scale = std::pow(10.0, 5 - std::floor(std::log10(std::abs(x))));
  return std::isfinite(scale) ? std::round(x * scale) / scale : x;
}

Json point(const geo::Vec3& p) { return {six(p.x()), six(p.y()), six(p.z())}; }

Json flat(const std::vector<geo::Vec3>& points) {
  Json list = Json::array();
  for (const geo::Vec3& p : points)
    for (int k = 0; k < 3; ++k) list.push_back(six(p[k]));
  return list;
}

Json obstacles_of(const geo::Scene& scene) {
  Json list = Json::array();
  for (const geo::SceneObstacle& o : scene.obstacles) {
    Json about{{"name", o.name}};
    if (o.mesh.triangles.empty()) {
      about["point"] = point(o.place.position);
      about["normal"] = point(o.place.rotation * o.normal.normalized());
    } else {
      std::vector<geo::Vec3> world;
      for (const geo::Vec3& p : o.mesh.vertices) world.push_back(o.place * (o.scale * p));
      about["vertices"] = flat(world);
      about["triangles"] = Json::array();
      for (const geo::Triangle& t : o.mesh.triangles)
        for (const auto v : t) about["triangles"].push_back(v);
    }
    list.push_back(std::move(about));
  }
  return list;
}

// The least and the largest coefficient of friction of all that touches in a scene; of the ground
// where nothing does.
std::pair<double, double> frictions_of(const geo::Scene& scene) {
  std::vector<double> all;
  if (scene.ground) all.push_back(scene.friction);
  if (scene.self_contact) all.push_back(scene.contact.friction);
  for (const geo::SceneObstacle& o : scene.obstacles) all.push_back(o.friction);
  if (all.empty()) all.push_back(scene.friction);
  const auto [least, most] = std::minmax_element(all.begin(), all.end());
  return {*least, *most};
}

}  // namespace

std::string scene_text(const Session& session, const std::string& name, std::uint64_t run, bool from_gallery) {
  const geo::Scene& scene = session.original();
  const geo::Body& body = session.run().body();
  geo::Box3 box;
  for (const geo::Vec3& p : body.nodes.position) box.add(p);
  const double coarsest = *std::max_element(body.nodes.spacing.begin(), body.nodes.spacing.end());
  constexpr double most_dent = 0.1;  // of the resistance over Young's modulus, in node spacings (docs/formats.md)
  const double young = scene.material.young;
  Json bodies = Json::array(), blades = Json::array();
  for (const geo::SceneBody& b : scene.bodies) bodies.push_back(b.name);
  for (const geo::Blade& b : scene.blades) blades.push_back({{"name", b.name}, {"points", flat(b.at(0))}});
  Json text{{"name", name},
            {"run", run},
            {"gallery", from_gallery},
            {"up", sim::up_axis(scene.gravity) == 'Y' ? "y" : "z"},
            {"gravity", point(scene.gravity)},
            {"bodies", bodies},
            {"spacing", six(coarsest)},
            {"box", {point(box.lo - geo::Vec3::Constant(coarsest)), point(box.hi + geo::Vec3::Constant(coarsest))}},
            {"rate", scene.frame_rate},
            {"young", young},
            {"friction", frictions_of(scene).second},
            {"damping", scene.material.damping},
            {"blades", blades},
            {"obstacles", obstacles_of(scene)},
            {"ground", nullptr},
            {"options",
             {{"young", {young / 30, young * 30}},
              {"friction", {0, 1}},
              {"gravity", {0, 2}},
              {"resistance", {0, most_dent * young * coarsest}}}}};
  if (scene.ground)
    text["ground"] = {{"point", point(scene.ground_point)}, {"normal", point(scene.ground_normal.normalized())}};
  return text.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string statistics_text(const Session& session, const Pace& pace) {
  const geo::Scene& now = session.run().scene();
  Json force = Json::array(), edges = Json::array(), pins = Json::array();
  for (const auto& [edge, newtons] : session.edges()) {
    edges.push_back(flat(edge));
    force.push_back(six(newtons));
  }
  for (const geo::Vec3& p : session.hands().pins()) pins.push_back(point(p));
  Json holds = Json::array();
  for (const Hold& h : session.hands().holds())
    holds.push_back({{"id", h.number}, {"at", point(h.at)}, {"to", point(h.to)}});
  double pulled = 0;
  for (const geo::Vec3& f : session.stats().pull_force) pulled += f.norm();
  Json text{{"fps", six(pace.fps)},
            {"sim_rate", six(pace.rate)},
            {"step_ms", six(1e3 * pace.step)},
            {"accuracy", six(pace.effort.accuracy)},
            {"steps", pace.effort.steps},
            {"pieces", session.pieces()},
            {"blade_force", force},
            {"pull_force", six(pulled)},
            {"refused", session.refused()},
            {"newton", session.stats().newton},
            {"cut", session.has_cut()},
            {"paused", pace.paused},
            {"undo", session.history().strokes()},
            {"redo", session.history().undone()},
            {"blows", session.blows()},
            {"waiting", session.hands().waiting()},
            {"holds", holds},
            {"message", pace.message},
            {"stroke", session.hands().last_stroke()},
            {"pins", pins},
            {"edges", edges},
            {"set",
             {{"young", now.material.young},
              {"gravity", point(session.gravity())},
              {"friction", frictions_of(now).second},
              {"friction_least", frictions_of(now).first},
              {"damping", session.damping()},
              {"tension", session.original().prestretch.skin},
              {"resistance", session.hands().edges().resistance},
              {"dullness", session.hands().edges().friction}}}};
  const auto moves = [](const geo::SceneObstacle& o) { return !o.motion.keys.empty(); };
  if (std::any_of(now.obstacles.begin(), now.obstacles.end(), moves)) {
    text["obstacles"] = Json::array();
    for (const geo::SceneObstacle& o : now.obstacles) {
      const geo::Pose at = o.motion.at(session.run().state().time);
      text["obstacles"].push_back({at.rotation.w(), at.rotation.x(), at.rotation.y(), at.rotation.z(), at.position.x(),
                                   at.position.y(), at.position.z()});
    }
  }
  std::string result = text.dump(-1, ' ', false, Json::error_handler_t::replace);
  result.pop_back();
  return result;
}

}  // namespace live
