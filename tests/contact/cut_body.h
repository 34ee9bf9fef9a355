// A crack step of a body with self-contact.
#pragma once

#include <catch2/catch.hpp>
#include <optional>

#include "body/crack_transaction.h"
#include "contact/self_contact.h"

namespace geo {

/// Moves a front to `next`, material coordinates; mechanics and surface follow.
inline BodyDelta cut(Body& body, Solid& solid, State& state, SelfContact& contact, FrontState& front,
                     const std::vector<Vec3>& next) {
  std::optional<EmbeddingPlan> plan;
  CrackTransaction step(body, advance_of(front, next, {}), nullptr);
  const BodyDelta delta = step.commit([&](const Complex& grown, const CrackDelta& crack) {
    plan = contact.plan_embedding(body, solid, state, grown, crack);
  });
  solid.update(body.nodes, body.graph, delta.first_new_node, delta.donors, delta.updated_nodes, state);
  REQUIRE(plan.has_value() == !delta.crack.empty());
  if (plan) contact.commit(std::move(*plan), body, delta);
  contact.update_weights(body, solid, state.displacement);
  return delta;
}

/// The surface as a mesh, for count_crossings().
inline TriangleMesh mesh_of(const SelfContact& contact) {
  TriangleMesh mesh;
  mesh.vertices = contact.positions();
  mesh.triangles = contact.surface().triangles;
  mesh.site = contact.surface().site;
  return mesh;
}

}  // namespace geo
