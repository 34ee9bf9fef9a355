// Masters and their trees of slaves over the surface (Fig. 5c).
class BindingLayer {
  constructor() {
    this.all = new LineLayer(0x178a3c, 0.85, 2.4);
    this.own = new LineLayer(0x0c6b2b, 1, 2.5);
    this.links = new Sticks(2.6);
    this.masters = new Spots(2.7);
    this.slaves = new Spots(2.7);
  }
  update() {
    if (!hasNodes() || !about.nodes.tree) return;
    const parent = arrays["tree/parent"], node = arrays["tree/node"], at = shownSurface();
    // The rows of the tree are those of the surface at rest; a frame has the same ones when it is of the same state.
    const fits = at >= 0 && nodePositions() !== null && arrays[about.surfaces[at].position].length === 3 * parent.length;
    const vertices = fits ? shownPositions(at) : null, nodes = fits ? nodePositions() : null;
    this.all.set(state.tree ? vertices : null, this.pairs ??= this.links_of(parent, (v) => parent[v] !== v));
    this.links.clear(), this.masters.hide(), this.slaves.hide();
    this.own.set(null, []);
    const mine = fits && state.own && state.selected >= 0 && 3 * state.selected < nodes.length ? this.treeOf(parent, node, state.selected) : null;
    if (mine) {
      this.own.set(vertices, this.links_of(parent, (v) => mine.has(v) && parent[v] !== v));
      const at_node = new THREE.Vector3().fromArray(nodes, 3 * state.selected), size = arrays["nodes/size"][state.selected];
      for (const v of mine)
        if (node[v] === state.selected + 1) this.links.add(at_node, new THREE.Vector3().fromArray(vertices, 3 * v), 0.04 * size, [0.86, 0.12, 0.10]);
    }
    const shown = state.tree || mine ? [...node.keys()].filter((v) => node[v] > 0 && fits && (state.tree || mine.has(v))) : [];
    this.spots(this.masters, vertices, shown, [0.05, 0.62, 0.22], 0.011);
    this.spots(this.slaves, vertices, mine ? [...mine].filter((v) => node[v] === 0) : [], [0.35, 0.75, 0.40], 0.007);
  }
  spots(layer, vertices, shown, color, size) {
    if (shown.length > 0) layer.set(shown.flatMap((v) => [vertices[3 * v], vertices[3 * v + 1], vertices[3 * v + 2]]), shown.flatMap(() => color), shown.map(() => size * state.size));
  }
  links_of(parent, wanted) {
    const pairs = [];
    for (let v = 0; v < parent.length; v++) if (wanted(v)) pairs.push(v, parent[v]);
    return new Uint32Array(pairs);
  }
  // All vertices that hang from the masters of a node.
  treeOf(parent, node, selected) {
    const mine = new Set();
    for (let v = 0; v < parent.length; v++) {
      let top = v;
      for (let steps = 0; parent[top] !== top && steps < parent.length; steps++) top = parent[top];
      if (node[top] === selected + 1) mine.add(v);
    }
    return mine;
  }
  beforeDraw() { this.masters.beforeDraw(), this.slaves.beforeDraw(); }
}
