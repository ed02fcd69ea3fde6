// The quantities that colour panels and hinges, and their colour scale.

/** The directions m of the gauge (hinge/src/domain.rs). */
const DIRECTIONS = Array.from({ length: 27 }, (_, k) => [(k % 3) - 1, (Math.floor(k / 3) % 3) - 1, Math.floor(k / 9) - 1]);
DIRECTIONS.splice(13, 1);

/** The support of the training domain in every direction at the width of a hinge. */
function supports(hinge) {
  supportsOf[hinge] ??= (() => {
    const domain = run.domain;
    const [row, blend] = place(domain, run.hinges.w_lig[hinge]);
    const next = domain.supports[Math.min(row + 1, domain.supports.length - 1)];
    return domain.supports[row].map((here, m) => here + blend * (next[m] - here));
  })();
  return supportsOf[hinge];
}

let supportsOf = [];

/** eta_a of the mean path of the training domain. */
function meanPath(theta) {
  const [first, second] = run.domain.mean_path ?? [0, 0];
  return theta * (first + second * theta);
}

/** w' / w_lig of the hinge with the paper's hole and the same net ligament (hinge/src/net_ligament.rs). */
function netRatio(hinge) {
  return run.domain.holes ? (1 - run.hinges.fillet_ratio[hinge]) / (1 - 0.16) : 1;
}

/** The gauge of the training domain: 0 at its centre, 1 at its edge, more outside. */
function gauge(hinge, etaA, etaS, theta) {
  const { centre, half_range: half } = run.domain;
  const net = netRatio(hinge);
  const coordinates = [(etaA - 2 * Math.sin(theta / 2) * (1 - net)) / net - meanPath(theta), etaS / net, theta];
  const [y0, y1, y2] = coordinates.map((x, i) => (x - centre[i]) / half[i]);
  const support = supports(hinge);
  let sum = 0;
  for (let m = 0; m < 26; m++) {
    const direction = DIRECTIONS[m];
    const ratio = (direction[0] * y0 + direction[1] * y1 + direction[2] * y2) / support[m];
    if (ratio > 0) sum += ratio ** 24;
  }
  return sum ** (1 / 24);
}

/** The stored width at or below a ligament width, and the blending weight of the next one. */
function place(domain, wLig) {
  const steps = domain.supports.length - 1;
  const [low, high] = domain.w_lig;
  const share = Math.log(wLig / low) / Math.log(high / low);
  const along = Number.isFinite(share) ? Math.min(Math.max(share * steps, 0), steps) : 0;
  const row = Math.min(Math.floor(along), Math.max(steps - 1, 0));
  const x = along - row;
  return [row, steps > 0 ? x * x * x * (x * (6 * x - 15) + 10) : 0];
}

function gaugeOf(state, hinge) {
  const [a, s, theta] = deformation(state, hinge);
  const w = run.hinges.w_lig[hinge];
  return gauge(hinge, a / w, s / w, theta);
}

/** Each quantity: name, unit, value of a hinge in a state (NaN: not known). */
let quantities = {};

whenTaken.push(() => {
  supportsOf = [];
  quantities = { rotation: { short: "rotation \u03b8", name: "Rotation \u03b8 of the hinges", unit: "deg", of: (i, h) => deformation(i, h)[2] * DEG } };
  if (states.damage_peak)
    quantities.d_peak = { short: "D_peak", name: "D_peak, damage of the most strained 1 %: tears at 1", unit: "", of: (i, h) => of(states.damage_peak, i, h) };
  if (states.damage) quantities.d = { short: "D", name: "D, mean damage of the ligament", unit: "", of: (i, h) => of(states.damage, i, h) };
  if (states.energy) quantities.energy = { short: "energy W", name: "Energy W of the hinges", unit: "N mm", of: (i, h) => of(states.energy, i, h) };
  if (states.forces) {
    quantities.force = { short: "force |F|", name: "Force |F| of the hinges", unit: "N", of: (i, h) => Math.hypot(...forces(i, h).slice(0, 2)) };
    quantities.moment = { short: "moment M_\u03b8", name: "Moment M_\u03b8 of the hinges", unit: "N mm", of: (i, h) => forces(i, h)[2] };
  }
  if (states.spread)
    quantities.spread = { short: "ensemble spread", name: "Spread of the ensemble's forces, relative to the path's", unit: "%", of: (i, h) => of(states.spread, i, h) };
  if (run.domain)
    quantities.gauge = { short: "place in the training domain", name: "Place in the training domain: 0 centre, 1 edge", unit: "", of: gaugeOf };
});

/** Colours of the page's style, in SVG. */
const [INK, PAPER, ACCENT, TEAL, ERROR, GRID, TICK, UNKNOWN] =
  ["ink", "paper", "accent", "teal", "error", "grid", "tick", "not-known"].map((name) => `var(--${name})`);

/** Whether the page is laid out for a sheet of paper, which is always light. */
let onPaper = false;
const darkScreen = matchMedia("(prefers-color-scheme: dark)");

/**
 * The colours of the panels on the canvas: of the ground, of edges, and where nothing is known; `lift` is the share of
 * white in the colours of a scale, whose dark end would not be seen on a dark ground.
 */
const LIGHT = { lift: 0, ground: [255, 255, 255], ink: "#1f2933", unknownPanel: "#e3e6e9", unknownHinge: "#9aa3ad" };
const DARK = { lift: 0.22, ground: [26, 32, 39], ink: "#c4cdd6", unknownPanel: "#343d46", unknownHinge: "#7d8894" };
const canvasColours = () => (darkScreen.matches && !onPaper ? DARK : LIGHT);

const rgb = (channels) => `rgb(${channels.map(Math.round).join(",")})`;

const VIRIDIS = [[68, 1, 84], [65, 68, 135], [42, 120, 142], [34, 168, 132], [122, 209, 81], [253, 231, 37]];

/** The colour of a fraction of a scale, mixed with a share of the ground. */
function viridis(fraction, share) {
  const position = Math.min(Math.max(fraction, 0), 1) * (VIRIDIS.length - 1);
  const stop = Math.min(Math.floor(position), VIRIDIS.length - 2);
  const f = position - stop;
  const c = [0, 1, 2].map((i) => VIRIDIS[stop][i] + f * (VIRIDIS[stop + 1][i] - VIRIDIS[stop][i]));
  const { ground, lift } = canvasColours();
  return rgb(c.map((x) => x + lift * (255 - x)).map((x, i) => x + share * (ground[i] - x)));
}

/** The interval of a quantity over all states, which its colours cover. */
function range(quantity) {
  if (quantity.range) return quantity.range;
  let [low, high] = [0, 0];
  for (let i = 0; i < stateCount; i++)
    for (let h = 0; h < hingeCount; h++) {
      const value = quantity.of(i, h);
      if (value < low) low = value;
      if (value > high) high = value;
    }
  if (high - low < 1e-12) high = low + 1;
  quantity.range = [low, high];
  return quantity.range;
}

/** The share of the ground in the colours of panels. */
const PANEL_SHARE = 0.62;

/** The colours of all hinges and panels; a panel has the colour of its hinge with the largest value. */
function colours(quantity, state) {
  const [low, high] = range(quantity);
  const values = new Float32Array(hingeCount);
  const most = new Float32Array(panelCount).fill(-Infinity);
  const unknown = new Uint8Array(panelCount);
  for (let h = 0; h < hingeCount; h++) {
    values[h] = quantity.of(state, h);
    for (const k of [run.hinges.sites[h][0], run.hinges.sites[h][2]]) {
      if (Number.isNaN(values[h])) unknown[k] = 1;
      else if (most[k] === -Infinity || Math.abs(values[h]) > Math.abs(most[k])) most[k] = values[h];
    }
  }
  const colour = (value, share) => viridis((value - low) / (high - low), share);
  const { ground, unknownPanel, unknownHinge } = canvasColours();
  return {
    hinges: Array.from(values, (value) => (Number.isNaN(value) ? unknownHinge : colour(value, 0))),
    panels: Array.from(most, (value, k) => (unknown[k] ? unknownPanel : value === -Infinity ? rgb(ground) : colour(value, PANEL_SHARE))),
  };
}

/** Draws the colour scale of a quantity above the sheet. */
function drawScale(quantity) {
  byId("scale").textContent = "";
  const svg = draw(byId("scale"), "svg", { viewBox: "0 0 560 46" });
  const [low, high] = range(quantity);
  const [x0, x1] = [8, 390];
  const title = quantity.name + (quantity.unit ? ` (${quantity.unit})` : "");
  draw(svg, "text", { x: x0, y: 12, "font-size": 12.5 }, title);
  for (let i = 0; i < 64; i++) {
    const x = x0 + ((x1 - x0) * i) / 64;
    draw(svg, "rect", { x, y: 18, width: (x1 - x0) / 64 + 0.5, height: 10, fill: viridis((i + 0.5) / 64, 0), "shape-rendering": "crispEdges" });
  }
  for (const value of ticks(low, high, 5)) {
    const x = x0 + ((x1 - x0) * (value - low)) / (high - low);
    draw(svg, "line", { x1: x, x2: x, y1: 28, y2: 32, stroke: TICK });
    draw(svg, "text", { x, y: 43, "font-size": 11.5, "text-anchor": "middle", class: "muted" }, shown(value));
  }
  let partly = false;
  for (let h = 0; h < hingeCount && !partly; h++) partly = Number.isNaN(quantity.of(stateCount - 1, h));
  if (partly) {
    draw(svg, "rect", { x: 412, y: 18, width: 18, height: 10, fill: UNKNOWN });
    draw(svg, "text", { x: 436, y: 27, "font-size": 11.5, class: "muted" }, "left the domain:");
    draw(svg, "text", { x: 436, y: 41, "font-size": 11.5, class: "muted" }, "not known");
  }
}
