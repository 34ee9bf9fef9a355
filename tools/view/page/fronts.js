// Fronts, a line a time step, and the ways of their points.
class FrontLayer {
  constructor() {
    this.group = new THREE.Group();
    scene.add(this.group);
    for (const front of about.fronts) {
      const points = arrays[front.points];
      let first = 0;
      front.steps.forEach((count, step) => {
        const line = points.slice(3 * first, 3 * (first + count)), color = new THREE.Color(...scaleColor(front.steps.length > 1 ? step / (front.steps.length - 1) : 0));
        const geometry = new THREE.BufferGeometry().setAttribute("position", new THREE.BufferAttribute(line, 3));
        const material = new THREE.LineBasicMaterial({ color });
        this.group.add(front.closed ? new THREE.LineLoop(geometry, material) : new THREE.Line(geometry, material));
        if (front.steps[step + 1] === count) {
          const ways = [];
          for (let i = 0; i < count; i++) ways.push(first + i, first + count + i);
          const links = new THREE.BufferGeometry().setAttribute("position", new THREE.BufferAttribute(points, 3));
          links.setIndex(ways);
          this.group.add(new THREE.LineSegments(links, new THREE.LineBasicMaterial({ color: 0x808894, transparent: true, opacity: 0.5 })));
        }
        first += count;
      });
    }
  }
  update() {
    this.group.visible = state.fronts;
    for (const line of this.group.children) line.material.clippingPlanes = clipping();
  }
}
