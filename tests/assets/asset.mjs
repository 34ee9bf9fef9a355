// The physics of a .glb: rigid bodies with their hulls in world coordinates, and the bonds between them. It is read from
// what the file itself says, by either extension.
import fs from 'node:fs';

export const add = (a, b) => a.map((x, i) => x + b[i]);
export const sub = (a, b) => a.map((x, i) => x - b[i]);
export const scale = (s, a) => a.map(x => s * x);
export const dot = (a, b) => a.reduce((sum, x, i) => sum + x * b[i], 0);
export const norm = a => Math.sqrt(dot(a, a));
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
// Quaternions x, y, z, w.
export const turn = (q, v) => {
  const t = scale(2, cross(q, v));
  return add(v, add(scale(q[3], t), cross(q, t)));
};
export const conjugate = q => [-q[0], -q[1], -q[2], q[3]];
const times = (p, q) => [
  p[3] * q[0] + p[0] * q[3] + p[1] * q[2] - p[2] * q[1], p[3] * q[1] - p[0] * q[2] + p[1] * q[3] + p[2] * q[0],
  p[3] * q[2] + p[0] * q[1] - p[1] * q[0] + p[2] * q[3], p[3] * q[3] - p[0] * q[0] - p[1] * q[1] - p[2] * q[2]];

export function readGlb(path) {
  const bytes = fs.readFileSync(path), length = bytes.readUInt32LE(12);
  return {json: JSON.parse(bytes.toString('utf8', 20, 20 + length)), binary: bytes.subarray(28 + length)};
}

function positions({json, binary}, mesh) {
  if (json.meshes[mesh].primitives.length !== 1) throw new Error('a hull of several primitives');
  const accessor = json.accessors[json.meshes[mesh].primitives[0].attributes.POSITION];
  const from = json.bufferViews[accessor.bufferView].byteOffset;
  return Float32Array.from({length: 3 * accessor.count}, (_, i) => binary.readFloatLE(from + 4 * i));
}

const extensionOf = node => node.extensions?.OMI_physics_body ?? node.extensions?.KHR_physics_rigid_bodies ?? {};

// {bodies: [{name, position, rotation, mass, center, inertia, axes, hulls}], bonds: [{a, b, point, force, torque}]}
export function readAsset(path) {
  const glb = readGlb(path), {nodes, scenes, extensions, extensionsUsed} = glb.json;
  const bodies = [], places = new Map(), joints = [];
  const walk = (index, position, rotation, body) => {
    const node = nodes[index], physics = extensionOf(node);
    if (node.matrix || node.scale) throw new Error('a node with matrix or scale');
    position = add(position, turn(rotation, node.translation ?? [0, 0, 0]));
    rotation = times(rotation, node.rotation ?? [0, 0, 0, 1]);
    if (physics.motion) {
      const m = physics.motion;
      body = bodies.length;
      bodies.push({name: node.name, position, rotation, mass: m.mass, center: m.centerOfMass, inertia: m.inertiaDiagonal,
        axes: m.inertiaOrientation, hulls: []});
    }
    if (physics.collider) {
      const shape = extensions.OMI_physics_shape?.shapes[physics.collider.shape];
      if (shape ? shape.type !== 'convex' : !physics.collider.geometry.convexHull) throw new Error('not a convex hull');
      if (norm(sub(position, bodies[body].position)) > 1e-9) throw new Error('a hull away from its body');
      bodies[body].hulls.push(positions(glb, shape ? shape.convex.mesh : physics.collider.geometry.mesh));
    }
    places.set(index, {position, body});
    if (physics.joint) joints.push([index, physics.joint]);
    for (const child of node.children ?? []) walk(child, position, rotation, body);
  };
  const root = scenes[0].nodes[0];
  walk(root, [0, 0, 0], [0, 0, 0, 1]);
  const up = nodes[root].rotation ?? [0, 0, 0, 1], told = scenes[0].extras;
  if (extensionsUsed.includes('OMI_physics_body')) {
    const number = new Map(bodies.map((body, i) => [body.name, i]));
    const bonds = told.bonds.map(b => ({a: number.get(told.pieces[b.a].node), b: number.get(told.pieces[b.b].node),
      point: turn(up, b.centroid), force: b.strength, torque: b.torque}));
    return {bodies, bonds};
  }
  const limits = extensions.KHR_physics_rigid_bodies.physicsJoints?.map(joint => joint.limits);
  const bonds = joints.map(([index, joint]) => {
    const [linear, angular] = limits[joint.joint];
    for (const limit of [linear, angular])
      if ((limit.linearAxes ?? limit.angularAxes).join() !== '0,1,2' || limit.min !== 0 || limit.max !== 0)
        throw new Error('a joint that is not fixed');
    const a = places.get(index), b = places.get(joint.connectedNode);
    if (norm(sub(a.position, b.position)) > 1e-6) throw new Error('the ends of a joint are apart');
    return {a: a.body, b: b.body, point: a.position, force: joint.extras.breakForce, torque: joint.extras.breakTorque};
  });
  return {bodies, bonds};
}
