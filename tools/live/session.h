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
#include "live/pace.h"
#include "live/snapshot.h"
#include "sim/setup.h"

namespace live {

/// The scene without its own blades, where `blades` is false; at least `rate` frames a second.
void adapt_scene(geo::Scene& scene, double rate, bool blades);

class Session {
 public:
  /// A new run. The scene is as adapt_scene() leaves it. Throws as begin_run().
  Session(const sim::Setup& setup, const geo::Progress& progress);

  /// Obeys a command of a page, between two frames. Throws BadMessage where it cannot be obeyed.
  void obey(ClientId page, const Stroke& stroke);
  void obey(ClientId page, const Grab& grab);
  void obey(const Pin& pin);
  void obey(const Set& set);
  /// Goes back to before the last stroke that has cut. Throws BadMessage without one.
  void undo();
  /// Begins anew.
  void reset();
  /// Ends all that a page holds.
  void leave(ClientId page);
  /// Accuracy and steps of the frames to come.
  Effort effort() const;
  /// Bound of effort where frames take too long: accuracy four times as coarse, at most 0.1, and
  /// one step a frame. Explicit steps keep theirs. So do steps in which material cracks by stress:
  /// longer ones start fewer cracks.
  Effort least_effort() const;
  /// Sets them, recorded as a change.
  void set_effort(const Effort& effort);

  /// Computes the next frame. Where it cannot be computed, the run goes back to before the last
  /// stroke, or begins anew; the result is then the reason, else empty.
  /// `whole`: edges move all the way to the pointer, however long the frame then takes.
  std::string advance(bool whole = false);

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
  /// Number of strokes that can be undone.
  std::size_t strokes() const { return saved_.size(); }
  /// Number of the last stroke that ended.
  std::uint64_t last_stroke() const { return last_stroke_; }
  /// Crack steps refused since the run began.
  std::size_t refused() const { return run_.state().total.refused; }
  /// Number of pieces without specks; counted now and then while a blade cuts.
  std::uint32_t pieces() const { return pieces_; }
  /// World positions of pins that hold.
  std::vector<geo::Vec3> pins() const;
  /// World positions of the edges of blades that exist, each with the force on it, N.
  std::vector<std::pair<std::vector<geo::Vec3>, double>> edges() const;

 private:
  using Hand = std::pair<ClientId, std::uint64_t>;  // a page and the number of its stroke
  struct Edge {
    geo::Vec3 origin, direction;  // unit
  };
  struct HeldBlade {
    Edge now, target;  // where the edge is, and where the pointer is
    double length = 0;
    std::optional<double> above;         // of an edge that follows the surface: from its origin to there
    geo::Vec3 back = geo::Vec3::Zero();  // unit, from the edge against its motion; zero before it has moved
    std::optional<std::size_t> blade;    // added to the run when it moves first
    std::uint32_t faces = 0;             // of the complex, when the blade was added
    bool ends = false;
  };
  struct HeldPull {
    std::size_t pull;
    geo::Vec3 to;
    bool ends = false;
  };
  struct HeldPin {
    std::size_t grip;
    geo::Vec3 material, world;
    double radius;
  };
  // A run as it was before a stroke, with the numbers of all that was added up to then.
  struct Saved {
    geo::Body body;
    geo::RunState state;
    std::size_t blades, grips, pulls, changes;
    std::vector<int> checkpoints;
    std::vector<HeldPin> pins;
  };

  void save();
  void restore(Saved saved);
  // Continues as `scene` from a checkpoint, without hands.
  void go_on_from(const geo::Scene& scene, const std::string& checkpoint);
  void require_free_hand() const;
  void extend_hands(bool whole);
  void chase(HeldBlade& held, bool whole) const;
  static void follow(HeldBlade& held, double most);
  void turn(HeldBlade& held, const Edge& before) const;
  void add_blade(HeldBlade& held, const Edge& from);
  bool end_hands();
  void count_pieces();
  geo::Vec3 material_point(const Spot& spot, geo::SurfaceVertexId& nearest) const;
  geo::Vec3 world_point(const Spot& spot) const;
  double pull_stiffness(std::uint32_t node) const;

  sim::Setup setup_;
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
  std::vector<Saved> saved_;
  std::vector<int> checkpoints_;  // frames from which the run went on from its own checkpoint
  std::uint64_t last_stroke_ = 0;
};

}  // namespace live
