// The sheet in one state: panels and hinges on a canvas; target, supports, loads and reactions as SVG above it.

const stage = byId("stage");
const canvas = byId("panels");
const marks = byId("marks");

/** Position of a point of a panel in a state (mm). */
function moved(state, k, x, y) {
  const at = 3 * (state * panelCount + k);
  const [ux, uy, phi] = [states.motions[at], states.motions[at + 1], states.motions[at + 2]];
  const [cx, cy] = [run.panels.references[2 * k], run.panels.references[2 * k + 1]];
  const [cos, sin] = [Math.cos(phi), Math.sin(phi)];
  return [cx + ux + cos * (x - cx) - sin * (y - cy), cy + uy + sin * (x - cx) + cos * (y - cy)];
}

function corner(state, k, c) {
  const at = 2 * (4 * k + c);
  return moved(state, k, run.panels.corners[at], run.panels.corners[at + 1]);
}

/** The boundary of a panel in a state (mm). */
function boundary(state, k) {
  return Array.from({ length: boundaries[k].length / 2 }, (_, i) => moved(state, k, boundaries[k][2 * i], boundaries[k][2 * i + 1]));
}

function reference(state, k) {
  const at = 3 * (state * panelCount + k);
  return [run.panels.references[2 * k] + states.motions[at], run.panels.references[2 * k + 1] + states.motions[at + 1]];
}

/** The lower left and the upper right corner of the box around points. */
function bounds(points) {
  return [Math.min, Math.max].map((most) => [0, 1].map((c) => most(...points.map((p) => p[c]))));
}

/** The rectangle that holds the sheet in every state, its outline and the target (mm). */
let extent = null;

function measureExtent() {
  const box = { x0: Infinity, y0: Infinity, x1: -Infinity, y1: -Infinity };
  const add = ([x, y]) => {
    box.x0 = Math.min(box.x0, x);
    box.y0 = Math.min(box.y0, y);
    box.x1 = Math.max(box.x1, x);
    box.y1 = Math.max(box.y1, y);
  };
  for (let i = 0; i < stateCount; i++)
    for (let k = 0; k < panelCount; k++) boundary(i, k).forEach(add);
  for (let i = 0; i < run.target.length; i += 2) add([run.target[i], run.target[i + 1]]);
  if (run.carries_load) run.outlines.flat().forEach(add);
  extent = box;
}

/** The view: pixels of a point = origin + scale (x - centre), y downwards; `zoom` 1 shows the whole sheet. */
const view = { width: 0, height: 0, scale: 1, x: 0, y: 0, zoom: 1 };

/** Room around the sheet for arrows and labels (px). */
function margin() {
  const { loads, supports } = run.actuation;
  const widest = loads.some((load) => load.label) ? 150 : loads.length + supports.length ? 80 : 25;
  return Math.min(widest, 0.14 * view.width);
}

function fitView() {
  view.x = (extent.x0 + extent.x1) / 2;
  view.y = (extent.y0 + extent.y1) / 2;
  view.zoom = 1;
}

function resizeStage(width, height, ratio) {
  Object.assign(view, { width, height });
  stage.style.height = `${height}px`;
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  marks.setAttribute("viewBox", `0 0 ${width} ${height}`);
  canvas.getContext("2d").setTransform(ratio, 0, 0, ratio, 0, 0);
}

function toPixels([x, y]) {
  return [view.width / 2 + view.scale * (x - view.x), view.height / 2 - view.scale * (y - view.y)];
}

function updateScale() {
  const [w, h] = [view.width - 2 * margin(), view.height - 2 * Math.min(margin(), 60)];
  view.scale = view.zoom * Math.min(w / (extent.x1 - extent.x0), h / (extent.y1 - extent.y0));
}

/** Pixel positions of the corners of every panel's cell and of its boundary in the state drawn last. */
let cornersDrawn = [];
let boundariesDrawn = [];

function hingePixel(h) {
  const [a, atA, b, atB] = run.hinges.sites[h];
  const [p, q] = [cornersDrawn[a][atA], cornersDrawn[b][atB]];
  return [(p[0] + q[0]) / 2, (p[1] + q[1]) / 2];
}

/** The hinge next to a pixel, within 24 px; -1 if there is none. */
function hingeAt(x, y) {
  let [nearest, least] = [-1, 24];
  for (let h = 0; h < hingeCount; h++) {
    const [px, py] = hingePixel(h);
    const distance = Math.hypot(px - x, py - y);
    if (distance < least) [nearest, least] = [h, distance];
  }
  return nearest;
}

function drawSheet(state, quantity, selected) {
  updateScale();
  const pen = canvas.getContext("2d");
  const { ground, ink } = canvasColours();
  pen.fillStyle = rgb(ground);
  pen.fillRect(0, 0, view.width, view.height);
  cornersDrawn = Array.from({ length: panelCount }, (_, k) => [0, 1, 2, 3].map((c) => toPixels(corner(state, k, c))));
  boundariesDrawn = boundaries.map((_, k) => boundary(state, k).map(toPixels));
  const colour = colours(quantity, state);
  const edge = Math.sqrt(((extent.x1 - extent.x0) * (extent.y1 - extent.y0)) / panelCount) * view.scale;
  pen.lineJoin = "round";
  pen.strokeStyle = ink;
  pen.lineWidth = Math.min(1.2, edge / 25);
  boundariesDrawn.forEach((points, k) => {
    pen.beginPath();
    points.forEach(([x, y], c) => (c === 0 ? pen.moveTo(x, y) : pen.lineTo(x, y)));
    pen.closePath();
    pen.fillStyle = colour.panels[k];
    pen.fill();
    pen.stroke();
  });
  for (let h = 0; h < hingeCount; h++) {
    const [a, atA, b, atB] = run.hinges.sites[h];
    pen.fillStyle = colour.hinges[h];
    sector(pen, cornersDrawn[a], atA);
    sector(pen, cornersDrawn[b], atB);
  }
  drawMarks(state, selected);
}

/** The part of a hinge's window on a panel, about a corner of the panel. */
function sector(pen, corners, at) {
  const [x, y] = corners[at];
  const [next, previous] = [corners[(at + 1) % 4], corners[(at + 3) % 4]];
  const [toNext, toPrevious] = [next, previous].map((p) => Math.hypot(p[0] - x, p[1] - y));
  const window = Math.max(run.hinges.r_win * view.scale, 3);
  pen.beginPath();
  pen.moveTo(x, y);
  pen.arc(x, y, Math.min(window, 0.45 * toNext, 0.45 * toPrevious), Math.atan2(next[1] - y, next[0] - x), Math.atan2(previous[1] - y, previous[0] - x), true);
  pen.fill();
}

function outlinePath(points) {
  return points.map((p, i) => `${i ? "L" : "M"}${toPixels(p).map((v) => v.toFixed(1)).join(" ")}`).join("") + "Z";
}

function drawMarks(state, selected) {
  marks.textContent = "";
  if (run.carries_load)
    draw(marks, "path", { d: run.outlines.map(outlinePath).join(""), fill: "none", stroke: TICK, "stroke-dasharray": "3 3" });
  const pairs = (list) => Array.from({ length: list.length / 2 }, (_, i) => [list[2 * i], list[2 * i + 1]]);
  const target = pairs(run.target);
  const targets = [target, ...run.holes.map(pairs)];
  draw(marks, "path", { d: targets.map(outlinePath).join(""), fill: "none", stroke: ACCENT, "stroke-width": 1.8, "stroke-dasharray": "9 6" });
  const labels = [];
  const obstacles = [];
  if (state === stateCount - 1) drawMissed(target, labels);
  drawSupports(state, obstacles);
  drawLoads(state, labels, obstacles);
  if (selected >= 0) {
    const [x, y] = hingePixel(selected);
    draw(marks, "circle", { cx: x, cy: y, r: 12, fill: "none", stroke: PAPER, "stroke-width": 5, "stroke-opacity": 0.8 });
    draw(marks, "circle", { cx: x, cy: y, r: 12, fill: "none", stroke: INK, "stroke-width": 2 });
    obstacles.push({ x0: x - 12, x1: x + 12, y0: y - 12, y1: y + 12 });
    labels.push({ text: `hinge ${selected}`, x, y: y - 12, dx: 0.3, dy: -1, colour: INK });
  }
  obstacles.push(drawScaleBar());
  placeLabels(marks, labels, obstacles, view.width, view.height);
  overlays.forEach((drawOverlay) => drawOverlay());
}

/** Distance of the target from the opened outline, over the longer side of the flat sheet, from which its places are marked. */
const MISSED = 0.02;
/** The same from panels whose outline is not known, over the side of a square with the area of a panel: the gaps between panels are as wide. */
const GAP = 0.6;

/** Distance of the target from the sheet from which its places are marked (mm). */
function missedFrom() {
  const area = run.outlines.flatMap((line) => line.map(([x, y], i) => x * line[(i + 1) % line.length][1] - y * line[(i + 1) % line.length][0]));
  const panel = Math.sqrt(Math.abs(area.reduce((sum, part) => sum + part, 0)) / 2 / panelCount);
  const [low, high] = bounds(run.outlines.flat());
  return Math.max(MISSED * Math.max(high[0] - low[0], high[1] - low[1]), run.panels.outline.length ? 0 : GAP * panel);
}
/** Most places of the target whose distances are written. */
const MOST_PLACES = 4;

/** The lines as they are drawn (px) from which the target is so far: through the corners whose distances the figure has, or around all panels. */
function outlinesDrawn() {
  const corners = run.panels.outline.map(([k, c]) => cornersDrawn[k][c]);
  return corners.length ? [corners] : boundariesDrawn;
}

/** Distance of a point from a closed line. */
function distanceTo(line, [x, y]) {
  return line.reduce((least, [ax, ay], i) => {
    const [bx, by] = line[(i + 1) % line.length];
    const [dx, dy] = [bx - ax, by - ay];
    const along = Math.min(Math.max(((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy || 1), 0), 1);
    return Math.min(least, Math.hypot(x - ax - along * dx, y - ay - along * dy));
  }, Infinity);
}

/** Marks the stretches of the target that the sheet does not reach, with the largest distances. */
function drawMissed(target, labels) {
  const outlines = outlinesDrawn();
  const stride = Math.ceil(target.length / 300);
  const least = missedFrom() * view.scale;
  const stretches = [];
  let stretch = null;
  for (let i = 0; i < target.length; i += stride) {
    const at = toPixels(target[i]);
    const distance = Math.min(...outlines.map((outline) => distanceTo(outline, at)));
    if (distance < least) { stretch = null; continue; }
    if (!stretch) stretches.push((stretch = { points: [], distance: 0 }));
    stretch.points.push(at);
    if (distance > stretch.distance) Object.assign(stretch, { distance, at });
  }
  for (const { points } of stretches) draw(marks, "path", { d: path(points, (x) => x, (y) => y), class: "missed" });
  stretches.sort((one, other) => other.distance - one.distance);
  for (const { at: [x, y], distance } of stretches.slice(0, MOST_PLACES))
    labels.push({ text: `${shown(distance / view.scale, 2)} mm`, x, y, dx: x - view.width / 2, dy: y - view.height / 2, colour: "var(--error)" });
}

/** What other scripts draw above the sheet. */
const overlays = [];

/** The symbols of the supports, those that roll with their rails. */
function drawSupports(state, obstacles) {
  for (const { panel, symbol, rail } of run.actuation.supports) {
    const [x, y] = toPixels(reference(state, panel));
    if (rail) {
      const [dx, dy] = rail.map((part) => 14 * part);
      draw(marks, "line", { x1: x - dx, y1: y + dy, x2: x + dx, y2: y - dy, stroke: INK, "stroke-width": 2 });
    }
    const corners = symbol.map(([a, b]) => `${(x + 7 * a).toFixed(1)} ${(y - 7 * b).toFixed(1)}`);
    draw(marks, "path", { d: `M${corners.join("L")}Z`, fill: INK, stroke: PAPER, "stroke-width": 1.5 });
    obstacles.push({ x0: x - 9, x1: x + 9, y0: y - 9, y1: y + 9 });
  }
}

/** Forces below this fraction of the largest one are rounding, and are not drawn. */
const NEGLIGIBLE = 1e-6;

/** Loads, then reactions in a state: on panels, with their total, and the radius of a couple on a single panel. */
function forcesOnSheet(state) {
  const zeta = states.load_factor[state];
  const scaled = (load) => load.map((f) => zeta * f);
  const loads = run.actuation.loads.map((load) => ({
    name: load.name, label: load.label, colour: ACCENT, radius: load.place && 26,
    panels: load.on_panels.map(([panel, full]) => [panel, scaled(full)]), total: scaled(load.total),
  }));
  const reactions = run.actuation.supports.map(({ name, panel }, i) => {
    const at = 3 * (state * run.actuation.supports.length + i);
    const force = [0, 1, 2].map((d) => states.reactions[at + d]);
    return { name, colour: TEAL, radius: 20, panels: [[panel, force]], total: force };
  });
  return [...loads, ...reactions];
}

/** The largest force and couple of the path. */
let largest = { force: 0, couple: 0 };

/** The force and the couple that no larger one makes rounding: each of the two acts with the size of the sheet as lever. */
let noticeable = largest;

whenTaken.push(() => {
  let [force, couple] = [0, 0];
  for (let i = 0; i < stateCount; i++)
    for (const { panels } of forcesOnSheet(i))
      for (const [, [x, y, m]] of panels) [force, couple] = [Math.max(force, Math.hypot(x, y)), Math.max(couple, Math.abs(m))];
  const [low, high] = bounds(run.outlines.flat());
  const size = Math.hypot(high[0] - low[0], high[1] - low[1]);
  largest = { force, couple };
  noticeable = { force: NEGLIGIBLE * Math.max(force, couple / size), couple: NEGLIGIBLE * Math.max(couple, force * size) };
});

/** Arrows on the panels; of equal loads on several panels the first has a label, unless their total is shown. */
function drawLoads(state, labels, obstacles) {
  for (const { label, colour, radius, panels, total } of forcesOnSheet(state)) {
    const ends = [];
    const labelled = new Set();
    const add = (value, text, end) => {
      if (!labelled.has(value)) labels.push({ text, colour, ...end });
      labelled.add(value);
    };
    for (const [panel, [fx, fy, couple]] of panels) {
      const at = toPixels(reference(state, panel));
      const force = Math.hypot(fx, fy);
      if (force > noticeable.force) {
        ends.push(drawArrow(at, [fx, fy], colour, obstacles, radius ? 62 : 26));
        if (!label) add(`${fx} ${fy}`, `${shown(force)} N`, ends[ends.length - 1]);
      }
      if (Math.abs(couple) > noticeable.couple) {
        const r = radius || coupleRadius(panel);
        drawCouple(at, couple, colour, r);
        obstacles.push({ x0: at[0] - r - 3, x1: at[0] + r + 3, y0: at[1] - r - 3, y1: at[1] + r + 3 });
        add(couple, `${shown(Math.abs(couple))} N mm`, { x: at[0], y: at[1] + r, dx: 0, dy: 1 });
      }
    }
    const middle = ends[Math.floor(ends.length / 2)];
    if (label && middle) labels.push({ text: `${label} ${shown(Math.hypot(total[0], total[1]))} N`, colour, ...middle });
  }
}

/** The radius of a curved arrow that fits on a panel (px). */
function coupleRadius(panel) {
  const corners = cornersDrawn[panel];
  const edge = Math.hypot(corners[2][0] - corners[0][0], corners[2][1] - corners[0][1]) / Math.SQRT2;
  return Math.max(5, Math.min(16, 0.25 * edge));
}

/** Draws an arrow along a force; its length grows with the force. Returns its tip and direction. */
function drawArrow([x, y], force, colour, obstacles, longest) {
  const size = Math.hypot(...force);
  const [dx, dy] = [force[0] / size, -force[1] / size];
  const length = 12 + (longest - 12) * Math.min(size / largest.force, 1);
  const tip = [x + length * dx, y + length * dy];
  const neck = [tip[0] - 9 * dx, tip[1] - 9 * dy];
  const halo = { x1: x, y1: y, x2: neck[0], y2: neck[1], "stroke-linecap": "round" };
  draw(marks, "line", { ...halo, stroke: PAPER, "stroke-width": 5, "stroke-opacity": 0.7 });
  draw(marks, "line", { ...halo, stroke: colour, "stroke-width": 2.5 });
  draw(marks, "path", { d: `M${tip}L${neck[0] - 5 * dy} ${neck[1] + 5 * dx}L${neck[0] + 5 * dy} ${neck[1] - 5 * dx}Z`, fill: colour });
  // The shaft in pieces, as a slanted one covers little of its bounding box.
  for (let f = 0; f <= 1; f += 0.2)
    obstacles.push({ x0: x + f * length * dx - 4, x1: x + f * length * dx + 4, y0: y + f * length * dy - 4, y1: y + f * length * dy + 4 });
  return { x: tip[0], y: tip[1], dx, dy };
}

/** Draws a curved arrow in the sense of a couple. */
function drawCouple([x, y], couple, colour, r) {
  const sense = couple > 0 ? -1 : 1;
  const point = (angle) => [x + r * Math.cos(angle), y + sense * r * Math.sin(angle)];
  const [from, to] = [point(-0.6), point(Math.PI + 0.6)];
  const sweep = sense > 0 ? 1 : 0;
  draw(marks, "path", { d: `M${from}A${r} ${r} 0 1 ${sweep} ${to}`, fill: "none", stroke: colour, "stroke-width": r < 10 ? 1.6 : 2.5 });
  const along = [-Math.sin(Math.PI + 0.6), sense * Math.cos(Math.PI + 0.6)];
  const side = [-along[1], along[0]];
  const size = Math.min(1, r / 14);
  const p = (f, g) => [to[0] + size * (f * along[0] + g * side[0]), to[1] + size * (f * along[1] + g * side[1])];
  draw(marks, "path", { d: `M${p(8, 0)}L${p(-3, 5)}L${p(-3, -5)}Z`, fill: colour });
}

function drawScaleBar() {
  const longest = (0.25 * view.width) / view.scale;
  const decade = 10 ** Math.floor(Math.log10(longest));
  const length = [5, 2, 1].map((m) => m * decade).find((l) => l <= longest);
  const [x, y, w] = [12, view.height - 12, length * view.scale];
  draw(marks, "path", { d: `M${x} ${y - 4}v8m0 -4h${w}m0 -4v8`, stroke: INK, fill: "none", "stroke-width": 1.4 });
  draw(marks, "text", { x: x + w + 8, y: y + 4, "font-size": 12.5, class: "muted halo" }, `${length} mm`);
  return { x0: 0, x1: x + w + 90, y0: y - 10, y1: view.height };
}
