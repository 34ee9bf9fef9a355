"""in_chromium.py BUILD_DIR MODEL...: prints what `outcomes break MODEL...` prints in headless Chromium (js/build --tests)."""
import functools, http.server, os, sys, threading

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "tools"))
from browser import Browser

build, models = os.path.abspath(sys.argv[1]), [os.path.abspath(path) for path in sys.argv[2:]]
by_name = {"/models/" + os.path.basename(path): path for path in models}
PAGE = b"<!DOCTYPE html><meta charset='utf-8'><link rel='icon' href='data:,'><title>outcomes</title>"


class Files(http.server.SimpleHTTPRequestHandler):
    def do_GET(self):
        if self.path != "/":
            return super().do_GET()
        self.send_response(200)
        self.send_header("Content-Type", "text/html")
        self.end_headers()
        self.wfile.write(PAGE)

    def translate_path(self, path):
        return by_name.get(path) or super().translate_path(path)

    def log_message(self, *arguments):
        pass


server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Files, directory=build))
threading.Thread(target=server.serve_forever, daemon=True).start()
browser = Browser()
try:
    browser.open(f"http://127.0.0.1:{server.server_port}/")
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
