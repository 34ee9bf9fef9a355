// The number of pieces that pages show.
#pragma once

#include <cstdint>

#include <kerf/complex.h>

namespace live {

/// Counts pieces now and then while a blade cuts. Specks do not count.
class PieceCount {
 public:
  /// Counts now.
  void count(const geo::Complex& surface);
  /// After a frame: counts where something was cut since the last count, if it is due. `is_over`:
  /// no blade cuts any more.
  void follow(const geo::Complex& surface, bool is_over);
  /// As of the last count.
  std::uint32_t pieces() const { return pieces_; }

 private:
  std::uint32_t pieces_ = 1, counted_faces_ = 0;
  int frames_ = 0;  // while a blade cuts, since the last count
};

}  // namespace live
