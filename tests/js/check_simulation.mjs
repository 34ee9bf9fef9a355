// Simulations of the npm package: a blade parts a block, energies, what a program moves, memory.
import assert from "node:assert/strict";
import kerf from "kerf";

const k = await kerf();
const scene = `
[body]
mesh = "block"
nodes = 120
[material]
young = 2e5
density = 1000
[ground]
point = [0, 0, 0]
[contact]
self = true
[time]
step = 0.01
frames = 4
`;

// A block whose faces at x = 0 are red, with texture coordinates y and z.
function painted(k) {
  const block = k.shapes.block([1, 1, 1], { edge: 0.25 }), { vertices, faces } = block;
  const uv = Array.from(faces, (v) => [vertices[3 * v + 1], vertices[3 * v + 2]]);
  const groups = Array.from({ length: faces.length / 3 }, (_, f) => Number(faces.slice(3 * f, 3 * f + 3).every((v) => vertices[3 * v] === 0)));
  const made = new k.Solid(vertices, faces, { uv, groups, groupNames: ["wood", "red"] });
  block.delete();
  return made;
}

async function run() {
  const block = painted(k);
  const simulation = await k.simulation(scene, { models: block, set: { "gravity": [0, 0, -1] } });
  const knife = simulation.addBlade([[-1, 0, 0], [2, 0, 0]], [0, 0.5, 1.3]);
  const grip = simulation.addGrip([-0.1, -0.1, -0.1], [1.1, 0.2, 0.1]);
  let frames = 0;
  for (const z of [1.0, 0.6, 0.2, -0.2]) {
    knife.move([0, 0.5, z]);
    const stats = simulation.step();
    assert.ok(Number.isFinite(stats.elastic) && Number.isFinite(stats.kinetic) && stats.refused === 0);
    frames++;
  }
  assert.equal(simulation.frame, frames);
  assert.equal(simulation.pieceCount, 2);
  const surface = simulation.surface(), made = new k.Mesh(surface.vertices, surface.faces);
  assert.ok(made.check().closed && Math.abs(made.volume - 1) < 0.05);
  assert.equal(surface.uv.length, 2 * surface.faces.length);
  for (let f = 0; f < surface.groups.length; f++) {
    const name = surface.groupNames[surface.groups[f]];
    if (surface.patch[f] !== 0) assert.equal(name, "crack");
    else assert.ok(name === "red" || name === "wood");
  }
  const red = surface.uv.filter((_, i) => surface.groupNames[surface.groups[Math.floor(i / 6)]] === "red");
  assert.ok(red.length > 6 && Math.min(...red) === 0 && Math.max(...red) === 1);
  assert.equal(simulation.positions.length, simulation.stress.length * 3);
  assert.ok(Math.max(...simulation.stress) > 0);
  grip.end(), simulation.change({ young: 1e5, gravity: [0, 0, 0] });
  simulation.step();
  assert.equal(new TextDecoder().decode(simulation.save("ply").subarray(0, 3)), "ply");
  const total = simulation.pieceCount;
  for (const wrong of [{ cells: 1 }, { cells: 2.5 }, { cells: 1e4 }]) assert.throws(() => simulation.strike([1, 1, 1], wrong), { name: "InputError" });
  for (const point of [[0, 0], [0, 0, NaN]]) assert.throws(() => simulation.strike(point), { name: "InputError" });
  simulation.strike([1, 1, 1], { cells: 5 });
  assert.ok(simulation.pieceCount > total);
  assert.ok(simulation.step().kinetic > 0);
  assert.throws(() => simulation.blade(7).move([0, 0, 0]), /blade 7/);
  made.delete(), simulation.delete(), block.delete();
  return simulation.constructor.usedBytes();
}

await run();
const before = await run();
const after = await run();
assert.ok(after - before < 4096, `${after - before} bytes are left`);
await assert.rejects(k.simulation("[body]\nmesh = 1\n", {}), { name: "InputError" });
await assert.rejects(k.simulation(7), { name: "InputError", message: /TOML/ });
await assert.rejects(k.simulation("", { model: 1 }), { name: "InputError", message: /models, / });
console.log("simulation: a blade parts a block");
