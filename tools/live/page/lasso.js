// A closed line cuts out what is in it: the knife's edge goes round once the line is drawn, and ends across its own begin.
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
  // The whole path, as messages of a knife; null: too short a line to close.
  closed() {
    const path = lassoPath(this.places, Math.max(8, this.spacing()));
    return path && path.map(([x, y]) => this.knife.message(x, y));
  }
  // The distance of nodes on the screen.
  spacing() {
    const focal = $("canvas").clientHeight / (2 * Math.tan(camera.fov * Math.PI / 360));
    return (live.told.spacing / about.unit) * focal / camera.position.distanceTo(this.knife.sphere.middle);
  }
}
// The path of a lasso on the screen. The line begins `wanted` pixels inside of itself, less in a small one, and its end goes across this begin: two cracks
// that meet at a wide angle part what is between them. null: the line is too short.
function lassoPath(places, wanted) {
  const size = Math.max(...[0, 1].map((k) => Math.max(...places.map((p) => p[k])) - Math.min(...places.map((p) => p[k]))));
  const reach = Math.min(wanted, size / 5), shortest = 24;  // pixels
  if (places.length < 4 || size < shortest) return null;
  let area = 0;
  places.forEach(([x, y], i) => {
    const [u, v] = places[(i + 1) % places.length];
    area += x * v - y * u;
  });
  // The first place that is far enough from the first of all: there the edge comes out to the line.
  const from = places.findIndex(([x, y]) => Math.hypot(x - places[0][0], y - places[0][1]) >= reach), at = places[from];
  const along = [at[0] - places[0][0], at[1] - places[0][1]], long = Math.hypot(...along), tangent = along.map((d) => d / long);
  const inward = area > 0 ? [-tangent[1], tangent[0]] : [tangent[1], -tangent[0]];
  const beside = (a, b) => [at[0] + a * inward[0] + b * tangent[0], at[1] + a * inward[1] + b * tangent[1]];
  const corners = [beside(2 * reach, 0), ...places.slice(from), places[0], beside(reach, 0), beside(1.4 * reach, 2.5 * reach)];
  const path = [corners[0]];
  for (const [x, y] of corners.slice(1)) {
    const [px, py] = path[path.length - 1], n = Math.ceil(Math.hypot(x - px, y - py) / 6);
    for (let i = 1; i <= n; i++) path.push([px + (x - px) * i / n, py + (y - py) * i / n]);
  }
  return path;
}
handTools.lasso = Lasso;
