// An asset in Rapier: its bodies with their masses and hulls, its bonds as fixed joints that break.
import RAPIER from '@dimforge/rapier3d-compat';

import {add, conjugate, cross, norm, scale, sub, turn} from './asset.mjs';
import {bondLoads} from './loads.mjs';

await RAPIER.init();

const step = 1 / 240;  // s
const window = 12;     // steps over which accelerations are averaged
const vector = ([x, y, z]) => ({x, y, z}), quaternion = ([x, y, z, w]) => ({x, y, z, w});
const list = v => 'w' in v ? [v.x, v.y, v.z, v.w] : [v.x, v.y, v.z];

// The product of a body's inertia in the world with v.
function inertiaTimes(body, rotation, v) {
  const local = turn(conjugate(body.axes), turn(conjugate(rotation), v));
  return turn(rotation, turn(body.axes, local.map((x, k) => x * body.inertia[k])));
}

export class World {
  // fixed: names of bodies that do not move. ground: height of a horizontal plane, or null.
  constructor({bodies, bonds}, {gravity, fixed = [], ground = null}) {
    this.gravity = gravity;
    this.asset = bodies;
    this.world = new RAPIER.World(vector(gravity));
    this.world.timestep = step;
    this.world.integrationParameters.numSolverIterations = 40;
    if (ground !== null)
      this.ground = this.world.createCollider(RAPIER.ColliderDesc.cuboid(50, 1, 50).setTranslation(0, ground - 1, 0)
        .setFriction(0.8).setCollisionGroups(0x0001ffff));
    this.bodies = bodies.map(body => {
      const held = fixed.includes(body.name);
      const description = held ? RAPIER.RigidBodyDesc.fixed() : RAPIER.RigidBodyDesc.dynamic();
      description.setTranslation(...body.position).setRotation(quaternion(body.rotation)).setCanSleep(false);
      if (!held)
        description.setAdditionalMassProperties(body.mass, vector(body.center), vector(body.inertia), quaternion(body.axes));
      const made = this.world.createRigidBody(description);
      // Hulls of neighbours overlap where pieces are not convex, so pieces meet the ground alone.
      for (const hull of body.hulls)
        this.world.createCollider(RAPIER.ColliderDesc.convexHull(hull).setDensity(0).setFriction(0.8)
          .setCollisionGroups(0x00020001), made);
      return made;
    });
    this.bonds = bonds.map(bond => {
      const ends = [bond.a, bond.b].map(i => {
        const back = conjugate(bodies[i].rotation);
        return [vector(turn(back, sub(bond.point, bodies[i].position))), quaternion(back)];
      });
      const joint = this.world.createImpulseJoint(RAPIER.JointData.fixed(...ends[0], ...ends[1]),
        this.bodies[bond.a], this.bodies[bond.b], true);
      return {...bond, joint, most: [0, 0]};
    });
    this.broken = [];
    this.applied = bodies.map(() => []);  // [force, point in the body]
    this.before = this.velocities();
    this.touching = bodies.map(() => []);  // forces of the ground in this window
    this.weight = 0;                       // what the ground carried in the last window, upwards
    this.steps = 0;
  }

  velocities() { return this.bodies.map(b => [list(b.linvel()), list(b.angvel())]); }
  center(i) { return list(this.bodies[i].worldCom()); }
  mass() { return this.bodies.reduce((sum, b, i) => sum + (b.isDynamic() ? this.asset[i].mass : 0), 0); }
  at(i, point) { return add(list(this.bodies[i].translation()), turn(list(this.bodies[i].rotation()), point)); }
  // Applies a force to a point of a body, in its coordinates, from now on.
  load(i, force, point) { this.applied[i] = [[force, point]]; }

  // Forces of the ground on a body in the last step, as a part of the window's mean: [force, point]. Normal parts only.
  contacts(i) {
    const found = [];
    if (!this.ground) return found;
    for (let c = 0; c < this.bodies[i].numColliders(); ++c)
      this.world.contactPair(this.ground, this.bodies[i].collider(c), (manifold, flipped) => {
        const normal = scale(flipped ? -1 : 1, list(manifold.normal()));
        for (let k = 0; k < manifold.numContacts(); ++k)
          found.push([scale(manifold.contactImpulse(k) / (window * step), normal),
            this.at(i, list(flipped ? manifold.localContactPoint1(k) : manifold.localContactPoint2(k)))]);
      });
    return found;
  }

  // Simulates `seconds`; joints break at the end of a window in which they carried more than they withstand.
  run(seconds) {
    for (const end = this.steps + Math.round(seconds / step); this.steps < end;) {
      this.bodies.forEach((body, i) => {
        body.resetForces(false);
        body.resetTorques(false);
        for (const [force, point] of this.applied[i]) body.addForceAtPoint(vector(force), vector(this.at(i, point)), true);
      });
      this.world.step();
      this.bodies.forEach((_, i) => this.touching[i].push(...this.contacts(i)));
      this.steps += 1;
      if (this.steps % window === 0) this.check();
    }
  }

  check() {
    const now = this.velocities(), time = window * step;
    const bodies = this.bodies.map((body, i) => {
      if (!body.isDynamic()) return null;
      const center = this.center(i), rotation = list(body.rotation()), spin = now[i][1], {mass} = this.asset[i];
      let force = scale(mass, sub(scale(1 / time, sub(now[i][0], this.before[i][0])), this.gravity));
      let torque = add(inertiaTimes(this.asset[i], rotation, scale(1 / time, sub(spin, this.before[i][1]))),
        cross(spin, inertiaTimes(this.asset[i], rotation, spin)));
      for (const [f, p] of [...this.applied[i].map(([f, p]) => [f, this.at(i, p)]), ...this.touching[i]]) {
        force = sub(force, f);
        torque = sub(torque, cross(sub(p, center), f));
      }
      return {center, need: [force, torque]};
    });
    this.before = now;
    this.weight = this.touching.flat().reduce((sum, [f]) => sum + f[1], 0);
    this.touching.forEach(forces => { forces.length = 0; });
    const held = this.bonds.filter(bond => bond.joint);
    if (held.length === 0) return;
    // A bond's strength is in proportion to its area.
    const loads = bondLoads(bodies, held.map(bond => ({...bond, area: bond.force / this.stress,
      point: this.at(bond.a, turn(conjugate(this.asset[bond.a].rotation), sub(bond.point, this.asset[bond.a].position)))})));
    held.forEach((bond, k) => {
      const carried = loads[k].map(norm);
      bond.most = bond.most.map((m, i) => Math.max(m, carried[i]));
      if (carried[0] <= bond.force && carried[1] <= bond.torque) return;
      this.world.removeImpulseJoint(bond.joint, true);
      bond.joint = null;
      this.broken.push(bond);
    });
  }
}
