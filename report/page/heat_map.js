// Colours of a quantity, and maps over two of them.

// Viridis (Smith & van der Walt 2015, CC0) at 17 even steps: uniform in lightness, safe for every
// kind of colour blindness and in grey.
const viridis = ["440154", "48186a", "472d7b", "424086", "3b528b", "33638d", "2c728e", "26818e", "21908c",
  "1f9f88", "28ae80", "3ebc74", "5dc963", "82d34c", "abdc32", "d5e21a", "fde725"]
  .map((hex) => [0, 2, 4].map((i) => parseInt(hex.slice(i, i + 2), 16)));
const is_dark = () => matchMedia("(prefers-color-scheme: dark)").matches;
/// share 0 … 1. Its darkest tenth would sink into a dark page, its palest into a white one.
function shade(share, dark = is_dark()) {
  const [first, last] = dark ? [0.14, 1] : [0, 0.94];
  const at = (first + (last - first) * Math.min(Math.max(share, 0), 1)) * (viridis.length - 1);
  const i = Math.min(Math.floor(at), viridis.length - 2);
  return `rgb(${viridis[i].map((c, k) => Math.round(c + (at - i) * (viridis[i + 1][k] - c))).join(" ")})`;
}
const ramp = () => `linear-gradient(90deg, ${Array.from({length: 17}, (_, i) => shade(i / 16)).join(", ")})`;
const no_number = "#ff2fd0";  // not on the scale, so that it is seen

/// Cell edges half way between neighbours.
function edges_of(values, log) {
  const v = values.map((x) => (log ? Math.log10(x) : x));
  if (v.length === 1) return [v[0] - 0.5, v[0] + 0.5];
  const edges = [v[0] - (v[1] - v[0]) / 2];
  for (let i = 0; i + 1 < v.length; ++i) edges.push((v[i] + v[i + 1]) / 2);
  edges.push(v.at(-1) + (v.at(-1) - v.at(-2)) / 2);
  return edges;
}
const distinct = (values) => [...new Set(values)].filter(Number.isFinite).sort((a, b) => a - b);
const by_decades = (sorted) => sorted.length > 3 && sorted[0] > 0 && sorted.at(-1) / sorted[0] > 100 && sorted[1] - sorted[0] < 0.5 * (sorted.at(-1) - sorted.at(-2));

/// spec: {title, x, y: label, layers: [{z: label, at: [[x, y, z], …]}]}, z a number or a word; with
/// several layers the reader chooses.
class HeatMap {
  constructor(spec) {
    this.spec = spec;
    this.plot = svg("svg", {class: "plot", tabindex: 0, role: "img"});
    this.tip = el("div", {class: "tip", role: "status", hidden: ""});
    this.key_row = el("div", {class: "row"});
    this.log_button = el("button", {type: "button", class: "switch", title: "Logarithmic colours", onclick: () => { this.log = !this.log; this.draw(); }}, "log colours");
    this.choice = spec.layers.length < 2 ? null : el("select", {"aria-label": "Quantity of the map", onchange: () => { this.choose(Number(this.choice.value)); this.draw(); }},
      spec.layers.map((layer, i) => el("option", {value: i}, layer.z.short)));
    this.element = el("figure", {class: "chart"},
      el("div", {class: "head"}, el("h3", {}, spec.title), el("div", {class: "tools"}, this.choice, this.log_button)),
      this.plot, this.key_row, this.tip);
    this.xs = distinct(spec.layers[0].at.map((c) => c[0]));
    this.ys = distinct(spec.layers[0].at.map((c) => c[1]));
    this.hatch = `hatch${HeatMap.all.length}`;
    this.choose(0);
    this.plot.addEventListener("pointermove", (e) => { const r = this.plot.getBoundingClientRect(); this.show(this.cell_at(e.clientX - r.left, e.clientY - r.top)); });
    this.plot.addEventListener("pointerleave", () => this.hide());
    this.plot.addEventListener("blur", () => this.hide());
    this.plot.addEventListener("keydown", (e) => this.key(e));
    redraw_with_width(this.element, () => this.draw());
    on_theme(() => this.draw());
    HeatMap.all.push(this);
  }

  choose(layer) {
    ({z: this.z, at: this.values} = this.spec.layers[layer]);
    this.words_of = this.values.some((c) => typeof c[2] === "string") ? [...new Set(this.values.map((c) => c[2]))] : null;
    this.numbers = this.words_of ? [] : distinct(this.values.map((c) => c[2]));
    this.log = by_decades(this.numbers.filter((z) => z > 0));
    this.log_button.style.display = this.words_of ? "none" : "";
    this.hide();
  }

  colour(z) {
    if (this.words_of) return colour_of(this.words_of.indexOf(z));
    const v = this.log ? Math.log10(z) : z;
    return Number.isFinite(v) && (!this.log || z > 0) ? shade((v - this.low) / (this.high - this.low || 1)) : `url(#${this.hatch})`;
  }

  draw() {
    const width = this.element.clientWidth;
    if (width < 50) return;
    const usable = this.log ? this.numbers.filter((z) => z > 0) : this.numbers;
    [this.low, this.high] = usable.length ? [usable[0], usable.at(-1)].map((z) => (this.log ? Math.log10(z) : z)) : [0, 1];
    const log_x = by_decades(this.xs), log_y = by_decades(this.ys);
    const ex = edges_of(this.xs, log_x), ey = edges_of(this.ys, log_y);
    const height = Math.round(Math.min(Math.max(0.72 * width, 240), 380));
    const y_ticks = (log_y ? log_ticks : linear_ticks)(Math.min(...ey), Math.max(...ey), 5);
    const room = {left: 30 + 7 * Math.max(...y_ticks.map((t) => t.text.length), 1), right: 12, top: 8, bottom: 42};
    const inner = width - room.left - room.right, tall = height - room.top - room.bottom;
    const x_ticks = (log_x ? log_ticks : linear_ticks)(ex[0], ex.at(-1), Math.max(2, Math.floor(inner / 75)));
    const px = (v) => room.left + ((v - ex[0]) / (ex.at(-1) - ex[0])) * inner;
    const py = (v) => room.top + (1 - (v - ey[0]) / (ey.at(-1) - ey[0])) * tall;
    this.cells = this.values.filter((c) => Number.isFinite(c[0]) && Number.isFinite(c[1])).map((c) => {
      const i = this.xs.indexOf(c[0]), j = this.ys.indexOf(c[1]);
      return {c, x: px(ex[i]), y: py(ey[j + 1]), w: px(ex[i + 1]) - px(ex[i]), h: py(ey[j]) - py(ey[j + 1])};
    });
    this.cursor = svg("rect", {fill: "none", style: "stroke:var(--ink)", "stroke-width": 2, visibility: "hidden"});
    this.plot.setAttribute("height", height);
    this.plot.setAttribute("viewBox", `0 0 ${width} ${height}`);
    const z = this.z;
    this.plot.setAttribute("aria-label", `${this.spec.title}: map of ${z.text} over ${this.spec.x.text} and ${this.spec.y.text}. Arrow keys read its cells.`);
    this.plot.replaceChildren(
      svg("pattern", {id: this.hatch, width: 6, height: 6, patternUnits: "userSpaceOnUse", patternTransform: "rotate(45)"}, svg("rect", {width: 6, height: 6, style: "fill:var(--page)"}), svg("rect", {width: 2, height: 6, fill: no_number})),
      svg("g", {"shape-rendering": "crispEdges"}, this.cells.map((r) => svg("rect", {x: r.x, y: r.y, width: r.w + 0.6, height: r.h + 0.6, style: `fill:${this.colour(r.c[2])}`}))),
      ...x_ticks.map((t) => svg("text", {x: px(t.value), y: room.top + tall + 16, "text-anchor": "middle"}, t.text)),
      ...y_ticks.map((t) => svg("text", {x: room.left - 6, y: py(t.value) + 4, "text-anchor": "end"}, t.text)),
      svg("rect", {class: "frame", x: room.left, y: room.top, width: inner, height: tall}),
      svg("text", {class: "name", x: room.left + inner / 2, y: height - 6, "text-anchor": "middle"}, svg_label(this.spec.x)),
      svg("text", {class: "name", transform: `translate(13 ${room.top + tall / 2}) rotate(-90)`, "text-anchor": "middle"}, svg_label(this.spec.y)),
      this.cursor);
    const end = (v) => number(this.log ? 10 ** v : v, 3);
    const strange = this.words_of ? 0 : this.values.filter((c) => !Number.isFinite(c[2]) || (this.log && c[2] <= 0)).length;
    this.key_row.replaceChildren(...(this.words_of
      ? this.words_of.map((w) => el("span", {class: "note"}, box_of(this.colour(w)), ` ${w || "(empty)"}`))
      : [el("div", {class: "scale"}, el("span", {}, z.text), el("span", {}, end(this.low)), el("span", {class: "ramp", style: `background:${ramp()}`}), el("span", {}, end(this.high))),
        strange ? el("span", {class: "note"}, box_of(`repeating-linear-gradient(135deg, ${no_number} 0 2px, transparent 2px 5px)`), ` not on the scale: ${strange} of ${this.values.length}`) : null].filter(Boolean)));
    this.log_button.setAttribute("aria-pressed", String(Boolean(this.log)));
  }

  cell_at(x, y) { return this.cells?.find((r) => x >= r.x && x < r.x + r.w && y >= r.y && y < r.y + r.h); }
  show(cell) {
    if (!cell) return this.hide();
    this.at = cell;
    for (const [k, v] of Object.entries({x: cell.x, y: cell.y, width: cell.w, height: cell.h, visibility: "visible"})) this.cursor.setAttribute(k, v);
    const line = (l, v) => el("div", {}, el("span", {}, l.name, l.sub ? el("sub", {}, l.sub) : null), el("b", {}, typeof v === "string" ? v : `${number(v)}${l.unit ? " " + l.unit : ""}`));
    this.tip.replaceChildren(line(this.spec.x, cell.c[0]), line(this.spec.y, cell.c[1]), line(this.z, cell.c[2]));
    this.tip.hidden = false;
    const wide = this.tip.offsetWidth, right = cell.x + cell.w + 10;
    this.tip.style.left = `${right + wide < this.element.clientWidth ? right : Math.max(0, cell.x - wide - 10)}px`;
    this.tip.style.top = `${this.plot.offsetTop + cell.y}px`;
  }
  hide() { this.tip.hidden = true; this.at = null; this.cursor?.setAttribute("visibility", "hidden"); }
  key(e) {
    const step = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1]}[e.key];
    if (!step || !this.cells?.length) return;
    e.preventDefault();
    const from = (this.at ?? this.cells[0]).c;
    const i = this.xs.indexOf(from[0]) + (this.at ? step[0] : 0), j = this.ys.indexOf(from[1]) + (this.at ? step[1] : 0);
    const next = this.cells.find((r) => r.c[0] === this.xs[i] && r.c[1] === this.ys[j]);
    if (next) this.show(next);
  }
}
HeatMap.all = [];
const box_of = (colour) => el("span", {style: `display:inline-block;width:12px;height:12px;border-radius:3px;vertical-align:-1px;background:${colour}`, "aria-hidden": "true"});
