// Types of Kerf for JavaScript, for TypeScript 4.7 and later.

/** Rows of numbers: a typed array, an array of numbers, or an array of rows. */
export type Rows = ArrayLike<number> | ReadonlyArray<ArrayLike<number>>;
/** Hears of a phase, the work done and the whole work; false stops the call. */
export type Progress = (phase: string, done: number, total: number) => boolean | void;

/** What a call failed with. */
export class KerfError extends Error {
  name: "InputError" | "GeometryError" | "Interrupted" | "RangeError" | "Error";
}

// TypeScript knows it from 5.2 on.
declare global {
  interface SymbolConstructor {
    readonly dispose: unique symbol;
  }
}
/** An object with memory of its own, which delete() frees; `using` does, too. */
interface Owner {
  delete(): void;
  [Symbol.dispose](): void;
}

export interface Attributes {
  /** Rows for each vertex, or for each corner of each face. */
  uv?: Rows;
  normals?: Rows;
  /** Red, green, blue and alpha, from 0 to 1. */
  colors?: Rows;
  /** An index of groupNames for each face. */
  groups?: ArrayLike<number>;
  groupNames?: ReadonlyArray<string>;
}
export interface SurfaceReport {
  closed: boolean;
  manifold: boolean;
  oriented: boolean;
  degenerateFaces: number;
  firstProblem: string;
  good: boolean;
}

/** Tolerances, relative to the diagonal of the model's box. */
export interface CrackOptions {
  snap?: number;
  snapEdges?: number;
  faceOffset?: number;
  clearance?: number;
  jitter?: number;
  attempts?: number;
  seed?: number;
}
export type Pattern = "planes" | "crossing" | "voronoi" | "radial" | "glass" | "wood" | "bricks" | "curves";
export interface FractureOptions extends PieceOptions {
  pattern?: Pattern;
  attempts?: number;
  seed?: number;
  /** Below 1: walls are cut in only as deep as this fraction of their greatest depth. */
  depth?: number;
  /** Amplitude of bumps, a fraction of the diagonal; 0: flat. */
  jagged?: number;
  /** Bumps per diagonal. */
  frequency?: number;
  octaves?: number;
  edge?: number;
  axis?: "x" | "y" | "z" | ArrayLike<number>;
  /** Where cracks meet, or cells are small. */
  impact?: ArrayLike<number>;
  cluster?: number;
  grain?: number;
  /** voronoi, wood: where cells are many, a channel of the model's colours or a value of at least 0 for each vertex. */
  density?: "red" | "green" | "blue" | "alpha" | "luminance" | ArrayLike<number>;
  /** curves: the borders of its black areas, along `axis`. Brightness up to 255 of each pixel, or red, green, blue, alpha, as a canvas has them. */
  image?: { data: Uint8Array | Uint8ClampedArray; width: number; height: number };
  /** Small pieces that break off edges, beside the number of pieces. */
  chips?: number;
  /** Their length, a fraction of the cube root of the mean piece's volume. */
  chipSize?: number;
  /** Height of finer bumps near the skin, a fraction of the diagonal; 0: none. */
  edgeDetail?: number;
  /** Their depth, a fraction of the diagonal. */
  edgeWidth?: number;
  progress?: Progress;
}
export interface ScoreOptions extends FractureOptions {
  pieces?: number;
}
export interface PieceOptions {
  /** Whether pieces have convex hulls. */
  hulls?: boolean;
  /** Most corners of a hull. */
  corners?: number;
  /** Most hulls of a piece. */
  parts?: number;
  /** Side of a texture tile on inner faces, a fraction of the diagonal. */
  tile?: number;
}
export type Crack = Score | Mesh | Plane | Front;

export interface Mesh extends Owner {}
/** Triangles with attributes. Arrays are made once and shared: do not change them. */
export class Mesh {
  constructor(vertices: Rows, faces: Rows, attributes?: Attributes);
  /** Three coordinates for each vertex. */
  readonly vertices: Float64Array;
  /** Three vertices for each face. */
  readonly faces: Uint32Array;
  /** Two numbers for each corner of each face. */
  readonly uv: Float64Array | undefined;
  readonly normals: Float64Array | undefined;
  readonly colors: Float64Array | undefined;
  readonly groups: Int32Array | undefined;
  readonly groupNames: string[];
  /** For each face: 0 on the skin, +c and −c on the two sides of crack c. */
  readonly patch: Int32Array | undefined;
  readonly site: Uint32Array | undefined;
  /** For each face: that of the model which contains it, or 2³²−1 on a crack. */
  readonly source: Uint32Array | undefined;
  readonly volume: number;
  readonly area: number;
  readonly centroid: Float64Array;
  /** About the centroid, for a density of 1: nine numbers. */
  readonly inertia: Float64Array;
  /** Lowest and highest corner. */
  readonly bounds: Float64Array;
  /** Metres of one unit, where the file says so. */
  readonly unit: number | undefined;
  /** What load() left out or assumed. */
  readonly notes?: string[];
  check(): SurfaceReport;
  save(format: "ply" | "obj" | "glb" | "stl" | "off"): Uint8Array;
  complex(): Complex;
  crack(what: Crack | ReadonlyArray<Crack>, options?: CrackOptions): Complex;
  split(what: Crack | ReadonlyArray<Crack>, options?: CrackOptions & PieceOptions): Piece[];
  cut(what: Crack | ReadonlyArray<Crack>, options?: CrackOptions & PieceOptions): Piece[];
  fracture(pieces?: number, options?: FractureOptions): Piece[];
  /** Breaks it by a blow of an energy, J; a Breakable is faster for a second one. */
  strike(point: ArrayLike<number>, energy: number, options?: StrikeOptions): Breaking;
  /** The same shape with edges of at most `longest`: attributes are interpolated. */
  refine(longest: number): this;
  /** Convex parts. */
  decomposition(options?: { parts?: number; corners?: number }): Mesh[];
}
/** A mesh that is a valid model: closed, oriented outwards, free of self-intersection. */
export class Solid extends Mesh {
  constructor(vertices: Rows, faces: Rows, attributes?: Attributes);
  constructor(mesh: Mesh);
  static repaired(mesh: Mesh, options?: { weld?: number; smooth?: boolean }): Solid;
}
/** A piece of a broken model. */
export class Piece extends Mesh {
  private constructor();
  readonly index: number;
  readonly hulls: Mesh[];
}
export class Plane {
  constructor(point: ArrayLike<number>, normal: ArrayLike<number>);
  readonly point: Float64Array;
  readonly normal: Float64Array;
}
/** A polyline that moves: the points of each step. */
export class Front {
  constructor(steps: ReadonlyArray<Rows>, options?: { closed?: boolean });
  readonly steps: Float64Array[];
  readonly closed: boolean;
}
export interface Score extends Owner {}
/** The walls of a pattern. */
export class Score {
  private constructor();
  readonly sheet: Mesh;
  readonly pieces: number;
  /** Chips beside these. */
  readonly chips: number;
  readonly attempts: number;
}
export interface CrackDelta {
  removedFaces: Uint32Array;
  newFaces: Uint32Array;
  newCrackFaces: Uint32Array;
}
/** The area that two pieces share. */
export interface Bond {
  a: number;
  b: number;
  area: number;
  normal: Float64Array;
  centroid: Float64Array;
  section: number;
}
export interface FrontState extends Owner {}
/** A front in a complex. */
export class FrontState {
  private constructor();
  readonly crack: number;
  advance(points: Rows, options?: CrackOptions): CrackDelta;
}
export interface Complex extends Owner {}
/** A cracked model; it changes by its methods. */
export class Complex {
  constructor(model: Mesh);
  readonly faceCount: number;
  readonly vertexCount: number;
  readonly crackCount: number;
  readonly diagonal: number;
  readonly bonds: Bond[];
  copy(): Complex;
  surface(): Mesh;
  check(): string;
  crack(what: Crack | ReadonlyArray<Crack>, options?: CrackOptions): this;
  insert(sheet: Score | Mesh | Plane, options?: CrackOptions): CrackDelta;
  front(points: Rows, options?: { closed?: boolean }): FrontState;
  /** Takes the last edit back; the front that made it goes back, too. */
  undo(): void;
  /** Heals pieces below a volume to their neighbours. This and the next three end the fronts of the complex. */
  joinSmallPieces(least: number): this;
  /** Improves faces with a smaller angle than `angle` degrees. This and the next two cannot be undone; one that is stopped changes nothing. */
  remesh(options?: { angle?: number; deviation?: number; progress?: Progress }): CrackDelta;
  /** Displaces the inner vertices of cracks by noise; lengths are fractions of the diagonal. Volumes of pieces keep their sum. */
  roughen(options?: { amplitude?: number; frequency?: number; octaves?: number; seed?: number; progress?: Progress }): CrackDelta;
  /** Collapses edges where the surface moves by at most `deviation`, a fraction of the diagonal, until `faces` are left. */
  decimate(options?: { deviation?: number; faces?: number; progress?: Progress }): CrackDelta;
  pieces(options?: PieceOptions): Piece[];
  hierarchy(levels: number): { of: Uint32Array; volume: Float64Array }[];
  save(format: "glb" | "usda" | "ply" | "obj" | "stl" | "off", options?: { corners?: number; parts?: number; tile?: number; zUp?: boolean }): Uint8Array;
}

export interface StrikeOptions {
  /** Pieces are longer along it. */
  direction?: ArrayLike<number>;
  /** Time that the call may take; without it, the break is finished at once. */
  milliseconds?: number;
  /** J for a square unit of new wall. */
  toughness?: number;
  maxPieces?: number;
  /** Spacing of pieces over distance from the impact, as a power; 0: even. */
  grading?: number;
  /** Length of pieces along the direction over width. */
  elongation?: number;
  hullParts?: number;
  hullCorners?: number;
  seed?: number;
  /** Whether no faces may cross by a rounding, either, so that every piece is a Solid: takes twice as long. */
  guard?: boolean;
}
export interface Breakable extends Owner {}
/** A solid that is prepared to be broken where it is hit. Making it is the slow part of an impact. */
export class Breakable {
  constructor(solid: Mesh);
  /** Freed with this object. */
  readonly mesh: Mesh;
  readonly volume: number;
  strike(point: ArrayLike<number>, energy: number, options?: StrikeOptions): Breaking;
}
/** A part of a break; `divided`, `whole` and `hulls` follow it. */
export class BrokenPart {
  private constructor();
  readonly index: number;
  /** May be hit again. */
  readonly solid: Breakable;
  readonly mesh: Mesh;
  readonly volume: number;
  readonly centroid: Float64Array;
  /** Index of the part that it came out of; null: it is the solid. */
  readonly parent: number | null;
  readonly divided: boolean;
  /** It breaks no further in this impact, and has its hulls. */
  readonly whole: boolean;
  readonly hulls: ReadonlyArray<Mesh>;
}
export interface Breaking extends Owner {}
/** A break that goes on from call to call: after each, its pieces fill the solid. delete() frees the parts, too. */
export class Breaking {
  private constructor();
  readonly finished: boolean;
  readonly parts: BrokenPart[];
  /** The parts that are not divided. */
  readonly pieces: BrokenPart[];
  /** Goes on for about this time, for one step at least; returns whether it is finished. */
  advance(milliseconds: number): boolean;
}

export interface FrameStats {
  /** Elastic and kinetic energy at the frame's end, J. */
  elastic: number;
  kinetic: number;
  /** Crack steps that could not be made. */
  refused: number;
  newton: number;
  edgesCut: number;
  /** Three numbers for each, N. */
  bladeForce: Float64Array;
  pullForce: Float64Array;
  obstacleForce: Float64Array;
}
/** A position, or a position and a quaternion w, x, y, z. */
export type Pose = ArrayLike<number>;
/** An object of a run that a program moves. */
export interface Moved {
  readonly index: number;
  move(to: Pose): void;
  end(): void;
}
export interface Simulation extends Owner {
  readonly time: number;
  readonly frame: number;
  readonly frames: number;
  /** Of the nodes, now and in the material. */
  readonly positions: Float64Array;
  readonly nodes: Float64Array;
  readonly velocities: Float64Array;
  /** Von Mises, Pa. */
  readonly stress: Float64Array;
  readonly pieceCount: number;
  step(options?: { progress?: Progress }): FrameStats;
  run(each?: (run: Simulation, frame: FrameStats) => boolean | void): this;
  /** The deformed surface. Attributes are those of the model where the scene has one body; new faces have the group "crack". */
  surface(): {
    vertices: Float64Array;
    faces: Uint32Array;
    patch: Int32Array;
    site: Uint32Array;
    uv: Float64Array | undefined;
    colors: Float64Array | undefined;
    groups: Int32Array | undefined;
    groupNames: string[];
  };
  save(format: "kerf" | "ply"): Uint8Array;
  blade(index: number): Moved;
  grip(index: number): Moved;
  obstacle(index: number): Moved;
  addBlade(points: Rows, at: Pose, options?: { closed?: boolean; back?: ArrayLike<number>; thickness?: number; stiffness?: number }): Moved;
  addGrip(lo: ArrayLike<number>, hi: ArrayLike<number>): Moved;
  addPull(point: ArrayLike<number>, to: ArrayLike<number>, options?: { stiffness?: number }): Moved;
  /** Breaks the piece nearest to a point of the world into about `cells` parts (12), now; they fly from the point. */
  strike(point: ArrayLike<number>, options?: { cells?: number }): void;
  change(values: { young?: number; damping?: number; friction?: number; accuracy?: number; step?: number; gravity?: ArrayLike<number> }): void;
}
export interface SimulationOptions {
  /** A mesh, or one for each body of the scene. */
  models?: Mesh | ReadonlyArray<Mesh>;
  /** Values that replace those of the scene: { "material.young": 2e5 }. */
  set?: Record<string, number | string | boolean | ReadonlyArray<number>>;
  progress?: Progress;
  /** The module, or its address. */
  wasm?: string | URL | BufferSource | WebAssembly.Module;
}

export interface Kerf {
  Mesh: typeof Mesh;
  Solid: typeof Solid;
  Piece: typeof Piece;
  Plane: typeof Plane;
  Front: typeof Front;
  Score: typeof Score;
  Complex: typeof Complex;
  FrontState: typeof FrontState;
  Breakable: typeof Breakable;
  Breaking: typeof Breaking;
  BrokenPart: typeof BrokenPart;
  KerfError: typeof KerfError;
  plane(point: ArrayLike<number>, normal: ArrayLike<number>): Plane;
  score(model: Mesh | Complex, options?: ScoreOptions): Score;
  /** Reads OBJ, PLY, STL, OFF or GLB: a Solid, or a Mesh where it is no valid model. `format`: of the content, or the file's name. */
  load(bytes: Uint8Array | ArrayBuffer, format?: string): Mesh;
  shapes: {
    block(size?: ArrayLike<number>, options?: { edge?: number }): Solid;
    sphere(frequency?: number): Solid;
    pumpkin(frequency?: number): Solid;
    apple(frequency?: number): Solid;
    polyp(frequency?: number): Solid;
    letter(letter: string, options?: { depth?: number; resolution?: number }): Solid;
  };
  /** Begins a run of a scene, given as TOML; loads its module first. */
  simulation(scene: string, options?: SimulationOptions): Promise<Simulation>;
  patterns: Pattern[];
  usedBytes(): number;
}
/** Loads the module, once. */
export default function kerf(options?: { wasm?: string | URL | BufferSource | WebAssembly.Module }): Promise<Kerf>;
