// A pointer for the keyboard: arrow keys move a cross over the body, and Enter presses and releases what the tool does there.
const cursor = {
  shown: false, x: 0, y: 0, hint: "Arrow keys move the cross, with Shift by small steps. Enter begins and ends; Escape leaves.",
  show() {
    const canvas = $("canvas");
    this.shown = true, this.x = canvas.clientWidth / 2, this.y = canvas.clientHeight / 2;
    this.place();
    showHint();
  },
  hide() {
    if (!this.shown) return;
    this.shown = false, $("cursor").hidden = true;
    showHint();
  },
  place() {
    $("cursor").hidden = false;
    $("cursor").style.transform = `translate(${this.x}px, ${this.y}px)`;
  },
  move(x, y, finely) {
    const canvas = $("canvas"), step = finely ? 2 : 10;  // pixels
    this.x = Math.min(Math.max(this.x + step * x, 0), canvas.clientWidth), this.y = Math.min(Math.max(this.y + step * y, 0), canvas.clientHeight);
    this.place();
    if (hand.stroke?.pointer === "keys") moveStroke(this.x, this.y);
  },
  // Enter; with Ctrl a grab stays.
  press(stays) {
    if (!this.shown) return this.show();
    if (hand.stroke) {
      if (stays) keepHeld(hand.stroke);
      return endStroke();
    }
    const done = clickTools[state.tool]?.(this.x, this.y) ?? beginStroke(this.x, this.y, "keys");
    if (!done) notice({ notice: "The cross is not on the body." });
  },
};
