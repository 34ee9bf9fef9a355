// drop.mjs FOLDER: assets that tests/assets/run makes stand, hang, break and drop in Rapier as their files say.
import {add, norm, readAsset, sub, turn} from './asset.mjs';
import {World} from './world.mjs';

const folder = process.argv[2], g = 9.81;
const failures = [];
function expect(condition, text) {
  console.log(`${condition ? 'ok  ' : 'FAIL'} ${text}`);
  if (!condition) failures.push(text);
}
const within = (share, value, stated) => Math.abs(value - stated) <= share * Math.abs(stated);
const read = name => readAsset(`${folder}/${name}.glb`);
function world(asset, stress, options) {
  const made = new World(asset, options);
  made.stress = stress;
  return made;
}

// Both extensions say the same.
{
  const [omi, khr] = [read('omi'), read('khr')];
  let worst = omi.bodies.length === khr.bodies.length && omi.bonds.length === khr.bonds.length ? 0 : Infinity;
  const compare = (...differences) => { worst = Math.max(worst, ...differences); };
  omi.bodies.forEach((body, i) => {
    const other = khr.bodies[i];
    if (body.name !== other.name || body.hulls.length !== other.hulls.length) compare(Infinity);
    compare(norm(sub(body.position, other.position)), norm(sub(body.inertia, other.inertia)), Math.abs(body.mass - other.mass));
  });
  for (const bond of omi.bonds) {
    const other = khr.bonds.find(b => b.a === bond.a && b.b === bond.b);
    if (other) compare(norm(sub(bond.point, other.point)), Math.abs(bond.force - other.force), Math.abs(bond.torque - other.torque));
    else compare(Infinity);
  }
  expect(worst < 1e-6, `${omi.bodies.length} bodies and ${omi.bonds.length} bonds are the same by both extensions, to ${worst.toExponential(1)}`);
}

// A pumpkin in twelve pieces stands under its weight.
for (const name of ['omi', 'khr']) {
  const asset = read(name);
  let lowest = Infinity;
  for (const body of asset.bodies)
    for (const hull of body.hulls)
      for (let i = 0; i < hull.length; i += 3)
        lowest = Math.min(lowest, add(body.position, turn(body.rotation, [...hull.slice(i, i + 3)]))[1]);
  const w = world(asset, 1e5, {gravity: [0, -g, 0], ground: lowest});
  w.run(2);
  const moved = Math.max(...asset.bodies.map((b, i) => norm(sub(w.at(i, [0, 0, 0]), b.position))));
  const share = Math.max(...w.bonds.map(b => Math.max(b.most[0] / b.force, b.most[1] / b.torque)));
  expect(w.broken.length === 0, `${name}: stands for two seconds, no bond of ${w.bonds.length} broken; the most loaded carries ${(100 * share).toFixed(1)} % of its strength`);
  expect(moved < 0.05, `${name}: no piece moved farther than ${moved.toFixed(4)} m`);
  // Rapier's impulses of contacts count one of its 40 substeps too many.
  expect(within(0.05, w.weight, w.mass() * g), `${name}: the ground carries ${w.weight.toFixed(0)} N of ${(w.mass() * g).toFixed(0)} N`);
}

// A bar of four pieces hangs from the highest. A load that grows at its lower end breaks the upper bond, which carries
// all of the weight, too.
function grow(name, stress, gravity, point, breakingLoad) {
  const asset = read(name), order = asset.bodies.map((_, i) => i).sort((i, j) => asset.bodies[i].position[0] - asset.bodies[j].position[0]);
  const [held, tip] = gravity[0] < 0 ? [order.at(-1), order[0]] : [order[0], order.at(-1)];
  const w = world(asset, stress, {gravity, fixed: [asset.bodies[held].name]});
  w.run(0.5);
  expect(w.broken.length === 0, `${name}: holds its own weight`);
  const along = gravity.map(x => x / norm(gravity)), local = sub(point, asset.bodies[tip].position);
  const stated = breakingLoad(asset, held);
  let load = 0;
  while (w.broken.length === 0 && load < 3 * stated) {
    load += 0.013 * stated;
    w.load(tip, along.map(x => load * x), local);
    w.run(0.1);
  }
  const first = w.broken[0];
  expect(first && [first.a, first.b].includes(held), `${name}: the bond at the support breaks first`);
  expect(within(0.1, load, stated), `${name}: breaks at ${load.toFixed(0)} N; stated are ${stated.toFixed(0)} N (${(100 * (load / stated - 1)).toFixed(1)} %)`);
  const from = w.center(tip);
  w.run(0.5);
  const fell = sub(w.center(tip), from).reduce((sum, x, k) => sum + x * along[k], 0);
  expect(fell > 1, `${name}: what broke off falls, ${fell.toFixed(2)} m in half a second`);
  return load;
}
// The bond of the held piece, and the weight that hangs on it, with the lever of that weight.
function support(asset, held) {
  const bond = asset.bonds.find(b => b.a === held || b.b === held);
  const free = asset.bodies.filter((_, i) => i !== held);
  return {bond, weight: g * free.reduce((sum, b) => sum + b.mass, 0),
    moment: g * free.reduce((sum, b) => sum + b.mass * Math.abs(b.position[0] - bond.point[0]), 0)};
}
const tension = (asset, held) => { const s = support(asset, held); return s.bond.force - s.weight; };
const bending = (asset, held) => { const s = support(asset, held); return (s.bond.torque - s.moment) / Math.abs(2 - s.bond.point[0]); };
const strong = grow('bar', 1e6, [-g, 0, 0], [0, 0.5, 0.5], tension);
const weak = grow('bar-weak', 5e5, [-g, 0, 0], [0, 0.5, 0.5], tension);
expect(within(0.1, (weak + 47e3) / (strong + 47e3), 0.5), 'half the strength breaks at half the load, weight included');
grow('bar', 1e6, [0, -g, 0], [2, 0.5, 0.5], bending);

// The same bar, divided lengthwise, too: bonds share the load, and each piece has several. Each half is pulled in
// proportion to its section, so all bonds of a section reach their strength at the same load.
{
  const asset = read('bar-split'), stress = 1e6, {bodies, bonds} = asset;
  const across = bonds.filter(b => Math.abs(bodies[b.a].position[0] - bodies[b.b].position[0]) > 0.3);
  const ends = pick => across.filter(b => Math.abs(b.point[0] - pick(...across.map(c => c.point[0]))) < 1e-3).map(bond => {
    const [low, high] = bodies[bond.a].position[0] < bodies[bond.b].position[0] ? [bond.a, bond.b] : [bond.b, bond.a];
    return {bond, low, high};
  });
  const upper = ends(Math.max), lower = ends(Math.min);
  const w = world(asset, stress, {gravity: [-g, 0, 0], fixed: upper.map(e => bodies[e.high].name)});
  w.run(0.5);
  const stated = upper.reduce((sum, e) => sum + e.bond.force, 0) - w.mass() * g;
  let load = 0;
  while (w.broken.length === 0 && load < 3 * stated) {
    load += 0.013 * stated;
    for (const {bond, low} of lower)
      w.load(low, [-load * bond.force / stress, 0, 0], sub([0, bond.point[1], bond.point[2]], bodies[low].position));
    w.run(0.1);
  }
  expect(upper.length === 2 && lower.length === 2 && bonds.length > bodies.length, `bar-split: ${bodies.length} pieces, ${bonds.length} bonds`);
  expect(w.broken.every(b => upper.some(e => e.bond.a === b.a && e.bond.b === b.b)), 'bar-split: a bond at the support breaks first');
  expect(within(0.1, load, stated), `bar-split: breaks at ${load.toFixed(0)} N; stated are ${stated.toFixed(0)} N (${(100 * (load / stated - 1)).toFixed(1)} %)`);
}

// A fall from two metres breaks weak bonds, and not strong ones.
for (const [name, breaks] of [['omi-weak', true], ['omi-strong', false]]) {
  const asset = read(name);
  const w = world(asset, breaks ? 1e4 : 1e9, {gravity: [0, -g, 0], ground: -3});
  w.run(1.5);
  expect(breaks === w.broken.length > 0, `${name}: a fall breaks ${w.broken.length} bonds of ${w.bonds.length}`);
}

if (failures.length > 0) process.exit(1);
