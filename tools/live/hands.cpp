// A blade or spring gets a key at each frame: the pose that the pointer had last.
#include "live/hands.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace live {
namespace {

constexpr std::size_t most_hands = 8;     // blades and springs at a time
constexpr double farthest_pull = 0.6;     // stretch of a spring, in diagonals of the body
constexpr double most_motion = 2;         // of an edge point in a frame, in the finest node spacing: one cut
constexpr double blade_width = 0.8;       // from edge to back, in the coarsest node spacing
constexpr double blade_thickness = 0.15;  // at the back: parts the sheets, and feels their force
constexpr double finest_edge = 48;        // segments of an edge

double finest_spacing(const geo::Body& body) {
  return *std::min_element(body.nodes.spacing.begin(), body.nodes.spacing.end());
}

double coarsest_spacing(const geo::Body& body) {
  return *std::max_element(body.nodes.spacing.begin(), body.nodes.spacing.end());
}

}  // namespace

Hands::Hands(geo::Simulation& run, const SurfaceView& view, double size) : run_(run), view_(view), size_(size) {
  const geo::Solid& solid = run.solid();
  for (std::uint32_t i = 0; i < solid.size(); ++i) mass_ += solid.mass(geo::NodeId(i));
}

void Hands::require_free_hand() const {
  if (strokes_.size() + grabs_.size() >= most_hands) throw BadMessage("there are as many strokes as can be at a time");
}

void Hands::obey(ClientId page, const Stroke& stroke) {
  const Hand hand{page, stroke.id};
  if (stroke.phase == Phase::begin) {
    if (strokes_.contains(hand)) throw BadMessage("this stroke has begun already");
    require_free_hand();
    if (stroke.depth > 100 * size_) throw BadMessage("the edge is too long");
    strokes_.emplace(hand, stroke);
    return;
  }
  const auto held = strokes_.find(hand);
  if (held == strokes_.end()) return;  // ended by undo or reset
  held->second.edge.add_path(stroke);
  held->second.ends = stroke.phase == Phase::end;
}

// Stiff enough to lift all bodies by a stretch of a tenth of their size, and about as stiff as the
// material in the neighbourhood that is held.
double Hands::pull_stiffness(std::uint32_t node, const geo::Vec3& gravity) const {
  const geo::Material& material = run_.solid().materials().of(node);
  return std::max(2 * material.young * run_.body().nodes.radius[node], 10 * mass_ * gravity.norm() / size_);
}

geo::NodeId Hands::carrier_of(geo::SurfaceVertexId vertex) const {
  const geo::Binding& binding = run_.body().binding;
  const auto master = binding.master[vertex.index()];
  if (!master.valid()) throw BadMessage("no node carries this point");
  return binding.master_node[master.index()];
}

void Hands::begin_grab(const Hand& hand, const Grab& grab, const geo::Vec3& gravity) {
  if (grabs_.contains(hand)) throw BadMessage("this grab has begun already");
  require_free_hand();
  if (grab.held) {
    const auto at = lasting_.springs.find(*grab.held);
    if (at == lasting_.springs.end()) throw BadMessage("there is nothing held by this number");
    grabs_[hand] = at->second;
    grabs_[hand].to = grab.to;
    lasting_.springs.erase(at);
    return;
  }
  const PickedPoint picked = view_.pick(run_.body().surface, grab.spot);
  geo::Pull pull;
  pull.point = picked.material;
  pull.node = carrier_of(picked.nearest).value;
  pull.stiffness = pull_stiffness(*pull.node, gravity);
  const auto added = run_.add_pull(std::move(pull), view_.world_point(grab.spot));
  grabs_[hand] = {.pull = added.index(), .to = grab.to, .nearest = picked.nearest};
}

void Hands::obey(ClientId page, const Grab& grab, const geo::Vec3& gravity) {
  const Hand hand{page, grab.id};
  if (grab.phase == Phase::begin) {
    begin_grab(hand, grab, gravity);
    return;
  }
  const auto held = grabs_.find(hand);
  if (held == grabs_.end()) return;
  held->second.to = grab.to;
  held->second.ends = grab.phase == Phase::end;
  if (grab.phase != Phase::hold) return;
  if (lasting_.springs.size() >= most_hands) throw BadMessage("as many places are held as can be at a time");
  if (held->second.number == 0) held->second.number = ++last_spring_;
  lasting_.springs[held->second.number] = held->second;
  grabs_.erase(held);
}

void Hands::obey(const Pin& pin) {
  const PickedPoint picked = view_.pick(run_.body().surface, pin.spot);
  const geo::Vec3& x = picked.material;
  if (!pin.on) {
    const auto held = std::find_if(lasting_.pins.begin(), lasting_.pins.end(), [&](const HeldPin& p) {
      return (p.material - x).cwiseAbs().maxCoeff() <= std::max(p.radius, pin.radius);
    });
    if (held == lasting_.pins.end()) throw BadMessage("there is no pin here");
    run_.grip(held->grip).end();
    lasting_.pins.erase(held);
    return;
  }
  const double radius = pin.radius > 0 ? pin.radius : coarsest_spacing(run_.body());
  const geo::Vec3& node = run_.body().nodes.position[carrier_of(picked.nearest).index()];
  geo::Grip grip;
  grip.lo = (x - geo::Vec3::Constant(radius)).cwiseMin(node);
  grip.hi = (x + geo::Vec3::Constant(radius)).cwiseMax(node);
  const auto added = run_.add_grip(std::move(grip));
  lasting_.pins.push_back(
      {.grip = added.index(), .material = x, .world = view_.world_point(pin.spot), .radius = radius});
}

void Hands::leave(ClientId page) {
  for (auto& [hand, held] : strokes_)
    if (hand.first == page) held.ends = true;
  for (auto& [hand, held] : grabs_)
    if (hand.first == page) held.ends = true;
}

void Hands::begin_anew(Lasting lasting) {
  strokes_.clear();
  grabs_.clear();
  lasting_ = std::move(lasting);
}

void Hands::add_blade(HeldBlade& held, const EdgePose& from) {
  const double coarsest = coarsest_spacing(run_.body()), length = held.edge.length();
  geo::Blade blade;
  blade.name = "stroke" + std::to_string(run_.scene().blades.size() + 1);
  const double n = std::clamp(std::ceil(length / finest_spacing(run_.body())), 1.0, finest_edge);
  for (int i = 0; i <= static_cast<int>(n); ++i) blade.points.push_back({0, 0, length * i / n});
  blade.limit = most_motion;
  blade.back = {blade_width * coarsest, 0, 0};
  blade.thickness = blade_thickness * coarsest;
  blade.friction = edges_.friction;
  blade.resistance = edges_.resistance;
  held.blade = run_.add_blade(std::move(blade), held.edge.pose_at(from)).index();
  held.faces = run_.body().surface.face_count();
}

void Hands::move_on(bool whole, const std::function<void()>& before_cut) {
  for (auto& [hand, held] : strokes_) {
    const double spacing = finest_spacing(run_.body());
    const EdgePose before = held.edge.now();
    held.edge.advance(whole ? std::numeric_limits<double>::infinity() : most_motion * spacing, spacing);
    if (!held.edge.has_back()) continue;
    if (!held.blade) {
      before_cut();
      add_blade(held, before);
    }
    run_.blade(*held.blade).drive_to(held.edge.pose());
  }
  for (const auto& [hand, held] : grabs_) move_on(held);
  for (const auto& [number, held] : lasting_.springs) move_on(held);
}

// A jump of the pointer is made in several frames.
void Hands::move_on(const HeldPull& held) {
  auto pull = run_.pull(held.pull);
  const double most = farthest_pull * size_;
  const geo::Vec3 before = pull.end(), way = held.to - before;
  pull.drive_to(way.norm() > most ? geo::Vec3(before + most / way.norm() * way) : held.to);
}

std::optional<std::vector<std::size_t>> Hands::end() {
  std::optional<std::vector<std::size_t>> ended;
  for (auto at = strokes_.begin(); at != strokes_.end();) {
    // A stroke that has ended goes on until its edge is where it ended.
    const HeldBlade& held = at->second;
    if (!held.ends || !held.edge.has_arrived()) {
      ++at;
      continue;
    }
    if (!ended) ended.emplace();
    if (held.blade && held.faces == run_.body().surface.face_count()) ended->push_back(*held.blade);
    last_stroke_ = at->first.second;
    at = strokes_.erase(at);
  }
  std::erase_if(grabs_, [&](const auto& entry) { return entry.second.ends; });
  return ended;
}

std::size_t Hands::stop_late(double seconds, double most) {
  std::size_t late = 0;
  for (auto& [hand, held] : strokes_) {
    if (!held.ends) continue;
    held.late += seconds;
    if (held.late < most) continue;
    held.edge.stop();
    ++late;
  }
  return late;
}

bool Hands::has_cut(std::uint32_t faces) const {
  return std::any_of(strokes_.begin(), strokes_.end(),
                     [&](const auto& entry) { return entry.second.blade && entry.second.faces != faces; });
}

std::vector<geo::Vec3> Hands::pins() const {
  std::vector<geo::Vec3> world;
  for (const HeldPin& pin : lasting_.pins) world.push_back(pin.world);
  return world;
}

std::vector<Hold> Hands::holds() const {
  std::vector<Hold> holds;
  const geo::Complex& surface = run_.body().surface;
  const auto add = [&](const HeldPull& held) {
    const geo::Pull& pull = run_.scene().pulls[held.pull];
    geo::Vec3 at = pull.point + run_.state().motion.displacement[*pull.node];
    if (const geo::Vec3* place = view_.place_of(held.nearest))
      at = *place + pull.point - surface.point(surface.site(held.nearest));
    holds.push_back({.number = held.number, .at = at, .to = held.to});
  };
  for (const auto& [number, held] : lasting_.springs) add(held);
  for (const auto& [hand, held] : grabs_)
    if (held.number != 0) add(held);
  return holds;
}

std::vector<std::uint64_t> Hands::waiting() const {
  std::vector<std::uint64_t> numbers;
  for (const auto& [hand, held] : strokes_) numbers.push_back(hand.second);
  return numbers;
}

}  // namespace live
