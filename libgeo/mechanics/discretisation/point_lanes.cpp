// Highway compiles the part between HWY_BEFORE_NAMESPACE and HWY_AFTER_NAMESPACE once for each kind of vector. Each
// lane has its own sum. What is written MulAdd is one operation for all kinds that have it, so these find the same
// numbers, and others such as differ by rounding; what is written Add of Mul, as in Shares, is two for all, and the
// same for all.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "mechanics/discretisation/point_lanes.cpp"
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | HWY_AVX3_DL)
#include "hwy/foreach_target.h"
// After foreach_target.h:
#include <algorithm>

#include "hwy/highway.h"
#include "mechanics/discretisation/point_lanes.h"

HWY_BEFORE_NAMESPACE();
namespace geo::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Column c of the gradient of each point is the sum of its nodes' values, each times coordinate c of its shape
// gradient.
void Gradients(const PointBlock& block, const double* values, double* const* out) {
  using Tag = hn::CappedTag<double, 4>;
  const Tag d;
  constexpr std::size_t step = hn::MaxLanes(Tag());
  const std::uint16_t* to = block.to.data();
  const double* g = block.gradient.data();
  for (std::size_t i = 0; i < block.points.size(); ++i) {
    const std::size_t begin = block.first[i], end = block.first[i + 1];
    for (std::size_t at = 0; at < 4; at += step) {
      auto x = hn::Zero(d), y = x, z = x;
      for (std::size_t q = begin; q < end; ++q) {
        const auto u = hn::LoadU(d, values + 4 * to[q] + at);
        x = hn::MulAdd(u, hn::Set(d, g[3 * q]), x);
        y = hn::MulAdd(u, hn::Set(d, g[3 * q + 1]), y);
        z = hn::MulAdd(u, hn::Set(d, g[3 * q + 2]), z);
      }
      hn::StoreU(x, d, out[0] + 4 * i + at);
      hn::StoreU(y, d, out[1] + 4 * i + at);
      hn::StoreU(z, d, out[2] + 4 * i + at);
    }
  }
}

void Divergence(const PointBlock& block, const double* const* stress, double* out) {
  using Tag = hn::CappedTag<double, 4>;
  const Tag d;
  constexpr std::size_t step = hn::MaxLanes(Tag());
  const std::uint16_t* to = block.to.data();
  const double* g = block.gradient.data();
  for (std::size_t i = 0; i < block.points.size(); ++i) {
    const std::size_t begin = block.first[i], end = block.first[i + 1];
    for (std::size_t at = 0; at < 4; at += step) {
      const auto x = hn::LoadU(d, stress[0] + 4 * i + at), y = hn::LoadU(d, stress[1] + 4 * i + at),
                 z = hn::LoadU(d, stress[2] + 4 * i + at);
      for (std::size_t q = begin; q < end; ++q) {
        double* const f = out + 4 * to[q] + at;
        hn::StoreU(
            hn::MulAdd(z, hn::Set(d, g[3 * q + 2]),
                       hn::MulAdd(y, hn::Set(d, g[3 * q + 1]), hn::MulAdd(x, hn::Set(d, g[3 * q]), hn::LoadU(d, f)))),
            d, f);
      }
    }
  }
}

void Shares(const PointBlock& block, const Vec3& base, const float* HWY_RESTRICT place, const float* HWY_RESTRICT own,
            float* HWY_RESTRICT out) {
  using Tag = hn::CappedTag<float, 8>;
  const Tag d;
  constexpr std::size_t step = hn::MaxLanes(Tag());
  const std::uint16_t* to = block.to.data();
  for (std::size_t i = 0; i < block.points.size(); ++i) {
    if (own[8 * i + 6] == 0) continue;
    const Vec3 from = block.points[i].position - base;
    const auto x0 = static_cast<float>(from[0]), y0 = static_cast<float>(from[1]), z0 = static_cast<float>(from[2]),
               volume = static_cast<float>(block.points[i].volume);
    for (std::size_t q = block.first[i]; q < block.first[i + 1]; ++q) {
      const float* const node = place + 4 * to[q];
      const float x = x0 - node[0], y = y0 - node[1], z = z0 - node[2];
      const float left = 1 - (x * x + y * y + z * z) * node[3];  // the kernel, but for its scale
      if (!(left > 0)) continue;
      const auto w = hn::Set(d, volume * left * left * left);
      float* const sum = out + 8 * to[q];
      for (std::size_t c = 0; c < 8; c += step)
        hn::StoreU(hn::Add(hn::LoadU(d, sum + c), hn::Mul(w, hn::LoadU(d, own + 8 * i + c))), d, sum + c);
    }
  }
}

}  // namespace geo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace geo {
HWY_EXPORT(Gradients);
HWY_EXPORT(Divergence);
HWY_EXPORT(Shares);

template <class Number>
void Columns<Number>::resize(std::size_t points) {
  for (auto& c : column) c.resize(4 * ((points + 7) / 8 * 8));
}
template struct Columns<double>;
template struct Columns<float>;

void point_gradients(const PointBlock& block, const double* values, Columns<double>& out) {
  out.resize(block.points.size());
  double* const columns[3] = {out.column[0].data(), out.column[1].data(), out.column[2].data()};
  HWY_DYNAMIC_DISPATCH(Gradients)(block, values, columns);
}
void point_divergence(const PointBlock& block, const Columns<double>& stress, double* out) {
  const double* const columns[3] = {stress.column[0].data(), stress.column[1].data(), stress.column[2].data()};
  HWY_DYNAMIC_DISPATCH(Divergence)(block, columns, out);
}
void point_shares(const PointBlock& block, const Vec3& base, const float* place, const float* own, float* out) {
  HWY_DYNAMIC_DISPATCH(Shares)(block, base, place, own, out);
}

}  // namespace geo
#endif
