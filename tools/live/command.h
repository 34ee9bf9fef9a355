// Requests of a page: text messages of docs/live-protocol.md, read and checked.
#pragma once

#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <kerf/vec.h>

namespace live {

/// A message that is not of the protocol; says what is wrong.
struct BadMessage : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The longest message, in bytes.
constexpr std::size_t longest_message = 4096;

/// `hold` ends the hand's part in a grab, whose spring stays.
enum class Phase { begin, move, end, hold };

/// Confirms that the message with this sequence number was shown.
struct Acknowledge {
  std::uint32_t sequence = 0;
};
/// Data that frames are to hold in addition to the surface. `graph`: once. `rest`: places in the
/// material and colours, with what changes.
struct Want {
  std::optional<bool> nodes, stress, rest;
  bool graph = false;
};
/// Where an edge is: it begins at `origin`, along `direction` (unit).
struct EdgePose {
  geo::Vec3 origin = geo::Vec3::Zero(), direction = geo::Vec3::UnitZ();
};
/// The pose of a hand's edge: from `origin` along `direction` (unit), `depth` long.
struct Stroke {
  std::uint64_t id = 0, input = 0;
  Phase phase = Phase::begin;
  geo::Vec3 origin = geo::Vec3::Zero(), direction = geo::Vec3::UnitZ();
  double depth = 0;
  /// Distance from the origin to the point of the surface that the edge follows; none: it follows
  /// the ray.
  std::optional<double> above = {};
  /// Poses between the message before and this one, in their order.
  std::vector<EdgePose> way = {};
};
/// Appends a pose to the path of an edge. A path of longest_path poses first loses every second
/// one.
void add_pose(std::vector<EdgePose>& path, const EdgePose& pose);
constexpr std::size_t longest_path = 4096;
/// A point of the surface: barycentric coordinates in the face of a slot.
struct Spot {
  std::uint32_t face = 0;
  geo::Vec3 bary = geo::Vec3::Zero();
};
/// A spring from a point of the surface to the pointer.
struct Grab {
  std::uint64_t id = 0, input = 0;
  Phase phase = Phase::begin;
  Spot spot;  ///< read where the grab begins
  geo::Vec3 to = geo::Vec3::Zero();
  std::optional<std::uint64_t> held = {};  ///< where it begins: number of the spring that it takes up again
};
/// Holds, or frees, the material around a point of the surface.
struct Pin {
  Spot spot;
  bool on = true;
  double radius = 0;  ///< model units; 0: as the server finds fit
};
/// A blow that breaks the piece around a point of the surface.
struct Blow {
  Spot spot;
  int cells = 0;  ///< of the pattern: about as many parts, or fewer
};
/// Values of the scene, of the edges to come, and of the skin.
struct Set {
  std::optional<double> young = {}, friction = {}, damping = {};
  std::optional<geo::Vec3> gravity = {};
  std::optional<double> resistance = {};  ///< of the material to edges, J / model unit²
  std::optional<double> dullness = {};    ///< friction of edges: Coulomb's coefficient
  std::optional<double> tension = {};     ///< stretch of the skin, 1: none. The body begins anew
};
/// A body of the gallery, shown in place of the present one.
struct Show {
  std::string name;
};
struct Undo {};
struct Redo {};
struct Reset {};
struct Pause {
  bool on = true;
};
struct Step {};

using Command = std::variant<Acknowledge, Want, Stroke, Grab, Pin, Blow, Set, Show, Undo, Redo, Reset, Pause, Step>;

/// Reads a message. Throws BadMessage where it is longer than longest_message, no JSON, of no known
/// kind, has unknown or missing keys, or values out of range. Throws nothing else.
Command read_command(std::string_view text);

}  // namespace live
