// An animated GLB (glTF 2.0) of frames: a mesh for each interval in which nothing was cut, with a morph target for each of its
// other frames. Each mesh has its size while its interval lasts, and is a point otherwise.
class GlbWriter {
  constructor() {
    this.json = { asset: { version: "2.0", generator: "kerf" }, scene: 0, scenes: [{ nodes: [0] }], nodes: [], meshes: [], materials: [], accessors: [], bufferViews: [], buffers: [] };
    this.parts = [], this.size = 0;
  }
  // An accessor of these numbers. `shape`: SCALAR or VEC3; `target`: 34962 vertices, 34963 indices, or none.
  add(values, shape, target, bounds = false) {
    const width = shape === "VEC3" ? 3 : shape === "VEC4" ? 4 : 1, { json } = this;
    json.bufferViews.push({ buffer: 0, byteOffset: this.size, byteLength: values.byteLength, ...(target ? { target } : {}) });
    this.parts.push(values), this.size += values.byteLength;
    const accessor = { bufferView: json.bufferViews.length - 1, componentType: values instanceof Uint32Array ? 5125 : 5126, count: values.length / width, type: shape };
    if (bounds) {
      accessor.min = new Array(width).fill(Infinity), accessor.max = new Array(width).fill(-Infinity);
      for (let i = 0; i < values.length; i++) accessor.min[i % width] = Math.min(accessor.min[i % width], values[i]), accessor.max[i % width] = Math.max(accessor.max[i % width], values[i]);
    }
    return json.accessors.push(accessor) - 1;
  }
  bytes() {
    this.json.buffers = [{ byteLength: this.size }];
    const text = new TextEncoder().encode(JSON.stringify(this.json)), padded = (text.length + 3) & ~3, bytes = new Uint8Array(28 + padded + this.size), head = new DataView(bytes.buffer);
    [0x46546c67, 2, bytes.length, padded, 0x4e4f534a].forEach((x, i) => head.setUint32(4 * i, x, true));
    bytes.fill(32, 20, 20 + padded), bytes.set(text, 20);
    head.setUint32(20 + padded, this.size, true), head.setUint32(24 + padded, 0x004e4942, true);
    let at = 28 + padded;
    for (const part of this.parts) bytes.set(new Uint8Array(part.buffer, part.byteOffset, part.byteLength), at), at += part.byteLength;
    return bytes;
  }
}
// `frames`: as the recorder has them; positions as shown, which become those of the world.
function animatedGlb(frames, look) {
  const glb = new GlbWriter(), { json } = glb, channels = [], samplers = [];
  const linear = (color) => [16, 8, 0].map((shift) => ((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4))(((color >> shift) & 255) / 255));
  for (const [name, color] of [["skin", look.skin], ["cut", look.wall]]) json.materials.push({ name, pbrMetallicRoughness: { baseColorFactor: [...linear(color), 1], metallicFactor: 0, roughnessFactor: 0.6 }, doubleSided: true });
  json.nodes.push({ name: "body", children: [], ...(about.y_up ? {} : { rotation: [-Math.SQRT1_2, 0, 0, Math.SQRT1_2] }) });
  const animate = (node, path, times, values, shape, interpolation) => {
    samplers.push({ input: glb.add(Float32Array.from(times), "SCALAR", 0, true), output: glb.add(Float32Array.from(values), shape), interpolation });
    channels.push({ sampler: samplers.length - 1, target: { node, path } });
  };
  const starts = frames.flatMap((frame, i) => (i === 0 || frame.skin ? [i] : [])), end = frames[frames.length - 1].lasts;
  starts.forEach((first, number) => {
    const next = starts[number + 1] ?? frames.length, interval = frames.slice(first, next);
    const node = json.nodes.push({ name: `interval ${number + 1}`, mesh: json.meshes.length, translation: about.middle }) - 1;
    json.nodes[0].children.push(node);
    json.meshes.push(intervalMesh(glb, interval));
    if (interval.length > 1) animate(node, "weights", interval.map(({ lasts }) => lasts), interval.flatMap((f, i) => interval.slice(1).map((g, k) => Number(k + 1 === i))), "SCALAR", "LINEAR");
    if (starts.length === 1) return;
    const from = interval[0].lasts, to = next < frames.length ? frames[next].lasts : Infinity, times = [...new Set([0, from, to].filter((t) => t <= end))];
    animate(node, "scale", times, times.flatMap((t) => new Array(3).fill(t >= from && t < to ? 1 : 0)), "VEC3", "STEP");
  });
  if (channels.length > 0) json.animations = [{ name: "run", channels, samplers }];
  return glb.bytes();
}
// A mesh of the frames of an interval: their vertices are the ones that triangles of its first frame use.
function intervalMesh(glb, interval) {
  const [{ skin, walls, position, normal }] = interval, number = new Map(), numbered = (list) => Uint32Array.from(list, (g) => (number.has(g) || number.set(g, number.size), number.get(g)));
  const lists = [numbered(skin), numbered(walls)], used = [...number.keys()];
  const picked = (from, scale) => {
    const to = new Float32Array(3 * used.length);
    used.forEach((g, i) => { for (let k = 0; k < 3; k++) to[3 * i + k] = scale * from[3 * g + k]; });
    return to;
  };
  const unit = about.unit, base = picked(position, unit), normals = picked(normal, 1);
  for (let i = 0; i < normals.length; i += 3) if (Math.hypot(normals[i], normals[i + 1], normals[i + 2]) < 0.5) normals[i + 2] = 1;  // corners that cancel
  const attributes = { POSITION: glb.add(base, "VEC3", 34962, true), NORMAL: glb.add(normals, "VEC3", 34962) };
  const targets = interval.slice(1).map((frame) => ({ POSITION: glb.add(picked(frame.position, unit).map((x, i) => x - base[i]), "VEC3", 34962, true) }));
  const primitives = lists.flatMap((list, material) => (list.length === 0 ? [] : [{ attributes, indices: glb.add(list, "SCALAR", 34963), material, ...(targets.length > 0 ? { targets } : {}) }]));
  return { primitives, ...(targets.length > 0 ? { weights: new Array(targets.length).fill(0) } : {}) };
}
