// Makes a manifold of each mesh of a folder with the library Manifold, as its manual recommends for meshes from files:
// merge() joins open vertices, and a union of all components resolves overlaps.
//   node manifold.mjs FOLDER FIRST     from mesh FIRST on; a line for each: its number and what became of it
// Meshes are FOLDER/N.in: two counts, coordinates as doubles, corners as 32 bits. Results are N.out in the same form.
import fs from 'node:fs';
import {pathToFileURL} from 'node:url';

const module = (await import(pathToFileURL('node_modules/manifold-3d/manifold.js').href)).default;
const {Manifold, Mesh} = await module().then((m) => (m.setup(), m));
const [folder, first] = process.argv.slice(2);
fs.writeSync(1, 'ready\n');

function united(data) {
  const [vertices, triangles] = new Uint32Array(data.buffer, data.byteOffset, 2);
  const points = new Float64Array(data.buffer.slice(data.byteOffset + 8, data.byteOffset + 8 + 24 * vertices));
  const at = data.byteOffset + 8 + 24 * vertices;
  const corners = new Uint32Array(data.buffer.slice(at, at + 12 * triangles));
  const mesh = new Mesh({numProp: 3, vertProperties: Float32Array.from(points), triVerts: corners});
  mesh.merge();
  const whole = new Manifold(mesh);
  if (whole.status() !== 'NoError') throw new Error(whole.status());
  const result = Manifold.union(whole.decompose());
  if (result.isEmpty()) throw new Error('empty');
  return result.getMesh();
}

for (let n = Number(first); fs.existsSync(`${folder}/${n}.in`); ++n) {
  let said = 'done';
  try {
    const out = united(fs.readFileSync(`${folder}/${n}.in`));
    const head = Uint32Array.of(out.vertProperties.length / 3, out.triVerts.length / 3);
    fs.writeFileSync(`${folder}/${n}.out`, Buffer.concat([head, Float64Array.from(out.vertProperties), out.triVerts]
      .map((a) => Buffer.from(a.buffer, a.byteOffset, a.byteLength))));
  } catch (error) {
    said = 'refused ' + String(error.message ?? error).split('\n')[0];
  }
  fs.writeSync(1, `${n} ${said}\n`);
}
