// The fields of the scene: numbers, choices and lists, each with its key.

/** The keys of the scene that is shown. */
let scene = null;

const keysOf = (path) => path.split(".").map((part) => (/^\d+$/.test(part) ? Number(part) : part));

function valueAt(path) {
  return keysOf(path).reduce((value, key) => value?.[key], scene);
}

/** Gives a key another value, and sends the scene. */
function set(path, value) {
  const keys = keysOf(path);
  const last = keys.pop();
  const parent = keys.reduce((object, key) => (object[key] ??= {}), scene);
  parent[last] = value;
  sendScene();
}

/** A value as a field shows it: a number to six digits. */
const inField = (value) => (typeof value === "number" ? String(Number(value.toPrecision(6))) : (value ?? ""));

/** The key of a path as the command line writes it: supports[0].clip. */
const named = (path) => path.replace(/\.(\d+)/g, "[$1]");

/** What a key means, with its unit and its range. */
const meaningOf = (path) => shop.keys[path.replace(/\.\d+/g, "")] ?? "";

/** A label with an input element for a key. */
function field(parent, text, path, input) {
  const label = write(parent, "label", text);
  label.title = meaningOf(path);
  input.dataset.key = named(path).replace(/\[\d+\]$/, "");
  input.dataset.path = path;
  label.appendChild(input);
  return input;
}

function numberField(parent, text, path, changed = (value) => set(path, value), when = "input") {
  const input = document.createElement("input");
  Object.assign(input, { type: "number", step: "any", value: inField(valueAt(path)) });
  input.addEventListener(when, () => { if (input.value !== "" && Number.isFinite(input.valueAsNumber)) changed(input.valueAsNumber); });
  return field(parent, text, path, input);
}

function textField(parent, text, path) {
  const input = document.createElement("input");
  input.value = valueAt(path) ?? "";
  input.addEventListener("change", () => set(path, input.value));
  return field(parent, text, path, input);
}

function choiceField(parent, text, path, choices, changed = (value) => set(path, value)) {
  const select = document.createElement("select");
  for (const [value, name] of choices) write(select, "option", name).value = value;
  select.value = valueAt(path);
  select.addEventListener("change", () => changed(select.value));
  return field(parent, text, path, select);
}

/** A number with a slider below it. */
function sliderField(parent, text, path, [low, high], changed) {
  const number = numberField(parent, text, path, changed);
  const slider = document.createElement("input");
  Object.assign(slider, { type: "range", min: low, max: high, step: (high - low) / 500, value: valueAt(path) ?? low });
  slider.setAttribute("aria-label", text);
  slider.title = meaningOf(path);
  slider.addEventListener("input", () => {
    number.value = Number(slider.valueAsNumber.toPrecision(5));
    number.dispatchEvent(new Event("input"));
  });
  number.addEventListener("input", () => { slider.value = number.value; });
  parent.appendChild(slider);
  return number;
}

function button(parent, text, pressed, title) {
  const element = write(parent, "button", text);
  Object.assign(element, { type: "button", title });
  element.addEventListener("click", pressed);
  return element;
}

/** A choice of the scene between yes and no, which decides a key. */
function checkField(parent, text, path, checked, changed) {
  const check = document.createElement("input");
  Object.assign(check, { type: "checkbox", checked });
  check.addEventListener("change", () => {
    changed(check.checked);
    sendScene();
    writeFields();
  });
  const label = write(parent, "label", text);
  label.title = meaningOf(path);
  label.appendChild(check);
}

/** The names of the folded groups that are open. */
const unfolded = new Set();

/** A folded group of fields within another. */
function folded(parent, name) {
  const box = write(parent, "details", undefined, "folded");
  write(box, "summary", name);
  box.open = unfolded.has(name);
  box.addEventListener("toggle", () => unfolded[box.open ? "add" : "delete"](name));
  return box;
}

/** The groups of fields: what writes each into its part of the page. */
const groups = {
  load(box) {
    if (scene.drive) sliderField(box, "Stroke (mm)", "drive.stroke", [0, Math.max(1, 2 * Math.abs(scene.drive.stroke))]);
    const loaded = scene.loads.length + scene.edge_loads.length + scene.opening_couples.length > 0;
    if (loaded && !scene.drive) loadSlider(box);
    if (!loaded && scene.level !== "pin") write(box, "p", "Nothing pulls: choose \u201cholds and pulls panels\u201d and click one.", "note");
    if (scene.pin) sliderField(box, "Opening (deg)", "pin.opening_deg", [0, 90]);
    if (!loaded) return;
    checkField(box, "the stroke is prescribed", "drive", Boolean(scene.drive), (checked) => {
      scene.drive = checked ? { stroke: Number(strokeNow().toPrecision(4)) } : null;
    });
  },

  ligament(box) {
    const [low, high] = scene.ligament.range;
    const inside = [low + 1e-3 * (high - low), high - 1e-3 * (high - low)];
    sliderField(box, "All ligaments (mm)", "ligament.start", inside, (width) => {
      scene.start.w_lig = null;
      set("ligament.start", width);
      const ofHinge = box.querySelector("[data-path^='start.']");
      if (ofHinge) ofHinge.parentNode.nextSibling.value = ofHinge.value = inField(width);
    });
    const more = folded(box, "Limits and single ligaments");
    if (run) {
      const h = shownNow.hinge;
      const text = `Hinge ${h} (mm)`;
      const widths = () => scene.start.w_lig ?? Array(hingeCount).fill(scene.ligament.start);
      const number = sliderField(more, text, `start.w_lig.${h}`, inside, (width) => {
        scene.start.w_lig = widths();
        set(`start.w_lig.${h}`, width);
      });
      number.parentNode.nextSibling.value = number.value = inField(widths()[h]);
    }
    numberField(more, "Narrowest (mm)", "ligament.range.0");
    numberField(more, "Widest (mm)", "ligament.range.1");
  },

  sheet(box) {
    textField(box, "Title", "title");
    if (scene.sheet.size) {
      numberField(box, "Width (mm)", "sheet.size.0");
      numberField(box, "Height (mm)", "sheet.size.1");
    }
    numberField(box, "Columns", "sheet.panels.0", (count) => askPanels(0, count), "change");
    numberField(box, "Rows", "sheet.panels.1", (count) => askPanels(1, count), "change");
    const most = scene.sheet.size?.map((side) => Math.floor(side / (shop.panel * scene.process.r_win)));
    if (most) button(box, `As many as the material allows: ${most.join(" \u00d7 ")}`, () => ask({ do: "panels", panels: most }), "More are narrower than the windows of their hinges");
    if (scene.thickness) numberField(box, "Thickness (mm)", "thickness", setThickness, "change");
    numberField(box, "Width of slits (mm)", "process.slit_width");
    numberField(box, "Kerf (mm)", "cutting.kerf", setKerf);
    if (scene.process.hole_diameter) numberField(box, "Hole diameter (mm)", "process.hole_diameter");
    else numberField(box, "Hole over ligament", "process.fillet_ratio");
    if (["pin", "linear"].includes(scene.level)) numberField(box, "Window r_win (mm)", "process.r_win");
    const window = inField(scene.process.r_win);
    write(box, "p", `Material: ${scene.material.split("/").pop()}. Windows of the hinges: r_win = ${window} mm; panels are at least ${shop.panel} r_win wide.`, "note");
  },

  grips: (box) => writeGrips(box),
  target: (box) => writeTarget(box),

  search(box) {
    writeLevels(box);
    choiceField(box, "Method", "optimiser.method", [["lbfgs", "L-BFGS"], ["adam", "Adam"]]);
    numberField(box, "Steps", "optimiser.steps", (steps) => set("optimiser.steps", Math.max(1, Math.round(steps))));
    const weights = folded(box, "Weights");
    for (const [text, key] of [["Damage", "damage"], ["Compression", "compression"], ["Panel shape", "panel_shape"], ["Domain", "domain"]])
      numberField(weights, text, `objective.${key}`);
    write(weights, "p", "Relative to the outline's distance to the target; docs/KEYS.md describes them.", "note");
  },
};

/** The levels, with what each costs and how far it is from the finest if that was measured. */
function writeLevels(box) {
  const says = ({ search, difference }) =>
    [search !== null && `${shown(search, 2)} s`, difference && `${shown(difference.corners[1], 2)} mm from the finest`].filter(Boolean).join(", ");
  const costs = Object.fromEntries(levelCosts.map((cost) => [cost.level, says(cost)]));
  const choices = shop.levels.map(([name]) => [name, costs[name] ? `${name}: ${costs[name]}` : name]);
  choiceField(box, "Level", "level", choices, (level) => ask({ do: "level", level }));
  const [, hinges] = shop.levels.find(([name]) => name === scene.level) ?? [];
  write(box, "p", `Hinges: ${hinges ?? scene.level}.`, "note");
  const line = write(box, "div", undefined, "actions");
  button(line, "Compare levels", () => compareLevels(null), "Time of a search and distance of the corners from the finest level, for this sheet");
  const within = document.createElement("input");
  Object.assign(within, { type: "number", min: 0, step: "any", value: withinShown, title: "Corners of panels this near to those of the finest level (mm)" });
  within.setAttribute("aria-label", within.title);
  button(line, "Cheapest within", () => compareLevels(within.valueAsNumber), "Chooses the cheapest level that is near enough to the finest one for this sheet");
  line.append(within, " mm");
}

/** The distance from the finest level (mm) in the control, and the one for which a level is to be chosen. */
let withinShown = 0.5;
let wanted = null;

function compareLevels(within) {
  wanted = within > 0 ? within : null;
  withinShown = wanted ?? withinShown;
  ask({ do: "levels" });
}

/** Takes the cheapest level that is near enough, if one is wanted. The finest has no difference. */
function chooseLevel() {
  const near = ({ failure, difference }) => !failure && (difference?.corners[1] ?? 0) <= wanted;
  const cheapest = wanted && levelCosts.find(near);
  if (cheapest) ask({ do: "level", level: cheapest.level });
  wanted = null;
}

/** Loads in proportion to those at the beginning of a drag. */
function loadSlider(box) {
  const label = write(box, "label", "All loads, times");
  label.title = meaningOf("loads");
  const slider = document.createElement("input");
  Object.assign(slider, { type: "range", min: 0.05, max: 2, step: 0.05, value: 1 });
  let from = null;
  slider.addEventListener("input", () => {
    from ??= structuredClone([scene.loads, scene.edge_loads, scene.opening_couples]);
    const f = slider.valueAsNumber;
    [scene.loads, scene.edge_loads, scene.opening_couples] = structuredClone(from);
    scene.loads.forEach((load) => { load.force = load.force.map((x) => f * x); load.couple *= f; if (load.mass_g) load.mass_g *= f; });
    scene.edge_loads.forEach((load) => { load.traction = load.traction.map((x) => f * x); });
    scene.opening_couples.forEach((load) => { load.couple *= f; });
    sendScene();
  });
  slider.addEventListener("change", () => { [from, slider.value] = [null, 1]; updateFields(); });
  label.appendChild(slider);
}

/** The stroke of the state that is shown last, or a tenth of the sheet. */
function strokeNow() {
  const reached = states?.curve?.[states.curve.length - 1];
  return reached ? reached[0] : 0.1 * Math.max(...(scene.sheet.size ?? [100]));
}

/** Another thickness: ligaments, holes, windows and slots in proportion, as the weights require; a slit of one pass is as wide as the tool. */
function setThickness(thickness) {
  if (!(thickness > 0)) return;
  const factor = thickness / scene.thickness;
  const scaled = (x) => Number((factor * x).toPrecision(6));
  const { ligament, process, start } = scene;
  ligament.start = scaled(ligament.start);
  ligament.range = ligament.range.map(scaled);
  start.w_lig = start.w_lig?.map((width) => factor * width) ?? null;
  process.r_win = scaled(process.r_win);
  if (process.slit_width !== scene.cutting.kerf) process.slit_width = scaled(process.slit_width);
  if (process.hole_diameter) process.hole_diameter = scaled(process.hole_diameter);
  set("thickness", thickness);
  updateFields();
}

/** Another tool: slits of one pass are as wide. */
function setKerf(kerf) {
  const { process, cutting } = scene;
  if (process.slit_width === cutting.kerf) process.slit_width = kerf;
  set("cutting.kerf", kerf);
  updateFields();
}

/** Asks for another number of columns or rows. */
function askPanels(axis, count) {
  const panels = [...scene.sheet.panels];
  panels[axis] = Math.max(0, Math.round(count));
  ask({ do: "panels", panels });
}

/** Writes all groups; the field that has the focus keeps it. */
function writeFields() {
  if (!scene) return;
  const focused = document.activeElement?.dataset?.path;
  for (const box of document.querySelectorAll("#studio [data-fields]")) {
    while (box.lastChild.tagName !== "SUMMARY") box.lastChild.remove();
    groups[box.dataset.fields](box);
  }
  if (focused) document.querySelector(`#studio [data-path="${focused}"]`)?.focus();
}

/** Brings the fields up to date without writing them again. */
function updateFields() {
  for (const input of document.querySelectorAll("#studio [data-path]")) {
    const value = valueAt(input.dataset.path);
    if (input !== document.activeElement && ["number", "string"].includes(typeof value)) input.value = inField(input.dataset.from ? value + 1 : value);
  }
}
