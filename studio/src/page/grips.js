// What holds and pulls the sheet: lists of fields, and a menu on the panel that is clicked.

const POSTURES = [["held-flat", "between plates"], ["mounted", "fastened to a board"], ["lying", "lies on a table"], ["hanging", "hangs"], ["free", "nothing"]];
const KINDS = [["clamp", "clamp"], ["pin", "pin"], ["roller-x", "roller along x"], ["roller-y", "roller along y"]];
const EDGES = ["bottom", "right", "top", "left"];

function writeGrips(box) {
  if (scene.posture)
    choiceField(box, "In its plane by", "posture.kind", POSTURES, (kind) => {
      scene.posture = kind === "hanging" ? { kind, down: [0, -1] } : { kind };
      sendScene();
    });
  scene.supports.forEach((support, i) => {
    const item = listItem(box, "supports", i, "Held");
    choiceField(item, "by a", `supports.${i}.kind`, KINDS, (kind) => {
      // Only a clamp holds the rotation, and an edge by a clip.
      if (kind !== "clamp") Object.assign(support, { clip: null, rotation_deg: 0 });
      set(`supports.${i}.kind`, kind);
      writeFields();
    });
    writePlace(item, `supports.${i}`);
  });
  scene.loads.forEach((load, i) => {
    const item = listItem(box, "loads", i, "Pulled");
    numberField(item, "Force x (N)", `loads.${i}.force.0`);
    numberField(item, "Force y (N)", `loads.${i}.force.1`);
    if (load.mass_g !== null) numberField(item, "Weight (g)", `loads.${i}.mass_g`);
    writePlace(item, `loads.${i}`);
  });
  scene.edge_loads.forEach((load, i) => {
    const item = listItem(box, "edge_loads", i, "Edge pulled");
    choiceField(item, "Edge", `edge_loads.${i}.edge`, EDGES.map((edge) => [edge, edge]));
    numberField(item, "Along x (N/mm)", `edge_loads.${i}.traction.0`);
    numberField(item, "Along y (N/mm)", `edge_loads.${i}.traction.1`);
  });
  const line = write(box, "div", undefined, "actions");
  const middle = scene.sheet.panels.map((count) => Math.floor(count / 2));
  button(line, "Hold", () => addGrip("supports", { panel: [middle[0], scene.sheet.panels[1] - 1], kind: "clamp", at: "top" }), "Hold a panel");
  button(line, "Pull", () => addGrip("loads", { panel: [middle[0], 0], at: "bottom", force: [0, -1] }), "Pull a panel");
  button(line, "Pull an edge", () => addGrip("edge_loads", { edge: "bottom", traction: [0, -0.01] }), "Pull all panels along an edge");
}

function listItem(box, list, i, text) {
  const item = write(box, "div", undefined, "item");
  const { panel } = scene[list][i];
  write(item, "b", panel ? `${text}: panel in ${placeOf(panel)} ` : `${text} `);
  button(item, "remove", () => { scene[list].splice(i, 1); letGo(); }, "Remove it");
  return item;
}

/** Sends the scene after something was removed: without loads there is no stroke. */
function letGo() {
  if (scene.loads.length + scene.edge_loads.length + scene.opening_couples.length === 0) scene.drive = null;
  sendScene();
  writeFields();
}

/** A column or a row: counted from 1 on the page, from 0 in the scene. */
function placeField(item, text, path) {
  const input = numberField(item, text, path, (at) => set(path, Math.max(0, Math.round(at) - 1)));
  Object.assign(input, { step: 1, min: 1, value: valueAt(path) + 1 });
  input.dataset.from = 1;
  input.parentNode.title = "Counted from 1, at the lower left";
}

/** The place of a panel in words. */
const placeOf = ([column, row]) => `column ${column + 1}, row ${row + 1}`;

/** Where a panel is held or pulled. */
function writePlace(item, path) {
  placeField(item, "Column", `${path}.panel.0`);
  placeField(item, "Row", `${path}.panel.1`);
  if (typeof valueAt(`${path}.at`) === "string")
    choiceField(item, "At", `${path}.at`, [["centroid", "its centroid"], ...EDGES.map((edge) => [edge, `its ${edge} edge`])], (at) => {
      const grip = valueAt(path);
      if (at === "centroid") grip.clip = null;
      set(`${path}.at`, at);
    });
  if (valueAt(`${path}.clip`) !== null) numberField(item, "Clip (mm)", `${path}.clip`);
}

const NOTHING = { hole: null, clip: null };
const COMPLETE = {
  supports: { ...NOTHING, displacement: [0, 0], rotation_deg: 0 },
  loads: { ...NOTHING, mass_g: null, force: [0, 0], couple: 0 },
  edge_loads: {},
};

function addGrip(list, grip) {
  scene[list].push({ ...structuredClone(COMPLETE[list]), ...grip });
  sendScene();
  writeFields();
}

/** The panel at a pixel, and which of its points is nearest: its centroid or the middle of an edge. */
function panelAt([px, py]) {
  const inside = (points) =>
    points.filter(([x, y], i) => {
      const [u, v] = points[(i + 1) % points.length];
      return y > py !== v > py && px < x + ((py - y) / (v - y)) * (u - x);
    }).length % 2 === 1;
  const k = boundariesDrawn.findIndex(inside);
  if (k < 0) return null;
  const corners = cornersDrawn[k];
  const points = { centroid: meanOf(boundariesDrawn[k]) };
  // A trimmed panel has no edges that a scene names.
  if (!run.panels.trimmed.some(([trimmed]) => trimmed === k))
    EDGES.forEach((edge, c) => { points[edge] = meanOf([corners[c], corners[(c + 1) % 4]]); });
  const distance = (name) => Math.hypot(points[name][0] - px, points[name][1] - py);
  const at = Object.keys(points).reduce((best, name) => (distance(name) < distance(best) ? name : best));
  return { panel: run.panels.places[k], at };
}

/** The menu of a panel, in the place of the mode's fields. */
function openGripMenu(place) {
  const menu = byId("grip-menu");
  menu.textContent = "";
  menu.hidden = !place;
  if (!place) return;
  const { panel, at } = place;
  write(menu, "p", `Panel in ${placeOf(panel)}, ${at === "centroid" ? "its centroid" : `its ${at} edge`}:`, "note");
  const line = write(menu, "div", undefined, "actions");
  const here = (grip) => grip.panel[0] === panel[0] && grip.panel[1] === panel[1];
  const act = (text, change) => button(line, text, () => { change(); openGripMenu(null); }, `${text}: ${placeOf(panel)}`);
  const held = (kind) => {
    scene.supports = scene.supports.filter((support) => !here(support));
    addGrip("supports", { panel, at, kind });
  };
  act("Clamp", () => held("clamp"));
  act("Pin", () => held("pin"));
  const outward = { bottom: [0, -1], right: [1, 0], top: [0, 1], left: [-1, 0], centroid: [0, -1] };
  act("Pull", () => addGrip("loads", { panel, at, force: outward[at] }));
  if (scene.posture?.kind === "hanging" && !scene.drive) act("Hang 100 g", () => addGrip("loads", { panel, at, mass_g: 100 }));
  if (scene.supports.some(here) || scene.loads.some(here))
    act("Let go", () => {
      scene.supports = scene.supports.filter((support) => !here(support));
      scene.loads = scene.loads.filter((load) => !here(load));
      letGo();
    });
  act("Cancel", () => {});
  line.firstChild.focus();
}
