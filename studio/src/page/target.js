// The target: its fields, and its handles on the sheet.

const TARGETS = { rectangle: "rectangle", circle: "circle", curve: "curve", svg: "drawing", polygon: "polygon", csv: "table of points" };
const targetKind = () => Object.keys(scene.target)[0];

/** Points along the sampled target (mm). */
function alongTarget(count) {
  const n = run.target.length / 2;
  return Array.from({ length: count }, (_, i) => {
    const at = Math.floor((i * n) / count);
    return [run.target[2 * at], run.target[2 * at + 1]].map((x) => Number(x.toPrecision(6)));
  });
}

const meanOf = (points) => [0, 1].map((c) => points.reduce((sum, p) => sum + p[c], 0) / points.length);

/** The present target as another kind. */
function targetAs(kind) {
  const points = alongTarget(200);
  const [low, high] = [Math.min, Math.max].map((most) => [0, 1].map((c) => most(...points.map((p) => p[c]))));
  const centre = [0, 1].map((c) => Number(((low[c] + high[c]) / 2).toPrecision(6)));
  const size = [0, 1].map((c) => Number((high[c] - low[c]).toPrecision(6)));
  if (kind === "circle") return { circle: { centre, radius: Number((Math.max(...size) / 2).toPrecision(6)) } };
  if (kind === "rectangle") return { rectangle: { centre, size, rotation_deg: 0 } };
  return { curve: { points: alongTarget(12) } };
}

function writeTarget(box) {
  const kind = targetKind();
  const kinds = Object.entries(TARGETS).filter(([key]) => ["rectangle", "circle", "curve", kind].includes(key));
  const select = choiceField(box, "Shape", "target", kinds, (chosen) => {
    scene.target = targetAs(chosen);
    sendScene();
    writeFields();
  });
  select.value = kind;
  select.disabled = !run;
  const target = scene.target[kind];
  if (target.centre) {
    numberField(box, "Centre x (mm)", `target.${kind}.centre.0`);
    numberField(box, "Centre y (mm)", `target.${kind}.centre.1`);
  }
  if (kind === "rectangle") {
    numberField(box, "Width (mm)", "target.rectangle.size.0");
    numberField(box, "Height (mm)", "target.rectangle.size.1");
  }
  if (kind === "circle") numberField(box, "Radius (mm)", "target.circle.radius");
  if (kind === "svg") numberField(box, "Height (mm)", "target.svg.height");
  if (kind === "rectangle" || kind === "svg") numberField(box, "Rotation (deg)", `target.${kind}.rotation_deg`);
  if (kind === "curve") {
    const line = write(box, "div", undefined, "actions");
    button(line, "More points", () => morePoints(2), "Twice as many points");
    button(line, "Fewer points", () => morePoints(0.5), "Half as many points");
    write(box, "p", `${target.points.length} points. Drag them, or Tab to one and move it with the arrows (Shift: by 10 mm).`, "note");
  }
  const label = write(box, "label", "Drawing or picture");
  label.title = "An SVG or DXF file with one closed outline, or a PNG or JPEG, which is traced";
  const file = document.createElement("input");
  Object.assign(file, { type: "file", accept: ".svg,.dxf,.png,.jpg,.jpeg", id: "drawing" });
  file.addEventListener("change", () => takeDrawing(file.files[0]));
  label.appendChild(file);
  write(box, "p", "Or drop one anywhere: an outline with its holes, which becomes a sheet of an even pattern.", "note");
  writeFitSliders(box);
}

function morePoints(factor) {
  const count = Math.round(scene.target.curve.points.length * factor);
  if (!run || count < 3 || count > 96) return;
  scene.target.curve.points = alongTarget(count);
  sendScene();
  writeFields();
}

const MOST_BYTES = 8e6;

/** Fits the sheet, or a new one while the form of a new sheet is shown, to the drawing in a file. */
async function takeDrawing(file) {
  if (!file) return;
  sayAtSheet("");
  if (busy) return sayAtSheet(`${file.name} was not taken: something else is under way. Pause it, or drop the file again later.`);
  if (file.size > MOST_BYTES) return sayAtSheet(`${file.name} has ${Math.round(file.size / 1e6)} MB: simplify the drawing to 8 MB at most`);
  dropped = { name: file.name, file: await inBase64(file) };
  sendDrawing();
}

/** Sends the drawing that was taken, for a new sheet while the form of one is shown. */
function sendDrawing() {
  byId("pieces").toggleAttribute("hidden", true);
  taken = true;
  if (byId("tools").hidden) begin(dropped);
  else ask({ do: "drawing", ...dropped });
}

/** Draws the pieces of a drawing: a click, or Enter, takes one. */
function writePieces(pieces) {
  const box = byId("pieces");
  box.textContent = "";
  const points = pieces.flatMap(([, points]) => points);
  const [low, high] = [Math.min, Math.max].map((most) => [0, 1].map((c) => points.map((p) => p[c]).reduce((a, b) => most(a, b))));
  box.setAttribute("viewBox", [low[0], -high[1], high[0] - low[0], high[1] - low[1]].join(" "));
  for (const [piece, outline] of pieces) {
    const d = `M${outline.map(([x, y]) => `${x} ${-y}`).join("L")}Z`;
    const path = draw(box, "path", { d, tabindex: 0, role: "button", "aria-label": `piece ${piece}` });
    const take = () => { dropped.piece = piece; refuse(""); sendDrawing(); };
    path.addEventListener("click", take);
    path.addEventListener("keydown", ({ key }) => { if (key === "Enter") take(); });
  }
  box.removeAttribute("hidden");
  if (byId("tools").hidden) byId("refusal").after(box);
  else stage.before(box);
  box.scrollIntoView({ block: "nearest" });
}

/** The drawing that was taken last, as it was sent. */
let dropped = null;

const inBase64 = (file) => new Promise((done) => {
  const reader = new FileReader();
  reader.addEventListener("load", () => done(reader.result.split(",")[1] ?? ""));
  reader.readAsDataURL(file);
});

/** Sliders of the fit to the drawing that was taken: the side of the panels, and the line at which a picture is traced. */
function writeFitSliders(box) {
  if (!dropped || fit.side === undefined) return;
  const slider = (text, title, key, range, value, move) => {
    const label = Object.assign(write(box, "label", text(value)), { title });
    const input = Object.assign(document.createElement("input"), { type: "range", ...range, id: `fit-${key}` });
    input.value = value;
    input.addEventListener("input", () => { label.firstChild.textContent = text(input.valueAsNumber); move(input.valueAsNumber); });
    input.addEventListener("change", () => {
      dropped[key] = input.valueAsNumber;
      sendDrawing();
    });
    label.appendChild(input);
  };
  const { smallest, side, threshold } = fit;
  slider((mm) => `Side of the panels: ${shown(mm, 3)} mm`, "Larger panels are fewer, and show less of the drawing", "panel_side", { min: smallest, max: 3 * smallest, step: smallest / 50 }, side, (panel_side) => ask({ do: "crop", panel_side }));
  if (threshold !== null) slider((part) => `Traced at ${Math.round(100 * part)} % of the largest difference`, "The outline of the picture: from the colour of its border to the most different one", "threshold", { min: 0.02, max: 0.98, step: 0.01 }, threshold, () => {});
}

/** Takes out the panel at a pixel of the opened sheet, or adds one there; first the sheet is opened. */
function askCell(at) {
  if (shownNow.state < stateCount - 1) show({ state: stateCount - 1 });
  else ask({ do: "cell", at: toMm(at) });
  centreBefore = centreOf(scene.target);
}

/** Where the target was when a panel was asked for. */
let centreBefore = null;
const centreOf = (target) => Object.values(target)[0].centre;

/** Moves the view with the target, so that the sheet stays under the pointer when its corner is another. */
function keepInView(target) {
  const centre = centreOf(target);
  if (centreBefore && centre) {
    view.x += centre[0] - centreBefore[0];
    view.y += centre[1] - centreBefore[1];
    show({});
  }
  centreBefore = null;
}

/** The panels that a side under the slider gives, over the target, and how much of it they show. */
let crop = null;
overlays.push(() => {
  for (const panel of crop?.panels ?? []) draw(marks, "path", { d: outlinePath(panel), fill: "none", stroke: TEAL, "stroke-width": 1.2 });
});

/** Whether a drawing was taken of which nothing is known yet. */
let taken = false;

/** Says something about a drawing where it was dropped. */
function sayAtSheet(message) {
  if (byId("tools").hidden) refuseNew(message);
  byId("drop-says").hidden = !message;
  byId("drop-says").textContent = message;
}

/** The handles of the target: where each is (mm), and what moving it there does. */
function handles() {
  const kind = targetKind();
  const target = scene.target[kind];
  const put = (object, key) => (at) => { object[key] = at; };
  if (kind === "curve" || kind === "polygon") {
    const name = kind === "curve" ? "points" : "vertices";
    const points = target[name];
    if (points.length > 96) return [];
    const centre = meanOf(points);
    const all = { at: centre, centre: true, move: (to) => { target[name] = points.map((p) => [p[0] + to[0] - centre[0], p[1] + to[1] - centre[1]]); } };
    return [all, ...points.map((at, i) => ({ at, move: put(points, i) }))];
  }
  if (!target.centre) return [];
  const [x, y] = target.centre;
  const list = [{ at: target.centre, centre: true, move: put(target, "centre") }];
  if (kind === "circle") list.push({ at: [x + target.radius, y], move: (to) => { target.radius = Math.max(1, Math.hypot(to[0] - x, to[1] - y)); } });
  const angle = (target.rotation_deg ?? 0) / DEG;
  const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
  const place = ([a, b]) => [x + cos * a - sin * b, y + sin * a + cos * b];
  if (kind === "svg" && target.height) {
    const move = (to) => { target.height = Math.max(1, 2 * Math.abs(cos * (to[1] - y) - sin * (to[0] - x))); };
    list.push({ at: place([0, target.height / 2]), move });
  }
  if (kind === "rectangle") {
    const [w, h] = target.size;
    list.push({
      at: place([w / 2, h / 2]),
      move: (to) => {
        const [dx, dy] = [to[0] - x, to[1] - y];
        target.size = [Math.max(1, 2 * Math.abs(cos * dx + sin * dy)), Math.max(1, 2 * Math.abs(cos * dy - sin * dx))];
      },
    });
    list.push({ at: place([w / 2, 0]), move: (to) => { target.rotation_deg = Math.atan2(to[1] - y, to[0] - x) * DEG; } });
  }
  return list;
}

const toMm = ([px, py]) => [view.x + (px - view.width / 2) / view.scale, view.y - (py - view.height / 2) / view.scale];
const short = (x) => Number(x.toFixed(2));

/** Moves a handle to a place (mm). */
function moveHandle(i, to) {
  handles()[i].move(to.map(short));
  for (const key of ["radius", "height", "rotation_deg"]) {
    const target = scene.target[targetKind()];
    if (target[key] !== undefined) target[key] = short(target[key]);
  }
  const { target } = scene;
  if (target.rectangle) target.rectangle.size = target.rectangle.size.map(short);
  sendScene();
  updateFields();
  drawHandles();
}

function drawHandles() {
  const focused = document.activeElement?.dataset?.handle;
  marks.querySelectorAll(".handle").forEach((handle) => handle.remove());
  if (mode() !== "target" || !scene) return;
  handles().forEach(({ at, centre }, i) => {
    const [cx, cy] = toPixels(at);
    const handle = draw(marks, "circle", { cx, cy, r: centre ? 7 : 6, class: centre ? "handle centre" : "handle", tabindex: 0, role: "button" });
    handle.dataset.handle = i;
    handle.setAttribute("aria-label", centre ? "centre of the target" : `handle ${i} of the target`);
    if (String(i) === focused) handle.focus();
  });
}
overlays.push(drawHandles);

/** The handle at a pixel of the stage; -1 if there is none. */
function handleAt([px, py]) {
  if (mode() !== "target" || busy) return -1;
  let [nearest, least] = [-1, 16];
  handles().forEach(({ at }, i) => {
    const [x, y] = toPixels(at);
    const distance = Math.hypot(x - px, y - py);
    if (distance < least) [nearest, least] = [i, distance];
  });
  return nearest;
}

marks.addEventListener("keydown", (event) => {
  const i = event.target.dataset?.handle;
  const ways = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
  if (i === undefined || !(event.key in ways) || busy) return;
  event.preventDefault();
  event.stopPropagation();
  const step = event.shiftKey ? 10 : 1;
  const { at } = handles()[i];
  moveHandle(Number(i), [0, 1].map((c) => at[c] + step * ways[event.key][c]));
});
