// How wide a wound is: of each vertex of a wall, how far the vertex is that had the same place before the cut. At the tip of
// a crack there is none, and the wound is closed.
class Wounds {
  constructor() { this.next = new Int32Array(0), this.matched = 0; }
  // Without places at rest, no wound is known.
  clear() { this.matched = 0; }
  // Rings of the vertices that have the same place at rest. `used`: whether a vertex has triangles.
  match(rest, vertices, used) {
    this.matched = vertices;
    if (this.next.length < vertices) this.next = new Int32Array(Math.ceil(1.3 * vertices));
    const bits = new Int32Array(rest.buffer, rest.byteOffset, 3 * vertices), first = new Map();
    for (let v = 0; v < vertices; v++) {
      this.next[v] = v;
      if (!used(v)) continue;
      const i = 3 * v, key = (Math.imul(bits[i], 73856093) ^ Math.imul(bits[i + 1], 19349663) ^ Math.imul(bits[i + 2], 83492791)) | 0;
      const other = first.get(key);
      if (other === undefined) first.set(key, v);
      else if (rest[3 * other] === rest[i] && rest[3 * other + 1] === rest[i + 1] && rest[3 * other + 2] === rest[i + 2]) this.next[v] = this.next[other], this.next[other] = v;
    }
  }
  // The distance to the nearest vertex of the ring; 0 without one, or where no ring is known.
  gap(v, p) {
    if (v >= this.matched) return 0;
    let least = Infinity;
    for (let w = this.next[v]; w !== v; w = this.next[w]) least = Math.min(least, Math.hypot(p[3 * w] - p[3 * v], p[3 * w + 1] - p[3 * v + 1], p[3 * w + 2] - p[3 * v + 2]));
    return least === Infinity ? 0 : least;
  }
}
