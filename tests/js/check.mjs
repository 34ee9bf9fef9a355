// The npm package as a program uses it: shapes, pieces, hulls, bonds, files, errors, memory.
//   node check.mjs [NATIVE_OUTCOMES]
import assert from "node:assert/strict";
import kerf from "kerf";

// A start that fails may be made again; two at once start one module.
await assert.rejects(kerf({ wasm: new Uint8Array([1, 2, 3]) }));
await assert.rejects(kerf({ wsam: "" }), { name: "InputError", message: /wasm/ });
const [k, again] = await Promise.all([kerf(), kerf()]);
assert.equal(again.shapes.block([1, 1, 1]).split(k.plane([0, 0, 0.5], [0, 0, 1])).length, 2);
const near = (a, b, share = 1e-9) => assert.ok(Math.abs(a - b) <= share * Math.abs(b), `${a} is not ${b}`);
const sum = (list) => list.reduce((total, x) => total + x, 0);
const free = (list) => list.forEach((object) => object.delete());

const tests = {
  "cells are many where the density is high, and chips are pieces beside them"() {
    const cube = k.shapes.block([1, 1, 1], { edge: 0.1 });
    const [high, low] = [[1, 0.05], [0.05, 1]].map(([above, below]) => {
      const density = Array.from({ length: cube.vertices.length / 3 }, (_, v) => (cube.vertices[3 * v + 2] > 0.5 ? above : below));
      const pieces = cube.fracture(24, { density, seed: 3 });
      const count = pieces.filter((piece) => piece.vertices.some((x, i) => i % 3 === 2 && x > 0.6)).length;
      free(pieces);
      return count;
    });
    assert.ok(high > 0.8 * 24 && low < 0.7 * 24, `${high} and ${low} of 24 reach above the middle`);
    const walls = k.score(cube, { pieces: 5, chips: 6, chipSize: 0.2, edgeDetail: 0.004, seed: 3 });
    assert.equal(walls.chips, 6);
    const broken = cube.crack(walls), chipped = broken.pieces();
    assert.equal(chipped.length, walls.pieces + 6);
    near(sum(chipped.map((piece) => piece.volume)), 1);
    free([...chipped, broken, walls, cube]);
  },
  "a black square of an image is cut out"() {
    const cube = k.shapes.block([1, 1, 1]), width = 64, height = 64;
    const gray = Uint8Array.from({ length: 64 * 64 }, (_, i) => (i % 64 >= 16 && i % 64 < 48 && i >= 16 * 64 && i < 48 * 64 ? 0 : 255));
    const colors = Uint8ClampedArray.from({ length: 4 * gray.length }, (_, i) => (i % 4 === 3 ? 255 : gray[i >> 2]));
    for (const data of [gray, colors]) {
      const pieces = cube.fracture(2, { pattern: "curves", image: { data, width, height } });
      assert.equal(pieces.length, 2);
      near(sum(pieces.map((piece) => piece.volume)), 1);
      near(Math.min(...pieces.map((piece) => piece.volume)), 0.25, 0.05); // outlines leave the border by half a pixel
      free(pieces);
    }
    const fails = (options) => assert.throws(() => cube.fracture(2, options), { name: "InputError" });
    fails({ pattern: "curves" });
    fails({ image: { data: gray, width, height } });
    fails({ pattern: "curves", image: { data: gray, width: 65, height } });
    cube.delete();
  },
  "a cube breaks into closed pieces whose volumes add up"() {
    const cube = k.shapes.block([1, 1, 1]);
    const pieces = cube.fracture(30, { seed: 7, hulls: true });
    assert.equal(pieces.length, 30);
    near(sum(pieces.map((piece) => piece.volume)), 1);
    for (const piece of pieces) {
      assert.ok(piece.check().good && piece.hulls.length >= 1);
      assert.ok(piece.hulls[0].volume >= piece.volume * (1 - 1e-9));
      assert.equal(piece.patch.length, piece.faces.length / 3);
    }
    free(pieces), cube.delete();
  },
  "a plane splits, and inner faces are a group of their own"() {
    const cube = k.shapes.block([1, 1, 1]);
    const halves = cube.split(k.plane([0, 0, 0.25], [0, 0, 1]));
    near(halves[0].volume, 0.75), near(halves[1].volume, 0.25);
    assert.ok(halves[0].groupNames.includes("crack"));
    const shelf = halves[1].faces.filter((_, i) => halves[1].patch[Math.floor(i / 3)] !== 0);
    assert.ok(shelf.length > 0 && shelf.every((v) => Math.abs(halves[1].vertices[3 * v + 2] - 0.25) < 1e-12));
    free(halves), cube.delete();
  },
  "typed arrays go in and come out to the bit"() {
    const vertices = new Float64Array([0, 0, 0, 1 / 3, 0, 0, 0, 1 / 7, 0, 0, 0, Math.PI]), faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    const solid = new k.Solid(vertices, faces, { uv: [[0, 0], [1, 0], [0, 1], [1, 1]], groups: [0, 0, 1, 0], groupNames: ["wall", "slope"] });
    assert.deepEqual(solid.vertices, vertices);
    assert.deepEqual([...solid.faces], faces.flat());
    assert.equal(solid.uv.length, 4 * 3 * 2);
    near(solid.volume, Math.PI / 3 / 7 / 6);
    const pieces = solid.fracture(3, { pattern: "planes", axis: "z" });
    assert.ok(pieces.every((piece) => piece.uv.length === 2 * piece.faces.length && piece.groupNames.includes("slope")));
    free(pieces), solid.delete();
  },
  "a blow breaks a solid finer near it, within budgets, again and again"() {
    const cube = k.shapes.block([1, 1, 1], { edge: 0.1 }), glass = new k.Breakable(cube);
    const blow = [[1, 0.5, 0.5], 1500, { direction: [-1, 0, 0] }];
    const breaking = glass.strike(...blow);
    assert.ok(breaking.finished && breaking.pieces.length > 5);
    near(sum(breaking.pieces.map(({ volume }) => volume)), 1);
    for (const { mesh, volume, hulls, whole } of breaking.pieces) {
      assert.ok(whole && hulls.length === 1 && hulls[0].volume >= volume * (1 - 1e-9));
      assert.ok(mesh.check().closed && mesh.groupNames.includes("crack"));
      near(mesh.volume, volume);
    }
    const mean = (list) => sum(list.map(({ volume }) => volume)) / list.length;
    const at = (test) => breaking.pieces.filter(({ centroid }) => test(centroid[0]));
    assert.ok(mean(at((x) => x > 0.7)) < 0.5 * mean(at((x) => x < 0.4)));
    const slow = glass.strike(blow[0], blow[1], { ...blow[2], milliseconds: 0 });
    let calls = 0;
    for (; !slow.finished; calls++) near(sum(slow.pieces.map(({ volume }) => volume)), 1), slow.advance(0);
    assert.ok(calls > 5 && slow.parts[0].parent === null && slow.parts[0].divided);
    const part = breaking.pieces.reduce((a, b) => (a.volume > b.volume ? a : b)), again = part.solid.strike(part.centroid, 300);
    near(sum(again.pieces.map(({ volume }) => volume)), part.volume);
    assert.ok(again.pieces.length > 1);
    assert.equal(cube.strike([1, 1, 1], 0).pieces.length, 1);
    const refused = (work, words) => assert.throws(work, (error) => error.name === "InputError" && words.test(error.message));
    refused(() => glass.strike([0, 0], 1), /point/), refused(() => glass.strike([0, 0, 0], -1), /energy/);
    refused(() => glass.strike([0, 0, 0], "1"), /energy/), refused(() => glass.strike([0, 0, 0], 1, { maxPieces: 1 }), /maxPieces/);
    refused(() => glass.strike([0, 0, 0], 1, { milliseconds: -1 }), /milliseconds/), refused(() => new k.Breakable("cube"), /Solid/);
    free([breaking, slow, again, glass, cube]);
    refused(() => slow.advance(1), /deleted/);
  },
  "files of each format come back"() {
    const pumpkin = k.shapes.pumpkin(4);
    for (const format of ["ply", "off", "obj", "stl", "glb"]) {
      const again = k.load(pumpkin.save(format), format);
      assert.ok(again instanceof k.Solid, format);
      near(again.volume, pumpkin.volume, 1e-6);
      if (format === "ply" || format === "off") assert.deepEqual(again.vertices, pumpkin.vertices);
      again.delete();
    }
    const complex = pumpkin.crack(k.score(pumpkin, { pieces: 4 }));
    const glb = complex.save("glb");
    assert.equal(new TextDecoder().decode(glb.subarray(0, 4)), "glTF");
    const json = JSON.parse(new TextDecoder().decode(glb.subarray(20, 20 + new DataView(glb.buffer).getUint32(12, true))));
    assert.equal(json.nodes.filter(({ name }) => /^piece_\d+$/.test(name)).length, 4);
    assert.ok(complex.bonds.length >= 3 && complex.bonds.every(({ area, normal }) => area > 0 && Math.abs(Math.hypot(...normal) - 1) < 1e-12));
    assert.equal(complex.hierarchy(2)[0].volume.length, 1);
    assert.equal(complex.check(), "");
    complex.delete(), pumpkin.delete();
  },
  "a front cuts step by step, and a step can be undone"() {
    const cube = k.shapes.block([1, 1, 1]), complex = cube.complex();
    const line = (y) => [[-0.2, y, 0.51], [0.5, y, 0.49], [1.2, y, 0.5]];
    const front = complex.front(line(-0.1));
    assert.ok(front.advance(line(0.5)).newCrackFaces.length > 0);
    const before = complex.faceCount;
    front.advance(line(1.1));
    assert.equal(complex.pieces().length, 2);
    complex.undo();
    assert.equal(complex.faceCount, before);
    const swept = cube.split(new k.Front([line(-0.1), line(0.5), line(1.1)]));
    assert.equal(swept.length, 2);
    free(swept), front.delete(), complex.delete(), cube.delete();
  },
  "a front that was undone goes on from where it was"() {
    const cube = k.shapes.block([1, 1, 1]), line = (y) => [[-0.2, y, 0.51], [0.5, y, 0.49], [1.2, y, 0.5]];
    for (const steps of [[-0.1, 0.5], [-0.1, 0.5, 0.8]]) {
      const complex = cube.complex(), front = complex.front(line(steps[0]));
      for (const y of steps.slice(1)) front.advance(line(y));
      complex.undo();
      front.advance(line(1.1));
      const pieces = complex.pieces();
      assert.equal(pieces.length, 2);
      assert.equal(complex.check(), "");
      free([...pieces, front, complex]);
    }
    cube.delete();
  },
  "a complex is made rougher, coarser, and its crumbs are healed"() {
    const pumpkin = k.shapes.pumpkin(6), complex = pumpkin.crack(k.score(pumpkin, { pieces: 12, seed: 2 }));
    const volumes = () => complex.pieces().map((piece) => [piece.volume, piece.delete()][0]);
    const before = volumes(), front = complex.front([[-2, -2, 0.1], [2, -2, 0.1]]);
    assert.ok(complex.roughen({ amplitude: 0.01, frequency: 10, seed: 3 }).newFaces.length > 0);
    near(sum(volumes()), sum(before));
    assert.throws(() => front.advance([[-2, 0, 0.1], [2, 0, 0.1]]), { name: "InputError", message: /ended/ });
    assert.throws(() => complex.undo(), { name: "GeometryError", message: /whole complex/ });
    const count = complex.faceCount;
    assert.throws(() => complex.decimate({ deviation: 0.01, progress: () => false }), { name: "Interrupted" });
    assert.equal(complex.faceCount, count);
    complex.decimate({ deviation: 0.01 });
    assert.ok(complex.faceCount < count);
    complex.remesh({ angle: 10 });
    const least = 1.001 * before[8], after = complex.joinSmallPieces(least);
    assert.equal(after, complex);
    assert.ok(volumes().length < before.length && volumes().every((volume) => volume >= least));
    assert.equal(complex.check(), "");
    const cube = k.shapes.block([1, 1, 1]), fine = cube.refine(0.1);
    assert.ok(fine instanceof k.Solid && fine.faces.length > cube.faces.length);
    near(fine.volume, 1);
    free([front, complex, pumpkin, cube, fine]);
  },
  "wrong input is an error with a sentence"() {
    const fails = (work, name, words) => assert.throws(work, (error) => error instanceof k.KerfError && error.name === name && words.test(error.message));
    const cube = k.shapes.block([1, 1, 1]);
    fails(() => new k.Solid(cube.vertices, cube.faces.subarray(3)), "InputError", /open.*Solid\.repaired/);
    fails(() => new k.Mesh([0, 0], [0, 0, 0]), "InputError", /three numbers/);
    fails(() => new k.Mesh([0, 0, NaN], [[0, 0, 0]]), "InputError", /finite/);
    fails(() => new k.Mesh([0, 0, 0], [[0, 1, 0]]), "InputError", /vertex 1/);
    fails(() => new k.Mesh([0, 0, 0], [[0, -1, 0]]), "InputError", /no index/);
    fails(() => cube.fracture(0), "InputError", /pieces/);
    fails(() => cube.fracture(3, { pattern: "vornoi" }), "InputError", /voronoi/);
    fails(() => cube.fracture(3, { seed: -1 }), "InputError", /seed/);
    fails(() => cube.fracture(3, { chipSize: 0.2 }), "InputError", /chipSize changes nothing without chips/);
    fails(() => cube.fracture(3, { density: "grey" }), "InputError", /luminance/);
    fails(() => cube.fracture(3, { density: [1, 2] }), "InputError", /2 values/);
    fails(() => cube.fracture(3, { pattern: "planes", density: "red" }), "InputError", /voronoi and wood/);
    fails(() => cube.split(k.plane([0, 0, 0], [0, 0, 0])), "InputError", /normal/);
    fails(() => cube.split("z"), "InputError", /Plane/);
    fails(() => k.load(new Uint8Array([1, 2, 3])), "InputError", /./);
    fails(() => k.load("cube.obj"), "InputError", /bytes/);
    fails(() => cube.save("fbx"), "InputError", /fbx/);
    fails(() => k.shapes.block([1, -1, 1]), "InputError", /./);
    fails(() => cube.complex().front([[0, 0, 0]]), "InputError", /two/);
    fails(() => cube.fracture(5, { peices: 3 }), "InputError", /no option 'peices'; there are pattern, /);
    fails(() => cube.fracture(5, { pieces: 3 }), "InputError", /no option 'pieces'/);
    fails(() => cube.strike([1, 1, 1], 1, { budget: 4 }), "InputError", /milliseconds/);
    fails(() => cube.split(k.plane([0, 0, 0.5], [0, 0, 1]), { snapp: 1 }), "InputError", /snap, /);
    fails(() => k.score([1, 2]), "InputError", /Solid/), fails(() => k.Solid.repaired(), "InputError", /Mesh/);
    fails(() => new k.Complex(), "InputError", /Solid/), fails(() => k.load(cube.save("ply"), 7), "InputError", /glb/);
    fails(() => cube.fracture(5, { progress: "x" }), "InputError", /function/), fails(() => cube.save(), "InputError", /glb/);
    fails(() => cube.fracture("5"), "InputError", /from 1 to 1000000$/), fails(() => cube.decomposition({ parts: 0 }), "InputError", /parts/);
    fails(() => k.shapes.block([1, 1, 1], { edge: 1e-6 }), "InputError", /20 million/), fails(() => k.shapes.sphere(2.5), "InputError", /whole/);
    fails(() => cube.refine(0), "InputError", /above 0/), fails(() => new k.Mesh([0, 0, 0], [], { uvs: [] }), "InputError", /uv, /);
    const holes = new k.Mesh(cube.vertices, cube.faces.subarray(3));
    assert.equal(holes.check().closed, false);
    fails(() => holes.complex(), "InputError", /or try Solid\.repaired\(\)$/);
    fails(() => new k.Breakable(holes), "InputError", /or try Solid\.repaired\(\)$/);
    const mended = k.Solid.repaired(holes);
    near(mended.volume, 1);
    mended.delete(), holes.delete(), cube.delete();
    fails(() => cube.volume, "InputError", /deleted/);
    cube.delete();
  },
  "progress is told, stops a call, and passes errors on"() {
    const cube = k.shapes.block([1, 1, 1]);
    let told = 0;
    k.score(cube, { pieces: 5, progress: () => void told++ }).delete();
    assert.ok(told > 0);
    assert.throws(() => k.score(cube, { progress: () => false }), { name: "Interrupted" });
    assert.throws(() => k.score(cube, { progress() { throw new TypeError("mine"); } }), { name: "TypeError", message: "mine" });
    cube.delete();
  },
  "memory is freed by delete(), and where nobody holds an object"() {
    const round = () => {
      const pumpkin = k.shapes.pumpkin(6), pieces = pumpkin.fracture(6, { hulls: true }), again = k.load(pieces[0].save("ply"));
      assert.throws(() => new k.Solid(pumpkin.vertices, pumpkin.faces.subarray(3)));
      pumpkin.strike([1, 0, 0], 2000).delete();
      free(pieces), again.delete(), pumpkin.delete();
    };
    round();
    const before = k.usedBytes();
    for (let i = 0; i < 10; i++) round();
    assert.ok(k.usedBytes() - before < 4096, `${k.usedBytes() - before} bytes are left`);
  },
};

for (const [name, test] of Object.entries(tests)) {
  const started = performance.now();
  test();
  console.log(`${name}: ${(performance.now() - started).toFixed(0)} ms`);
}
