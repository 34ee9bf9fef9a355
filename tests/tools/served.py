"""Files for a browser of the tests: a folder, further files by their paths, and a page of its own."""
import functools, http.server, threading


def serve(folder, page=None, files={}):
    """The address, without the last slash, at which a thread serves folder, files, and page at "/" instead of the folder's index."""

    class Files(http.server.SimpleHTTPRequestHandler):
        def do_GET(self):
            if page is None or self.path != "/":
                return super().do_GET()
            self.send_response(200)
            self.send_header("Content-Type", "text/html")
            self.end_headers()
            self.wfile.write(page)

        def translate_path(self, path):
            return files.get(path) or super().translate_path(path)

        def log_message(self, *arguments):
            pass

    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Files, directory=folder))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    return f"http://127.0.0.1:{server.server_port}"
