// Controls and keys: each sets one value of the state and shows it.
const kinds = { frame: Number, skin: Number, explode: Number, size: Number, offset: Number, axis: Number };

function show(key) {
  const control = $(key);
  if (control.type === "checkbox") control.checked = state[key];
  else control.value = String(state[key]);
  if (key === "frame" || key === "rest") $("frame-label").textContent = shownSurface() >= 0 ? about.surfaces[shownSurface()].label : "";
}
function set(key, value) {
  if (state[key] === value) return;
  state[key] = value;
  show(key);
  changed();
}

const keys = {
  c: () => set("cracks", !state.cracks), w: () => set("wire", !state.wire), n: () => set("nodes", !state.nodes),
  e: () => set("edges", !state.edges), d: () => set("cut", !state.cut), b: () => set("near", !state.near), t: () => set("tree", !state.tree),
  u: () => set("updated", !state.updated), o: () => set("own", !state.own), f: () => set("fronts", !state.fronts), k: () => set("obstacles", !state.obstacles), p: () => set("clip", !state.clip), r: () => set("rest", !state.rest),
  s: () => set("skin", state.skin === 1 ? 0.25 : state.skin > 0 ? 0 : 1), x: () => set("explode", state.explode > 0 ? 0 : 0.5),
  h: resetView, m: () => $("menu").click(), "?": () => $("help").showModal(), " ": () => play(!state.playing),
  ",": () => showFrame(state.frame - 1), ".": () => showFrame(state.frame + 1), Escape: () => select(-1),
  "+": () => zoom(0.88), "=": () => zoom(0.88), "-": () => zoom(1 / 0.88),
};
const arrows = { ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
// Which part of the controls a key belongs to: nothing happens where that part is not there.
const needs = { n: "node-controls", e: "graph-controls", d: "graph-controls", b: "graph-controls", u: "updated-label", t: "tree-controls", o: "tree-controls", f: "front-controls", k: "obstacles-label", r: "rest-label", c: "surface-controls", w: "surface-controls", s: "surface-controls", x: "explode-label", " ": "timeline", ",": "timeline", ".": "timeline" };

function resetView() {
  Object.assign(view, home);
  view.target.set(0, 0, 0);
  eyeMoved();
}

function listenToKeys() {
  document.addEventListener("keydown", (e) => {
    if (e.ctrlKey || e.metaKey || e.altKey || $("help").open) return;
    const typing = e.target.matches("input[type=number], select"), sliding = e.target.matches("input[type=range]");
    if (e.key === "Escape") return keys.Escape();
    if (typing || (e.key === " " && e.target.matches("button, input[type=checkbox]"))) return;
    const arrow = arrows[e.key];
    if (arrow && !sliding) {
      if (e.shiftKey) pan(-24 * arrow[0], 24 * arrow[1] * -1);
      else turn(0.08 * arrow[0], 0.08 * arrow[1]);
      e.preventDefault();
    } else if (keys[e.key] && !(needs[e.key] && $(needs[e.key]).hidden)) {
      keys[e.key]();
      e.preventDefault();
    }
  });
}

function listenToControls() {
  for (const key of Object.keys(state)) {
    const control = $(key);
    if (!control || key === "selected" || key === "playing") continue;
    show(key);
    control.addEventListener("input", () => {
      if (key === "frame") play(false);
      set(key, control.type === "checkbox" ? control.checked : kinds[key] ? kinds[key](control.value) : control.value);
    });
  }
  $("pick").addEventListener("input", () => select($("pick").value === "" ? -1 : Math.round(Number($("pick").value) / about.nodes.step)));
  $("play").addEventListener("click", () => play(!state.playing));
  $("home").addEventListener("click", resetView);
  $("keys").addEventListener("click", () => $("help").showModal());
  $("menu").addEventListener("click", () => {
    const wide = document.body.classList.toggle("wide");
    $("menu").setAttribute("aria-expanded", String(!wide));
    resize();
  });
  $("save").addEventListener("click", () => {
    draw();
    const link = document.createElement("a");
    link.href = $("canvas").toDataURL("image/png"), link.download = about.title.replace(/[^\w.-]+/g, "_") + ".png";
    link.click();
  });
}

// Parts of the controls that what is looked at has nothing for are left out.
function dress() {
  document.title = about.title + " – Kerf";
  $("title").textContent = about.title;
  $("made").textContent = "made by " + about.made;
  const n = about.nodes, cracked = about.surfaces.some((s) => arrays[s.patch].some((p) => p !== 0));
  $("surface-controls").hidden = about.surfaces.length === 0;
  $("node-controls").hidden = $("inspector").hidden = n === null;
  $("graph-controls").hidden = !(n && n.graph), $("tree-controls").hidden = !(n && n.tree);
  $("updated-label").hidden = !(n && n.updated);
  $("front-controls").hidden = about.fronts.length === 0;
  $("cracks").disabled = !cracked;
  const painted = about.surfaces.some((s) => s.paint);
  if (!painted) $("color").options[0].remove();
  state.color = about.color === "model" && !painted ? "patch" : about.color;
  $("obstacles-label").hidden = about.obstacles.length === 0;
  $("rest-label").hidden = !(n && n.rest > 0);
  $("explode-label").hidden = !about.surfaces.some((s) => arrays[s.piece].some((p) => p > 0));
  $("timeline").hidden = frameCount() < 2;
  document.body.classList.toggle("run", frameCount() > 1);
  $("frame").max = String(Math.max(0, frameCount() - 1));
  if (n) {
    $("field").replaceChildren(...n.fields.map((name) => new Option(name, name)));
    $("pick").max = String(n.count * n.step - 1);
    if (about.surfaces.length === 0) state.nodes = true;
  }
  $("notices").hidden = about.notices.length === 0;
  $("notices").replaceChildren(...about.notices.map((text) => {
    const item = document.createElement("li");
    item.textContent = text;
    return item;
  }));
}

// A view to begin with, behind the page's name: #nodes=true&skin=0.25&selected=12
function followAddress() {
  for (const [key, value] of new URLSearchParams(location.hash.slice(1))) {
    if (key in view && key !== "target") view[key] = Number(value);
    if (!(key in state)) continue;
    state[key] = value === "true" || value === "false" ? value === "true" : Number.isFinite(Number(value)) ? Number(value) : value;
  }
  if (hasNodes() && !about.nodes.fields.includes(state.field)) state.field = about.nodes.fields[0];
  state.frame = Math.min(Math.max(0, Math.round(state.frame) || 0), Math.max(0, frameCount() - 1));
  if (!hasNodes() || !(state.selected >= 0 && state.selected < about.nodes.count)) state.selected = -1;
}

async function begin() {
  about = JSON.parse($("about").textContent);
  arrays = await unpack($("data").textContent, about.arrays);
  $("data").textContent = "";
  await loadImages();
  dress();
  followAddress();
  layers.push(new SurfaceLayer(), new ObstacleLayer(), new FrontLayer(), new NodeLayer(), new GraphLayer(), new BindingLayer(), new InspectLayer());
  listenToControls(), listenToKeys(), listenToPointer();
  new ResizeObserver(resize).observe($("stage"));
  resize(), changed(), draw();
  $("wait").hidden = true;
}
begin().catch((problem) => {
  $("wait").textContent = "This page cannot be shown: " + problem.message;
  console.error(problem);
});
