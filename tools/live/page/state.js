// What is shown, and what is known of the simulation. Shown coordinates have the body's first box in the unit sphere.
const state = {
  tool: "knife", depth: 1, cells: 12, skin: 1, walls: true, wire: false, look: "clay", paint: true, nodes: false, edges: false, stress: false, size: 1,
  shadows: true, plotted: true, clip: false, axis: 3, offset: 0, fill: false, selected: -1,
};
const about = { y_up: false, middle: [0, 0, 0], unit: 1 };
const live = {
  told: null,      // JSON of the state
  stats: {},       // JSON of the newest frame
  frame: null,     // the newest frame that is not yet drawn
  fresh: false,    // a run has been told, and its first frame is still to come
  time: 0, revision: -1, vertices: 0, nodes: 0,
  position: new Float32Array(0),  // shown coordinates
  rest: new Float32Array(0),      // places of the vertices in the material, likewise
  node: null, stress: null, stressMost: 0, skinStress: null,
  pairs: null, asked: 0, stale: false,  // edges of the graph; when they were asked for, if an answer is due; whether the surface has changed since
};

const toShown = (p) => new THREE.Vector3(...p.map((x, k) => (x - about.middle[k]) / about.unit));
const toWorld = (v) => v.toArray().map((x, k) => about.middle[k] + about.unit * x);
const upward = () => new THREE.Vector3(0, about.y_up ? 1 : 0, about.y_up ? 0 : 1);

function stateArrived(arrived) {
  const told = arrived.about, first = live.told === null || live.told.run !== told.run;
  live.told = told, live.revision = arrived.revision, live.vertices = arrived.vertices, live.pairs = null;
  askForGraph();
  if (first) {
    const [lo, hi] = told.box;
    about.y_up = told.up === "y";
    about.middle = lo.map((x, k) => (x + hi[k]) / 2);
    about.unit = Math.max(0.5 * Math.hypot(...lo.map((x, k) => hi[k] - x)), 1e-9);
  }
  surface.begin(arrived);
  live.fresh ||= first;
  if (first) dress();
}
function deltaArrived(delta) {
  if (delta.from !== live.revision) throw new Error("A change is missing");
  live.revision = delta.to, live.vertices = delta.vertices;
  askForGraph();
  surface.change(delta);
}
function frameArrived(frame, time) {
  if (frame.revision !== live.revision) throw new Error("A frame belongs to another surface");
  live.frame = frame, live.time = time, live.nodes = frame.nodes;
  surface.changed = true;
  if (live.fresh) live.fresh = false, resetView();  // its first positions: those before are of another run
  told(frame.about);
  redraw();
}
function graphArrived(pairs) {
  live.pairs = pairs.slice(), live.asked = 0;
  if (live.stale) askForGraph();
  changed();
}
// Each change of the surface may change the graph. While an answer is due, the next request waits for it, two seconds at most.
function askForGraph() {
  live.stale = live.asked > 0 && performance.now() - live.asked < 2000;
  if (!state.edges || live.stale) return;
  live.asked = performance.now();
  send({ want: { graph: true } });
}

// 16-bit coordinates of a box, as shown.
function unpacked(values, frame, into) {
  const scale = frame.step.map((s) => s / about.unit), from = frame.lo.map((x, k) => (x - about.middle[k]) / about.unit);
  for (let i = 0; i < values.length; i += 3)
    for (let k = 0; k < 3; k++) into[i + k] = from[k] + scale[k] * values[i + k];
  return into;
}
// Takes the newest frame: positions of the surface and of the nodes.
function takeFrame() {
  const frame = live.frame;
  if (!frame) return false;
  live.frame = null;
  live.position = grown(live.position, 3 * frame.vertices);
  unpacked(frame.position, frame, live.position);
  live.node = frame.node ? unpacked(frame.node, frame, new Float32Array(3 * frame.nodes)) : null;
  live.stress = frame.stress ? Float32Array.from(frame.stress, (s) => s * frame.stressMost / 65535) : null;
  live.skinStress = frame.skinStress ? Float32Array.from(frame.skinStress, (s) => s * frame.skinStressMost / 65535) : null;
  live.stressMost = frame.stressMost ?? 0;
  return true;
}

function sendWants(anew) {
  const wants = { nodes: state.nodes || state.edges, stress: state.stress, graph: state.edges, rest: true };
  if (anew || JSON.stringify(wants) !== live.wants) live.asked = state.edges ? performance.now() : 0, live.stale = false, send({ want: wants });
  live.wants = JSON.stringify(wants);
}
// After any change of what is shown.
function changed() {
  sendWants(false);
  for (const layer of layers) layer.update();
  redraw();
}
