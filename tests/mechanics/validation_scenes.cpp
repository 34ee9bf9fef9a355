// Bodies that stand, slide and are stacked, in scenes at the default step, against rigid bodies.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include "kerf/files.h"
#include "kerf/mesh.h"
#include "kerf/simulation.h"
#include "mechanics/validation.h"

namespace validation {
namespace {

using namespace geo;

constexpr double gravity = 9.81;

// Text of a vector in a scene file.
std::string row(const Vec3& v) {
  std::ostringstream text;
  text.precision(17);
  text << "[" << v.x() << ", " << v.y() << ", " << v.z() << "]";
  return text.str();
}

// A run, and the centre of mass of one of its bodies.
class Run {
 public:
  Run(const std::string& text, const std::vector<TriangleMesh>& models)
      : scene_(parse_scene(text, "s.toml")), sim_(scene_, place_models(scene_, models)) {}

  void advance(int frames) {
    for (int i = 0; i < frames; ++i) {
      sim_.advance_frame();
      ++frame_;
      highest_ = std::max(highest_, centre(0).z());
    }
  }
  double time() const { return frame_ / scene_.frame_rate; }
  Vec3 centre(std::uint32_t body) const {
    return mean(body, [&](std::size_t i) -> Vec3 {
      return sim_.body().nodes.position[i] + sim_.state().motion.displacement[i];
    });
  }
  Vec3 velocity(std::uint32_t body) const {
    return mean(body, [&](std::size_t i) { return sim_.state().motion.velocity[i]; });
  }
  // The greatest height of the first body's centre, over all frames.
  double highest() const { return highest_; }
  double lowest_point() const {
    double lowest = 1e300;
    for (const Vec3& p : sim_.surface().vertices) lowest = std::min(lowest, p.z());
    return lowest;
  }

 private:
  template <class Of>
  Vec3 mean(std::uint32_t body, const Of& of) const {
    double mass = 0;
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < sim_.body().nodes.size(); ++i) {
      if (sim_.state().body_index[i] != body) continue;
      const double own = sim_.solid().mass(NodeId(i));
      mass += own;
      sum += own * of(i);
    }
    return sum / mass;
  }

  Scene scene_;
  Simulation sim_;
  int frame_ = 0;
  double highest_ = -1e300;
};

std::string number(double x) {
  std::ostringstream text;
  text << x;
  return text.str();
}

// A slope: the scene without its friction and contact, and the body that slides down along +x.
struct Slope {
  std::string what, text;
  std::vector<TriangleMesh> models;
  std::uint32_t body;
  Vec3 down;
};

const std::string block = "[[body]]\nmesh = 'a'\nnodes = 200\n";
const std::string firm = "[material]\nyoung = 1e7\n";

std::vector<Slope> slopes(double degrees, double friction) {
  const double angle = degrees * std::numbers::pi / 180;
  const Vec3 pull = gravity * Vec3(std::sin(angle), 0, -std::cos(angle)), down(std::cos(angle), 0, -std::sin(angle)),
             up(std::sin(angle), 0, std::cos(angle));
  const std::string mu = "friction = " + number(friction) + "\n",
                    turn = "rotation = [0, 1, 0, " + number(degrees) + "]\n";
  const TriangleMesh model = make_block({1, 1, 0.5}, 0.25);
  // A moving plane takes the body along: in its frame nothing differs.
  const std::string keys = "keys = [[0, 0, 0, 0, 0, 0, 1, 0], [4, " + number(-4 * down.x()) + ", 0, " +
                           number(-4 * down.z()) + ", 0, 0, 1, 0]]\n";
  const std::string along = "velocity = " + row(-down) + "\n";
  return {
      {"Ground, gravity tilted",
       "gravity = " + row(pull) + "\n" + block + firm + "[ground]\n" + mu,
       {model},
       0,
       Vec3::UnitX()},
      {"Ground, tilted", block + turn + firm + "[ground]\nnormal = " + row(up) + "\n" + mu, {model}, 0, down},
      {"Plane that moves up at 1 m/s",
       block + turn + along + firm + "[[obstacle]]\nnormal = [0, 0, 1]\n" + turn + mu + keys,
       {model},
       0,
       down},
      {"Body on a body",
       "gravity = " + row(pull) + "\n" + block + "[[body]]\nmesh = 'b'\nnodes = 100\nposition = [0.5, 1.03, 0.5001]\n" +
           firm + "[[grip]]\nbox = [-1, -1, -1, 9, 9, 0.3]\n[contact]\n" + mu,
       {make_block({6, 3, 0.5}, 0.5), make_block({0.8, 0.8, 0.5}, 0.25)},
       1,
       Vec3::UnitX()}};
}

}  // namespace

std::vector<Finding> standing(int size) {
  std::vector<Finding> found;
  for (const double edge : {1.0, 0.5, 0.25})
    for (const char* self : {"true", "false"}) {
      Run run("[body]\nmesh = 'a'\nnodes = 300\n[material]\nyoung = 1e6\n[ground]\n[contact]\nself = " +
                  std::string(self) + "\n",
              {make_block({1, 1, 1}, edge)});
      const double from = run.centre(0).z();
      run.advance(size ? 48 : 16);
      const std::string what =
          "Cube that stands, " + std::to_string(std::lround(1 / edge)) + " squares a side, contact.self = " + self;
      found.push_back(
          {what + ": lowest point, m", "0, less the depth of the penalty", run.lowest_point(), 0, 1e-3, true});
      found.push_back(
          {what + ": highest rise of its centre, m", "≤ 0", std::max(0.0, run.highest() - from), 0, 1e-5, true});
    }
  return found;
}

std::vector<Finding> sliding(int size) {
  std::vector<Finding> found;
  using Case = std::pair<double, double>;
  for (const auto& [degrees, friction] : size ? std::vector<Case>{{20, 0.5}, {10, 0.2}, {35, 0.5}, {35, 0.2}, {20, 0.1}}
                                              : std::vector<Case>{{20, 0.5}, {35, 0.5}})
    for (const Slope& slope : slopes(degrees, friction)) {
      const double angle = degrees * std::numbers::pi / 180;
      Run run(slope.text, slope.models);
      run.advance(8);
      const double early = run.time(), speed = slope.down.dot(run.velocity(slope.body));
      run.advance(12);
      const double gained = (slope.down.dot(run.velocity(slope.body)) - speed) / (run.time() - early);
      const std::string what = slope.what + ", " + number(degrees) + "°, μ = " + number(friction);
      if (std::tan(angle) < friction)
        found.push_back({what + ": acceleration, m/s²", "0: it sticks", gained, 0, 0.05, true});
      else
        found.push_back({what + ": coefficient by the acceleration", "μ = (g sin α − a) / (g cos α)",
                         (gravity * std::sin(angle) - gained) / (gravity * std::cos(angle)), friction, 0.03});
    }
  return found;
}

std::vector<Finding> stacking(int size) {
  std::vector<Finding> found;
  constexpr double young = 1e8, density = 1000, gap = 1e-4;
  for (const int count : size ? std::vector{3, 10} : std::vector{3}) {
    std::string text;
    for (int i = 0; i < count; ++i)
      text += "[[body]]\nmesh = 'a'\nnodes = 120\nposition = [0, 0, " + std::to_string(i * (1 + gap)) + "]\n";
    Run run(text + "[material]\nyoung = 1e8\n[ground]\n",
            std::vector<TriangleMesh>(std::size_t(count), make_block({1, 1, 1}, 0.25)));
    const auto top = std::uint32_t(count - 1);
    const Vec3 from = run.centre(top);
    run.advance(size ? 48 : 24);
    const Vec3 moved = run.centre(top) - from;
    // The centre of the topmost cube, at the height h of H, sinks by ρ g (H h − h² / 2) / E.
    const double all = count, height = count - 0.5,
                 sunk = density * gravity * (all * height - 0.5 * height * height) / young + (count - 1) * gap;
    const std::string what = "Stack of " + std::to_string(count) + " cubes after " + (size ? "2 s" : "1 s");
    found.push_back(
        {what + ": its top sinks, m", "ρ g (H h − h² / 2) / E and the gaps", -moved.z(), sunk, 5e-4 * count, true});
    found.push_back({what + ": drift of its top, m", "0", moved.head<2>().norm(), 0, 1e-3 * count, true});
    found.push_back({what + ": speed of its top, m/s", "0", run.velocity(top).norm(), 0, 5e-3, true});
  }
  return found;
}

}  // namespace validation
