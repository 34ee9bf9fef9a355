// Compiles a module of WebAssembly in browsers, workers and Node.

const inNode = typeof process === "object" && typeof process.versions?.node === "string";

/** A module from an address or bytes. */
async function compiled(source) {
  if (source instanceof WebAssembly.Module) return source;
  if (source instanceof ArrayBuffer || ArrayBuffer.isView(source)) return WebAssembly.compile(source);
  if (inNode && new URL(source).protocol === "file:") {
    // package.json names the file for Node, and another for browsers: bundlers need not know Node's modules.
    const { bytesOf } = await import("#file");
    return WebAssembly.compile(await bytesOf(new URL(source)));
  }
  const answer = await fetch(source);
  if (!answer.ok) throw new Error(`${source}: ${answer.status} ${answer.statusText}; give the place of the file as the option wasm`);
  // Some servers do not say that it is WebAssembly, as compileStreaming() wants it.
  if (answer.headers.get("Content-Type") === "application/wasm") return WebAssembly.compileStreaming(answer);
  const bytes = await answer.arrayBuffer(), [zero, a, s, m] = new Uint8Array(bytes);
  // Servers of single pages answer with the page where there is no file.
  if (zero !== 0 || String.fromCharCode(a, s, m) !== "asm")
    throw new Error(`${source} is no WebAssembly: the server has another file there; give the place of the file as the option wasm`);
  return WebAssembly.compile(bytes);
}

/** The objects of a module: `make` is Emscripten's factory. */
async function started(make, source) {
  const module = await compiled(source);
  return new Promise((ready, failed) => {
    make({
      instantiateWasm(imports, done) {
        WebAssembly.instantiate(module, imports).then((instance) => done(instance, module)).catch(failed);
        return {};
      },
    }).then(ready, failed);
  });
}

/** A function that starts a module at its first call, and gives the same to all later ones; after a failure it tries again. */
export function once(make) {
  let module = null;
  return (source) => {
    module ??= started(make, source).catch((error) => {
      module = null;
      throw error;
    });
    return module;
  };
}
