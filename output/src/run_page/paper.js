// What only paper shows: a summary, and a sketch of the flat sheet with the places where it is held and pulled.

/** The facts of the summary. */
const SUMMARY = ["material", "flat size", "deployed size", "load reached", "stroke reached", "stable parts"];

function drawPaper() {
  const table = byId("paper-facts");
  table.textContent = "";
  const row = (name, value) => {
    const tr = write(table, "tr");
    write(tr, "td", name);
    write(tr, "td", value);
  };
  row("target", run.miss);
  for (const { label, text } of run.facts) if (SUMMARY.includes(label)) row(label, text);
  // They need not be twice on paper.
  for (const tr of byId("facts").rows) tr.classList.toggle("screen-only", SUMMARY.includes(tr.firstChild.textContent));
  row("cut file", run.about_cut_files ? `${run.about_cut_files}: see the findings` : "no finding prevents it");
  byId("hang-box").hidden = !run.carries_load;
  if (run.carries_load) drawHang(byId("hang"), 340, 215);
}

/** The flat sheet with what is fastened to it; turned so that a single pull points down, as the sheet hangs. */
function drawHang(svg, width, height) {
  svg.textContent = "";
  svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
  const pulls = run.actuation.loads.filter(({ total: [x, y] }) => Math.hypot(x, y) > noticeable.force);
  const [px, py] = pulls.length === 1 ? pulls[0].total : [0, -1];
  const size = Math.hypot(px, py);
  const [cos, sin] = [-py / size, -px / size];
  const turned = ([x, y]) => [cos * x - sin * y, -sin * x - cos * y];
  const [low, high] = bounds(run.outlines.flat().map(turned));
  const scale = Math.min((width - 130) / (high[0] - low[0]), (height - 40) / (high[1] - low[1]));
  const place = (point) => turned(point).map((x, c) => [width, height][c] / 2 + scale * (x - (low[c] + high[c]) / 2));
  for (let k = 0; k < panelCount; k++) {
    draw(svg, "path", { d: path(boundary(0, k).map(place), (x) => x, (y) => y) + "Z", fill: "none", stroke: TICK, "stroke-width": 0.7 });
  }
  const labels = [];
  const mark = (panel, text, colour, symbol) => {
    const at = reference(0, panel);
    const [x, y] = place(at);
    draw(svg, "circle", { cx: x, cy: y, r: 4, fill: symbol ? colour : PAPER, stroke: colour, "stroke-width": 2 });
    labels.push({ text: `${text} (${fixed(at[0], 1)}, ${fixed(at[1], 1)})`, x, y, dx: x - width / 2, dy: y - height / 2, colour });
  };
  for (const { name, panel } of run.actuation.supports) mark(panel, name.split(",")[0], TEAL, true);
  for (const { on_panels: panels } of pulls) {
    for (const [panel, [fx, fy]] of panels) {
      const force = Math.hypot(fx, fy);
      const [x, y] = place(reference(0, panel));
      const [dx, dy] = turned([fx / force, fy / force]);
      draw(svg, "line", { x1: x, y1: y, x2: x + 26 * dx, y2: y + 26 * dy, stroke: ACCENT, "stroke-width": 2 });
      draw(svg, "path", { d: `M${x + 34 * dx} ${y + 34 * dy}L${x + 24 * dx - 4 * dy} ${y + 24 * dy + 4 * dx}L${x + 24 * dx + 4 * dy} ${y + 24 * dy - 4 * dx}Z`, fill: ACCENT });
    }
    if (panels.length === 1) mark(panels[0][0], "pull", ACCENT, false);
  }
  placeLabels(svg, labels, [], width, height);
}

/** The height of the drawing of the sheet (px): what the summary and the findings leave of the first page. */
function paperHeight() {
  const lines = run.warnings.reduce((sum, { message, hinges }) => sum + 0.5 + Math.ceil((message.length + 4 * Math.min(hinges.length, 14) + 12) / 125), 0);
  return Math.max(550 - 16 * lines, 240);
}
