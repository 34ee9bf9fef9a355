// A program that has to fit the types, with lines that must not: tests/js/types.mjs.
import kerf, { type Kerf, type KerfError, type Mesh, type Piece, type Breaking } from "kerf";

const k: Kerf = await kerf();
const cube = k.shapes.block([1, 1, 1], { edge: 0.5 });
const pieces: Piece[] = cube.fracture(30, { seed: 7, jagged: 0.02, pattern: "voronoi", hulls: true, progress: (phase, done) => done < 9 });
const volume: number = pieces.reduce((sum, piece) => sum + piece.volume + piece.hulls.length, 0);
const mesh: Mesh = new k.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], new Uint32Array([0, 1, 2]), { uv: new Float32Array(6), groups: [0], groupNames: ["a"] });
const [upper, lower] = cube.split(k.plane([0, 0, 0.5], [0, 0, 1]));
const glass = new k.Breakable(cube);
const breaking: Breaking = glass.strike([1, 0.5, 0.5], 900, { direction: [-1, 0, 0], milliseconds: 4 });
while (!breaking.finished) breaking.advance(4);
const parent: number | null = breaking.pieces[0].parent;
breaking.pieces[0].solid.strike(breaking.pieces[0].centroid, volume);
const complex = cube.crack([k.score(cube, { pieces: 3 }), new k.Front([[[0, 0, 0], [1, 0, 0]], [[0, 1, 0], [1, 1, 0]]])]);
const bytes: Uint8Array = complex.save("glb", { zUp: true });
const run = await k.simulation("[body]", { models: [cube, upper, lower], set: { "material.young": 2e5 } });
const elastic: number = run.step().elastic + run.addBlade([[0, 0, 0]], [0, 0, 1]).index;
run.strike([0, 0, 1], { cells: 5 });
mesh[Symbol.dispose]();
try {
  k.load(bytes, "glb").delete();
} catch (error) {
  console.log((error as KerfError).message, elastic, parent);
}

// @ts-expect-error: no such pattern
cube.fracture(3, { pattern: "vornoi" });
// @ts-expect-error: no such option
glass.strike([0, 0, 0], 1, { toughnes: 3 });
// @ts-expect-error: a string is no mesh
new k.Solid("cube.obj");
// @ts-expect-error: arrays belong to the mesh
cube.vertices = new Float64Array(3);
// @ts-expect-error: the energy is missing
glass.strike([0, 0, 0]);
// @ts-expect-error: no such option
run.strike([0, 0, 1], { pieces: 5 });
// @ts-expect-error: no file of this kind is written
complex.save("fbx");
