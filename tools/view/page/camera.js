// The eye goes round a target, z up or y up as the model's maker wants. Angles in radians.
const home = { azimuth: 0.52, elevation: 0.38, distance: 3.25 };
const view = { ...home, target: new THREE.Vector3() };

function eyePosition() {
  const c = Math.cos(view.elevation);
  const side = Math.sin(view.azimuth) * c, back = Math.cos(view.azimuth) * c, up = Math.sin(view.elevation);
  return (about.y_up ? new THREE.Vector3(-side, up, back) : new THREE.Vector3(-side, -back, up)).multiplyScalar(view.distance).add(view.target);
}
function placeCamera() {
  camera.up.set(0, about.y_up ? 1 : 0, about.y_up ? 0 : 1);
  sky.position.copy(camera.up);
  camera.position.copy(eyePosition());
  camera.near = view.distance / 200, camera.far = view.distance * 20 + 20;
  camera.updateProjectionMatrix();
  camera.lookAt(view.target);
  camera.updateMatrixWorld();
  // Light comes from over the left shoulder.
  const right = new THREE.Vector3().setFromMatrixColumn(camera.matrixWorld, 0), up = new THREE.Vector3().setFromMatrixColumn(camera.matrixWorld, 1);
  lamp.position.copy(camera.position).addScaledVector(right, -0.5 * view.distance).addScaledVector(up, 0.6 * view.distance);
  lamp.target.position.copy(view.target);
  lamp.target.updateMatrixWorld();
}
function turn(azimuth, elevation) {
  view.azimuth += azimuth;
  view.elevation = Math.min(Math.max(view.elevation + elevation, -1.55), 1.55);
  eyeMoved();
}
function zoom(factor) {
  view.distance = Math.min(Math.max(view.distance * factor, 0.05), 60);
  eyeMoved();
}
// Moves the target in the plane of the screen, by pixels.
function pan(x, y) {
  const step = 2 * view.distance * Math.tan(camera.fov * Math.PI / 360) / $("canvas").clientHeight;
  const right = new THREE.Vector3().setFromMatrixColumn(camera.matrixWorld, 0), up = new THREE.Vector3().setFromMatrixColumn(camera.matrixWorld, 1);
  view.target.addScaledVector(right, -x * step).addScaledVector(up, y * step);
  eyeMoved();
}
function eyeMoved() {
  if (state.clip && Number(state.axis) === 6) changed();
  else redraw();
}

function resize() {
  const stage = $("stage"), ratio = window.devicePixelRatio || 1;
  renderer.setPixelRatio(ratio);
  renderer.setSize(stage.clientWidth, stage.clientHeight, false);
  camera.aspect = stage.clientWidth / Math.max(1, stage.clientHeight);
  redraw();
}
