// Requests to the studio, and what it refuses.

/** This page among the pages of the studio, and the number of its changes. */
const me = Math.random().toString(36).slice(2);
let changes = 0;

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
  for (let box = last.closest("details"); box; box = box.parentElement.closest("details")) box.open = true;
  last.closest("label").after(text);
}
