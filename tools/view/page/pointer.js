// The pointer turns, moves and zooms; a click selects a node.
function listenToPointer() {
  const canvas = $("canvas");
  const pointers = new Map();
  let moved = 0, spread = 0;
  canvas.addEventListener("contextmenu", (e) => e.preventDefault());
  canvas.addEventListener("pointerdown", (e) => {
    canvas.setPointerCapture(e.pointerId);
    pointers.set(e.pointerId, e);
    if (pointers.size === 1) moved = 0;
    spread = 0;
  });
  canvas.addEventListener("pointermove", (e) => {
    const before = pointers.get(e.pointerId);
    if (!before) return;
    const dx = e.clientX - before.clientX, dy = e.clientY - before.clientY;
    moved += Math.abs(dx) + Math.abs(dy);
    pointers.set(e.pointerId, e);
    if (pointers.size === 2) {
      const [a, b] = [...pointers.values()], now = Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY);
      if (spread > 0) zoom(spread / Math.max(now, 1));
      spread = now;
      pan(dx / 2, dy / 2);
    } else if (before.buttons === 2 || e.shiftKey) pan(dx, dy);
    else turn(0.006 * dx, 0.006 * dy);
  });
  canvas.addEventListener("pointerup", (e) => {
    const only = pointers.size === 1;
    pointers.delete(e.pointerId);
    if (only && moved < 5 && e.button === 0) selectAt(e.offsetX, e.offsetY);
  });
  canvas.addEventListener("pointercancel", (e) => pointers.delete(e.pointerId));
  canvas.addEventListener("wheel", (e) => {
    e.preventDefault();
    zoom(Math.exp(0.0011 * Math.sign(e.deltaY) * Math.min(Math.abs(e.deltaY), 240)));
  }, { passive: false });
}
