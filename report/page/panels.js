// Which curves a kind of result is shown by.

// x, y: columns; y_text: the name of the axis where several columns share it; alone: only for a
// single folder, where `compare` lists what each folder is compared by instead.
const stress_paths = [
  {title: "Stress and strain", x: "eps_a", y: ["q_Pa"]},
  {title: "Stress path", x: "p_Pa", y: ["q_Pa"], unless: "tau_Pa"},
  {title: "Shear stress", x: "gamma", y: ["tau_Pa"]},
  {title: "Stress path", x: "p_Pa", y: ["tau_Pa"]},
  {title: "Excess pore pressure", x: "eps_a", y: ["u_Pa"], varies: true},
  {title: "Volume strain, compression positive", x: "eps_a", y: ["eps_v"], varies: true},
  {title: "Volume strain, compression positive", x: "gamma", y: ["eps_v"], varies: true},
  {title: "Compression plane", x: "p_Pa", y: ["v"], log_x: true, varies: true},
  {title: "Friction over inertial number", x: "I", y: ["mu"], log_x: true, varies: true},
];
const panels = {
  run: {
    "series.csv": [
      {title: "Front and height", x: "time_s", y: ["front_m", "front_max_m", "height_m"], y_text: "length (m)", compare: ["front_m", "height_m"], unless: "runout_99_m"},
      {title: "Run-out in the plan", x: "time_s", y: ["runout_99_m", "runout_max_m"], y_text: "distance from the release (m)", compare: ["runout_99_m"]},
      {title: "Depth of the flow", x: "time_s", y: ["depth_max_m", "depth_mean_m"], y_text: "solid depth (m)", compare: ["depth_max_m"]},
      {title: "Speed of the flow", x: "time_s", y: ["speed_max_m_per_s", "speed_mean_m_per_s"], y_text: "speed (m/s)", compare: ["speed_max_m_per_s"]},
      {title: "Ground covered", x: "time_s", y: ["area_m2", "reached_m2"], y_text: "area (m²)", compare: ["reached_m2"]},
      {title: "Energy", x: "time_s", y: ["kinetic_J_per_m", "elastic_J_per_m", "dissipated_J_per_m", "transfer_loss_J_per_m", "wall_loss_J_per_m"], y_text: "energy (J/m)", compare: ["kinetic_J_per_m", "dissipated_J_per_m"]},
      {title: "Energy", x: "time_s", y: ["kinetic_J", "elastic_J", "dissipated_J", "transfer_loss_J", "wall_loss_J"], y_text: "energy (J)", compare: ["kinetic_J", "dissipated_J"]},
      {title: "Energy not accounted for", x: "time_s", y: ["energy_residual_J_per_m"], varies: true},
      {title: "Energy not accounted for", x: "time_s", y: ["energy_residual_J"], varies: true},
      {title: "Mass through the edges", x: "time_s", y: ["inflow_kg_per_m", "outflow_kg_per_m"], y_text: "mass (kg/m)", varies: true},
      {title: "Mass through the edges", x: "time_s", y: ["inflow_kg", "outflow_kg"], y_text: "mass (kg)", varies: true},
      {title: "Density", x: "time_s", y: ["density_min", "density_max"], y_text: "density (kg/m³)", compare: []},
      {title: "Time step", x: "time_s", y: ["dt_s"], varies: true},
      {title: "Points torn from the rest", x: "time_s", y: ["points_separated"], varies: true},
    ],
    "profile.csv": [{title: "Profile at the end", x: "x_m", y: ["depth_m"], equal: true, static: true}],
  },
  point_test: {"curve.csv": stress_paths},
  fit: {"predictions.csv": "predictions"},
  chart_point: {
    "chart.csv": [{facet: ["path"], group: ["method"], x: "error", y: ["wall_s"], log_x: true, log_y: true, marks: true, x_text: "error (relative)"}],
    "error_map.csv": [{facet: ["start"], map: ["eps_v", "eps_q", "error"]}],
  },
  chart_fit: {
    "chart.csv": [
      {title: "Objective over trials", facet_by: "algorithm", group: ["algorithm"], x: "trials", y: ["objective"], log_x: true, log_y: true, step: true},
      {title: "Objective over time", facet_by: "algorithm", group: ["algorithm"], x: "time_s", y: ["objective"], log_x: true, log_y: true, step: true},
    ],
  },
  chart_mpm: {
    "chart.csv": [
      {title: "Does the front depend on the step?", group: ["transfer", "kernel", "h_m"], x: "mean_dt_s", y: ["front_m"], log_x: true, marks: true, sort: true},
      {title: "Does the height depend on the step?", group: ["transfer", "kernel", "h_m"], x: "mean_dt_s", y: ["height_m"], log_x: true, marks: true, sort: true},
      {title: "Front against cost", group: ["transfer", "kernel", "h_m"], x: "cpu_s", y: ["front_m"], log_x: true, marks: true, sort: true},
      {title: "Profile's change against cost", group: ["transfer", "kernel", "h_m"], x: "cpu_s", y: ["profile_change_mean"], log_x: true, log_y: true, marks: true, sort: true},
    ],
    "history.csv": [
      {title: "Front", group: ["transfer", "kernel", "h_m", "courant", "dt_s"], x: "time_s", y: ["front_m"]},
      {title: "Kinetic energy", group: ["transfer", "kernel", "h_m", "courant", "dt_s"], x: "time_s", y: ["kinetic_J_per_m"]},
    ],
  },
};

/// NLopt's names begin with G or L and then D where gradients are used; others are local.
function family(name) {
  if (/^G/.test(name)) return /DIRECT|STOGO/.test(name) ? "Global: dividing rectangles, branch and bound" : "Global: random and clustering";
  if (/TNEWTON/.test(name)) return "Local, with gradients: truncated Newton";
  return /^LN_/.test(name) ? "Local, without gradients" : "Local, with gradients";
}

const axis = (column, text, log) => ({label: text ? made(text, "", "", label(column).factor) : label(column), log});
const varies = (values) => { const v = [...values].filter(Number.isFinite); return v.length > 0 && v.some((x) => x !== v[0]); };

/// sources: [{label, style, table}], the same file of one or several folders.
function draw_panel(panel, sources) {
  const usable = sources.filter(({table}) => has(table, panel.x) && panel.y.some((y) => has(table, y)) && !(panel.unless && has(table, panel.unless)));
  if (usable.length === 0) return [];
  if (panel.group) return grouped(panel, usable);
  const several = usable.length > 1;
  const one = (columns, title, y_text) => {
    const series = [];
    for (const {label: name, style, table} of usable)
      for (const column of columns.filter((c) => has(table, c))) {
        if (panel.varies && !varies(column_of(table, column))) continue;
        const rows = all_rows(table);
        series.push({
          name: several ? name : label(column).short, style: several ? style : series.length,
          x: picked(table, panel.x, rows, label(panel.x).factor), y: picked(table, column, rows, label(column).factor),
        });
      }
    if (series.length === 0) return [];
    return [new Chart({
      title, series, equal: panel.equal, time: panel.x === "time_s", always_name: several || columns.length > 1,
      x: axis(panel.x, null, panel.log_x), y: axis(columns[0], y_text, panel.log_y),
    }).element];
  };
  if (!several) return one(panel.y, panel.title, panel.y_text);
  return (panel.compare ?? panel.y).flatMap((column) => one([column], panel.y.length > 1 ? capital(label(column).name) : panel.title, null));
}
const capital = (text) => text.slice(0, 1).toUpperCase() + text.slice(1);

/// Curves of the rows that share the words of panel.group; one chart for each value of panel.facet.
function grouped(panel, sources) {
  const facets = new Map();
  for (const {label: name, style, table} of sources) {
    const columns = panel.group.filter((c) => has(table, c));
    const differing = columns.filter((c) => groups_of(table, [c]).length > 1);
    for (const part of groups_of(table, [...(panel.facet ?? []), ...columns])) {
      const words = part.key.slice(panel.facet?.length ?? 0);
      const facet = panel.facet ? part.key[0] : panel.facet_by ? family(words[columns.indexOf(panel.facet_by)]) : "";
      const said = columns.map((c, i) => [c, words[i]]).filter(([c, w]) => w !== "" && (differing.includes(c) || columns.length === 1));
      const group_name = said.map(([c, w]) => (is_text(table, c) ? w : `${{h_m: "h", courant: "Courant", dt_s: "dt"}[c] ?? label(c).name} ${w}`)).join(", ");
      let rows = part.rows;
      const x = column_of(table, panel.x), y = column_of(table, panel.y[0]);
      rows = rows.filter((i) => Number.isFinite(x[i]) && Number.isFinite(y[i]));
      if (panel.log_x) rows = rows.filter((i) => x[i] > 0 || panel.step);
      if (panel.log_y && panel.facet) rows = rows.filter((i) => y[i] > 0);
      if (panel.sort) rows.sort((a, b) => x[a] - x[b]);
      if (rows.length === 0) continue;
      if (!facets.has(facet)) facets.set(facet, []);
      const list = facets.get(facet);
      list.push({
        name: [sources.length > 1 ? name : "", group_name].filter(Boolean).join(": ") || name, style: list.length,
        x: picked(table, panel.x, rows, label(panel.x).factor), y: picked(table, panel.y[0], rows, label(panel.y[0]).factor),
        marks: panel.marks, step: panel.step,
      });
    }
  }
  return [...facets].map(([facet, series]) => new Chart({
    title: [panel.title, facet].filter(Boolean).join(" · "), series, always_name: true, time: false,
    x: axis(panel.x, panel.x_text, panel.log_x), y: axis(panel.y[0], panel.y_text, panel.log_y),
  }).element);
}

/// A table whose rows are the cells of a map, one map for each value of the facet.
function draw_map(panel, sources) {
  const [x, y, z] = panel.map;
  return sources.filter(({table}) => [x, y, z].every((c) => has(table, c))).flatMap(({label: name, table}) =>
    groups_of(table, panel.facet.filter((c) => has(table, c))).map((part) => {
      const value = (column, i) => (is_text(table, column) ? column_of(table, column)[i] : label(column).factor * column_of(table, column)[i]);
      const layers = [z, ...(panel.rest ?? [])].map((c) => ({z: label(c), at: part.rows.map((i) => [value(x, i), value(y, i), value(c, i)])}));
      const title = [sources.length > 1 ? name : "", panel.title ?? capital(label(z).name), ...part.key].filter(Boolean).join(" · ");
      return new HeatMap({title, x: label(x), y: label(y), layers}).element;
    }));
}

/// Measured rows and fitted ones, target by target.
function draw_predictions(sources) {
  const charts = [];
  const targets = new Map();
  for (const source of sources)
    for (const part of groups_of(source.table, ["target", "held_out", "x_name", "channel"])) {
      const id = part.key.join("\u0000");
      if (!targets.has(id)) targets.set(id, {key: part.key, parts: []});
      targets.get(id).parts.push({...source, rows: part.rows});
    }
  for (const {key: [target, held_out, x_name, channel], parts} of targets.values()) {
    const xl = label(x_name), yl = label(channel);
    const first = parts[0];
    const x = picked(first.table, "x", first.rows, xl.factor);
    // strains, times and places are read evenly; pressures, rates and inertial numbers by decades
    const even = x_name.startsWith("eps_") || x_name === "time_s" || x_name === "x_m";
    const log = !even && x.every((v) => v > 0) && Math.max(...x) > 8 * Math.min(...x);
    const series = [{name: "measured", style: 6, line: false, marks: true, scattered: true, x, y: picked(first.table, "measured", first.rows, yl.factor)}];
    for (const part of parts)
      series.push({
        name: parts.length > 1 ? part.label : held_out === "yes" ? "predicted" : "fitted", style: part.style,
        x: picked(part.table, "x", part.rows, xl.factor), y: picked(part.table, "fitted", part.rows, yl.factor), scattered: true,
      });
    charts.push(new Chart({title: `${target}${held_out === "yes" ? " (held out, predicted)" : ""}`, series, x: {label: xl, log}, y: {label: yl}}).element);
  }
  return charts;
}

/// The tables of a run's probes or tracers: [{name: "2: flank", result, style, table}]. They are numbered in the order of the
/// scene, as the pictures do.
function looks_of(results, kind) {
  return results.flatMap((result, k) => {
    const order = kind === "probe" ? (result.scene?.probes ?? []).map((p) => p.name) : result.scene?.tracers ?? [];
    const names = Object.keys(result.tables).filter((file) => file.startsWith(`${kind}_`)).map((file) => file.slice(kind.length + 1, -4));
    names.sort((a, b) => (order.indexOf(a) + 1 || 1e9) - (order.indexOf(b) + 1 || 1e9));
    return names.map((name) => {
      const number = kind === "probe" && order.includes(name) ? `${order.indexOf(name) + 1}: ` : "";
      return {name: `${results.length > 1 ? `${result.label}, ` : ""}${number}${name}`, style: k, result, table: result.tables[`${kind}_${name}.csv`]};
    }).filter(({table}) => table.shown > 0);
  });
}

/// What the probes saw, and where the tracers went.
function draw_looks(results) {
  const charts = [];
  const over_time = (looks, title, column) => {
    const shown = looks.filter(({table}) => has(table, column) && column_of(table, column).some(Number.isFinite));
    if (shown.length === 0) return;
    charts.push(new Chart({
      title, time: true, always_name: true, x: axis("time_s"), y: axis(column),
      series: shown.map(({name, table}, k) => ({
        name, style: k, x: picked(table, "time_s", all_rows(table)), y: picked(table, column, all_rows(table), label(column).factor)})),
    }).element);
  };
  const probes = looks_of(results, "probe"), tracers = looks_of(results, "tracer");
  for (const [title, column] of [["Depth at the probes", "depth_m"], ["Speed at the probes", "speed_m_per_s"], ["Mean pressure at the probes", "pressure_Pa"], ["Shear stress q at the probes", "q_Pa"]])
    over_time(probes, title, column);
  if (tracers.length) {
    const plan = tracers.some(({result}) => result.scene?.plan);
    charts.push(new Chart({
      title: plan ? "Paths of the tracers, from above" : "Paths of the tracers", equal: true, always_name: true,
      x: {label: made("x", "", "m", 1)}, y: {label: made(plan ? "northwards" : "y", "", "m", 1)},
      series: tracers.map(({name, result, table}, k) => ({name, style: k, scattered: true, ...path_of(result, table)})),
    }).element);
    over_time(tracers, "Speed of the tracers", "speed_m_per_s");
  }
  return charts;
}

/// A tracer's places in the plane that its run is seen in: {time, x, y}.
function path_of(result, table) {
  const rows = all_rows(table), height = result.scene?.plan ? result.scene.plan_height : null;
  const y = height === null ? picked(table, "y_m", rows) : picked(table, "z_m", rows).map((z) => height - z);
  return {time: picked(table, "time_s", rows), x: picked(table, "x_m", rows), y};
}

/// Charts of one file over all folders of a kind; an unknown table is shown as it looks.
function charts_of(kind, file, sources) {
  const known = panels[kind]?.[file];
  if (known === "predictions") return draw_predictions(sources);
  if (known) return known.flatMap((panel) => (panel.map ? draw_map(panel, sources) : draw_panel(panel, sources)));
  if (panels[kind]) return [];
  const {table} = sources[0];
  const map = map_columns(table);
  if (map) return draw_map({...map, title: capital(file.replace(/\.csv$/, "").replaceAll("_", " "))}, sources);
  const numeric = numeric_columns(table);
  if (numeric.length < 2) return [];
  const columns = text_columns(table).filter((c) => groups_of(table, [c]).length <= 24);
  const y = numeric.slice(1, 3);
  return y.flatMap((column) => draw_panel(
    {title: `${file}: ${label(column).short}`, x: numeric[0], y: [column], ...(columns.length ? {group: columns, marks: true} : {})}, sources));
}

/// Two columns whose values form a grid, and what stands in its cells; null if there are none.
function map_columns(table) {
  const words = text_columns(table), numeric = numeric_columns(table);
  for (let a = 0; a + 1 < Math.min(numeric.length, 4); ++a) {
    const [x, y] = [numeric[a], numeric[a + 1]];
    const facet = words.filter((c) => { const n = groups_of(table, [c]).length; return n > 1 && n <= 12; });
    for (const by of [[], ...facet.map((c) => [c]), facet]) {
      const grid = groups_of(table, by).every(({rows}) => {
        const nx = new Set(rows.map((i) => column_of(table, x)[i])).size, ny = new Set(rows.map((i) => column_of(table, y)[i])).size;
        const cells = new Set(rows.map((i) => `${column_of(table, x)[i]},${column_of(table, y)[i]}`)).size;
        return nx >= 3 && ny >= 3 && cells === rows.length && cells >= 0.7 * nx * ny;
      });
      const rest = [...numeric.slice(a + 2), ...words.filter((c) => !by.includes(c))];
      if (grid && rest.length) return {map: [x, y, rest[0]], rest: rest.slice(1), facet: by};
    }
  }
  return null;
}

/// Any column over any other, with curves by the words of a third.
function explorer(file, sources) {
  const {table} = sources[0];
  const numeric = numeric_columns(table), words = text_columns(table);
  if (numeric.length < 2) return null;
  const choose = (name, list, value) => {
    const select = el("select", {onchange: redraw}, list.map((c) => el("option", {value: c}, c)));
    select.value = value;
    return [el("label", {}, name, select), select];
  };
  const host = el("div", {});
  const [x_label, x] = choose("x", numeric, numeric[0]);
  const [y_label, y] = choose("y", numeric, numeric[1]);
  const [by_label, by] = choose("curves by", ["(one)", ...words], words[0] ?? "(one)");
  function redraw() {
    const panel = {title: `${y.value} over ${x.value}`, x: x.value, y: [y.value]};
    if (by.value !== "(one)") Object.assign(panel, {group: [by.value], marks: true});
    Chart.all = Chart.all.filter((chart) => !host.contains(chart.element));
    host.replaceChildren(...draw_panel(panel, sources));
  }
  redraw();
  return el("div", {}, el("div", {class: "row"}, el("b", {}, file), x_label, y_label, words.length ? by_label : null), host);
}
