// Line charts.

/** The width of a chart on a sheet of paper (px). */
const PAPER_CHART = 345;

/** Widths of the charts on the screen (px); forgotten when the window changes. */
const widths = new Map();

function chartWidth(svg) {
  if (!widths.has(svg)) widths.set(svg, Math.max(svg.clientWidth || 460, 200));
  return widths.get(svg);
}

/**
 * Draws a chart of series { name, colour, width, points, labelled } into an SVG element.
 * axes: { x: label, y: label, log and logX: whether y and x are logarithmic, box: [[x0, x1], [y0, y1]] or nothing, exponents if logarithmic };
 * marks: points { x, y, colour, hollow, text } on top; below: areas { points, colour }.
 */
function chart(svg, height, axes, series, marks, below = []) {
  svg.textContent = "";
  const width = onPaper ? PAPER_CHART : chartWidth(svg);
  svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
  svg.style.aspectRatio = `${width} / ${height}`;
  const toY = axes.log ? Math.log10 : (y) => y;
  const toX = axes.logX ? Math.log10 : (x) => x;
  const points = series.flatMap((s) => s.points).filter(([, y]) => Number.isFinite(toY(y)));
  const bounds = (values) => values.reduce(([low, high], v) => [Math.min(low, v), Math.max(high, v)], [Infinity, -Infinity]);
  let [[x0, x1], [y0, y1]] = axes.box || [bounds(points.map((p) => p[0])), bounds(points.map((p) => toY(p[1])))];
  if (!(x1 > x0)) [x0, x1] = [x0 - 0.5, x0 + 0.5];
  if (!(y1 > y0)) [y0, y1] = [y0 - 0.5, y0 + 0.5];
  const padding = axes.box ? 0 : 0.05 * (y1 - y0);
  [y0, y1] = [y0 - padding, y1 + padding];
  const yTicks = axes.log ? decades(y0, y1) : ticks(y0, y1, height / 45).map((v) => [v, shown(v)]);
  const left = 34 + Math.max(...yTicks.map(([, text]) => textWidth(text, 11.5)));
  const named = series.filter((s) => s.name);
  const isNamed = named.length > (axes.box ? 0 : 1);
  const right = isNamed ? 12 + Math.max(...named.map((s) => textWidth(s.name, 11.5))) : 14;
  const [top, bottom] = [10, 40];
  const px = (x) => left + ((width - left - right) * (toX(x) - x0)) / (x1 - x0);
  const py = (y) => height - bottom - ((height - top - bottom) * (toY(y) - y0)) / (y1 - y0);
  for (const [value, text] of yTicks) {
    const y = height - bottom - ((height - top - bottom) * (value - y0)) / (y1 - y0);
    draw(svg, "line", { x1: left, x2: width - right, y1: y, y2: y, stroke: GRID });
    draw(svg, "text", { x: left - 6, y: y + 4, "font-size": 11.5, "text-anchor": "end", class: "muted" }, text);
  }
  const xTicks = axes.logX ? decades(x0, x1).map(([exponent]) => 10 ** exponent) : roomyTicks(x0, x1, width - left - right);
  for (const value of xTicks) {
    draw(svg, "line", { x1: px(value), x2: px(value), y1: height - bottom, y2: height - bottom + 4, stroke: TICK });
    draw(svg, "text", { x: px(value), y: height - bottom + 17, "font-size": 11.5, "text-anchor": "middle", class: "muted" }, shown(value));
  }
  draw(svg, "rect", { x: left, y: top, width: width - left - right, height: height - top - bottom, fill: "none", stroke: "var(--frame)" });
  draw(svg, "text", { x: (left + width - right) / 2, y: height - 6, "font-size": 12, "text-anchor": "middle" }, axes.x);
  const middle = (top + height - bottom) / 2;
  draw(svg, "text", { x: 12, y: middle, "font-size": 12, "text-anchor": "middle", transform: `rotate(-90 12 ${middle})` }, axes.y);
  for (const { points, colour } of below)
    draw(svg, "path", { d: path(points, px, py) + "Z", fill: colour, "fill-opacity": 0.12, stroke: colour, "stroke-width": 1 });
  for (const { points, colour, width: w } of series) {
    const finite = points.filter(([, y]) => Number.isFinite(toY(y)));
    draw(svg, "path", { d: path(finite, px, py), fill: "none", stroke: colour, "stroke-width": w || 1.6, "stroke-linejoin": "round" });
  }
  for (const mark of marks)
    if (Number.isFinite(toY(mark.y))) {
      draw(svg, "circle", { cx: px(mark.x), cy: py(mark.y), r: mark.r || 4, fill: mark.hollow ? PAPER : mark.colour, stroke: mark.colour, "stroke-width": 1.6 });
      if (mark.text) draw(svg, "text", { x: px(mark.x) + 8, y: py(mark.y) + 4, "font-size": 11.5 }, mark.text);
    }
  if (isNamed) nameLines(svg, named.map((s) => ({ name: s.name, colour: s.colour, y: py(s.points[s.points.length - 1][1]) })), width - right + 6, top, height - bottom);
}

function path(points, px, py) {
  return points.map(([x, y], i) => `${i ? "L" : "M"}${px(x).toFixed(1)} ${py(y).toFixed(1)}`).join("");
}

/** As many ticks as their texts leave room for on an axis of the given length (px). */
function roomyTicks(low, high, length) {
  const room = (values) => {
    const widest = Math.max(...values.map((v) => textWidth(shown(v), 11.5)));
    return values.length < 2 || ((values[1] - values[0]) * length) / (high - low) > widest + 12;
  };
  const counts = [10, 8, 6, 5, 4, 3, 2];
  const found = counts.map((count) => ticks(low, high, count)).find(room);
  return found || ticks(low, high, 1);
}

/** Ticks of a logarithmic axis between two exponents: decades, with 2 and 5 on a short axis. */
function decades(low, high) {
  const digits = high - low > 3 ? [1] : [1, 2, 5];
  const stride = Math.max(1, Math.ceil((high - low) / 6));
  const values = [];
  for (let n = Math.floor(low); n <= high; n++)
    if (n % stride === 0) for (const digit of digits) values.push(digit * 10 ** n);
  const within = (list) => list.map((v) => [Math.log10(v), shown(v)]).filter(([y]) => y >= low && y <= high);
  const found = within(values);
  return found.length > 2 ? found : within(ticks(10 ** low, 10 ** high, 4).filter((v) => v > 0));
}

/** Writes names at the ends of lines, moved apart where they would overlap. */
function nameLines(svg, names, x, top, bottom) {
  names.forEach((it) => { if (!Number.isFinite(it.y)) it.y = bottom; });
  names.sort((a, b) => a.y - b.y);
  const gap = 14;
  names.forEach((it, i) => { it.y = Math.max(it.y, i ? names[i - 1].y + gap : top + 4); });
  for (let i = names.length - 1; i >= 0; i--)
    names[i].y = Math.min(names[i].y, i === names.length - 1 ? bottom : names[i + 1].y - gap);
  for (const it of names) draw(svg, "text", { x, y: it.y + 4, "font-size": 11.5, style: `fill: ${it.colour}` }, it.name);
}

function drawCurve(state) {
  if (!states.curve || !run.stroke) return;
  const [what, [length, force]] = run.stroke;
  const points = states.curve.filter(Boolean);
  const jumps = states.curve.filter((point, i) => point && states.status[states.index.indexOf(i)] === "limit-point");
  const marks = points.map(([x, y]) => ({ x, y, colour: TEAL, r: 2.5 }));
  marks.push(...jumps.map(([x, y]) => ({ x, y, colour: ACCENT, hollow: true })));
  const last = points[points.length - 1];
  const peak = run.peak && Math.abs(run.peak[0]) < Math.abs(last[0]) ? run.peak : null;
  const path = peak ? [...points, peak].sort((a, b) => Math.abs(a[0]) - Math.abs(b[0])) : points;
  if (peak) marks.push({ x: peak[0], y: peak[1], colour: ACCENT, r: 3.5 });
  const here = states.curve[states.index[state]];
  if (here) marks.push({ x: here[0], y: here[1], colour: INK, r: 5 });
  const named = { x: `${what.startsWith("rotation") || length === "rad" ? "rotation" : "displacement"} (${length})`, y: `${force === "N" ? "load" : "couple"} (${force})` };
  chart(byId("curve"), 250, named, [{ points: path, colour: TEAL }], marks);
  byId("curve-note").textContent =
    `Displacement: ${what}. Load: ${run.actuation.loads.length ? "sum of the magnitudes of all loads" : "its work-conjugate"}. ` +
    `Points: load steps; large: the state shown.` +
    (peak ? ` Orange: the largest load, ${shown(peak[1])} ${force} at ${shown(peak[0])} ${length}.` : "") + (jumps.length ? " Hollow: the sheet jumped to this state past a limit point." : "");
}

const TERM_COLOURS = ["teal", "accent", "violet", "blue", "ochre", "rose"].map((name) => `var(--${name})`);

/** The place of the best design in the history of a search. */
const bestOf = ({ loss }) => loss.reduce((best, value, i) => (value < loss[best] ? i : best), 0);

function drawHistory() {
  const history = run.history;
  const line = (values) => values.map((value, i) => [history.step[i], value > 0 ? value : NaN]);
  const series = history.terms
    .filter(([, values]) => values.some((value) => value > 0))
    .map(([name, values], i) => ({ name: values[values.length - 1] > 0 ? name : `${name} (0)`, points: line(values), colour: TERM_COLOURS[i] }));
  // With a single term the loss is that term.
  if (series.length === 1) series.length = 0;
  series.push({ name: "loss", points: line(history.loss), colour: INK, width: 2.4 });
  const best = bestOf(history);
  const mark = { x: history.step[best], y: history.loss[best], colour: INK };
  chart(byId("history"), 250, { x: "step of the search", y: "loss and terms (mm\u00b2)", log: true }, series, [mark]);
  const error = history.outline_error;
  byId("history-note").textContent =
    `Terms of the loss, weighted. Best design: step ${history.step[best]}. Outline error, rms: ${shown(error[0])} mm at the start, ${shown(error[best])} mm at the best design.`;
}

/** The levels of a run: seconds of a search against the difference to the finest level, and a table. */
function drawLevels() {
  byId("levels-card").hidden = !run.levels;
  if (!run.levels) return;
  const { levels, others } = run.levels;
  const marks = levels
    .filter(({ search, difference }) => search > 0 && difference?.corners[1] > 0)
    .map(({ level, search, difference }) => ({ x: search, y: difference.corners[1], colour: TEAL, text: level }));
  const known = (cause) => others.find((other) => other.cause === cause)?.effect?.corners[1];
  const mesh = known("window-mesh");
  const causes = [["material-law", "material"], ["loading-path", "loading path"], ["kerf", "kerf"], ["thickness", "thickness"]].filter(([cause]) => known(cause) > 0);
  const range = (values, [before, after]) => [Math.log10(Math.min(...values)) - before, Math.log10(Math.max(...values)) + after];
  const heights = [...marks.map((mark) => mark.y), ...causes.map(([cause]) => known(cause)), ...(mesh > 0 ? [mesh] : [])];
  byId("levels-chart").style.display = marks.length ? "" : "none";
  if (marks.length) {
    const box = [range(marks.map((mark) => mark.x), [0.4, 0.9]), range(heights, [0.5, 0.3])];
    const [[x0, x1], [y0]] = box.map((exponents) => exponents.map((exponent) => 10 ** exponent));
    const series = causes.map(([cause, name], i) => ({ name, points: [[x0, known(cause)], [x1, known(cause)]], colour: TERM_COLOURS[i + 1], width: 1 }));
    const below = mesh > 0 ? [{ points: [[x0, y0], [x1, y0], [x1, mesh], [x0, mesh]], colour: TICK }] : [];
    const axes = { x: "search (s)", y: "largest difference of a corner (mm)", log: true, logX: true, box };
    chart(byId("levels-chart"), 250, axes, series, marks, below);
  }
  const rounded = (x) => (x == null ? "-" : shown(Number(x.toPrecision(2))));
  const rows = levels.map(({ level, search, difference, failure }) => {
    if (!difference) return [level, rounded(search), failure ?? "-", "", "", ""];
    const { corners: [rms, largest], load, damage } = difference;
    return [level, ...[search, rms, largest, load == null ? null : 100 * load, damage].map(rounded)];
  });
  byId("levels").textContent = "";
  [["level", "search", "corners, rms", "largest", "load", "D_peak"], ["", "s", "mm", "mm", "%", ""], ...rows].forEach((cells, i) => {
    const tr = write(byId("levels"), "tr");
    cells.forEach((cell) => write(tr, i < 2 && cell ? "th" : "td", cell));
  });
}
