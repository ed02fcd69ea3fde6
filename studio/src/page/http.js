// The connection to the studio over HTTP: requests to it, events from it.

const token = new URLSearchParams(location.search).get("token") ?? "";
const withToken = (path) => `${path}?token=${token}`;

/** Sends a request; the reason appears if it is refused. */
async function ask(request) {
  try {
    const answer = await fetch(withToken("request"), { method: "POST", body: JSON.stringify(request) });
    if (!answer.ok) refuse(await answer.text());
  } catch {
    goOffline();
  }
}

function goOffline() {
  byId("offline").hidden = false;
  byId("offline").textContent =
    "The studio does not answer: it was ended. Start `kirigami studio` again with the folder of the sheet.";
}

/** Calls the listeners of every kind with the data of their events. */
function connect(listeners) {
  const stream = new EventSource(withToken("events"));
  for (const kind in listeners) stream.addEventListener(kind, (event) => listeners[kind](JSON.parse(event.data)));
  stream.addEventListener("open", () => { byId("offline").hidden = true; });
  stream.addEventListener("error", goOffline);
}

/** How the command line goes on with the sheet. */
const atHome = (command) => `In the terminal: ${command}`;

/** The address of a file of the run. */
const addressOf = (name) => withToken(`files/${name.split("/").map(encodeURIComponent).join("/")}`);
