// The place where the body is: background, light, ground with shadows, obstacles, pins, and edges of blades.
// Colours of the background, from above to below, and of the floor, from its middle outwards.
const tonesOf = {
  light: { top: "#dfe7f0", middle: "#eef2f6", bottom: "#cfd8e2", inner: 0xfbfcfd, outer: 0xdbe3ec },
  dark: { top: "#1b222b", middle: "#262f3a", bottom: "#12171d", inner: 0x3c4754, outer: 0x222a34 },
};
const darkness = window.matchMedia("(prefers-color-scheme: dark)");

class World {
  constructor() {
    this.inner = { value: new THREE.Color() }, this.outer = { value: new THREE.Color() };
    this.paint();
    darkness.addEventListener("change", () => (this.paint(), redraw()));
    renderer.shadowMap.enabled = true, renderer.shadowMap.type = THREE.PCFShadowMap;
    sky.intensity = 0.62, lamp.intensity = 0.22;  // the lamp goes with the eye, the sun stays
    this.sun = new THREE.DirectionalLight(0xfff6ea, 0.42);
    this.sun.castShadow = true, this.sun.shadow.mapSize.set(1024, 1024), this.sun.shadow.radius = 4, this.sun.shadow.bias = -0.004;
    Object.assign(this.sun.shadow.camera, { left: -2, right: 2, top: 2, bottom: -2, near: 0.5, far: 10 });
    scene.add(this.sun, this.sun.target);
    this.floor = null;
    this.things = new THREE.Group(), this.pins = new Spots(7), this.edges = new THREE.Group();
    scene.add(this.things, this.edges);
  }
  // Background and floor, light or dark as the rest of the page.
  paint() {
    const tones = tonesOf[darkness.matches ? "dark" : "light"], canvas = document.createElement("canvas"), paint = canvas.getContext("2d");
    canvas.width = 2, canvas.height = 256;
    const fade = paint.createLinearGradient(0, 0, 0, 256);
    fade.addColorStop(0, tones.top), fade.addColorStop(0.55, tones.middle), fade.addColorStop(1, tones.bottom);
    paint.fillStyle = fade, paint.fillRect(0, 0, 2, 256);
    scene.background = new THREE.CanvasTexture(canvas);
    this.inner.value.set(tones.inner), this.outer.value.set(tones.outer);
  }
  // Once the state is known: the ground, and obstacles.
  begin() {
    const up = upward(), side = new THREE.Vector3(-0.55, about.y_up ? 0 : -0.45, about.y_up ? 0.45 : 0);
    this.sun.position.copy(up).multiplyScalar(3.6).addScaledVector(side, 2.2);
    const { ground } = live.told;
    if (this.floor) scene.remove(this.floor), this.floor = null;
    if (ground) {
      const normal = new THREE.Vector3(...ground.normal).normalize(), at = toShown(ground.point);
      this.height = at.dot(normal), this.normal = normal;
      const turned = new THREE.Quaternion().setFromUnitVectors(new THREE.Vector3(0, 0, 1), normal);
      const put = (mesh, order) => {
        mesh.quaternion.copy(turned), mesh.position.copy(normal).multiplyScalar(this.height - 0.002), mesh.renderOrder = order;
        this.floor.add(mesh);
      };
      this.floor = new THREE.Group();
      put(new THREE.Mesh(new THREE.CircleBufferGeometry(5, 64), this.floorMaterial()), 0);
      const shade = new THREE.Mesh(new THREE.CircleBufferGeometry(5, 64), new THREE.ShadowMaterial({ color: 0x1c2a3a, opacity: 0.3, depthWrite: false, polygonOffset: true, polygonOffsetFactor: -1, polygonOffsetUnits: -1 }));
      shade.receiveShadow = true;
      put(shade, 0.2);
      scene.add(this.floor);
    }
    this.things.remove(...this.things.children);
    for (const o of live.told.obstacles ?? []) this.things.add(o.normal ? this.plane(o) : this.solid(o));
  }
  solid(o) {
    const geometry = new THREE.BufferGeometry().setAttribute("position", new THREE.BufferAttribute(Float32Array.from(o.vertices, (x, i) => (x - about.middle[i % 3]) / about.unit), 3));
    geometry.setIndex(new THREE.BufferAttribute(Uint32Array.from(o.triangles), 1));
    const mesh = new THREE.Mesh(geometry, new THREE.MeshPhongMaterial({ color: 0x9aa3ad, specular: 0x222222, side: THREE.DoubleSide, flatShading: true }));
    mesh.castShadow = mesh.receiveShadow = true, mesh.matrixAutoUpdate = false, mesh.renderOrder = 2;
    return mesh;
  }
  // A plane as a pale disc beside the body, which is seen through it.
  plane(o) {
    const normal = new THREE.Vector3(...o.normal).normalize(), turned = new THREE.Quaternion().setFromUnitVectors(new THREE.Vector3(0, 0, 1), normal);
    const middle = normal.clone().multiplyScalar(toShown(o.point).dot(normal));
    const geometry = new THREE.CircleBufferGeometry(1.2, 64).applyMatrix(new THREE.Matrix4().compose(middle, turned, new THREE.Vector3(1, 1, 1)));
    const mesh = new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({ color: 0x6f7c8a, transparent: true, opacity: 0.28, side: THREE.DoubleSide, depthWrite: false }));
    mesh.matrixAutoUpdate = false, mesh.renderOrder = 7;
    return mesh;
  }
  // A disc that fades into the background, lighter in the middle, with rings to tell distances.
  floorMaterial() {
    return new THREE.ShaderMaterial({
      transparent: true, depthWrite: false, uniforms: { inner: this.inner, outer: this.outer },
      vertexShader: "varying vec2 at; void main() { at = position.xy; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }",
      fragmentShader: `varying vec2 at; uniform vec3 inner, outer;
        void main() {
          float r = length(at), ring = smoothstep(0.012, 0.0, abs(fract(r * 2.0 + 0.5) - 0.5) / 2.0);
          vec3 tone = mix(inner, outer, smoothstep(0.0, 3.2, r)) - 0.05 * ring;
          gl_FragColor = vec4(tone, 0.95 * (1.0 - smoothstep(1.6, 4.6, r)));
        }`,
    });
  }
  update() {
    this.sun.castShadow = state.shadows && quality.shadows;
    if (this.floor) this.floor.visible = eyePosition().dot(this.normal) > this.height;
  }
  // With each frame: where pins, edges and obstacles are.
  moved() {
    const { pins = [], holds = [], edges = [], obstacles = [] } = live.stats;
    const spots = [...pins.map((p) => [p, [0.16, 0.36, 0.85], 0.06]), ...holds.flatMap(({ at, to }) => [[at, [0.85, 0.45, 0.1], 0.04], [to, [0.85, 0.45, 0.1], 0.07]])];
    if (spots.length) this.pins.set(spots.flatMap(([p]) => toShown(p).toArray()), spots.flatMap(([, color]) => color), spots.map(([, , size]) => size));
    else this.pins.hide();
    for (const line of this.edges.children) line.geometry.dispose(), line.material.dispose();
    this.edges.remove(...this.edges.children);
    const add = (points, color) => {
      const line = new THREE.Line(new THREE.BufferGeometry().setFromPoints(points), new THREE.LineBasicMaterial({ color }));
      line.frustumCulled = false, line.renderOrder = 6.5;
      this.edges.add(line);
    };
    for (const edge of edges) {
      const points = [];
      for (let i = 0; i + 2 < edge.length; i += 3) points.push(toShown(edge.slice(i, i + 3)));
      add(points, 0x2a5fa8);
    }
    for (const { at, to } of holds) add([toShown(at), toShown(to)], 0xc0661a);
    obstacles.forEach(([w, x, y, z, ...t], i) => this.place(this.things.children[i], new THREE.Quaternion(x, y, z, w), new THREE.Vector3(...t)));
  }
  // A pose in world coordinates, of vertices that are stored in shown ones: R (m + u v) + t = m + u (R v + (R m + t − m) / u).
  place(mesh, turned, shift) {
    if (!mesh) return;
    const m = new THREE.Vector3(...about.middle);
    const by = m.clone().applyQuaternion(turned).add(shift).sub(m).divideScalar(about.unit);
    mesh.matrix.compose(by, turned, new THREE.Vector3(1, 1, 1)), mesh.matrixWorldNeedsUpdate = true;
  }
  beforeDraw() {
    this.pins.beforeDraw();
    if (!this.floor) return;
    const n = this.normal.clone().transformDirection(camera.matrixWorldInverse);
    groundPlane.value.set(n.x, n.y, n.z, camera.position.dot(this.normal) - this.height);
    this.floor.visible = camera.position.dot(this.normal) > this.height;
  }
}

// Nodes, coloured by stress where it is asked for, and edges of the graph.
class Inside {
  constructor() {
    this.spots = new Spots(2);
    this.edges = new LineLayer(0x2b4c9b, 0.45, 2.1);
  }
  update() {
    const shown = live.node && state.nodes;
    $("legend").hidden = !(live.stress && state.stress);
    if (shown) {
      const n = live.node.length / 3, color = new Float32Array(3 * n), most = this.range();
      for (let i = 0; i < n; i++) color.set(live.stress && state.stress ? scaleColor(live.stress[i] / most) : [0.16, 0.45, 0.75], 3 * i);
      this.spots.set(live.node, color, new Float32Array(n).fill(0.3 * (live.told.spacing ?? 0.1 * about.unit) / about.unit * state.size));
    } else this.spots.hide();
    if (live.stress && state.stress) {
      $("legend-hi").textContent = "≥ " + pascals(this.range());
      $("legend-bar").style.background = `linear-gradient(to right, ${[0, 1, 2, 3, 4].map((i) => `rgb(${scaleColor(i / 4).map((c) => Math.round(255 * c))})`)})`;
    }
    this.edges.set(state.edges && live.node && live.pairs ? live.node : null, live.pairs ?? []);
  }
  // The scale follows the greatest stress slowly: colours do not flicker.
  range() {
    if (!live.stress) return 1;
    const high = Float32Array.from(live.stress).sort()[Math.floor(0.97 * live.stress.length)] ?? 1;
    this.high = this.high ? 0.95 * this.high + 0.05 * high : high;
    return Math.max(this.high, 1e-9);
  }
  moved() {
    if (state.nodes || state.stress || state.edges || this.spots.points.visible) this.update();
  }
  beforeDraw() { this.spots.beforeDraw(); }
}
const pascals = (x) => (x >= 1e6 ? Number((x / 1e6).toPrecision(2)) + " MPa" : x >= 1e3 ? Number((x / 1e3).toPrecision(2)) + " kPa" : Number(x.toPrecision(2)) + " Pa");
