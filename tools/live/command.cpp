// JSON by nlohmann's parser, which refuses what is no JSON without exceptions. Nesting is bounded
// before, since the parser's values are destroyed recursively.
#include "live/command.h"

#include <cmath>
#include <initializer_list>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace live {
namespace {

using Json = nlohmann::json;

constexpr double farthest = 1e9;      // coordinate, model units
constexpr int deepest = 8;            // nesting
constexpr std::size_t max_rows = 64;  // of a list: more do not fit into a message

void require_shallow(std::string_view text) {
  int depth = 0;
  for (const char c : text) {
    depth += (c == '{' || c == '[') - (c == '}' || c == ']');
    if (depth > deepest) throw BadMessage("the message is nested too deeply");
  }
}

// A table of the message. done() refuses it where it has a key that was not looked up.
class Table {
 public:
  Table(const Json& json, std::string name) : json_(json), name_(std::move(name)) {
    if (!json.is_object()) throw BadMessage("'" + name_ + "' must be a table");
  }
  const Json* find(const char* key) {
    const auto at = json_.find(key);
    if (at == json_.end()) return nullptr;
    known_.insert(key);
    return &*at;
  }
  const Json& at(const char* key) {
    const Json* value = find(key);
    if (!value) throw BadMessage("'" + name_ + "." + key + "' is missing");
    return *value;
  }
  [[noreturn]] void fail(const char* key, const std::string& what) const {
    throw BadMessage("'" + name_ + "." + key + "' must be " + what);
  }
  double number(const char* key, double least, double most) { return in_range(key, at(key), least, most); }
  std::optional<double> optional_number(const char* key, double least, double most) {
    const Json* value = find(key);
    return value ? std::optional(in_range(key, *value, least, most)) : std::nullopt;
  }
  std::uint64_t count(const char* key, std::uint64_t most) {
    const Json& value = at(key);
    if (!value.is_number_unsigned() || value.get<std::uint64_t>() > most)
      fail(key, "a whole number up to " + std::to_string(most));
    return value.get<std::uint64_t>();
  }
  bool flag(const char* key) { return as_flag(key, at(key)); }
  std::optional<bool> optional_flag(const char* key) {
    const Json* value = find(key);
    return value ? std::optional(as_flag(key, *value)) : std::nullopt;
  }
  geo::Vec3 point(const char* key) { return as_point(key, at(key)); }
  std::optional<geo::Vec3> optional_point(const char* key) {
    const Json* value = find(key);
    return value ? std::optional(as_point(key, *value)) : std::nullopt;
  }
  geo::Vec3 direction(const char* key) { return unit(key, point(key)); }
  geo::Vec3 unit(const char* key, const geo::Vec3& v) const {
    if (!(v.norm() > 1e-6) || !(v.norm() < 1e6)) fail(key, "a direction");
    return v.normalized();
  }
  // A list, if it is there, of rows of three numbers and `more` others.
  std::vector<std::pair<geo::Vec3, std::vector<double>>> pairs(const char* key, std::size_t more) {
    const Json* value = find(key);
    if (!value) return {};
    if (!value->is_array() || value->size() > max_rows) fail(key, "a list of at most " + std::to_string(max_rows));
    std::vector<std::pair<geo::Vec3, std::vector<double>>> rows;
    for (const Json& row : *value) {
      if (!row.is_array() || row.size() != 3 + more) fail(key, "rows of " + std::to_string(3 + more) + " numbers");
      std::vector<double> x;
      for (const Json& number : row) x.push_back(in_range(key, number, -farthest, farthest));
      rows.push_back({{x[0], x[1], x[2]}, {x.begin() + 3, x.end()}});
    }
    return rows;
  }
  double bounded(const char* key, double x, double least, double most) const {
    if (!(x >= least && x <= most)) fail(key, "from " + std::to_string(least) + " to " + std::to_string(most));
    return x;
  }
  void done() const {
    if (known_.size() == json_.size()) return;
    throw BadMessage("'" + name_ + "' has a key that is not known");
  }

 private:
  double in_range(const char* key, const Json& value, double least, double most) const {
    if (!value.is_number()) fail(key, "a number");
    return bounded(key, value.get<double>(), least, most);
  }
  bool as_flag(const char* key, const Json& value) const {
    if (!value.is_boolean()) fail(key, "true or false");
    return value.get<bool>();
  }
  geo::Vec3 as_point(const char* key, const Json& value) const {
    if (!value.is_array() || value.size() != 3) fail(key, "three numbers");
    geo::Vec3 v;
    for (int i = 0; i < 3; ++i) v[i] = in_range(key, value[static_cast<std::size_t>(i)], -farthest, farthest);
    return v;
  }

  const Json& json_;
  std::string name_;
  std::set<std::string_view> known_;
};

constexpr std::uint64_t largest_count = std::uint64_t(1) << 53;  // JavaScript's whole numbers

Phase phase_of(Table& t) {
  const Json& value = t.at("phase");
  if (value == "begin") return Phase::begin;
  if (value == "move") return Phase::move;
  if (value == "end") return Phase::end;
  t.fail("phase", "\"begin\", \"move\" or \"end\"");
}

Phase grab_phase_of(Table& t) { return t.at("phase") == "hold" ? Phase::hold : phase_of(t); }

// The pose of an edge on a ray from the eye, which begins at a distance from it.
EdgePose on_ray(const geo::Vec3& eye, const geo::Vec3& ray, double from) { return {eye + from * ray, ray}; }

// The pose of an edge `depth` long across a surface. It begins above the surface, at a quarter of
// its depth.
constexpr double share_above = 0.25;
EdgePose across_surface(const geo::Vec3& point, const geo::Vec3& normal, double depth) {
  return {point + share_above * depth * normal, -normal};
}

Stroke knife_of(Table& t) {
  const geo::Vec3 eye = t.point("eye");
  Stroke s{.id = t.count("id", largest_count),
           .input = t.count("input", largest_count),
           .phase = phase_of(t),
           .origin = eye,
           .direction = t.direction("ray"),
           .depth = t.number("depth", 1e-9, farthest)};
  s.origin = on_ray(eye, s.direction, t.number("from", 0, farthest)).origin;
  for (const auto& [ray, from] : t.pairs("way", 1))
    s.way.push_back(on_ray(eye, t.unit("way", ray), t.bounded("way", from[0], 0, farthest)));
  return s;
}

Stroke scalpel_of(Table& t) {
  Stroke s{.id = t.count("id", largest_count),
           .input = t.count("input", largest_count),
           .phase = phase_of(t),
           .origin = t.point("point"),
           .direction = t.direction("normal"),
           .depth = t.number("depth", 1e-9, farthest)};
  for (const auto& [point, normal] : t.pairs("way", 3))
    s.way.push_back(across_surface(point, t.unit("way", {normal[0], normal[1], normal[2]}), s.depth));
  const EdgePose pose = across_surface(s.origin, s.direction, s.depth);
  s.origin = pose.origin;
  s.direction = pose.direction;
  s.above = share_above * s.depth;
  s.depth += *s.above;
  return s;
}

Spot spot_of(Table& t) {
  Spot spot{static_cast<std::uint32_t>(t.count("face", 0xffffffffu)), t.point("bary")};
  if (spot.bary.minCoeff() < -0.01 || std::abs(spot.bary.sum() - 1) > 0.01) t.fail("bary", "barycentric coordinates");
  return spot;
}

Grab grab_of(Table& t) {
  Grab g{.id = t.count("id", largest_count),
         .input = t.count("input", largest_count),
         .phase = grab_phase_of(t),
         .spot = {},
         .to = t.point("to")};
  if (t.find("held")) g.held = t.count("held", largest_count);
  if (g.phase == Phase::begin && !g.held) {
    g.spot = spot_of(t);
  } else {
    t.find("face");
    t.find("bary");
  }
  return g;
}

Pin pin_of(Table& t) { return {spot_of(t), t.flag("on"), t.optional_number("radius", 0, farthest).value_or(0)}; }

Blow blow_of(Table& t) {
  constexpr std::uint64_t fewest = 2, most = 64;
  const std::uint64_t cells = t.count("cells", most);
  if (cells < fewest) t.fail("cells", "2 to 64");
  return {spot_of(t), static_cast<int>(cells)};
}

Set set_of(Table& t) {
  constexpr double most_tension = 2;  // living skin bears about half of it
  return {.young = t.optional_number("young", 1, 1e12),
          .friction = t.optional_number("friction", 0, 1),
          .damping = t.optional_number("damping", 0, 1e3),
          .gravity = t.optional_point("gravity"),
          .resistance = t.optional_number("resistance", 0, 1e9),
          .dullness = t.optional_number("dullness", 0, 2),
          .tension = t.optional_number("tension", 1, most_tension)};
}

template <class Read>
auto inner(const Json& value, const std::string& key, const Read& read) {
  Table t(value, key);
  auto command = read(t);
  t.done();
  return command;
}

// A key whose value is true and says nothing else.
template <class Sign>
Sign sign(const Json& value, const std::string& key) {
  if (value != true) throw BadMessage("'" + key + "' must be true");
  return {};
}

Command command_of(const std::string& key, const Json& value) {
  if (key == "ack") {
    if (!value.is_number_unsigned() || value.get<std::uint64_t>() > 0xffffffffu)
      throw BadMessage("'ack' must be the number of a message");
    return Acknowledge{static_cast<std::uint32_t>(value.get<std::uint64_t>())};
  }
  if (key == "want")
    return inner(value, key, [](Table& t) {
      return Want{.nodes = t.optional_flag("nodes"),
                  .stress = t.optional_flag("stress"),
                  .rest = t.optional_flag("rest"),
                  .graph = t.optional_flag("graph").value_or(false)};
    });
  if (key == "knife") return inner(value, key, knife_of);
  if (key == "scalpel") return inner(value, key, scalpel_of);
  if (key == "grab") return inner(value, key, grab_of);
  if (key == "pin") return inner(value, key, pin_of);
  if (key == "break") return inner(value, key, blow_of);
  if (key == "set") return inner(value, key, set_of);
  if (key == "show") {
    if (!value.is_string()) throw BadMessage("'show' must be the name of a body of the gallery");
    return Show{value.get<std::string>()};
  }
  if (key == "undo") return sign<Undo>(value, key);
  if (key == "redo") return sign<Redo>(value, key);
  if (key == "reset") return sign<Reset>(value, key);
  if (key == "step") return sign<Step>(value, key);
  if (key == "pause") {
    if (!value.is_boolean()) throw BadMessage("'pause' must be true or false");
    return Pause{value.get<bool>()};
  }
  throw BadMessage("the message is of no known kind");
}

}  // namespace

void add_pose(std::vector<EdgePose>& path, const EdgePose& pose) {
  if (path.size() >= longest_path) {
    std::size_t kept = 0;
    for (std::size_t i = 1; i < path.size(); i += 2) path[kept++] = path[i];
    path.resize(kept);
  }
  path.push_back(pose);
}

Command read_command(std::string_view text) {
  if (text.size() > longest_message) throw BadMessage("the message is longer than 4096 bytes");
  require_shallow(text);
  const Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) throw BadMessage("the message is no JSON");
  if (!json.is_object() || json.size() != 1) throw BadMessage("a message is a table with one key");
  return command_of(json.begin().key(), json.begin().value());
}

}  // namespace live
