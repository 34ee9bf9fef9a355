// Small graphs over the last seconds: force on blades and of pulls, and frames a second.
class Plot {
  constructor(id, color, unit) {
    this.canvas = $(id), this.color = color, this.unit = unit, this.values = new Float32Array(180), this.at = 0;
  }
  add(value) {
    this.values[this.at++ % this.values.length] = value;
  }
  draw() {
    const { canvas, values } = this, ratio = window.devicePixelRatio || 1, w = canvas.clientWidth, h = canvas.clientHeight;
    if (w === 0) return;
    if (canvas.width !== Math.round(w * ratio)) canvas.width = Math.round(w * ratio), canvas.height = Math.round(h * ratio);
    const paint = canvas.getContext("2d"), most = Math.max(...values, 1e-9), n = values.length;
    paint.setTransform(ratio, 0, 0, ratio, 0, 0);
    paint.clearRect(0, 0, w, h);
    paint.beginPath(), paint.moveTo(0, h);
    for (let i = 0; i < n; i++) paint.lineTo(i * w / (n - 1), h - 1 - (h - 4) * values[(this.at + i) % n] / most);
    paint.lineTo(w, h), paint.closePath();
    paint.fillStyle = this.color + "33", paint.fill();
    paint.strokeStyle = this.color, paint.lineWidth = 1.4, paint.stroke();
  }
}
const plots = { frames: [] };

// A slow machine draws with less: without shadows, then without reflections, with fewer pixels, without solid textures.
const quality = {
  shadows: true, coat: true, solids: true, pixels: 1, slow: 0,
  watch(rate) {
    const late = live.stats.fps > 20 && !live.stats.paused && rate < Math.min(20, 0.7 * live.stats.fps);
    this.slow = late && performance.now() > 3000 ? this.slow + 1 : 0;
    if (this.slow < 20) return;
    this.slow = 0;
    if (this.shadows && state.shadows) this.shadows = false, world.update();
    else if (this.coat) this.coat = false, surface.dress();
    else if (this.solids && state.look !== "clay" && this.pixels < 0.7) this.solids = false, surface.dress();
    else if (this.pixels > 0.5) this.pixels *= 0.8, fit();
  },
};

// Frames that were drawn in the last second.
function drawnRate() {
  const now = performance.now();
  while (plots.frames.length && now - plots.frames[0] > 1000) plots.frames.shift();
  return plots.frames.length;
}
const newtons = (f) => (f >= 1000 ? (f / 1000).toPrecision(3) + " kN" : f >= 1 ? f.toPrecision(3) + " N" : f > 0 ? (1000 * f).toPrecision(2) + " mN" : "0 N");

// Figures of the newest frame.
function told(stats) {
  live.stats = stats;
  if (stats.ack_input !== undefined) inputTaken(stats.ack_input);
  const force = (stats.blade_force ?? []).reduce((sum, f) => sum + f, 0) + (stats.pull_force ?? 0);
  plots.force.add(force);
  plots.now = force;
  if (stats.message && stats.message !== plots.message && !stats.message.startsWith("slower")) notice({ notice: stats.message });
  plots.message = stats.message;
}
// Ten times a second at most; those of the last frame are always shown, though none comes after it.
let figuresAt = 0, figuresTimer = 0;
function drawFigures() {
  const now = performance.now(), left = figuresAt + 100 - now;
  plots.frames.push(now);
  clearTimeout(figuresTimer);
  if (left > 0) figuresTimer = setTimeout(showFigures, left);
  else showFigures();
}
function showFigures() {
  const stats = live.stats, rate = drawnRate();
  figuresAt = performance.now();
  plots.rate.add(rate);
  quality.watch(rate);
  $("force").textContent = newtons(plots.now ?? 0), $("rate").textContent = rate + " /s";
  if (state.plotted) plots.force.draw(), plots.rate.draw();
  $("time").textContent = live.time.toFixed(2) + " s", $("pieces").textContent = stats.pieces ?? "–";
  $("lag").textContent = wire.latency ? Math.round(wire.latency) + " ms" : "–";
  $("sizes").textContent = `${surface.corners.slots.toLocaleString("en")} triangles, ${(live.nodes ?? 0).toLocaleString("en")} nodes`;
  $("undo").disabled = !(stats.undo > 0), $("redo").disabled = !(stats.redo > 0);
  $("pause").setAttribute("aria-pressed", String(!!stats.paused));
  $("pause").querySelector("span").textContent = stats.paused ? "Go on" : "Pause";
  const slow = !stats.paused && stats.fps > 0 && stats.sim_rate < 0.95;
  $("slow").hidden = !slow && !stats.paused;
  $("slow").textContent = stats.paused ? "Paused" : slow ? `Slower than real time: ${Math.round(100 * stats.sim_rate)} %` : "";
  showValues(stats.set);
  $("find").hidden = !isBodyAway();
}

// Whether the middle of the body is outside of the picture: a knife may push it away.
function isBodyAway() {
  if (live.position.length === 0 || hand.stroke) return false;
  placeCamera();
  const p = bodySphere().middle.project(camera), canvas = $("canvas"), edge = (pixels) => 1 - 2 * 40 / Math.max(pixels, 80);
  return p.z > 1 || Math.abs(p.x) > edge(canvas.clientWidth) || Math.abs(p.y) > edge(canvas.clientHeight);
}

// What the program says: shown for some seconds.
let noticeTimer = 0;
function notice({ error, notice: text }) {
  const box = $("notice");
  if (error !== undefined && wire.open) $("wait").hidden = true;
  box.textContent = error ?? text, box.hidden = false, box.classList.toggle("wrong", error !== undefined);
  clearTimeout(noticeTimer);
  noticeTimer = setTimeout(() => box.hidden = true, 5000);
}
function connection(text) {
  $("wait").textContent = text, $("wait").hidden = text === "" && live.told !== null;
  document.body.classList.toggle("offline", text !== "");
}
