"use strict";

// The data that the page shows, and numbers as text.

window.addEventListener("error", (event) => { document.documentElement.dataset.error = event.message; });

const byId = (id) => document.getElementById(id);

/** The data that are shown, their states, and the numbers of states, panels and hinges. */
let run, states, stateCount, panelCount, hingeCount;

/** The points of every panel's boundary in the flat sheet, x and y one after the other (mm). */
let boundaries;

/** What other scripts compute from new data, in the order in which it is needed. */
const whenTaken = [];

/** Shows other data from now on. */
function take(data) {
  [run, states] = [data, data.states];
  unpack(run, ["target"]);
  unpack(run.holes, Object.keys(run.holes));
  unpack(run.panels, ["corners", "references"]);
  panelCount = run.panels.places.length;
  boundaries = run.panels.places.map((_, k) => run.panels.corners.subarray(8 * k, 8 * k + 8));
  for (const [k, points] of run.panels.trimmed) boundaries[k] = floats(points);
  unpack(run.hinges, ["w_lig", "alpha_deg", "fillet_ratio", "damage", "damage_peak"]);
  unpack(states, ["motions", "deformations", "inside", "energy", "forces", "damage", "damage_peak", "spread", "reactions"]);
  stateCount = states.index.length;
  hingeCount = run.hinges.sites.length;
  whenTaken.forEach((compute) => compute());
}

function floats(base64) {
  const bytes = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
  return new Float32Array(bytes.buffer);
}

/** Replaces packed lists by arrays of floats. */
function unpack(object, names) {
  for (const name of names) if (typeof object[name] === "string") object[name] = floats(object[name]);
}
const DEG = 180 / Math.PI;

/** Significant digits, in full between 1e-3 and 1e6. */
function shown(x, digits = 4) {
  if (!Number.isFinite(x)) return "not known";
  if (x === 0) return "0";
  const size = Math.abs(x);
  if (size < 1e-3 || size >= 1e6) return x.toExponential(2).replace("e+", "e").replaceAll("-", "\u2212");
  return String(Number(x.toPrecision(Math.max(digits, Math.floor(Math.log10(size)) + 1)))).replace("-", "\u2212");
}

function fixed(x, decimals) {
  if (!Number.isFinite(x)) return "not known";
  if (Math.abs(x) >= 1e6) return shown(x);
  const text = x.toFixed(decimals);
  return Number(text) === 0 ? (0).toFixed(decimals) : text.replace("-", "\u2212");
}

/** The deformation of a hinge in a state: a (mm), s (mm), theta (rad). */
function deformation(state, hinge) {
  const at = 3 * (state * hingeCount + hinge);
  return [states.deformations[at], states.deformations[at + 1], states.deformations[at + 2]];
}

/** (F_a, F_s, M_theta) of a hinge in a state (N, N, N mm). */
function forces(state, hinge) {
  const at = 3 * (state * hingeCount + hinge);
  return [states.forces[at], states.forces[at + 1], states.forces[at + 2]];
}

function of(list, state, hinge) { return list[state * hingeCount + hinge]; }

const SVG = byId("marks").namespaceURI;

/** An SVG element with attributes and a text, appended to its parent. */
function draw(parent, name, attributes, text) {
  const element = document.createElementNS(SVG, name);
  for (const key in attributes) element.setAttribute(key, attributes[key]);
  if (text !== undefined) element.textContent = text;
  parent.appendChild(element);
  return element;
}

/** An HTML element with a text, appended to its parent. */
function write(parent, name, text, className) {
  const element = document.createElement(name);
  if (text !== undefined) element.textContent = text;
  if (className) element.className = className;
  parent.appendChild(element);
  return element;
}

/** Round numbers that cover an interval. */
function ticks(low, high, count) {
  const raw = (high - low) / count || 1;
  const decade = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((m) => m * decade).find((s) => s >= raw * 0.999);
  const first = Math.ceil(low / step - 1e-9);
  const last = Math.floor(high / step + 1e-9);
  return Array.from({ length: last - first + 1 }, (_, i) => Number(((first + i) * step).toPrecision(12)));
}
