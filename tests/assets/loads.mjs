// The loads that bonds carry, from the motion of rigid bodies.
//
// Newton and Euler give the force and the torque that all bonds together exert on a body. A tree of bonds has one
// solution; where there are loops, the loads are those of the least complementary energy, for bonds whose stiffness is in
// proportion to their area.
import {cross, sub} from './asset.mjs';

// Solves the symmetric system A x = b in place, by elimination.
function solve(A, b) {
  const n = b.length;
  for (let k = 0; k < n; ++k)
    for (let i = k + 1; i < n; ++i) {
      const f = A[i][k] / A[k][k];
      if (f === 0) continue;
      for (let j = k; j < n; ++j) A[i][j] -= f * A[k][j];
      b[i] -= f * b[k];
    }
  for (let k = n - 1; k >= 0; --k) {
    for (let j = k + 1; j < n; ++j) b[k] -= A[k][j] * b[j];
    b[k] /= A[k][k];
  }
  return b;
}

// bodies: [{center, need: [force, torque about center]}, …], null for a fixed one; need: what bonds have to provide.
// Returns for each bond [force on b's side by a's, torque about the bond's point].
export function bondLoads(bodies, bonds) {
  const row = [];
  let rows = 0;
  bodies.forEach((body, i) => { row[i] = body ? 6 * rows++ : -1; });
  const A = Array.from({length: 6 * rows}, () => new Float64Array(6 * rows)), need = new Float64Array(6 * rows);
  bodies.forEach((body, i) => { if (body) need.set([...body.need[0], ...body.need[1]], row[i]); });
  // Columns of a bond: unit forces and torques on b at the point, the opposite on a.
  const columns = bonds.map(bond => {
    const size = Math.sqrt(bond.area), unit = [];
    for (let k = 0; k < 6; ++k) {
      const e = [0, 0, 0];
      e[k % 3] = 1;
      const entries = [];
      for (const [i, sign] of [[bond.b, 1], [bond.a, -1]]) {
        if (row[i] < 0) continue;
        const wrench = k < 3 ? [...e, ...cross(sub(bond.point, bodies[i].center), e)] : [0, 0, 0, ...e];
        wrench.forEach((x, j) => { if (x !== 0) entries.push([row[i] + j, sign * x]); });
      }
      unit.push({entries, stiffness: k < 3 ? bond.area : bond.area * size * size / 12});
    }
    return unit;
  });
  for (const unit of columns)
    for (const {entries, stiffness} of unit)
      for (const [i, x] of entries) for (const [j, y] of entries) A[i][j] += stiffness * x * y;
  // A part that no bond holds to a fixed body may move as a whole: a trace of stiffness to the ground.
  const trace = A.reduce((sum, r, i) => sum + r[i], 0) / A.length;
  A.forEach((r, i) => { r[i] += 1e-10 * trace; });
  const lambda = solve(A, need);
  return columns.map(unit => {
    const w = unit.map(({entries, stiffness}) => stiffness * entries.reduce((sum, [i, x]) => sum + x * lambda[i], 0));
    return [w.slice(0, 3), w.slice(3)];
  });
}
