"""in_chromium.py BUILD_DIR MODEL...: prints what `outcomes break MODEL...` prints in headless Chromium (js/build --all-tests)."""
import os, sys

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "tools"))
from browser import Browser
from served import serve

build, models = os.path.abspath(sys.argv[1]), [os.path.abspath(path) for path in sys.argv[2:]]
by_name = {"/models/" + os.path.basename(path): path for path in models}
PAGE = b"<!DOCTYPE html><meta charset='utf-8'><link rel='icon' href='data:,'><title>outcomes</title>"

address = serve(build, PAGE, by_name)
browser = Browser()
try:
    browser.open(address + "/")
    browser.run("""import("/outcomes-web.js").then(async (made) => {
      window.said = [];
      window.program = await made.default({ print: (line) => said.push(line), printErr: (line) => said.push(line) });
    })""")
    for name in by_name:  # one by one: an answer of the browser may take two minutes
        lines = browser.run(f"""fetch("{name}").then((answer) => answer.arrayBuffer()).then((bytes) => {{
          const file = "{os.path.basename(name)}";
          said.length = 0;
          program.FS.writeFile(file, new Uint8Array(bytes));
          program.callMain(["break", file]);
          return said.slice();
        }})""")
        print("\n".join(lines), flush=True)
    assert not browser.errors, browser.errors
finally:
    browser.close()
