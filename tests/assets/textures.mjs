// textures.mjs NAME.usda: tinyusdz reads the materials of textured.py with their textures, which are there, NAME_….png.
import fs from 'node:fs';
import path from 'node:path';

import {tiny} from './tiny.mjs';

const [file] = process.argv.slice(2), stem = path.parse(file).name;
function check(condition, what) {
  if (condition) return;
  console.error(`${file}: ${what}`);
  process.exit(1);
}
const loader = new tiny.TinyUSDZLoaderNative();
check(loader.loadFromBinary(fs.readFileSync(file), path.basename(file)), `tinyusdz does not read it: ${loader.error()}`);
const near = (a, b) => a.length === b.length && a.every((x, i) => Math.abs(x - b[i]) < 1e-6);
const texture = id => loader.getImage(loader.getTexture(id).textureImageId);
const materials = [0, 1, 2].map(i => loader.getMaterial(i));
const textured = materials.find(m => m.diffuseColorTextureId !== undefined);
check(textured, 'no material has a texture of colours');
check(texture(textured.diffuseColorTextureId).uri.endsWith(`${stem}_brick_wall.png`), 'another texture of colours');
check(texture(textured.diffuseColorTextureId).usdColorSpace === 'srgb', 'colours are not sRGB');
check(texture(textured.normalTextureId).usdColorSpace === 'raw', 'normals are not raw');
const lid = materials.find(m => near(m.diffuseColor, [1, 0.5, 0]));
check(lid && near(lid.emissiveColor, [2, 1, 0]) && Math.abs(lid.opacity - 0.5) < 1e-6, 'the lid has other values');
for (const id of [lid.roughnessTextureId, lid.metallicTextureId])
  check(texture(id).uri.endsWith(`${stem}_surface.png`), 'the lid has another texture');
check(materials.some(m => near(m.diffuseColor, [0.42, 0.36, 0.31])), 'no material of cracks');
const text = String(fs.readFileSync(file)), names = [...text.matchAll(/@\.\/(.*?)@/g)].map(match => match[1]);
check(names.length === 3, `${names.length} textures`);
for (const name of names) check(fs.existsSync(path.join(path.dirname(file), name)), `${name} is not there`);
console.log(`usd: ${materials.length} materials, ${names.length} textures, all there`);
