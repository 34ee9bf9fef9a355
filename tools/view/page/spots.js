// Shaded discs at points, as nodes are drawn.
const spotShader = {
  vertex: `
    attribute vec3 color; attribute float size; varying vec3 tint; uniform float scale; uniform vec4 cut;
    void main() {
      tint = color;
      vec4 eye = modelViewMatrix * vec4(position, 1.0);
      gl_Position = projectionMatrix * eye;
      gl_PointSize = max(2.0, size * scale / -eye.z);
      if (dot(position, cut.xyz) + cut.w < 0.0) gl_Position = vec4(0.0, 0.0, 3.0, 1.0);
    }`,
  fragment: `
    precision mediump float; varying vec3 tint;
    void main() {
      vec2 at = 2.0 * gl_PointCoord - 1.0;
      float r = dot(at, at);
      if (r > 1.0) discard;
      vec3 n = vec3(at.x, -at.y, sqrt(1.0 - r));
      gl_FragColor = vec4(tint * (0.45 + 0.6 * max(0.0, dot(n, vec3(-0.4, 0.5, 0.77)))), 1.0);
    }`,
};

// Discs at points: positions, colours and diameters of as many rows as there are.
class Spots {
  constructor(order) {
    this.material = new THREE.ShaderMaterial({ vertexShader: spotShader.vertex, fragmentShader: spotShader.fragment, uniforms: { scale: { value: 1 }, cut: { value: new THREE.Vector4(0, 0, 0, 1) } } });
    this.points = new THREE.Points(new THREE.BufferGeometry(), this.material);
    this.points.frustumCulled = false, this.points.renderOrder = order, this.points.visible = false;
    scene.add(this.points);
  }
  set(position, color, size) {
    this.points.geometry.dispose();
    this.points.geometry = new THREE.BufferGeometry()
      .setAttribute("position", new THREE.BufferAttribute(Float32Array.from(position), 3))
      .setAttribute("color", new THREE.BufferAttribute(Float32Array.from(color), 3))
      .setAttribute("size", new THREE.BufferAttribute(Float32Array.from(size), 1));
    this.points.visible = size.length > 0;
  }
  hide() { this.points.visible = false; }
  beforeDraw() {
    const u = this.material.uniforms;
    u.scale.value = renderer.domElement.height / (2 * Math.tan(camera.fov * Math.PI / 360));
    if (state.clip) u.cut.value.set(clipPlane.normal.x, clipPlane.normal.y, clipPlane.normal.z, clipPlane.constant);
    else u.cut.value.set(0, 0, 0, 1);
  }
}
