// The eye goes with a piece: a click of the orbit tool on it. What was clicked is known by its place in the material.
const follow = {
  rest: null, vertex: -1, members: null, revision: -1,
  click(x, y) {
    const { origin, ray } = rayAt(x, y), hit = surface.hit(origin, ray), was = this.rest !== null;
    this.rest = null;
    if (hit && live.rest.length > 0) {
      const v = surface.corners.vertex[3 * hit.slot + hit.bary.indexOf(Math.max(...hit.bary))];
      this.rest = [0, 1, 2].map((k) => live.rest[3 * v + k]), this.vertex = v, this.revision = -1;
      notice({ notice: "The view goes with this piece. A click beside the body lets it stay." });
    } else if (was) notice({ notice: "The view stays." });
    redraw();
    return true;
  },
  // The vertices of the piece, anew after each cut: all that triangles join to the one that was clicked.
  find() {
    const c = surface.corners, top = new Int32Array(live.vertices).map((x, i) => i);
    const root = (i) => {
      while (top[i] !== i) i = top[i] = top[top[i]];
      return i;
    };
    for (let s = 0; s < c.slots; s++) {
      if (c.kind[s] === noKind) continue;
      const a = root(c.vertex[3 * s]);
      for (let k = 1; k < 3; k++) top[root(c.vertex[3 * s + k])] = a;
    }
    let least = Infinity;
    for (let v = 0; v < live.vertices; v++) {
      if (c.first[v] < 0) continue;
      const d = Math.hypot(...this.rest.map((x, k) => live.rest[3 * v + k] - x));
      if (d < least || (d === least && v === this.vertex)) least = d, this.vertex = v;
    }
    const own = root(this.vertex);
    this.members = [];
    for (let v = 0; v < live.vertices; v++) if (c.first[v] >= 0 && root(v) === own) this.members.push(v);
    this.revision = live.revision;
  },
  update() {},
  moved() {
    if (!this.rest || live.rest.length < 3 * live.vertices) return;
    if (this.revision !== live.revision) this.find();
    const sum = new THREE.Vector3();
    for (const v of this.members) sum.x += live.position[3 * v], sum.y += live.position[3 * v + 1], sum.z += live.position[3 * v + 2];
    // A tenth of the way with each frame: the eye does not shake.
    view.target.lerp(sum.divideScalar(Math.max(1, this.members.length)), 0.1);
    placeCamera();
  },
};
clickTools.orbit = (x, y) => follow.click(x, y);
