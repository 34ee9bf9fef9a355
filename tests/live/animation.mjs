// animation.mjs READERS FILE.glb: plays an animated GLB in three.js. Prints, for the times of standard input (a JSON list),
// a JSON list of the boxes [x, y, z, x, y, z] of all that has a size, in the file's world.
import fs from 'node:fs';
import {pathToFileURL} from 'node:url';

const [readers, file] = process.argv.slice(2), load = (path) => import(pathToFileURL(`${readers}/node_modules/three/${path}`).href);
const THREE = await load('build/three.module.js'), {GLTFLoader} = await load('examples/jsm/loaders/GLTFLoader.js');
const bytes = fs.readFileSync(file), times = JSON.parse(fs.readFileSync(0, 'utf8'));
const {scene, animations} = await new GLTFLoader().parseAsync(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length), '');
const mixer = new THREE.AnimationMixer(scene);
for (const clip of animations) {
  const action = mixer.clipAction(clip);
  action.setLoop(THREE.LoopOnce), action.clampWhenFinished = true;
  action.play();
}
const boxes = times.map((time) => {
  mixer.setTime(time);
  scene.updateMatrixWorld(true);
  const box = new THREE.Box3(), at = new THREE.Vector3();
  scene.traverse((mesh) => {
    if (!mesh.isMesh || mesh.matrixWorld.getMaxScaleOnAxis() < 1e-6) return;
    for (let i = 0; i < mesh.geometry.attributes.position.count; i++) box.expandByPoint(mesh.getVertexPosition(i, at).applyMatrix4(mesh.matrixWorld));
  });
  return [...box.min.toArray(), ...box.max.toArray()];
});
console.log(JSON.stringify(boxes));
