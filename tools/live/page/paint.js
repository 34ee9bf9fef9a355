// The model's own colours: materials with images, and the place and tint of each corner of its skin.
class Paint {
  constructor() {
    this.materials = [], this.textures = [], this.has = false;
    this.clear();
  }
  clear() { this.material = new Uint16Array(0), this.at = new Float32Array(0), this.tint = new Uint32Array(0), this.has = false; }
  // The message LOOK: its images are drawn when they are decoded.
  async take({ about: { materials, images }, bytes }) {
    for (const texture of this.textures) texture && texture.dispose();
    this.materials = materials, this.textures = [];
    let from = 0;
    const blobs = images.map(({ type, bytes: size }) => new Blob([bytes.slice(from, from += size)], { type }));
    const decoded = await Promise.all(blobs.map((blob) => this.decoded(blob)));
    this.textures = materials.map(({ image, wrap }) => {
      if (image < 0 || !decoded[image]) return null;
      const texture = new THREE.CanvasTexture(decoded[image]);
      [texture.wrapS, texture.wrapT] = wrap.map((kind) => [THREE.RepeatWrapping, THREE.MirroredRepeatWrapping, THREE.ClampToEdgeWrapping][kind]);
      texture.anisotropy = 4;
      return texture;
    });
    if (images.some((image, i) => !decoded[i])) notice({ notice: "An image of the model cannot be decoded, and is left out." });
    surface.repaint();
  }
  // As a square whose side is a power of two, so that it may repeat; null where it cannot be decoded.
  async decoded(blob) {
    const image = new Image(), address = URL.createObjectURL(blob), side = (x) => Math.min(4096, 2 ** Math.round(Math.log2(Math.max(1, x))));
    try {
      image.src = address;
      await image.decode();
    } catch (problem) {
      return null;
    } finally {
      URL.revokeObjectURL(address);
    }
    const canvas = document.createElement("canvas");
    canvas.width = side(image.naturalWidth), canvas.height = side(image.naturalHeight);
    canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
    return canvas;
  }
  reserve(slots) {
    this.material = grown(this.material, slots), this.at = grown(this.at, 6 * slots), this.tint = grown(this.tint, 3 * slots);
  }
  // Row i of what a message has, for a slot.
  put(slot, from, i) {
    this.has = true;
    this.material[slot] = from.material[i];
    this.at.set(from.at.subarray(6 * i, 6 * i + 6), 6 * slot), this.tint.set(from.tint.subarray(3 * i, 3 * i + 3), 3 * slot);
  }
  // A geometry whose corners are those of some slots, by material: { corners, groups: [{ start, count, material }], uv, tint }.
  arranged(slots) {
    const order = Uint32Array.from(slots).sort((a, b) => this.material[a] - this.material[b] || a - b), n = order.length;
    const result = { corners: new Uint32Array(3 * n), uv: new Float32Array(6 * n), tint: new Uint8Array(9 * n), groups: [] };
    order.forEach((slot, i) => {
      const material = Math.min(this.material[slot], this.materials.length), last = result.groups[result.groups.length - 1];
      if (last && last.material === material) last.count += 3;
      else result.groups.push({ start: 3 * i, count: 3, material });
      result.uv.set(this.at.subarray(6 * slot, 6 * slot + 6), 6 * i);
      for (let k = 0; k < 3; k++) {
        const tint = this.tint[3 * slot + k];
        result.corners[3 * i + k] = 3 * slot + k;
        for (let d = 0; d < 3; d++) result.tint[9 * i + 3 * k + d] = (tint >> (8 * d)) & 255;
      }
    });
    return result;
  }
}
