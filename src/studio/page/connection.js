// The connection to the studio: requests to it, events from it.

const token = new URLSearchParams(location.search).get("token") ?? "";
const withToken = (path) => `${path}?token=${token}`;

/** This page among those of the studio, and the number of its changes. */
const me = Math.random().toString(36).slice(2);
let changes = 0;

/** Sends a request; the reason appears if it is refused. */
async function ask(request) {
  try {
    const answer = await fetch(withToken("request"), { method: "POST", body: JSON.stringify(request) });
    if (!answer.ok) refuse(await answer.text());
  } catch {
    goOffline();
  }
}

let sending = false;
let unsent = false;

/** Sends the scene: the latest one as soon as the one before has arrived. */
async function sendScene() {
  changes += 1;
  unsent = true;
  document.documentElement.dataset.saved = false;
  if (sending) return;
  sending = true;
  while (unsent) {
    unsent = false;
    await ask({ do: "change", scene, by: [me, changes] });
  }
  sending = false;
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

/** Shows why a request was refused, at the field that it names or else above; nothing without a reason. */
function refuse(why) {
  const fields = byId("tools").hidden || !why ? [] : [...document.querySelectorAll("#studio [data-key]")];
  const named = fields.filter(({ dataset: { key } }) => {
    const at = why.indexOf(key);
    const beside = [why[at - 1], why[at + key.length]];
    return at >= 0 && !beside.some((character) => /[\w.[]/.test(character ?? ""));
  });
  document.querySelectorAll("#studio [aria-invalid]").forEach((field) => field.removeAttribute("aria-invalid"));
  document.querySelectorAll("#studio .at-field").forEach((text) => text.remove());
  for (const field of named) field.setAttribute("aria-invalid", "true");
  byId("refusal").hidden = !why || named.length > 0;
  byId("refusal").textContent = why;
  const last = named[named.length - 1];
  if (!last) return;
  const text = document.createElement("p");
  text.className = "refusal at-field";
  text.setAttribute("role", "alert");
  text.textContent = why;
  last.closest("details").open = true;
  last.closest("label").after(text);
}
