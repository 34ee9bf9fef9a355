#include "kerf/run.h"

namespace geo {

FrameStats& FrameStats::operator+=(const FrameStats& o) {
  split.crack += o.split.crack;
  split.edges_cut += o.split.edges_cut, split.edges_added += o.split.edges_added,
      split.nodes_updated += o.split.nodes_updated;
  split.nodes_added += o.split.nodes_added, split.nodes_moved += o.split.nodes_moved, split.orphans += o.split.orphans;
  split.resample_seconds += o.split.resample_seconds, split.graph_seconds += o.split.graph_seconds,
      split.binding_seconds += o.split.binding_seconds;
  refused += o.refused, fronts += o.fronts, newton += o.newton, cg += o.cg, steps += o.steps;
  front_seconds += o.front_seconds, mechanics_seconds += o.mechanics_seconds, contact_seconds += o.contact_seconds,
      write_seconds += o.write_seconds;
  fracture_seconds += o.fracture_seconds;
  fracture.begun += o.fracture.begun, fracture.divided += o.fracture.divided, fracture.advanced += o.fracture.advanced,
      fracture.refused += o.fracture.refused;
  contact += o.contact;
  energy = o.energy, blade_force = o.blade_force, obstacle_force = o.obstacle_force,
  obstacle_torque = o.obstacle_torque;
  return *this;
}

double FrameStats::split_seconds() const {
  return split.crack.seconds() + split.graph_seconds + split.resample_seconds + split.binding_seconds;
}

}  // namespace geo
