// A blade or spring gets a key at each frame: the pose that the pointer had last. A run that went
// back goes on from the checkpoint of that frame, as it would be read from a file.
#include "live/session.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include <kerf/error.h>
#include <kerf/pieces.h>
#include "live/memory.h"
#include "sim/start.h"

namespace live {
namespace {

constexpr std::size_t most_hands = 8;     // blades and springs at a time
constexpr int count_interval = 12;        // frames between two counts of pieces while a blade cuts
constexpr double farthest_pull = 0.6;     // stretch of a spring, in diagonals of the body
constexpr double most_motion = 2;         // of an edge point in a frame, in the finest node spacing: one cut
constexpr double most_bend = 0.125;       // of a path in a frame, in that spacing: most_motion on a circle of four
constexpr double blade_width = 0.8;       // from edge to back, in the coarsest node spacing
constexpr double blade_thickness = 0.15;  // at the back: parts the sheets, and feels their force
constexpr double finest_edge = 48;        // segments of an edge

// The part of v across a unit direction.
geo::Vec3 across(const geo::Vec3& v, const geo::Vec3& direction) { return v - v.dot(direction) * direction; }

// The larger motion of an edge's two ends.
double way_between(const EdgePose& a, const EdgePose& b, double length) {
  const geo::Vec3 way = b.origin - a.origin;
  return std::max(way.norm(), (way + length * (b.direction - a.direction)).norm());
}

// A motion of an edge towards a pose of its path.
struct Advance {
  EdgePose pose;
  double way = 0;  // of its ends
  bool arrives = false;
};

// Both ends go straight.
Advance approach(const EdgePose& from, const EdgePose& to, double length, double most) {
  const double way = way_between(from, to, length);
  if (way <= most) return {to, way, true};
  EdgePose pose = from;
  pose.origin += most / way * (to.origin - from.origin);
  const geo::Vec3 direction = from.direction + most / way * (to.direction - from.direction);
  if (direction.norm() > 0.1) pose.direction = direction.normalized();
  return {pose, most, false};
}

// Moves an edge on the surface, no point of it farther than `most`. Normals of triangles jump. An
// edge that turned with them would sweep a sheet that crosses itself and cuts off crumbs. So the
// turn moves a point by at most `most_turn` of the way across the edge, and every point goes
// forward. The edge has arrived when it is at the point, however it is turned.
Advance follow(const EdgePose& from, const EdgePose& to, double length, double above, double most) {
  constexpr double most_turn = 0.5;
  const double reach = std::max(above, length - above);
  const geo::Vec3 begin = from.origin + above * from.direction;
  const geo::Vec3 all = to.origin + above * to.direction - begin;
  const double share = std::min(1.0, most / std::max((1 + most_turn) * all.norm(), 1e-300));
  const geo::Vec3 way = share * all, turn = share * (to.direction - from.direction);
  const double wanted = reach * turn.norm(), bound = most_turn * across(way, from.direction).norm();
  EdgePose pose;
  pose.direction = (from.direction + (wanted > bound ? bound / wanted : 1) * turn).normalized();
  pose.origin = begin + way - above * pose.direction;
  return {pose, (1 + most_turn) * way.norm(), share == 1};
}

double distance_to_segment(const geo::Vec3& p, const geo::Vec3& a, const geo::Vec3& b) {
  const geo::Vec3 way = b - a;
  const double size = way.squaredNorm(), at = size > 0 ? std::clamp((p - a).dot(way) / size, 0.0, 1.0) : 0;
  return (p - a - at * way).norm();
}

// Whether the ends of an edge that goes straight from a pose to another one come within `most` of
// where they are in the poses between.
bool is_straight(const EdgePose& from, std::span<const EdgePose> between, const EdgePose& to, double length,
                 double most) {
  const auto far_end = [&](const EdgePose& pose) { return geo::Vec3(pose.origin + length * pose.direction); };
  return std::all_of(between.begin(), between.end(), [&](const EdgePose& pose) {
    return distance_to_segment(pose.origin, from.origin, to.origin) <= most &&
           distance_to_segment(far_end(pose), far_end(from), far_end(to)) <= most;
  });
}

// The pose of an edge along local z, whose back is along local x.
geo::Pose pose_of(const geo::Vec3& origin, const geo::Vec3& direction, const geo::Vec3& back) {
  geo::Mat3 axes;
  axes << back, direction.cross(back), direction;
  return {origin, Eigen::Quaterniond(axes).normalized()};
}

// Keys after a time go. The motion then ends where it was at that time.
void cut_motion(geo::Motion& motion, double time) {
  if (motion.keys.empty() || motion.keys.back().time <= time) return;
  const geo::Vec3 position = motion.at(time).position;
  std::erase_if(motion.keys, [&](const geo::Motion::Key& key) { return key.time > time; });
  if (motion.keys.empty() || motion.keys.back().time == time) return;
  motion.keys.push_back(motion.keys.back());
  motion.keys.back().time = time;
  motion.keys.back().position = position;
}

double finest_spacing(const geo::Body& body) {
  return *std::min_element(body.nodes.spacing.begin(), body.nodes.spacing.end());
}

double coarsest_spacing(const geo::Body& body) {
  return *std::max_element(body.nodes.spacing.begin(), body.nodes.spacing.end());
}

}  // namespace

void adapt_scene(geo::Scene& scene, double rate, bool blades) {
  scene.frame_rate = rate;
  scene.dt = std::min(scene.dt, 1 / rate);
  scene.checkpoint_every = 1000000;
  if (!blades) scene.blades.clear();
}

Session::Session(const sim::Setup& setup, const geo::Progress& progress, const SessionBounds& bounds)
    : setup_(setup),
      bounds_(bounds),
      start_(sim::first_checkpoint(setup, progress)),
      run_(sim::run_from(setup.scene, start_)) {
  faces_ = run_.body().surface.face_count();
  for (std::uint32_t i = 0; i < run_.solid().size(); ++i) mass_ += run_.solid().mass(geo::NodeId(i));
  count_pieces();
}

void Session::count_pieces() {
  constexpr double least_share = 1e-6;  // of the volume: smaller pieces are specks
  const geo::Pieces pieces = geo::find_pieces(run_.body().surface);
  const double least = least_share * std::accumulate(pieces.volume.begin(), pieces.volume.end(), 0.0);
  pieces_ = static_cast<std::uint32_t>(
      std::count_if(pieces.volume.begin(), pieces.volume.end(), [&](double v) { return v > least; }));
  counted_faces_ = run_.body().surface.face_count();
  since_count_ = 0;
}

void Session::require_space() const {
  const geo::Scene& scene = run_.scene();
  std::size_t keys = 0;
  for (const geo::Blade& b : scene.blades) keys += b.motion.keys.size();
  for (const geo::Pull& p : scene.pulls) keys += p.motion.keys.size();
  if (scene.blades.size() + scene.grips.size() + scene.pulls.size() >= bounds_.recorded || keys >= bounds_.keys)
    throw BadMessage("the recording is full; save it and reset");
}

void Session::require_free_hand() const {
  require_space();
  if (blades_.size() + pulls_.size() >= most_hands) throw BadMessage("there are as many strokes as can be at a time");
}

void Session::obey(ClientId page, const Stroke& stroke) {
  taken_[page] = stroke.input;
  const Hand hand{page, stroke.id};
  if (stroke.phase == Phase::begin) {
    if (blades_.contains(hand)) throw BadMessage("this stroke has begun already");
    require_free_hand();
    if (stroke.depth > 100 * geo::bounding_box(setup_.models.all).diagonal()) throw BadMessage("the edge is too long");
    HeldBlade& held = blades_[hand];
    held.now = {stroke.origin, stroke.direction};
    held.length = stroke.depth;
    held.above = stroke.above;
    return;
  }
  const auto held = blades_.find(hand);
  if (held == blades_.end()) return;  // ended by undo or reset
  for (const EdgePose& pose : stroke.way) add_pose(held->second.path, pose);
  add_pose(held->second.path, {stroke.origin, stroke.direction});
  held->second.ends = stroke.phase == Phase::end;
}

geo::Vec3 Session::material_point(const Spot& spot, geo::SurfaceVertexId& nearest) const {
  const geo::Side side = slots_.side(spot.face);
  if (!side.face.valid()) throw BadMessage("there is no such triangle now");
  const geo::Complex& surface = run_.body().surface;
  geo::Vec3 x = geo::Vec3::Zero();
  int most = 0;
  for (int k = 0; k < 3; ++k) {
    // A side is seen from its own side: its corners 1 and 2 are exchanged.
    const int corner = side.which == 1 && k > 0 ? 3 - k : k;
    const auto v = surface.surface_vertex(side, corner);
    x += spot.bary[k] * surface.point(surface.site(v));
    if (k == 0 || spot.bary[k] > spot.bary[most]) {
      most = k;
      nearest = v;
    }
  }
  return x;
}

geo::Vec3 Session::world_point(const Spot& spot) const {
  const geo::Triangle& t = slots_.topology()->triangle.at(spot.face);
  return spot.bary[0] * positions_[t[0]] + spot.bary[1] * positions_[t[1]] + spot.bary[2] * positions_[t[2]];
}

// Stiff enough to lift all bodies by a stretch of a tenth of their size, and about as stiff as the
// material in the neighbourhood that is held.
double Session::pull_stiffness(std::uint32_t node) const {
  const double size = geo::bounding_box(setup_.models.all).diagonal();
  const geo::Material& material = run_.solid().materials().of(node);
  return std::max(2 * material.young * run_.body().nodes.radius[node], 10 * mass_ * gravity().norm() / size);
}

geo::NodeId Session::carrier_of(geo::SurfaceVertexId vertex) const {
  const geo::Binding& binding = run_.body().binding;
  const auto master = binding.master[vertex.index()];
  if (!master.valid()) throw BadMessage("no node carries this point");
  return binding.master_node[master.index()];
}

void Session::begin_grab(const Hand& hand, const Grab& grab) {
  if (pulls_.contains(hand)) throw BadMessage("this grab has begun already");
  require_free_hand();
  if (grab.held) {
    const auto at = holds_.find(*grab.held);
    if (at == holds_.end()) throw BadMessage("there is nothing held by this number");
    pulls_[hand] = at->second;
    pulls_[hand].to = grab.to;
    holds_.erase(at);
    return;
  }
  geo::SurfaceVertexId nearest;
  const geo::Vec3 x = material_point(grab.spot, nearest);
  geo::Pull pull;
  pull.point = x;
  pull.node = carrier_of(nearest).value;
  pull.stiffness = pull_stiffness(*pull.node);
  const std::size_t p = run_.add_pull(std::move(pull));
  run_.extend_pull(p, 0, world_point(grab.spot));
  pulls_[hand] = {.pull = p, .to = grab.to, .nearest = nearest};
}

void Session::obey(ClientId page, const Grab& grab) {
  taken_[page] = grab.input;
  const Hand hand{page, grab.id};
  if (grab.phase == Phase::begin) {
    begin_grab(hand, grab);
    return;
  }
  const auto held = pulls_.find(hand);
  if (held == pulls_.end()) return;
  held->second.to = grab.to;
  held->second.ends = grab.phase == Phase::end;
  if (grab.phase != Phase::hold) return;
  if (holds_.size() >= most_hands) throw BadMessage("as many places are held as can be at a time");
  if (held->second.number == 0) held->second.number = ++last_hold_;
  holds_[held->second.number] = held->second;
  pulls_.erase(held);
}

void Session::obey(const Pin& pin) {
  geo::SurfaceVertexId nearest;
  const geo::Vec3 x = material_point(pin.spot, nearest);
  if (!pin.on) {
    const auto held = std::find_if(pins_.begin(), pins_.end(), [&](const HeldPin& p) {
      return (p.material - x).cwiseAbs().maxCoeff() <= std::max(p.radius, pin.radius);
    });
    if (held == pins_.end()) throw BadMessage("there is no pin here");
    run_.end_grip(held->grip);
    pins_.erase(held);
    return;
  }
  require_space();
  const double radius = pin.radius > 0 ? pin.radius : coarsest_spacing(run_.body());
  geo::Grip grip;
  grip.lo = x - geo::Vec3::Constant(radius);
  grip.hi = x + geo::Vec3::Constant(radius);
  const geo::Vec3& node = run_.body().nodes.position[carrier_of(nearest).index()];
  grip.lo = grip.lo.cwiseMin(node);
  grip.hi = grip.hi.cwiseMax(node);
  pins_.push_back(
      {.grip = run_.add_grip(std::move(grip)), .material = x, .world = world_point(pin.spot), .radius = radius});
}

void Session::obey(const Set& set) {
  if (changes_.size() >= bounds_.changes) throw BadMessage("the recording is full; save it and reset");
  geo::SceneChange change;
  change.young = set.young;
  change.damping = set.damping;
  change.gravity = set.gravity;
  change.friction = set.friction;
  try {
    change_run(change);
  } catch (const geo::InputError& e) {
    throw BadMessage(e.what());
  }
}

Effort Session::effort() const { return {run_.scene().accuracy, run_.scene().steps_per_frame()}; }

Effort Session::least_effort() const {
  constexpr double coarser = 4, coarsest = 0.1;  // than the scene's accuracy; node spacings
  const Effort own{setup_.scene.accuracy, setup_.scene.steps_per_frame()};
  if (!setup_.scene.implicit) return own;
  return {std::max(own.accuracy, std::min(coarser * own.accuracy, coarsest)), setup_.scene.fracture.on ? own.steps : 1};
}

void Session::set_effort(const Effort& effort) {
  if (changes_.size() >= bounds_.changes) return;
  geo::SceneChange change;
  change.accuracy = effort.accuracy;
  change.dt = 1 / run_.scene().frame_rate / effort.steps;
  change_run(change);
}

void Session::change_run(geo::SceneChange change) {
  change.time = run_.state().time;
  run_.change(change);
  changes_.push_back(change);
}

void Session::leave(ClientId page) {
  for (auto& [hand, held] : blades_)
    if (hand.first == page) held.ends = true;
  for (auto& [hand, held] : pulls_)
    if (hand.first == page) held.ends = true;
  taken_.erase(page);
}

void Session::save() {
  const geo::Scene& scene = run_.scene();
  saved_states_.push(sim::checkpoint_bytes(run_.body(), run_.state(), setup_.fingerprint));
  saved_.push_back({.time = run_.state().time,
                    .frame = run_.state().frame,
                    .blades = scene.blades.size(),
                    .grips = scene.grips.size(),
                    .pulls = scene.pulls.size(),
                    .changes = changes_.size(),
                    .hands = in_hands()});
  drop_states();
}

// The oldest states go first. The newest one stays, however large it is.
void Session::drop_states() {
  while (saved_.size() > 1 && (saved_.size() > bounds_.saved || saved_bytes() > bounds_.saved_bytes)) {
    saved_states_.erase(0);
    saved_.erase(saved_.begin());
    dropped_ = true;
  }
  while (!undone_.empty() && saved_bytes() > bounds_.saved_bytes) {
    undone_states_.erase(0);
    undone_states_.erase(0);
    undone_.erase(undone_.begin());
  }
}

std::pair<geo::Scene, Session::Removed> Session::scene_at(const Saved& saved) const {
  geo::Scene scene = setup_.scene;
  Removed removed;
  const geo::Scene& now = run_.scene();
  const auto begin = [](const auto& original) { return original.size(); };
  scene.blades.assign(now.blades.begin(), now.blades.begin() + static_cast<std::ptrdiff_t>(saved.blades));
  scene.grips.assign(now.grips.begin(), now.grips.begin() + static_cast<std::ptrdiff_t>(saved.grips));
  scene.pulls.assign(now.pulls.begin(), now.pulls.begin() + static_cast<std::ptrdiff_t>(saved.pulls));
  const auto is_later = [&](const geo::Motion& motion) {
    return !motion.keys.empty() && motion.keys.back().time > saved.time;
  };
  for (std::size_t b = begin(setup_.scene.blades); b < now.blades.size(); ++b) {
    if (b >= saved.blades || is_later(now.blades[b].motion)) removed.blades[b] = now.blades[b];
    if (b < saved.blades) cut_motion(scene.blades[b].motion, saved.time);
  }
  for (std::size_t p = begin(setup_.scene.pulls); p < now.pulls.size(); ++p) {
    if (p >= saved.pulls || is_later(now.pulls[p].motion)) removed.pulls[p] = now.pulls[p];
    if (p < saved.pulls) cut_motion(scene.pulls[p].motion, saved.time);
  }
  for (std::size_t g = begin(setup_.scene.grips); g < now.grips.size(); ++g) {
    const bool ends_later = std::isfinite(now.grips[g].until) && now.grips[g].until > saved.time;
    if (g >= saved.grips || ends_later) removed.grips[g] = now.grips[g];
    if (g < saved.grips && ends_later) scene.grips[g].until = std::numeric_limits<double>::infinity();
  }
  removed.changes.assign(changes_.begin() + static_cast<std::ptrdiff_t>(saved.changes), changes_.end());
  for (std::size_t c = 0; c < saved.changes; ++c) scene.add_change(changes_[c]);
  return {std::move(scene), std::move(removed)};
}

void Session::resume(const geo::Scene& scene, const std::string& state, int frame, InHands hands) {
  checkpoints_ = std::move(hands.checkpoints);
  pins_ = std::move(hands.pins);
  holds_ = std::move(hands.holds);
  withheld_ = hands.withheld;
  if (frame > 0 && (checkpoints_.empty() || checkpoints_.back() != frame)) checkpoints_.push_back(frame);
  go_on_from(scene, state);
}

void Session::go_on_from(const geo::Scene& scene, const std::string& checkpoint) {
  blades_.clear();
  pulls_.clear();
  slots_.clear();
  // The old run goes first. Otherwise the new one fills the gaps that the old one leaves, and keeps
  // the pages around them.
  { const geo::Simulation ended = std::move(run_); }
  release_free_memory();
  run_ = sim::run_from(scene, checkpoint);
  stats_ = {};
  has_cut_ = false;
  faces_ = run_.body().surface.face_count();
  count_pieces();
}

void Session::restore_last(const std::string& state) {
  const Saved last = std::move(saved_.back());
  saved_.pop_back();
  const geo::Scene scene = scene_at(last).first;
  changes_.resize(last.changes);
  resume(scene, state, last.frame, last.hands);
}

void Session::undo() {
  if (saved_.empty())
    throw BadMessage(dropped_ ? "cuts before these are not kept for undo" : "there is no cut to undo");
  undone_.push_back({.before = saved_.back(),
                     .removed = scene_at(saved_.back()).second,
                     .hands = in_hands(),
                     .frame = run_.state().frame});
  const std::string before = saved_states_.pop();
  undone_states_.push(before);
  undone_states_.push(sim::checkpoint_bytes(run_.body(), run_.state(), setup_.fingerprint));
  restore_last(before);
  drop_states();
}

void Session::redo() {
  if (undone_.empty()) throw BadMessage("there is no cut to make again");
  Undone last = std::move(undone_.back());
  undone_.pop_back();
  geo::Scene scene = scene_at(last.before).first;
  const auto put_back = [](auto& list, auto& removed) {
    for (auto& [index, item] : removed) {
      if (index >= list.size()) list.resize(index + 1);
      list[index] = std::move(item);
    }
  };
  put_back(scene.blades, last.removed.blades);
  put_back(scene.grips, last.removed.grips);
  put_back(scene.pulls, last.removed.pulls);
  changes_.resize(last.before.changes);
  for (const geo::SceneChange& change : last.removed.changes) {
    scene.add_change(change);
    changes_.push_back(change);
  }
  const std::string after = undone_states_.pop();
  saved_states_.push(undone_states_.pop());
  saved_.push_back(std::move(last.before));
  resume(scene, after, last.frame, std::move(last.hands));
}

void Session::withhold_weight() {
  if (withheld_ || run_.scene().gravity.isZero() || changes_.size() >= bounds_.changes) return;
  const geo::Vec3 gravity = run_.scene().gravity;
  change_run({.gravity = geo::Vec3(geo::Vec3::Zero())});
  withheld_ = gravity;
}

void Session::reset() {
  saved_.clear();
  saved_states_.clear();
  undone_.clear();
  undone_states_.clear();
  checkpoints_.clear();
  pins_.clear();
  changes_.clear();
  holds_.clear();
  dropped_ = false;
  withheld_.reset();
  go_on_from(setup_.scene, start_);
}

// Moves an edge along its path, no farther than one cut, so that a frame has a bounded cost. An
// edge that a fast pointer has left behind catches up. In a frame an edge moves straight, so it
// stops where the path bends.
void Session::chase(HeldBlade& held, bool whole) const {
  const double spacing = finest_spacing(run_.body());
  const double most = whole ? std::numeric_limits<double>::infinity() : most_motion * spacing;
  const EdgePose begin = held.now;
  std::size_t passed = 0;
  double gone = 0;
  while (passed < held.path.size() && gone < most) {
    const Advance step = held.above ? follow(held.now, held.path[passed], held.length, *held.above, most - gone)
                                    : approach(held.now, held.path[passed], held.length, most - gone);
    const std::span before(held.path.data(), passed);
    if (!is_straight(begin, before, step.pose, held.length, most_bend * spacing)) break;
    held.now = step.pose;
    gone += step.way;
    if (!step.arrives) break;
    held.path[passed++] = step.pose;
  }
  held.path.erase(held.path.begin(), held.path.begin() + static_cast<std::ptrdiff_t>(passed));
}

// Turns the back of a blade against its motion, little by little: material is beside it.
void Session::turn(HeldBlade& held, const EdgePose& before) const {
  constexpr double least_motion = 0.02, share = 0.3;  // in node spacings; of the turn, in a frame
  const geo::Vec3 motion =
      across(held.now.origin - before.origin + 0.5 * held.length * (held.now.direction - before.direction),
             held.now.direction);
  if (motion.norm() > least_motion * finest_spacing(run_.body())) {
    const geo::Vec3 wanted = -motion.normalized();
    if (held.back == geo::Vec3::Zero())
      held.back = wanted;
    else if (wanted.dot(held.back) > -0.5)  // else the pointer goes back on its way
      held.back += share * (wanted - held.back);
  }
  if (held.back != geo::Vec3::Zero()) held.back = across(held.back, held.now.direction).normalized();
}

void Session::add_blade(HeldBlade& held, const EdgePose& from) {
  save();
  const double coarsest = coarsest_spacing(run_.body());
  geo::Blade blade;
  blade.name = "stroke" + std::to_string(run_.scene().blades.size() + 1);
  const double n = std::clamp(std::ceil(held.length / finest_spacing(run_.body())), 1.0, finest_edge);
  for (int i = 0; i <= static_cast<int>(n); ++i) blade.points.push_back({0, 0, held.length * i / n});
  blade.limit = most_motion;
  blade.back = {blade_width * coarsest, 0, 0};
  blade.thickness = blade_thickness * coarsest;
  held.blade = run_.add_blade(std::move(blade));
  held.faces = run_.body().surface.face_count();
  run_.extend_blade(*held.blade, 0,
                    pose_of(from.origin, from.direction, across(held.back, from.direction).normalized()));
}

void Session::extend_hands(bool whole) {
  for (auto& [hand, held] : blades_) {
    const EdgePose before = held.now;
    chase(held, whole);
    turn(held, before);
    if (held.back == geo::Vec3::Zero()) continue;
    if (!held.blade) add_blade(held, before);
    run_.extend_blade(*held.blade, 1, pose_of(held.now.origin, held.now.direction, held.back));
  }
  const double most = farthest_pull * geo::bounding_box(setup_.models.all).diagonal();
  const auto extend = [&](const HeldPull& held) {
    const geo::Vec3 before = run_.scene().pulls[held.pull].motion.keys.back().position, way = held.to - before;
    // A jump of the pointer is made in several frames.
    run_.extend_pull(held.pull, 1, way.norm() > most ? geo::Vec3(before + most / way.norm() * way) : held.to);
  };
  for (const auto& [hand, held] : pulls_) extend(held);
  for (const auto& [number, held] : holds_) extend(held);
}

// Ends the hands that said so; whether a stroke was among them. A stroke that has cut nothing need
// not be undone.
bool Session::end_hands() {
  const std::size_t before = blades_.size();
  for (auto at = blades_.begin(); at != blades_.end();) {
    // A stroke that has ended goes on until its edge is where it ended.
    const HeldBlade& held = at->second;
    if (!held.ends || !held.path.empty()) {
      ++at;
      continue;
    }
    last_stroke_ = at->first.second;
    if (held.blade && held.faces == run_.body().surface.face_count()) forget_state(*held.blade);
    at = blades_.erase(at);
  }
  std::erase_if(pulls_, [&](const auto& entry) { return entry.second.ends; });
  return blades_.size() != before;
}

void Session::forget_state(std::size_t blade) {
  for (std::size_t s = 0; s < saved_.size(); ++s)
    if (saved_[s].blades == blade) {
      saved_states_.erase(s);
      saved_.erase(saved_.begin() + static_cast<std::ptrdiff_t>(s));
      return;
    }
}

std::size_t Session::end_late_strokes(double seconds, double most) {
  std::size_t late = 0;
  for (auto& [hand, held] : blades_)
    if (held.ends && (held.late += seconds) >= most) {
      held.path.clear();
      ++late;
    }
  if (late > 0) end_hands();
  return late;
}

std::string Session::advance(bool whole) {
  if (withheld_ && blades_.empty()) {
    change_run({.gravity = *withheld_});
    withheld_.reset();
  }
  extend_hands(whole);
  try {
    stats_ = run_.advance_frame();
  } catch (const geo::GeometryError& e) {
    const std::string reason = e.what();
    if (saved_.empty())
      reset();
    else
      restore_last(saved_states_.pop());
    return reason;
  }
  has_cut_ = faces_ != run_.body().surface.face_count();
  faces_ = run_.body().surface.face_count();
  const bool cut_by_hand = std::any_of(blades_.begin(), blades_.end(), [&](const auto& entry) {
    return entry.second.blade && entry.second.faces != faces_;
  });
  if (cut_by_hand) {
    undone_.clear();
    undone_states_.clear();
  }
  const bool ended = end_hands();
  if (faces_ != counted_faces_ && (ended || !has_cut_ || ++since_count_ >= count_interval)) count_pieces();
  return {};
}

geo::Scene Session::recording() const {
  geo::Scene scene = geo::recording_of(setup_.scene, run_);
  scene.checkpoints = checkpoints_;
  return scene;
}

void Session::show(Snapshot& snapshot) {
  slots_.update(run_.body().surface);
  const std::vector<geo::Vec3> surface = run_.state().surface.empty() ? run_.surface().vertices : run_.state().surface;
  const auto& slot = slots_.slot_of_living();
  positions_.assign(slots_.topology()->vertices, surface.empty() ? geo::Vec3(geo::Vec3::Zero()) : surface[0]);
  for (std::size_t i = 0; i < slot.size(); ++i) positions_[slot[i]] = surface[i];
  snapshot.time = run_.state().time;
  snapshot.topology = slots_.topology();
  snapshot.positions = positions_;
  snapshot.node_count = run_.body().nodes.size();
  snapshot.taken = taken_;
}

std::vector<geo::Vec3> Session::pins() const {
  std::vector<geo::Vec3> world;
  for (const HeldPin& pin : pins_) world.push_back(pin.world);
  return world;
}

std::vector<Session::Hold> Session::holds() const {
  std::vector<Hold> holds;
  const geo::Complex& surface = run_.body().surface;
  const auto add = [&](const HeldPull& held) {
    const geo::Pull& pull = run_.scene().pulls[held.pull];
    geo::Vec3 at = pull.point + run_.state().motion.displacement[*pull.node];
    if (const auto slot = slots_.slot(held.nearest); slot && *slot < positions_.size())
      at = positions_[*slot] + pull.point - surface.point(surface.site(held.nearest));
    holds.push_back({held.number, at, held.to});
  };
  for (const auto& [number, held] : holds_) add(held);
  for (const auto& [hand, held] : pulls_)
    if (held.number != 0) add(held);
  return holds;
}

std::vector<std::uint64_t> Session::waiting() const {
  std::vector<std::uint64_t> numbers;
  for (const auto& [hand, held] : blades_) numbers.push_back(hand.second);
  return numbers;
}

std::vector<std::pair<std::vector<geo::Vec3>, double>> Session::edges() const {
  std::vector<std::pair<std::vector<geo::Vec3>, double>> edges;
  const geo::Scene& scene = run_.scene();
  for (std::size_t b = 0; b < scene.blades.size(); ++b)
    if (scene.blades[b].active(run_.state().time))
      edges.push_back(
          {scene.blades[b].at(run_.state().time), b < stats_.blade_force.size() ? stats_.blade_force[b].norm() : 0});
  return edges;
}

}  // namespace live
