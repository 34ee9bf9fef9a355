// FrameStats of kerf/simulation.h. Sums of statistics, member by member. Energy, forces and torques
// are those of the later frame.
#include "kerf/simulation.h"

#include <algorithm>

namespace geo {
namespace {

void add(SplitStats& sum, const SplitStats& o) {
  sum.crack += o.crack;
  sum.edges_cut += o.edges_cut;
  sum.edges_added += o.edges_added;
  sum.nodes_updated += o.nodes_updated;
  sum.nodes_added += o.nodes_added;
  sum.nodes_moved += o.nodes_moved;
  sum.orphans += o.orphans;
  sum.resample_seconds += o.resample_seconds;
  sum.graph_seconds += o.graph_seconds;
  sum.binding_seconds += o.binding_seconds;
}

}  // namespace

FrameStats& FrameStats::operator+=(const FrameStats& o) {
  add(split, o.split);
  refused += o.refused;
  fronts += o.fronts;
  newton += o.newton;
  cg += o.cg;
  steps += o.steps;
  blows += o.blows;
  blow_parts += o.blow_parts;
  front_seconds += o.front_seconds;
  mechanics_seconds += o.mechanics_seconds;
  contact_seconds += o.contact_seconds;
  write_seconds += o.write_seconds;
  fracture_seconds += o.fracture_seconds;
  fracture.begun += o.fracture.begun;
  fracture.divided += o.fracture.divided;
  fracture.advanced += o.fracture.advanced;
  fracture.refused += o.fracture.refused;
  fracture.broken += o.fracture.broken;
  fracture.broken_area += o.fracture.broken_area;
  fracture.spent += o.fracture.spent;
  fracture.tips = o.fracture.tips;
  contact += o.contact;
  sheet.deviation = std::max(sheet.deviation, o.sheet.deviation);
  sheet.turning = std::max(sheet.turning, o.sheet.turning);
  sheet.retreating += o.sheet.retreating;
  sheet.crumbs = o.sheet.crumbs;
  energy = o.energy;
  kinetic = o.kinetic;
  weight = o.weight;
  work += o.work;
  cut_energy += o.cut_energy;
  support_force = o.support_force;
  blade_force = o.blade_force;
  pull_force = o.pull_force;
  stitch_force = o.stitch_force;
  obstacle_force = o.obstacle_force;
  obstacle_torque = o.obstacle_torque;
  return *this;
}

double FrameStats::split_seconds() const {
  return split.crack.seconds() + split.graph_seconds + split.resample_seconds + split.binding_seconds;
}

double FrameStats::phase_seconds() const {
  return split_seconds() + fracture_seconds + front_seconds + mechanics_seconds + contact_seconds + write_seconds;
}

}  // namespace geo
