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
#include "live/history.h"
#include "live/pace.h"
#include "live/snapshot.h"
#include "sim/setup.h"

namespace live {

/// The scene without its own blades, where `blades` is false; at least `rate` frames a second.
void adapt_scene(geo::Scene& scene, double rate, bool blades);

/// Bounds on what a session keeps.
struct SessionBounds {
  std::size_t saved = 64;                 ///< states that undo can go back to
  std::size_t saved_bytes = 250'000'000;  ///< of all states of undo and redo; one state may have more
  std::size_t recorded = 4096;            ///< blades, springs and pins of the recording
  std::size_t keys = 1 << 20;             ///< of their motions, when one more begins; a key is a frame of one of them
  std::size_t changes = 1 << 16;          ///< of values, by hands and by effort
};

class Session {
 public:
  /// A new run. The scene is as adapt_scene() leaves it. Throws as begin_run().
  Session(const sim::Setup& setup, const geo::Progress& progress, const SessionBounds& bounds = {});

  /// Obeys a command of a page, between two frames. Throws BadMessage where it cannot be obeyed, or
  /// where the recording is full.
  void obey(ClientId page, const Stroke& stroke);
  void obey(ClientId page, const Grab& grab);
  void obey(const Pin& pin);
  void obey(const Set& set);
  /// Goes back to before the last stroke that has cut. Throws BadMessage without one.
  void undo();
  /// Goes to where the last undo left. Throws BadMessage without one, or after a new cut.
  void redo();
  /// Weight acts from when no stroke is in the body, but not yet: a body at rest without weight
  /// does not sag under the knife that cuts it first.
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
  /// Fills positions, topology and inputs taken.
  void show(Snapshot& snapshot);
  /// Number of strokes that can be undone, and of those that can be made again.
  std::size_t strokes() const { return saved_.size(); }
  std::size_t undone() const { return undone_.size(); }
  /// Bytes of the states that these go to.
  std::size_t saved_bytes() const { return saved_states_.bytes() + undone_states_.bytes(); }
  /// Numbers of the strokes whose edges are not yet where the pointer is or was.
  std::vector<std::uint64_t> waiting() const;
  /// Number of the last stroke that ended.
  std::uint64_t last_stroke() const { return last_stroke_; }
  /// Crack steps refused since the run began.
  std::size_t refused() const { return run_.state().total.refused; }
  /// Number of pieces without specks; counted now and then while a blade cuts.
  std::uint32_t pieces() const { return pieces_; }
  /// World positions of pins that hold.
  std::vector<geo::Vec3> pins() const;
  /// A spring that stays: its number, and its ends in the world, as of the last show().
  struct Hold {
    std::uint64_t number;
    geo::Vec3 at, to;
  };
  /// All springs that stay.
  std::vector<Hold> holds() const;
  /// Whether weight is withheld.
  bool is_weightless() const { return withheld_.has_value(); }
  /// Gravity, also while it is withheld.
  geo::Vec3 gravity() const { return withheld_ ? *withheld_ : run_.scene().gravity; }
  /// World positions of the edges of blades that exist, each with the force on it, N.
  std::vector<std::pair<std::vector<geo::Vec3>, double>> edges() const;

 private:
  using Hand = std::pair<ClientId, std::uint64_t>;  // a page and the number of its stroke
  struct HeldBlade {
    EdgePose now;
    std::vector<EdgePose> path;  // poses that the edge has still to pass; the last one is the pointer's
    double length = 0;
    std::optional<double> above;         // of an edge that follows the surface: from its origin to there
    geo::Vec3 back = geo::Vec3::Zero();  // unit, from the edge against its motion; zero before it has moved
    std::optional<std::size_t> blade;    // added to the run when it moves first
    std::uint32_t faces = 0;             // of the complex, when the blade was added
    bool ends = false;
    double late = 0;  // s since it was released
  };
  struct HeldPull {
    std::size_t pull;
    geo::Vec3 to;
    geo::SurfaceVertexId nearest;  // to the point of the material that is held
    std::uint64_t number = 0;      // of a spring that stays, while a hand has it, too
    bool ends = false;
  };
  struct HeldPin {
    std::size_t grip;
    geo::Vec3 material, world;
    double radius;
  };
  // All that hands have in a run.
  struct InHands {
    std::vector<int> checkpoints;
    std::vector<HeldPin> pins;
    std::map<std::uint64_t, HeldPull> holds;
    std::optional<geo::Vec3> withheld;
  };
  // A run as it was before a stroke, with the numbers of all that was added up to then. Its body
  // and motion are in the stack of states.
  struct Saved {
    double time;
    int frame;
    std::size_t blades, grips, pulls, changes;  // of the run; changes: by hands and effort
    InHands hands;
  };
  // The parts of a scene that are not yet there in a saved state: by index, all that was added or
  // has changed since; and the changes of values after the saved ones.
  struct Removed {
    std::map<std::size_t, geo::Blade> blades;
    std::map<std::size_t, geo::Grip> grips;
    std::map<std::size_t, geo::Pull> pulls;
    std::vector<geo::SceneChange> changes;
  };
  // A stroke that was undone. Two states belong to it: the one before it, and the run before undo.
  struct Undone {
    Saved before;
    Removed removed;
    InHands hands;
    int frame;
  };

  void save();
  void drop_states();
  InHands in_hands() const {
    return {.checkpoints = checkpoints_, .pins = pins_, .holds = holds_, .withheld = withheld_};
  }
  // The scene with what was there at a saved state, and what was removed from it.
  std::pair<geo::Scene, Removed> scene_at(const Saved& saved) const;
  // Continues with a scene from a state.
  void resume(const geo::Scene& scene, const std::string& state, int frame, InHands hands);
  // Goes to the last saved stroke, whose state is given.
  void restore_last(const std::string& state);
  // Changes values of the run. Throws InputError for values that a scene may not have.
  void change_run(geo::SceneChange change);
  // Continues as `scene` from a checkpoint, without hands.
  void go_on_from(const geo::Scene& scene, const std::string& checkpoint);
  void begin_grab(const Hand& hand, const Grab& grab);
  void require_space() const;
  void require_free_hand() const;
  void extend_hands(bool whole);
  void chase(HeldBlade& held, bool whole) const;
  void turn(HeldBlade& held, const EdgePose& before) const;
  void add_blade(HeldBlade& held, const EdgePose& from);
  bool end_hands();
  // Removes the state that was saved before this blade.
  void forget_state(std::size_t blade);
  void count_pieces();
  geo::Vec3 material_point(const Spot& spot, geo::SurfaceVertexId& nearest) const;
  geo::NodeId carrier_of(geo::SurfaceVertexId vertex) const;
  geo::Vec3 world_point(const Spot& spot) const;
  double pull_stiffness(std::uint32_t node) const;

  sim::Setup setup_;
  SessionBounds bounds_;
  std::string start_;  // checkpoint of frame 0
  geo::Simulation run_;
  double mass_ = 0;
  geo::FrameStats stats_;
  bool has_cut_ = false;
  std::uint32_t pieces_ = 1, counted_faces_ = 0, faces_ = 0;
  int since_count_ = 0;
  Slots slots_;
  std::vector<geo::Vec3> positions_;  // per vertex slot, of the last show()
  std::map<Hand, HeldBlade> blades_;
  std::map<Hand, HeldPull> pulls_;
  std::vector<HeldPin> pins_;
  std::map<ClientId, std::uint64_t> taken_;
  std::vector<geo::SceneChange> changes_;  // by hands and effort
  StateStack saved_states_, undone_states_;
  std::vector<Saved> saved_;
  std::vector<Undone> undone_;
  bool dropped_ = false;                     // states that undo could have gone back to
  std::map<std::uint64_t, HeldPull> holds_;  // springs that stay, by their numbers
  std::uint64_t last_hold_ = 0;
  std::optional<geo::Vec3> withheld_;  // gravity that does not act yet
  std::vector<int> checkpoints_;       // frames from which the run went on from its own checkpoint
  std::uint64_t last_stroke_ = 0;
};

}  // namespace live
