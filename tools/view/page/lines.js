// Lines and sticks between points.
class LineLayer {
  constructor(color, opacity, order) {
    this.lines = new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ color, transparent: opacity < 1, opacity }));
    this.lines.frustumCulled = false, this.lines.renderOrder = order, this.lines.visible = false;
    scene.add(this.lines);
  }
  // Pairs of rows of `position`; those with a row that it does not have are left out.
  set(position, all) {
    this.lines.visible = position !== null && all.length > 0;
    if (!this.lines.visible) return;
    const rows = position.length / 3, pairs = all.some((row) => row >= rows) ? [] : all;
    if (pairs !== all) for (let i = 0; i < all.length; i += 2) if (all[i] < rows && all[i + 1] < rows) pairs.push(all[i], all[i + 1]);
    this.lines.geometry.dispose();
    this.lines.geometry = new THREE.BufferGeometry().setAttribute("position", new THREE.BufferAttribute(new Float32Array(position), 3));
    this.lines.geometry.setIndex(new THREE.BufferAttribute(pairs instanceof Uint32Array ? pairs : new Uint32Array(pairs), 1));
    this.lines.material.clippingPlanes = clipping();
  }
}

// Round sticks of any width, from their ends.
class Sticks {
  constructor(order) {
    this.geometry = new THREE.CylinderBufferGeometry(1, 1, 1, 7, 1, true).rotateX(Math.PI / 2);
    this.group = new THREE.Group();
    this.order = order;
    scene.add(this.group);
  }
  clear() {
    for (const mesh of this.group.children) mesh.material.dispose();
    this.group.remove(...this.group.children);
  }
  add(a, b, radius, color) {
    const mesh = new THREE.Mesh(this.geometry, new THREE.MeshPhongMaterial({ color: new THREE.Color(...color), specular: 0x111111, clippingPlanes: clipping() }));
    mesh.position.copy(a).add(b).multiplyScalar(0.5);
    mesh.lookAt(b);
    mesh.scale.set(radius, radius, Math.max(a.distanceTo(b), 1e-9));
    mesh.renderOrder = this.order;
    this.group.add(mesh);
  }
}
