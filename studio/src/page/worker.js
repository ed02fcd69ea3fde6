// A worker that runs the studio: one request after the other, and the everyday level when no request comes for a moment.

/** Time without a request after which the everyday level is computed (ms). */
const REST = 200;

const files = new Files();
let resting;
let searching = null;
let heldFiles = null;

/** Whether the page has paused the search: the address that it gave is gone. */
function isPaused() {
  const look = new XMLHttpRequest();
  look.open("GET", searching, false);
  try {
    look.send();
    return false;
  } catch {
    return true;
  }
}

files.appears = (path) => (path === "pause" ? searching !== null && isPaused() : undefined);

function onLine(line, isError) {
  if (isError) return console.error(line);
  const tab = line.indexOf("\t");
  const [kind, data] = [line.slice(0, tab), line.slice(tab + 1)];
  if (kind === "files") heldFiles = data;
  else if (kind === "paths") sendFiles(JSON.parse(data));
  else postMessage({ kind, data });
}

/** Sends the files of the run before the list of them. */
function sendFiles(paths) {
  const bytes = Object.entries(paths).map(([name, path]) => [name, files.bytes(path)]);
  postMessage({ kind: "bytes", files: Object.fromEntries(bytes) });
  postMessage({ kind: "files", data: heldFiles });
  heldFiles = null;
}

/** The module, after its files have arrived. */
async function load() {
  if (typeof WebAssembly !== "object") throw new Error("this browser has no WebAssembly: take another one, or install kirigami");
  const get = async (path) => {
    const answer = await fetch(path);
    if (!answer.ok) throw new Error(`${path} is missing on the server (${answer.status})`);
    return answer;
  };
  const { first, later } = await (await get("files.json")).json();
  later.forEach((name) => files.putLater(name));
  const arrive = async (name) => files.put(name, new Uint8Array(await (await get(name)).arrayBuffer()));
  const system = wasi(files, onLine);
  const module = get("kirigami.wasm").then((answer) => WebAssembly.instantiateStreaming(answer, system.imports));
  const [{ instance }] = await Promise.all([module, ...first.map(arrive)]);
  system.begin(instance);
  instance.exports.start();
  return instance.exports;
}

const loaded = load();
loaded.catch((error) => postMessage({ kind: "failed", data: `The studio cannot start: ${error.message}.` }));

function compute(work, exports) {
  try {
    work();
    if (heldFiles) exports.paths();
  } catch (error) {
    postMessage({ kind: "failed", data: `The studio failed: ${error.message}. Reload the page; the sheet is lost.` });
  }
}

addEventListener("message", async ({ data }) => {
  const exports = await loaded;
  clearTimeout(resting);
  searching = data.searching;
  files.put("request.json", new TextEncoder().encode(JSON.stringify(data.request)));
  compute(exports.answer, exports);
  postMessage({ kind: "answered" });
  resting = setTimeout(() => compute(exports.rest, exports), REST);
});
