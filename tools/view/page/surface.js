// Skin and the sheets of cracks, with the section that a cut-away shows.
const surfaceCache = new Map();

// Corners, normals and pieces of a surface, worked out when it is first shown. The last dozen are kept.
function surfaceData(at) {
  if (surfaceCache.has(at)) return surfaceCache.get(at);
  const s = about.surfaces[at], position = arrays[s.position], corner = arrays[s.triangles], pieceOf = arrays[s.piece];
  const patch = new Int32Array(arrays[s.patch].buffer), triangles = corner.length / 3;
  const piece = new Uint32Array(triangles), groups = new CornerGroups();
  groups.reserve(position.length / 3, triangles);
  for (let t = 0; t < triangles; t++) {
    piece[t] = pieceOf[corner[3 * t]];
    groups.put(t, corner[3 * t], corner[3 * t + 1], corner[3 * t + 2], 0);
  }
  groups.regroup(position);
  const place = new Float32Array(3 * groups.groups), normals = new Float32Array(3 * groups.groups), normal = new Float32Array(3 * corner.length);
  groups.place(position, place, normals);
  for (let i = 0; i < corner.length; i++) normal.set(normals.subarray(3 * groups.group[i], 3 * groups.group[i] + 3), 3 * i);
  const lo = [], hi = [];
  for (let v = 0; v < pieceOf.length; v++)
    for (let k = 0; k < 3; k++) {
      const p = 3 * pieceOf[v] + k, x = position[3 * v + k];
      lo[p] = Math.min(lo[p] ?? x, x), hi[p] = Math.max(hi[p] ?? x, x);
    }
  const centers = lo.map((x, i) => (x + hi[i]) / 2), middle = [0, 1, 2].map((k) => {
    const mine = (list) => list.filter((_, i) => i % 3 === k);
    return (mine(lo).reduce((m, x) => Math.min(m, x), Infinity) + mine(hi).reduce((m, x) => Math.max(m, x), -Infinity)) / 2;
  });
  const data = { position, corner, patch, pieceOf, piece, normal, centers, middle };
  if (surfaceCache.size > 12) surfaceCache.delete(surfaceCache.keys().next().value);
  surfaceCache.set(at, data);
  return data;
}

// Positions of a surface's vertices as they are shown.
function shownPositions(at) {
  const s = surfaceData(at);
  if (state.explode === 0) return s.position;
  const shift = pieceShifts(at), moved = new Float32Array(s.position);
  for (let v = 0; v < s.pieceOf.length; v++) for (let k = 0; k < 3; k++) moved[3 * v + k] += shift[3 * s.pieceOf[v] + k];
  return moved;
}

// What a surface's triangles have of the model's materials and colours.
function paintArrays(paint) {
  const places = [arrays[paint.u], arrays[paint.v]];
  return {
    material: new Uint32Array(arrays[paint.material]), tint: arrays[paint.tint],
    place: (axis, corner) => paint.lo[axis] + paint.step[axis] * places[axis][corner],
  };
}

// Images of the model, as canvases whose sides are powers of two: WebGL repeats no others.
let images = [];
async function loadImages() {
  const largest = renderer.capabilities.maxTextureSize, side = (n) => Math.min(largest, 2 ** Math.ceil(Math.log2(n)));
  images = await Promise.all((about.paint ? about.paint.images : []).map(async (url) => {
    const image = new Image();
    image.src = url;
    await image.decode();
    const canvas = document.createElement("canvas");
    canvas.width = side(image.naturalWidth), canvas.height = side(image.naturalHeight);
    canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
    return canvas;
  }));
}

class SurfaceLayer {
  constructor() {
    const solid = () => new THREE.MeshPhongMaterial({ vertexColors: THREE.VertexColors, specular: 0x161616, shininess: 30, side: THREE.DoubleSide, polygonOffsetFactor: 1, polygonOffsetUnits: 1 });
    this.skin = new THREE.Mesh(new THREE.BufferGeometry(), solid());
    this.crack = new THREE.Mesh(new THREE.BufferGeometry(), solid());
    this.crack.material.side = THREE.FrontSide;  // the two sheets stand at one place; each is seen from its own side
    for (const mesh of [this.skin, this.crack]) mesh.plain = mesh.material, mesh.withImage = [];
    this.lines = new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ color: 0x26323f, transparent: true, opacity: 0.45 }));
    // The section: backs count up, fronts count down, the plane is drawn where more is counted than nothing.
    const count = (side, op) => new THREE.MeshBasicMaterial({ side, colorWrite: false, depthWrite: false, depthTest: false, stencilWrite: true, stencilFunc: THREE.AlwaysStencilFunc, stencilFail: op, stencilZFail: op, stencilZPass: op });
    const whole = new THREE.BufferGeometry();
    this.counters = [new THREE.Mesh(whole, count(THREE.BackSide, THREE.IncrementWrapStencilOp)), new THREE.Mesh(whole, count(THREE.FrontSide, THREE.DecrementWrapStencilOp))];
    this.section = new THREE.Mesh(new THREE.PlaneBufferGeometry(40, 40),
      new THREE.MeshBasicMaterial({ color: 0xf2c99b, side: THREE.DoubleSide, stencilWrite: true, stencilRef: 0, stencilFunc: THREE.NotEqualStencilFunc, stencilFail: THREE.ReplaceStencilOp, stencilZFail: THREE.ReplaceStencilOp, stencilZPass: THREE.ReplaceStencilOp }));
    this.counters.forEach((mesh, i) => mesh.renderOrder = 1 + i * 0.1);
    this.section.renderOrder = 1.5, this.skin.renderOrder = 4, this.crack.renderOrder = 3, this.lines.renderOrder = 5;
    for (const mesh of [...this.counters, this.section, this.skin, this.crack, this.lines]) mesh.frustumCulled = false, scene.add(mesh);
  }
  update() {
    const at = shownSurface();
    const all = [...this.counters, this.section, this.skin, this.crack, this.lines];
    if (at < 0) return all.forEach((mesh) => mesh.visible = false);
    const key = [at, state.explode, state.color].join();
    if (key !== this.key) this.fill(at), this.key = key;
    for (const mesh of all) for (const material of [].concat(mesh.material)) material.clippingPlanes = mesh === this.section ? [] : clipping();
    const through = state.skin < 1;
    for (const m of [].concat(this.skin.material)) m.opacity = state.skin, m.depthWrite = !through, m.transparent = through;
    this.skin.visible = state.skin > 0;
    this.crack.visible = state.cracks;
    for (const m of [].concat(this.skin.material, this.crack.material)) m.polygonOffset = state.wire;  // lines before faces
    this.lines.visible = state.wire;
    const filled = state.clip && state.fill && !through;
    this.counters.forEach((mesh) => mesh.visible = filled);
    this.section.visible = filled;
    clipPlane.coplanarPoint(this.section.position);
    this.section.lookAt(this.section.position.x - clipPlane.normal.x, this.section.position.y - clipPlane.normal.y, this.section.position.z - clipPlane.normal.z);
  }
  // The material of a mesh with the image of a material of the model.
  painted(mesh, number) {
    const { image, wrap } = about.paint.materials[number];
    if (image < 0) return mesh.plain;
    if (!mesh.withImage[number]) {
      const texture = new THREE.CanvasTexture(images[image]);
      const ways = [THREE.RepeatWrapping, THREE.MirroredRepeatWrapping, THREE.ClampToEdgeWrapping];
      texture.wrapS = ways[wrap[0]], texture.wrapT = ways[wrap[1]];
      texture.anisotropy = renderer.capabilities.getMaxAnisotropy();
      mesh.withImage[number] = mesh.plain.clone();
      mesh.withImage[number].map = texture;
    }
    return mesh.withImage[number];
  }
  fill(at) {
    const s = surfaceData(at), shown = shownPositions(at), n = s.corner.length;
    const cracked = [], skin = [];
    for (let t = 0; t < n / 3; t++) (s.patch.length > t && s.patch[t] !== 0 ? cracked : skin).push(t);
    const colors = { skin: [0.878, 0.502, 0.227], plus: [0.34, 0.60, 0.88], minus: [0.93, 0.75, 0.30] };
    const paint = state.color === "model" ? about.surfaces[at].paint : undefined, own = paint && paintArrays(paint);
    const color = (t) => state.color === "piece" ? pieceColor(s.piece[t]) : state.color === "plain" || !(s.patch.length > t) || s.patch[t] === 0 ? colors.skin : s.patch[t] > 0 ? colors.plus : colors.minus;
    const attribute = (array) => new THREE.BufferAttribute(array, 3);
    const put = (mesh, triangles) => {
      if (paint) triangles.sort((t, u) => own.material[t] - own.material[u] || t - u);
      const uv = new Float32Array(paint ? 6 * triangles.length : 0);
      const p = new Float32Array(9 * triangles.length), q = new Float32Array(p.length), c = new Float32Array(p.length);
      triangles.forEach((t, i) => {
        const one = color(t), painted = paint && own.material[t] !== 0xffffffff;
        for (let k = 0; k < 3; k++) {
          if (paint) uv[6 * i + 2 * k] = own.place(0, 3 * t + k), uv[6 * i + 2 * k + 1] = own.place(1, 3 * t + k);
          for (let d = 0; d < 3; d++) {
            p[9 * i + 3 * k + d] = shown[3 * s.corner[3 * t + k] + d];
            q[9 * i + 3 * k + d] = s.normal[9 * t + 3 * k + d];
            c[9 * i + 3 * k + d] = painted ? own.tint[9 * t + 3 * k + d] / 255 : one[d];
          }
        }
      });
      mesh.geometry.dispose();
      mesh.geometry = new THREE.BufferGeometry().setAttribute("position", attribute(p)).setAttribute("normal", attribute(q)).setAttribute("color", attribute(c));
      mesh.material = mesh.plain;
      if (!paint) return;
      mesh.geometry.setAttribute("uv", new THREE.BufferAttribute(uv, 2));
      mesh.material = about.paint.materials.map((_, m) => this.painted(mesh, m)).concat(mesh.plain);
      for (let i = 0, end = 0; i < triangles.length; i = end) {
        const number = own.material[triangles[i]];
        while (end < triangles.length && own.material[triangles[end]] === number) end++;
        mesh.geometry.addGroup(3 * i, 3 * (end - i), Math.min(number, about.paint.materials.length));
      }
    };
    put(this.skin, skin), put(this.crack, cracked);
    const points = attribute(new Float32Array(shown));
    this.counters[0].geometry.dispose(), this.lines.geometry.dispose();
    const whole = new THREE.BufferGeometry().setAttribute("position", points);
    whole.setIndex(new THREE.BufferAttribute(new Uint32Array(s.corner), 1));
    for (const mesh of this.counters) mesh.geometry = whole;
    // Each edge of a closed surface is met from both sides; an edge without its other side is drawn too.
    const edges = [], seen = new Set();
    for (let i = 0; i < n; i++) {
      const a = s.corner[i], b = s.corner[i % 3 === 2 ? i - 2 : i + 1], edge = Math.min(a, b) * shown.length + Math.max(a, b);
      if (!seen.delete(edge)) seen.add(edge), edges.push(a, b);
    }
    this.lines.geometry = new THREE.BufferGeometry().setAttribute("position", points);
    this.lines.geometry.setIndex(new THREE.BufferAttribute(new Uint32Array(edges), 1));
  }
}
