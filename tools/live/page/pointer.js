// Mouse, touch and pen: one finger or the left button has the tool, two fingers or the right button have the eye.
const pointers = new Map();
const spent = new Set();  // pointers that have drawn a stroke: after Escape, what is left of the drag does nothing
const slop = 5;     // pixels that a pointer moves before a knife cuts: a click does not
const stride = 3;   // pixels between two places of its path

// Where the pointer has been since the last event: the browser collects moves until it draws.
function placesOf(e) {
  const box = $("canvas").getBoundingClientRect(), places = [];
  for (const at of e.getCoalescedEvents?.() ?? []) {
    const place = [at.clientX - box.x, at.clientY - box.y], [x, y] = places[places.length - 1] ?? [Infinity, 0];
    if (Math.hypot(place[0] - x, place[1] - y) >= stride) places.push(place);
  }
  const [x, y] = places[places.length - 1] ?? [NaN, NaN];
  if (x !== e.offsetX || y !== e.offsetY) places.push([e.offsetX, e.offsetY]);
  return places;
}

// A click that does nothing says so.
function clickAt(x, y) {
  const click = clickTools[state.tool];
  if (!click) notice({ notice: `A click does not cut. ${does[state.tool]}` });
  else if (!click(x, y)) notice({ notice: beside });
}
const beside = "That is beside the body: click on it.";

function listenToPointer() {
  const canvas = $("canvas");
  let pending = null, pressed = null, spread = 0;  // pressed: where the orbit tool was, for a click
  canvas.addEventListener("contextmenu", (e) => e.preventDefault());
  canvas.addEventListener("pointerdown", (e) => {
    canvas.setPointerCapture(e.pointerId);
    pointers.set(e.pointerId, e);
    spread = 0;
    cursor.hide();
    if (pointers.size > 1 && hand.stroke?.kind === "grab") return spent.add(e.pointerId), keepHeld(hand.stroke);
    if (pointers.size > 1) return pending = pressed = null, endStroke();  // a second finger: the eye moves
    const grabs = state.tool === "grab", stays = grabs && (e.ctrlKey || e.metaKey);
    const tool = e.button === 0 && !e.shiftKey && !e.altKey && (stays || !e.ctrlKey);
    if (!tool) return;
    if (state.tool === "orbit") return pressed = { x: e.offsetX, y: e.offsetY };
    if (grabs) {
      if (!beginStroke(e.offsetX, e.offsetY, e.pointerId)) return;
      spent.add(e.pointerId);
      if (stays) keepHeld(hand.stroke);
    } else pending = { x: e.offsetX, y: e.offsetY, id: e.pointerId };
  });
  canvas.addEventListener("pointermove", (e) => {
    const before = pointers.get(e.pointerId);
    if (!before) return;
    const dx = e.clientX - before.clientX, dy = e.clientY - before.clientY;
    if (hand.stroke) {
      pointers.set(e.pointerId, e);
      if (hand.stroke.pointer === e.pointerId) for (const place of placesOf(e)) moveStroke(...place);
      return;
    }
    if (pending) {
      if (Math.hypot(e.offsetX - pending.x, e.offsetY - pending.y) < slop) return;
      const { x, y, id } = pending;
      pending = null;
      pointers.set(e.pointerId, e);
      if (beginStroke(x, y, id)) {
        spent.add(id);
        for (const place of placesOf(e)) moveStroke(...place);
        return;
      }
    }
    pointers.set(e.pointerId, e);
    if (!spent.has(e.pointerId)) moveEye(e, dx, dy);
  });
  // Two fingers turn, zoom and move at once; with the shift key or the middle button the eye moves sideways.
  const moveEye = (e, dx, dy) => {
    if (pointers.size === 2) {
      const [a, b] = [...pointers.values()], now = Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY);
      if (spread > 0) zoom(spread / Math.max(now, 1));
      spread = now;
      turn(0.003 * dx, 0.003 * dy);
    } else if (e.shiftKey || e.buttons & 4) pan(dx, dy);
    else turn(0.006 * dx, 0.006 * dy);
  };
  const up = (e) => {
    pointers.delete(e.pointerId), spent.delete(e.pointerId);
    if (hand.stroke && hand.stroke.pointer === e.pointerId) {
      if (e.type === "pointerup") moveStroke(e.offsetX, e.offsetY);
      if (e.ctrlKey || e.metaKey) keepHeld(hand.stroke);
      endStroke();
    } else if (pending && e.type === "pointerup") clickAt(e.offsetX, e.offsetY);
    if (pressed && e.type === "pointerup" && Math.hypot(e.offsetX - pressed.x, e.offsetY - pressed.y) < slop) clickTools.orbit(e.offsetX, e.offsetY);
    pending = pressed = null;
  };
  canvas.addEventListener("pointerup", up);
  canvas.addEventListener("pointercancel", up);
  canvas.addEventListener("wheel", (e) => {
    e.preventDefault();
    if (!hand.stroke) zoom(Math.exp(0.0011 * Math.sign(e.deltaY) * Math.min(Math.abs(e.deltaY), 240)));
  }, { passive: false });
}
