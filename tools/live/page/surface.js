// The surface that moves: skin and walls of cracks share the vertices of their corner groups, and the lips of cuts are drawn.
const dynamic = (length, size = 3) => new THREE.BufferAttribute(new Float32Array(length), size).setUsage(THREE.DynamicDrawUsage);

class Surface {
  constructor() {
    this.corners = new CornerGroups(), this.paint = new Paint(), this.wounds = new Wounds();
    this.changed = false, this.topology = false, this.painted = null;
    const mesh = (material, order) => {
      const m = new THREE.Mesh(new THREE.BufferGeometry(), material);
      m.frustumCulled = false, m.renderOrder = order, m.castShadow = m.receiveShadow = true;
      scene.add(m);
      return m;
    };
    // Transparent skin is drawn in three passes: what faces away, the depth of what faces the eye, and this itself. So the
    // order of triangles does not show.
    this.skinValues = softValues(false), this.wallValues = softValues(true);
    this.plain = this.skinMaterials();
    this.skin = mesh(this.plain.front, 4), this.inner = mesh(this.plain.back, 3.8);
    this.depth = mesh(new THREE.MeshBasicMaterial({ colorWrite: false, transparent: true, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 }), 3.9);
    this.inner.castShadow = this.depth.castShadow = false;
    // Closed sheets stand at one place; each is seen from its own side.
    this.walls = mesh(softMaterial(this.wallValues, { side: THREE.FrontSide, shadowSide: THREE.DoubleSide }), 3);
    const lines = (color, opacity, order) => {
      const l = new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ color, transparent: true, opacity }));
      l.frustumCulled = false, l.renderOrder = order;
      scene.add(l);
      return l;
    };
    this.wire = lines(0x26323f, 0.4, 5), this.lips = lines(0x7a3212, 0.9, 3.85);  // before the skin, which those behind it are seen through
  }
  // What faces the eye, and what faces away; with an image, or plain.
  skinMaterials(more = {}) {
    const front = softMaterial(this.skinValues, more), back = softMaterial(this.skinValues, { ...more, side: THREE.BackSide, transparent: true, depthWrite: false });
    front.userData.painted = back.userData.painted = more.vertexColors !== undefined;
    return { front, back };
  }
  fronts() { return [this.skin.material].flat(); }
  dress() {
    const look = looks[state.look] ?? looks.clay;
    for (const material of [...this.fronts(), ...[this.inner.material].flat(), this.walls.material]) dressMaterial(material, look);
    this.lips.material.color.set(look.lip);
    lighting.heated.value = state.stress && live.skinStress ? 1 : 0;
  }
  // Materials anew, where the model has come with colours, or they are not to be shown.
  repaint() {
    for (const material of this.painted ?? []) material.front.dispose(), material.back.dispose();
    const shown = this.paint.has && this.paint.materials.length > 0 && state.paint;
    this.painted = shown ? [...this.paint.textures, null].map((map) => this.skinMaterials({ vertexColors: THREE.VertexColors, ...(map ? { map } : {}) })) : null;
    this.skin.material = shown ? this.painted.map(({ front }) => front) : this.plain.front;
    this.inner.material = shown ? this.painted.map(({ back }) => back) : this.plain.back;
    this.dress();
    if (this.position && live.position.length > 0) this.fill(), this.move();
    $("paint").disabled = !(this.paint.has && this.paint.materials.length > 0);
    redraw();
  }
  // A whole surface: the groups of corners wait for the positions of its frame.
  begin(arrived) {
    this.corners = new CornerGroups();
    this.corners.reserve(arrived.vertices, arrived.faces);
    this.paint.clear();
    for (let s = 0; s < arrived.faces; s++) this.put(s, arrived.corners.subarray(3 * s, 3 * s + 3), arrived.patch[s]);
    if (arrived.paint) this.paint.reserve(arrived.faces);
    for (let s = 0; arrived.paint && s < arrived.faces; s++) this.paint.put(s, arrived.paint, s);
    if (arrived.rest) this.placeAtRest(arrived.rest, null);
    this.topology = true;
    this.repaint();
  }
  change(delta) {
    let slots = this.corners.slots;
    for (let i = 0; i < delta.patch.length; i++) slots = Math.max(slots, delta.added[4 * i] + 1);
    this.corners.reserve(delta.vertices, slots);
    for (const slot of delta.removed) this.corners.remove(slot);
    for (let i = 0; i < delta.patch.length; i++) this.put(delta.added[4 * i], delta.added.subarray(4 * i + 1, 4 * i + 4), delta.patch[i]);
    if (delta.paint) this.paint.reserve(slots);
    for (let i = 0; delta.paint && i < delta.patch.length; i++) this.paint.put(delta.added[4 * i], delta.paint, i);
    if (delta.rest) this.placeAtRest(delta.rest, delta.placed);
    this.topology = true;
  }
  put(slot, [a, b, c], patch) {
    if (a === b || b === c || a === c) this.corners.remove(slot);
    else this.corners.put(slot, a, b, c, patch === 0 ? 0 : 1);
  }
  // Places in the material of some vertices, or of all, as shown. With all of them, the depth below the skin is made anew.
  placeAtRest(places, vertices) {
    live.rest = grown(live.rest, 3 * live.vertices);
    const rows = places.length / 3;
    for (let i = 0; i < rows; i++)
      for (let k = 0; k < 3; k++) live.rest[3 * (vertices ? vertices[i] : i) + k] = (places[3 * i + k] - about.middle[k]) / about.unit;
    if (vertices) return;
    const c = this.corners, skin = [], size = [0, 1, 2].map((k) => live.told.box[1][k] - live.told.box[0][k]);
    for (let s = 0; s < c.slots; s++) if (c.kind[s] === 0) skin.push(c.vertex[3 * s], c.vertex[3 * s + 1], c.vertex[3 * s + 2]);
    const longest = size.indexOf(Math.max(...size));
    lighting.axis.value.set(...[0, 1, 2].map((k) => Number(k === longest))), lighting.vertical.value.copy(upward());
    if (skin.length > 0) depthField.fill(live.rest, skin);
  }
  beforeDraw() {
    lighting.up.value.copy(upward()).transformDirection(camera.matrixWorldInverse);
    lighting.sun.value.copy(world.sun.position).transformDirection(camera.matrixWorldInverse);
    this.arrive();
  }
  // Takes the newest frame, if there is one: a change of triangles waits for its positions.
  arrive() {
    if (!this.changed) return;
    this.changed = false;
    if (!takeFrame()) return;
    if (this.topology) this.corners.regroup(live.position), this.fill(), this.topology = false;
    this.move();
    for (const layer of layers) if (layer.moved) layer.moved();
  }
  // Positions, normals, widths of wounds and stresses as they are now.
  move() {
    const { corners } = this, { groupVertex, groups, group } = corners, gap = this.gap.array, heat = this.heat.array;
    corners.place(live.position, this.position.array, this.normal.array);
    for (const g of this.wallGroups) gap[g] = this.wounds.gap(groupVertex[g], live.position);
    const stress = state.stress && live.skinStress, scale = stress ? 1 / inside.range() : 0;
    for (let g = 0; stress && g < groups; g++) heat[g] = stress[groupVertex[g]] * scale;
    lighting.heated.value = stress ? 1 : 0;
    this.position.needsUpdate = this.normal.needsUpdate = this.gap.needsUpdate = this.heat.needsUpdate = true;
    if (this.arranged) {
      const { corners: list, position, normal, hot } = this.arranged;
      for (let i = 0; i < list.length; i++) {
        const g = group[list[i]], from = 3 * g, to = 3 * i;
        for (let k = 0; k < 3; k++) position.array[to + k] = this.position.array[from + k], normal.array[to + k] = this.normal.array[from + k];
        hot.array[i] = heat[g];
      }
      position.needsUpdate = normal.needsUpdate = hot.needsUpdate = true;
    }
    this.points.array.set(live.position.subarray(0, 3 * live.vertices));
    this.points.needsUpdate = true;
  }
  // Buffers of the geometry, made anew where they are too small; others keep their size and say how much counts.
  fill() {
    const c = this.corners, room = (have, need) => !have || have.array.length < need;
    if (room(this.position, 3 * c.groups)) {
      const length = Math.ceil(1.3 * c.groups);
      this.position = dynamic(3 * length), this.normal = dynamic(3 * length), this.rest = dynamic(3 * length), this.gap = dynamic(length, 1), this.heat = dynamic(length, 1);
    }
    if (room(this.points, 3 * live.vertices)) this.points = dynamic(Math.ceil(1.3 * live.vertices) * 3);
    const skin = [], walls = [], lips = [], slots = [], wallGroups = new Set();
    for (let s = 0; s < c.slots; s++) {
      if (c.kind[s] === noKind) continue;
      const to = c.kind[s] === 0 ? skin : walls;
      to.push(c.group[3 * s], c.group[3 * s + 1], c.group[3 * s + 2]);
      if (c.kind[s] === 0) slots.push(s);
      else for (let k = 3 * s; k < 3 * s + 3; k++) {
        wallGroups.add(c.group[k]);
        if (this.isLip(k)) lips.push(c.vertex[k], c.vertex[cornerAfter(k)]);
      }
    }
    this.wallGroups = [...wallGroups];
    this.fillRest();
    this.arranged = this.painted ? this.arrange(slots) : null;
    if (!this.arranged) this.bind(this.skin, skin, true);
    this.inner.geometry = this.depth.geometry = this.skin.geometry;
    this.bind(this.walls, walls, true), this.bind(this.lips, lips, false);
    this.wireStale = true;
    this.update();
  }
  fillRest() {
    const { groups, groupVertex, first } = this.corners, rest = this.rest.array;
    if (live.rest.length < 3 * live.vertices) return this.wounds.clear();
    for (let g = 0; g < groups; g++) {
      const v = 3 * groupVertex[g];
      rest[3 * g] = live.rest[v], rest[3 * g + 1] = live.rest[v + 1], rest[3 * g + 2] = live.rest[v + 2];
    }
    this.rest.needsUpdate = true;
    if (this.wallGroups.length > 0) this.wounds.match(live.rest, live.vertices, (v) => first[v] >= 0);
  }
  // The painted skin has its own corners: seams of images run between triangles of one group.
  arrange(slots) {
    const a = this.paint.arranged(slots), n = a.corners.length, { skin } = this;
    Object.assign(a, { position: dynamic(3 * n), normal: dynamic(3 * n), hot: dynamic(n, 1) });
    skin.geometry.dispose();
    skin.geometry = new THREE.BufferGeometry().setAttribute("position", a.position).setAttribute("normal", a.normal).setAttribute("heat", a.hot)
      .setAttribute("uv", new THREE.BufferAttribute(a.uv, 2)).setAttribute("color", new THREE.BufferAttribute(a.tint, 3, true));
    for (const { start, count, material } of a.groups) skin.geometry.addGroup(start, count, material);
    return a;
  }
  bind(mesh, index, shaded) {
    mesh.geometry.dispose();
    mesh.geometry = new THREE.BufferGeometry().setAttribute("position", shaded ? this.position : this.points);
    if (shaded) for (const name of ["normal", "rest", "gap", "heat"]) mesh.geometry.setAttribute(name, this[name]);
    mesh.geometry.setIndex(new THREE.BufferAttribute(new Uint32Array(index), 1));
    mesh.empty = index.length === 0;
  }
  // The edge behind a corner of a wall has skin on its other side.
  isLip(corner) {
    const c = this.corners, a = c.vertex[corner], b = c.vertex[cornerAfter(corner)];
    for (let at = c.first[a]; at >= 0; at = c.next[at])
      if (c.kind[at / 3 | 0] === 0 && (c.vertex[cornerAfter(at)] === b || c.vertex[cornerBefore(at)] === b)) return true;
    return false;
  }
  fillWire() {
    if (!state.wire || !this.wireStale || !this.points) return;
    const c = this.corners, edges = [];
    for (let i = 0; i < 3 * c.slots; i++)
      if (c.kind[i / 3 | 0] !== noKind && c.vertex[i] < c.vertex[cornerAfter(i)]) edges.push(c.vertex[i], c.vertex[cornerAfter(i)]);
    this.bind(this.wire, edges, false);
    this.wireStale = false;
  }
  update() {
    const through = state.skin < 1;
    for (const m of [this.inner.material].flat()) m.opacity = state.skin;
    for (const m of this.fronts()) {
      m.opacity = state.skin;
      if (m.transparent !== through) m.transparent = through, m.side = through ? THREE.FrontSide : THREE.DoubleSide, m.shadowSide = THREE.DoubleSide, m.needsUpdate = true;
    }
    this.skin.visible = state.skin > 0, this.inner.visible = this.depth.visible = through && state.skin > 0;
    this.walls.visible = state.walls && !this.walls.empty;
    this.lips.visible = state.walls && state.skin > 0 && !this.lips.empty;
    this.fillWire();
    this.wire.visible = state.wire && !this.wire.empty;
    lighting.heated.value = state.stress && live.skinStress ? 1 : 0, lighting.covered.value = state.skin;
  }
  // The first triangle that a ray meets, in shown coordinates: { slot, bary, distance, point, normal, skin }; null: none.
  hit(origin, ray) {
    this.arrive();
    const c = this.corners, p = live.position, a = new THREE.Vector3(), e = new THREE.Vector3(), f = new THREE.Vector3(), q = new THREE.Vector3(), s = new THREE.Vector3();
    let best = null, least = Infinity;
    for (let slot = 0; slot < c.slots; slot++) {
      if (c.kind[slot] === noKind) continue;
      a.fromArray(p, 3 * c.vertex[3 * slot]);
      e.fromArray(p, 3 * c.vertex[3 * slot + 1]).sub(a), f.fromArray(p, 3 * c.vertex[3 * slot + 2]).sub(a);
      q.crossVectors(ray, f);
      const det = e.dot(q);
      if (det < 1e-14) continue;  // seen from behind
      s.subVectors(origin, a);
      const u = s.dot(q) / det;
      if (u < 0 || u > 1) continue;
      s.cross(e);
      const v = ray.dot(s) / det, t = f.dot(s) / det;
      if (v < 0 || u + v > 1 || t <= 0 || t >= least) continue;
      least = t, best = { slot, bary: [1 - u - v, u, v], distance: t, flat: new THREE.Vector3().crossVectors(e, f).normalize() };
    }
    if (!best) return null;
    best.point = ray.clone().multiplyScalar(least).add(origin), best.skin = c.kind[best.slot] === 0;
    best.normal = this.normalAt(best);
    return best;
  }
  // The normal that is drawn: smooth within skin or wall, with a jump at sharp edges. Where corners cancel, the triangle's own.
  normalAt({ slot, bary, flat }) {
    const sum = new THREE.Vector3(), n = new THREE.Vector3();
    bary.forEach((w, k) => sum.addScaledVector(n.fromArray(this.normal.array, 3 * this.corners.group[3 * slot + k]), w));
    return sum.dot(flat) > 1e-3 ? sum.normalize() : flat;
  }
}
