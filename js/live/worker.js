// The worker of the static page: runs the loop of kerf-live, and passes messages on.
import makeLive from "./kerf-live.js";

const module = await makeLive();
const turns = new MessageChannel();  // a turn without the delay that browsers give to timers
let timer = 0, asked = false;

function pass() {
  for (let message = module.nextMessage(); message !== undefined; message = module.nextMessage()) postMessage(message.buffer, [message.buffer]);
}
// When the next turn is: at once, later, or with the next message.
function plan() {
  clearTimeout(timer);
  const wait = module.waitTime();
  if (wait < 0) return;
  if (wait < 4) askForTurn();
  else timer = setTimeout(turn, wait);
}
function askForTurn() {
  if (asked) return;
  asked = true;
  turns.port2.postMessage(0);
}
function turn() {
  asked = false;
  if (module.waitTime() > 4) return plan();
  const problem = module.takeTurn();
  if (problem !== "") postMessage({ error: problem });
  pass();
  plan();
}
turns.port1.onmessage = turn;

const answers = {
  open: ({ name, bytes, beside, up, nodes }) =>
    module.openModel(name, new Uint8Array(bytes), (beside ?? []).map((file) => ({ name: file.name, bytes: new Uint8Array(file.bytes) })), up ?? "", nodes ?? 0),
  save: ({ format }) => module.save(format),
};
onmessage = ({ data }) => {
  if (typeof data === "string") {
    module.message(data);
    pass();
    if (module.waitTime() < 0) askForTurn();
    return;
  }
  let answer;
  try {
    answer = answers[data.kind](data);
  } catch (problem) {
    answer = data.kind === "open" ? String(problem) : { error: String(problem) };
  }
  postMessage({ number: data.number, answer });
  pass(), plan();
};
postMessage({ ready: true });
