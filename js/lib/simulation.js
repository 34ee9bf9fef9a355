// Simulations, in a module of WebAssembly of their own: it is loaded where a program asks for one.
import makeSimulation from "./kerf-simulation.js";
import { once } from "./load.js";

const started = once(makeSimulation);

// A value as TOML writes it.
function toml(value) {
  if (Array.isArray(value) || ArrayBuffer.isView(value)) return `[${Array.from(value, toml).join(", ")}]`;
  if (typeof value === "number") return Number.isInteger(value) && Math.abs(value) < 1e15 ? String(value) : value.toExponential();
  return typeof value === "string" ? JSON.stringify(value) : String(value);
}

export async function begin(scene, given, kerf) {
  const { Mesh, Owner, numbers, rows, taken, known, wrong, withProgress } = kerf;
  const { models = [], set = {}, progress, wasm } = known(given, ["models", "set", "progress", "wasm"], "simulation");
  if (typeof scene !== "string") throw wrong("scene: give the text of a scene, in TOML");
  const module = await started(wasm ?? new URL("./kerf-simulation.wasm", import.meta.url));
  const call = (name, ...given) => taken(module[name](...given));
  const pose = (given) => numbers(Float64Array, given, "pose");

  /** An object of the run that a program moves. */
  class Moved {
    #run; #kind;
    constructor(run, kind, index) { this.#run = run, this.#kind = kind, this.index = index; }
    /** Moves it to a pose by the end of the next frame. */
    move(to) { call("move", this.#run.handle, this.#kind, this.index, pose(to)); }
    /** Lets go, where it is a grip. */
    end() {
      if (this.#kind !== "grip") throw wrong(`end: a ${this.#kind} ends where it is moved no more`);
      call("endGrip", this.#run.handle, this.index);
    }
  }

  /** A run of a scene. Arrays are copies: they stay as they are when the run goes on. */
  class Simulation extends Owner {
    get time() { return call("field", this.handle, "time"); }
    get frame() { return call("field", this.handle, "frame"); }
    get frames() { return call("field", this.handle, "frames"); }
    get positions() { return call("field", this.handle, "positions"); }
    get nodes() { return call("field", this.handle, "nodes"); }
    get velocities() { return call("field", this.handle, "velocities"); }
    get stress() { return call("field", this.handle, "stress"); }
    get pieceCount() { return call("field", this.handle, "pieces"); }
    /** Computes a frame, and returns its statistics. */
    step({ progress: told } = {}) { return withProgress(told, (report) => call("step", this.handle, report)); }
    /** Computes frames up to the last one of the scene; `each` hears of every one, and stops it by false. */
    run(each = () => true) {
      while (this.frame < this.frames && each(this, this.step()) !== false);
      return this;
    }
    /** The deformed surface: vertices, faces, patch, site; of one body, uv, colors, groups and groupNames, too. */
    surface() { return call("surface", this.handle); }
    save(format) { return call("saveRun", this.handle, format); }
    blade(index) { return new Moved(this, "blade", index); }
    grip(index) { return new Moved(this, "grip", index); }
    obstacle(index) { return new Moved(this, "obstacle", index); }
    addBlade(points, at, given) {
      const options = known(given, ["closed", "back", "thickness", "stiffness"], "addBlade");
      return this.blade(call("addBlade", this.handle, rows(points, "points"), pose(at), options));
    }
    addGrip(lo, hi) { return this.grip(call("addGrip", this.handle, rows(lo, "lo"), rows(hi, "hi"))); }
    addPull(point, to, given) {
      const { stiffness = 100 } = known(given, ["stiffness"], "addPull");
      return new Moved(this, "pull", call("addPull", this.handle, rows(point, "point"), rows(to, "to"), stiffness));
    }
    /** Breaks the piece nearest to a point of the world into about `cells` parts, which fly from it. */
    strike(point, given) { call("strike", this.handle, rows(point, "point"), known(given, ["cells"], "strike")); }
    change(given) {
      const values = known(given, ["young", "damping", "friction", "accuracy", "step", "gravity"], "change");
      call("change", this.handle, values.gravity === undefined ? values : { ...values, gravity: rows(values.gravity, "gravity") });
    }
    /** Bytes of the module's heap that are in use. */
    static usedBytes() { return module.usedBytes(); }
  }

  const meshes = (Array.isArray(models) ? models : [models]).map((mesh) => {
    if (!(mesh instanceof Mesh)) throw wrong("models: give a Mesh, or a list of these");
    const { vertices, faces, uv, colors, groups, groupNames } = mesh;
    return { vertices, faces, uv, colors, groups, groupNames };
  });
  const overrides = Object.entries(set).map(([key, value]) => [key, toml(value)]);
  return new Simulation(withProgress(progress, (report) => call("beginRun", scene, meshes, overrides, report)));
}
