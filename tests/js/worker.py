"""worker.py FOLDER: samples/js/soft-worker.js in a browser's worker, where FOLDER/node_modules has kerf: a knife parts the block."""
import os, shutil, sys

sys.dont_write_bytecode = True
here = os.path.dirname(os.path.realpath(__file__))
sys.path.insert(0, os.path.join(here, "..", "tools"))
from browser import Browser
from served import serve

folder = os.path.abspath(sys.argv[1])
shutil.copy(os.path.join(here, "..", "..", "samples", "js", "soft-worker.js"), folder)
PAGE = b"<!DOCTYPE html><meta charset='utf-8'><link rel='icon' href='data:,'><title>worker</title>"

address = serve(folder, PAGE)
browser = Browser()
try:
    browser.open(address + "/")
    browser.run("""{
      const worker = new Worker("/soft-worker.js", { type: "module" });
      window.frame = (knife) => new Promise((done, failed) => {
        worker.onmessage = ({ data }) => done({ ...data, vertices: data.vertices?.length, faces: data.faces?.length });
        worker.onerror = ({ message }) => failed(new Error(message));
        worker.postMessage({ knife });
      });
    }""")
    frames = [browser.run(f"frame({knife})") for knife in (0.9, 0.6, 0.3, 0, -0.2, "")]
    assert all("failure" not in frame for frame in frames), frames
    assert [frame["pieces"] for frame in frames][0] == 1 and frames[-1]["pieces"] == 2, frames
    assert frames[-1]["vertices"] > frames[0]["vertices"] > 0 and frames[-1]["faces"] % 3 == 0, frames
    wrong = browser.run("frame(NaN)")
    assert wrong["failure"].startswith("InputError"), wrong
    assert not browser.errors, browser.errors
    print(f"worker: {len(frames)} frames, {frames[-1]['pieces']} pieces")
finally:
    browser.close()
