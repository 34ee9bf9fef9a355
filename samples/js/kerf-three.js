// Geometries of three.js to solids of Kerf, and pieces of Kerf to geometries of three.js, with texture coordinates and a
// material for each group.
import * as THREE from "three";

/** A Solid of a closed BufferGeometry. Vertices at one place become one; `names` of materials are those of its groups. */
export function solidOf(k, geometry, names = ["skin"]) {
  const position = geometry.getAttribute("position"), uv = geometry.getAttribute("uv"), index = geometry.getIndex();
  const corners = index ? index.count : position.count, corner = (i) => (index ? index.getX(i) : i);
  const places = new Map(), vertices = [], faces = [], coordinates = [];
  for (let i = 0; i < corners; ++i) {
    const v = corner(i), place = [position.getX(v), position.getY(v), position.getZ(v)], key = place.map((x) => x.toFixed(6)).join();
    if (!places.has(key)) places.set(key, places.size), vertices.push(...place);
    faces.push(places.get(key));
    if (uv) coordinates.push(uv.getX(v), uv.getY(v));
  }
  const groups = new Int32Array(corners / 3);
  for (const { start, count, materialIndex } of geometry.groups) groups.fill(materialIndex, start / 3, (start + count) / 3);
  return new k.Solid(vertices, faces, { ...(uv ? { uv: coordinates } : {}), groups, groupNames: names });
}

/** A BufferGeometry of a piece, with a group for each material in the order of `names`, about its own middle. */
export function geometryOf(piece, names) {
  const { vertices, faces, uv, groups, groupNames, centroid } = piece;
  const order = [...groups.keys()].sort((a, b) => groups[a] - groups[b]);
  const position = new Float32Array(3 * faces.length), coordinates = new Float32Array(2 * faces.length), geometry = new THREE.BufferGeometry();
  let start = 0;
  order.forEach((face, at) => {
    for (let c = 0; c < 3; ++c) {
      const to = 3 * at + c, from = 3 * face + c;
      for (let x = 0; x < 3; ++x) position[3 * to + x] = vertices[3 * faces[from] + x] - centroid[x];
      coordinates.set(uv.subarray(2 * from, 2 * from + 2), 2 * to);
    }
    if (at + 1 < order.length && groups[order[at + 1]] === groups[face]) return;
    geometry.addGroup(start, 3 * (at + 1) - start, names.indexOf(groupNames[groups[face]]));
    start = 3 * (at + 1);
  });
  geometry.setAttribute("position", new THREE.BufferAttribute(position, 3));
  geometry.setAttribute("uv", new THREE.BufferAttribute(coordinates, 2));
  geometry.computeVertexNormals();
  return geometry;
}
