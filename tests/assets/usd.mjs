// usd.mjs PIECES.usda PIECES.glb: tinyusdz reads the stage, and it says what the .glb does: pieces, masses, joints.
import fs from 'node:fs';

import {add, norm, readAsset, readGlb, sub} from './asset.mjs';
import {tiny} from './tiny.mjs';

const [file, glbFile] = process.argv.slice(2), text = fs.readFileSync(file);
function check(condition, what) {
  if (condition) return;
  console.error(`${file}: ${what}`);
  process.exit(1);
}
const loader = new tiny.TinyUSDZLoaderNative();
check(loader.loadFromBinary(text, 'pieces.usda'), `tinyusdz does not read it: ${loader.error()}`);
const asset = readAsset(glbFile), {json} = readGlb(glbFile);

// Prims by path, with positions: column-major or row-major, the translation is the last row of USD's matrices.
const prims = new Map();
(function walk(prim, path, position) {
  const m = prim.localMatrix, here = add(position, [m[12], m[13], m[14]]);
  prims.set(path, {prim, position: here});
  for (const child of prim.children ?? []) walk(child, `${path}/${child.primName}`, here);
})(loader.getDefaultRootNode(), '', [0, 0, 0]);
const pathOf = name => [...prims.keys()].find(path => path.endsWith(`/${name}`));
let triangles = 0;
for (const body of asset.bodies) {
  const at = pathOf(body.name);
  check(at, `no prim ${body.name}`);
  check(norm(sub(prims.get(at).position, body.position)) < 1e-6, `${body.name} is at another place`);
  check(at.split('/').filter(name => name.startsWith('cluster_')).length === 2, `${body.name} is not below two clusters`);
}
check(loader.numMeshes() === asset.bodies.length, `${loader.numMeshes()} meshes`);
for (let i = 0; i < loader.numMeshes(); ++i) {
  const mesh = loader.getMesh(i);
  check(mesh.points.length > 0 && mesh.normals.length > 0, `mesh ${mesh.primName} without points or normals`);
  triangles += mesh.faceVertexCounts.length;
}
check(triangles === json.scenes[0].extras.pieces.reduce((sum, p) => sum + p.triangles, 0), `${triangles} triangles`);

// tinyusdz keeps no physics. A strict parser: every line is one that is known, braces match, and values have their type.
const number = '-?(?:\\d+(?:\\.\\d+)?(?:e[+-]\\d+)?)';
const tuple = n => `\\(${Array(n).fill(`(${number})`).join(', ')}\\)`;
const path_ = '<(/[\\w/]+)>';
const known = {
  'float physics:mass': number, 'point3f physics:centerOfMass': tuple(3), 'float3 physics:diagonalInertia': tuple(3),
  'quatf physics:principalAxes': tuple(4), 'uniform token physics:approximation': '"(convexHull)"',
  'rel physics:body0': path_, 'rel physics:body1': path_, 'point3f physics:localPos0': tuple(3), 'point3f physics:localPos1': tuple(3),
  'quatf physics:localRot0': '\\(1, 0, 0, 0\\)', 'quatf physics:localRot1': '\\(1, 0, 0, 0\\)',
  'float physics:breakForce': number, 'float physics:breakTorque': number, 'uniform bool physics:excludeFromArticulation': '1'};
const stack = [], physics = new Map();
for (const line of String(text).split('\n').map(l => l.trim())) {
  const begin = line.match(/^def (\w+) "(\w+)"(?: \(prepend apiSchemas = \[([^\]]*)\]\))?$/);
  if (begin) {
    stack.push(begin[2]);
    physics.set('/' + stack.join('/'), {type: begin[1], schemas: (begin[3] ?? '').replaceAll('"', '').split(', ')});
  } else if (line === '}') {
    check(stack.pop(), 'braces do not match');
  } else if (line.includes(' physics:')) {
    const [name, value] = line.split(' = '), pattern = known[name];
    check(pattern, `an unknown property: ${name}`);
    const match = value.match(new RegExp(`^${pattern}$`));
    check(match, `not a value of ${name}: ${value}`);
    physics.get('/' + stack.join('/'))[name.split(':')[1]] = match.length > 2 ? match.slice(1).map(Number) : match[1] ?? value;
  }
}
check(stack.length === 0, 'braces do not match');
for (const setting of ['defaultPrim = "pieces"', 'metersPerUnit = 1', 'kilogramsPerUnit = 1', 'upAxis = "Y"'])
  check(String(text).includes(`\n    ${setting}\n`), `no ${setting}`);
const near = (a, b, scale = 1) => Math.abs(a - b) <= 1e-6 * Math.max(scale, Math.abs(b));
for (const body of asset.bodies) {
  const prim = physics.get('/pieces' + pathOf(body.name).replace(/^\/pieces/, ''));
  check(prim?.type === 'Mesh', `${body.name} is no mesh`);
  for (const schema of ['RigidBody', 'Mass', 'Collision', 'MeshCollision'])
    check(prim.schemas.includes(`Physics${schema}API`), `${body.name} without Physics${schema}API`);
  check(near(Number(prim.mass), body.mass), `${body.name} has another mass`);
  check(prim.diagonalInertia.every((x, i) => near(x, body.inertia[i])), `${body.name} has another inertia`);
  const [w, x, y, z] = prim.principalAxes;
  check(norm(sub([x, y, z, w], body.axes)) < 1e-6, `${body.name} has other principal axes`);
}
const joints = [...physics].filter(([, prim]) => prim.type === 'PhysicsFixedJoint');
check(joints.length === asset.bonds.length, `${joints.length} joints for ${asset.bonds.length} bonds`);
joints.forEach(([name, joint], i) => {
  const bond = asset.bonds[i], ends = [[joint.body0, joint.localPos0, bond.a], [joint.body1, joint.localPos1, bond.b]];
  for (const [body, local, k] of ends) {
    check(physics.has(body) && body.endsWith(`/${asset.bodies[k].name}`), `${name} names ${body}`);
    check(norm(sub(add(asset.bodies[k].position, local), bond.point)) < 1e-6, `${name} is not at its bond`);
  }
  check(near(Number(joint.breakForce), bond.force) && near(Number(joint.breakTorque), bond.torque), `${name} has another strength`);
});
console.log(`usd: ${asset.bodies.length} bodies, ${joints.length} joints, ${triangles} triangles as in the .glb`);
