// Corners of triangles in groups that share a normal: at one vertex, of one kind, across edges that bend less than 40 degrees.
// Triangles live in slots; after some have changed, only the groups at their vertices are made anew.
const crease = 0.766, noKind = 255;

const grown = (array, length) => {
  if (array.length >= length) return array;
  const more = new array.constructor(Math.max(length, 2 * array.length));
  more.set(array);
  return more;
};

class CornerGroups {
  constructor() {
    this.slots = 0, this.groups = 0;
    this.vertex = new Uint32Array(0), this.next = new Int32Array(0), this.group = new Int32Array(0);  // of each corner
    this.kind = new Uint8Array(0);                                                                    // of each slot
    this.first = new Int32Array(0), this.vertices = 0;                                                // of each vertex: its first corner
    this.members = new Uint32Array(0), this.groupVertex = new Uint32Array(0), this.free = [];         // of each group
    this.touched = new Set();
  }
  reserve(vertices, slots) {
    this.vertex = grown(this.vertex, 3 * slots), this.next = grown(this.next, 3 * slots), this.group = grown(this.group, 3 * slots);
    this.kind = grown(this.kind, slots), this.first = grown(this.first, vertices);
    if (vertices > this.vertices) this.first.fill(-1, this.vertices, vertices), this.vertices = vertices;
    if (slots > this.slots) this.kind.fill(noKind, this.slots, slots), this.group.fill(-1, 3 * this.slots, 3 * slots), this.slots = slots;
  }
  has(slot) { return slot < this.slots && this.kind[slot] !== noKind; }
  put(slot, a, b, c, kind) {
    this.remove(slot);
    this.kind[slot] = kind;
    [a, b, c].forEach((v, k) => {
      const corner = 3 * slot + k;
      this.vertex[corner] = v, this.group[corner] = -1, this.next[corner] = this.first[v], this.first[v] = corner;
      this.touched.add(v);
    });
  }
  remove(slot) {
    if (!this.has(slot)) return;
    for (let corner = 3 * slot; corner < 3 * slot + 3; corner++) {
      const v = this.vertex[corner];
      let at = this.first[v];
      if (at === corner) this.first[v] = this.next[corner];
      else {
        while (this.next[at] !== corner) at = this.next[at];
        this.next[at] = this.next[corner];
      }
      this.leave(corner);
      this.touched.add(v);
    }
    this.kind[slot] = noKind;
  }
  leave(corner) {
    const g = this.group[corner];
    if (g >= 0 && --this.members[g] === 0) this.free.push(g);
    this.group[corner] = -1;
  }
  join(corner, g) {
    this.group[corner] = g, this.members[g]++;
  }
  fresh(v) {
    const g = this.free.length ? this.free.pop() : this.groups++;
    this.members = grown(this.members, this.groups), this.groupVertex = grown(this.groupVertex, this.groups);
    this.members[g] = 0, this.groupVertex[g] = v;
    return g;
  }
  // Makes the groups of all vertices whose triangles have changed.
  regroup(position) {
    for (const v of this.touched) this.regroupVertex(v, position);
    this.touched.clear();
  }
  regroupVertex(v, position) {
    const corners = [], top = [];
    for (let c = this.first[v]; c >= 0; c = this.next[c]) this.leave(c), corners.push(c), top.push(top.length);
    const flat = corners.map((c) => this.flat(c / 3 | 0, position));
    const root = (i) => { while (top[i] !== i) i = top[i]; return i; };
    for (let i = 0; i < corners.length; i++)
      for (let j = 0; j < i; j++) {
        if (!this.smooth(corners[i], corners[j])) continue;
        const [a, b] = [flat[i], flat[j]];
        if (a[0] * b[0] + a[1] * b[1] + a[2] * b[2] > crease) top[root(i)] = root(j);
      }
    const of = new Map();
    corners.forEach((c, i) => {
      const r = root(i);
      if (!of.has(r)) of.set(r, this.fresh(v));
      this.join(c, of.get(r));
    });
  }
  // Two corners of one vertex whose triangles have a common edge and are of one kind.
  smooth(a, b) {
    if (this.kind[a / 3 | 0] !== this.kind[b / 3 | 0]) return false;
    return this.vertex[cornerAfter(a)] === this.vertex[cornerBefore(b)] || this.vertex[cornerBefore(a)] === this.vertex[cornerAfter(b)];
  }
  flat(slot, p) {
    const [a, b, c] = [3 * this.vertex[3 * slot], 3 * this.vertex[3 * slot + 1], 3 * this.vertex[3 * slot + 2]];
    const ux = p[b] - p[a], uy = p[b + 1] - p[a + 1], uz = p[b + 2] - p[a + 2], wx = p[c] - p[a], wy = p[c + 1] - p[a + 1], wz = p[c + 2] - p[a + 2];
    const x = uy * wz - uz * wy, y = uz * wx - ux * wz, z = ux * wy - uy * wx, size = Math.hypot(x, y, z) || 1;
    return [x / size, y / size, z / size];
  }
  // Positions and normals of all groups, into arrays of at least three numbers a group. A face counts by the sine of its angle
  // at the corner: by their areas, long triangles beside short ones would decide, and coarse meshes look faceted.
  place(p, position, normal) {
    const { vertex, group, kind } = this;
    normal.fill(0, 0, 3 * this.groups);
    for (let s = 0, i = 0; s < this.slots; s++, i += 3) {
      if (kind[s] === noKind) continue;
      const a = 3 * vertex[i], b = 3 * vertex[i + 1], c = 3 * vertex[i + 2];
      const ax = p[a], ay = p[a + 1], az = p[a + 2];
      const ux = p[b] - ax, uy = p[b + 1] - ay, uz = p[b + 2] - az, wx = p[c] - ax, wy = p[c + 1] - ay, wz = p[c + 2] - az;
      const x = uy * wz - uz * wy, y = uz * wx - ux * wz, z = ux * wy - uy * wx;
      const vx = p[c] - p[b], vy = p[c + 1] - p[b + 1], vz = p[c + 2] - p[b + 2];
      const ab = ux * ux + uy * uy + uz * uz, ac = wx * wx + wy * wy + wz * wz, bc = vx * vx + vy * vy + vz * vz;
      for (let k = 0; k < 3; k++) {
        const g = 3 * group[i + k], sides = k === 0 ? ab * ac : k === 1 ? ab * bc : ac * bc, weight = sides > 0 ? 1 / Math.sqrt(sides) : 0;
        normal[g] += weight * x, normal[g + 1] += weight * y, normal[g + 2] += weight * z;
      }
    }
    for (let g = 0; g < this.groups; g++) {
      const v = 3 * this.groupVertex[g], o = 3 * g;
      position[o] = p[v], position[o + 1] = p[v + 1], position[o + 2] = p[v + 2];
      const size = Math.hypot(normal[o], normal[o + 1], normal[o + 2]) || 1;
      normal[o] /= size, normal[o + 1] /= size, normal[o + 2] /= size;
    }
  }
}
const cornerAfter = (corner) => (corner % 3 === 2 ? corner - 2 : corner + 1);
const cornerBefore = (corner) => (corner % 3 === 0 ? corner + 2 : corner - 1);
