// A crate of planks with iron bands breaks where it is clicked: its planks keep their texture, broken wood has one of its own.
import * as THREE from "three";
import kerf from "kerf";
import { geometryOf, solidOf } from "./kerf-three.js";

const names = ["planks", "iron", "crack"];  // the last is Kerf's name for new faces

// ---- Materials: textures that are drawn here

function painted(draw, size = 256) {
  const canvas = document.createElement("canvas"), paint = canvas.getContext("2d");
  canvas.width = canvas.height = size;
  draw(paint, size);
  const texture = new THREE.CanvasTexture(canvas);
  texture.wrapS = texture.wrapT = THREE.RepeatWrapping;
  if (THREE.SRGBColorSpace) texture.colorSpace = THREE.SRGBColorSpace;
  return texture;
}
function grain(paint, size, tones, lines) {
  paint.fillStyle = tones[0], paint.fillRect(0, 0, size, size);
  for (let i = 0; i < lines; ++i) {
    paint.strokeStyle = tones[1 + (i % (tones.length - 1))], paint.globalAlpha = 0.25;
    paint.beginPath();
    for (let x = 0; x <= size; x += 8) paint.lineTo(x, ((i * 37) % size) + 3 * Math.sin(x / 23 + i));
    paint.stroke();
  }
  paint.globalAlpha = 1;
}
const planks = painted((paint, size) => {
  grain(paint, size, ["#b07a45", "#6e4522", "#c99a66"], 120);
  paint.fillStyle = "#4a2d16";
  for (let i = 0; i < 4; ++i) paint.fillRect(0, (i * size) / 4, size, 4);
});
const broken = painted((paint, size) => grain(paint, size, ["#e9cf9f", "#b98d55", "#fff0cf"], 200));
const materials = [
  new THREE.MeshPhongMaterial({ map: planks, shininess: 8 }),
  new THREE.MeshPhongMaterial({ color: 0x50565e, specular: 0x9aa4b0, shininess: 60 }),
  new THREE.MeshPhongMaterial({ map: broken, shininess: 4 }),
];

// ---- Scene

const renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
if ("outputEncoding" in renderer && THREE.sRGBEncoding) renderer.outputEncoding = THREE.sRGBEncoding;
document.body.append(renderer.domElement);
const scene = new THREE.Scene(), camera = new THREE.PerspectiveCamera(35, 1, 0.1, 100);
scene.background = new THREE.Color(0xe8edf2);
camera.position.set(2.6, 1.7, 3.2), camera.lookAt(0, 0, 0);
const light = Number(THREE.REVISION) < 155 ? 0.45 : 1.4;  // since r155 lights are in physical units
const sun = new THREE.DirectionalLight(0xffffff, light);
sun.position.set(2, 4, 3);
scene.add(sun, new THREE.HemisphereLight(0xffffff, 0x8a7f70, 0.8 * light));

// The iron bands are the outer rows of squares of each side: two materials of one solid.
function crateGeometry(squares = 10) {
  const box = new (THREE.BoxBufferGeometry ?? THREE.BoxGeometry)(1.4, 1.4, 1.4, squares, squares, squares).toNonIndexed();
  const uv = box.getAttribute("uv"), corners = uv.count;
  box.clearGroups();
  for (let face = 0; face < corners; face += 3) {
    const u = (uv.getX(face) + uv.getX(face + 1) + uv.getX(face + 2)) / 3, v = (uv.getY(face) + uv.getY(face + 1) + uv.getY(face + 2)) / 3;
    const rim = Math.max(Math.abs(u - 0.5), Math.abs(v - 0.5)) > 0.5 - 1 / squares;
    box.addGroup(face, 3, rim ? 1 : 0);
  }
  return box;
}

const crate = new THREE.Mesh(crateGeometry(), materials), pieces = new THREE.Group();
scene.add(crate, pieces);
const k = await kerf(), solid = solidOf(k, crate.geometry, names);

/** Breaks the crate near a point, the smallest pieces there. */
function breakAt(point) {
  const parts = solid.fracture(24, { seed: 5, impact: point.toArray(), cluster: 0.2, jagged: 0.012, tile: 0.25 });
  for (const part of parts) {
    const mesh = new THREE.Mesh(geometryOf(part, names), materials);
    mesh.userData.home = new THREE.Vector3(...part.centroid);
    mesh.userData.away = mesh.userData.home.clone().sub(point.clone().multiplyScalar(0.6));
    pieces.add(mesh);
    part.delete();
  }
  crate.visible = false;
}

// ---- Hands

const apart = document.getElementById("apart");
function draw() {
  for (const mesh of pieces.children) mesh.position.copy(mesh.userData.home).addScaledVector(mesh.userData.away, Number(apart.value));
  renderer.render(scene, camera);
}
function fit() {
  renderer.setSize(innerWidth, innerHeight);
  camera.aspect = innerWidth / innerHeight;
  camera.updateProjectionMatrix();
  draw();
}
addEventListener("resize", fit);
apart.addEventListener("input", draw);
renderer.domElement.addEventListener("pointerdown", (e) => {
  if (!crate.visible) return;
  const at = new THREE.Vector2((2 * e.offsetX) / innerWidth - 1, 1 - (2 * e.offsetY) / innerHeight), ray = new THREE.Raycaster();
  ray.setFromCamera(at, camera);
  const [hit] = ray.intersectObject(crate);
  if (!hit) return;
  breakAt(hit.point);
  apart.value = 0.35;
  draw();
});
fit();
export { breakAt, camera, crate, materials, pieces, renderer };  // for tests
