#include <cstdio>

#include "surface/pieces.h"
#include "surface/shapes.h"

int main() {
  const auto complex = geo::Complex::from_skin(geo::make_pumpkin(6));
  const auto pieces = geo::find_pieces(complex);
  std::printf("%u piece, volume %.6f\n", pieces.count, pieces.volume.at(0));
  return pieces.count == 1 && pieces.volume[0] > 0 ? 0 : 1;
}
