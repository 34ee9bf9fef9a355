// Fields of the sampling and graph as stored; fields of the motion from displacements and
// velocities.
#include "view/fields.h"

#include <cmath>

#include <kerf/error.h>

namespace view {

std::vector<Field> node_fields(const Subject& subject) {
  const geo::NodeSet& nodes = subject.nodes;
  std::vector<Field> fields{{"radius", nodes.radius}, {"spacing", nodes.spacing}, {"volume", nodes.volume}};
  if (!subject.body) return fields;
  const geo::Body& body = *subject.body;
  std::vector<std::uint32_t> component;
  body.graph.components(component);
  Field neighbors{"neighbors", {}};
  for (std::size_t i = 0; i < nodes.size(); ++i)
    neighbors.values.push_back(double(body.graph.neighbor_count(geo::NodeId(i))));
  fields.push_back(std::move(neighbors));
  fields.push_back({"component", {component.begin(), component.end()}});
  fields.push_back({"debris", {body.debris.begin(), body.debris.end()}});
  if (!subject.motion) return fields;
  Field displacement{"displacement", {}}, speed{"speed", {}}, strain{"strain", {}};
  for (const auto& u : subject.motion->displacement) displacement.values.push_back(u.norm());
  for (const auto& v : subject.motion->velocity) speed.values.push_back(v.norm());
  const geo::Solid solid(nodes, body.graph, {});
  for (const auto& gradient : solid.gradients(subject.motion->displacement)) {
    const geo::Mat3 f = geo::Mat3::Identity() + gradient, e = 0.5 * (f.transpose() * f - geo::Mat3::Identity());
    const geo::Mat3 deviator = e - e.trace() / 3 * geo::Mat3::Identity();
    strain.values.push_back(std::sqrt(2.0 / 3) * deviator.norm());
  }
  for (auto* f : {&strain, &displacement, &speed}) fields.push_back(std::move(*f));
  return fields;
}

const Field& find_field(const std::vector<Field>& fields, const std::string& name) {
  std::string known;
  for (const auto& f : fields) {
    if (f.name == name) return f;
    known += (known.empty() ? "" : ", ") + f.name;
  }
  throw geo::InputError("nodes have no field '" + name + "', but " + known);
}

}  // namespace view
