// Frames list the first nodes of the checkpoint; younger nodes are at rest there. A piece of the
// checkpoint is assigned by a vote of up to 64 of its nodes for the nearest piece of the frame.
#include "view/moving_nodes.h"

#include <algorithm>
#include <map>

#include <kerf/files.h>
#include <kerf/mesh.h>
#include "view/pieces.h"

namespace view {
namespace {

// Pieces only ever separate, so a piece of the checkpoint is part of one piece of each frame: the
// one whose surface is nearest to most of its nodes. `own`: per node, its piece in the checkpoint.
std::vector<std::uint32_t> containing_pieces(const geo::TriangleMesh& surface, const std::vector<std::uint32_t>& own,
                                             const MovingNodes::Frame& frame) {
  constexpr std::size_t sampled = 64;  // nodes of each piece
  const PieceMap pieces = pieces_of(surface);
  const std::uint32_t count = own.empty() ? 0 : *std::max_element(own.begin(), own.end()) + 1;
  std::vector<std::uint32_t> containing(count, 0);
  if (pieces.center.size() < 2) return containing;
  std::vector<std::vector<std::uint32_t>> nodes(count);
  for (std::uint32_t i = 0; i < frame.count; ++i) nodes[own[i]].push_back(i);
  std::vector<geo::Vec3> points;
  std::vector<std::uint32_t> piece_of_point;
  for (std::uint32_t p = 0; p < count; ++p)
    for (std::size_t k = 0; k < nodes[p].size(); k += nodes[p].size() / sampled + 1) {
      points.push_back(frame.position[nodes[p][k]]);
      piece_of_point.push_back(p);
    }
  const auto nearest = geo::nearest_triangles(surface, points);
  std::vector<std::map<std::uint32_t, std::size_t>> votes(count);
  for (std::size_t k = 0; k < points.size(); ++k)
    ++votes[piece_of_point[k]][pieces.of_row[surface.triangles[nearest[k]][0]]];
  for (std::uint32_t p = 0; p < count; ++p) {
    std::size_t most = 0;
    for (const auto& [piece, times] : votes[p])
      if (times > most) {
        most = times;
        containing[p] = piece;
      }
  }
  return containing;
}

}  // namespace

MovingNodes read_moving_nodes(const Run& run, const Subject& checkpoint, const std::vector<geo::TriangleMesh>& surfaces,
                              const geo::Progress& progress) {
  MovingNodes moving;
  if (!checkpoint.body) return moving;
  const auto& rest = checkpoint.nodes.position;
  const auto own = pieces_of_nodes(checkpoint, pieces_of(checkpoint.surface));
  std::vector<double> stresses;
  for (std::size_t f = 0; f < run.nodes.size(); ++f) {
    geo::report(progress, "nodes", f, run.nodes.size());
    geo::FrameNodes file = geo::parse_frame_nodes(geo::read_all(run.nodes[f]), run.nodes[f]);
    MovingNodes::Frame frame{.count = file.nodes.size(),
                             .position = std::move(file.nodes.position),
                             .stress = std::move(file.stress),
                             .piece_of = {}};
    frame.count = std::min(frame.count, rest.size());  // a run that was stopped has nodes newer than its checkpoint
    frame.position.resize(frame.count);
    frame.stress.resize(frame.count);
    frame.position.insert(frame.position.end(), rest.begin() + static_cast<std::ptrdiff_t>(frame.count), rest.end());
    stresses.insert(stresses.end(), frame.stress.begin(), frame.stress.end());
    frame.stress.resize(rest.size(), 0);
    frame.piece_of = containing_pieces(surfaces[f], own, frame);
    moving.frames.push_back(std::move(frame));
  }
  if (stresses.empty()) return moving;
  // The 99th percentile: a few nodes with extreme stress do not set the scale of colours.
  const auto mark = stresses.begin() + static_cast<std::ptrdiff_t>(stresses.size() / 100 * 99);
  std::nth_element(stresses.begin(), mark, stresses.end());
  moving.stress_shown = *mark;
  return moving;
}

}  // namespace view
