// Texts, controls, and the state that is shown.

const shownNow = { state: 0, quantity: "rotation", hinge: 0 };

/** The name of a state of the path. */
function stateName(i) {
  if (states.index[i] === 0) return "the flat sheet";
  if (!run.carries_load) return `an opening of ${fixed(deformation(i, 0)[2] * DEG, 1)} deg`;
  const [step, all] = [states.index[i] - states.weight_steps, states.of - 1 - states.weight_steps];
  return step > 0 ? `load step ${step} of ${all}` : `weight step ${states.index[i]} of ${states.weight_steps}`;
}

function stateText(i) {
  const parts = [stateName(i)];
  if (run.carries_load) parts.push(`load factor ${shown(states.load_factor[i])}`);
  if (run.stroke && states.curve?.[states.index[i]]) {
    const [displacement, load] = states.curve[states.index[i]];
    const [length, force] = run.stroke[1];
    parts.push(`load ${shown(load)} ${force}`, `${length === "rad" ? "rotation" : "stroke"} ${shown(displacement)} ${length}`);
  }
  const remarks = {
    "left-domain": "some hinges outside the training domain", almost: "the residual is above its tolerance",
    "limit-point": "the sheet jumped to this state past a limit point", diverged: "no equilibrium was found beyond the state shown",
  };
  if (remarks[states.status[i]]) parts.push(remarks[states.status[i]]);
  const text = parts.join(" \u00b7 ");
  return text[0].toUpperCase() + text.slice(1);
}

/** How far the sheet is from its target, with the verdict of a report. */
function writeMiss(missed) {
  const miss = byId("miss");
  miss.textContent = "";
  if (missed && missed.severity !== "note") write(miss, "span", missed.severity, `tag ${missed.severity}`);
  miss.append(run.miss[0].toUpperCase() + run.miss.slice(1));
}

function writeSummary() {
  byId("summary").textContent = `${panelCount} panels, ${hingeCount} hinges. Search: ${run.end_of_search}.`;
}

function writeTexts() {
  byId("title").textContent = run.title;
  writeSummary();
  writeMiss(run.warnings.find(({ concern }) => concern.startsWith("target-")));
  byId("alert").hidden = !run.about_cut_files;
  byId("alert").textContent = `${run.about_cut_files}: see the findings.`;
  byId("mounting-card").hidden = !run.mounting;
  if (run.mounting) byId("mounting").src = `data:image/svg+xml,${encodeURIComponent(run.mounting)}`;
  byId("facts").textContent = "";
  for (const { label, text, page } of run.facts) {
    const tr = write(byId("facts"), "tr");
    write(tr, "td", label).title = page;
    write(tr, "td", text);
  }
  writeBudget();
  document.body.classList.toggle("pin", !run.carries_load);
  writeWarnings();
  byId("scene").textContent = run.scene;
  byId("legend").textContent = legend();
  byId("forces-card").hidden = run.actuation.loads.length + run.actuation.supports.length === 0;
  byId("curve-card").hidden = !states.curve || !run.stroke;
}

function writeBudget() {
  byId("budget-card").hidden = !run.budget;
  byId("budget").textContent = "";
  const { head, rows } = run.budget?.table ?? { head: [], rows: [] };
  const names = head.map((name) => name.replace("\n", ", "));
  for (const cells of [names, ...rows]) {
    const tr = write(byId("budget"), "tr");
    cells.forEach((cell) => write(tr, cells === names ? "th" : "td", cell));
  }
  byId("budget-note").textContent = run.budget ? `${run.budget.heading}. ${run.budget.left_out}.` : "";
}

function writeWarnings() {
  const MOST = 12;
  const list = byId("warnings");
  list.textContent = "";
  if (run.warnings.length === 0) write(list, "li", "No warnings.");
  for (const warning of run.warnings) {
    const li = write(list, "li");
    li.title = `Remedy: ${warning.remedy}`;
    write(li, "span", warning.severity, `tag ${warning.severity}`);
    write(li, "span", warning.message);
    warning.hinges.slice(0, MOST).forEach((h, i) => {
      write(li, "span", i ? ", " : warning.hinges.length > 1 ? " (hinges " : " (hinge ");
      const link = write(li, "a", String(h), "hinge");
      link.addEventListener("click", () => show({ hinge: h }));
    });
    const more = warning.hinges.length - MOST;
    if (warning.hinges.length) write(li, "span", more > 0 ? ` and ${more} more)` : ")");
  }
}

function legend() {
  const parts = [`Dashed orange: target; red where it is further than ${shown(missedFrom(), 2)} mm from the opened sheet.`];
  if (!run.carries_load) parts.push("Pins carry no load; the sheet is centred on its target.");
  else parts.push("Fine dashes: flat sheet. Panels stay in the plane. Arrows: loads (orange) and reactions (teal) at the points where they act.", run.actuation.legend);
  parts.push("A panel has the fainter colour of its hinge with the largest value.");
  return parts.join(" ");
}

function writeForces(state) {
  const table = byId("forces");
  table.textContent = "";
  const MOST = 12;
  const head = write(table, "tr");
  for (const name of ["", "F_x (N)", "F_y (N)", "M (N mm)"]) write(head, name ? "th" : "td", name);
  const rows = forcesOnSheet(state);
  for (const { name, total: [x, y, couple] } of rows.slice(0, MOST)) {
    const tr = write(table, "tr");
    write(tr, "td", name);
    const clean = (x, least) => (Math.abs(x) > least ? shown(x) : "0");
    [x, y].forEach((f) => write(tr, "td", clean(f, noticeable.force)));
    write(tr, "td", clean(couple, noticeable.couple));
  }
  if (rows.length > MOST) write(write(table, "tr"), "td", `and ${rows.length - MOST} more`).colSpan = 4;
  byId("forces-state").textContent = `${stateName(state)}, on the sheet, at the points where they act`;
}

/** Shows a state, a quantity or a hinge; what is not named remains. */
function show(changes) {
  Object.assign(shownNow, changes);
  if (!run) return;
  const { state, quantity, hinge } = shownNow;
  drawSheet(state, quantities[quantity], onPaper ? -1 : hinge);
  if (changes.quantity !== undefined) {
    drawScale(quantities[quantity]);
    byId("quantity").value = quantity;
  }
  byId("slider").value = state;
  byId("state").textContent = stateText(state);
  drawHinge(state, hinge);
  drawCurve(state);
  writeForces(state);
}

let playing = null;

function stop() {
  clearInterval(playing);
  playing = null;
  byId("play").textContent = "\u25b6";
}

function play() {
  if (playing) return stop();
  if (shownNow.state === stateCount - 1) show({ state: 0 });
  byId("play").textContent = "\u25a0";
  const pause = Math.min(Math.max(4000 / stateCount, 80), 500);
  playing = setInterval(() => {
    if (shownNow.state === stateCount - 1) stop();
    else show({ state: shownNow.state + 1 });
  }, pause);
}

/** The choices of the controls, which the data decide. */
function writeChoices() {
  const select = byId("quantity");
  select.textContent = "";
  for (const key in quantities) {
    const option = write(select, "option", quantities[key].short + (quantities[key].unit ? ` (${quantities[key].unit})` : ""));
    option.value = key;
  }
  byId("slider").max = stateCount - 1;
  byId("hinge-number").max = hingeCount - 1;
}

function connectControls() {
  byId("quantity").addEventListener("change", (event) => show({ quantity: event.target.value }));
  byId("slider").addEventListener("input", (event) => { stop(); show({ state: Number(event.target.value) }); });
  byId("play").addEventListener("click", play);
  const number = byId("hinge-number");
  number.addEventListener("change", () => {
    const h = Number(number.value);
    if (Number.isInteger(h) && h >= 0 && h < hingeCount) show({ hinge: h });
  });
  document.addEventListener("keydown", (event) => {
    // These elements have their own meaning of the keys.
    const taken = { " ": ["SELECT", "INPUT", "BUTTON", "SUMMARY", "TEXTAREA"], ArrowRight: ["SELECT", "INPUT", "TEXTAREA"], ArrowLeft: ["SELECT", "INPUT", "TEXTAREA"] };
    if (!(event.key in taken) || taken[event.key].includes(event.target.tagName)) return;
    event.preventDefault();
    if (event.key === " ") return play();
    stop();
    const step = event.key === "ArrowRight" ? 1 : -1;
    show({ state: Math.min(Math.max(shownNow.state + step, 0), stateCount - 1) });
  });
  connectStage();
  connectPrinter();
  window.addEventListener("resize", () => layOut(false));
  // Printing is a change to light.
  darkScreen.addEventListener("change", () => layOut(onPaper));
}

/** The final state is printed; then the page returns to the state that it showed. */
function connectPrinter() {
  let before = 0;
  window.addEventListener("beforeprint", () => {
    if (!run) return;
    stop();
    fitView();
    before = shownNow.state;
    shownNow.state = stateCount - 1;
    layOut(true);
  });
  window.addEventListener("afterprint", () => {
    shownNow.state = before;
    layOut(false);
  });
}

/** The pixel of the drawing at which an event of the pointer is. */
function pixelOf(event) {
  const box = canvas.getBoundingClientRect();
  return [((event.clientX - box.left) * view.width) / box.width, ((event.clientY - box.top) * view.height) / box.height];
}

function connectStage() {
  let dragged = null;
  stage.addEventListener("pointerdown", (event) => { dragged = { from: pixelOf(event), x: view.x, y: view.y, far: false }; });
  stage.addEventListener("pointermove", (event) => {
    const [x, y] = pixelOf(event);
    if (dragged && (dragged.far || Math.hypot(x - dragged.from[0], y - dragged.from[1]) > 5)) {
      dragged.far = true;
      view.x = dragged.x - (x - dragged.from[0]) / view.scale;
      view.y = dragged.y + (y - dragged.from[1]) / view.scale;
      drawSheet(shownNow.state, quantities[shownNow.quantity], shownNow.hinge);
    }
    showTip(dragged ? -1 : hingeAt(x, y), x, y);
  });
  window.addEventListener("pointerup", (event) => {
    if (dragged && !dragged.far) {
      const h = hingeAt(...pixelOf(event));
      if (h >= 0) show({ hinge: h });
    }
    dragged = null;
  });
  stage.addEventListener("pointerleave", () => showTip(-1));
  const zoom = (factor) => {
    view.zoom = Math.min(Math.max(view.zoom * factor, 0.5), 40);
    drawSheet(shownNow.state, quantities[shownNow.quantity], shownNow.hinge);
  };
  byId("zoom-in").addEventListener("click", () => zoom(1.5));
  byId("zoom-out").addEventListener("click", () => zoom(1 / 1.5));
  byId("zoom-fit").addEventListener("click", () => { fitView(); zoom(1); });
  stage.addEventListener("wheel", (event) => {
    if (!event.ctrlKey) return;
    event.preventDefault();
    zoom(event.deltaY < 0 ? 1.15 : 1 / 1.15);
  }, { passive: false });
}

function showTip(h, x, y) {
  const tip = byId("tip");
  tip.hidden = h < 0;
  if (h < 0) return;
  const quantity = quantities[shownNow.quantity];
  const value = quantity.of(shownNow.state, h);
  const theta = `\u03b8 ${fixed(deformation(shownNow.state, h)[2] * DEG, 2)} deg`;
  const also = shownNow.quantity === "rotation" ? "" : `, ${quantity.short} ${shown(value)} ${Number.isNaN(value) ? "" : quantity.unit}`;
  tip.textContent = `hinge ${h}: ${theta}${also}`;
  tip.style.left = `${Math.min(x + 14, view.width - tip.offsetWidth - 4)}px`;
  tip.style.top = `${Math.min(y + 14, view.height - 30)}px`;
}

/** Fits the drawings to the window, or to a sheet of paper. */
function layOut(paper) {
  onPaper = paper;
  if (!run) return;
  widths.clear();
  const width = paper ? 700 : stage.clientWidth;
  const aspect = (extent.y1 - extent.y0) / (extent.x1 - extent.x0);
  if (paper) drawPaper();
  const most = paper ? paperHeight() : Math.max(window.innerHeight - 290, 380);
  resizeStage(width, Math.round(Math.min(most, Math.max(0.8 * width * aspect + 110, 320))), paper ? 3 : window.devicePixelRatio || 1);
  show({ quantity: shownNow.quantity });
  drawHistory();
  drawLevels();
}

