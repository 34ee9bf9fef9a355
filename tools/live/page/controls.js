// Controls and keys: tools, orders to the program, sliders of the material, and how things are shown.
const surface = new Surface(), world = new World(), inside = new Inside();

function show(key) {
  const control = $(key);
  if (!control) return;
  if (control.type === "checkbox") control.checked = state[key];
  else control.value = String(state[key]);
}
function set(key, value) {
  if (state[key] === value) return;
  state[key] = value;
  show(key);
  if (key === "tool") showTool();
  if (key === "depth") showDepth();
  if (key === "cells") showCells();
  if ((key === "nodes" || key === "edges") && value && state.skin === 1) set("skin", 0.2);
  if (["nodes", "edges"].includes(key) && !state.nodes && !state.edges && state.skin === 0.2) set("skin", 1);
  if (key === "look") surface.dress();
  if (key === "paint") surface.repaint();
  if (key === "plotted") $("plots").hidden = !value;
  changed();
}
const does = {
  knife: "Drag across the body: the cut follows.", scalpel: "Drag along the surface: an edge cuts in.", grab: "Drag a place of the body. With Ctrl, or a second finger, it stays held.",
  lasso: "Draw a line around what is to be cut out.", clamp: "Click two places: they are drawn together.",
  pin: "Click a place to hold it; click again to let go.",
  break: "Click a place: the piece there breaks.", orbit: "Drag to turn, two fingers or the wheel to zoom. A click on a piece: the view goes with it.",
};
function showTool() {
  for (const button of document.querySelectorAll("[data-tool]")) button.setAttribute("aria-pressed", String(button.dataset.tool === state.tool));
  $("canvas").dataset.tool = state.tool;
  clamp.leave();
  showHint();
}
const showHint = () => $("hint").textContent = cursor.shown ? cursor.hint : clamp.first ? clamp.hint : does[state.tool];
const showDepth = () => $("depth-value").textContent = state.depth >= 1 ? "through" : Math.round(100 * state.depth) + " %";

const showCells = () => $("cells-value").textContent = String(state.cells);

// Sliders of the material: what the program has, shown unless a hand is on the slider.
const values = { young: null, gravity: null, friction: null, damping: null, tension: null, resistance: null, dullness: null };
const touched = Object.fromEntries(Object.keys(values).map((name) => [name, 0]));
const logarithmic = { young: true };
const units = { young: pascals, gravity: (g) => "× " + g.toFixed(2), friction: (f) => f.toFixed(2), damping: (d) => d.toPrecision(2) + " /s",
  tension: (s) => s < 1.005 ? "none" : "× " + s.toFixed(2), resistance: (r) => r === 0 ? "sharp" : Number(r.toPrecision(2)).toLocaleString("en") + " J/m²", dullness: (d) => d.toFixed(2) };
function rangeOf(name) {
  return live.told?.options?.[name] ?? { young: [1e3, 1e7], gravity: [0, 2], friction: [0, 1], damping: [0, 10], tension: [1, 1.6], resistance: [0, 1e4], dullness: [0, 1] }[name];
}
function toSlider(name, value) {
  const [lo, hi] = rangeOf(name);
  return logarithmic[name] ? Math.log(value / lo) / Math.log(hi / lo) : (value - lo) / (hi - lo);
}
function fromSlider(name, at) {
  const [lo, hi] = rangeOf(name);
  return logarithmic[name] ? lo * Math.exp(at * Math.log(hi / lo)) : lo + at * (hi - lo);
}
const length = (v) => Math.hypot(...v);
function showValues(said) {
  if (!said) return;
  for (const name of Object.keys(values)) {
    if (said[name] === undefined || performance.now() - touched[name] < 600) continue;
    const g = length(live.told.gravity);
    const value = name === "gravity" ? (g > 0 ? length(said.gravity) / g : 0) : said[name];
    $(name).value = String(toSlider(name, value)), $(name + "-value").textContent = units[name](value);
  }
  // Ground, obstacles and bodies may each have their own, until the slider gives them one.
  const least = said.friction_least ?? said.friction;
  if (performance.now() - touched.friction >= 600 && least !== said.friction) $("friction-value").textContent = [least, said.friction].map((f) => Number(f.toFixed(2))).join("–");
}
function slide(name, last = false) {
  const value = fromSlider(name, Number($(name).value));
  touched[name] = performance.now();
  $(name + "-value").textContent = units[name](value);
  if (name === "tension" && !last) return;  // each value is a new beginning
  send({ set: { [name]: name === "gravity" ? live.told.gravity.map((x) => x * value) : value } });
}

const orders = {
  undo: () => send({ undo: true }), redo: () => send({ redo: true }), reset: () => send({ reset: true }), pause: () => send({ pause: !live.stats.paused }), step: () => send({ step: true }),
  help: () => ($("help").showModal(), $("help").scrollTop = 0), find: resetView, home: resetView, menu: toggleMenu, save: () => savePicture(),
  gallery: () => $("bodies").showModal(), record: () => recorder.toggle(),
};
function resetView() {
  Object.assign(view, home), view.target.set(0, 0, 0);
  fitEye();
  if (live.time > 0 && live.position.length > 0) seeBody();
  redraw();
}
// On a narrow screen the eye is farther away.
function fitEye() {
  const narrow = Math.min(1, $("stage").clientWidth / Math.max(1, $("stage").clientHeight) / 0.78);
  view.distance = home.distance * 1.22 / narrow;
}
// Looks at the body where it is now, all of its pieces.
function seeBody() {
  const { middle, radius } = bodySphere();
  view.target.copy(middle);
  view.distance *= Math.max(1, radius / 1.1);
}
function toggleMenu() {
  const wide = document.body.classList.toggle("wide");
  $("menu").setAttribute("aria-expanded", String(!wide));
  resize();
}
function savePicture() {
  draw();
  const link = document.createElement("a");
  link.href = $("canvas").toDataURL("image/png"), link.download = live.told.name.replace(/[^\w.-]+/g, "_") + ".png";
  link.click();
}

const keys = {
  k: () => set("tool", "knife"), l: () => set("tool", "scalpel"), a: () => set("tool", "lasso"), j: () => set("tool", "clamp"), i: orders.gallery, v: orders.record, g: () => set("tool", "grab"), p: () => set("tool", "pin"), b: () => set("tool", "break"), o: () => set("tool", "orbit"),
  u: orders.undo, U: orders.redo, r: orders.reset, " ": orders.pause, ".": orders.step, h: resetView, m: toggleMenu, "?": orders.help,
  n: () => set("nodes", !state.nodes), e: () => set("edges", !state.edges), t: () => set("stress", !state.stress), w: () => set("wire", !state.wire),
  c: () => set("walls", !state.walls), s: () => set("skin", state.skin === 1 ? 0.2 : state.skin > 0 ? 0 : 1), d: () => set("shadows", !state.shadows),
  "+": () => zoom(0.88), "=": () => zoom(0.88), "-": () => zoom(1 / 0.88), Escape: () => (clamp.leave(), hand.stroke ? endStroke() : cursor.hide()),
  "[": () => set("depth", Math.max(0.05, Number((state.depth - 0.05).toFixed(2)))), "]": () => set("depth", Math.min(1, Number((state.depth + 0.05).toFixed(2)))),
};
const arrows = { ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

function listenToKeys() {
  document.addEventListener("keydown", (e) => {
    if (document.querySelector("dialog[open]")) return;
    if ((e.ctrlKey || e.metaKey) && e.key === "z") return e.preventDefault(), orders.undo();
    if ((e.ctrlKey || e.metaKey) && (e.key === "Z" || e.key === "y")) return e.preventDefault(), orders.redo();
    if (e.key === "Enter" && !e.target.matches("button, input, a, select")) return e.preventDefault(), cursor.press(e.ctrlKey || e.metaKey);
    if (e.ctrlKey || e.metaKey || e.altKey) return;
    const sliding = e.target.matches("input[type=range], select"), pressing = e.key === " " && e.target.matches("button, input[type=checkbox]");
    if (pressing) return;
    const arrow = arrows[e.key];
    if (arrow && !sliding && cursor.shown) {
      cursor.move(-arrow[0], -arrow[1], e.shiftKey);
      e.preventDefault();
    } else if (arrow && !sliding) {
      if (e.shiftKey) pan(-24 * arrow[0], -24 * arrow[1]);
      else turn(0.08 * arrow[0], 0.08 * arrow[1]);
      e.preventDefault();
    } else if (keys[e.key]) keys[e.key](), e.preventDefault();
  });
}
function listenToControls() {
  // A control that was clicked does not keep the focus: the space bar pauses. Nor does one get it back
  // when the dialog that it has opened is closed. The keyboard's own focus stays.
  document.addEventListener("click", (e) => {
    if (e.detail > 0 && document.activeElement.matches("button, a, input[type=checkbox]")) document.activeElement.blur();
  }, true);
  for (const button of document.querySelectorAll("[data-tool]")) button.addEventListener("click", () => set("tool", button.dataset.tool));
  for (const [name, order] of Object.entries(orders)) $(name === "help" ? "help-button" : name).addEventListener("click", order);
  for (const key of ["skin", "paint", "walls", "wire", "nodes", "edges", "stress", "shadows", "plotted", "depth", "cells", "look"]) {
    const control = $(key);
    show(key);
    control.addEventListener("input", () => set(key, control.type === "checkbox" ? control.checked : key === "look" ? control.value : Number(control.value)));
  }
  for (const name of Object.keys(values)) $(name).addEventListener("input", () => slide(name));
  $("tension").addEventListener("change", () => slide("tension", true));
  $("wait").addEventListener("click", () => wire.open || connect());
}

// A view to begin with, behind the page's name: #tool=grab&azimuth=1&nodes=true
function followAddress() {
  const wishes = [...new URLSearchParams(location.hash.slice(1))];
  for (const [key, value] of wishes.sort(([a], [b]) => (a === "skin") - (b === "skin"))) {  // others change the skin, too
    if (key === "bodies") galleryAsked = value === "true";
    else if (key === "look") set("look", lookAsked = value);
    else if (key in home) home[key] = view[key] = Number(value);
    else if (key in state) set(key, value === "true" || value === "false" ? value === "true" : Number.isFinite(Number(value)) ? Number(value) : value);
  }
}

// Once the first state is known.
function dress() {
  document.title = live.told.name + " – Kerf";
  $("title").textContent = live.told.name;
  const g = length(live.told.gravity);
  $("gravity").disabled = g === 0;
  showValues({ young: live.told.youngs?.[0] ?? live.told.youngs, friction: live.told.friction, gravity: live.told.gravity, damping: live.told.damping });
  world.begin();
  clamp.leave();
  $("wait").hidden = true;
  beginWithLook(), beginWithGallery();
}

function begin() {
  followAddress();
  if (window.matchMedia("(max-width: 700px)").matches) document.body.classList.add("wide"), $("menu").setAttribute("aria-expanded", "false");
  plots.force = new Plot("force-plot", "#b5432a", newtons), plots.rate = new Plot("rate-plot", "#2464b4", String);
  layers.push(surface, follow, world, inside, recorder, { update() {}, beforeDraw: drawGhosts }, { update() {}, beforeDraw: drawTrail }, { update() {}, afterDraw: (side => () => side.afterDraw())(new SideView()) }, { update() {}, beforeDraw: drawFigures });
  listenToControls(), listenToKeys(), listenToPointer(), listenToFiles(), listenToGallery(), listenToRecorder();
  surface.dress();
  showTool(), showDepth(), showCells();
  $("plots").hidden = !state.plotted;
  new ResizeObserver(fit).observe($("stage"));
  fit(), resetView(), changed();
  connection("Connecting …");
  connect();
}
function fit() {
  resize();
  renderer.setPixelRatio(quality.pixels * Math.min(2, window.devicePixelRatio || 1));
  const trail = $("trail"), ratio = window.devicePixelRatio || 1;
  trail.width = Math.round(trail.clientWidth * ratio), trail.height = Math.round(trail.clientHeight * ratio);
}
begin();
