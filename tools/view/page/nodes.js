// Nodes, coloured by a field.
const nodeDiameter = (i) => 0.28 * arrays["nodes/size"][i] * state.size;
// Stress is that of the frame which is shown (at rest: of the slider's), all else is told once.
const fieldValues = (name) => arrays[name === "stress" ? about.nodes.frames[state.frame].stress : "field/" + name];
function fieldRange(name) {
  if (name === "stress") return about.nodes.stress;
  const e = about.arrays.find((a) => a.name === "field/" + name);
  return [e.lo[0], e.lo[0] + 65535 * e.step[0]];
}
const fieldTitles = { stress: "stress (von Mises, Pa)", strain: "strain (von Mises stress / 3G)" };
// Of the checkpoint, where that is another frame.
const fieldTitle = (name) => (fieldTitles[name] ?? name) + (["strain", "displacement", "speed"].includes(name) && about.surfaces[about.nodes.frame] && state.frame !== about.nodes.frame ? " in " + about.surfaces[about.nodes.frame].label : "");
const short = (x) => Number.isInteger(x) ? String(x) : Number(x.toPrecision(4)).toString();

class NodeLayer {
  constructor() { this.spots = new Spots(2); }
  update() {
    if (!hasNodes()) return;
    const position = state.nodes ? nodePositions() : null;
    $("elsewhere").hidden = !(state.nodes || state.edges || state.cut) || nodePositions() !== null;
    $("legend").hidden = position === null;
    if (!position) return this.spots.hide();
    const values = fieldValues(state.field), [lo, hi] = fieldRange(state.field), color = new Float32Array(position.length), size = new Float32Array(position.length / 3);
    const around = state.selected >= 0 && state.near && rows ? new Set(rows[state.selected].filter((e) => isNeighbor(e.bits)).map((e) => e.to)) : null;
    for (let i = 0; i < size.length; i++) {
      const red = state.updated && arrays["nodes/updated"][i];
      color.set(red ? [0.86, 0.12, 0.10] : scaleColor(hi > lo ? (values[i] - lo) / (hi - lo) : 0), 3 * i);
      size[i] = nodeDiameter(i) * (around && !around.has(i) ? 0.4 : 1);
    }
    this.spots.set(position, color, size);
    $("legend-name").textContent = fieldTitle(state.field);
    $("legend-lo").textContent = short(lo), $("legend-hi").textContent = (state.field === "stress" ? "≥ " : "") + short(hi);
    $("legend-bar").style.background = `linear-gradient(to right, ${[0, 1, 2, 3, 4].map((i) => `rgb(${scaleColor(i / 4).map((c) => Math.round(255 * c))})`)})`;
  }
  beforeDraw() { this.spots.beforeDraw(); }
}

// The node nearest to the eye under a place on the canvas, or close to it; −1: none.
function nodeAt(x, y) {
  const position = nodePositions(), canvas = $("canvas"), p = new THREE.Vector3();
  if (!position) return -1;
  const focal = canvas.clientHeight / (2 * Math.tan(camera.fov * Math.PI / 360));
  let best = -1, least = Infinity;
  for (let i = 0; 3 * i < position.length; i++) {
    p.fromArray(position, 3 * i);
    if (state.clip && clipPlane.distanceToPoint(p) < 0) continue;
    const depth = p.distanceTo(camera.position);
    p.project(camera);
    if (p.z > 1) continue;
    const away = Math.hypot((p.x + 1) / 2 * canvas.clientWidth - x, (1 - p.y) / 2 * canvas.clientHeight - y);
    const reach = Math.max(0.5 * nodeDiameter(i) * focal / depth, 5);
    // Within its disc the nearest one counts; around it, farther ones lose to closer ones.
    const cost = depth + (away > reach ? 3 * (away - reach) * depth / focal + 0.1 : 0);
    if (away < reach + 12 && cost < least) least = cost, best = i;
  }
  return best;
}
