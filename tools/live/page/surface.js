// The surface that moves: skin and walls of cracks share the vertices of their corner groups, and the lips of cuts are drawn.
// Colours of skin, walls and lips, and of the light that comes through.
const looks = {
  clay: { skin: 0xe0803a, wall: 0xf6d8a8, lip: 0x7a3212, glow: 0xff9a58, inner: 0xffe9c8 },
  tissue: { skin: 0xd98880, wall: 0xb23a3f, lip: 0x6e1420, glow: 0xff8f80, inner: 0xff6a60 },
  apple: { skin: 0xb8342c, wall: 0xf6efd2, lip: 0x5e120e, glow: 0xff7a50, inner: 0xfff6d8 },
  gelatine: { skin: 0x4fae5c, wall: 0xa5e08a, lip: 0x1d5a2c, glow: 0x9cff9a, inner: 0xd8ffc0 },
};

// Light goes into soft material: shaded sides keep a glow, edges towards the eye are brighter, what is near the ground is darker.
function softMaterial() {
  const material = new THREE.MeshPhongMaterial({ specular: 0x1b1a19, shininess: 26, side: THREE.DoubleSide });
  material.userData.glow = new THREE.Color();
  material.onBeforeCompile = (shader) => {
    shader.uniforms.glow = { value: material.userData.glow }, shader.uniforms.groundPlane = groundPlane;
    shader.fragmentShader = "uniform vec3 glow; uniform vec4 groundPlane;\n" + shader.fragmentShader.replace("#include <envmap_fragment>", `
      vec3 toEye = normalize(vViewPosition);
      float grazing = pow(1.0 - abs(dot(normal, toEye)), 2.5);
      outgoingLight += glow * (0.04 + 0.34 * grazing) * (0.35 + 0.65 * max(0.0, dot(normal, groundPlane.xyz) * 0.5 + 0.5));
      float height = dot(-vViewPosition, groundPlane.xyz) + groundPlane.w;
      outgoingLight *= mix(0.72, 1.0, smoothstep(0.0, 0.42, height + 0.25 * max(0.0, dot(normal, groundPlane.xyz))));
      // Above a shoulder, brightness approaches 1 and never clips: pale walls keep their shading. Hues stay.
      float shoulder = 0.75, most = max(outgoingLight.r, max(outgoingLight.g, outgoingLight.b));
      if (most > shoulder) outgoingLight *= (1.0 - (1.0 - shoulder) * exp((shoulder - most) / (1.0 - shoulder))) / most;
      #include <envmap_fragment>`);
  };
  return material;
}

const dynamic = (length) => new THREE.BufferAttribute(new Float32Array(length), 3).setUsage(THREE.DynamicDrawUsage);

class Surface {
  constructor() {
    this.corners = new CornerGroups();
    this.changed = false, this.topology = false;
    const mesh = (material, order) => {
      const m = new THREE.Mesh(new THREE.BufferGeometry(), material);
      m.frustumCulled = false, m.renderOrder = order, m.castShadow = m.receiveShadow = true;
      scene.add(m);
      return m;
    };
    // Transparent skin is drawn in three passes: what faces away, the depth of what faces the eye, and this itself. So the
    // order of triangles does not show.
    this.skin = mesh(softMaterial(), 4);
    this.inner = mesh(this.skin.material.clone(), 3.8);
    this.inner.material.onBeforeCompile = this.skin.material.onBeforeCompile, this.inner.material.userData = this.skin.material.userData;
    this.inner.material.side = THREE.BackSide, this.inner.material.transparent = true, this.inner.material.depthWrite = false;
    this.depth = mesh(new THREE.MeshBasicMaterial({ colorWrite: false, transparent: true }), 3.9);
    this.inner.castShadow = this.depth.castShadow = false;
    this.walls = mesh(softMaterial(), 3);
    this.walls.material.side = THREE.FrontSide;  // closed sheets stand at one place; each is seen from its own side
    this.walls.material.shadowSide = THREE.DoubleSide;
    const lines = (color, opacity, order) => {
      const l = new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ color, transparent: true, opacity }));
      l.frustumCulled = false, l.renderOrder = order;
      scene.add(l);
      return l;
    };
    this.wire = lines(0x26323f, 0.4, 5), this.lips = lines(0x7a3212, 0.9, 3.85);  // before the skin, which those behind it are seen through
    for (const m of [this.skin, this.inner, this.depth, this.walls]) m.material.polygonOffset = true, m.material.polygonOffsetFactor = m.material.polygonOffsetUnits = 1;
  }
  dress() {
    const look = looks[state.look] ?? looks.clay;
    this.skin.material.color.set(look.skin), this.inner.material.color.set(look.skin), this.walls.material.color.set(look.wall), this.lips.material.color.set(look.lip);
    this.skin.material.userData.glow.set(look.glow), this.walls.material.userData.glow.set(look.inner);
  }
  // A whole surface: the groups of corners wait for the positions of its frame.
  begin(arrived) {
    this.corners = new CornerGroups();
    this.corners.reserve(arrived.vertices, arrived.faces);
    for (let s = 0; s < arrived.faces; s++) this.put(s, arrived.corners.subarray(3 * s, 3 * s + 3), arrived.patch[s]);
    this.topology = true;
  }
  change(delta) {
    let slots = this.corners.slots;
    for (let i = 0; i < delta.patch.length; i++) slots = Math.max(slots, delta.added[4 * i] + 1);
    this.corners.reserve(delta.vertices, slots);
    for (const slot of delta.removed) this.corners.remove(slot);
    for (let i = 0; i < delta.patch.length; i++) this.put(delta.added[4 * i], delta.added.subarray(4 * i + 1, 4 * i + 4), delta.patch[i]);
    this.topology = true;
  }
  put(slot, [a, b, c], patch) {
    if (a === b || b === c || a === c) this.corners.remove(slot);
    else this.corners.put(slot, a, b, c, patch === 0 ? 0 : 1);
  }
  beforeDraw() { this.arrive(); }
  // Takes the newest frame, if there is one: a change of triangles waits for its positions.
  arrive() {
    if (!this.changed) return;
    this.changed = false;
    if (!takeFrame()) return;
    const { corners } = this;
    if (this.topology) corners.regroup(live.position), this.fill(), this.topology = false;
    corners.place(live.position, this.position.array, this.normal.array);
    this.position.needsUpdate = this.normal.needsUpdate = true;
    this.points.array.set(live.position.subarray(0, 3 * live.vertices));
    this.points.needsUpdate = true;
    for (const layer of layers) if (layer.moved) layer.moved();
  }
  // Buffers of the geometry, made anew where they are too small; others keep their size and say how much counts.
  fill() {
    const c = this.corners, room = (have, need) => !have || have.array.length < need;
    if (room(this.position, 3 * c.groups)) {
      const length = 3 * Math.ceil(1.3 * c.groups);
      this.position = dynamic(length), this.normal = dynamic(length);
    }
    if (room(this.points, 3 * live.vertices)) this.points = dynamic(Math.ceil(1.3 * live.vertices) * 3);
    const skin = [], walls = [], lips = [];
    for (let s = 0; s < c.slots; s++) {
      if (c.kind[s] === noKind) continue;
      const to = c.kind[s] === 0 ? skin : walls;
      to.push(c.group[3 * s], c.group[3 * s + 1], c.group[3 * s + 2]);
      if (c.kind[s] !== 0) for (let k = 3 * s; k < 3 * s + 3; k++) if (this.isLip(k)) lips.push(c.vertex[k], c.vertex[cornerAfter(k)]);
    }
    this.bind(this.skin, skin, true);
    this.inner.geometry = this.depth.geometry = this.skin.geometry;
    this.bind(this.walls, walls, true), this.bind(this.lips, lips, false);
    this.wireStale = true;
    this.update();
  }
  bind(mesh, index, shaded) {
    mesh.geometry.dispose();
    mesh.geometry = new THREE.BufferGeometry().setAttribute("position", shaded ? this.position : this.points);
    if (shaded) mesh.geometry.setAttribute("normal", this.normal);
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
    const m = this.skin.material, through = state.skin < 1;
    m.opacity = this.inner.material.opacity = state.skin;
    if (m.transparent !== through) m.transparent = through, m.side = through ? THREE.FrontSide : THREE.DoubleSide, m.shadowSide = THREE.DoubleSide, m.needsUpdate = true;
    this.skin.visible = state.skin > 0, this.inner.visible = this.depth.visible = through && state.skin > 0;
    this.walls.visible = state.walls && !this.walls.empty;
    this.lips.visible = state.walls && state.skin > 0 && !this.lips.empty;
    this.fillWire();
    this.wire.visible = state.wire && !this.wire.empty;
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
