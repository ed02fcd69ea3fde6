// The studio in a worker of this page: requests to it, events from it, and the files of its run.

const worker = new Worker("worker.js");
const answered = [];
const addresses = new Map();

/** An address that exists while a search may go on; the worker, which hears nothing meanwhile, looks for it. */
let searching = null;

/** Sends a request, and waits until it is answered. */
function ask(request) {
  if (request.do === "pause") {
    URL.revokeObjectURL(searching);
    return Promise.resolve();
  }
  if (request.do === "design") searching = URL.createObjectURL(new Blob(["searching"]));
  worker.postMessage({ request, searching });
  return new Promise((resolve) => { answered.push(resolve); });
}

const MEDIA = { html: "text/html", svg: "image/svg+xml", png: "image/png", json: "application/json", csv: "text/plain", txt: "text/plain" };

function keepFiles(files) {
  for (const [name, bytes] of Object.entries(files)) {
    URL.revokeObjectURL(addresses.get(name));
    const type = MEDIA[name.split(".").pop()] ?? "application/octet-stream";
    addresses.set(name, URL.createObjectURL(new Blob([bytes], { type })));
  }
}

/** Calls the listeners of every kind with the data of their events. */
function connect(listeners) {
  const fail = (message) => {
    byId("offline").hidden = false;
    byId("offline").textContent = message;
  };
  worker.addEventListener("error", (error) => fail(`The studio failed: ${error.message}. Reload the page; the sheet is lost.`));
  worker.addEventListener("message", ({ data: { kind, data, files } }) => {
    if (kind === "answered") answered.shift()();
    else if (kind === "bytes") keepFiles(files);
    else if (kind === "failed") fail(data);
    else listeners[kind]?.(JSON.parse(data));
  });
}

/** How the command line goes on with the sheet. */
const atHome = () => "The sheet is in this tab alone: save its files. The program at home checks sheets by finite elements (kirigami verify).";

/** The address of a file of the run. */
const addressOf = (name) => addresses.get(name);
