// The transport of a page that kerf-live serves: a WebSocket, and a request for each model that is opened.
const link = { socket: null, wait: 500 };
const patience = 10000;  // milliseconds without a connection, after which the page says what may be the reason

function transmit(text) { link.socket.send(text); }

function connect() {
  const address = new URL("live", location.href);
  address.protocol = address.protocol.replace("http", "ws"), address.hash = address.search = "";
  const socket = new WebSocket(address);
  socket.binaryType = "arraybuffer";
  link.socket = socket;
  socket.onopen = () => {
    wire.open = true, link.wait = 500, wire.sequence = -1, wire.lost = undefined;
    sendWants(true), connection("");
  };
  socket.onmessage = (e) => arrived(e.data) || socket.close();
  socket.onclose = (e) => {
    wire.open = false, endStroke();
    // 1001: the program has said that it ends.
    if (e.code === 1001) return connection("kerf-live has ended. Start it again, and open the address that it prints.");
    wire.lost ??= performance.now();
    const long = performance.now() - wire.lost > patience;
    connection(wire.broken ?? (long ? "kerf-live does not answer. If it has ended, start it again, and open the address that it prints." : "No connection – trying again …"));
    wire.broken = undefined;
    setTimeout(connect, link.wait);
    link.wait = Math.min(link.wait * 1.6, 5000);
  };
}

// Opens a model; the reason where it cannot be opened, else an empty text.
// `beside`: its materials and images.
async function openModel(file, beside) {
  const named = beside.map(({ name, size }) => `&beside=${encodeURIComponent(name)}:${size}`).join("");
  const answer = await fetch("open?name=" + encodeURIComponent(file.name) + named, { method: "POST", body: new Blob([file, ...beside]) });
  return answer.ok ? "" : (await answer.text()).trim();
}
