// A clamp: two places, clicked one after the other, are drawn together. It is two springs that stay, whose other ends move to
// the middle between both; each is let go as a grab is.
const clamp = {
  first: null,
  hint: "Click the place that it is to be drawn to, or press Escape.",
  // The middle moves there in this many steps of 40 ms: pulled at once, a soft body tears its contacts apart.
  steps: 25,
  click(x, y) {
    const { origin, ray } = rayAt(x, y), hit = surface.hit(origin, ray);
    if (!hit) return false;
    if (!this.first) {
      this.first = hit;
    } else {
      if (this.close(this.first, hit)) notice({ notice: "Both places are drawn together. Grab the end of a line to move it, click it to let go." });
      this.first = null;
    }
    showHint();
    redraw();
    return true;
  },
  close(a, b) {
    const middle = a.point.clone().add(b.point).multiplyScalar(0.5);
    if (!surface.corners.has(a.slot)) return notice({ error: "The first place was cut meanwhile: click both again" }), false;
    for (const place of [a, b]) {
      const id = ++strokes, { slot: face, bary, point } = place;
      sendInput("grab", { id, phase: "begin", face, bary, to: toWorld(point) });
      const move = (step) => {
        const to = toWorld(point.clone().lerp(middle, step / this.steps));
        sendInput("grab", { id, phase: step < this.steps ? "move" : "hold", to });
        if (step < this.steps) setTimeout(() => wire.open && move(step + 1), 40);
      };
      move(1);
    }
    return true;
  },
  leave() {
    this.first = null;
    showHint();
  },
};
clickTools.clamp = (x, y) => clamp.click(x, y);
