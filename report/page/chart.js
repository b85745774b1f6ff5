// Curves in one pair of axes: read-out under the pointer, zoom, logarithmic axes, curves on and off.

const dashes = ["", "7 4", "2 3", "9 3 2 3"];
/// Each in steps from its middle.
const shapes = [
  "M-4 0a4 4 0 1 0 8 0a4 4 0 1 0-8 0Z", "M-3.6-3.6h7.2v7.2h-7.2Z", "M0-4.6l4.3 8h-8.6Z", "M0-5l4.4 5-4.4 5-4.4-5Z",
  "M0 4.6l-4.3-8h8.6Z", "M-4-1.4h2.6v-2.6h2.8v2.6h2.6v2.8h-2.6v2.6h-2.8v-2.6h-2.6Z",
];
const colour_of = (k) => `var(--c${k % 7})`;
/// Of bodies, in the order of the pictures (colour_of_body): vermillion is for what is looked at.
const colour_of_body = (k) => `--c${[0, 4, 2, 3, 5][k % 5]}`;
/// Neighbours differ in colour, dash and mark, so that no one of the three is needed.
function look(series) {
  const k = series.style;
  return {colour: colour_of(k), dash: dashes[k % 4], shape: shapes[k % 6]};
}
function swatch(series) {
  const {colour, dash, shape} = look(series);
  return svg("svg", {width: 26, height: 12, viewBox: "0 0 26 12", "aria-hidden": "true"},
    series.line === false ? null : svg("path", {d: "M1 6H25", style: `stroke:${colour}`, "stroke-width": 2.2, "stroke-dasharray": dash}),
    series.marks ? svg("path", {d: shape, transform: "translate(13 6)", style: `fill:${colour}`}) : null);
}

function linear_ticks(lower, upper, most) {
  const raw = (upper - lower) / Math.max(most, 1);
  const size = 10 ** Math.floor(Math.log10(raw));
  const step = size * ([1, 2, 5, 10].find((m) => m * size >= raw * 0.999) ?? 10);
  const ticks = [];
  for (let i = Math.ceil(lower / step - 1e-9); i * step <= upper + 1e-9 * step; ++i) ticks.push(i * step);
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  const far = Math.max(Math.abs(lower), Math.abs(upper));
  return ticks.map((value) => ({value, text: far >= 1e6 || far < 1e-3 ? number(value, 3) : group(value.toFixed(Math.min(digits, 8))).replace(/^−0(\.0*)?$/, "0")}));
}
function log_ticks(lower, upper, most) {
  const first = Math.ceil(lower - 1e-9), last = Math.floor(upper + 1e-9);
  if (last - first < 2) {
    const factors = upper - lower > 1 ? [1, 2, 5] : [1, 1.5, 2, 3, 4, 5, 7];
    const ticks = [];
    for (let e = Math.floor(lower); e <= upper; ++e)
      for (const m of factors) {
        const at = e + Math.log10(m);
        if (at >= lower - 1e-9 && at <= upper + 1e-9) ticks.push({value: at, text: number(m * 10 ** e, 3)});
      }
    return ticks;
  }
  const step = Math.max(1, Math.ceil((last - first) / Math.max(most, 1)));
  const ticks = [];
  for (let e = first; e <= last; ++e)
    if ((e - first) % step === 0) ticks.push({value: e, text: Math.abs(e) <= 2 ? number(10 ** e) : `10${power(e)}`});
  return ticks;
}

/// spec: {title, x, y: {label, log}, series: [{name, x, y, style, line, marks, step}], equal, time}
/// Labels as of label(); equal: one metre is as long on both axes; time: x is the time of the run.
class Chart {
  constructor(spec) {
    this.spec = spec;
    this.log = {x: Boolean(spec.x.log), y: Boolean(spec.y.log)};
    this.off = new Set();
    this.zoom = null;
    for (const s of spec.series) {
      s.rising = true;
      for (let i = 1; i < s.x.length && s.rising; ++i) s.rising = !(s.x[i] < s.x[i - 1]);
    }
    this.build();
    Chart.all.push(this);
  }

  build() {
    const tool = (text, title, press) => el("button", {type: "button", class: "switch", title, "aria-pressed": "false", onclick: press}, text);
    const toggle = (axis) => { this.log[axis] = !this.log[axis]; this.zoom = null; this.draw(); };
    this.tools = {
      reset: el("button", {type: "button", title: "Show everything again (double click)", onclick: () => this.reset()}, "reset"),
      x: tool("log x", "Logarithmic horizontal axis", () => toggle("x")),
      y: tool("log y", "Logarithmic vertical axis", () => toggle("y")),
    };
    this.plot = svg("svg", {class: "plot", tabindex: 0, role: "img"});
    this.tip = el("div", {class: "tip", role: "status", hidden: ""});
    this.note = el("p", {class: "note", hidden: ""});
    this.legend = el("div", {class: "legend", role: "group", "aria-label": "Curves"});
    if (this.spec.series.length > 1 || this.spec.always_name)
      this.spec.series.forEach((s) => this.legend.append(this.legend_button(s)));
    this.element = el("figure", {class: "chart"},
      el("div", {class: "head"}, el("h3", {}, this.spec.title), el("div", {class: "tools"}, Object.values(this.tools))),
      this.plot, this.legend, this.note, this.tip);
    this.listen();
    redraw_with_width(this.element, () => this.draw());
  }

  legend_button(s) {
    return el("button", {
      type: "button", "aria-pressed": "true", title: "Show or hide; double click: only this one",
      onclick: (event) => {
        if (event.detail === 2) {
          this.spec.series.forEach((other) => (other === s ? this.off.delete(other) : this.off.add(other)));
        } else if (this.off.has(s)) this.off.delete(s);
        else this.off.add(s);
        if (this.off.size === this.spec.series.length) this.off.clear();
        this.draw();
      },
    }, swatch(s), s.name);
  }

  visible() { return this.spec.series.filter((s) => !this.off.has(s)); }
  reset() { this.zoom = null; this.hide(); this.draw(); }

  /// On a logarithmic axis what is not positive has no place.
  to(axis, value) { return this.log[axis] ? (value > 0 ? Math.log10(value) : NaN) : value; }

  range(axis) {
    let lower = Infinity, upper = -Infinity, left_out = 0;
    for (const s of this.visible())
      for (const value of s[axis]) {
        const v = this.to(axis, value);
        if (v < lower) lower = v;
        if (v > upper) upper = v;
        if (this.log[axis] && value <= 0) ++left_out;
      }
    if (!(lower <= upper) || !Number.isFinite(lower + upper)) [lower, upper] = this.log[axis] ? [0, 1] : [0, 1];
    if (lower === upper) {
      const room = this.log[axis] ? 0.5 : Math.abs(lower) * 0.05 || 1;
      [lower, upper] = [lower - room, upper + room];
    }
    const room = 0.04 * (upper - lower);
    if (!this.log[axis] && lower >= 0 && lower < 0.25 * upper) return {lower: 0, upper: upper + room, left_out};
    const flush = axis === "x" && this.visible().every((s) => s.rising && !s.marks);
    return {lower: lower - (flush ? 0 : room), upper: upper + (flush ? 0 : room), left_out};
  }

  draw() {
    const width = this.element.clientWidth;
    if (width < 50) return;
    const x = this.range("x"), y = this.range("y");
    const left_out = x.left_out + y.left_out;
    let height = this.spec.height ?? Math.round(Math.min(Math.max(0.62 * width, 230), 330));
    const box = this.zoom ?? {x: [x.lower, x.upper], y: [y.lower, y.upper]};
    const y_ticks = (this.log.y ? log_ticks : linear_ticks)(...box.y, 5);
    const left = 30 + 7 * Math.max(...y_ticks.map((t) => t.text.length), 1);
    const room = {left, right: 12, top: 8, bottom: 42};
    const inner = width - room.left - room.right;
    if (this.spec.equal && !this.zoom) {
      const scale = (inner / (box.x[1] - box.x[0])) * (box.y[1] - box.y[0]);
      height = Math.round(Math.min(Math.max(scale, 60), 420)) + room.top + room.bottom;
    }
    const x_ticks = (this.log.x ? log_ticks : linear_ticks)(...box.x, Math.max(2, Math.floor(inner / 75)));
    const tall = height - room.top - room.bottom;
    const px = (v) => room.left + ((v - box.x[0]) / (box.x[1] - box.x[0])) * inner;
    const py = (v) => room.top + (1 - (v - box.y[0]) / (box.y[1] - box.y[0])) * tall;
    this.place = {px, py, inner, tall, room, box, height, width};

    const clip = (this.clip ??= `clip${Chart.all.length}_${Math.random().toString(36).slice(2, 8)}`);
    const grid = [];
    for (const t of x_ticks)
      grid.push(svg("line", {class: "grid", x1: px(t.value), x2: px(t.value), y1: room.top, y2: room.top + tall}),
        svg("text", {x: px(t.value), y: room.top + tall + 16, "text-anchor": "middle"}, t.text));
    for (const t of y_ticks)
      grid.push(svg("line", {class: "grid", x1: room.left, x2: room.left + inner, y1: py(t.value), y2: py(t.value)}),
        svg("text", {x: room.left - 6, y: py(t.value) + 4, "text-anchor": "end"}, t.text));
    const curves = this.visible().map((s) => this.curve(s));
    this.now_line = svg("line", {class: "now", y1: room.top, y2: room.top + tall, visibility: "hidden"});
    this.cursor = svg("g", {});
    this.band = svg("rect", {class: "box", visibility: "hidden"});
    this.plot.setAttribute("height", height);
    this.plot.setAttribute("viewBox", `0 0 ${width} ${height}`);
    this.plot.setAttribute("aria-label", this.words(x, y));
    this.plot.replaceChildren(
      svg("clipPath", {id: clip}, svg("rect", {x: room.left, y: room.top, width: inner, height: tall})),
      ...grid, svg("rect", {class: "frame", x: room.left, y: room.top, width: inner, height: tall}),
      svg("text", {class: "name", x: room.left + inner / 2, y: height - 6, "text-anchor": "middle"}, svg_label(this.spec.x.label)),
      svg("text", {class: "name", transform: `translate(13 ${room.top + tall / 2}) rotate(-90)`, "text-anchor": "middle"}, svg_label(this.spec.y.label)),
      svg("g", {"clip-path": `url(#${clip})`}, curves, this.now_line), this.cursor, this.band);
    this.show_time(Chart.time);
    for (const axis of ["x", "y"]) this.tools[axis].setAttribute("aria-pressed", String(this.log[axis]));
    this.tools.reset.style.visibility = this.zoom ? "visible" : "hidden";
    [...this.legend.children].forEach((b, i) => b.setAttribute("aria-pressed", String(!this.off.has(this.spec.series[i]))));
    this.note.hidden = left_out === 0 && !this.spec.note;
    this.note.textContent = [this.spec.note, left_out ? `${left_out} values at or below zero have no place on a logarithmic axis.` : ""].filter(Boolean).join(" ");
  }

  curve(s) {
    const {px, py} = this.place, {colour, dash, shape} = look(s);
    const parts = [];
    let path = "", pen = false, before = 0;
    const marks = [];
    for (let i = 0; i < s.x.length; ++i) {
      const x = px(this.to("x", s.x[i])), y = py(this.to("y", s.y[i]));
      if (!Number.isFinite(x) || !Number.isFinite(y)) { pen = false; continue; }
      const at = `${x.toFixed(1)} ${y.toFixed(1)}`;
      path += pen ? (s.step ? `L${x.toFixed(1)} ${before.toFixed(1)}L${at}` : `L${at}`) : `M${at}`;
      if (s.marks) marks.push(`M${at}m${shape.slice(1)}`);
      pen = true;
      before = y;
    }
    if (s.line !== false)
      parts.push(svg("path", {d: path, fill: "none", style: `stroke:${colour}`, "stroke-width": 2, "stroke-dasharray": dash, "stroke-linejoin": "round", "stroke-linecap": dash ? "butt" : "round"}));
    if (s.marks) parts.push(svg("path", {d: marks.join(""), style: `fill:${colour};stroke:var(--page)`, "stroke-width": 0.8}));
    return svg("g", {class: "curve"}, parts);
  }

  /// For those who do not see the curves.
  words(x, y) {
    const ends = (axis, r) => `${this.spec[axis].label.text} from ${number(this.log[axis] ? 10 ** r.lower : r.lower)} to ${number(this.log[axis] ? 10 ** r.upper : r.upper)}`;
    return `${this.spec.title}: ${ends("y", y)} over ${ends("x", x)}; ${this.visible().map((s) => s.name).join(", ")}. Arrow keys read values, plus and minus zoom, Escape resets.`;
  }

  show_time(time) {
    if (!this.spec.time || time === null || !this.now_line || !this.place) return;
    const at = this.place.px(this.to("x", time));
    const inside = Number.isFinite(at) && at >= this.place.room.left - 1 && at <= this.place.room.left + this.place.inner + 1;
    this.now_line.setAttribute("visibility", inside ? "visible" : "hidden");
    if (inside) { this.now_line.setAttribute("x1", at); this.now_line.setAttribute("x2", at); }
  }

  /// The point that is nearest: along x if every curve is a function of it, else on the screen.
  nearest(mx, my) {
    const {px, py} = this.place;
    const functions = this.visible().every((s) => s.rising && !s.scattered);
    const hits = [];
    for (const s of this.visible()) {
      let best = null;
      for (let i = 0; i < s.x.length; ++i) {
        const x = px(this.to("x", s.x[i])), y = py(this.to("y", s.y[i]));
        if (!Number.isFinite(x) || !Number.isFinite(y)) continue;
        const far = functions ? Math.abs(x - mx) : Math.hypot(x - mx, y - my);
        if (!best || far < best.far) best = {s, i, x, y, far};
      }
      if (best) hits.push(best);
    }
    if (hits.length === 0) return [];
    if (functions) {
      // curves that are not sampled at the place of the nearest one say nothing there
      const at = hits.reduce((a, b) => (b.far < a.far ? b : a));
      return hits.filter((h) => Math.abs(h.x - at.x) < 6).sort((a, b) => Math.abs(a.y - my) - Math.abs(b.y - my));
    }
    return [hits.reduce((a, b) => (b.far < a.far ? b : a))];
  }

  show(mx, my) {
    const hits = this.nearest(mx, my);
    if (hits.length === 0) return;
    this.at = hits[0];
    const {room, tall} = this.place;
    this.cursor.replaceChildren(
      svg("line", {class: "cross", x1: hits[0].x, x2: hits[0].x, y1: room.top, y2: room.top + tall}),
      ...hits.slice(0, 8).map((h) => svg("circle", {cx: h.x, cy: h.y, r: 4.5, style: `fill:${look(h.s).colour};stroke:var(--page)`, "stroke-width": 1.5})));
    const y = this.spec.y.label, x = this.spec.x.label;
    const quantity = (l, value) => [" ", number(value), l.unit ? ` ${l.unit}` : ""];
    this.tip.replaceChildren(
      el("div", {}, el("span", {}, x.name, x.sub ? el("sub", {}, x.sub) : null), el("b", {}, quantity(x, hits[0].s.x[hits[0].i]))),
      ...hits.slice(0, 8).map((h) => el("div", {}, el("span", {class: "who"}, swatch(h.s), h.s.name), el("b", {}, quantity(y, h.s.y[h.i])))),
      hits.length > 8 ? el("div", {}, `and ${hits.length - 8} more`) : "");
    this.tip.hidden = false;
    const top = this.plot.offsetTop + Math.min(Math.max(hits[0].y - 20, 0), this.place.height - 60);
    const wide = this.tip.offsetWidth;
    const beside = hits[0].x + 14 + wide < this.place.width ? hits[0].x + 14 : Math.max(0, hits[0].x - 14 - wide);
    this.tip.style.left = `${beside}px`;
    this.tip.style.top = `${top}px`;
  }
  hide() { this.tip.hidden = true; this.at = null; this.cursor?.replaceChildren(); }

  /// Zooms by a factor about a place on the screen.
  scale(factor, mx, my) {
    const {box, room, inner, tall} = this.place;
    const about = (range, share) => { const at = range[0] + share * (range[1] - range[0]); return [at + (range[0] - at) * factor, at + (range[1] - at) * factor]; };
    this.zoom = {x: about(box.x, (mx - room.left) / inner), y: about(box.y, 1 - (my - room.top) / tall)};
    this.draw();
  }

  zoom_to(x0, y0, x1, y1) {
    const {box, room, inner, tall} = this.place;
    const bx = (p) => box.x[0] + ((p - room.left) / inner) * (box.x[1] - box.x[0]);
    const by = (p) => box.y[0] + (1 - (p - room.top) / tall) * (box.y[1] - box.y[0]);
    this.zoom = {x: [bx(Math.min(x0, x1)), bx(Math.max(x0, x1))], y: [by(Math.max(y0, y1)), by(Math.min(y0, y1))]};
    this.hide();
    this.draw();
  }

  listen() {
    const plot = this.plot, fingers = new Map();
    let from = null, pinch = 0;
    const where = (e) => { const r = plot.getBoundingClientRect(); return [e.clientX - r.left, e.clientY - r.top]; };
    const inside = ([x, y]) => {
      const {room, inner, tall} = this.place;
      return [Math.min(Math.max(x, room.left), room.left + inner), Math.min(Math.max(y, room.top), room.top + tall)];
    };
    const spread = () => { const [a, b] = [...fingers.values()]; return Math.hypot(a[0] - b[0], a[1] - b[1]); };
    plot.addEventListener("pointerdown", (e) => {
      if (!this.place) return;
      const at = where(e);
      if (e.pointerType === "touch") {
        fingers.set(e.pointerId, at);
        if (fingers.size === 2) pinch = spread();
        this.show(...at);
      } else if (e.button === 0) {
        from = inside(at);
        plot.setPointerCapture(e.pointerId);
      }
    });
    plot.addEventListener("pointermove", (e) => {
      if (!this.place) return;
      const at = where(e);
      if (fingers.has(e.pointerId)) {
        fingers.set(e.pointerId, at);
        if (fingers.size === 2 && spread() > 10) {
          const [a, b] = [...fingers.values()];
          this.scale(pinch / spread(), (a[0] + b[0]) / 2, (a[1] + b[1]) / 2);
          pinch = spread();
          return;
        }
      }
      if (from) {
        const to = inside(at);
        for (const [k, v] of Object.entries({x: Math.min(from[0], to[0]), y: Math.min(from[1], to[1]), width: Math.abs(to[0] - from[0]), height: Math.abs(to[1] - from[1]), visibility: "visible"}))
          this.band.setAttribute(k, v);
      }
      this.show(...at);
    });
    const up = (e) => {
      fingers.delete(e.pointerId);
      if (!from) return;
      const to = inside(where(e)), [x, y] = from;
      from = null;
      this.band.setAttribute("visibility", "hidden");
      if (Math.abs(to[0] - x) > 6 && Math.abs(to[1] - y) > 6) this.zoom_to(x, y, ...to);
    };
    plot.addEventListener("pointerup", up);
    plot.addEventListener("pointercancel", (e) => { fingers.delete(e.pointerId); from = null; this.band?.setAttribute("visibility", "hidden"); });
    plot.addEventListener("pointerleave", (e) => { if (e.pointerType !== "touch") this.hide(); });
    plot.addEventListener("dblclick", () => this.reset());
    plot.addEventListener("blur", () => this.hide());
    plot.addEventListener("keydown", (e) => this.key(e));
  }

  key(e) {
    const {room, inner, tall, px, py} = this.place;
    const centre = this.at ? [this.at.x, this.at.y] : [room.left + inner / 2, room.top + tall / 2];
    if (e.key === "Escape" || e.key === "0") this.reset();
    else if (e.key === "+" || e.key === "=") this.scale(0.6, ...centre);
    else if (e.key === "-") this.scale(1 / 0.6, ...centre);
    else if (e.key === "ArrowLeft" || e.key === "ArrowRight") {
      const s = this.at?.s ?? this.visible()[0];
      if (!s) return;
      const step = (e.key === "ArrowLeft" ? -1 : 1) * Math.max(1, Math.round(s.x.length / 100));
      const i = Math.min(Math.max((this.at?.i ?? 0) + (this.at ? step : 0), 0), s.x.length - 1);
      this.show(px(this.to("x", s.x[i])), py(this.to("y", s.y[i])));
    } else return;
    e.preventDefault();
  }
}
Chart.all = [];
Chart.time = null;
Chart.set_time = (time) => { Chart.time = time; for (const chart of Chart.all) chart.show_time(time); };
