// The models of kerf-bench break in 20 pieces, by Kerf, three-pinata and manifold-3d: milliseconds, closed pieces, volumes.
// Run by break-peers. A piece is closed if each of its edges has its opposite, once vertices at the same place are one; in the
// column "nearly" once those are one that agree to five decimals.
import Manifold3d from "manifold-3d";
import * as pinata from "@dgreenheck/three-pinata";
import * as THREE from "three";
import kerf from "kerf";

const wanted = 20, runs = 9;
const k = await kerf();
const manifold = await Manifold3d();
manifold.setup();

// Mulberry32: a small generator, so that all runs are the same.
function generator(seed) {
  return () => {
    seed = (seed + 0x6d2b79f5) | 0;
    let t = Math.imul(seed ^ (seed >>> 15), 1 | seed);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}

function volumeOf({ vertices: v, faces: f }) {
  let six = 0;
  for (let i = 0; i < f.length; i += 3) {
    const [a, b, c] = [3 * f[i], 3 * f[i + 1], 3 * f[i + 2]];
    six += v[a] * (v[b + 1] * v[c + 2] - v[b + 2] * v[c + 1]) - v[a + 1] * (v[b] * v[c + 2] - v[b + 2] * v[c]) + v[a + 2] * (v[b] * v[c + 1] - v[b + 1] * v[c]);
  }
  return six / 6;
}
function isClosed({ vertices, faces }, decimals) {
  const place = new Map(), edges = new Map();
  const idOf = (i) => {
    const key = vertices.slice(3 * i, 3 * i + 3).map((x) => (decimals ? x.toFixed(decimals).replace(/^-(0\.0*)$/, "$1") : x + 0)).join();
    if (!place.has(key)) place.set(key, place.size);
    return place.get(key);
  };
  for (let i = 0; i < faces.length; i += 3) {
    const [a, b, c] = [idOf(faces[i]), idOf(faces[i + 1]), idOf(faces[i + 2])];
    if (a === b || b === c || c === a) continue;  // a sliver that is a line once its corners are one
    for (const [p, q] of [[a, b], [b, c], [c, a]]) {
      const key = p < q ? `${p},${q}` : `${q},${p}`;
      edges.set(key, (edges.get(key) ?? 0) + (p < q ? 1 : -1));
    }
  }
  return [...edges.values()].every((sum) => sum === 0);
}

// ---- The three. Each takes a model once, and then breaks it with a seed, to a list of { vertices, faces }.

function byKerf(model) {
  return (seed) => {
    const pieces = model.fracture(wanted, { seed });
    const meshes = pieces.map(({ vertices, faces }) => ({ vertices, faces }));
    for (const piece of pieces) piece.delete();
    return meshes;
  };
}

function byPinata(model) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(Float32Array.from(model.vertices), 3));
  geometry.setAttribute("uv", new THREE.BufferAttribute(new Float32Array((2 * model.vertices.length) / 3), 2));
  geometry.setIndex(new THREE.BufferAttribute(model.faces.slice(), 1));
  geometry.computeVertexNormals();
  return (seed) => {
    Math.random = generator(seed);
    return pinata.fracture(geometry, new pinata.FractureOptions({ fragmentCount: wanted }))
      .map((piece) => ({ vertices: piece.getAttribute("position").array, faces: piece.getIndex().array }));
  };
}

// It has no patterns: convex cells of random sites, each by planes, are intersected with the model.
function byManifold(model) {
  const { Manifold, Mesh } = manifold;
  const whole = new Manifold(new Mesh({ numProp: 3, vertProperties: Float32Array.from(model.vertices), triVerts: model.faces.slice() }));
  const { min, max } = whole.boundingBox(), size = max.map((x, i) => x - min[i]);
  const cellOf = (site, sites) => {
    let cell = Manifold.cube(size.map((x) => 1.1 * x)).translate(min.map((x, i) => x - 0.05 * size[i]));
    for (const other of sites) {
      if (other === site) continue;
      const normal = site.map((x, i) => x - other[i]), length = Math.hypot(...normal);
      const unit = normal.map((x) => x / length), offset = unit.reduce((sum, x, i) => sum + (x * (site[i] + other[i])) / 2, 0);
      const smaller = cell.trimByPlane(unit, offset);
      cell.delete();
      cell = smaller;
    }
    return cell;
  };
  return (seed) => {
    const random = generator(seed), sites = Array.from({ length: wanted }, () => min.map((x, i) => x + size[i] * random())), pieces = [];
    for (const site of sites) {
      const cell = cellOf(site, sites), part = Manifold.intersection(whole, cell);
      for (const piece of part.decompose()) {
        const mesh = piece.getMesh();
        if (mesh.triVerts.length > 0) pieces.push({ vertices: mesh.vertProperties, faces: mesh.triVerts });
        piece.delete();
      }
      cell.delete(), part.delete();
    }
    return pieces;
  };
}

const models = { pumpkin: k.shapes.pumpkin(22), "letter R": k.shapes.letter("R", { depth: 0.4, resolution: 38 }), block: k.shapes.block([1, 1, 1], { edge: 0.035 }) };
console.log("model      program        pieces  closed  nearly  least ms  median ms  volume error");
for (const [name, model] of Object.entries(models)) {
  const single = volumeOf({ vertices: Float32Array.from(model.vertices), faces: model.faces }), double = volumeOf(model);
  for (const [program, prepare] of [["kerf", byKerf], ["three-pinata", byPinata], ["manifold-3d", byManifold]]) {
    const broken = prepare(model), times = [];
    let pieces = 0, closed = 0, nearly = 0, error = 0, reason = "";
    for (let seed = 1; seed <= runs; ++seed) {
      const start = performance.now();
      try {
        const parts = broken(seed);
        times.push(performance.now() - start);
        pieces += parts.length, closed += parts.filter((part) => isClosed(part)).length, nearly += parts.filter((part) => isClosed(part, 5)).length;
        const whole = program === "kerf" ? double : single;
        error = Math.max(error, Math.abs(parts.reduce((sum, part) => sum + volumeOf(part), 0) / whole - 1));
      } catch (problem) {
        reason = `seed ${seed}: ${String(problem.message ?? problem).slice(0, 60)}`;
      }
    }
    times.sort((a, b) => a - b);
    const n = times.length || 1;
    console.log(`${name.padEnd(10)} ${program.padEnd(14)} ${(pieces / n).toFixed(1).padStart(6)}  ${((100 * closed) / (pieces || 1)).toFixed(1).padStart(5)}%  ${((100 * nearly) / (pieces || 1)).toFixed(1).padStart(5)}%  ${(times[0] ?? NaN).toFixed(1).padStart(8)}  ${(times[n >> 1] ?? NaN).toFixed(1).padStart(9)}  ${error.toExponential(1)} ${reason}`);
  }
}
