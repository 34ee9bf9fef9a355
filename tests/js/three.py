"""three.py FOLDER [PICTURE]: samples/js in a browser, where FOLDER/node_modules has kerf and three: a click breaks the crate.

Pieces keep texture coordinates and materials: of the planks, of the iron, and of new faces.
"""
import os, shutil, sys

sys.dont_write_bytecode = True
here = os.path.dirname(os.path.realpath(__file__))
sys.path.insert(0, os.path.join(here, "..", "tools"))
from browser import Browser
from served import serve

folder = os.path.abspath(sys.argv[1])
for name in ("index.html", "crate.js", "kerf-three.js"):
    shutil.copy(os.path.join(here, "..", "..", "samples", "js", name), folder)

address = serve(folder)
browser = Browser(720, 520)
try:
    browser.open(address + "/index.html")
    browser.run("import('/crate.js').then((crate) => { window.crate = crate; })")
    browser.click(330, 240)
    browser.run("""new Promise((done, failed) => { const end = performance.now() + 60000;
      const look = () => crate.pieces.children.length > 0 ? done(1) : performance.now() > end ? failed(new Error("nothing broke")) : setTimeout(look, 20); look(); })""")
    told = browser.run("""crate.pieces.children.map(({ geometry }) => {
      const { position, uv } = geometry.attributes, p = position.array;
      let six = 0, finite = true, varied = new Set();
      for (let i = 0; i < p.length; i += 9) {
        const [a, b, c] = [p.subarray(i, i + 3), p.subarray(i + 3, i + 6), p.subarray(i + 6, i + 9)];
        six += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
      }
      for (const x of uv.array) finite &&= Number.isFinite(x), varied.add(x);
      const covered = geometry.groups.reduce((sum, group) => sum + group.count, 0);
      return { volume: six / 6, corners: position.count, uvs: uv.count, covered, finite, varied: varied.size, materials: geometry.groups.map((group) => group.materialIndex) };
    })""")
    volume = sum(piece["volume"] for piece in told)
    assert len(told) == 24 and abs(volume / 1.4 ** 3 - 1) < 1e-5, (len(told), volume)
    for piece in told:
        assert piece["covered"] == piece["corners"] == piece["uvs"] and piece["finite"] and piece["varied"] > 10, piece
        assert 2 in piece["materials"] and all(0 <= i <= 2 for i in piece["materials"]), piece
    assert {i for piece in told for i in piece["materials"]} == {0, 1, 2}
    if len(sys.argv) > 2:
        browser.screenshot(sys.argv[2])
    assert not browser.errors, browser.errors
    print(f"three.js: {len(told)} pieces with materials and texture coordinates")
finally:
    browser.close()
