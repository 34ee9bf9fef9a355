// The hands in a run: strokes that cut, grabs that pull, pins and springs that stay.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include <kerf/simulation.h>
#include "live/command.h"
#include "live/moving_edge.h"
#include "live/surface_view.h"

namespace live {

/// A spring that stays: its number, and its ends in the world.
struct Hold {
  std::uint64_t number;
  geo::Vec3 at, to;
};

/// A spring of a run, with or without a hand.
struct HeldPull {
  std::size_t pull;
  geo::Vec3 to;
  geo::SurfaceVertexId nearest;  ///< to the point of the material that is held
  std::uint64_t number = 0;      ///< of a spring that stays, while a hand has it, too
  bool ends = false;
};

/// A pin of a run.
struct HeldPin {
  std::size_t grip;
  geo::Vec3 material, world;
  double radius;
};

/// Pins and springs of a run, which stay without a hand.
struct Lasting {
  std::vector<HeldPin> pins;
  std::map<std::uint64_t, HeldPull> springs;  ///< by their numbers
};

/// How hard it is to cut.
struct EdgeKind {
  double resistance = 0;  ///< of the material, J / model unit²
  double friction = 0;    ///< of the flanks, Coulomb's coefficient
};

/// Turns the commands of pages into blades, pulls and grips of a run, to which it refers.
class Hands {
 public:
  /// `view`: what pages see of the run; `size`: diagonal of all bodies at the beginning.
  Hands(geo::Simulation& run, const SurfaceView& view, double size);

  /// Obeys a command of a page, between two frames. Throws BadMessage where it cannot be obeyed.
  void obey(ClientId page, const Stroke& stroke);
  /// Likewise. `gravity`: what springs must bear.
  void obey(ClientId page, const Grab& grab, const geo::Vec3& gravity);
  /// Likewise.
  void obey(const Pin& pin);
  /// Properties of the edges of strokes that begin to cut from now on.
  void set_edges(const EdgeKind& kind) { edges_ = kind; }
  const EdgeKind& edges() const { return edges_; }
  /// Ends all strokes and grabs of a page. Springs that stay belong to no page.
  void leave(ClientId page);
  /// Lets all go, in a run that has begun anew or has gone back; `lasting` is what it has.
  void begin_anew(Lasting lasting);

  /// Moves edges and springs on to the end of the next frame; `whole`: see Session::advance().
  /// `before_cut` is called before a blade is added.
  void move_on(bool whole, const std::function<void()>& before_cut);
  /// Ends the hands that said so, after a frame. The blades of strokes that have ended without a
  /// cut; nothing where no stroke has ended.
  std::optional<std::vector<std::size_t>> end();
  /// Lets strokes end where their edges are, if they were released `most` seconds ago or earlier,
  /// and returns their number; end() ends them. `seconds`: simulated in the last frame.
  std::size_t stop_late(double seconds, double most);

  /// Whether a stroke is under way.
  bool has_strokes() const { return !strokes_.empty(); }
  /// Whether a stroke has cut, where the complex now has this number of faces.
  bool has_cut(std::uint32_t faces) const;
  /// Pins and springs.
  const Lasting& lasting() const { return lasting_; }
  /// World positions of pins that hold.
  std::vector<geo::Vec3> pins() const;
  /// All springs that stay, as of the last update of the view.
  std::vector<Hold> holds() const;
  /// Numbers of the strokes whose edges are not yet where the pointer is or was.
  std::vector<std::uint64_t> waiting() const;
  /// Number of the last stroke that ended.
  std::uint64_t last_stroke() const { return last_stroke_; }

 private:
  using Hand = std::pair<ClientId, std::uint64_t>;  // a page and the number of its stroke
  struct HeldBlade {
    explicit HeldBlade(const Stroke& stroke) : edge(stroke) {}
    MovingEdge edge;
    std::optional<std::size_t> blade;  // added to the run when the edge moves first
    std::uint32_t faces = 0;           // of the complex, when the blade was added
    bool ends = false;
    double late = 0;  // s since it was released
  };

  void require_free_hand() const;
  void begin_grab(const Hand& hand, const Grab& grab, const geo::Vec3& gravity);
  void add_blade(HeldBlade& held, const EdgePose& from);
  void move_on(const HeldPull& held);
  geo::NodeId carrier_of(geo::SurfaceVertexId vertex) const;
  double pull_stiffness(std::uint32_t node, const geo::Vec3& gravity) const;

  geo::Simulation& run_;
  const SurfaceView& view_;
  double size_, mass_ = 0;  // of all bodies; model units, kg
  std::map<Hand, HeldBlade> strokes_;
  std::map<Hand, HeldPull> grabs_;
  Lasting lasting_;
  EdgeKind edges_;
  std::uint64_t last_spring_ = 0, last_stroke_ = 0;
};

}  // namespace live
