// Edges of the visibility graph, those that cracks cut, and the neighbourhood of the selected node (Fig. 4).
let rows = null;  // per node: entries { to, bits, distance }

function unpackRows() {
  const count = arrays["graph/count"], to = arrays["graph/to"], bits = arrays["graph/bits"], distance = arrays["graph/distance"];
  rows = Array.from(count, () => []);
  for (let i = 0, at = 0; i < count.length; i++)
    for (const end = at + count[i]; at < end; at++) {
      rows[i].push({ to: to[at], bits: bits[at], distance: distance[at] });
      rows[to[at]].push({ to: i, bits: bits[at], distance: distance[at] });
    }
}
const isEdge = (bits) => (bits & 1) !== 0, isNeighbor = (bits) => (bits & 2) !== 0, isBehind = (bits) => (bits & 4) !== 0;

// Shortest paths along edges from a node, no longer than `reach`: where each node was come to from.
function pathsFrom(start, reach) {
  const rest = arrays["nodes/rest"], length = new Map([[start, 0]]), from = new Map(), done = new Set();
  const span = (i, j) => Math.hypot(rest[3 * i] - rest[3 * j], rest[3 * i + 1] - rest[3 * j + 1], rest[3 * i + 2] - rest[3 * j + 2]);
  for (;;) {
    let at = -1;
    for (const [i, d] of length) if (!done.has(i) && (at < 0 || d < length.get(at))) at = i;
    if (at < 0) return from;
    done.add(at);
    for (const e of rows[at]) {
      if (!isEdge(e.bits)) continue;
      const d = length.get(at) + span(at, e.to);
      if (d <= reach && d < (length.get(e.to) ?? Infinity)) length.set(e.to, d), from.set(e.to, at);
    }
  }
}

class GraphLayer {
  constructor() {
    this.edges = new LineLayer(0x2b4c9b, 0.5, 2);
    this.cut = new LineLayer(0xd8231c, 1, 2.1);
    this.sticks = new Sticks(2.2);
    this.spots = new Spots(2.3);
  }
  update() {
    if (!hasNodes() || !about.nodes.graph) return;
    if (!rows) unpackRows();
    const position = nodePositions();
    this.edges.set(state.edges ? position : null, this.allEdges());
    this.cut.set(state.cut ? position : null, arrays["graph/cut"]);
    this.neighborhood(position);
  }
  allEdges() {
    if (this.pairs) return this.pairs;
    const pairs = [];
    rows.forEach((row, i) => row.forEach((e) => { if (e.to > i && isEdge(e.bits)) pairs.push(i, e.to); }));
    return this.pairs = new Uint32Array(pairs);
  }
  // Widths say how near; blue sees the node, orange is behind a face and reached along the thin path.
  neighborhood(position) {
    this.sticks.clear(), this.spots.hide();
    const i = state.selected;
    const there = (j) => 3 * j < (position ? position.length : 0);
    if (i < 0 || !there(i)) return;
    const point = (j) => new THREE.Vector3().fromArray(position, 3 * j), own = arrays["nodes/size"][i];
    const near = state.near ? rows[i].filter((e) => isNeighbor(e.bits) && there(e.to)) : [];
    const reach = near.reduce((most, e) => Math.max(most, e.distance), 1e-9), spots = [[i, [0.86, 0.10, 0.10], 1.9]];
    const from = near.some((e) => isBehind(e.bits)) ? pathsFrom(i, 2 * reach) : null, drawn = new Set();
    for (const e of near) {
      const width = 0.075 * own * (1.15 - e.distance / reach);
      if (!isBehind(e.bits)) this.sticks.add(point(i), point(e.to), width, [0.16, 0.36, 0.75]);
      else
        for (let j = e.to; from.has(j) && there(j) && there(from.get(j)); j = from.get(j)) {
          const step = j + "," + from.get(j);
          if (!drawn.has(step)) drawn.add(step), this.sticks.add(point(j), point(from.get(j)), 0.03 * own, [0.95, 0.55, 0.10]);
        }
      spots.push([e.to, isBehind(e.bits) ? [0.98, 0.62, 0.15] : [0.25, 0.52, 0.92], 1.25]);
    }
    this.spots.set(spots.flatMap(([j]) => [...point(j).toArray()]), spots.flatMap(([, color]) => color), spots.map(([j, , much]) => much * nodeDiameter(j)));
  }
  beforeDraw() { this.spots.beforeDraw(); }
}
