"""look.py READERS ORIGINAL.glb PIECES.glb [PICTURE]: three.js in headless Chromium draws the pieces, in their places, as the original.

READERS has three in node_modules. From each of four sides all pixels are compared but those within three of a border between pieces,
or of the outline: there the rounding of positions decides which triangle a pixel shows. The others may differ by 1 % of full
intensity; one in a thousand may differ more, where a texture's borders lie. PICTURE shows original, pieces and differences.
"""
import os, sys

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "tools"))
from browser import Browser
from served import serve

readers, original, pieces = (os.path.abspath(path) for path in sys.argv[1:4])
given = {"/original.glb": original, "/pieces.glb": pieces}
PAGE = b"""<!DOCTYPE html><meta charset='utf-8'><link rel='icon' href='data:,'><title>look</title><body style='margin:0'>
<script type='importmap'>{"imports": {"three": "/node_modules/three/build/three.module.js", "three/addons/": "/node_modules/three/examples/jsm/"}}</script>"""
SCRIPT = """(async () => {
  const THREE = await import("three"), { GLTFLoader } = await import("three/addons/loaders/GLTFLoader.js");
  const size = 480, renderer = new THREE.WebGLRenderer({ preserveDrawingBuffer: true, antialias: false });
  renderer.setPixelRatio(1), renderer.setSize(size, size), renderer.setClearColor(0x808080);
  document.body.append(renderer.domElement);
  const camera = new THREE.PerspectiveCamera(40, 1, 0.5, 10), lamp = new THREE.DirectionalLight(0xffffff, 2);
  const sceneOf = async (name) => {
    const scene = new THREE.Scene();
    const { scene: root } = await new GLTFLoader().loadAsync(name);
    scene.add(root, new THREE.HemisphereLight(0xffffff, 0x404040, 1.5), lamp.clone());
    return scene;
  };
  const shown = (scene) => {
    renderer.render(scene, camera);
    const gl = renderer.getContext(), pixels = new Uint8Array(4 * size * size);
    gl.readPixels(0, 0, size, size, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    return pixels;
  };
  lamp.position.set(1, 2, 1.5);
  const before = await sceneOf("/original.glb"), after = await sceneOf("/pieces.glb"), parts = await sceneOf("/pieces.glb");
  parts.children.slice(1).forEach((light) => parts.remove(light));
  let count = 0;
  for (const child of parts.children[0].children[0].children.length ? parts.children[0].children[0].children : parts.children[0].children) {
    const number = ++count, flat = new THREE.MeshBasicMaterial({ color: new THREE.Color().setRGB(number % 8 / 8 + 0.1, (number >> 3) % 8 / 8 + 0.1, 0.9, THREE.LinearSRGBColorSpace) });
    child.traverse((mesh) => { if (mesh.isMesh) mesh.material = flat; });
  }
  const views = [[0.3, 0.4], [1.9, -0.5], [3.4, 0.9], [5.0, -1.2]], told = { pieces: count, compared: 0, far: 0, most: 0, sum: 0, lit: 0 };
  const picture = document.createElement("canvas");
  picture.width = 3 * size, picture.height = views.length * size;
  const paper = picture.getContext("2d");
  views.forEach(([azimuth, elevation], row) => {
    camera.position.set(Math.cos(elevation) * Math.sin(azimuth), Math.sin(elevation), Math.cos(elevation) * Math.cos(azimuth)).multiplyScalar(3.2);
    camera.lookAt(0, 0, 0);
    const one = shown(before), other = shown(after), part = shown(parts);
    const border = new Uint8Array(size * size), reach = 3, apart = new Uint8ClampedArray(4 * size * size).fill(255);
    for (let y = 0; y < size; y++)
      for (let x = 0; x < size; x++)
        for (const [u, v] of [[x + 1, y], [x, y + 1]]) {
          const i = y * size + x, j = v * size + u;
          if (u >= size || v >= size || [0, 1, 2].every((c) => part[4 * i + c] === part[4 * j + c])) continue;
          for (let b = Math.max(0, y - reach); b <= Math.min(size - 1, y + reach); b++) border.fill(1, b * size + Math.max(0, x - reach), b * size + Math.min(size, x + reach + 1));
        }
    for (let i = 0; i < size * size; i++) {
      const d = Math.max(...[0, 1, 2].map((c) => Math.abs(one[4 * i + c] - other[4 * i + c])));
      apart.fill(border[i] ? 200 : 255 - Math.min(255, 20 * d), 4 * i, 4 * i + 3);
      if (border[i]) continue;
      if (one[4 * i] !== 0x80 || one[4 * i + 1] !== 0x80) told.lit++;
      told.compared++, told.sum += d / 255, told.far += d > 0.01 * 255, told.most = Math.max(told.most, d / 255);
    }
    [one, other, apart].forEach((pixels, column) => paper.putImageData(new ImageData(new Uint8ClampedArray(pixels), size), column * size, row * size));
  });
  renderer.domElement.replaceWith(picture);
  return told;
})()"""

address = serve(readers, PAGE, given)
browser = Browser(1440, 1920)
try:
    browser.open(address + "/")
    told = browser.run(SCRIPT)
    if len(sys.argv) > 4:
        browser.screenshot(sys.argv[4])
    assert not browser.errors, browser.errors
    assert told["pieces"] > 1 and told["lit"] > 100000, told
    print(f"three.js: {told['pieces']} pieces in their places: {told['lit']} pixels of the skin away from cracks, {told['far']} differ by more than "
          f"1 %, the mean difference is {100 * told['sum'] / told['compared']:.4f} %, the largest {100 * told['most']:.1f} %")
    assert told["far"] <= 0.001 * told["lit"], told
finally:
    browser.close()
