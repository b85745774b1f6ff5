// Elements, numbers, and what a column's name says.

/// el("p", {class: "note"}, "text", child, …): texts stay texts, so nothing in a result is markup.
function el(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  return fill(node, attributes, children);
}
function svg(tag, attributes = {}, ...children) {
  return fill(document.createElementNS("http://www.w3.org/2000/svg", tag), attributes, children);
}
function fill(node, attributes, children) {
  for (const [name, value] of Object.entries(attributes))
    if (name.startsWith("on")) node.addEventListener(name.slice(2), value);
    else if (value !== null && value !== undefined && value !== false) node.setAttribute(name, value);
  for (const child of children.flat(3))
    if (child !== null && child !== undefined) node.append(child);
  return node;
}

/// Calls draw() whenever the width of the element changes, at the next picture.
function redraw_with_width(element, draw) {
  let width = 0;
  new ResizeObserver(() => {
    if (element.clientWidth === width) return;
    width = element.clientWidth;
    requestAnimationFrame(draw);
  }).observe(element);
}
const on_theme = (draw) => matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);

const superscript = {"-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹"};
const power = (n) => [...String(n)].map((c) => superscript[c]).join("");

/// Four digits, 1.234·10⁻⁵ outside 0.001 … 10⁶; what is not finite keeps its name.
function number(x, digits = 4) {
  if (x === null || x === undefined) return "–";
  if (typeof x !== "number") return String(x);
  if (!Number.isFinite(x)) return Number.isNaN(x) ? "nan" : x > 0 ? "∞" : "−∞";
  if (x === 0) return "0";
  const size = Math.abs(x);
  if (Number.isInteger(x) && size < 1e7) return group(String(x));
  if (size >= 1e6 || size < 1e-3) {
    const [mantissa, exponent] = x.toExponential(digits - 2).split("e");
    const short = mantissa.includes(".") ? mantissa.replace(/\.?0+$/, "") : mantissa;
    return minus(`${short}·10${power(Number(exponent))}`);
  }
  const text = x.toPrecision(digits);
  const plain = text.includes("e") ? String(Math.round(x)) : text;
  return group(plain.includes(".") ? plain.replace(/\.?0+$/, "") : plain);
}
const minus = (text) => text.replace(/^-/, "−");
function group(text) {
  const [whole, part] = text.split(".");
  const digits = whole.replace("-", "");
  const spaced = digits.length > 4 ? whole.replace(/\B(?=(\d{3})+$)/g, " ") : whole;
  return minus(part === undefined ? spaced : `${spaced}.${part}`);
}

const units = [
  ["_J_per_m3", "J/m³", 1], ["_J_per_m", "J/m", 1], ["_kg_per_m3", "kg/m³", 1], ["_kg_per_m", "kg/m", 1],
  ["_m_per_s", "m/s", 1], ["_per_cpu_s", "1/s", 1], ["_1_per_s", "1/s", 1], ["_1_per_m", "1/m", 1], ["_per_s", "1/s", 1], ["_kPa", "kPa", 1], ["_Pa", "kPa", 1e-3],
  ["_kg", "kg", 1], ["_J", "J", 1], ["_m2", "m²", 1], ["_percent", "%", 1], ["_MB", "MB", 1], ["_deg", "°", 1], ["_s", "s", 1], ["_m", "m", 1],
];
const greek = {eps: "ε", deps: "Δε", gamma: "γ", sigma: "σ", tau: "τ", mu: "μ", eta: "η", lambda: "λ", kappa: "κ", rho: "ρ", nu: "ν", phi: "φ", delta: "Δ", Gamma: "Γ"};
const words = {
  kinetic: "kinetic energy", potential: "potential energy", elastic: "elastic energy", dissipated: "dissipated energy",
  dt: "time step", mean_dt: "mean time step", wall: "wall time", cpu: "CPU time", front_max: "farthest point", h: "cell h",
  velocity: "speed |v|", mises: "von Mises stress", density_min: "least density", density_max: "largest density",
  front_change: "change of the front", height_change: "change of the height", profile_change_mean: "mean change of the profile",
  profile_change_max: "largest change of the profile", courant: "Courant number",
  runout_99: "run-out, 99 % of the mass", runout_max: "run-out, farthest point", area: "area covered now", reached: "area ever reached",
  depth_max: "largest depth", depth_mean: "mean depth", speed_max: "largest speed", speed_mean: "mean speed",
  inflow: "has come in", outflow: "has left", depth: "solid depth", pressure: "mean pressure",
};
const whole_names = {density: ["density", "kg/m³"], density_min: ["least density", "kg/m³"], density_max: ["largest density", "kg/m³"],
  momentum_x: ["momentum x", "kg/s"], momentum_y: ["momentum y", "kg/s"], angular_momentum: ["angular momentum", "kg m/s"]};

/// Which strain the columns eps_... hold, where all results say the same: "logarithmic".
let strain_measure = "";

/// "q_Pa" → {name: "q", unit: "kPa", factor: 1e-3}; "eps_a" → ε with subscript a, in %.
function label(column) {
  if (whole_names[column]) return made(whole_names[column][0], "", whole_names[column][1], 1);
  let base = column, unit = "", factor = 1;
  const found = units.find(([suffix]) => column.endsWith(suffix) && column.length > suffix.length);
  if (found) [base, unit, factor] = [column.slice(0, -found[0].length), found[1], found[2]];
  if (/(^|_)dt(_min|_max)?$/.test(base) && unit === "s") [unit, factor] = ["µs", 1e6];
  if (words[base]) return made(words[base], "", unit, factor);
  const [head, ...rest] = base.split("_");
  if (greek[head] && rest.length < 2) {
    if (!found && (head.endsWith("eps") || head === "gamma")) [unit, factor] = ["%", 100];
    if (unit === "%" && head === "eps" && strain_measure) unit = `${strain_measure}, %`;
    return made(greek[head], rest.join(" "), unit, factor);
  }
  if (head.length === 1 && rest.length === 1 && rest[0].length <= 3) return made(head, rest[0], unit, factor);
  return made(base.replaceAll("_", " "), "", unit, factor);
}
function made(name, sub, unit, factor) {
  return {name, sub, unit, factor, text: `${name}${sub ? "_" + sub : ""}${unit ? ` (${unit})` : ""}`, short: `${name}${sub ? "_" + sub : ""}`};
}
const html_label = (l) => [l.name, l.sub ? el("sub", {}, l.sub) : null, l.unit ? ` (${l.unit})` : null];
const svg_label = (l) => [
  svg("tspan", {}, l.name), l.sub ? svg("tspan", {dy: 4, "font-size": "10px"}, l.sub) : null,
  l.unit ? svg("tspan", {dy: l.sub ? -4 : 0}, ` (${l.unit})`) : null,
];
