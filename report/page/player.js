// The collapse: frames of points on a canvas, one slider for all runs.

/// runs: [{label, style, frames, domain: [w, h] or null, tilt, spacing, marks, tracks}]; marks: what stands around the points
/// (scene_marks.hpp) or null, tracks: where tracers went, [{name, time, x, y}].
class Player {
  constructor(runs) {
    this.runs = runs.map((run) => ({...run, ...Player.unpack(run.frames)}));
    this.times = [...new Set(this.runs.flatMap((r) => r.frames.times))].sort((a, b) => a - b);
    this.names = [...new Set(this.runs.flatMap((r) => r.frames.fields.map((f) => f.name)))].sort(
      (a, b) => Player.rank(a) - Player.rank(b));
    this.field = this.names[0] ?? null;
    this.at = 0;
    this.build();
    this.seek(this.liveliest());
    Player.all.push(this);
  }

  /// Bodies where there are several, as in final.svg; then speed, it shows the collapse; then what the law knows.
  static rank(name) {
    const order = ["body", "velocity_m_per_s", "pressure_Pa", "density_kg_per_m3", "mises_Pa"];
    return order.includes(name) ? order.indexOf(name) : order.length;
  }

  static unpack(frames) {
    const bytes = bytes_of(frames.xy);
    const places = new Uint16Array(bytes.length / 2);
    for (let i = 0; i < places.length; ++i) places[i] = bytes[2 * i] | (bytes[2 * i + 1] << 8);
    const starts = [0];
    for (const n of frames.counts) starts.push(starts.at(-1) + n);
    return {places, starts, codes: new Map(frames.fields.map((f) => [f.name, bytes_of(f.codes)]))};
  }

  build() {
    this.stages = this.runs.map((run) => {
      const canvas = el("canvas", {role: "img"});
      const tip = el("div", {class: "tip", hidden: ""});
      run.canvas = canvas;
      canvas.addEventListener("pointermove", (e) => this.read(run, tip, e));
      canvas.addEventListener("pointerleave", () => { tip.hidden = true; });
      return el("figure", {class: "stage"}, this.runs.length > 1 ? el("figcaption", {}, swatch({style: run.style}), run.label) : null, canvas, tip);
    });
    this.button = el("button", {type: "button", class: "play", onclick: () => this.toggle()}, "▶ Play");
    this.slider = el("input", {
      type: "range", min: 0, max: this.times.length - 1, step: 1, value: 0, "aria-label": "Time of the run",
      oninput: () => { this.stop(); this.seek(Number(this.slider.value)); },
      onkeydown: (e) => { if (e.key === " ") { e.preventDefault(); this.toggle(); } },
    });
    this.clock = el("output", {});
    this.select = el("select", {onchange: () => { this.field = this.select.value; this.draw(); }},
      this.names.map((n) => el("option", {value: n}, label(n).text)));
    this.low = el("span", {});
    this.high = el("span", {});
    this.ramp = el("span", {class: "ramp"});
    this.scale = el("div", {class: "scale"}, this.low, this.ramp, this.high);
    this.bodies = el("div", {class: "marks", hidden: ""});
    this.note = el("p", {class: "note"}, this.notes());
    this.element = el("div", {class: "player"},
      el("div", {class: this.runs.length > 1 ? "stages many" : "stages"}, this.stages),
      el("div", {class: "controls"}, this.button, this.slider, this.clock),
      el("div", {class: "controls"}, this.names.length ? el("label", {}, "Colour", this.select) : null, this.scale, this.bodies),
      this.probe_names(), this.note);
    redraw_with_width(this.element, () => this.draw());
    on_theme(() => this.draw());
  }

  /// The numbers of the probes in the picture, once where all runs have the same.
  probe_names() {
    const lists = this.runs.map((run) => run.marks?.probes.map((p) => p.name) ?? []);
    const same = lists.every((list) => list.join() === lists[0].join());
    return (same ? lists.slice(0, 1) : lists).map((list, k) => (list.length === 0 ? null : el("p", {class: "marks"},
      el("span", {}, same ? "Probes" : `Probes of ${this.runs[k].label}`), list.map((name, i) => el("span", {}, el("b", {}, `${i + 1}`), ` ${name}`)))));
  }

  /// The moment with most speed, or of what there is most of the first field: the page opens with motion.
  liveliest() {
    if (this.field === null) return 0;
    const field = this.names.find((name) => name.startsWith("velocity")) ?? this.field;
    const run = this.runs.find((r) => r.codes.has(field)), codes = run.codes.get(field);
    const mean = run.frames.times.map((_, k) => {
      let sum = 0;
      for (let i = run.starts[k]; i < run.starts[k + 1]; ++i) sum += codes[i] === 255 ? 0 : codes[i];
      return sum / (run.starts[k + 1] - run.starts[k] || 1);
    });
    return this.times.indexOf(run.frames.times[mean.indexOf(Math.max(...mean))]);
  }

  notes() {
    const lines = [];
    for (const {label: name, frames, marks} of this.runs) {
      const who = this.runs.length > 1 ? `${name}: ` : "";
      const shown = Math.max(...frames.counts);
      if (shown < frames.most_points) lines.push(`${who}${number(shown)} of ${number(frames.most_points)} points are drawn, evenly chosen.`);
      if (frames.times.length < frames.all_frames) lines.push(`${who}${frames.times.length} of ${frames.all_frames} frames are here, evenly chosen.`);
      if (frames.lost) lines.push(`${who}${frames.lost} values are no finite number and are drawn in magenta, or not at all where they are places.`);
      if (marks?.plan) lines.push(`${who}the flow is seen from above, north up; contours are those of the ground, what was released is dashed.`);
      if (frames.depth) lines.push(`${who}the points are seen along z.`);
    }
    return lines.join(" ");
  }

  /// The last frame of a run that is not later than the slider.
  frame_of(run) {
    const time = this.times[this.at];
    let k = 0;
    while (k + 1 < run.frames.times.length && run.frames.times[k + 1] <= time) ++k;
    return k;
  }

  seek(at) {
    this.at = at;
    this.slider.value = at;
    const time = this.times[at];
    this.clock.textContent = `${time.toFixed(this.digits())} s`;
    this.slider.setAttribute("aria-valuetext", `${number(time)} seconds`);
    this.draw();
    Chart.set_time(time);
  }
  digits() {
    const step = this.times.length > 1 ? (this.times.at(-1) - this.times[0]) / (this.times.length - 1) : 1;
    return Math.min(Math.max(Math.ceil(-Math.log10(step) + 0.7), 0), 6);
  }

  toggle() { if (this.timer) this.stop(); else this.play(); }
  play() {
    if (this.at === this.times.length - 1) this.seek(0);
    this.button.textContent = "❚❚ Pause";
    // about four seconds, whatever the number of frames
    const wait = 1000 / Math.min(Math.max(this.times.length / 4, 6), 30);
    this.timer = setInterval(() => {
      if (this.at + 1 >= this.times.length) return this.stop();
      this.seek(this.at + 1);
    }, wait);
  }
  stop() {
    clearInterval(this.timer);
    this.timer = null;
    this.button.textContent = "▶ Play";
  }

  /// Common to all runs, so that a colour means the same in each.
  colours() {
    const fields = this.runs.map((r) => r.frames.fields.find((f) => f.name === this.field)).filter(Boolean);
    return {
      lower: Math.min(...fields.map((f) => f.lower)), upper: Math.max(...fields.map((f) => f.upper)),
      least: Math.min(...fields.map((f) => f.least)), largest: Math.max(...fields.map((f) => f.largest)),
    };
  }

  draw() {
    if (!this.element.clientWidth) return;
    const range = this.field === null ? null : this.colours();
    const by_body = this.field === "body";
    this.scale.hidden = by_body;
    this.bodies.hidden = !by_body;
    if (by_body) {
      const most = this.runs.reduce((a, run) => ((run.marks?.bodies.length ?? 0) > (a?.length ?? 0) ? run.marks.bodies : a), null);
      const names = most ?? Array.from({length: range.largest + 1}, (_, k) => `body ${k + 1}`);
      this.bodies.replaceChildren(...names.slice(0, 24).map((name, k) => el("span", {}, el("i", {style: `background:var(${colour_of_body(k)})`}), name)), names.length > 24 ? `and ${names.length - 24} more` : "");
    } else if (range) {
      const {factor, unit} = label(this.field);
      this.low.textContent = `${range.least < range.lower ? "≤ " : ""}${number(factor * range.lower, 3)}`;
      this.high.textContent = `${range.largest > range.upper ? "≥ " : ""}${number(factor * range.upper, 3)}${unit ? " " + unit : ""}`;
      this.ramp.style.background = ramp();
    }
    for (const run of this.runs) this.paint(run, range);
  }

  box(run) {
    const [x0, x1] = run.frames.x, [y0, y1] = run.frames.y;
    if (!run.domain) return [x0, x1, y0, y1];
    if (run.marks?.plan) return [0, Math.max(run.domain[0], x1), Math.min(...run.marks.edges.map((e) => e.from[1])), run.marks.plan_height];
    // the air above the highest point is of no interest, unless something stands in it
    const tops = (run.marks?.surfaces ?? []).flatMap((s) => s.outlines.flat()).filter((o) => o.length).map((o) => Math.max(...o.map((p) => p[1])));
    const top = Math.max(1.12 * y1, ...tops, ...(run.marks?.probes ?? []).map((p) => 1.05 * p.place[1]));
    return [Math.min(0, x0), Math.max(run.domain[0], x1), Math.min(0, y0), Math.max(Math.min(run.domain[1], top), y1)];
  }

  paint(run, range) {
    const canvas = run.canvas, wide = canvas.clientWidth;
    if (!wide) return;
    const [x0, x1, y0, y1] = this.box(run);
    const margin = {left: 40, right: 18, top: 10, bottom: 26};
    let scale = (wide - margin.left - margin.right) / (x1 - x0);
    const tallest = Math.max(240, 0.62 * window.innerHeight);
    if (scale * (y1 - y0) > tallest) scale = tallest / (y1 - y0);
    const tall = Math.round(scale * (y1 - y0)) + margin.top + margin.bottom;
    const dpr = Math.min(window.devicePixelRatio || 1, 3);
    canvas.style.height = `${tall}px`;
    canvas.width = Math.round(wide * dpr);
    canvas.height = Math.round(tall * dpr);
    const c = canvas.getContext("2d");
    c.setTransform(dpr, 0, 0, dpr, 0, 0);
    const left = margin.left + Math.max(0, (wide - margin.left - margin.right - scale * (x1 - x0)) / 2);
    const px = (x) => left + (x - x0) * scale, py = (y) => tall - margin.bottom - (y - y0) * scale;
    const style = getComputedStyle(document.documentElement);
    const soft = style.getPropertyValue("--soft"), line = style.getPropertyValue("--line"), ink = style.getPropertyValue("--ink");

    c.font = "12px system-ui, sans-serif";
    c.lineWidth = 1;
    c.strokeStyle = line;
    c.fillStyle = soft;
    c.textAlign = "center";
    const x_ticks = linear_ticks(x0, x1, Math.max(2, Math.floor((scale * (x1 - x0)) / 90)));
    for (const t of x_ticks) {
      c.beginPath(); c.moveTo(px(t.value), py(y0)); c.lineTo(px(t.value), py(y0) + 5); c.stroke();
      c.fillText(t.value === x_ticks.at(-1).value ? `${t.text} m` : t.text, px(t.value), py(y0) + 18);
    }
    c.textAlign = "right";
    for (const t of linear_ticks(y0, y1, Math.max(2, Math.floor((scale * (y1 - y0)) / 42)))) {
      c.beginPath(); c.moveTo(px(x0) - 5, py(t.value)); c.lineTo(px(x0), py(t.value)); c.stroke();
      c.fillText(t.text, px(x0) - 8, py(t.value) + 4);
    }

    const within = {x: px(x0), y: py(y1), width: scale * (x1 - x0), height: scale * (y1 - y0)};
    const inside = (draw) => { c.save(); c.beginPath(); c.rect(within.x - 2, within.y - 2, within.width + 4, within.height + 4); c.clip(); draw(); c.restore(); };
    if (run.marks) inside(() => this.ground(c, run.marks, px, py, style));

    const k = this.frame_of(run), from = run.starts[k], to = run.starts[k + 1];
    const codes = this.field === null ? null : run.codes.get(this.field);
    const field = codes && run.frames.fields.find((f) => f.name === this.field);
    const thinned = run.frames.most_points / Math.max(...run.frames.counts);
    const spacing = run.spacing ?? Math.sqrt(((x1 - x0) * (y1 - y0)) / (4 * Math.max(...run.frames.counts)));
    const size = Math.max(1.2, 1.5 * spacing * scale * Math.sqrt(thinned));
    const sx = (run.frames.x[1] - run.frames.x[0]) / 65534, sy = (run.frames.y[1] - run.frames.y[0]) / 65534;
    // points of one colour together: the canvas is slow to change it
    const order = Array.from({length: 256}, () => []);
    for (let i = from; i < to; ++i) order[codes ? codes[i] : 127].push(i);
    order.forEach((points, code) => {
      if (points.length === 0) return;
      const value = field ? field.lower + ((field.upper - field.lower) * code) / 254 : 0;
      c.fillStyle = code === 255 ? no_number : this.field === "body" ? style.getPropertyValue(colour_of_body(Math.round(value))) : shade(field ? (value - range.lower) / (range.upper - range.lower) : 0.5);
      c.beginPath();
      for (const i of points) {
        const a = run.places[2 * i], b = run.places[2 * i + 1];
        if (a === 65535 || b === 65535) continue;
        const x = px(run.frames.x[0] + a * sx), y = py(run.frames.y[0] + b * sy);
        if (size < 3) c.rect(x - size / 2, y - size / 2, size, size);
        else { c.moveTo(x + size / 2, y); c.arc(x, y, size / 2, 0, 7); }
      }
      c.fill();
    });

    c.strokeStyle = soft;
    c.lineWidth = 1.5;
    if (run.marks) {
      inside(() => this.surroundings(c, run, k, px, py, style));
    } else {
      c.beginPath();
      c.moveTo(px(x0), py(y1)); c.lineTo(px(x0), py(y0)); c.lineTo(px(x1), py(y0)); c.lineTo(px(x1), py(y1));
      c.stroke();
    }
    if (run.tilt !== null && !run.marks?.plan) this.gravity(c, px(x1) - 34, py(y1) + 12, run.tilt, ink);
    run.view = {px, py, sx, sy, from, to, field, codes};
    canvas.setAttribute("aria-label", `${to - from} points of ${run.label} at ${number(run.frames.times[k])} s${this.field === null ? "" : `, coloured by ${label(this.field).text}`}`);
  }

  /// One line through places, or around them.
  trace(c, places, px, py) {
    c.beginPath();
    this.follow(c, places, px, py);
  }
  follow(c, places, px, py, closed = false) {
    places.forEach(([x, y], i) => (i ? c.lineTo(px(x), py(y)) : c.moveTo(px(x), py(y))));
    if (closed) c.closePath();
  }

  /// Below the points: contours of a terrain, and what was released on it.
  ground(c, marks, px, py, style) {
    for (const {kind, places} of marks.lines) {
      c.strokeStyle = style.getPropertyValue(kind === "contour" ? "--line" : "--ink");
      c.lineWidth = kind === "contour" ? 1 : 1.5;
      c.setLineDash(kind === "contour" ? [] : [5, 4]);
      this.trace(c, places, px, py);
      c.stroke();
    }
    c.setLineDash([]);
  }

  /// Upon the points of frame k: edges, rigid surfaces, the way of tracers up to now, probes.
  surroundings(c, run, k, px, py, style) {
    const ink = style.getPropertyValue("--ink"), soft = style.getPropertyValue("--soft"), mark = style.getPropertyValue("--c1");
    const {marks, tracks} = run;
    for (const {kind, from, to} of marks.edges) {
      c.strokeStyle = kind === "inflow" ? style.getPropertyValue("--accent") : soft;
      c.lineWidth = kind === "inflow" ? 5 : 1.5;
      c.setLineDash(kind === "open" || kind === "periodic" ? [6, 5] : []);
      this.trace(c, [from, to], px, py);
      c.stroke();
    }
    c.setLineDash([]);
    c.lineWidth = 1.5;
    for (const {hollow, outlines} of marks.surfaces) {
      c.beginPath();
      for (const ring of outlines[Math.min(k, outlines.length - 1)]) this.follow(c, ring, px, py, true);
      c.fillStyle = style.getPropertyValue("--line");
      if (!hollow) c.fill("evenodd");
      c.strokeStyle = ink;
      c.stroke();
    }
    c.textAlign = "left";
    // with a rim, to be seen upon points of any colour
    const rimmed = () => {
      c.lineWidth = 5;
      c.strokeStyle = style.getPropertyValue("--stage");
      c.stroke();
      c.lineWidth = 2;
      c.strokeStyle = mark;
      c.stroke();
    };
    const named = (text, x, y) => {
      c.font = "bold 13px system-ui, sans-serif";
      c.lineWidth = 4;
      c.strokeStyle = style.getPropertyValue("--stage");
      c.strokeText(text, x, y);
      c.fillStyle = ink;
      c.fillText(text, x, y);
    };
    const now = this.times[this.at];
    for (const {name, time, x, y} of tracks) {
      const places = [];
      for (let i = 0; i < time.length && time[i] <= now * (1 + 1e-9); ++i) if (Number.isFinite(x[i]) && Number.isFinite(y[i])) places.push([x[i], y[i]]);
      if (places.length === 0) continue;
      this.trace(c, places, px, py);
      rimmed();
      const [a, b] = places.at(-1);
      c.beginPath(); c.arc(px(a), py(b), 5, 0, 7); rimmed();
      named(name, px(a) + 9, py(b) - 6);
    }
    marks.probes.forEach(({place: [a, b]}, i) => {
      const x = px(a), y = py(b);
      c.beginPath(); c.moveTo(x - 5, y - 5); c.lineTo(x + 5, y + 5); c.moveTo(x - 5, y + 5); c.lineTo(x + 5, y - 5); rimmed();
      named(`${i + 1}`, x + 8, y - 5);
    });
  }

  gravity(c, x, y, tilt, ink) {
    const angle = (tilt * Math.PI) / 180, length = 34;
    const dx = Math.sin(angle), dy = Math.cos(angle);
    const bx = x + length * dx, by = y + length * dy;
    c.strokeStyle = c.fillStyle = ink;
    c.beginPath(); c.moveTo(x, y); c.lineTo(bx, by); c.stroke();
    c.beginPath();
    c.moveTo(bx + 5 * dx, by + 5 * dy); c.lineTo(bx - 4 * dy - 3 * dx, by + 4 * dx - 3 * dy); c.lineTo(bx + 4 * dy - 3 * dx, by - 4 * dx - 3 * dy);
    c.fill();
    c.textAlign = "right";
    c.fillText(tilt ? `g, tilt ${number(tilt)}°` : "g", x - 7, y + 16);
  }

  read(run, tip, event) {
    if (!run.view) return;
    const r = run.canvas.getBoundingClientRect(), mx = event.clientX - r.left, my = event.clientY - r.top;
    const {px, py, sx, sy, from, to, field, codes} = run.view;
    let best = null;
    for (let i = from; i < to; ++i) {
      const x = run.frames.x[0] + run.places[2 * i] * sx, y = run.frames.y[0] + run.places[2 * i + 1] * sy;
      const far = Math.hypot(px(x) - mx, py(y) - my);
      if (!best || far < best.far) best = {i, x, y, far};
    }
    tip.hidden = !best || best.far > 14;
    if (tip.hidden) return;
    const rows = [["x", `${number(best.x, 3)} m`], [run.marks?.plan ? "northwards" : "y", `${number(best.y, 3)} m`]];
    if (field) {
      const l = label(field.name), code = codes[best.i];
      const value = number(l.factor * (field.lower + ((field.upper - field.lower) * code) / 254), 3);
      const end = code === 0 && field.least < field.lower ? "≤ " : code === 254 && field.largest > field.upper ? "≥ " : "";
      const body = field.name === "body" ? run.marks?.bodies[Math.round(Number(value))] : null;
      rows.push([l.short, code === 255 ? "no number" : body ?? `${end}${value} ${l.unit}`]);
    }
    tip.replaceChildren(...rows.map(([name, value]) => el("div", {}, el("span", {}, name), el("b", {}, value))));
    tip.style.left = `${mx + 16 + tip.offsetWidth < r.width ? mx + 16 : mx - 16 - tip.offsetWidth}px`;
    tip.style.top = `${run.canvas.offsetTop + Math.max(0, my - 30)}px`;
  }
}
Player.all = [];
