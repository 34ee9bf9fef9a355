// Kerf for JavaScript: breaks and cuts solids. `const k = await kerf()`, then names as in Python.
import makeCore from "./kerf-core.js";
import { once } from "./load.js";

const started = once(makeCore);
let core = null;  // the module of WebAssembly, once it is loaded

// What a call failed with; `name` is InputError, GeometryError, Interrupted, RangeError or Error. */
export class KerfError extends Error {
  constructor(name, message) {
    super(message);
    this.name = name;
  }
}

// A result of the module, or the error that it stands for.
export function taken(result) {
  if (result !== null && typeof result === "object" && typeof result.failure === "string") throw new KerfError(result.failure, result.message);
  return result;
}
const call = (name, ...given) => taken(core[name](...given));

// ---- Arguments

export const wrong = (message) => new KerfError("InputError", message);
// An object whose class is one of these.
export function kind(given, name, words, ...classes) {
  if (!classes.some((one) => given instanceof one)) throw wrong(`${name}: give ${words}`);
  return given;
}
// Options whose names are known.
export function known(given, names, call) {
  for (const name of Object.keys(given ?? {}))
    if (!names.includes(name)) throw wrong(`${call}: there is no option '${name}'; there are ${names.join(", ")}`);
  return given ?? {};
}
const names = {
  crack: ["snap", "snapEdges", "faceOffset", "clearance", "jitter", "attempts", "seed"],
  pieces: ["hulls", "corners", "parts", "tile"],
  pattern: ["pattern", "attempts", "seed", "depth", "jagged", "frequency", "octaves", "edge", "axis", "impact", "cluster", "grain", "density", "image",
    "chips", "chipSize", "edgeDetail", "edgeWidth", "progress"],
  strike: ["direction", "milliseconds", "toughness", "maxPieces", "grading", "elongation", "hullParts", "hullCorners", "seed", "guard"],
};
const ofCracks = [...names.crack, ...names.pieces], ofPatterns = [...names.pattern, ...names.pieces], ofScores = ["pieces", ...ofPatterns];

// Calls with a function that hears of progress. It may stop the call by false, or by an error, which then ends the call.
function withProgress(progress, work) {
  if (progress === undefined || progress === null) return work(undefined);
  if (typeof progress !== "function") throw wrong("progress: give a function of phase, done and total");
  let problem = null;
  const report = (phase, done, total) => {
    try {
      return progress(phase, done, total) !== false;
    } catch (error) {
      problem = error;
      return false;
    }
  };
  try {
    return work(report);
  } catch (error) {
    throw problem ?? error;
  }
}

// ---- Memory: an object owns its part of the module's memory until delete(), or until nobody holds it

const forgotten = new FinalizationRegistry((handle) => handle.delete());
export const dispose = Symbol.dispose ?? Symbol.for("Symbol.dispose");

export class Owner {
  #handle;
  constructor(handle) {
    this.#handle = handle;
    forgotten.register(this, handle, this);
  }
  /** The object in the module. */
  get handle() {
    if (this.#handle === null) throw wrong(`this ${this.constructor.name} was deleted`);
    return this.#handle;
  }
  /** Frees its memory. */
  delete() {
    if (this.#handle === null) return;
    forgotten.unregister(this);
    this.#handle.delete();
    this.#handle = null;
  }
  [dispose]() { this.delete(); }
}

// ---- Arrays

// Numbers as a typed array of this kind: a typed array, an array, or an array of rows.
export function numbers(kind, given, name) {
  if (given instanceof kind) return given;
  if (ArrayBuffer.isView(given) && !(given instanceof DataView)) return kind.from(given);
  if (Array.isArray(given)) return kind.from(given.length > 0 && typeof given[0] === "object" ? given.flatMap((row) => [...row]) : given);
  throw wrong(`${name}: give a typed array, or an array of numbers or rows`);
}
const rows = (given, name) => numbers(Float64Array, given, name);
const whole = (given, name) => {
  const list = numbers(Float64Array, given, name);
  const at = list.findIndex((x) => !Number.isInteger(x) || x < 0 || x > 0xffffffff);
  if (at >= 0) throw wrong(`${name}: ${list[at]} is no index`);
  return Uint32Array.from(list);
};
const indices = (given, name) => (given instanceof Uint32Array ? given : whole(given, name));

// ---- Meshes

/** Triangles with attributes. Arrays are made once and shared: do not change them. */
export class Mesh extends Owner {
  #arrays = new Map();
  #measures = null;
  constructor(vertices, faces, attributes = {}) {
    super(vertices instanceof Made ? vertices.handle : makeMesh(vertices, faces, attributes));
  }
  #array(name) {
    if (!this.#arrays.has(name)) this.#arrays.set(name, call("meshArray", this.handle, name));
    return this.#arrays.get(name);
  }
  get #measured() { return (this.#measures ??= call("meshMeasures", this.handle)); }
  get vertices() { return this.#array("vertices"); }
  get faces() { return this.#array("faces"); }
  get uv() { return this.#array("uv"); }
  get normals() { return this.#array("normals"); }
  get colors() { return this.#array("colors"); }
  get groups() { return this.#array("groups"); }
  get groupNames() { return this.#array("groupNames"); }
  get patch() { return this.#array("patch"); }
  get site() { return this.#array("site"); }
  get source() { return this.#array("source"); }
  get volume() { return this.#measured.volume; }
  get area() { return this.#measured.area; }
  get centroid() { return this.#measured.centroid; }
  get inertia() { return this.#measured.inertia; }
  get bounds() { return this.#measured.bounds; }
  /** Metres of one unit, or undefined. */
  get unit() { return this.#measured.unit || undefined; }
  check() { return call("checkMesh", this.handle); }
  save(format) { return call("save", this.handle, String(format)); }
  /** Convex parts. */
  decomposition(given) { return call("hulls", this.handle, known(given, ["parts", "corners"], "decomposition")).map(meshOf); }
  /** The same shape with edges of at most `longest`. */
  refine(longest) {
    const made = meshOf(call("refined", this.handle, longest));
    return this instanceof Solid ? solidOf(made) : made;
  }
  /** The model, to be cracked; throws where the mesh is no valid model. */
  complex() { return new Complex(new Made(call("makeComplex", this.handle))); }
  crack(what, given) {
    const complex = this.complex();
    try {
      complex.crack(what, given);
    } catch (error) {
      complex.delete();
      throw error;
    }
    return complex;
  }
  /** The pieces into which a plane, sheet or front divides it. */
  split(what, given) { return piecesOf(this.crack(what, given), given); }
  cut(what, given) { return this.split(what, given); }
  /** The pieces of a pattern. */
  fracture(pieces = 20, given = {}) {
    const options = known(given, ofPatterns, "fracture"), complex = this.complex();
    try {
      const walls = score(complex, { ...options, pieces });
      complex.crack(walls);
      walls.delete();
    } catch (error) {
      complex.delete();
      throw error;
    }
    return piecesOf(complex, options);
  }
  /** Breaks it by a blow, finer near the point; Breakable is faster for a second one. */
  strike(point, energy, options = {}) {
    const prepared = new Breakable(this);
    try {
      return prepared.strike(point, energy, options);
    } finally {
      prepared.delete();
    }
  }
}

// A handle of the module, for constructors.
class Made {
  constructor(handle) { this.handle = handle; }
}
const meshOf = (handle) => new Mesh(new Made(handle));

function makeMesh(vertices, faces, attributes) {
  if (!(attributes instanceof Mesh)) known(attributes, ["uv", "normals", "colors", "groups", "groupNames"], "Mesh");
  const { uv, normals, colors, groups, groupNames } = attributes, given = {};
  for (const [name, value] of Object.entries({ uv, normals, colors })) if (value !== undefined) given[name] = rows(value, name);
  if (groups !== undefined) given.groups = numbers(Int32Array, groups, "groups"), given.groupNames = [...(groupNames ?? [])].map(String);
  return call("makeMesh", rows(vertices, "vertices"), indices(faces, "faces"), given);
}

/** A mesh that is a valid model: closed, oriented outwards, free of self-intersection. */
export class Solid extends Mesh {
  constructor(vertices, faces, attributes) {
    super(vertices instanceof Mesh ? new Made(vertices.handle.clone()) : vertices, faces, attributes);
    try {
      call("requireSolid", this.handle);
    } catch (error) {
      this.delete();
      throw error;
    }
  }
  /** Closes holes, turns shells outwards, unites parts that overlap. */
  static repaired(mesh, given) {
    const { handle } = kind(mesh, "repaired", "a Mesh", Mesh);
    return new Solid(new Made(call("repaired", handle, known(given, ["weld", "smooth"], "repaired"))));
  }
}
// A mesh as a Solid; an error where it is none. The mesh is freed.
function solidOf(mesh) {
  try {
    return new Solid(mesh);
  } finally {
    mesh.delete();
  }
}

/** A piece of a broken model. */
export class Piece extends Mesh {
  #told;
  constructor(told) {
    super(new Made(told.mesh));
    this.#told = { volume: told.volume, centroid: told.centroid, hulls: told.hulls.map(meshOf), index: told.index };
  }
  get index() { return this.#told.index; }
  get volume() { return this.#told.volume; }
  get centroid() { return this.#told.centroid; }
  get hulls() { return this.#told.hulls; }
  delete() {
    for (const hull of this.hulls) hull.delete();
    super.delete();
  }
}
// Of a complex that is then deleted.
function piecesOf(complex, given) {
  try {
    return complex.pieces(Object.fromEntries(Object.entries(given ?? {}).filter(([name]) => names.pieces.includes(name))));
  } finally {
    complex.delete();
  }
}

// ---- Cracks

/** A plane, for crack() and split(). */
export class Plane {
  constructor(point, normal) {
    this.point = rows(point, "point");
    this.normal = rows(normal, "normal");
  }
}
export const plane = (point, normal) => new Plane(point, normal);

/** A polyline that moves: the points of each step. */
export class Front {
  constructor(steps, given) {
    const { closed = false } = known(given, ["closed"], "Front");
    this.steps = [...steps].map((step) => rows(step, "steps"));
    this.closed = closed;
    if (this.steps.length < 2) throw wrong("steps: give two at least");
  }
}

/** The walls of a pattern: a sheet that divides a model. */
export class Score {
  constructor({ sheet, pieces, chips, attempts }) {
    this.sheet = meshOf(sheet), this.pieces = pieces, this.chips = chips, this.attempts = attempts;
  }
  delete() { this.sheet.delete(); }
  [dispose]() { this.delete(); }
}

// Brightness from 0 to 1 of an image: one number up to 255 a pixel, or four, as a canvas has it, of which the last makes it white.
function brightness({ data, width, height }) {
  const pixels = width * height;
  if (data?.length === pixels) return Float32Array.from(data, (value) => value / 255);
  if (data?.length !== 4 * pixels)
    throw wrong("image: data has neither one nor four numbers for each of width x height pixels; give an ImageData");
  return Float32Array.from({ length: pixels }, (_, i) => {
    const [red, green, blue, alpha] = data.subarray(4 * i, 4 * i + 4);
    return 1 - (alpha / 255) * (1 - (red + green + blue) / 765);
  });
}

/** Looks for a pattern that divides a model into as many pieces as wanted. */
export function score(model, given = {}) {
  kind(model, "score", "a Solid, a Mesh or a Complex", Mesh, Complex);
  const { progress, ...rest } = known(given, ofScores, "score");
  if (rest.density !== undefined && typeof rest.density !== "string") rest.density = Float64Array.from(rest.density);
  if (rest.image !== undefined) rest.image = { width: rest.image.width, height: rest.image.height, brightness: brightness(rest.image) };
  if (rest.impact !== undefined) rest.impact = rows(rest.impact, "impact");
  const complex = model instanceof Complex ? model : model.complex();
  try {
    return new Score(withProgress(progress, (report) => call("score", complex.handle, rest, report)));
  } finally {
    if (complex !== model) complex.delete();
  }
}

/** A front in a complex, advanced step by step. */
export class FrontState extends Owner {
  constructor(handle) { super(handle); }
  get crack() { return call("frontCrack", this.handle); }
  advance(points, given) { return call("advance", this.handle, rows(points, "points"), known(given, ofCracks, "advance")); }
}

/** A cracked model; it changes by its methods. */
export class Complex extends Owner {
  constructor(model) {
    super(model instanceof Made ? model.handle : call("makeComplex", kind(model, "Complex", "a Solid, or a Mesh that is a valid model", Mesh).handle));
  }
  #last = 0;  // the largest number of a front
  copy() { return new Complex(new Made(call("copyComplex", this.handle))); }
  get faceCount() { return call("counts", this.handle).faces; }
  get vertexCount() { return call("counts", this.handle).vertices; }
  get crackCount() { return call("counts", this.handle).cracks; }
  get diagonal() { return call("counts", this.handle).diagonal; }
  get bonds() { return call("bonds", this.handle); }
  /** The two-sided surface, with patch, site and source. */
  surface() { return meshOf(call("surface", this.handle)); }
  /** What is wrong with it, or an empty text. */
  check() { return call("checkComplex", this.handle); }
  /** Cuts along a score, mesh, plane or front, or a list of these. */
  crack(what, given) {
    const options = known(given, ofCracks, "crack");
    for (const one of Array.isArray(what) ? what : [what]) {
      if (one instanceof Front) this.#sweep(one, options);
      else this.insert(one, options);
    }
    return this;
  }
  #sweep({ steps, closed }, options) {
    const front = this.front(steps[0], { closed });
    try {
      for (const step of steps.slice(1)) front.advance(step, options);
    } finally {
      front.delete();
    }
  }
  insert(sheet, given) {
    const options = known(given, ofCracks, "insert");
    if (sheet instanceof Score) return this.insert(sheet.sheet, options);
    if (sheet instanceof Mesh) return call("insert", this.handle, sheet.handle, options);
    if (!(sheet instanceof Plane)) throw wrong("crack: give a Score, Mesh, Plane or Front");
    const made = meshOf(call("planeSheet", this.handle, sheet.point, sheet.normal));
    try {
      return this.insert(made, options);
    } finally {
      made.delete();
    }
  }
  front(points, given) {
    const { closed = false } = known(given, ["closed"], "front");
    const front = new FrontState(call("beginFront", this.handle, rows(points, "points"), Boolean(closed), this.#last + 1));
    this.#last = front.crack;
    return front;
  }
  undo() { call("undo", this.handle); }
  /** Heals pieces below a volume to their neighbours. This and the next three end the fronts of the complex. */
  joinSmallPieces(least) {
    call("joinSmallPieces", this.handle, least);
    return this;
  }
  /** Improves thin faces; this and the next two cannot be undone. */
  remesh(given) { return this.#edit("remesh", given, ["angle", "deviation"]); }
  /** Displaces the inner vertices of cracks by noise. */
  roughen(given) { return this.#edit("roughen", given, ["amplitude", "frequency", "octaves", "seed"]); }
  /** Collapses edges where the surface moves by little. */
  decimate(given) { return this.#edit("decimate", given, ["deviation", "faces"]); }
  #edit(name, given, allowed) {
    const { progress, ...rest } = known(given, [...allowed, "progress"], name);
    return withProgress(progress, (report) => call(name, this.handle, rest, report));
  }
  pieces(given) { return call("pieces", this.handle, known(given, ofCracks, "pieces")).map((told, index) => new Piece({ ...told, index })); }
  hierarchy(levels) { return call("hierarchy", this.handle, levels); }
  save(format, given) {
    const options = known(given, ["corners", "parts", "tile", "zUp"], "save");
    if (format === "glb" || format === "usda") return call("savePieces", this.handle, format, options);
    const surface = this.surface();
    try {
      return surface.save(format);
    } finally {
      surface.delete();
    }
  }
}

// ---- Impacts

/** A solid that is prepared to be broken where it is hit. Making it is the slow part of an impact. */
export class Breakable extends Owner {
  #mesh = null;
  constructor(solid) {
    const { handle } = kind(solid, "solid", "a Solid, or a Mesh that is a valid model", Made, Mesh);
    super(solid instanceof Made ? handle : call("makeBreakable", handle));
  }
  /** Its mesh, made once: delete() of this object frees it. */
  get mesh() { return (this.#mesh ??= meshOf(call("breakableMesh", this.handle))); }
  get volume() { return call("breakableVolume", this.handle); }
  strike(point, energy, given) {
    const { milliseconds = Infinity, ...rest } = known(given, names.strike, "strike");
    if (rest.direction !== undefined) rest.direction = rows(rest.direction, "direction");
    const breaking = new Breaking(new Made(call("strike", this.handle, rows(point, "point"), energy, rest)));
    try {
      breaking.advance(milliseconds);
    } catch (error) {
      breaking.delete();
      throw error;
    }
    return breaking;
  }
  delete() {
    this.#mesh?.delete();
    super.delete();
  }
}

/** A part of a break; `divided`, `whole` and `hulls` follow it. */
export class BrokenPart {
  constructor(made, index) {
    this.index = index, this.solid = new Breakable(new Made(made.solid)), this.parent = made.parent < 0 ? null : made.parent;
    this.volume = made.volume, this.centroid = made.centroid, this.divided = false, this.whole = false, this.hulls = [];
  }
  get mesh() { return this.solid.mesh; }
}

/** A break that goes on from call to call: after each, its pieces fill the solid. */
export class Breaking extends Owner {
  #parts = [];
  constructor({ handle }) { super(handle); }
  finished = false;
  /** Goes on for about this time, for one step at least; returns whether it is finished. */
  advance(milliseconds) {
    this.finished = call("advanceBreaking", this.handle, milliseconds);
    call("partStates", this.handle).forEach((state, index) => {
      const part = (this.#parts[index] ??= new BrokenPart(call("partMade", this.handle, index), index));
      if (state & 2 && !part.whole) part.hulls = call("partHulls", this.handle, index).map(meshOf);
      part.divided = (state & 1) !== 0, part.whole = (state & 2) !== 0;
    });
    return this.finished;
  }
  /** All parts, in the order in which they came out; the first is the solid. */
  get parts() { return [...this.#parts]; }
  /** The parts that are not divided. */
  get pieces() { return this.#parts.filter(({ divided }) => !divided); }
  /** Frees the parts, their meshes and hulls, too. */
  delete() {
    for (const { solid, hulls } of this.#parts) solid.delete(), hulls.forEach((hull) => hull.delete());
    super.delete();
  }
}

// ---- Files and shapes

/** Reads OBJ, PLY, STL, OFF or GLB: a Solid, or a Mesh where it is no valid model. */
export function load(bytes, format = "") {
  const data = bytes instanceof ArrayBuffer ? new Uint8Array(bytes) : bytes;
  if (!(data instanceof Uint8Array)) throw wrong("load: give the bytes of a file, as a Uint8Array or ArrayBuffer");
  if (typeof format !== "string") throw wrong("format: give a text, such as 'glb', or the file's name");
  const { mesh, notes } = call("load", data, format.includes(".") ? format : `model${format ? "." : ""}${format}`);
  const made = meshOf(mesh);
  let result = made;
  try {
    result = new Solid(made);
    made.delete();
  } catch (error) {
    if (!(error instanceof KerfError)) throw error;
  }
  result.notes = notes;
  return result;
}

const shape = (name, given) => new Solid(new Made(call("shape", name, given)));
/** Shapes to try things with. */
export const shapes = {
  block: (size = [1, 1, 1], given) => shape("block", { ...known(given, ["edge"], "block"), size: rows(size, "size") }),
  sphere: (frequency = 8) => shape("sphere", { frequency }),
  pumpkin: (frequency = 16) => shape("pumpkin", { frequency }),
  apple: (frequency = 16) => shape("apple", { frequency }),
  polyp: (frequency = 12) => shape("polyp", { frequency }),
  letter: (letter, given) => shape("letter", { ...known(given, ["depth", "resolution"], "letter"), letter }),
};

// ---- Beginning

/** Begins a simulation; loads its module first. */
async function simulation(scene, options) {
  const { begin } = await import("./simulation.js");
  return begin(scene, options, { Mesh, rows, numbers, taken, Owner, known, wrong, withProgress });
}

const api = {
  Mesh, Solid, Piece, Plane, Front, Score, Complex, FrontState, Breakable, Breaking, BrokenPart, KerfError, plane, score, load, shapes, simulation,
  patterns: ["planes", "crossing", "voronoi", "radial", "glass", "wood", "bricks", "curves"],
  /** Bytes of the module's heap that are in use. */
  usedBytes: () => core.usedBytes(),
};

/** Loads the module, once. `wasm`: where it is, or its bytes; by default beside this file. */
export default async function kerf(given) {
  const { wasm } = known(given, ["wasm"], "kerf");
  core = await started(wasm ?? new URL("./kerf-core.wasm", import.meta.url));
  return api;
}
