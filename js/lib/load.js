// Compiles a module of WebAssembly in browsers, workers and Node.

const inNode = typeof process === "object" && typeof process.versions?.node === "string";

/** A module from an address or bytes. */
export async function compiled(source) {
  if (source instanceof WebAssembly.Module) return source;
  if (source instanceof ArrayBuffer || ArrayBuffer.isView(source)) return WebAssembly.compile(source);
  if (inNode && new URL(source).protocol === "file:") {
    const { readFile } = await import("node:fs/promises");
    return WebAssembly.compile(await readFile(new URL(source)));
  }
  const answer = await fetch(source);
  if (!answer.ok) throw new Error(`${source}: ${answer.status} ${answer.statusText}`);
  // Some servers do not say that it is WebAssembly, as compileStreaming() wants it.
  if (answer.headers.get("Content-Type") === "application/wasm") return WebAssembly.compileStreaming(answer);
  return WebAssembly.compile(await answer.arrayBuffer());
}

/** The objects of a module: `make` is Emscripten's factory. */
export async function started(make, source) {
  const module = await compiled(source);
  return make({
    instantiateWasm(imports, ready) {
      WebAssembly.instantiate(module, imports).then((instance) => ready(instance, module));
      return {};
    },
  });
}
