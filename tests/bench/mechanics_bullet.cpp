// Bullet's deformable body: linear tetrahedra, backward Euler, as its own example of a neo-Hookean
// body sets it up.
#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableGravityForce.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btDeformableNeoHookeanForce.h>
#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>

#include "bench.h"
#include "mechanics.h"

namespace bench {

Bent bend_with_bullet(const Beam& beam) {
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btDeformableBodySolver bodies;
  btDeformableMultiBodyConstraintSolver constraints;
  constraints.setDeformableSolver(&bodies);
  btDeformableMultiBodyDynamicsWorld world(&dispatcher, &broadphase, &constraints, &configuration, &bodies);
  const btVector3 gravity(0, 0, btScalar(-beam.gravity));
  world.setGravity(gravity);
  world.getWorldInfo().m_gravity = gravity;
  world.setImplicit(true);
  world.setLineSearch(false);
  world.setUseProjection(true);
  const int nx = beam.across * 4 + 1, ny = beam.across + 1, nz = ny;
  const double h = 1.0 / beam.across;
  const auto id = [&](int i, int j, int k) { return i + nx * (j + ny * k); };
  std::vector<btVector3> points;
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) points.push_back(btVector3(btScalar(i * h), btScalar(j * h), btScalar(k * h)));
  auto* body = new btSoftBody(&world.getWorldInfo(), int(points.size()), points.data(), nullptr);
  // Six tetrahedra a cell, about its diagonal.
  constexpr int six[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};
  for (int k = 0; k + 1 < nz; ++k)
    for (int j = 0; j + 1 < ny; ++j)
      for (int i = 0; i + 1 < nx; ++i)
        for (const auto& t : six) {
          int v[4];
          for (int c = 0; c < 4; ++c) v[c] = id(i + (t[c] & 1), j + (t[c] >> 1 & 1), k + (t[c] >> 2));
          body->appendTetra(v[0], v[1], v[2], v[3]);
        }
  std::vector<double> mass(points.size(), 0);
  for (int t = 0; t < body->m_tetras.size(); ++t)
    for (const auto* node : body->m_tetras[t].m_n)
      mass[std::size_t(node - &body->m_nodes[0])] += beam.density * h * h * h / 24;
  for (int i = 0; i < int(points.size()); ++i)
    body->setMass(i, points[std::size_t(i)].x() < 0.1 ? btScalar(0) : btScalar(mass[std::size_t(i)]));
  body->initializeDmInverse();
  body->m_tetraScratches.resize(body->m_tetras.size());
  body->m_tetraScratchesTn.resize(body->m_tetras.size());
  body->m_cfg.drag = 0;
  body->m_cfg.kDP = 0;
  body->setDampingCoefficient(0);
  body->m_cfg.collisions = 0;
  body->m_sleepingThreshold = 0;
  world.addSoftBody(body);
  const double mu = beam.young / (2 * (1 + beam.poisson)),
               lambda = beam.young * beam.poisson / ((1 + beam.poisson) * (1 - 2 * beam.poisson));
  btDeformableNeoHookeanForce elastic{btScalar(mu), btScalar(lambda), btScalar(0)};
  btDeformableGravityForce weight(gravity);
  world.addForce(body, &elastic);
  world.addForce(body, &weight);
  Bent bent;
  bent.nodes = points.size();
  const double start = cpu_seconds();
  for (int f = 0; f < beam.frames; ++f) world.stepSimulation(btScalar(beam.dt), 1, btScalar(beam.dt));
  bent.seconds = cpu_seconds() - start;
  int tips = 0;
  for (int i = 0; i < body->m_nodes.size(); ++i)
    if (points[std::size_t(i)].x() > 4 - 0.5 * h) {
      bent.tip += body->m_nodes[i].m_x.z() - points[std::size_t(i)].z();
      ++tips;
    }
  bent.tip /= tips;
  world.removeSoftBody(body);
  delete body;
  return bent;
}

}  // namespace bench
