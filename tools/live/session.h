// A run that hands act on: commands become blades, springs, grips and changes of its scene, and all
// of it is the recording.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <kerf/simulation.h>
#include "live/command.h"
#include "live/hands.h"
#include "live/pace.h"
#include "live/piece_count.h"
#include "live/scene_mark.h"
#include "live/snapshot.h"
#include "live/surface_stress.h"
#include "live/surface_view.h"
#include "live/undo.h"
#include "sim/setup.h"

namespace live {

/// The scene without its own blades, where `blades` is false; at least `rate` frames a second.
void adapt_scene(geo::Scene& scene, double rate, bool blades);

/// Bounds on what a session keeps.
struct SessionBounds {
  UndoBounds undo = {};           ///< states of strokes
  std::size_t recorded = 4096;    ///< blades, springs and pins of the recording
  std::size_t keys = 1 << 20;     ///< of their motions, when one more begins; a key is a frame of one of them
  std::size_t changes = 1 << 16;  ///< of values, by hands and by effort
};

class Session {
 public:
  /// A new run. The scene is as adapt_scene() leaves it. Throws as begin_run().
  Session(const sim::Setup& setup, const geo::Progress& progress, const SessionBounds& bounds = {});
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Obeys a command of a page, between two frames. Throws BadMessage where it cannot be obeyed, or
  /// where the recording is full.
  void obey(ClientId page, const Stroke& stroke);
  void obey(ClientId page, const Grab& grab);
  void obey(const Pin& pin);
  void obey(const Set& set);
  /// Begins anew with a skin that is stretched by this factor, 1: not at all, in a layer as deep as
  /// the nodes are apart. The body keeps its shape until it is cut. Throws BadMessage where it
  /// finds no rest.
  void tighten(double stretch);
  /// Likewise. It counts as a stroke that has cut.
  void obey(const Blow& blow);
  /// Goes back to before the last stroke that has cut. Throws BadMessage without one.
  void undo();
  /// Goes to where the last undo left. Throws BadMessage without one, or after a new cut.
  void redo();
  /// Weight acts from when no stroke is in the body, but not yet: a body at rest without weight
  /// does not sag under the knife that cuts it first. Without weight no friction of the ground
  /// holds it. A drag does, so a slow knife does not push it along. A body that rests in its weight
  /// keeps it.
  void withhold_weight();
  /// Begins anew.
  void reset();
  /// Ends all strokes and grabs of a page. Springs that stay belong to no page.
  void leave(ClientId page);
  /// Accuracy and steps of the frames to come.
  Effort effort() const;
  /// Bound of effort where frames take too long: accuracy four times as coarse, at most 0.1, and
  /// one step a frame. Explicit steps keep theirs. So do steps in which material cracks by stress:
  /// longer ones start fewer cracks.
  Effort least_effort() const;
  /// Sets them, recorded as a change. Does nothing where the recording has no space for one.
  void set_effort(const Effort& effort);

  /// Computes the next frame. Where it cannot be computed, the run goes back to before the last
  /// stroke, or begins anew; the result is then the reason, else empty.
  /// `whole`: edges move as far as their path is straight, however long the frame then takes.
  std::string advance(bool whole = false);

  /// Ends strokes where their edges are, if they were released `most` seconds ago or earlier, and
  /// returns their number. `seconds`: simulated in the last frame. So an edge far behind its
  /// pointer does not cut long after the hand has moved, and a slow machine has the time it needs.
  std::size_t end_late_strokes(double seconds, double most);

  /// Statistics of the last frame.
  const geo::FrameStats& stats() const { return stats_; }
  /// Whether the last frame has cut.
  bool has_cut() const { return has_cut_; }
  const geo::Simulation& run() const { return run_; }
  /// The values that the run began with.
  const geo::Scene& original() const { return setup_.scene; }
  /// The scene that gives this run, with everything that hands did.
  geo::Scene recording() const;
  /// Fills positions, topology, colours and inputs taken; stress of nodes and skin where asked for.
  void show(Snapshot& snapshot, bool stress = false);
  /// The models and their materials.
  const sim::Setup& setup() const { return setup_; }
  /// The hands in the run.
  const Hands& hands() const { return hands_; }
  /// The strokes that can be undone and made again.
  const StrokeHistory& history() const { return history_; }
  /// Crack steps refused since the run began.
  std::size_t refused() const { return run_.state().total.refused; }
  /// Number of pieces without specks; counted now and then while a blade cuts.
  std::uint32_t pieces() const { return pieces_.pieces(); }
  /// Whether weight is withheld.
  bool is_weightless() const { return withheld_.has_value(); }
  /// Gravity, also while it is withheld.
  geo::Vec3 gravity() const { return withheld_ ? withheld_->gravity : run_.scene().gravity; }
  /// Damping of the material, 1/s, likewise.
  double damping() const { return withheld_ ? withheld_->damping : run_.scene().material.damping; }
  /// Blows in the body as it is now.
  int blows() const { return static_cast<int>(blows_.size()); }
  /// World positions of the edges of blades that exist, each with the force on it, N.
  std::vector<std::pair<std::vector<geo::Vec3>, double>> edges() const;

 private:
  void require_space() const;
  HandMadeScene scene() const { return {setup_.scene, run_.scene(), changes_}; }
  Beside beside() const {
    return {.lasting = hands_.lasting(), .checkpoints = checkpoints_, .withheld = withheld_, .blows = blows_};
  }
  std::string state_bytes() const;
  // Weight acts, and the drag that held the body ends.
  void give_weight();
  // Changes values of the run. Throws InputError for values that a scene may not have.
  void change_run(geo::SceneChange change);
  // Goes to a state before a stroke.
  void return_to(const BeforeStroke& before, const std::string& state);
  // Continues with a scene from a checkpoint.
  void resume(const geo::Scene& scene, const std::string& checkpoint, int frame, Beside beside);
  bool end_hands();

  sim::Setup setup_;
  bool loaded_;  // whether the scene says so by itself
  SessionBounds bounds_;
  std::string start_;  // checkpoint of frame 0
  geo::Simulation run_;
  SurfaceView view_;
  SurfaceStress stress_;
  Hands hands_;
  StrokeHistory history_;
  PieceCount pieces_;
  geo::FrameStats stats_;
  bool has_cut_ = false;
  std::uint32_t faces_ = 0;  // of the complex
  std::map<ClientId, std::uint64_t> taken_;
  std::vector<geo::SceneChange> changes_;  // by hands and effort
  std::optional<Withheld> withheld_;       // what does not act yet
  std::vector<geo::Blow> blows_;           // by hands, in the body as it is now
  std::vector<int> checkpoints_;           // frames from which the run went on from its own checkpoint
};

}  // namespace live
