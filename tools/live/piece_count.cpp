// A count is a pass over the surface.
#include "live/piece_count.h"

#include <algorithm>
#include <numeric>

#include <kerf/pieces.h>

namespace live {

void PieceCount::count(const geo::Complex& surface) {
  constexpr double least_share = 1e-6;  // of the volume: smaller pieces are specks
  const geo::Pieces pieces = geo::find_pieces(surface);
  const double least = least_share * std::accumulate(pieces.volume.begin(), pieces.volume.end(), 0.0);
  pieces_ = static_cast<std::uint32_t>(
      std::count_if(pieces.volume.begin(), pieces.volume.end(), [&](double v) { return v > least; }));
  counted_faces_ = surface.face_count();
  frames_ = 0;
}

void PieceCount::follow(const geo::Complex& surface, bool is_over) {
  constexpr int interval = 12;  // frames between two counts while a blade cuts
  if (surface.face_count() == counted_faces_) return;
  if (!is_over) ++frames_;
  if (is_over || frames_ >= interval) count(surface);
}

}  // namespace live
