// The frames of a run.
let lastTick = 0, behind = 0;

function showFrame(frame) {
  const n = frameCount();
  set("frame", Math.min(Math.max(frame, 0), n - 1));
}
function play(on) {
  state.playing = on && frameCount() > 1;
  $("play").textContent = state.playing ? "❚❚" : "▶";
  if (!state.playing) return;
  if (state.frame === frameCount() - 1) showFrame(0);
  set("rest", false);
  lastTick = performance.now(), behind = 0;
  requestAnimationFrame(tick);
}
function tick(now) {
  if (!state.playing) return;
  behind += Math.max(0, now - lastTick) * about.rate / 1000;
  lastTick = now;
  if (behind >= 1) {
    const next = state.frame + Math.min(Math.floor(behind), 4);  // a slow machine skips some
    behind %= 1;
    showFrame(next);
    if (next >= frameCount() - 1) return play(false);
  }
  requestAnimationFrame(tick);
}
