// painted_density() and ramp_density() of kerf/score.h: values of the skin's nearest point, and a
// ramp along an axis.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "geometry/bvh.h"
#include "geometry/distance.h"
#include "kerf/error.h"
#include "kerf/score.h"

namespace geo {
namespace {

double value_of(const Color& color, ColorChannel channel) {
  if (channel == ColorChannel::luminance) return 0.2126 * color[0] + 0.7152 * color[1] + 0.0722 * color[2];
  return color[static_cast<int>(channel)];
}

// Values at the corners of triangles, and where these are.
struct Painted {
  TriangleBvh skin;
  std::vector<std::array<double, 3>> values;
};

// The density of a surface whose triangle t has the values `corner(t, k)`. Sides of cracks have
// none.
Density density_of(const TriangleMesh& model, const std::function<double(std::size_t, std::size_t)>& corner) {
  const auto all = corners_of(model);
  std::vector<std::array<Vec3, 3>> triangles;
  auto painted = std::make_shared<Painted>();
  for (std::size_t t = 0; t < all.size(); ++t) {
    if (!model.patch.empty() && model.patch[t] != 0) continue;
    triangles.push_back(all[t]);
    painted->values.push_back({corner(t, 0), corner(t, 1), corner(t, 2)});
  }
  if (triangles.empty()) throw InputError("the model has no skin, whose values would be the density");
  painted->skin = TriangleBvh(triangles);
  return [painted = std::shared_ptr<const Painted>(std::move(painted))](const Vec3& p) {
    const auto nearest = painted->skin.closest(p);
    const auto& c = painted->skin.corners(nearest.triangle);
    const Vec3 weights = barycentric(nearest.point, c[0], c[1], c[2]).cwiseMax(0);
    const auto& values = painted->values[nearest.triangle];
    return (weights[0] * values[0] + weights[1] * values[1] + weights[2] * values[2]) / weights.sum();
  };
}

}  // namespace

Density painted_density(const TriangleMesh& model, ColorChannel channel) {
  const auto& colors = model.attributes.color;
  if (colors.size() != model.triangles.size() || colors.empty())
    throw InputError("the model has no colours, which would be the density");
  return density_of(model, [&](std::size_t t, std::size_t k) { return value_of(colors[t][k], channel); });
}

Density painted_density(const TriangleMesh& model, std::span<const double> values) {
  if (values.size() != model.vertices.size())
    throw InputError("the density has " + std::to_string(values.size()) + " values, but the model has " +
                     std::to_string(model.vertices.size()) + " vertices; give one for each");
  if (std::any_of(values.begin(), values.end(), [](double v) { return !(v >= 0) || !std::isfinite(v); }))
    throw InputError("the density has a value below 0 or not finite; give numbers of at least 0");
  return density_of(model, [&](std::size_t t, std::size_t k) { return values[model.triangles[t][k]]; });
}

Density ramp_density(const Box3& box, const Vec3& axis) {
  if (!(axis.norm() > 0) || !axis.allFinite()) throw InputError("an axis needs a length");
  const Vec3 along = axis.normalized();
  const double middle = along.dot(box.center()), reach = 0.5 * along.cwiseAbs().dot(box.hi - box.lo);
  return [along, middle, reach](const Vec3& p) {
    return reach > 0 ? std::clamp(0.5 + (along.dot(p) - middle) / (2 * reach), 0.0, 1.0) : 1.0;
  };
}

}  // namespace geo
