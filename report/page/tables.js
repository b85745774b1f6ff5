// The tables of the results, as the program packed them.

/// Numbers as a Float64Array (an empty cell is NaN), words as an array of strings.
function column_of(table, name) {
  const column = table.columns.find((c) => c.name === name);
  if (!column) return null;
  if (!column.ready)
    column.ready = column.words
      ? column.of.map((k) => column.words[k])
      : Float64Array.from(column.values, (x) => (x === null || x === "nan" ? NaN : x === "inf" ? Infinity : x === "-inf" ? -Infinity : x));
  return column.ready;
}
const is_text = (table, name) => Boolean(table.columns.find((c) => c.name === name)?.words);
const has = (table, name) => table.columns.some((c) => c.name === name);
const numeric_columns = (table) => table.columns.filter((c) => c.values && c.values.some((x) => typeof x === "number")).map((c) => c.name);
const text_columns = (table) => table.columns.filter((c) => c.words).map((c) => c.name);

/// Rows that share the values of the columns, in the order of their first row:
/// [{key: ["apic", "0.0125"], rows: [0, 1, …]}].
function groups_of(table, columns) {
  const groups = new Map();
  for (let i = 0; i < table.shown; ++i) {
    const key = columns.map((c) => { const v = column_of(table, c)[i]; return typeof v === "number" ? (Number.isNaN(v) ? "" : number(v)) : v; });
    const id = key.join("\u0000");
    if (!groups.has(id)) groups.set(id, {key, rows: []});
    groups.get(id).rows.push(i);
  }
  return [...groups.values()];
}
function picked(table, name, rows, factor = 1) {
  const column = column_of(table, name);
  return Float64Array.from(rows, (i) => factor * column[i]);
}
const all_rows = (table) => Array.from({length: table.shown}, (_, i) => i);

function csv_text(table) {
  const quoted = (x) => (/[",\n]/.test(x) ? `"${x.replaceAll('"', '""')}"` : x);
  const lines = [table.columns.map((c) => quoted(c.name)).join(",")];
  for (let i = 0; i < table.shown; ++i)
    lines.push(table.columns.map((c) => (c.words ? quoted(c.words[c.of[i]]) : c.values[i] ?? "")).join(","));
  return lines.join("\n") + "\n";
}

function bytes_of(base64) {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
  return bytes;
}
