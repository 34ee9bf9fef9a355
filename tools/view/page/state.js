// What is shown, and how it follows the controls: layers are told after each change, and draw once a display frame.
const state = {
  frame: 0, rest: false, skin: 1, cracks: true, wire: false, color: "patch", explode: 0,
  nodes: false, field: "radius", size: 1, edges: false, cut: false, updated: false, near: true, tree: false, own: true, fronts: true, obstacles: true,
  clip: false, axis: 3, offset: 0, fill: true, selected: -1, playing: false,
};
let about = null, arrays = null;

const hasNodes = () => about.nodes !== null;
// The surface that is shown: a frame of the run, or the body at rest.
const shownSurface = () => (about.surfaces.length === 0 ? -1 : state.rest && hasNodes() && about.nodes.rest >= 0 ? about.nodes.rest : state.frame);
const isRun = () => hasNodes() ? about.nodes.rest > 0 || about.surfaces.length > 1 : about.surfaces.length > 1;
const frameCount = () => (isRun() && hasNodes() && about.nodes.rest > 0 ? about.surfaces.length - 1 : about.surfaces.length);

// What is known of the nodes in the frame that is shown; null at rest, and where frames have none.
const nodeFrame = () => (shownSurface() === about.nodes.rest ? null : about.nodes.frames[shownSurface()] ?? null);
// Node positions as they are shown, pieces pulled apart; fewer than there are nodes where some come later, null where they are
// not known.
function nodePositions() {
  if (!hasNodes()) return null;
  const n = about.nodes, at = shownSurface(), frame = nodeFrame();
  const base = frame ? arrays[frame.position].subarray(0, 3 * frame.count) : at === n.rest || at === -1 ? arrays["nodes/rest"] : null;
  if (!base || state.explode === 0 || !arrays["nodes/piece"] || at < 0) return base;
  const shift = pieceShifts(at), piece = arrays["nodes/piece"], moved = new Float32Array(base);
  for (let i = 0; 3 * i < moved.length; i++) {
    const own = frame ? frame.pieces[piece[i]] : piece[i];
    for (let k = 0; k < 3; k++) moved[3 * i + k] += shift[3 * own + k];
  }
  return moved;
}

// How far each piece of a surface is pulled from the middle.
function pieceShifts(at) {
  const s = surfaceData(at), shift = new Float32Array(s.centers.length);
  for (let i = 0; i < shift.length; i++) shift[i] = state.explode * (s.centers[i] - s.middle[i % 3]);
  return shift;
}

// After any change of the state.
function changed() {
  placeClipPlane();
  for (const layer of layers) layer.update();
  redraw();
}

// What lies beyond the plane, along the axis that is chosen, is cut away.
function placeClipPlane() {
  const axis = Number(state.axis), beyond = new THREE.Vector3(), from = new THREE.Vector3();
  if (axis === 6) beyond.copy(eyePosition()).sub(view.target).normalize(), from.copy(view.target);
  else beyond.setComponent(axis >> 1, axis & 1 ? -1 : 1);
  clipPlane.normal.copy(beyond).negate();
  clipPlane.constant = beyond.dot(from) + Number(state.offset);
}
