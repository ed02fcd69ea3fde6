// The studio: what its events change on the page, and what its buttons ask.

document.body.classList.add("studio", "empty");
byId("title").textContent = document.title;
const mode = () => document.querySelector("#modes input:checked").value;

/** The texts of a report while something newer is drawn. */
const reported = () => ["summary", "facts-card", "warnings-card", "budget-card", "curve-card", "hinge-card", "forces-card"].map(byId);
const setStale = (stale) => reported().forEach((card) => card.classList.toggle("stale", stale));

let shop = { materials: [], machines: [], services: [], examples: [], levels: [], keys: {} };

/** What the levels cost for the sheet that is open, if that was measured. */
let levelCosts = [];

byId("miss").insertAdjacentHTML("afterend", '<p id="search" class="note screen-only"><progress id="bar" aria-label="work under way"></progress> <span id="left"></span></p>');
byId("state").insertAdjacentHTML("afterend", '<p id="fit" class="note screen-only"></p>');
stage.insertAdjacentHTML("beforeend", '<p id="drop-says" class="refusal screen-only" role="alert" hidden></p>');

/** Whether a search or the writing of files is under way: the sheet is not changed meanwhile. */
let busy = false;

let times = { draft: null, everyday: null, recent: [] };

/** The designs of this visit: run, loss, outline error, and the boundaries of the deployed panels (mm). */
let designs = [];

/** The scene file of the sheet that is open. */
let file = null;

/** What may be expected of the sheet that was fitted to a target. */
let fit = { target: "", says: "" };

connect({
  shop(offered) {
    shop = offered;
    const select = byId("new-material");
    select.textContent = "";
    for (const { file, name } of shop.materials) write(select, "option", name).value = file;
    if (!shop.materials.length) refuse("No material with weights here: start the studio in the folder of kirigami, or with a scene.");
    sayMaterial();
    writeExamples();
    for (const element of document.querySelectorAll("[data-meaning]")) element.title = meaningOf(element.dataset.meaning);
    byId("machine").length = byId("new-service").length = 1;
    for (const [name] of shop.machines) write(byId("machine"), "option", `for ${name}`).value = name;
    for (const [name] of shop.services) write(byId("new-service"), "option", name).value = name;
  },

  sheet({ file: opened, command }) {
    byId("terminal").textContent = atHome(command);
    if (opened !== file) openSheet(opened);
  },

  scene(event) {
    byId("undo").disabled = event.undo === 0;
    byId("redo").disabled = event.redo === 0;
    for (const id of ["files", "verdicts"]) byId(id).classList.toggle("stale", !event.run);
    byId("files-of").hidden = event.run || !byId("files").hasChildNodes();
    // Changes of this page that are on their way are newer.
    if (event.by?.[0] === me && event.by[1] < changes) return;
    document.documentElement.dataset.saved = true;
    const other = JSON.stringify(event.scene) !== JSON.stringify(scene);
    scene = event.scene;
    if (other) writeFields();
    sayFit();
  },

  draft(event) {
    crop = null;
    times.draft = event.ms;
    times.recent = [...times.recent, performance.now()].filter((t) => t > performance.now() - 1000);
    sayTimes();
    showDraft(event);
  },

  path(sheet) {
    if (!run || sheet.hinges.sites.length !== hingeCount) return;
    const fraction = fractionShown();
    take({ ...run, ...sheet });
    choosePath(fraction);
    show({ quantity: shownNow.quantity });
    setStale(true);
    sayWork("Writing the report \u2026");
  },

  page(event) {
    const first = !run;
    const fraction = first ? 1 : fractionShown();
    take(event.page);
    document.body.classList.remove("empty");
    setStale(false);
    if (event.run && run.history.step.length > 1) addDesign(event.run);
    if (event.ms !== null) times.everyday = event.ms;
    writeTexts();
    writeBlocking();
    writeDesigns();
    sayTimes();
    if (first || grown()) { measureExtent(); fitView(); }
    if (first || shownNow.hinge >= hingeCount) shownNow.hinge = run.worst;
    choosePath(fraction);
    layOut(false);
    if (first) writeFields();
    document.documentElement.dataset.pages = Number(document.documentElement.dataset.pages ?? 0) + 1;
  },

  step(event) {
    sayWork(`Step ${event.step} of ${event.of}`);
    const best = shown(event.history.outline_error[bestOf(event.history)], 3);
    const left = event.seconds_left === null ? "" : ` \u00b7 ${shown(Math.ceil(event.seconds_left), 2)} s left at most`;
    byId("left").textContent = `best so far ${best} mm from the target${left}`;
    Object.assign(byId("bar"), { value: event.step, max: event.of });
    if (!run) return;
    Object.assign(run, { history: event.history, end_of_search: `step ${event.step} of ${event.of}` });
    if (event.draft) showDraft(event.draft);
    writeSummary();
    byId("summary").classList.remove("stale");
    drawHistory();
  },

  working(what) {
    const texts = {
      everyday: "Following the path \u2026", design: "Searching \u2026", files: "Writing files \u2026",
      fit: "Fitting the sheet and the drawing to each other \u2026", panels: "Placing the panels \u2026", levels: "Measuring every level \u2026",
    };
    byId("search").classList.toggle("working", what !== null);
    byId("bar").removeAttribute("value");
    sayWork(texts[what] ?? "");
    busy = what !== null && what !== "everyday";
    byId("design").textContent = what === "design" ? "Pause" : "Design";
    document.querySelectorAll("#new-sheet input, #new-sheet select, #new-sheet button, #tools details input, #tools details select, #tools details button, #grip-menu, #undo, #redo, #another").forEach((element) => { element.inert = busy; });
    document.documentElement.dataset.working = what ?? "";
  },

  says({ refused, message }) {
    if (refused && taken) sayAtSheet(message);
    else refuse(refused ? message : "");
    if (refused) [taken, centreBefore] = [false, null];
    if (!refused && message) byId("progress").textContent = message;
  },

  pieces(pieces) {
    if (dropped) writePieces(pieces);
  },

  crop(shows) {
    crop = shows;
    byId("fit").textContent = `${crop.panels.length} panels show about ${shown(100 * crop.seen, 3)} % of the target`;
    layOut(false);
  },

  fit(expected) {
    fit = { ...fit, ...expected, target: JSON.stringify(expected.target) };
    sayFit();
    writeFields();
    keepInView(expected.target);
    taken = false;
  },

  levels(costs) {
    levelCosts = costs;
    chooseLevel();
    writeFields();
  },

  files({ files, verdicts }) {
    const list = byId("files");
    list.textContent = "";
    writeVerdicts(verdicts);
    for (const { name, contents } of files) {
      const link = write(write(list, "li"), "a", name);
      link.href = addressOf(name);
      link.title = contents;
      if (/\.(html|pdf|svg|png|txt)$/.test(name)) link.target = "_blank";
      else link.download = `${file.split("/").at(-2)}-${name.replaceAll("/", "-")}`;
    }
  },
});

/** Shows what is under way: next to the buttons, at the sheet and in the form. */
function sayWork(text) {
  byId("progress").textContent = byId("left").textContent = byId("new-work").textContent = text;
  byId("new-work").hidden = !text;
}

/** Says what may be expected of the fitted sheet, while the target is that of the fit. */
function sayFit() {
  byId("fit").textContent = fit.says;
  byId("fit").hidden = JSON.stringify(scene?.target) !== fit.target;
}

/** Buttons that mend what prevents a cut file: what each says and does, if the sheet has what it changes. */
const MENDS = {
  "cuts-too-close": () => ["Wider panels", () => ask({ do: "panels", panels: scene.sheet.panels.map((count) => Math.max(1, count - 1)) })],
  "cannot-be-cut": () => {
    const clips = [...scene.supports, ...scene.loads].filter(({ clip }) => clip);
    return clips.length > 0 && ["Narrower clips", () => { clips.forEach((grip) => { grip.clip *= 0.5; }); sendScene(); }];
  },
  tearing: () => scene.drive && ["Open it less", () => set("drive.stroke", 0.85 * scene.drive.stroke)],
};
MENDS.overstrained = MENDS.tearing;

/** The findings that prevent a cut file. */
function writeBlocking() {
  const list = byId("blocking");
  list.textContent = "";
  for (const { message, concern } of run.warnings.filter(({ severity }) => severity === "error")) {
    const item = write(list, "li");
    write(item, "span", "no cut file", "tag error");
    write(item, "span", `${message} `);
    const [text, mend] = MENDS[concern]?.() || [];
    if (mend) button(item, text, () => { mend(); updateFields(); }, "Changes the sheet; Undo takes it back");
  }
}

/** How far along the path the state is that is shown. */
const fractionShown = () => (stateCount < 2 ? 1 : shownNow.state / (stateCount - 1));

/** Chooses the state at a fraction of a new path, to be shown. */
function choosePath(fraction) {
  writeChoices();
  const quantity = quantities[shownNow.quantity] ? shownNow.quantity : "rotation";
  Object.assign(shownNow, { state: Math.round(fraction * (stateCount - 1)), quantity });
}

/** Draws a sheet at full load in place of the last path. */
function showDraft({ sheet }) {
  if (!run) return;
  const sameSheet = sheet.hinges.sites.length === hingeCount;
  take({ ...run, ...sheet });
  shownNow.state = stateCount - 1;
  // Drafts have no ensemble.
  if (!quantities[shownNow.quantity]) shownNow.quantity = byId("quantity").value = "rotation";
  if (!sameSheet) { shownNow.hinge = 0; measureExtent(); fitView(); }
  byId("slider").max = byId("slider").value = stateCount - 1;
  const quantity = quantities[shownNow.quantity];
  drawSheet(shownNow.state, quantity, shownNow.hinge);
  drawScale(quantity);
  byId("state").textContent = "At full load (draft)";
  writeMiss();
  setStale(true);
}

/** Whether the sheet or the target has left the view, or fills little of it. */
function grown() {
  const before = extent;
  measureExtent();
  const now = extent;
  extent = before;
  const size = Math.max(before.x1 - before.x0, before.y1 - before.y0);
  return ["x0", "x1", "y0", "y1"].some((side) => Math.abs(now[side] - before[side]) > 0.08 * size);
}

/** The boundaries of the deployed panels (mm). */
function finalOutline() {
  const last = stateCount - 1;
  return boundaries.map((_, k) => boundary(last, k));
}

/** Adds the best design of a run to the list, unless it is there. */
function addDesign(name) {
  const { loss, outline_error } = run.history;
  const best = bestOf(run.history);
  if (designs.some((design) => design.run === name && design.loss === loss[best])) return;
  designs.push({ run: name, loss: loss[best], error: outline_error[best], outline: finalOutline() });
}

overlays.push(() => {
  const before = byId("ghost").checked && designs[designs.length - 2];
  if (before) for (const panel of before.outline) draw(marks, "path", { d: outlinePath(panel), fill: "none", stroke: TEAL, "stroke-width": 1.2 });
});

function writeDesigns() {
  byId("designs-box").hidden = designs.length === 0;
  const table = byId("designs");
  table.textContent = "";
  const head = write(table, "tr");
  ["", "loss (mm\u00b2)", "outline (mm)"].forEach((text) => write(head, "th", text));
  designs.forEach(({ loss, error }, i) => {
    const row = write(table, "tr");
    [`design ${i + 1}`, shown(loss), shown(error, 3)].forEach((text) => write(row, "td", text));
  });
}

/** What services say of the files of machines. */
function writeVerdicts(verdicts) {
  const list = byId("verdicts");
  list.textContent = "";
  for (const [machine, services] of Object.entries(verdicts))
    for (const { name, refuses } of services) {
      const says = refuses.length ? `refuses ${refuses.join("; ")}` : "no published limit is broken";
      write(list, "li", `${machine}, ${name}: ${says}`, refuses.length ? "refusal" : "note");
    }
}

function sayTimes() {
  const parts = [];
  if (times.draft) parts.push(`draft ${shown(times.draft, 2)} ms (${times.recent.length} in the last second)`);
  if (times.everyday) parts.push(`whole path and report ${shown(times.everyday / 1000, 2)} s`);
  byId("speed").textContent = parts.join(" \u00b7 ");
}

function sayMaterial() {
  const material = shop.materials.find(({ file }) => file === byId("new-material").value);
  byId("new-says").textContent = material?.says ?? "";
  byId("new-thickness").placeholder = material ? String(material.thickness) : "";
}

/** Begins a sheet as the form says, for a drawing if there is one. */
function begin(drawing = null) {
  const [width, height, thickness, kerf, margin] = ["width", "height", "thickness", "kerf", "margin"].map((id) => byId(`new-${id}`).valueAsNumber || null);
  const [material, service, chosen] = ["material", "service", "stock"].map((id) => byId(`new-${id}`).value || null);
  const size = width && height && [width, height];
  if ((width === null) !== (height === null) || (chosen === "own" && !size)) return refuseNew("Give both width and height, or neither.");
  refuse("");
  const name = byId("new-name");
  const named = drawing && name.value === name.defaultValue ? drawing.name.replace(/\.(svg|dxf|png|jpe?g)$/i, "") : name.value;
  const stock = chosen === "own" ? size : chosen;
  if (service) byId("machine").value = shop.services.find(([name]) => name === service)[1];
  ask({ do: "new", name: named, material, thickness, size: stock ? null : size, stock, margin: stock && margin, kerf, service, drawing });
}

/** Refuses a new sheet, or a drawing for one, at the form. */
function refuseNew(why) {
  refuse(why);
  byId("refusal").scrollIntoView({ block: "nearest" });
}

function writeExamples() {
  const list = byId("examples");
  list.textContent = "";
  for (const { scene, title, becomes, picture } of shop.examples) {
    const open = button(write(list, "li"), "", () => ask({ do: "open", scene }), `Open a copy: ${becomes}`);
    if (picture) Object.assign(write(open, "img"), { src: `data:image/svg+xml,${encodeURIComponent(picture)}`, alt: "" });
    write(open, "b", title);
    write(open, "span", ` ${becomes}`, "note");
  }
}

/** Shows the tools of the sheet, or the form of a new one. */
function openTools(tools) {
  byId("tools").hidden = !tools;
  byId("new-sheet").hidden = tools;
  byId("back").hidden = file === null;
}

/** Waits for the first page of another sheet. */
function openSheet(other) {
  [file, run, designs, levelCosts] = [other, null, [], []];
  document.body.classList.add("empty");
  byId("files").textContent = "";
  writeVerdicts({});
  openTools(true);
}

byId("new-material").addEventListener("change", sayMaterial);
byId("new-stock").addEventListener("change", ({ target: { value } }) => {
  byId("new-margin").disabled = !value;
  for (const id of ["new-width", "new-height"]) byId(id).disabled = value && value !== "own";
});
byId("new-sheet").addEventListener("submit", (event) => {
  event.preventDefault();
  begin();
});
byId("new-drawing").addEventListener("change", (event) => takeDrawing(event.target.files[0]));
byId("another").addEventListener("click", () => openTools(false));
byId("back").addEventListener("click", () => { refuse(""); openTools(true); });
byId("design").addEventListener("click", () => ask({ do: byId("design").textContent === "Pause" ? "pause" : "design" }));
byId("undo").addEventListener("click", () => ask({ do: "undo" }));
byId("redo").addEventListener("click", () => ask({ do: "redo" }));
byId("write").addEventListener("click", () => ask({ do: "write", paper: byId("paper").value || null, machine: byId("machine").value || null }));
byId("machine").addEventListener("change", (event) => {
  byId("machine-says").textContent = shop.machines.find(([name]) => name === event.target.value)?.[1] ?? "";
});
byId("ghost").addEventListener("change", () => show({}));
byId("modes").addEventListener("change", () => { openGripMenu(null); show(mode() === "cells" ? { state: stateCount - 1 } : {}); });
document.addEventListener("keydown", (event) => {
  if (!(event.ctrlKey || event.metaKey) || event.key.toLowerCase() !== "z" || ["text", "number"].includes(event.target.type)) return;
  event.preventDefault();
  if (busy) return;
  ask({ do: event.shiftKey ? "redo" : "undo" });
});

// Handles and panels come before hinges.
let grabbed = -1;
stage.addEventListener("pointerdown", (event) => {
  if (!run) return;
  const at = pixelOf(event);
  grabbed = handleAt(at);
  const place = mode() === "grip" && !busy ? panelAt(at) : null;
  if (place) openGripMenu(place);
  const picked = mode() === "cells" && !busy;
  if (picked) askCell(at);
  if (grabbed < 0 && !place && !picked) return;
  event.stopImmediatePropagation();
  if (grabbed >= 0) stage.setPointerCapture(event.pointerId);
}, true);
stage.addEventListener("pointermove", (event) => { if (grabbed >= 0) { event.stopImmediatePropagation(); moveHandle(grabbed, toMm(pixelOf(event))); } }, true);
window.addEventListener("pointerup", () => { grabbed = -1; });
// The fields of a hinge describe the selected hinge.
stage.addEventListener("click", () => { if (mode() === "look") writeFields(); });
byId("hinge-number").addEventListener("change", writeFields);
const setDropping = (dropping) => document.body.classList.toggle("dropping", dropping);
document.addEventListener("dragover", (event) => { event.preventDefault(); setDropping(true); });
document.addEventListener("dragleave", (event) => { if (!event.relatedTarget) setDropping(false); });
document.addEventListener("drop", (event) => {
  event.preventDefault();
  setDropping(false);
  takeDrawing(event.dataTransfer.files[0]);
});

document.addEventListener("pointerdown", () => { byId("drop-says").hidden = true; });

connectControls();
document.documentElement.dataset.ready = "true";
