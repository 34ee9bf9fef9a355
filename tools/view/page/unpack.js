// The arrays that view/pack.h wrote: differences in byte planes, deflated, as base64.
async function unpack(text, entries) {
  const binary = atob(text), deflated = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; i++) deflated[i] = binary.charCodeAt(i);
  const stream = new Blob([deflated]).stream().pipeThrough(new DecompressionStream("deflate"));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  const whole = {}, arrays = {};
  for (const e of entries) {
    const n = e.count, values = new Uint32Array(n), mask = e.width === 4 ? 0xffffffff : 256 ** e.width - 1;
    const base = e.base ? whole[e.base] : null;
    for (let i = 0; i < n; i++) {
      let folded = 0;
      for (let k = 0; k < e.width; k++) folded |= bytes[e.at + k * n + i] << (8 * k);
      const before = base ? base[i] : i >= e.columns ? values[i - e.columns] : 0;
      values[i] = (before + ((folded >>> 1) ^ -(folded & 1))) & mask;
    }
    whole[e.name] = values;
    if (!e.step) {
      arrays[e.name] = values;
      continue;
    }
    const real = new Float32Array(n), columns = e.step.length;
    for (let i = 0; i < n; i++) real[i] = e.lo[i % columns] + e.step[i % columns] * values[i];
    arrays[e.name] = real;
  }
  return arrays;
}
