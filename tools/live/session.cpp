// Commands go to the hands; what hands did is recorded in the run's own scene. A run that went back
// goes on from the checkpoint of that frame, as it would be read from a file.
#include "live/session.h"

#include <algorithm>
#include <utility>

#include <kerf/error.h>
#include "live/memory.h"
#include "sim/start.h"

namespace live {

namespace {

constexpr double rest_before_sleep = 1;  // s: what swings slowly has moved on by then
constexpr double hold_damping = 30;  // 1/s: an apple that a knife takes 5 s to cut moves by 0.02 of its size, not 0.25

}  // namespace

void adapt_scene(geo::Scene& scene, double rate, bool blades) {
  scene.frame_rate = rate;
  scene.dt = std::min(scene.dt, 1 / rate);
  scene.checkpoint_every = 1000000;
  if (scene.sleep == 0) scene.sleep = rest_before_sleep;
  if (!blades) scene.blades.clear();
}

Session::Session(const sim::Setup& setup, const geo::Progress& progress, const SessionBounds& bounds)
    : setup_(setup),
      loaded_(setup.scene.loaded),
      bounds_(bounds),
      start_(sim::first_checkpoint(setup, progress)),
      run_(sim::run_from(setup.scene, start_)),
      view_(Painter(setup.models.all, setup.materials)),
      hands_(run_, view_, geo::bounding_box(setup.models.all).diagonal()),
      history_(bounds.undo),
      faces_(run_.body().surface.face_count()) {
  pieces_.count(run_.body().surface);
}

void Session::require_space() const {
  const geo::Scene& scene = run_.scene();
  std::size_t keys = 0;
  for (const geo::Blade& b : scene.blades) keys += b.motion.keys.size();
  for (const geo::Pull& p : scene.pulls) keys += p.motion.keys.size();
  if (scene.blades.size() + scene.grips.size() + scene.pulls.size() >= bounds_.recorded || keys >= bounds_.keys)
    throw BadMessage("the recording is full; save it and reset");
}

void Session::obey(ClientId page, const Stroke& stroke) {
  taken_[page] = stroke.input;
  if (stroke.phase == Phase::begin) require_space();
  hands_.obey(page, stroke);
}

void Session::obey(ClientId page, const Grab& grab) {
  taken_[page] = grab.input;
  if (grab.phase == Phase::begin) require_space();
  hands_.obey(page, grab, gravity());
}

void Session::obey(const Pin& pin) {
  if (pin.on) require_space();
  hands_.obey(pin);
}

void Session::tighten(double stretch) {
  sim::Setup tight = setup_;
  const std::vector<double>& spacing = run_.body().nodes.spacing;
  const double depth = *std::max_element(spacing.begin(), spacing.end());
  const auto set = [&](geo::Prestretch& p) {
    p.skin = stretch;
    if (p.depth == 0) p.depth = depth;
  };
  set(tight.scene.prestretch);
  for (geo::SceneBody& body : tight.scene.bodies)
    if (body.prestretch) set(*body.prestretch);
  tight.scene.loaded = loaded_ || stretch > 1;
  try {
    start_ = sim::first_checkpoint(tight, {});
  } catch (const geo::InputError& e) {
    throw BadMessage(e.what());
  }
  setup_ = std::move(tight);
  reset();
}

void Session::obey(const Set& set) {
  EdgeKind edges = hands_.edges();
  edges.resistance = set.resistance.value_or(edges.resistance);
  edges.friction = set.dullness.value_or(edges.friction);
  hands_.set_edges(edges);
  if (set.tension) tighten(*set.tension);
  if (!set.young && !set.damping && !set.gravity && !set.friction) return;
  if (changes_.size() >= bounds_.changes) throw BadMessage("the recording is full; save it and reset");
  geo::SceneChange change;
  change.young = set.young;
  change.friction = set.friction;
  if (withheld_) {  // they act with the weight
    withheld_->gravity = set.gravity.value_or(withheld_->gravity);
    withheld_->damping = set.damping.value_or(withheld_->damping);
  } else {
    change.damping = set.damping;
    change.gravity = set.gravity;
  }
  if (!change.young && !change.friction && !change.damping && !change.gravity) return;
  try {
    change_run(change);
  } catch (const geo::InputError& e) {
    throw BadMessage(e.what());
  }
}

void Session::obey(const Blow& blow) {
  if (hands_.has_strokes()) throw BadMessage("a stroke is in the body: break it when the stroke is over");
  view_.pick(run_.body().surface, blow.spot);  // a triangle that is there
  const geo::Blow hit{.time = run_.state().time, .point = view_.world_point(blow.spot), .cells = blow.cells};
  std::string before = state_bytes();
  try {
    run_.strike(hit);
  } catch (const geo::GeometryError& e) {
    throw BadMessage(e.what());
  } catch (const geo::InputError& e) {
    throw BadMessage(e.what());
  }
  history_.forget_undone();
  history_.add({.mark = scene().mark(run_.state()), .beside = beside()}, std::move(before));
  Beside now = beside();
  now.blows.push_back(hit);
  // Frame 0: the recording needs no checkpoint here, since a run goes on from a blow as from one.
  resume(scene().at(scene().mark(run_.state())), state_bytes(), 0, std::move(now));
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
  hands_.leave(page);
  taken_.erase(page);
}

std::string Session::state_bytes() const {
  return sim::checkpoint_bytes(run_.body(), run_.state(), setup_.fingerprint);
}

void Session::resume(const geo::Scene& scene, const std::string& checkpoint, int frame, Beside beside) {
  checkpoints_ = std::move(beside.checkpoints);
  withheld_ = beside.withheld;
  blows_ = std::move(beside.blows);
  if (frame > 0 && (checkpoints_.empty() || checkpoints_.back() != frame)) checkpoints_.push_back(frame);
  hands_.begin_anew(std::move(beside.lasting));
  view_.clear();
  stress_.clear();
  // The old run goes first. Otherwise the new one fills the gaps that the old one leaves, and keeps
  // the pages around them.
  { const geo::Simulation ended = std::move(run_); }
  release_free_memory();
  run_ = sim::run_from(scene, checkpoint);
  stats_ = {};
  has_cut_ = false;
  faces_ = run_.body().surface.face_count();
  pieces_.count(run_.body().surface);
}

void Session::return_to(const BeforeStroke& before, const std::string& state) {
  const geo::Scene earlier = scene().at(before.mark);
  changes_.resize(before.mark.changes);
  resume(earlier, state, before.mark.frame, before.beside);
}

void Session::undo() {
  if (history_.strokes() == 0)
    throw BadMessage(history_.has_dropped() ? "cuts before these are not kept for undo" : "there is no cut to undo");
  const BeforeStroke& last = history_.last();
  UndoneStroke undone{
      .before = last, .rest = scene().after(last.mark), .beside = beside(), .frame = run_.state().frame};
  const auto [before, state] = history_.undo(std::move(undone), state_bytes());
  return_to(before, state);
}

void Session::redo() {
  if (history_.undone() == 0) throw BadMessage("there is no cut to make again");
  auto [undone, state] = history_.redo();
  const geo::Scene later = scene().at(undone.before.mark, undone.rest);
  changes_.resize(undone.before.mark.changes);
  changes_.insert(changes_.end(), undone.rest.changes.begin(), undone.rest.changes.end());
  resume(later, state, undone.frame, std::move(undone.beside));
}

void Session::withhold_weight() {
  if (withheld_ || setup_.scene.loaded || run_.scene().gravity.isZero() || changes_.size() >= bounds_.changes) return;
  const geo::Scene& scene = run_.scene();
  const Withheld values{scene.gravity, scene.material.damping};
  change_run({.damping = std::max(values.damping, hold_damping), .gravity = geo::Vec3(geo::Vec3::Zero())});
  withheld_ = values;
}

void Session::give_weight() {
  change_run({.damping = withheld_->damping, .gravity = withheld_->gravity});
  withheld_.reset();
}

void Session::reset() {
  history_.clear();
  changes_.clear();
  resume(setup_.scene, start_, 0, {});
}

// Ends the hands that said so; whether a stroke was among them.
bool Session::end_hands() {
  const auto ended = hands_.end();
  if (!ended) return false;
  for (const std::size_t blade : *ended) history_.forget(blade);
  return true;
}

std::size_t Session::end_late_strokes(double seconds, double most) {
  const std::size_t late = hands_.stop_late(seconds, most);
  if (late > 0) end_hands();
  return late;
}

std::string Session::advance(bool whole) {
  if (withheld_ && !hands_.has_strokes()) give_weight();
  bool saved = false;  // strokes that begin in one frame are one step of undo
  const auto save = [&] {
    if (saved)
      history_.join();
    else
      history_.add({.mark = scene().mark(run_.state()), .beside = beside()}, state_bytes());
    saved = true;
  };
  hands_.move_on(whole, save);
  try {
    stats_ = run_.advance_frame();
  } catch (const geo::GeometryError& e) {
    const std::string reason = e.what();
    if (history_.strokes() == 0) {
      reset();
    } else {
      const auto [before, state] = history_.take_back();
      return_to(before, state);
    }
    return reason;
  }
  const std::uint32_t faces = run_.body().surface.face_count();
  has_cut_ = faces_ != faces;
  faces_ = faces;
  if (hands_.has_cut(faces)) history_.forget_undone();
  const bool ended = end_hands();
  pieces_.follow(run_.body().surface, ended || !has_cut_);
  return {};
}

geo::Scene Session::recording() const {
  geo::Scene scene = geo::recording_of(setup_.scene, run_);
  scene.checkpoints = checkpoints_;
  if (!blows_.empty() && blows_.back().time >= run_.state().time)
    scene.frames = run_.state().frame + 1;  // that shows it
  scene.blows.insert(scene.blows.end(), blows_.begin(), blows_.end());
  std::stable_sort(scene.blows.begin(), scene.blows.end(),
                   [](const auto& a, const auto& b) { return a.time < b.time; });
  return scene;
}

void Session::show(Snapshot& snapshot, bool stress) {
  view_.update(run_);
  view_.show(snapshot);
  snapshot.time = run_.state().time;
  snapshot.node_count = run_.body().nodes.size();
  snapshot.taken = taken_;
  if (!stress) return;
  snapshot.stress = geo::von_mises_stress(run_.solid(), run_.body().nodes, run_.state().motion);
  snapshot.skin_stress = stress_.at_vertices(run_, snapshot.stress, view_);
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
