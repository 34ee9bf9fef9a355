// Tools of the hand: each turns a drag of the pointer into messages. Distances here are in shown coordinates, messages in world ones.
let strokes = 0;
const hand = { stroke: null, trail: [], ghosts: [] };

// The ray from the eye through a place on the canvas.
function rayAt(x, y) {
  const canvas = $("canvas"), end = new THREE.Vector3(2 * x / canvas.clientWidth - 1, 1 - 2 * y / canvas.clientHeight, 0.5).unproject(camera);
  return { origin: camera.position.clone(), ray: end.sub(camera.position).normalize() };
}
// The sphere around the body as it is now.
function bodySphere() {
  surface.arrive();
  const lo = new THREE.Vector3(Infinity, Infinity, Infinity), hi = lo.clone().negate(), p = new THREE.Vector3();
  for (let v = 0; v < live.vertices; v++)
    if (surface.corners.first[v] >= 0) p.fromArray(live.position, 3 * v), lo.min(p), hi.max(p);
  const middle = lo.clone().add(hi).multiplyScalar(0.5);
  return { middle, radius: 1.04 * hi.distanceTo(middle) };
}

// The knife: an edge on the ray of the pointer. At full depth it goes through the whole body, else it begins at the skin.
class Knife {
  begin(x, y) {
    this.sphere = bodySphere();
    this.along = null;
    this.through = state.depth >= 1;
    const { middle, radius } = this.sphere, away = middle.distanceTo(camera.position);
    this.margin = 0.05;
    this.depth = this.through ? 2 * radius : state.depth * 2 * radius + this.margin;
    this.fixed = Math.max(away - radius, 0.02);
    return this.message(x, y);
  }
  message(x, y) {
    const { origin, ray } = rayAt(x, y);
    let from = this.fixed;
    if (!this.through) {
      const hit = surface.hit(origin, ray);
      if (hit) this.along = hit.distance;
      from = Math.max((hit ? hit.distance : this.along ?? this.sphere.middle.clone().sub(origin).dot(ray)) - this.margin, 0.02);
    }
    const near = ray.clone().multiplyScalar(from).add(origin), far = ray.clone().multiplyScalar(this.depth).add(near);
    this.edge = [near, far];
    return { eye: toWorld(origin), ray: ray.toArray(), depth: this.depth * about.unit, from: from * about.unit };
  }
  // A pose on the way between two messages.
  row({ ray, from }) { return [...ray, from]; }
}
// The scalpel: an edge that follows the pointer on the surface, across it. A stroke that is on the skin stays on it: over an open
// cut it goes on in the plane of the skin that it left. A stroke that begins on a wall of a cut follows the wall.
class Scalpel {
  begin(x, y) { return this.message(x, y); }
  message(x, y) {
    const { origin, ray } = rayAt(x, y), hit = surface.hit(origin, ray);
    const at = hit && this.left?.skin && !hit.skin ? this.bridge(origin, ray, hit.distance) : hit;
    if (!at) return null;
    if (at === hit) this.left = hit;
    const depth = Math.min(state.depth, 0.5) * 0.8;
    this.edge = [at.point.clone().addScaledVector(at.normal, 0.04), at.point.clone().addScaledVector(at.normal, -depth)];
    return { point: toWorld(at.point), normal: at.normal.toArray(), depth: depth * about.unit };
  }
  row({ point, normal }) { return [...point, ...normal]; }
  // Where a ray meets the plane of the skin that was left, in front of the wall that it meets; null: nowhere.
  bridge(origin, ray, wall) {
    const { point, normal } = this.left, run = normal.dot(ray), distance = point.clone().sub(origin).dot(normal) / run;
    if (!(run < -0.1 && distance > 0 && distance <= wall)) return null;
    return { point: ray.clone().multiplyScalar(distance).add(origin), normal };
  }
}
// A spring on what is under the pointer, or one that has stayed; its other end moves in the plane through that point that faces the eye.
class Grab {
  begin(x, y) {
    const { origin, ray } = rayAt(x, y);
    this.hold = holdAt(x, y);
    this.at = this.hold ? null : surface.hit(origin, ray);
    if (!this.hold && !this.at) return null;
    const through = this.hold ? toShown(this.hold.to) : this.at.point;
    this.plane = new THREE.Plane().setFromNormalAndCoplanarPoint(new THREE.Vector3().setFromMatrixColumn(camera.matrixWorld, 2), through);
    this.from = [x, y], this.moved = false;
    return this.message(x, y);
  }
  message(x, y) {
    const { origin, ray } = rayAt(x, y), run = this.plane.normal.dot(ray);
    const along = -this.plane.distanceToPoint(origin) / run, to = ray.clone().multiplyScalar(along).add(origin);
    this.moved ||= Math.hypot(x - this.from[0], y - this.from[1]) >= slop;
    this.edge = [this.held(), to];
    return { ...(this.hold ? { held: this.hold.id } : { face: this.at.slot, bary: this.at.bary }), to: toWorld(to) };
  }
  // Where the held point of the surface is now.
  held() {
    if (this.hold) return toShown(((live.stats.holds ?? []).find((h) => h.id === this.hold.id) ?? this.hold).at);
    const c = surface.corners, p = new THREE.Vector3(), sum = new THREE.Vector3();
    if (!c.has(this.at.slot)) return this.last ?? this.at.point;
    this.at.bary.forEach((w, k) => sum.addScaledVector(p.fromArray(live.position, 3 * c.vertex[3 * this.at.slot + k]), w));
    return this.last = sum;
  }
  // The last message of a grab. One that has stayed goes on to, unless it was clicked.
  get ending() { return this.stays || (this.hold && this.moved) ? "hold" : "end"; }
}
// A spring that stays, whose end is at a place of the screen.
function holdAt(x, y) {
  const canvas = $("canvas"), near = window.matchMedia("(pointer: coarse)").matches ? 26 : 14;
  return (live.stats.holds ?? []).find(({ to }) => {
    const p = toShown(to).project(camera);
    return Math.hypot((p.x + 1) / 2 * canvas.clientWidth - x, (1 - p.y) / 2 * canvas.clientHeight - y) < near;
  });
}
function keepHeld(stroke) {
  if (stroke.kind !== "grab" || stroke.tool.stays) return;
  stroke.tool.stays = true;
  notice({ notice: "This place stays held. A click on the end of its line lets go." });
}
const handTools = { knife: Knife, scalpel: Scalpel, grab: Grab };

function beginStroke(x, y, pointer) {
  const make = handTools[state.tool];
  if (!make || !wire.open || live.position.length === 0) return false;
  const tool = new make(), message = tool.begin(x, y);
  if (!message) return false;
  const id = ++strokes, ghost = new Ghost(id, tool.edge, state.tool);
  hand.stroke = { id, kind: state.tool, tool, ghost, sphere: tool.sphere ?? bodySphere(), pointer, last: message, pending: [], sentAt: performance.now() };
  hand.ghosts.push(ghost);
  hand.trail = [[x, y, performance.now()]];
  if (!tool.late) sendInput(state.tool, { id: strokes, phase: "begin", ...message });
  redraw();
  return true;
}
const apart = 6;       // milliseconds between messages: below the 240 a second that are taken
const mostPoses = 24;  // in a message, which has at most 4096 bytes
function moveStroke(x, y) {
  const s = hand.stroke, message = s.tool.message(x, y);
  hand.trail.push([x, y, performance.now()]);
  redraw();
  if (!message) return;
  s.last = message;
  s.pending.push(message);
  s.ghost.add(s.tool.edge);
  clearTimeout(s.later);
  const wait = s.sentAt + apart - performance.now();
  if (wait <= 0) passOn(s);
  else s.later = setTimeout(() => hand.stroke === s && passOn(s), wait);
}
// Sends the poses since the last message: the path between two frames is kept.
function passOn(s) {
  clearTimeout(s.later);
  if (s.tool.late) return;
  s.sentAt = performance.now();
  while (s.pending.length > 0) {
    const first = s.pending[0];
    let n = 1;
    while (n < Math.min(mostPoses, s.pending.length) && String(s.pending[n].eye) === String(first.eye)) n++;
    const poses = s.pending.splice(0, n), last = poses.pop();
    const way = s.tool.row ? poses.map((pose) => s.tool.row(pose).map((x) => Number(x.toPrecision(8)))) : [];
    sendInput(s.kind, { id: s.id, phase: "move", ...last, ...(way.length > 0 ? { way } : {}) });
  }
}
function endStroke() {
  const s = hand.stroke;
  if (!s) return;
  passOn(s);
  hand.stroke = null;
  if (s.tool.late && !sendClosed(s)) return s.ghost.end(), notice({ notice: "Draw a line around what is to be cut out." });
  sendInput(s.kind, { id: s.id, phase: s.tool.ending ?? "end", ...s.last });
  s.ghost.end();
  redraw();
}
// Paths that are known only when they are drawn, as strokes of the knife that begin together. The last one is the stroke; its end is sent by the caller.
// False: there is none.
function sendClosed(s) {
  const paths = s.tool.closed();
  if (!paths) return false;
  s.kind = "knife", s.tool.late = false;
  const ids = paths.map((_, i) => (i === 0 ? s.id : ++strokes));
  paths.forEach((path, i) => sendInput(s.kind, { id: ids[i], phase: "begin", ...path[0] }));
  paths.forEach((path, i) => {
    s.id = ids[i], s.pending = path.slice(1), s.last = path[path.length - 1];
    passOn(s);
    if (i + 1 < paths.length) sendInput(s.kind, { id: s.id, phase: "end", ...s.last });
  });
  return true;
}
function pinAt(x, y) {
  const { origin, ray } = rayAt(x, y), hit = surface.hit(origin, ray);
  if (!hit) return false;
  // A click close to a pin takes it away.
  const near = (live.stats.pins ?? []).some((p) => toShown(p).distanceTo(hit.point) < 0.08);
  send({ pin: { face: hit.slot, bary: hit.bary, on: !near, radius: 0.1 * about.unit } });
  return true;
}
function breakAt(x, y) {
  const { origin, ray } = rayAt(x, y), hit = surface.hit(origin, ray);
  if (!hit) return false;
  send({ break: { face: hit.slot, bary: hit.bary, cells: state.cells } });
  return true;
}
const clickTools = { pin: pinAt, break: breakAt };

// What the edge of a stroke has swept, as a pale sheet that fades after the stroke; for the grab, a line from the held point.
// A stroke on a paused body is shown until it has cut.
class Ghost {
  constructor(id, edge, kind) {
    const mesh = (object, order) => {
      object.frustumCulled = false, object.renderOrder = order, object.visible = false;
      scene.add(object);
      return object;
    };
    this.sheet = mesh(new THREE.Mesh(new THREE.BufferGeometry(), new THREE.MeshBasicMaterial({ color: 0x4d8fe0, transparent: true, opacity: 0.3, side: THREE.DoubleSide, depthWrite: false, depthTest: false })), 8);
    this.rim = mesh(new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ color: 0x1d4f96, transparent: true, depthTest: false })), 8.1);
    this.id = id, this.kind = kind, this.edges = [edge], this.fading = 0;
  }
  add(edge) {
    if (this.kind === "grab") this.edges = [edge];
    else if (edge[0].distanceTo(this.edges[this.edges.length - 1][0]) > 1e-4) this.edges.push(edge);
    if (this.edges.length > 2000) this.edges = this.edges.filter((e, i) => i % 2 === 0);
  }
  end() { this.fading = performance.now(); }
  // Whether the edge is still to cut, once the run goes on.
  waits() { return this.kind !== "grab" && live.stats.paused && (live.stats.waiting ?? []).includes(this.id); }
  gone() { return this.fading > 0 && performance.now() - this.fading >= (this.kind === "grab" ? 0 : 2500); }
  beforeDraw() {
    if (this.fading && this.waits()) this.fading = performance.now();
    const age = this.fading ? (performance.now() - this.fading) / 2500 : 0;
    if (hand.stroke?.ghost === this && hand.stroke.tool.held) this.edges = [[hand.stroke.tool.held(), this.edges[0][1]]];
    this.sheet.visible = this.kind !== "grab" && this.edges.length > 1, this.rim.visible = true;
    const points = this.edges.flatMap(([a, b]) => [...a.toArray(), ...b.toArray()]), n = this.edges.length, faces = [], lines = [0, 1, 2 * n - 2, 2 * n - 1];
    for (let i = 0; i + 1 < n; i++) faces.push(2 * i, 2 * i + 1, 2 * i + 2, 2 * i + 1, 2 * i + 3, 2 * i + 2), lines.push(2 * i, 2 * i + 2, 2 * i + 1, 2 * i + 3);
    const put = (mesh, index) => {
      mesh.geometry.dispose();
      mesh.geometry = new THREE.BufferGeometry().setAttribute("position", new THREE.BufferAttribute(Float32Array.from(points), 3));
      mesh.geometry.setIndex(index);
    };
    put(this.sheet, faces), put(this.rim, lines);
    this.sheet.material.opacity = 0.3 * (1 - age), this.rim.material.opacity = 0.9 * (1 - age);
    if (this.fading && !this.waits()) redraw();
  }
  remove() {
    for (const object of [this.sheet, this.rim]) {
      scene.remove(object);
      object.geometry.dispose(), object.material.dispose();
    }
  }
}
function drawGhosts() {
  for (const ghost of hand.ghosts) ghost.gone() ? ghost.remove() : ghost.beforeDraw();
  hand.ghosts = hand.ghosts.filter((ghost) => !ghost.gone());
}

// The knife's plane goes through the eye, which sees it as a line: a small picture shows it from the side while it is dragged.
class SideView {
  constructor() {
    this.camera = new THREE.PerspectiveCamera(30, 1, 0.01, 100);
  }
  afterDraw() {
    const box = $("side"), on = hand.stroke !== null && hand.stroke.kind !== "grab" && quality.pixels === 1;
    box.hidden = !on;
    if (!on) return;
    const { middle, radius } = hand.stroke.sphere, c = this.camera, canvas = $("canvas");
    const right = new THREE.Vector3().setFromMatrixColumn(camera.matrixWorld, 0), ahead = middle.clone().sub(camera.position).normalize();
    c.aspect = box.clientWidth / box.clientHeight, c.updateProjectionMatrix();
    c.up.copy(camera.up);
    c.position.copy(middle).addScaledVector(right, 4.6 * radius).addScaledVector(ahead, -0.4 * radius).addScaledVector(camera.up, 0.9 * radius);
    c.lookAt(middle);
    const x = box.offsetLeft, y = canvas.clientHeight - box.offsetTop - box.offsetHeight;
    renderer.setScissorTest(true);
    renderer.setViewport(x, y, box.offsetWidth, box.offsetHeight), renderer.setScissor(x, y, box.offsetWidth, box.offsetHeight);
    renderer.shadowMap.autoUpdate = false;
    renderer.render(scene, c);
    renderer.shadowMap.autoUpdate = true;
    renderer.setScissorTest(false);
    renderer.setViewport(0, 0, canvas.clientWidth, canvas.clientHeight);
  }
}

// The way of the pointer, drawn over the picture, thinner where it is older.
function drawTrail() {
  const canvas = $("trail"), paint = canvas.getContext("2d"), now = performance.now(), ratio = canvas.width / Math.max(1, canvas.clientWidth);
  paint.setTransform(ratio, 0, 0, ratio, 0, 0);
  paint.clearRect(0, 0, canvas.clientWidth, canvas.clientHeight);
  if (!hand.stroke) hand.trail = hand.trail.filter(([, , at]) => now - at < 500);
  canvas.style.visibility = hand.trail.length ? "visible" : "hidden";
  const cuts = (hand.stroke?.kind ?? state.tool) !== "grab", trail = hand.trail;
  if (trail.length > 1 && cuts) {
    paint.lineCap = paint.lineJoin = "round";
    for (const [width, color] of [[5, "rgba(20, 50, 100, 0.28)"], [2, "rgba(255, 255, 255, 0.95)"]])
      for (let i = 1; i < trail.length; i++) {
        const age = hand.stroke ? 0 : (now - trail[i][2]) / 500;
        paint.globalAlpha = Math.max(0, 1 - age), paint.strokeStyle = color, paint.lineWidth = width;
        paint.beginPath(), paint.moveTo(trail[i - 1][0], trail[i - 1][1]), paint.lineTo(trail[i][0], trail[i][1]), paint.stroke();
      }
    paint.globalAlpha = 1;
  }
  if (hand.stroke && trail.length) {
    const [x, y] = trail[trail.length - 1];
    paint.lineWidth = 1.5, paint.strokeStyle = "rgba(20, 50, 100, 0.9)", paint.fillStyle = "rgba(255, 255, 255, 0.85)";
    paint.beginPath(), paint.arc(x, y, cuts ? 5 : 8, 0, 2 * Math.PI), paint.fill(), paint.stroke();
  }
  if (!hand.stroke && trail.length) redraw();
}
