// Records what is shown: frames of the body for an animated GLB, and the picture as a video. Both are bounded.
const largestRecording = 256 << 20;  // bytes of frames; then every second one is left out
const recorder = {
  on: false, frames: [], bytes: 0, every: 1 / 15, begun: 0, media: null, video: [], longest: 10 * 60,  // s of the simulation; s
  toggle() { return this.on ? this.stop() : this.start(); },
  start() {
    Object.assign(this, { on: true, frames: [], bytes: 0, every: 1 / 15, begun: performance.now(), video: [], media: null, run: live.told.run });
    const type = ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm"].find((kind) => window.MediaRecorder?.isTypeSupported(kind));
    if (type) {
      this.media = new MediaRecorder($("canvas").captureStream(30), { mimeType: type, videoBitsPerSecond: 6e6 });
      this.media.ondataavailable = ({ data }) => data.size > 0 && this.video.push(data);
      this.media.start(1000);
    }
    this.take();
    this.show(), redraw();
  },
  async stop() {
    this.on = false;
    this.take(true);
    this.show();
    if (this.media && this.media.state !== "inactive") await new Promise((done) => (this.media.onstop = done, this.media.stop()));
    $("recorded-about").textContent = `${this.frames.length} frames of the body, ${((performance.now() - this.begun) / 1000).toFixed(1)} s of the picture.`;
    $("recorded-video").disabled = this.video.length === 0;
    $("recorded").showModal();
  },
  // The newest state, unless it is too near the one before. Undo and reset go back in time: frames then go on from there.
  take(last = false) {
    if (live.position.length === 0 || !surface.position) return;
    const before = this.frames[this.frames.length - 1], past = before ? before.lasts + live.time - before.time : 0;
    if (before && live.time === before.time && live.revision === before.revision) return;
    const lasts = before ? (live.time > before.time ? past : before.lasts + this.every) : 0;
    if (before && !last && live.revision === before.revision && lasts - before.lasts < 0.999 * this.every) return;
    const { groups } = surface.corners, index = (mesh) => (before && before.revision === live.revision ? null : mesh.geometry.index.array.slice());
    const frame = { time: live.time, lasts, revision: live.revision, position: surface.position.array.slice(0, 3 * groups), normal: surface.normal.array.slice(0, 3 * groups) };
    if (!before || before.revision !== live.revision) frame.skin = this.skinIndex(), frame.walls = index(surface.walls);
    this.frames.push(frame);
    this.bytes += 24 * groups + 4 * ((frame.skin?.length ?? 0) + (frame.walls?.length ?? 0));
    if (this.bytes > largestRecording) this.thin();
  },
  skinIndex() {
    const c = surface.corners, list = [];
    for (let s = 0; s < c.slots; s++) if (c.kind[s] === 0) list.push(c.group[3 * s], c.group[3 * s + 1], c.group[3 * s + 2]);
    return Uint32Array.from(list);
  },
  // Every second frame goes. The triangles of one that goes are passed on, if the next one has the same.
  thin() {
    this.every *= 2;
    this.frames = this.frames.filter((frame, i) => {
      const next = this.frames[i + 1];
      if (i % 2 === 0 || !next) return true;
      if (next.revision === frame.revision && frame.skin) next.skin = frame.skin, next.walls = frame.walls;
      return false;
    });
    this.bytes = this.frames.reduce((sum, { position, skin, walls }) => sum + 8 * position.length + 4 * ((skin?.length ?? 0) + (walls?.length ?? 0)), 0);
  },
  show() {
    $("record").setAttribute("aria-pressed", String(this.on));
    $("record").querySelector("span").textContent = this.on ? "Stop" : "Record";
  },
  update() {},
  moved() {
    if (!this.on) return;
    if (live.told.run !== this.run || performance.now() - this.begun > 1000 * this.longest) return this.stop();
    this.take();
  },
  saveVideo() { saveBlob(new Blob(this.video, { type: "video/webm" }), ".webm"); },
  saveAnimation() { saveBlob(new Blob([animatedGlb(this.frames, looks[state.look] ?? looks.clay)]), "-animation.glb"); },
};
function saveBlob(blob, ending) {
  const saved = document.createElement("a");
  saved.href = URL.createObjectURL(blob), saved.download = live.told.name.replace(/[^\w.-]+/g, "_") + ending;
  saved.click();
  setTimeout(() => URL.revokeObjectURL(saved.href), 60000);
}
function listenToRecorder() {
  $("recorded-video").addEventListener("click", () => recorder.saveVideo());
  $("recorded-glb").addEventListener("click", () => recorder.saveAnimation());
}
