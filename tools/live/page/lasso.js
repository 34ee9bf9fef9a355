// A closed line cuts out what is in it: two edges of the knife go round, half of it each, once the line is drawn.
class Lasso {
  begin(x, y) {
    this.knife = new Knife(), this.places = [[x, y]], this.late = true;
    const message = this.knife.begin(x, y);
    this.edge = this.knife.edge;
    return message;
  }
  message(x, y) {
    this.places.push([x, y]);
    const message = this.knife.message(x, y);
    this.edge = this.knife.edge;
    return message;
  }
  row(message) { return this.knife.row(message); }
  // The paths, as messages of knives; null: too short a line to close.
  closed() {
    const paths = lassoPaths(this.places, this.spacing());
    return paths && paths.map((path) => path.map(([x, y]) => this.knife.message(x, y)));
  }
  // The distance of nodes on the screen.
  spacing() {
    const focal = $("canvas").clientHeight / (2 * Math.tan(camera.fov * Math.PI / 360));
    return (live.told.spacing / about.unit) * focal / camera.position.distanceTo(this.knife.sphere.middle);
  }
}
// The paths of a lasso on the screen: two strokes that go round half of it each, since an edge stays where it would come near the sheet that it has cut itself.
// Each begins inside of the line, comes out to it, goes along it, turns inwards, and goes across the begin of the other one at a right angle, so that both
// part what is in the line. All turns have 45 degrees. `spacing`: of the nodes, in pixels. null: the line is too short.
function lassoPaths(places, spacing) {
  const grid = 6, size = Math.max(...[0, 1].map((k) => Math.max(...places.map((p) => p[k])) - Math.min(...places.map((p) => p[k]))));  // pixels
  if (places.length < 4 || size < Math.max(24, 0.8 * spacing)) return null;
  const reach = Math.min(spacing, size / 5), gap = Math.ceil(Math.SQRT2 * reach / grid);
  const loop = straightEnd(smooth(closedLine(places, size, grid), Math.ceil(reach / 2 / grid)), gap + 2), n = loop.length;
  if (n < 4 * gap) return null;
  const half = Math.floor(n / 2), side = Math.sign(area(loop)), beside = ([x, y], way, a) => [x + a * way[0], y + a * way[1]];
  const joint = (at) => {
    const first = loop[at], last = loop[at - gap], long = Math.hypot(first[0] - last[0], first[1] - last[1]);
    const t = [0, 1].map((k) => (first[k] - last[k]) / long / Math.SQRT2);
    return { begin: beside(first, [t[0] + side * t[1], t[1] - side * t[0]], -2 * reach), end: beside(last, [t[0] - side * t[1], t[1] + side * t[0]], 2.5 * reach) };
  };
  const a = joint(half), b = joint(n - 1);
  return [[b.begin, loop[n - 1], ...loop.slice(0, half - gap + 1), a.end], [a.begin, ...loop.slice(half, n - gap), b.end]].map((path) => resampled(path, grid));
}
// Twice the area in a closed line.
function area(loop) {
  return loop.reduce((sum, [x, y], i) => sum + x * loop[(i + 1) % loop.length][1] - y * loop[(i + 1) % loop.length][0], 0);
}
// The line that a hand has closed, as places `step` apart. Where its end has passed its begin, or both are apart, the two places of its first and last thirds
// count that are nearest to each other.
function closedLine(places, size, step) {
  const line = resampled(places, step), third = Math.floor(line.length / 3);
  let best = [Infinity, 0, line.length - 1];
  for (let i = 0; i < third; i++)
    for (let j = line.length - third; j < line.length; j++) {
      const left = i + line.length - 1 - j, far = Math.hypot(line[i][0] - line[j][0], line[i][1] - line[j][1]) + 0.2 * step * left;  // as little as can be is left out
      if (far < best[0]) best = [far, i, j];
    }
  const [, from, to] = best;
  return resampled([...line.slice(from, to + 1), line[from]], step).slice(1);
}
// A closed line without sharp corners, at which a front would stay: each place is the mean of `reach` places to both sides, twice.
function smooth(loop, reach) {
  for (let pass = 0; pass < 2; pass++)
    loop = loop.map((_, i) => {
      const sum = [0, 0];
      for (let k = -reach; k <= reach; k++) loop[(i + k + loop.length * reach) % loop.length].forEach((x, axis) => sum[axis] += x / (2 * reach + 1));
      return sum;
    });
  return loop;
}
// The closed line so turned that its last `count` places are its straightest.
function straightEnd(loop, count) {
  const n = loop.length, bend = (i) => {
    const [a, b] = [loop[i], loop[(i + count) % n]], long = Math.hypot(b[0] - a[0], b[1] - a[1]);
    let way = 0;
    for (let k = 0; k < count; k++) way += Math.hypot(loop[(i + k + 1) % n][0] - loop[(i + k) % n][0], loop[(i + k + 1) % n][1] - loop[(i + k) % n][1]);
    return way / long;
  };
  const bends = loop.map((_, i) => bend(i)), from = (bends.indexOf(Math.min(...bends)) + count + 1) % n;
  return [...loop.slice(from), ...loop.slice(0, from)];
}
// Places on a polyline, at most `step` apart.
function resampled(corners, step) {
  const path = [corners[0]];
  for (const [x, y] of corners.slice(1)) {
    const [px, py] = path[path.length - 1], n = Math.ceil(Math.hypot(x - px, y - py) / step);
    for (let i = 1; i <= n; i++) path.push([px + (x - px) * i / n, py + (y - py) * i / n]);
  }
  return path;
}
handTools.lasso = Lasso;
