// The numbers of one hinge, and its path in the training domain.

/** Lines of names and values, one or two a line. */
function hingeLines(state, h) {
  const w = run.hinges.w_lig[h];
  const [a, s, theta] = deformation(state, h);
  const [panelA, , panelB] = run.hinges.sites[h];
  const value = (list, unit, digits) => {
    if (!list) return null;
    const number = of(list, state, h);
    return Number.isFinite(number) ? shown(number, digits) + unit : shown(number);
  };
  const most = (list, known) => (known ? shown(list[h], 3) : null);
  const [fa, fs, m] = states.forces ? forces(state, h) : [];
  const law = (x, unit) => (states.forces ? `${shown(x)} ${unit}` : null);
  const lines = [
    [["panels", `P${panelA}, P${panelB}`]],
    [["w_lig", `${fixed(w, 2)} mm`], ["\u03b1", `${fixed(run.hinges.alpha_deg[h], 1)} deg`]],
    [["\u03b8", `${fixed(theta * DEG, 2)} deg`], ["M_\u03b8", law(m, "N mm")]],
  ];
  if (run.carries_load)
    lines.push(
      [["\u03b7_a", fixed(a / w, 4)], ["\u03b7_s", fixed(s / w, 4)]],
      [["a", `${fixed(a, 3)} mm`], ["F_a", law(fa, "N")]],
      [["s", `${fixed(s, 3)} mm`], ["F_s", law(fs, "N")]],
    );
  lines.push(
    [["W", value(states.energy, " N mm")], ["spread of F", value(states.spread, " %", 2)]],
    [["D", value(states.damage, "", 3)], ["maximum", most(run.hinges.damage, states.damage)]],
    [["D_peak", value(states.damage_peak, "", 3)], ["maximum", most(run.hinges.damage_peak, states.damage_peak)]],
    [["domain", run.domain ? domainText(state, h) : null]],
  );
  return lines.map((line) => line.filter(([, text]) => text !== null)).filter((line) => line.length > 0);
}

/** Where a hinge is in the training domain in a state, and where it left it. */
function domainText(state, h) {
  const left = states.index.findIndex((_, i) => of(states.inside, i, h) === 0);
  if (left < 0) return "inside on the whole path";
  const where = of(states.inside, state, h) === 1 ? "inside" : "outside";
  return `${where}; left it at ${stateName(left)}`;
}

function drawHinge(state, h) {
  byId("hinge-number").value = h;
  const table = byId("hinge-numbers");
  table.textContent = "";
  for (const line of hingeLines(state, h)) {
    const tr = write(table, "tr");
    for (const [name, value] of line) {
      write(tr, "td", name);
      write(tr, "td", value, value.startsWith("not known") || value.startsWith("outside") ? "unknown" : "");
    }
    if (line.length === 1) tr.lastChild.colSpan = 3;
  }
  drawDomain(state, h);
}

/** The boundary of the domain in the plane of (eta_a or eta_s, theta) through the state of a hinge; theta in deg. */
function section(h, axis, eta, theta) {
  const at = (x, t) => gauge(h, axis === 0 ? x : eta[0], axis === 0 ? eta[1] : x, t);
  const { centre, half_range: half } = run.domain;
  const net = netRatio(h);
  const etaA = (centre[0] + meanPath(centre[2])) * net + 2 * Math.sin(centre[2] / 2) * (1 - net);
  const middle = [[etaA, centre[1] * net][axis], centre[2]];
  const inside = [[eta[axis], theta], middle].find(([x, t]) => at(x, t) <= 1);
  if (!inside) return [];
  const points = [];
  for (let i = 0; i < 60; i++) {
    const angle = (i / 60) * 2 * Math.PI;
    const along = (r) => [inside[0] + r * half[axis] * Math.cos(angle), inside[1] + r * half[2] * Math.sin(angle)];
    let [low, high] = [0, 8];
    for (let k = 0; k < 14; k++) {
      const middle = (low + high) / 2;
      if (at(...along(middle)) <= 1) low = middle;
      else high = middle;
    }
    const [x, t] = along(low);
    points.push([x, t * DEG]);
  }
  return points;
}

function drawDomain(state, h) {
  byId("domain-plots").hidden = !run.carries_load;
  if (!run.carries_load) return;
  const w = run.hinges.w_lig[h];
  const all = states.index.map((_, i) => deformation(i, h)).map(([a, s, t]) => [a / w, s / w, t]);
  const [a, s, theta] = all[state];
  let cuts = false;
  for (const axis of [0, 1]) {
    const points = all.map((p) => [p[axis], p[2] * DEG]);
    const region = run.domain ? section(h, axis, [a, s], theta) : [];
    cuts ||= region.length > 0;
    const known = points.concat(region, [[0, 0]]);
    const span = (c) => {
      const values = known.map((p) => p[c]);
      const [low, high] = [Math.min(...values), Math.max(...values)];
      // What is below a millionth is rounding.
      const room = high - low > 1e-6 ? 0.06 * (high - low) : 0.01;
      return [low - room, high + room];
    };
    const outside = (i) => of(states.inside, i, h) === 0;
    const dots = points.map(([x, y], i) => ({ x, y, r: 2.2, colour: outside(i) ? ERROR : INK }));
    const now = { x: points[state][0], y: points[state][1], r: 5, colour: outside(state) ? ERROR : ACCENT };
    const axes = { x: axis === 0 ? "\u03b7_a = a / w_lig" : "\u03b7_s = s / w_lig", y: "\u03b8 (deg)", box: [span(0), span(1)] };
    chart(byId(axis === 0 ? "plot-a" : "plot-s"), 230, axes, [{ points, colour: INK, width: 1.2 }], dots.concat(now), region.length ? [{ points: region, colour: TEAL }] : []);
  }
  byId("domain-note").textContent = domainNote(h, cuts);
}

function domainNote(h, cuts) {
  if (!run.domain) return "Path of the hinge from the flat sheet; large: the state shown.";
  const [low, high] = run.domain.w_lig;
  const [least, most] = run.domain.alpha.map((angle) => angle * DEG);
  const [w, alpha] = [run.hinges.w_lig[h], run.hinges.alpha_deg[h]];
  const ligament = [];
  if (w < low || w > high) ligament.push(`w_lig is outside the trained ${fixed(low, 1)} to ${fixed(high, 1)} mm.`);
  if (alpha < least || alpha > most) ligament.push(`\u03b1 is outside the trained ${fixed(least, 0)} to ${fixed(most, 0)} deg.`);
  const { holes } = run.domain;
  const hole = run.hinges.fillet_ratio[h];
  if (holes && (hole < holes[0] || hole > holes[1]))
    ligament.push(`The hole of ${fixed(hole, 3)} w_lig is outside the trained ${fixed(holes[0], 3)} to ${fixed(holes[1], 3)}.`);
  const region = cuts
    ? `Shaded: the training domain at w_lig = ${fixed(w, 1)} mm and \u03b1 = ${fixed(alpha, 0)} deg, cut through the state shown (large).`
    : "No state with these \u03b7 is in the training domain.";
  return [region, "Line: path from the flat sheet; red: outside.", ...ligament].join(" ");
}
