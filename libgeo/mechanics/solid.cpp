#include "mechanics/solid.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "mechanics/kernel.h"

namespace geo {

Solid::Solid(const NodeSet& nodes, const VisibilityGraph& graph, const Material& material) : material_(material) {
  require_material(material);
  State none;
  std::vector<NodeId> all(nodes.size());
  for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = NodeId(i);
  update(nodes, graph, NodeId(nodes.size()), {}, all, none);
}

void Solid::build_row(std::uint32_t i, const NodeSet& nodes, const VisibilityGraph& graph) {
  Row& row = rows_[i];
  row = Row{};
  Mat3 moment = Mat3::Zero();
  std::vector<double> weights;
  const double scale = nodes.radius[i];
  for (const auto& n : graph.neighbors(nodes, NodeId(i))) {
    const double h = std::max(nodes.radius[i], nodes.radius[n.to.index()]);
    const double w = kernel(n.distance / h, 1.0);  // the moment matrix cancels the kernel's scale
    if (w <= 0) continue;
    const Vec3 x = nodes.position[n.to.index()] - nodes.position[i];
    row.to.push_back(n.to.value);
    row.x.push_back(x);
    weights.push_back(w);
    moment += w / (scale * scale) * x * x.transpose();
  }
  // Directions in which the neighbours hardly spread carry no gradient: their part of the inverse is left out.
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(moment);
  const Vec3 values = eigen.eigenvalues();
  Vec3 inverse = Vec3::Zero();
  int kept = 0;
  for (int k = 0; k < 3; ++k)
    if (values[k] > 1e-4 * values[2] && values[k] > 0) inverse[k] = 1 / values[k], ++kept;
  rung_[i] = kept == 3 ? Rung::full : kept > 0 && row.to.size() >= 2 ? Rung::regularised : Rung::rigid;
  if (rung_[i] == Rung::rigid) inverse.setZero();
  const Mat3 solve = eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose();
  double sum = 0;
  for (const double w : weights) sum += w;
  for (std::size_t q = 0; q < row.to.size(); ++q) {
    row.g.push_back(weights[q] / (scale * scale) * (solve * row.x[q]));
    row.g_self -= row.g.back();
    row.penalty.push_back(material_.mode_penalty * material_.young * weights[q] / sum / row.x[q].squaredNorm());
  }
}

void Solid::transpose() {
  incoming_.assign(rows_.size(), {});
  for (std::uint32_t i = 0; i < rows_.size(); ++i)
    for (std::uint32_t q = 0; q < rows_[i].to.size(); ++q) incoming_[rows_[i].to[q]].push_back({i, q});
}

void Solid::update(const NodeSet& nodes, const VisibilityGraph& graph, NodeId first_new, std::span<const NodeId> donors,
                   std::span<const NodeId> updated, State& state) {
  const std::size_t n = nodes.size();
  if (first_new.index() < n) {
    // New nodes move as their donors' neighbourhoods did before the split.
    for (std::size_t k = 0; first_new.index() + k < n; ++k) {
      const std::uint32_t i = static_cast<std::uint32_t>(first_new.index() + k), d = donors[k].value;
      const Mat3 g = d < rows_.size() ? gradient(d, state.displacement) : Mat3::Zero();
      const Vec3 from = d < material_position_.size() ? material_position_[d] : nodes.position[d];
      state.displacement.push_back(state.displacement[d] + g * (nodes.position[i] - from));
      state.velocity.push_back(Vec3(state.velocity[d]));
    }
  }
  // A moved node keeps its place in the deformed field too.
  for (const NodeId i : updated)
    if (i.index() < material_position_.size() && i.index() < state.displacement.size() && material_position_[i.index()] != nodes.position[i.index()])
      state.displacement[i.index()] += gradient(i.value, state.displacement) * (nodes.position[i.index()] - material_position_[i.index()]);
  rows_.resize(n), rung_.resize(n), mass_.resize(n);
  volume_ = nodes.volume, spacing_ = nodes.spacing, material_position_ = nodes.position;
  for (std::size_t i = 0; i < n; ++i) mass_[i] = material_.density * volume_[i];
  parallel_for(updated.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) build_row(updated[k].value, nodes, graph);
  });
  transpose();
}

Mat3 Solid::gradient(std::uint32_t i, const std::vector<Vec3>& u) const {
  Mat3 g = Mat3::Zero();
  const Row& row = rows_[i];
  for (std::size_t q = 0; q < row.to.size(); ++q)
    if (row.to[q] < u.size()) g += (u[row.to[q]] - u[i]) * row.g[q].transpose();
  return g;
}

void Solid::gradient_row(NodeId i, std::vector<std::pair<NodeId, Vec3>>& out) const {
  const Row& row = rows_[i.index()];
  for (std::size_t q = 0; q < row.to.size(); ++q) out.push_back({NodeId(row.to[q]), row.g[q]});
  out.push_back({i, row.g_self});
}

std::vector<Mat3> Solid::gradients(const std::vector<Vec3>& u) const {
  std::vector<Mat3> g(size());
  parallel_for(size(), 128, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) g[i] = gradient(static_cast<std::uint32_t>(i), u);
  });
  return g;
}

// Each node sums what the rows that hold it contribute, in row order: the same bits for any number of threads.
void Solid::gather(const std::vector<Mat3>& node_stress, const std::vector<std::vector<Vec3>>& pull, std::vector<Vec3>& out) const {
  out.resize(size());
  parallel_for(size(), 128, [&](std::size_t begin, std::size_t end) {
    for (std::size_t j = begin; j < end; ++j) {
      Vec3 sum = node_stress[j] * rows_[j].g_self;
      for (const Vec3& p : pull[j]) sum -= p;
      for (const auto& [i, q] : incoming_[j]) sum += node_stress[i] * rows_[i].g[q] + pull[i][q];
      out[j] = sum;
    }
  });
}

double Solid::elastic_force(const std::vector<Vec3>& u, std::vector<Vec3>* force) const {
  const std::size_t n = size();
  std::vector<double> energy(n);
  std::vector<Mat3> s(force ? n : 0);
  std::vector<std::vector<Vec3>> pull(force ? n : 0);
  parallel_for(n, 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Row& row = rows_[i];
      const Mat3 grad = gradient(static_cast<std::uint32_t>(i), u), f = Mat3::Identity() + grad;
      energy[i] = rung_[i] == Rung::rigid ? 0 : volume_[i] * energy_density(material_, f);
      if (force) s[i] = rung_[i] == Rung::rigid ? Mat3::Zero() : Mat3(volume_[i] * stress(material_, f)), pull[i].resize(row.to.size());
      // The mode penalty: what the linear field through the node does not explain. Its derivative through ∇u is carried
      // by the stress.
      for (std::size_t q = 0; q < row.to.size(); ++q) {
        const Vec3 r = u[row.to[q]] - u[i] - grad * row.x[q];
        const double w = volume_[i] * row.penalty[q];
        energy[i] += 0.5 * w * r.squaredNorm();
        if (force) pull[i][q] = w * r, s[i] -= w * r * row.x[q].transpose();
      }
    }
  });
  double sum = 0;
  for (const double e : energy) sum += e;
  if (force) {
    gather(s, pull, *force);
    for (Vec3& f : *force) f = -f;
  }
  return sum;
}

double Solid::energy(const std::vector<Vec3>& u) const { return elastic_force(u, nullptr); }

std::vector<Vec3> Solid::forces(const std::vector<Vec3>& u) const {
  std::vector<Vec3> f;
  elastic_force(u, &f);
  return f;
}

void Solid::multiply(const std::vector<Mat9>& h, const std::vector<Vec3>& p, std::vector<Vec3>& out) const {
  const std::size_t n = size();
  std::vector<Mat3> s(n);
  std::vector<std::vector<Vec3>> pull(n);
  parallel_for(n, 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Row& row = rows_[i];
      const Mat3 grad = gradient(static_cast<std::uint32_t>(i), p);
      const Eigen::Matrix<double, 9, 1> d = h[i] * Eigen::Map<const Eigen::Matrix<double, 9, 1>>(grad.data());
      s[i] = Eigen::Map<const Mat3>(d.data());
      pull[i].resize(row.to.size());
      for (std::size_t q = 0; q < row.to.size(); ++q) {
        const double w = volume_[i] * row.penalty[q];
        pull[i][q] = w * (p[row.to[q]] - p[i] - grad * row.x[q]);
        s[i] -= pull[i][q] * row.x[q].transpose();
      }
    }
  });
  gather(s, pull, out);
}

Vec3 Solid::momentum(const State& state) const {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < size(); ++i) sum += mass_[i] * state.velocity[i];
  return sum;
}

namespace {

// How deep a node's skin is in the ground; ≤ 0: not touching.
double depth(const Environment& e, std::size_t i, const Vec3& x) {
  return (e.clearance.empty() ? 0.0 : e.clearance[i]) - e.ground_normal.dot(x - e.ground_point);
}

bool is_fixed(const Environment& e, std::size_t i) { return !e.fixed.empty() && e.fixed[i]; }

}  // namespace

StepReport Solid::step_implicit(State& state, double dt, const Environment& env) const {
  const std::size_t n = size();
  StepReport report;
  report.substeps = 1;
  std::vector<Vec3> target(n), u = state.displacement;
  const double keep = 1 / (1 + material_.damping * dt);
  for (std::size_t i = 0; i < n; ++i) {
    target[i] = is_fixed(env, i) ? state.displacement[i] : Vec3(state.displacement[i] + dt * keep * state.velocity[i] + dt * dt * env.gravity);
    u[i] = target[i];
  }
  // Drag along the ground: lagged, from where the step began.
  std::vector<double> drag(n, 0);
  if (env.ground)
    for (std::size_t i = 0; i < n; ++i)
      if (depth(env, i, material_position_[i] + state.displacement[i]) > 0) drag[i] = mass_[i] * env.friction / (0.01 * dt);
  const auto tangential = [&](const Vec3& d) { return Vec3(d - env.ground_normal.dot(d) * env.ground_normal); };
  const auto potential = [&](const std::vector<Vec3>& at) {
    double sum = elastic_force(at, nullptr) + (env.contact ? env.contact->energy(at) : 0.0);
    for (std::size_t i = 0; i < n; ++i) {
      sum += 0.5 * mass_[i] / (dt * dt) * (at[i] - target[i]).squaredNorm();
      if (!env.ground) continue;
      const double d = depth(env, i, material_position_[i] + at[i]);
      if (d > 0) sum += 0.5 * mass_[i] * env.ground_stiffness * d * d;
      if (drag[i] > 0) sum += 0.5 * drag[i] * tangential(at[i] - state.displacement[i]).squaredNorm();
    }
    return sum;
  };
  double value = potential(u);
  const double size = std::cbrt(*std::max_element(volume_.begin(), volume_.end()));
  std::vector<Vec3> force, r(n), p(n), z(n), hp, x(n);
  std::vector<Mat9> h(n);
  std::vector<Mat3> local(n), touching(n), inverse(n);
  for (; report.newton < 12; ++report.newton) {
    elastic_force(u, &force);
    parallel_for(n, 32, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        if (rung_[i] == Rung::rigid)
          h[i].setZero();
        else
          h[i] = volume_[i] * projected_derivative(material_, Mat3::Identity() + gradient(static_cast<std::uint32_t>(i), u));
      }
    });
    std::fill(touching.begin(), touching.end(), Mat3::Zero());
    if (env.contact) env.contact->force(u, force), env.contact->blocks(touching);
    for (std::size_t i = 0; i < n; ++i) {
      r[i] = force[i] - mass_[i] / (dt * dt) * (u[i] - target[i]);
      local[i] = mass_[i] / (dt * dt) * Mat3::Identity();
      if (env.ground) {
        const Mat3 nn = env.ground_normal * env.ground_normal.transpose();
        const double d = depth(env, i, material_position_[i] + u[i]);
        if (d > 0) r[i] += mass_[i] * env.ground_stiffness * d * env.ground_normal, local[i] += mass_[i] * env.ground_stiffness * nn;
        if (drag[i] > 0) r[i] -= drag[i] * tangential(u[i] - state.displacement[i]), local[i] += drag[i] * (Mat3::Identity() - nn);
      }
      if (is_fixed(env, i)) r[i].setZero();
    }
    // Block Jacobi: the local part and the diagonal blocks of the elastic one.
    parallel_for(n, 64, [&](std::size_t begin, std::size_t end) {
      for (std::size_t j = begin; j < end; ++j) {
        Mat3 block = local[j] + touching[j];
        const auto add = [&](std::size_t i, const Vec3& g) {
          for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b)
              for (int c = 0; c < 3; ++c)
                for (int d = 0; d < 3; ++d) block(a, b) += g[c] * h[i](a + 3 * c, b + 3 * d) * g[d];
        };
        add(j, rows_[j].g_self);
        for (const auto& [i, q] : incoming_[j]) {
          add(i, rows_[i].g[q]);
          block += volume_[i] * rows_[i].penalty[q] * Mat3::Identity();
        }
        inverse[j] = block.inverse();
      }
    });
    const auto dot = [&](const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
      double sum = 0;
      for (std::size_t i = 0; i < n; ++i) sum += a[i].dot(b[i]);
      return sum;
    };
    for (std::size_t i = 0; i < n; ++i) x[i].setZero(), z[i] = inverse[i] * r[i], p[i] = z[i];
    double rz = dot(r, z);
    const double enough = 1e-6 * rz;
    if (!(rz > 0)) break;
    for (int k = 0; k < 400 && rz > enough; ++k, ++report.cg) {
      multiply(h, p, hp);
      if (env.contact) env.contact->multiply(p, hp);
      for (std::size_t i = 0; i < n; ++i) {
        hp[i] += local[i] * p[i];
        if (is_fixed(env, i)) hp[i].setZero();
      }
      const double curvature = dot(p, hp);
      if (!(curvature > 0)) break;
      const double alpha = rz / curvature;
      for (std::size_t i = 0; i < n; ++i) x[i] += alpha * p[i], r[i] -= alpha * hp[i];
      for (std::size_t i = 0; i < n; ++i) z[i] = inverse[i] * r[i];
      const double next = dot(r, z);
      for (std::size_t i = 0; i < n; ++i) p[i] = z[i] + next / rz * p[i];
      rz = next;
    }
    double step = 1, most = 0;
    for (const Vec3& d : x) most = std::max(most, d.norm());
    std::vector<Vec3> trial(n);
    double tried = 0;
    for (int k = 0; k < 20; ++k, step *= 0.5) {
      for (std::size_t i = 0; i < n; ++i) trial[i] = u[i] + step * x[i];
      tried = potential(trial);
      if (tried <= value) break;
    }
    if (!(tried <= value)) break;
    u.swap(trial);
    value = tried;
    if (step * most < 1e-5 * size) break;
  }
  for (std::size_t i = 0; i < n; ++i) state.velocity[i] = (u[i] - state.displacement[i]) / dt;
  state.displacement = u;
  report.energy = elastic_force(u, nullptr);
  return report;
}

StepReport Solid::step_explicit(State& state, double dt, const Environment& env) const {
  StepReport report;
  // No wave crosses a third of the smallest neighbourhood in one substep.
  const double speed = std::sqrt((material_.lambda() + 2 * material_.mu() + material_.volume_term) / material_.density);
  const double finest = *std::min_element(spacing_.begin(), spacing_.end());
  double limit = 0.3 * finest / speed;
  if (env.ground) limit = std::min(limit, 0.3 / std::sqrt(env.ground_stiffness));
  report.substeps = std::max(1, static_cast<int>(std::ceil(dt / limit)));
  const double h = dt / report.substeps;
  std::vector<Vec3> force;
  for (int s = 0; s < report.substeps; ++s) {
    report.energy = elastic_force(state.displacement, &force);
    for (std::size_t i = 0; i < size(); ++i) {
      if (is_fixed(env, i)) {
        state.velocity[i].setZero();
        continue;
      }
      Vec3& v = state.velocity[i];
      v += h * (force[i] / mass_[i] + env.gravity - material_.damping * v);
      if (env.ground) {
        const double d = depth(env, i, material_position_[i] + state.displacement[i]);
        if (d > 0) {
          const double normal = env.ground_normal.dot(v);
          v = normal * env.ground_normal + std::max(0.0, 1 - env.friction * h / 0.01) * (v - normal * env.ground_normal);
          v += h * env.ground_stiffness * d * env.ground_normal;
        }
      }
      state.displacement[i] += h * v;
    }
  }
  return report;
}

}  // namespace geo
