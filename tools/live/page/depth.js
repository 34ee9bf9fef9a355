// The depth of the material below the skin, as a grid around the body at rest: for solid textures, and for the darkness of
// wounds. The skin at rest is the same however it is cut.
class DepthField {
  constructor() {
    this.across = 40, this.columns = 8;  // nodes of the grid along each axis; slices beside each other in the image
    this.map = { value: new THREE.DataTexture(new Uint8Array([0]), 1, 1, THREE.LuminanceFormat) };
    this.box = { value: new THREE.Vector4(0, 0, 0, 1) };    // the first node; the distance of nodes
    this.range = { value: new THREE.Vector2(0, 0) };        // depth of the values 0 and 1
  }
  // `rest`: places of vertices; `triangles`: their numbers, three for each of the skin.
  fill(rest, triangles) {
    const n = this.across, lo = [Infinity, Infinity, Infinity], hi = [-Infinity, -Infinity, -Infinity];
    for (const v of triangles) for (let k = 0; k < 3; k++) lo[k] = Math.min(lo[k], rest[3 * v + k]), hi[k] = Math.max(hi[k], rest[3 * v + k]);
    const cell = Math.max(...hi.map((x, k) => x - lo[k])) / (n - 3), from = lo.map((x, k) => 0.5 * (x + hi[k]) - 0.5 * (n - 1) * cell);
    const nearest = new Float32Array(3 * n * n * n), squared = new Float32Array(n * n * n).fill(Infinity), inside = new Uint8Array(n * n * n);
    for (let t = 0; t < triangles.length; t += 3) this.addTriangle([0, 1, 2].map((k) => [0, 1, 2].map((d) => (rest[3 * triangles[t + k] + d] - from[d]) / cell)), nearest, squared, inside);
    this.spread(nearest, squared);
    // Each crossing of a line along z turns what is above it inside out.
    for (let i = 0; i < n * n; i++) for (let z = 1; z < n; z++) inside[i + n * n * z] ^= inside[i + n * n * (z - 1)];
    const least = -2, most = Math.max(1, ...squared.filter((d, i) => inside[i]).map(Math.sqrt)), rows = Math.ceil(n / this.columns);
    const image = new Uint8Array(n * this.columns * n * rows);
    for (let z = 0; z < n; z++)
      for (let y = 0; y < n; y++)
        for (let x = 0; x < n; x++) {
          const i = x + n * (y + n * z), depth = (inside[i] ? 1 : -1) * Math.sqrt(squared[i]);
          image[(n * Math.floor(z / this.columns) + y) * n * this.columns + n * (z % this.columns) + x] = 255 * Math.min(1, Math.max(0, (depth - least) / (most - least)));
        }
    this.map.value.dispose();
    this.map.value = new THREE.DataTexture(image, n * this.columns, n * rows, THREE.LuminanceFormat, THREE.UnsignedByteType);
    this.map.value.minFilter = this.map.value.magFilter = THREE.LinearFilter, this.map.value.generateMipmaps = false, this.map.value.needsUpdate = true;
    this.box.value.set(...from, cell), this.range.value.set(least * cell, most * cell);
    this.values = { image, from, cell, least, most };
  }
  // Exact distances of the nodes near a triangle, in cells; and lines along z that it crosses.
  addTriangle([a, b, c], nearest, squared, inside) {
    const n = this.across, point = new THREE.Vector3(), at = new THREE.Vector3(), triangle = new THREE.Triangle(new THREE.Vector3(...a), new THREE.Vector3(...b), new THREE.Vector3(...c));
    const [lo, hi] = [0, 1, 2].map((k) => [Math.min(a[k], b[k], c[k]), Math.max(a[k], b[k], c[k])]).reduce(([l, h], [x, y]) => [[...l, x], [...h, y]], [[], []]);
    const range = (k, more) => [Math.max(0, Math.ceil(lo[k] - more)), Math.min(n - 1, Math.floor(hi[k] + more))];
    const [x0, x1] = range(0, 1), [y0, y1] = range(1, 1), [z0, z1] = range(2, 1);
    for (let z = z0; z <= z1; z++)
      for (let y = y0; y <= y1; y++)
        for (let x = x0; x <= x1; x++) {
          triangle.closestPointToPoint(point.set(x, y, z), at);
          const i = x + n * (y + n * z), d = at.distanceToSquared(point);
          if (d < squared[i]) squared[i] = d, nearest[3 * i] = at.x, nearest[3 * i + 1] = at.y, nearest[3 * i + 2] = at.z;
        }
    // Lines are a little beside the nodes: no vertex of a regular model is on one.
    const beside = [0.00137, 0.00231], area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    if (area === 0) return;
    for (let y = y0; y <= y1; y++)
      for (let x = x0; x <= x1; x++) {
        const px = x + beside[0], py = y + beside[1], side = (p, q) => ((q[0] - p[0]) * (py - p[1]) - (q[1] - p[1]) * (px - p[0])) / area;
        const u = side(b, c), v = side(c, a), w = 1 - u - v;
        if (u < 0 || v < 0 || w < 0) continue;
        const z = Math.ceil(u * a[2] + v * b[2] + w * c[2]);
        if (z < n) inside[x + n * (y + n * Math.max(0, z))] ^= 1;
      }
  }
  // The nearest places of the neighbours are candidates, in two sweeps up and down along each axis (P.-E. Danielsson,
  // Euclidean distance mapping, 1980).
  spread(nearest, squared) {
    const n = this.across, steps = [1, n, n * n];
    for (let pass = 0; pass < 4; pass++) {
      const up = pass % 2 === 0;
      for (let m = 0; m < n * n * n; m++) {
        const i = up ? m : n * n * n - 1 - m, place = [i % n, Math.floor(i / n) % n, Math.floor(i / (n * n))];
        for (let k = 0; k < 3; k++) {
          const j = up ? i - steps[k] : i + steps[k];
          if (up ? place[k] === 0 : place[k] === n - 1) continue;
          if (squared[j] === Infinity) continue;
          const dx = nearest[3 * j] - place[0], dy = nearest[3 * j + 1] - place[1], dz = nearest[3 * j + 2] - place[2], d = dx * dx + dy * dy + dz * dz;
          if (d < squared[i]) squared[i] = d, nearest[3 * i] = nearest[3 * j], nearest[3 * i + 1] = nearest[3 * j + 1], nearest[3 * i + 2] = nearest[3 * j + 2];
        }
      }
    }
  }
}
const depthField = new DepthField();

// GLSL: depthAt(p), between the eight nodes around a place at rest.
const depthShader = `
  uniform sampler2D depthMap; uniform vec4 depthBox; uniform vec2 depthRange;
  float depthSlice(vec2 at, float z) {
    vec2 tile = vec2(mod(z, ACROSS_COLUMNS), floor(z / ACROSS_COLUMNS));
    return texture2D(depthMap, (tile * ACROSS + at + 0.5) / (ACROSS * vec2(ACROSS_COLUMNS, ACROSS_ROWS))).r;
  }
  float depthAt(vec3 p) {
    vec3 g = clamp((p - depthBox.xyz) / depthBox.w, 0.0, ACROSS - 1.0);
    float z = min(floor(g.z), ACROSS - 2.0);
    return mix(depthRange.x, depthRange.y, mix(depthSlice(g.xy, z), depthSlice(g.xy, z + 1.0), g.z - z));
  }
`.replace(/ACROSS_COLUMNS/g, depthField.columns.toFixed(1)).replace(/ACROSS_ROWS/g, Math.ceil(depthField.across / depthField.columns).toFixed(1)).replace(/ACROSS/g, depthField.across.toFixed(1));
