// The messages of kerf-live: binary ones are read into what the layers draw; text messages are what the hand does.
// Another file has the transport: connect(), transmit(text), openModel(file, beside).
const wire = { open: false, sequence: -1, held: null, input: 0, sent: new Map(), latency: 0, bytes: 0, messages: 0 };

// Little-endian fields, one after the other.
class Reader {
  constructor(buffer) { this.buffer = buffer, this.view = new DataView(buffer), this.at = 0; }
  u8() { return this.view.getUint8(this.at++); }
  u16() { return this.view.getUint16((this.at += 2) - 2, true); }
  u32() { return this.view.getUint32((this.at += 4) - 4, true); }
  f32() { return this.view.getFloat32((this.at += 4) - 4, true); }
  f64() { return this.view.getFloat64((this.at += 8) - 8, true); }
  floats(n) { return Array.from({ length: n }, () => this.f32()); }
  // Views without a copy; a message is aligned to four bytes throughout.
  array(kind, n) {
    const values = new kind(this.buffer, this.at, n);
    this.at += values.byteLength;
    return values;
  }
  align() { this.at = (this.at + 3) & ~3; }
  json(n) {
    const text = new TextDecoder().decode(new Uint8Array(this.buffer, this.at, n));
    this.at += n, this.align();
    return JSON.parse(text);
  }
}

function readFrame(r, flags) {
  const frame = { revision: r.u32(), vertices: r.u32(), nodes: r.u32() };
  frame.about = r.json(r.u32());
  frame.lo = r.floats(3), frame.step = r.floats(3);
  frame.position = r.array(Uint16Array, 3 * frame.vertices), r.align();
  if (flags & 1) frame.node = r.array(Uint16Array, 3 * frame.nodes), r.align();
  if (flags & 2) frame.stressMost = r.f32(), frame.stress = r.array(Uint16Array, frame.nodes), r.align();
  if (flags & 16) frame.skinStressMost = r.f32(), frame.skinStress = r.array(Uint16Array, frame.vertices), r.align();
  return frame;
}
// The paint of some triangles.
function readPaint(r, count) {
  const material = r.array(Uint16Array, count);
  r.align();
  return { material, at: r.array(Float32Array, 6 * count), tint: r.array(Uint32Array, 3 * count) };
}
function readState(r, flags) {
  const state = { revision: r.u32(), vertices: r.u32(), faces: r.u32(), nodes: r.u32() };
  state.about = r.json(r.u32());
  state.corners = r.array(Uint32Array, 3 * state.faces);
  state.patch = r.array(Uint8Array, state.faces), r.align();
  if (flags & 4) state.rest = r.array(Float32Array, 3 * state.vertices);
  if (flags & 8) state.paint = readPaint(r, state.faces);
  return state;
}
function readDelta(r, flags) {
  const delta = { from: r.u32(), to: r.u32(), vertices: r.u32() }, removed = r.u32(), added = r.u32();
  delta.removed = r.array(Uint32Array, removed);
  delta.added = r.array(Uint32Array, 4 * added);
  delta.patch = r.array(Uint8Array, added), r.align();
  if (flags & 4) delta.placed = r.array(Uint32Array, r.u32()), delta.rest = r.array(Float32Array, 3 * delta.placed.length);
  if (flags & 8) delta.paint = readPaint(r, added);
  return delta;
}

function receive(buffer) {
  const r = new Reader(buffer), kind = r.u8(), flags = r.u8(), version = r.u16(), sequence = r.u32(), time = r.f64();
  if (version !== 1) throw new Error("this page is of another version than the program: load it again");
  wire.bytes += buffer.byteLength, wire.messages++;
  if (kind === 5) return notice(r.json(buffer.byteLength - 16));  // needs no acknowledgement
  if (kind === 4) graphArrived(r.array(Uint32Array, 2 * r.u32()));
  if (kind === 1) stateArrived(readState(r, flags));
  if (kind === 2) deltaArrived(readDelta(r, flags));
  if (kind === 6) surface.paint.take({ about: r.json(r.u32()), bytes: buffer.slice(r.at) });
  if (kind <= 3) frameArrived(readFrame(r, flags), time);
  acknowledge(sequence);
}
// A page that nobody sees holds its acknowledgement back, and is sent nothing.
function acknowledge(sequence) {
  wire.sequence = sequence;
  if (!document.hidden) send({ ack: sequence });
}

function send(message) {
  if (wire.open) transmit(JSON.stringify(message));
}
// A message of the pointer, numbered: the frame that shows it tells how late that is.
function sendInput(kind, message) {
  const input = ++wire.input;
  wire.sent.set(input, performance.now());
  if (wire.sent.size > 500) wire.sent.delete(wire.sent.keys().next().value);
  send({ [kind]: { ...message, input } });
}
function inputTaken(input) {
  for (const [number, at] of wire.sent) {
    if (number > input) break;
    if (number === input) wire.latency = performance.now() - at;
    wire.sent.delete(number);
  }
}

// What the program has said: a sentence, or bytes. False where it cannot be understood.
function arrived(data) {
  if (typeof data === "string") return notice(JSON.parse(data)), true;
  try {
    receive(data);
    return true;
  } catch (problem) {
    console.error(problem);
    wire.broken = problem.message;
    return false;
  }
}
document.addEventListener("visibilitychange", () => {
  if (!document.hidden && wire.sequence >= 0) send({ ack: wire.sequence });
});
