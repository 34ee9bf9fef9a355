// The transport of the static page: the program runs in a worker of this tab, and nothing leaves it.
const link = { worker: null, number: 0, waiting: new Map() };

function transmit(text) { link.worker.postMessage(text); }
// An answer of the worker to a request that is no message of the protocol.
function ask(request, transfer = []) {
  const number = ++link.number;
  return new Promise((done) => {
    link.waiting.set(number, done);
    link.worker.postMessage({ ...request, number }, transfer);
  });
}

function connect() {
  if (link.worker) return;
  const worker = new Worker(new URL("worker.js", location.href), { type: "module" });
  link.worker = worker;
  worker.onerror = (e) => connection("The simulation has stopped: " + (e.message || "the browser could not load it. Load the page again."));
  worker.onmessage = ({ data }) => {
    if (data instanceof ArrayBuffer) {
      if (!arrived(data)) connection(wire.broken);
    } else if (data.ready) openFirst();
    else if (data.error) notice({ error: data.error });
    else {
      link.waiting.get(data.number)(data.answer);
      link.waiting.delete(data.number);
    }
  };
}

// The model of the address, ?model=NAME&up=y&nodes=600, which is a file beside the page.
async function openFirst() {
  const wishes = new URLSearchParams(location.search), name = wishes.get("model") ?? "bear.off";
  try {
    if (/[:/\\]/.test(name)) throw new Error(`${name}: a model is a file beside this page`);
    const answer = await fetch(name);
    if (!answer.ok) throw new Error(`${name}: ${answer.statusText}`);
    const bytes = await answer.arrayBuffer();
    const reason = await ask({ kind: "open", name, bytes, up: wishes.get("up") ?? (name === "bear.off" ? "y" : ""), nodes: Number(wishes.get("nodes") ?? 0) }, [bytes]);
    if (reason !== "") throw new Error(reason);
    wire.open = true;
    sendWants(true), connection("");
  } catch (problem) {
    connection(problem.message + " – drop a model on the page");
  }
}

// Opens a model; the reason where it cannot be opened, else an empty text.
// `beside`: its materials and images.
async function openModel(file, beside) {
  const bytes = await file.arrayBuffer(), wishes = new URLSearchParams(location.search);
  const others = await Promise.all(beside.map(async (other) => ({ name: other.name, bytes: await other.arrayBuffer() })));
  const reason = await ask({ kind: "open", name: file.name, bytes, beside: others, up: wishes.get("up") ?? "", nodes: Number(wishes.get("nodes") ?? 0) }, [bytes]);
  if (reason === "" && !wire.open) wire.open = true, sendWants(true), connection("");
  return reason;
}

// Files are saved from the worker's memory.
document.addEventListener("click", async (e) => {
  const link = e.target.closest?.("a[href^='save?as=']");
  if (!link) return;
  e.preventDefault();
  const { bytes, name, error } = await ask({ kind: "save", format: new URLSearchParams(link.getAttribute("href").slice(5)).get("as") });
  if (error) return notice({ error });
  const saved = document.createElement("a");
  saved.href = URL.createObjectURL(new Blob([bytes])), saved.download = name;
  saved.click();
  setTimeout(() => URL.revokeObjectURL(saved.href), 60000);
});
