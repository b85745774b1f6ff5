// The page: one section for each kind of result, its folders side by side.

const data = JSON.parse(document.getElementById("data").textContent);
const kind_names = {
  run: ["Collapse", "Collapses"], point_test: ["Test at a material point", "Tests at a material point"], fit: ["Fit", "Fits"],
  chart_point: ["Integrators: work and precision", "Integrators: work and precision"],
  chart_fit: ["Algorithms of a fit", "Algorithms of a fit"], chart_mpm: ["Transfers, cells and steps", "Transfers, cells and steps"],
  stability: ["Stability", "Stability"],
};
// what a reader wants first, and in which words
const figures = {
  run: [["front_m", "front"], ["height_m", "height"], ["runout_99_m", "run-out, 99 % of the mass"], ["runout_max_m", "run-out, farthest point"], ["largest_depth_m", "largest depth"], ["largest_speed_m_per_s", "largest speed"], ["reached_m2", "area reached"], ["time_s", "simulated"], ["points", "points"], ["lost_points", "points lost"], ["energy_error", "energy not accounted for"], ["kinetic_J_per_m", "kinetic energy left"], ["kinetic_J", "kinetic energy left"], ["outflow_kg_per_m", "has left the box"], ["outflow_kg", "has left the box"], ["inflow_kg_per_m", "has come in"], ["inflow_kg", "has come in"], ["steps", "steps"], ["wall_s", "wall time"], ["point_steps_per_s", "point-steps per second"]],
  point_test: [["rows", "rows"], ["method", "integrator"], ["q_max_Pa", "largest q"], ["steps", "steps"], ["control_residual", "control residual"], ["wall_s", "wall time"]],
  fit: [["objective", "objective"], ["counts.starts", "starts"], ["counts.evaluations", "evaluations"], ["counts.gradients", "gradients"], ["wall_s", "wall time"]],
  chart_point: [["settings", "settings"]],
  chart_fit: [["task", "task"], ["algorithms", "algorithms"], ["evaluations", "most trials"], ["first_objective", "first objective"]],
  chart_mpm: [["name", "scene"], ["runs", "runs"], ["runs_done", "runs done"], ["threads", "threads"], ["cpu_s", "CPU time"]],
};
const at_path = (object, path) => path.split(".").reduce((o, k) => o?.[k], object);

/// {"input.grid.h": 0.0125, …}
function flattened(value, path = "", out = {}) {
  if (value !== null && typeof value === "object" && !(Array.isArray(value) && value.every((v) => v === null || typeof v !== "object"))) {
    for (const [k, v] of Object.entries(value)) flattened(v, Array.isArray(value) ? `${path}[${k}]` : path ? `${path}.${k}` : k, out);
  } else out[path] = Array.isArray(value) ? `[${value.map((v) => shown(v)).join(", ")}]` : value;
  return out;
}
const shown = (v) => (typeof v === "number" ? number(v, 6) : v === null || v === undefined ? "–" : String(v));

/// A figure of summary.json with its unit: [value, unit].
function quantity(key, value) {
  if (typeof value !== "number") return [shown(value), ""];
  if (key === "energy_error") return [number(100 * value, 2), "%"];
  if (key === "point_steps_per_s") return [number(value / 1e6, 3), "million"];
  const l = label(key.split(".").at(-1));
  return [number(l.factor * value), l.unit];
}

function state(result) {
  const text = result.summary.status ?? "no status";
  return el("span", {class: `state ${text === "done" ? "good" : "bad"}`}, text);
}
function version(result) { return result.summary.repose ? `repose ${result.summary.repose}` : "unknown version"; }

function folder_list(results) {
  return el("ul", {class: "folders"}, results.map((r, k) => el("li", {},
    results.length > 1 ? swatch({style: k}) : null, el("b", {}, r.label), state(r),
    el("span", {class: "dim"}, [version(r), r.summary.input?.law?.name ?? r.summary.input?.body?.[0]?.law?.name].filter(Boolean).join(" · ")))));
}

function warnings(results) {
  const lines = results.flatMap((r) => {
    const who = results.length > 1 ? `${r.label}: ` : "";
    const said = [...(r.summary.warnings ?? []), ...(r.summary.notes ?? []), ...(r.fit?.notes ?? []), ...(r.summary.discrepancy ?? []), ...r.notes];
    if (r.summary.status !== "done" && r.summary.reason) said.unshift(r.summary.reason);
    return said.map((text) => who + text);
  });
  if (lines.length === 0) return null;
  const list = el("ul", {}, lines.map((text) => el("li", {}, text)));
  return el("div", {class: "warn", role: "note"}, el("b", {}, lines.length === 1 ? "To know" : `To know (${lines.length})`),
    lines.length > 8 ? el("details", {}, el("summary", {}, "all of them"), list) : list);
}

function key_figures(kind, results) {
  const wanted = (figures[kind] ?? Object.keys(results[0].summary).filter((k) => typeof results[0].summary[k] === "number").map((k) => [k, label(k).short]))
    .filter(([key]) => results.some((r) => at_path(r.summary, key) !== undefined))
    .filter(([key]) => !(/^(front|height)_m$/.test(key) && results.every((r) => "runout_99_m" in r.summary)))
    .filter(([key]) => !(key.startsWith("outflow_") && results.every((r) => r.summary[key] === 0)));
  if (wanted.length === 0) return null;
  if (results.length === 1)
    return el("dl", {class: "tiles"}, wanted.map(([key, name]) => {
      const [value, unit] = quantity(key, at_path(results[0].summary, key));
      return el("div", {class: "tile"}, el("dt", {}, name), el("dd", {class: value.length > 14 ? "words" : null}, value, unit ? el("small", {}, ` ${unit}`) : null));
    }));
  const unit_of = (key) => quantity(key, at_path(results.find((r) => typeof at_path(r.summary, key) === "number")?.summary ?? {}, key))[1];
  return el("div", {class: "scroll"}, el("table", {},
    el("thead", {}, el("tr", {}, el("th", {}, ""), wanted.map(([key, name]) => el("th", {class: "n"}, name, unit_of(key) ? ` (${unit_of(key)})` : "")))),
    el("tbody", {}, results.map((r, k) => el("tr", {}, el("th", {}, swatch({style: k}), " ", r.label),
      wanted.map(([key]) => el("td", {class: "n"}, quantity(key, at_path(r.summary, key))[0])))))));
}

/// The keys of the inputs that are not the same everywhere.
function differences(results) {
  if (results.length < 2) return null;
  const inputs = results.map((r) => flattened(r.summary.input ?? {}));
  const keys = [...new Set(inputs.flatMap(Object.keys))].filter((k) => inputs.some((i) => i[k] !== inputs[0][k]));
  if (keys.length === 0 || keys.length > 60) return null;
  const few = keys.length <= 12;
  return el("details", few ? {open: ""} : {}, el("summary", {}, `What differs between the inputs${few ? "" : ` (${keys.length} keys)`}`),
    el("div", {class: "scroll", style: "margin-top:4px"}, el("table", {},
      el("thead", {}, el("tr", {}, el("th", {}, "key"), results.map((r) => el("th", {}, r.label)))),
      el("tbody", {}, keys.map((k) => el("tr", {}, el("th", {}, k), inputs.map((i) => el("td", {}, shown(i[k]))))))))); 
}

/// Distance between points [m] as the scene was filled, from the resolved input.
function spacing_of(input) {
  const grid = input?.grid;
  return grid?.h && grid?.points_per_cell ? grid.h / Math.sqrt(grid.points_per_cell) : null;
}
function player_of(results) {
  const runs = results.map((r, k) => ({r, k})).filter(({r}) => r.frames).map(({r, k}) => {
    const input = r.summary.input;
    const pulled = (input?.scene?.gravity ?? 0) > 0;
    return {label: r.label, style: k, frames: r.frames, domain: input?.domain?.size?.slice(0, 2) ?? null, tilt: pulled ? input.scene.tilt_deg ?? 0 : null, spacing: spacing_of(input), marks: r.scene ?? null,
      tracks: looks_of([r], "tracer").map(({name, table}) => ({name, ...path_of(r, table)}))};
  });
  return runs.length ? new Player(runs).element : null;
}

/// The map that a run over a terrain leaves, large: it is what such a run is made for.
function terrain_maps(results) {
  return results.filter((r) => r.scene?.plan || "runout_99_m" in r.summary).flatMap((r) => r.pictures.filter((p) => p.name === "final.svg").map((p) =>
    el("div", {class: "pictures"}, el("figure", {}, el("img", {class: "map", alt: `Largest depth and deposit of ${r.label}, from above`, src: `data:image/svg+xml;charset=utf-8,${encodeURIComponent(p.svg)}`}),
      results.length > 1 ? el("figcaption", {class: "note"}, r.label) : null))));
}

/// Parameters with their intervals, and how the data tie them to each other.
function fit_tables(results) {
  return results.filter((r) => r.fit?.parameters).map((r) => {
    const names = Object.keys(r.fit.parameters), c = r.fit.correlation ?? [];
    const quoted = (p) => p.recommended_95;
    const interval = (p) => (quoted(p) && quoted(p).kind !== "bounds" ? `${quoted(p).lower_is_bound ? "at most" : quoted(p).upper_is_bound ? "at least" : number(quoted(p).interval[0]) + " to"} ${number(quoted(p).interval[quoted(p).upper_is_bound && !quoted(p).lower_is_bound ? 0 : 1])}${p.at_bound ? ` (at its ${p.at_bound} bound)` : ""}` : quoted(p) ? "the data do not determine it" : p.at_bound ? `at its ${p.at_bound} bound` : p.interval_95?.every((x) => x !== null) ? `${number(p.interval_95[0])} to ${number(p.interval_95[1])}` : "the data do not determine it");
    const ink = (x) => (Math.abs(x) > 0.55 ? "#ffffff" : "var(--ink)");
    const tint = (x) => (x === null ? "none" : `color-mix(in srgb, ${x < 0 ? "#a63c00" : "#005f9e"} ${Math.round(100 * Math.min(Math.abs(x), 1))}%, var(--page))`);
    return el("div", {},
      el("div", {class: "scroll"}, el("table", {},
        el("thead", {}, el("tr", {}, el("th", {}, results.length > 1 ? r.label : "parameter"), el("th", {class: "n"}, "value"), el("th", {}, "unit"), el("th", {class: "n"}, "standard error"), el("th", {}, "95 % interval"))),
        el("tbody", {}, names.map((n) => { const p = r.fit.parameters[n]; return el("tr", {}, el("th", {}, n), el("td", {class: "n"}, number(p.value, 5)), el("td", {}, p.unit), el("td", {class: "n"}, number(p.standard_error, 2)), el("td", {}, interval(p))); })))),
      names.length > 1 && c.length === names.length ? el("details", {}, el("summary", {}, "Correlation of the parameters"),
        el("div", {class: "scroll"}, el("table", {},
          el("thead", {}, el("tr", {}, el("th", {}, ""), names.map((n) => el("th", {}, n)))),
          el("tbody", {}, names.map((n, i) => el("tr", {}, el("th", {}, n), names.map((_, j) => el("td", {class: "cell", style: c[i][j] === null ? "" : `background:${tint(c[i][j])};color:${ink(c[i][j])}`}, c[i][j] === null ? "–" : minus(c[i][j].toFixed(2)))))))))) : null);
  });
}

function download(name, text, type) {
  return el("a", {class: "button", download: name, href: `data:${type};charset=utf-8,${encodeURIComponent(text)}`}, name);
}

/// A <details> that is filled when it is first opened.
function later(title, make, open = false) {
  const node = el("details", {}, el("summary", {}, title));
  let made_already = false;
  const fill_in = () => { if (node.open && !made_already) { made_already = true; node.append(...make()); } };
  node.addEventListener("toggle", fill_in);
  node.open = open;
  fill_in();
  return node;
}

function appendix(kind, results, files, known) {
  const parts = [];
  const who = (r, name) => (results.length > 1 ? `${r.label}/${name}` : name);
  const pictures = results.flatMap((r) => r.pictures.map((p) => [r, p]));
  const explorers = files.map((file) => [file, sources_of(results, file)]).filter(([, s]) => numeric_columns(s[0].table).length > 1);
  if (explorers.length)
    parts.push(later("Plot any column", () => explorers.map(([file, sources]) => explorer(file, sources)).filter(Boolean)));
  if (pictures.length)
    parts.push(later(`Pictures (${pictures.length})`, () => [el("div", {class: "pictures"}, pictures.map(([r, p]) => el("figure", {},
      el("img", {alt: `${who(r, p.name)}, the picture that the result came with`, loading: "lazy", src: `data:image/svg+xml;charset=utf-8,${encodeURIComponent(p.svg)}`}), el("figcaption", {class: "note"}, who(r, p.name)))))], !known));
  if (results.some((r) => r.input))
    parts.push(later(results.length > 1 ? "Inputs" : "Input", () => results.filter((r) => r.input).map((r) => el("div", {}, el("div", {class: "row"}, el("span", {class: "note"}, "Running it again gives the same bits:"), download(who(r, "input.toml").replace("/", "_"), r.input, "text/plain")), el("pre", {tabindex: 0}, r.input)))));
  for (const r of results)
    for (const t of r.texts) parts.push(later(who(r, t.name), () => [el("pre", {tabindex: 0}, t.text)]));
  parts.push(later("All figures", () => {
    const flat = results.map((r) => { const {input, warnings: said, ...rest} = r.summary; return flattened(rest); });
    const keys = [...new Set(flat.flatMap(Object.keys))];
    return [el("div", {class: "scroll"}, el("table", {},
      results.length > 1 ? el("thead", {}, el("tr", {}, el("th", {}, ""), results.map((r) => el("th", {class: "n"}, r.label)))) : null,
      el("tbody", {}, keys.map((k) => el("tr", {}, el("th", {}, k), flat.map((f) => el("td", {class: typeof f[k] === "number" ? "n" : ""}, shown(f[k]))))))))];
  }));
  if (files.length)
    parts.push(later("Tables", () => [el("p", {class: "note"}, "As CSV, seven digits; the result folder has them all."), ...results.map((r) => el("div", {class: "row"}, results.length > 1 ? el("b", {}, r.label) : null,
      Object.entries(r.tables).map(([name, table]) => download(who(r, name).replace("/", "_"), csv_text(table), "text/csv"))))]));
  return parts;
}

const sources_of = (results, file) => results.map((r, k) => ({label: r.label, style: k, table: r.tables[file]})).filter((s) => s.table && s.table.shown > 0);

function section(kind, results) {
  const known = Boolean(panels[kind]);
  const files = [...new Set(results.flatMap((r) => Object.keys(r.tables)))].filter((f) => sources_of(results, f).length > 0);
  const ordered = known ? [...Object.keys(panels[kind]).filter((f) => files.includes(f)), ...files.filter((f) => !panels[kind][f])] : files;
  const names = kind_names[kind] ?? [kind.replaceAll("_", " "), kind.replaceAll("_", " ")];
  const charts = [...ordered.flatMap((file) => charts_of(kind, file, sources_of(results, file))), ...(kind === "run" ? draw_looks(results) : [])];
  return el("section", {class: "kind", id: `kind-${kind}`}, el("h2", {}, capital(names[results.length > 1 ? 1 : 0])), folder_list(results),
    kind === "run" ? player_of(results) : null, kind === "run" ? terrain_maps(results) : null, key_figures(kind, results), warnings(results), fit_tables(results), differences(results),
    charts.length ? el("div", {class: "panels"}, charts) : null, appendix(kind, results, files, known));
}

function build() {
  const kinds = [...new Set(data.results.map((r) => r.kind))];
  const order = Object.keys(kind_names);
  kinds.sort((a, b) => (order.indexOf(a) + 1 || 99) - (order.indexOf(b) + 1 || 99));
  const sections = kinds.map((kind) => [kind, data.results.filter((r) => r.kind === kind)]);
  const versions = [...new Set(data.results.map(version))];
  const measures = new Set(data.results.flatMap((r) => [r.summary.strain, ...(r.fit?.targets ?? []).map((t) => t.strain)]).filter(Boolean));
  if (measures.size === 1) [strain_measure] = measures;
  fill(document.getElementById("page"), {}, [
    el("header", {class: "top"}, el("div", {class: "mark"}, "repose report"), el("h1", {}, data.title),
      sections.length > 1 ? el("nav", {"aria-label": "Kinds of results"}, sections.map(([kind, results]) => el("a", {href: `#kind-${kind}`}, `${(kind_names[kind] ?? [kind, kind])[results.length > 1 ? 1 : 0]}${results.length > 1 ? ` (${results.length})` : ""}`))) : null),
    el("main", {}, sections.map(([kind, results]) => section(kind, results))),
    el("footer", {}, `Page by repose ${data.repose}; results by ${versions.join(", ")}. One file, nothing from the network. Curves: drag to zoom, double click to see all, arrow keys to read; colours of Okabe and Ito, maps in viridis.`),
  ]);
}
build();
