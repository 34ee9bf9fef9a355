// The choice of vectors.
#include "kerf/vectors.h"

#include <hwy/targets.h>

#include <catch2/catch.hpp>

using namespace geo;

TEST_CASE("portable vectors leave out instruction sets with fused products, and may be given up again", "[vectors]") {
  const auto before = hwy::SupportedTargets();
  CHECK(vectors() == Vectors::widest);
  set_vectors(Vectors::portable);
  CHECK(vectors() == Vectors::portable);
#if HWY_ARCH_X86
  CHECK((hwy::SupportedTargets() & (HWY_AVX2 | HWY_AVX3)) == 0);
  CHECK(hwy::SupportedTargets() != 0);
#endif
  set_vectors(Vectors::widest);
  CHECK(hwy::SupportedTargets() == before);
}
