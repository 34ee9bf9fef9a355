// Rigid things that bodies lie on and are pressed by; they are not there at rest, nor are they cut away.
class ObstacleLayer {
  constructor() {
    this.mesh = new THREE.Mesh(new THREE.BufferGeometry(), new THREE.MeshPhongMaterial({ color: 0x9a9da3, specular: 0x161616, shininess: 30, side: THREE.DoubleSide, flatShading: true }));
    this.mesh.frustumCulled = false, this.mesh.renderOrder = 2;
    scene.add(this.mesh);
    if (about.obstacles.length > 0) this.mesh.geometry.setIndex(new THREE.BufferAttribute(arrays["obstacles/triangles"], 1));
  }
  update() {
    const name = about.obstacles[shownSurface()];
    this.mesh.visible = state.obstacles && name !== undefined;
    if (this.mesh.visible && name !== this.name) this.mesh.geometry.setAttribute("position", new THREE.BufferAttribute(arrays[name], 3)), this.name = name;
  }
}
