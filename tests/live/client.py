"""kerf-live as a program: starts it, talks to it over HTTP and WebSocket with the standard library alone."""
import base64, json, os, re, signal, socket, struct, subprocess, threading, time, urllib.parse, urllib.request

STATE, DELTA, FRAME, GRAPH, NOTICE = 1, 2, 3, 4, 5


class Program:
    """kerf-live with a scene or a model; `address` ends in the token and a slash."""

    def __init__(self, program, *arguments):
        self.process = subprocess.Popen([program, *map(str, arguments), "--no-browser", "--port", "0"], stdout=subprocess.PIPE,
                                        stderr=subprocess.PIPE, text=True)
        self.said = []
        threading.Thread(target=lambda: self.said.extend(self.process.stderr), daemon=True).start()
        line, self.address = "", None
        while self.address is None:
            line = self.process.stdout.readline()
            assert line, "kerf-live ended: " + "".join(self.said)
            found = re.search(r"http://\S+/", line)
            self.address = found and found.group(0)
        threading.Thread(target=self.process.stdout.read, daemon=True).start()

    def save(self, kind, path):
        with urllib.request.urlopen(f"{self.address}save?as={kind}", timeout=120) as answer, open(path, "wb") as file:
            file.write(answer.read())

    def memory(self):
        """Resident bytes."""
        with open(f"/proc/{self.process.pid}/statm") as file:
            return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")

    def stop(self):
        """Ends it as Ctrl-C does; the exit code."""
        self.process.send_signal(signal.SIGINT)
        try:
            return self.process.wait(20)
        except subprocess.TimeoutExpired:
            self.process.kill()
            raise


class Client:
    """One WebSocket: messages are read by `next`, which acknowledges them."""

    def __init__(self, address, origin=None, timeout=60):
        parts = urllib.parse.urlsplit(address)
        self.socket = socket.create_connection((parts.hostname, parts.port), timeout=timeout)
        key = base64.b64encode(os.urandom(16)).decode()
        self.socket.sendall((f"GET {parts.path}live HTTP/1.1\r\nHost: {parts.netloc}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                             f"Sec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\nOrigin: {origin or 'http://' + parts.netloc}\r\n\r\n").encode())
        self.rest = b""
        while b"\r\n\r\n" not in self.rest:
            more = self.socket.recv(65536)
            assert more, "kerf-live closed the connection"
            self.rest += more
        head, self.rest = self.rest.split(b"\r\n\r\n", 1)
        assert head.startswith(b"HTTP/1.1 101"), head.decode()
        self.input, self.notices, self.bytes, self.told = 0, [], 0, None

    def send(self, message):
        data, mask = json.dumps(message).encode(), os.urandom(4)
        size = bytes([0x80 | len(data)]) if len(data) < 126 else b"\xfe" + struct.pack(">H", len(data))
        self.socket.sendall(b"\x81" + size + mask + bytes(b ^ mask[i & 3] for i, b in enumerate(data)))

    def act(self, kind, **message):
        self.input += 1
        self.send({kind: {**message, "input": self.input}})

    def exactly(self, count):
        parts, have = [self.rest], len(self.rest)
        while have < count:
            more = self.socket.recv(1 << 20)
            assert more, "kerf-live closed the connection"
            parts.append(more)
            have += len(more)
        data = b"".join(parts)
        self.rest = data[count:]
        return data[:count]

    def message(self):
        """The next binary message."""
        while True:
            first, size = self.exactly(2)
            if size == 126:
                size = struct.unpack(">H", self.exactly(2))[0]
            elif size == 127:
                size = struct.unpack(">Q", self.exactly(8))[0]
            data = self.exactly(size)
            if first & 15 == 8:
                raise ConnectionError("kerf-live closed the connection")
            if first & 15 == 9:
                self.socket.sendall(b"\x8a\x80" + os.urandom(4))
            if first & 15 == 2:
                self.bytes += size
                return data

    def next(self):
        """The statistics of the next frame, with `kind`, `time`, `vertices` and `nodes`; notices are kept in `notices`."""
        while True:
            data = self.message()
            kind, flags, version, sequence, at = struct.unpack_from("<BBHId", data)
            assert version == 1
            self.send({"ack": sequence})
            if kind == NOTICE:
                self.notices.append(json.loads(data[16:]))
                continue
            if kind == GRAPH:
                continue
            frame = 16
            if kind == STATE:
                _, _, faces, _, size = struct.unpack_from("<5I", data, frame)
                size = (size + 3) & ~3
                self.told = json.loads(data[frame + 20:frame + 20 + size])
                frame += 20 + size + 12 * faces + ((faces + 3) & ~3)
            elif kind == DELTA:
                _, _, _, removed, added = struct.unpack_from("<5I", data, frame)
                frame += 20 + 4 * removed + 16 * added + ((added + 3) & ~3)
            revision, vertices, nodes, size = struct.unpack_from("<4I", data, frame)
            stats = json.loads(data[frame + 16:frame + 16 + size])
            return {**stats, "kind": kind, "time": at, "vertices": vertices, "nodes": nodes, "revision": revision}

    def close(self):
        self.socket.close()


def stroke(client, eye, toward, depth, begin, id, seconds=0.4, steps=24):
    """A knife's stroke from an eye: rays through points between toward[0] and toward[1]; frames are read meanwhile."""
    def ray(at):
        to = [a + at * (b - a) - e for a, b, e in zip(toward[0], toward[1], eye)]
        size = sum(x * x for x in to) ** 0.5
        return [x / size for x in to]

    start = time.time()
    for step in range(steps + 1):
        phase = "begin" if step == 0 else "end" if step == steps else "move"
        client.act("knife", id=id, phase=phase, eye=eye, ray=ray(step / steps), depth=depth, **{"from": begin})
        while time.time() < start + seconds * step / steps:
            client.next()
