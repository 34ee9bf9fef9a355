// A worker that simulates a soft block, so that its page stays smooth: it is told where the knife is, and answers with the surface.
// Workers have no import maps: without a bundler, "kerf" is named by its path.
import kerf from "./node_modules/kerf/index.js";

const scene = `
[body]
mesh = "block"
nodes = 200
[material]
young = 3e4
[ground]
point = [0, 0, 0]
[time]
step = 0.02
`;

// Asks for a frame at a time: { knife } is a height, at which an edge along x cuts; absent: none.
const started = (async () => {
  const k = await kerf(), block = k.shapes.block([1, 1, 1], { edge: 0.2 });
  const run = await k.simulation(scene, { models: block });
  block.delete();
  return run;
})();
let blade = null;
onmessage = async ({ data: { knife } }) => {
  try {
    const run = await started;
    if (knife !== undefined) (blade ??= run.addBlade([[-1, 0, 0], [2, 0, 0]], [0, 0.5, 1.2])).move([0, 0.5, knife]);
    run.step();
    const { vertices, faces } = run.surface();
    // Arrays are copies: they go to the page without another one.
    postMessage({ vertices, faces, pieces: run.pieceCount }, [vertices.buffer, faces.buffer]);
  } catch ({ name, message }) {
    postMessage({ failure: `${name}: ${message}` });
  }
};
