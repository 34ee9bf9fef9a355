// The module of tinyusdz, which reads USD stages.
import fs from 'node:fs';
import path from 'node:path';
import {fileURLToPath} from 'node:url';

// The package is built for browsers and workers.
Object.defineProperty(process, 'type', {value: 'renderer'});
globalThis.window = globalThis;
const {default: initialize} = await import('tinyusdz/tinyusdz.js');
const here = path.dirname(fileURLToPath(import.meta.url));
const wasm = fs.readFileSync(path.join(here, 'node_modules/tinyusdz/tinyusdz.wasm'));
export const tiny = await initialize({instantiateWasm(imports, done) {
  WebAssembly.instantiate(wasm, imports).then(result => done(result.instance, result.module));
  return {};
}});
