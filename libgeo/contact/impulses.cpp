#include "contact/impulses.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace geo {
namespace {

struct Row {
  std::vector<SurfaceWeights::Entry> entries;  // of the relative velocity, a's less b's
  double mobility = 0;                         // of the pair, softened
  double softness = 0;
};

class RowMaker {
 public:
  RowMaker(const SurfaceWeights& weights, const std::vector<std::vector<std::uint32_t>>& stands_for, const std::vector<double>& inverse_mass)
      : weights_(weights), stands_for_(stands_for), inverse_mass_(inverse_mass), sum_(inverse_mass.size(), 0), taken_(inverse_mass.size(), 0) {}

  Row make(const TouchingPlaces& t, double softness) {
    Row row;
    used_.clear();
    add(t.a, 1);
    double own = 0;  // the mobility of a alone: what the pair's would be were b held
    for (const auto j : used_) own += sum_[j] * sum_[j] * inverse_mass_[j];
    add(t.b, -1);
    for (const auto j : used_) {
      if (sum_[j] != 0) row.entries.push_back({j, sum_[j]});
      row.mobility += sum_[j] * sum_[j] * inverse_mass_[j];
      sum_[j] = 0, taken_[j] = 0;
    }
    row.softness = softness * own;
    row.mobility += row.softness;
    return row;
  }

 private:
  void add(const TouchingPlaces::Place& place, double sign) {
    for (int k = 0; k < place.size; ++k) {
      const auto& copies = stands_for_[place.vertex[k]];
      for (const auto v : copies)
        for (const auto& e : weights_.row(v)) {
          if (!taken_[e.node]) used_.push_back(e.node), taken_[e.node] = 1;
          sum_[e.node] += sign * place.weight[k] / double(copies.size()) * e.weight;
        }
    }
  }

  const SurfaceWeights& weights_;
  const std::vector<std::vector<std::uint32_t>>& stands_for_;
  const std::vector<double>& inverse_mass_;
  std::vector<double> sum_;
  std::vector<std::uint8_t> taken_;
  std::vector<std::uint32_t> used_;
};

}  // namespace

ImpulseReport apply_impulses(const SurfaceWeights& weights, std::span<const TouchingPlaces> touching,
                             const std::vector<std::vector<std::uint32_t>>& stands_for, const std::vector<double>& inverse_mass,
                             const ImpulseOptions& options, std::vector<Vec3>& velocity) {
  ImpulseReport report;
  std::vector<Row> rows(touching.size());
  parallel_for(touching.size(), 64, [&](std::size_t begin, std::size_t end) {
    RowMaker maker(weights, stands_for, inverse_mass);
    for (std::size_t i = begin; i < end; ++i) rows[i] = maker.make(touching[i], options.softness);
  });
  std::vector<double> pressed(touching.size(), 0);
  std::vector<Vec3> rubbed(touching.size(), Vec3::Zero());
  const auto relative = [&](const Row& row) {
    Vec3 v = Vec3::Zero();
    for (const auto& e : row.entries) v += e.weight * velocity[e.node];
    return v;
  };
  const auto kick = [&](const Row& row, const Vec3& impulse) {
    for (const auto& e : row.entries) velocity[e.node] += e.weight * inverse_mass[e.node] * impulse;
  };
  for (report.sweeps = 0; report.sweeps < options.sweeps; ++report.sweeps) {
    double change = 0, speed = 0;
    for (std::size_t i = 0; i < touching.size(); ++i) {
      const Row& row = rows[i];
      const Vec3& n = touching[i].normal;
      if (!(row.mobility > 0)) continue;
      Vec3 v = relative(row);
      const double lack = -touching[i].approach - n.dot(v) - row.softness * pressed[i];
      const double before = pressed[i];
      if (lack <= 0 && before == 0) continue;
      pressed[i] = std::max(0.0, before + lack / row.mobility);
      Vec3 impulse = (pressed[i] - before) * n;
      if (options.friction > 0) {
        const Vec3 slip = v - n.dot(v) * n;
        Vec3 rub = rubbed[i] - (slip + row.softness * rubbed[i]) / row.mobility;
        rub -= n.dot(rub) * n;
        if (const double most = options.friction * pressed[i], is = rub.norm(); is > most) rub *= is > 0 ? most / is : 0.0;
        impulse += rub - rubbed[i];
        rubbed[i] = rub;
      }
      kick(row, impulse);
      change = std::max(change, impulse.norm() * row.mobility), speed = std::max(speed, v.norm());
    }
    if (change <= options.tolerance * speed || change == 0) break;
  }
  for (const double p : pressed) report.touching += p > 0;
  return report;
}

}  // namespace geo
