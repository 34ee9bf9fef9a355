#include "io/scene_file.h"

#include <cmath>
#include <filesystem>
#include <set>
#include <toml++/toml.h>

#include "base/error.h"
#include "io/stream.h"
#include "io/text_internal.h"

namespace geo {
namespace {

// One table of the file; every key must be asked for, or it is unknown.
class Table {
 public:
  Table(const toml::table& table, std::string name, std::string path) : table_(table), name_(std::move(name)), path_(std::move(path)) {}

  [[noreturn]] void fail(const toml::node& node, const std::string& what) const {
    const auto at = node.source().begin;
    throw InputError(name_ + ":" + std::to_string(at.line) + ":" + std::to_string(at.column) + ": " + what);
  }
  const toml::node* find(const std::string& key) {
    known_.insert(key);
    return table_.get(key);
  }
  void get(const std::string& key, double& value, double least, double most) {
    const auto* node = find(key);
    if (!node) return;
    const auto v = node->value<double>();
    if (!v) fail(*node, "'" + path_ + key + "' must be a number");
    if (!(*v >= least && *v <= most)) fail(*node, "'" + path_ + key + "' is out of range");
    value = *v;
  }
  void get(const std::string& key, int& value, int least, int most) {
    const auto* node = find(key);
    if (!node) return;
    const auto v = node->value_exact<std::int64_t>();
    if (!v || *v < least || *v > most) fail(*node, "'" + path_ + key + "' must be an integer from " + std::to_string(least) + " to " + std::to_string(most));
    value = static_cast<int>(*v);
  }
  void get(const std::string& key, std::string& value) {
    const auto* node = find(key);
    if (!node) return;
    const auto v = node->value_exact<std::string>();
    if (!v) fail(*node, "'" + path_ + key + "' must be text");
    value = *v;
  }
  void get(const std::string& key, bool& value) {
    const auto* node = find(key);
    if (!node) return;
    const auto v = node->value_exact<bool>();
    if (!v) fail(*node, "'" + path_ + key + "' must be true or false");
    value = *v;
  }
  std::vector<double> row(const toml::node& node, std::size_t size, const std::string& what) const {
    const auto* array = node.as_array();
    if (!array || array->size() != size) fail(node, what + " must be " + std::to_string(size) + " numbers");
    std::vector<double> values;
    for (const auto& e : *array) {
      const auto v = e.value<double>();
      if (!v || !std::isfinite(*v)) fail(e, what + " must be " + std::to_string(size) + " finite numbers");
      values.push_back(*v);
    }
    return values;
  }
  void get(const std::string& key, Vec3& value) {
    const auto* node = find(key);
    if (!node) return;
    const auto v = row(*node, 3, "'" + path_ + key + "'");
    value = {v[0], v[1], v[2]};
  }
  void get(const std::string& key, std::vector<std::array<Vec3, 2>>& boxes) {
    const auto* node = find(key);
    if (!node) return;
    if (!node->is_array()) fail(*node, "'" + path_ + key + "' must be a list of boxes [x0, y0, z0, x1, y1, z1]");
    for (const auto& box : *node->as_array()) {
      const auto v = row(box, 6, "a box of '" + path_ + key + "'");
      boxes.push_back({Vec3(v[0], v[1], v[2]), Vec3(v[3], v[4], v[5])});
    }
  }
  /// After all keys were asked for.
  void done() const {
    for (const auto& [key, node] : table_)
      if (!known_.count(std::string(key.str()))) fail(node, "unknown key '" + path_ + shown(key.str()) + "'");
  }

 private:
  const toml::table& table_;
  std::string name_, path_;
  std::set<std::string> known_;
};

void override_key(toml::table& root, const std::string& key, const std::string& value) {
  toml::table parsed;
  try {
    parsed = toml::parse("value = " + value);
  } catch (const toml::parse_error&) {
    parsed = toml::table{{"value", value}};  // a bare word is text
  }
  toml::table* table = &root;
  std::size_t from = 0;
  for (std::size_t dot; (dot = key.find('.', from)) != std::string::npos; from = dot + 1) {
    const std::string part = key.substr(from, dot - from);
    if (!table->contains(part)) table->insert(part, toml::table{});
    table = table->get(part)->as_table();
    if (!table) throw InputError("--set " + key + ": '" + part + "' is not a table");
  }
  table->insert_or_assign(key.substr(from), *parsed.get("value"));
}

}  // namespace

Scene read_scene(const std::string& path, const std::vector<std::pair<std::string, std::string>>& overrides) {
  Scene scene = parse_scene(read_all(path), path, overrides);
  if (const std::filesystem::path mesh = scene.mesh; mesh.is_relative() && path != "-") scene.mesh = (std::filesystem::path(path).parent_path() / mesh).string();
  return scene;
}

Scene parse_scene(const std::string& text, const std::string& name, const std::vector<std::pair<std::string, std::string>>& overrides) {
  toml::table root;
  try {
    root = toml::parse(text);
  } catch (const toml::parse_error& e) {
    throw InputError(name + ":" + std::to_string(e.source().begin.line) + ":" + std::to_string(e.source().begin.column) + ": " + shown(e.description(), 250));
  }
  for (const auto& [key, value] : overrides) override_key(root, key, value);
  Scene s;
  Table top(root, name, "");
  const auto section = [&](const std::string& key, const auto& read) {
    const auto* node = top.find(key);
    if (!node) return;
    if (!node->is_table()) top.fail(*node, "'" + key + "' must be a table");
    Table table(*node->as_table(), name, key + ".");
    read(table);
    table.done();
  };
  section("body", [&](Table& t) {
    t.get("mesh", s.mesh);
    t.get("spacing", s.sampling.spacing, 1e-12, 1e12);
    t.get("spacing_percent", s.spacing_percent, 0.05, 50);
    int nodes = 0;
    t.get("nodes", nodes, 1, 100000000);
    s.sampling.count = static_cast<std::size_t>(nodes);
    t.get("levels", s.sampling.levels, 1, 10);
    t.get("k", s.k, 3, 1000);
    t.get("velocity", s.velocity);
    t.get("fixed", s.fixed);
  });
  section("material", [&](Table& t) {
    std::string model = "neo-hookean";
    t.get("model", model);
    if (model == "stvk") s.material.model = ElasticModel::saint_venant_kirchhoff;
    else if (model != "neo-hookean") t.fail(*t.find("model"), "'material.model' must be \"neo-hookean\" or \"stvk\"");
    t.get("young", s.material.young, 1e-6, 1e15);
    t.get("poisson", s.material.poisson, -0.99, 0.4999);
    t.get("density", s.material.density, 1e-9, 1e9);
    t.get("volume_term", s.material.volume_term, 0, 1e15);
    t.get("damping", s.material.damping, 0, 1e6);
    t.get("mode_penalty", s.material.mode_penalty, 0, 100);
  });
  section("ground", [&](Table& t) {
    s.ground = true;
    t.get("point", s.ground_point);
    t.get("normal", s.ground_normal);
    t.get("stiffness", s.ground_stiffness, 0, 1e12);
    t.get("friction", s.friction, 0, 1);
    if (!(s.ground_normal.norm() > 0)) throw InputError(name + ": 'ground.normal' has no direction");
  });
  section("time", [&](Table& t) {
    t.get("frames", s.frames, 1, 1000000);
    t.get("frame_rate", s.frame_rate, 1e-6, 1e9);
    t.get("step", s.dt, 1e-9, 1e6);
    t.get("checkpoint_every", s.checkpoint_every, 1, 1000000);
    std::string integrator = "implicit";
    t.get("integrator", integrator);
    if (integrator != "implicit" && integrator != "leapfrog") t.fail(*t.find("integrator"), "'time.integrator' must be \"implicit\" or \"leapfrog\"");
    s.implicit = integrator == "implicit";
    int seed = 1;
    t.get("seed", seed, 0, 2147483647);
    s.seed = static_cast<std::uint64_t>(seed);
  });
  section("fracture", [&](Table& t) {
    s.fracture.on = true;
    t.get("strength", s.fracture.strength, 1e-9, 1e15);
    t.get("toughness", s.fracture.toughness, 0, 1e15);
    t.get("variation", s.fracture.variation, 0, 1);
    t.get("grain", s.fracture.grain, 0, 1e12);
    t.get("speed", s.fracture.speed, 0, 1);
    t.get("branching", s.fracture.branching, 0, 1e6);
    t.get("apart", s.fracture.apart, 0.5, 1000);
    t.get("cracks", s.fracture.cracks, 0, 1000000);
    t.get("cracks_per_step", s.fracture.cracks_per_step, 0, 1000000);
    t.get("start", s.fracture.start, 0, 1e9);
    t.get("off", s.fracture.off);
  });
  s.fracture.seed = s.seed;
  top.get("gravity", s.gravity);
  if (const auto* blades = top.find("blade")) {
    if (!blades->is_array_of_tables()) top.fail(*blades, "write each blade as [[blade]]");
    for (const auto& node : *blades->as_array()) {
      Table t(*node.as_table(), name, "blade.");
      Blade blade;
      blade.name = "blade" + std::to_string(s.blades.size() + 1);
      t.get("name", blade.name);
      t.get("closed", blade.closed);
      const auto list = [&](const std::string& key, std::size_t size, const auto& add) {
        const auto* rows = t.find(key);
        if (!rows || !rows->is_array() || rows->as_array()->size() < 2) t.fail(rows ? *rows : node, "'blade." + key + "' must be a list of two rows at least");
        for (const auto& r : *rows->as_array()) add(t.row(r, size, "a row of 'blade." + key + "'"));
      };
      list("points", 3, [&](const auto& v) { blade.points.push_back({v[0], v[1], v[2]}); });
      list("keys", 8, [&](const auto& v) { blade.keys.push_back({v[0], {v[1], v[2], v[3]}, {v[4], v[5], v[6]}, v[7]}); });
      for (std::size_t i = 0; i < blade.keys.size(); ++i) {
        if (!(blade.keys[i].axis.norm() > 0)) t.fail(node, "a key of blade '" + shown(blade.name) + "' has no axis: write 0, 0, 1, 0 for no rotation");
        if (i > 0 && !(blade.keys[i].time > blade.keys[i - 1].time)) t.fail(node, "the keys of blade '" + shown(blade.name) + "' must ascend in time");
      }
      // The edge is divided finely enough to follow what the body does to it.
      std::vector<Vec3> fine;
      int divide = 1;
      t.get("divide", divide, 1, 10000);
      const std::size_t n = blade.points.size(), segments = blade.closed ? n : n - 1;
      for (std::size_t i = 0; i < segments; ++i)
        for (int k = 0; k < divide; ++k) fine.push_back(blade.points[i] + (blade.points[(i + 1) % n] - blade.points[i]) * (double(k) / divide));
      if (!blade.closed) fine.push_back(blade.points.back());
      blade.points = fine;
      t.done();
      s.blades.push_back(std::move(blade));
    }
  }
  top.done();
  if (s.mesh.empty()) throw InputError(name + ": 'body.mesh' is missing: name the model");
  require_material(s.material);
  return s;
}

}  // namespace geo
