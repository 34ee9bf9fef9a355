// The stage that pages share: canvas, camera, lights, layers that draw on it, and scales of colour.
const layers = [];
const $ = (id) => document.getElementById(id);

const renderer = new THREE.WebGLRenderer({ canvas: $("canvas"), antialias: true, preserveDrawingBuffer: true });
renderer.setClearColor(0xe4e9ef);
renderer.localClippingEnabled = true;
const scene = new THREE.Scene();
const camera = new THREE.PerspectiveCamera(34, 1, 0.01, 100);
const clipPlane = new THREE.Plane(new THREE.Vector3(0, -1, 0), 0);  // what is on its negative side is cut away
const sky = new THREE.HemisphereLight(0xffffff, 0x8f98a3, 0.6);
scene.add(sky);
const lamp = new THREE.DirectionalLight(0xffffff, 0.62);
scene.add(lamp, lamp.target);

const clipping = () => (state.clip ? [clipPlane] : []);

const stops = [[0.267, 0.005, 0.329], [0.230, 0.322, 0.546], [0.128, 0.567, 0.551], [0.369, 0.789, 0.383], [0.993, 0.906, 0.144]];  // viridis
function scaleColor(t) {
  const s = Math.min(Math.max(t, 0), 1) * 4, i = Math.min(3, Math.floor(s));
  return stops[i].map((c, k) => c + (s - i) * (stops[i + 1][k] - c));
}
// Hues a golden angle apart.
function pieceColor(piece) {
  const c = new THREE.Color().setHSL((0.07 + piece * 0.61803398875) % 1, 0.5, 0.58);
  return [c.r, c.g, c.b];
}

let drawing = false;
function draw() {
  drawing = false;
  placeCamera();
  for (const layer of layers) if (layer.beforeDraw) layer.beforeDraw();
  renderer.render(scene, camera);
  for (const layer of layers) if (layer.afterDraw) layer.afterDraw();
}
function redraw() {
  if (!drawing) drawing = true, requestAnimationFrame(() => drawing && draw());
}
