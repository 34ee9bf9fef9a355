// read_scene() of kerf/files.h. TOML by toml++, key by key through TomlTable, which reports
// unknown keys. Hashes of all files that the scene names enter its fingerprint.
#include "kerf/files.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <initializer_list>
#include <sstream>
#include <tuple>

#include "io/scene_keys.h"
#include "kerf/check.h"
#include "simulation/scene_changes.h"

namespace geo {
namespace {

// Reads the files that a scene names, and collects their hashes for the scene's fingerprint.
struct Files {
  std::filesystem::path folder;
  std::string contents;
  std::string path(const std::string& file) const {
    const std::filesystem::path path = file;
    return (path.is_relative() ? folder / path : path).string();
  }
  std::string read(const std::string& file) {
    std::string bytes = read_all(path(file));
    contents += std::to_string(fingerprint(bytes)) + ' ';
    return bytes;
  }
};

// Throws for keys that a single body must not set.
void refuse_shared(TomlTable& t, const std::string& table, std::initializer_list<const char*> keys) {
  for (const std::string key : keys)
    if (const auto* node = t.find(key))
      t.fail(*node, "'" + t.path() + key + "' is the same for all bodies: write it in the scene's [" + table + "]");
}

// Material of the scene; with `own` that of one body, whose missing keys keep the scene's values.
void read_material(TomlTable& t, Material& m, bool own = false) {
  std::string model = m.model == ElasticModel::saint_venant_kirchhoff ? "stvk" : "neo-hookean";
  t.get("model", model);
  if (model != "stvk" && model != "neo-hookean")
    t.fail(*t.find("model"), "'" + t.path() + "model' must be \"neo-hookean\" or \"stvk\"");
  m.model = model == "stvk" ? ElasticModel::saint_venant_kirchhoff : ElasticModel::neo_hookean;
  t.get("young", m.young, 1e-6, 1e15);
  t.get("poisson", m.poisson, -0.99, 0.4999);
  t.get("density", m.density, 1e-9, 1e9);
  t.get("volume_term", m.volume_term, 0, 1e15);
  t.get("damping", m.damping, 0, 1e6);
  if (own) refuse_shared(t, "material", {"discretisation"});
  std::string discretisation = m.discretisation == Discretisation::galerkin ? "galerkin" : "mueller04";
  t.get("discretisation", discretisation);
  if (discretisation != "galerkin" && discretisation != "mueller04")
    t.fail(*t.find("discretisation"), "'material.discretisation' must be \"galerkin\" or \"mueller04\"");
  m.discretisation = discretisation == "galerkin" ? Discretisation::galerkin : Discretisation::mueller04;
  t.get("viscosity", m.viscosity, 0, 1e15);
  t.get("mode_penalty", m.mode_penalty, 0, 100);
  t.get("yield", m.yield, 0, 1e6);
  t.get("creep", m.creep, 0, 1e9);
  t.get("most_plastic", m.max_plastic, 0, 1e6);
  require_material(m);
}

void read_strength(TomlTable& t, Strength& s) {
  t.get("strength", s.strength, 1e-9, 1e15);
  t.get("toughness", s.toughness, 0, 1e15);
  t.get("variation", s.variation, 0, 1);
  t.get("grain", s.grain, 0, 1e12);
}

void read_breakage(TomlTable& t, Breakage& b) {
  read_strength(t, b);
  t.get("cells", b.cells, 0, 100000);
  t.get("jagged", b.jagged, 0, 1);
}

// Reads a rotation [ax, ay, az, degrees], or a quaternion [w, x, y, z], which is taken to the bit.
void read_rotation(TomlTable& t, Pose& place, const std::string& what) {
  const auto *node = t.find("rotation"), *exact = t.find("quaternion");
  if (node && exact) t.fail(*exact, "give 'rotation' or 'quaternion', not both");
  if (exact) {
    const auto q = t.row(*exact, 4, "'" + t.path() + "quaternion'");
    place.rotation = Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
    if (!(std::abs(place.rotation.norm() - 1) < 1e-9)) t.fail(*exact, "a quaternion of a rotation has the norm 1");
  }
  if (!node) return;
  const auto v = t.row(*node, 4, "'" + what + "'");
  const Motion turn{{{.time = 0, .position = Vec3::Zero(), .axis = {v[0], v[1], v[2]}, .angle = v[3]}}};
  if (const auto wrong = unfit(turn.keys); !wrong.empty()) t.fail(*node, wrong);
  place.rotation = turn.at(0).rotation;
}

// `own`: of one body, which cannot say whether the shapes of all are those under load.
void read_prestretch(TomlTable& t, Prestretch& p, bool own) {
  if (const auto* node = t.find("stretch"); node && node->is_number()) {
    double all = 1;
    t.get("stretch", all, 0.1, 10);
    p.stretch.setConstant(all);
  } else {
    t.get("stretch", p.stretch);
    if (p.stretch.minCoeff() < 0.1 || p.stretch.maxCoeff() > 10) t.fail(*node, "a stretch lies between 0.1 and 10");
  }
  t.get("skin", p.skin, 0.1, 10);
  t.get("depth", p.depth, 0, 1e12);
  if (const auto* node = t.find("skin"); node && !(p.depth > 0))
    t.fail(*node, "give the 'depth' of the layer below the skin that is stretched, too");
  if (own) refuse_shared(t, "prestretch", {"loaded"});
}

void read_body_table(TomlTable& t, Scene& s) {
  SceneBody body;
  body.name = "body" + std::to_string(s.bodies.size() + 1);
  t.get("name", body.name);
  t.get("mesh", body.mesh);
  if (body.mesh.empty()) t.missing("mesh", "name the model");
  t.get("spacing", body.sampling.spacing, 1e-12, 1e12);
  t.get("spacing_percent", body.spacing_percent, 0.05, 50);
  int nodes = 0;
  t.get("nodes", nodes, 1, 100000000);
  body.sampling.count = static_cast<std::size_t>(nodes);
  if ((t.find("spacing") != nullptr) + (t.find("spacing_percent") != nullptr) + (nodes > 0) > 1)
    t.fail("give one of 'spacing', 'spacing_percent' and 'nodes'");
  t.get("levels", body.sampling.levels, 1, 10);
  t.get("across", body.sampling.across, 0, 100);
  t.get("k", s.k, 3, 1000);
  t.get("scale", body.scale, 1e-9, 1e9);
  t.get("refine", body.refine, 0, 1e12);
  t.get("position", body.place.position);
  read_rotation(t, body.place, "body.rotation");
  t.get("velocity", body.velocity);
  t.get("spin", body.spin);
  t.section("material", [&](TomlTable& own) { read_material(own, body.material.emplace(s.material), true); });
  t.section("prestretch", [&](TomlTable& own) { read_prestretch(own, body.prestretch.emplace(s.prestretch), true); });
  if (const auto* node = t.find("fracture"); node && !s.fracture.on)
    t.fail(*node,
           "'body.fracture' says how strong one body is; give the scene a [fracture], too, by which bodies break");
  s.fracture.per_body.push_back(s.fracture);
  t.section("fracture", [&](TomlTable& own) {
    read_breakage(own, s.fracture.per_body.back());
    refuse_shared(own, "fracture", {"speed", "branching", "apart", "cracks", "cracks_per_step", "start", "off"});
  });
  for (const auto& v : t.rows("fixed", 6))
    s.grips.push_back({.lo = {v[0], v[1], v[2]}, .hi = {v[3], v[4], v[5]}, .motion = {}, .release = false});
  s.bodies.push_back(std::move(body));
}

// Reads keyframes [time, x, y, z, ax, ay, az, degrees], in the scene or in a file.
Motion read_motion(TomlTable& t, Files& files) {
  Motion motion;
  for (const auto& v : t.rows("keys", 8))
    motion.keys.push_back({.time = v[0], .position = {v[1], v[2], v[3]}, .axis = {v[4], v[5], v[6]}, .angle = v[7]});
  std::string file;
  t.get("motion", file);
  if (!file.empty() && !motion.keys.empty()) t.fail(*t.find("motion"), "give 'keys' or 'motion', not both");
  if (!file.empty()) motion.keys = parse_motion(files.read(file), file);
  if (const auto wrong = unfit(motion.keys); !wrong.empty()) t.fail(wrong);
  return motion;
}

void read_blade(TomlTable& t, Scene& s, Files& files) {
  Blade blade;
  blade.name = "blade" + std::to_string(s.blades.size() + 1);
  t.get("name", blade.name);
  t.get("closed", blade.closed);
  for (const auto& v : t.rows("points", 3)) blade.points.push_back({v[0], v[1], v[2]});
  if (blade.points.size() < (blade.closed ? 3 : 2))
    t.fail("'blade.points' must be a list of two points at least, three when closed");
  blade.motion = read_motion(t, files);
  if (blade.motion.keys.size() < 2) t.fail("a blade needs two 'keys' at least, or a 'motion' file of them");
  // Divides the edge, so that the map into the deformed body bends it.
  std::vector<Vec3> fine;
  int divide = 1;
  t.get("divide", divide, 1, 10000);
  const std::size_t n = blade.points.size(), segments = blade.closed ? n : n - 1;
  for (std::size_t i = 0; i < segments; ++i)
    for (int k = 0; k < divide; ++k)
      fine.push_back(blade.points[i] + (blade.points[(i + 1) % n] - blade.points[i]) * (double(k) / divide));
  if (!blade.closed) fine.push_back(blade.points.back());
  blade.points = fine;
  t.get("back", blade.back);
  t.get("thickness", blade.thickness, 0, 1e9);
  if (blade.thickness > 0 && !(blade.back.norm() > 0))
    t.fail("a blade with 'thickness' needs 'back': the way from its edge to its back");
  t.get("stiffness", blade.stiffness, 0, 1e12);
  t.get("friction", blade.friction, 0, 10);
  if (blade.friction > 0 && !(blade.thickness > 0))
    t.fail(*t.find("friction"), "a blade without 'thickness' has no flanks; give it 'back' and 'thickness'");
  t.get("resistance", blade.resistance, 0, 1e12);
  if (blade.resistance > 0 && !s.implicit)
    t.fail(*t.find("resistance"), "blades have a resistance in implicit steps only; leave out 'time.integrator'");
  t.get("limit", blade.limit, 1e-3, 1e9);
  s.blades.push_back(std::move(blade));
}

void read_obstacle(TomlTable& t, Scene& s, Files& files) {
  SceneObstacle o;
  o.name = "obstacle" + std::to_string(s.obstacles.size() + 1);
  t.get("name", o.name);
  std::string mesh;
  t.get("mesh", mesh);
  const auto* normal = t.find("normal");
  if (mesh.empty() == !normal) t.fail("an obstacle is a 'mesh' or the 'normal' of a plane: give one of them");
  if (normal) {
    t.get("normal", o.normal);
    if (!(o.normal.norm() > 0)) t.fail(*normal, "'obstacle.normal' has no direction");
  } else {
    o.mesh = parse_surface(files.read(mesh), mesh).mesh;
    o.file = files.path(mesh);
    try {
      if (o.mesh.two_sided()) throw InputError("is cut; an obstacle is whole");
      require_solid(o.mesh);
    } catch (const InputError& e) {
      throw InputError(mesh + ": " + e.what());
    }
  }
  t.get("scale", o.scale, 1e-9, 1e9);
  t.get("position", o.place.position);
  read_rotation(t, o.place, "obstacle.rotation");
  o.motion = read_motion(t, files);
  t.get("stiffness", o.stiffness, 0, 1e12);
  t.get("friction", o.friction, 0, 10);
  s.obstacles.push_back(std::move(o));
}

void read_pull(TomlTable& t, Scene& s, Files& files) {
  Pull pull;
  if (!t.find("point")) t.missing("point", "where it holds the body");
  t.get("point", pull.point);
  int node = -1;
  t.get("node", node, 0, 2147483647);
  if (node >= 0) pull.node = static_cast<std::uint32_t>(node);
  t.get("stiffness", pull.stiffness, 0, 1e15);
  pull.motion = read_motion(t, files);
  if (pull.motion.keys.size() < 2) t.fail("a pull needs two 'keys' at least, or a 'motion' file of them");
  s.pulls.push_back(std::move(pull));
}

void read_stitch_end(TomlTable& t, Stitch::End& end, const std::string& which) {
  const std::string point = "point_" + which;
  if (!t.find(point)) t.missing(point, "which it holds");
  t.get(point, end.point);
  int node = -1;
  t.get("node_" + which, node, 0, 2147483647);
  if (node >= 0) end.node = static_cast<std::uint32_t>(node);
}

void read_stitch(TomlTable& t, Scene& s) {
  Stitch stitch;
  read_stitch_end(t, stitch.ends[0], "a");
  read_stitch_end(t, stitch.ends[1], "b");
  t.get("stiffness", stitch.stiffness, 0, 1e15);
  t.get("length", stitch.length, 0, 1e9);
  double slack = -1;
  t.get("slack", slack, 0, 1e9);
  if (slack >= 0) stitch.slack = slack;
  t.get("closing", stitch.closing, 0, 1e9);
  t.get("from", stitch.from, -1e9, 1e9);
  t.get("until", stitch.until, -1e9, 1e9);
  s.stitches.push_back(stitch);
}

void read_blow(TomlTable& t, Scene& s) {
  Blow blow;
  if (!t.find("point")) t.missing("point", "where it hits, in the world");
  t.get("time", blow.time, -1e9, 1e9);
  t.get("point", blow.point);
  t.get("cells", blow.cells, 2, 1000);
  if (!s.blows.empty() && blow.time < s.blows.back().time) t.fail("blows must be ascending in time");
  s.blows.push_back(blow);
}

// Corners of a box.
std::pair<Vec3, Vec3> read_box(TomlTable& t) {
  const auto* box = t.find("box");
  if (!box) t.missing("box", "x0, y0, z0, x1, y1, z1");
  const auto v = t.row(*box, 6, "'" + t.path() + "box'");
  return {{v[0], v[1], v[2]}, {v[3], v[4], v[5]}};
}

void read_load(TomlTable& t, Scene& s) {
  Load load;
  std::tie(load.lo, load.hi) = read_box(t);
  if (!t.find("traction")) t.missing("traction", "force over area, in Pa");
  t.get("traction", load.traction);
  t.get("from", load.from, 0, 1e9);
  t.get("ramp", load.ramp, 0, 1e9);
  t.get("until", load.until, 0, 1e9);
  s.loads.push_back(load);
}

void read_support(TomlTable& t, Scene& s, Files& files) {
  Support support;
  std::tie(support.lo, support.hi) = read_box(t);
  std::string axes;
  t.get("axes", axes);
  if (axes.empty()) t.missing("axes", "those along which the skin is held: \"z\", or \"xy\"");
  for (const char axis : axes) {
    if (axis != 'x' && axis != 'y' && axis != 'z')
      t.fail(*t.find("axes"), "'support.axes' must be made of the letters x, y and z");
    (axis == 'x' ? support.axes.x : axis == 'y' ? support.axes.y : support.axes.z) = true;
  }
  support.motion = read_motion(t, files);
  for (const Motion::Key& key : support.motion.keys)
    if (key.angle != 0) t.fail("a support does not turn: its keys have an angle of 0; a [[grip]] may turn");
  t.get("from", support.from, -1e9, 1e9);
  t.get("until", support.until, -1e9, 1e9);
  s.supports.push_back(std::move(support));
}

// A number where there is one.
void get(TomlTable& t, const char* key, std::optional<double>& value) {
  if (!t.find(key)) return;
  value = 0;
  t.get(key, *value, -1e300, 1e300);
}

void read_change(TomlTable& t, Scene& s) {
  SceneChange change;
  if (!t.find("time")) t.missing("time", "when the values change");
  t.get("time", change.time, 0, 1e9);
  get(t, "young", change.young);
  get(t, "damping", change.damping);
  get(t, "friction", change.friction);
  get(t, "accuracy", change.accuracy);
  get(t, "step", change.dt);
  if (t.find("gravity")) t.get("gravity", change.gravity.emplace());
  if (const auto wrong = unfit(change); !wrong.empty()) t.fail("a change: " + wrong);
  if (!s.changes.empty() && change.time < s.changes.back().time) t.fail("changes must ascend in time");
  s.changes.push_back(change);
}

void read_score(TomlTable& t, Scene& s, Files& files) {
  std::string file;
  int body = 0;
  t.get("file", file);
  t.get("body", body, 0, static_cast<int>(s.bodies.size()) - 1);
  if (file.empty()) t.missing("file", "name a front file");
  const SceneBody& of = s.bodies[static_cast<std::size_t>(body)];
  const std::filesystem::path path = file;
  const std::string name = path.filename().string();
  std::optional<Strength> glue;
  if (t.find("strength")) read_strength(t, glue.emplace());
  s.score_files.push_back({files.path(file), body, glue});
  for (Front& front : parse_fronts(files.read(file), name)) {
    for (auto& step : front.steps)
      for (Vec3& p : step) p = of.place * (of.scale * p);
    if (glue && !front.is_sheet()) t.fail("a front cannot be glued; give a sheet, or leave out 'strength'");
    s.scores.push_back({std::move(front), static_cast<std::uint32_t>(body), glue});
  }
}

void read_checkpoints(TomlTable& t, Scene& s) {
  const auto* node = t.find("checkpoints");
  if (!node) return;
  const auto* list = node->as_array();
  if (!list) t.fail(*node, "'time.checkpoints' must be a list of frames");
  for (const auto& e : *list) {
    const auto frame = e.value_exact<std::int64_t>();
    if (!frame || *frame < 1 || *frame > 1000000 || (!s.checkpoints.empty() && *frame <= s.checkpoints.back()))
      t.fail(e, "'time.checkpoints' must be frames from 1 to 1000000, ascending");
    s.checkpoints.push_back(static_cast<int>(*frame));
  }
}

// Bodies had a penalty of their own once, where they did not have self-contact. Keys of it are read
// where they mean what they meant.
void skip_former_contact(TomlTable& t, bool self_contact) {
  bool bodies = true;
  double stiffness = 0;
  t.get("bodies", bodies);
  t.get("stiffness", stiffness, 0, 1e12);
  const auto *about_bodies = t.find("bodies"), *about_stiffness = t.find("stiffness");
  if (about_bodies && !bodies && self_contact && !t.find("self"))
    t.fail(*about_bodies, "for bodies that do not touch each other, write 'contact.self' = false");
  if (self_contact || !bodies) return;
  if (about_bodies) t.fail(*about_bodies, "for bodies that touch each other, write 'contact.self' = true");
  if (about_stiffness)
    t.fail(*about_stiffness,
           "for bodies that touch each other, write 'contact.self' = true, whose stiffness follows "
           "the material");
}

void read_top(TomlTable& top, Scene& s, Files& files) {
  top.section("material", [&](TomlTable& t) { read_material(t, s.material); });
  top.section("fracture", [&](TomlTable& t) {
    s.fracture.on = true;
    read_breakage(t, s.fracture);
    t.get("speed", s.fracture.speed, 0, 1);
    t.get("branching", s.fracture.branching, 0, 1e6);
    t.get("apart", s.fracture.separation, 0.5, 1000);
    t.get("cracks", s.fracture.max_cracks, 0, 1000000);
    t.get("cracks_per_step", s.fracture.cracks_per_step, 0, 1000000);
    t.get("start", s.fracture.start, 0, 1e9);
    for (const auto& v : t.rows("off", 6)) s.fracture.off.push_back({Vec3(v[0], v[1], v[2]), Vec3(v[3], v[4], v[5])});
  });
  top.section("prestretch", [&](TomlTable& t) {
    read_prestretch(t, s.prestretch, false);
    t.get("loaded", s.loaded);
  });
  const auto* body = top.find("body");
  if (!body) top.missing("body", "write [body], and in it mesh = \"MODEL\"");
  if (body->is_table())
    top.section("body", [&](TomlTable& t) { read_body_table(t, s); });
  else
    top.list("body", [&](TomlTable& t) { read_body_table(t, s); });
  // Without differences a look-up for each node is not needed.
  if (std::all_of(s.fracture.per_body.begin(), s.fracture.per_body.end(),
                  [&](const Breakage& own) { return own == s.fracture; }))
    s.fracture.per_body.clear();
  top.section("ground", [&](TomlTable& t) {
    s.ground = true;
    t.get("point", s.ground_point);
    t.get("normal", s.ground_normal);
    t.get("stiffness", s.ground_stiffness, 0, 1e12);
    t.get("friction", s.friction, 0, 10);
    if (!(s.ground_normal.norm() > 0)) t.fail("'ground.normal' has no direction");
  });
  top.section("contact", [&](TomlTable& t) {
    t.get("self", s.self_contact);
    t.get("friction", s.contact.friction, 0, 10);
    t.get("gap", s.contact.gap, 1e-9, 0.1);
    skip_former_contact(t, s.self_contact);
  });
  top.section("time", [&](TomlTable& t) {
    t.get("frames", s.frames, 1, 1000000);
    t.get("frame_rate", s.frame_rate, 1e-6, 1e9);
    t.get("step", s.dt, 1e-9, 1e6);
    t.get("accuracy", s.accuracy, 1e-9, 0.1);
    t.get("sleep", s.sleep, 0, 1e9);
    t.get("checkpoint_every", s.checkpoint_every, 1, 1000000);
    read_checkpoints(t, s);
    std::string integrator = "implicit";
    t.get("integrator", integrator);
    if (integrator != "implicit" && integrator != "bossak" && integrator != "leapfrog")
      t.fail(*t.find("integrator"), "'time.integrator' must be \"implicit\", \"bossak\" or \"leapfrog\"");
    s.implicit = integrator != "leapfrog";
    s.scheme = integrator == "bossak" ? ImplicitScheme::bossak : ImplicitScheme::backward_euler;
    int seed = 1;
    t.get("seed", seed, 0, 2147483647);
    s.seed = static_cast<std::uint64_t>(seed);
  });
  s.fracture.seed = s.seed;
  top.get("gravity", s.gravity);
  top.list("grip", [&](TomlTable& t) {
    const auto [lo, hi] = read_box(t);
    Grip grip{.lo = lo, .hi = hi, .motion = read_motion(t, files), .release = false};
    t.get("release", grip.release);
    t.get("from", grip.from, -1e9, 1e9);
    t.get("until", grip.until, -1e9, 1e9);
    s.grips.push_back(std::move(grip));
  });
  top.list("blade", [&](TomlTable& t) { read_blade(t, s, files); });
  top.list("pull", [&](TomlTable& t) { read_pull(t, s, files); });
  top.list("stitch", [&](TomlTable& t) { read_stitch(t, s); });
  top.list("blow", [&](TomlTable& t) { read_blow(t, s); });
  top.list("load", [&](TomlTable& t) { read_load(t, s); });
  top.list("support", [&](TomlTable& t) { read_support(t, s, files); });
  top.list("change", [&](TomlTable& t) { read_change(t, s); });
  top.list("obstacle", [&](TomlTable& t) { read_obstacle(t, s, files); });
  top.list("score", [&](TomlTable& t) { read_score(t, s, files); });
}

// The number of frames and the paths of models do not change a frame, so they are left out.
std::uint64_t fingerprint_of(toml::table root, const std::string& contents) {
  if (auto* time = root["time"].as_table()) time->erase("frames");
  if (auto* body = root["body"].as_table()) body->erase("mesh");
  for (const char* list : {"body", "obstacle"})
    if (auto* rows = root[list].as_array())
      for (auto& row : *rows) row.as_table()->erase("mesh");
  std::ostringstream text;
  text << root << contents;
  return fingerprint(text.str());
}

}  // namespace

Scene read_scene(const std::string& path, const SceneOverrides& overrides) {
  const std::filesystem::path folder = path == "-" ? "" : std::filesystem::path(path).parent_path();
  Scene scene = parse_scene(read_all(path), path, overrides, folder.string());
  for (SceneBody& body : scene.bodies)
    if (const std::filesystem::path mesh = body.mesh; mesh.is_relative()) body.mesh = (folder / mesh).string();
  return scene;
}

Scene parse_scene(const std::string& text, const std::string& name, const SceneOverrides& overrides,
                  const std::string& folder) {
  toml::table root;
  try {
    root = toml::parse(text);
  } catch (const toml::parse_error& e) {
    throw InputError(name + ":" + std::to_string(e.source().begin.line) + ":" +
                     std::to_string(e.source().begin.column) + ": " + shown(e.description(), 250) +
                     (name == "-" || name.ends_with(".toml") || name.ends_with(".json")
                          ? ""
                          : "; a scene is a text file, as those in samples/scenes"));
  }
  for (const auto& [key, value] : overrides) override_key(root, key, value);
  Scene scene;
  Files files{folder, {}};
  TomlTable top(root, name, "");
  read_top(top, scene, files);
  top.done();
  scene.fingerprint = fingerprint_of(root, files.contents);
  return scene;
}

}  // namespace geo
