"use strict";
// The table: filters, sorting, pages.

const SCREEN_ROWS = 50;
/** Rows on paper, at most. */
const PAPER_ROWS = 2000;
let pageRows = SCREEN_ROWS;
/** Calls of the other parts when what is ticked changes. */
const onTicked = [];
let pointOf = null;
/** Rows of each point, and whether the measures of a row count for its point. */
let runsOf = new Map();
let counted = null;
let passing = [];
let entries = [];

const ofPoints = () => pointOf && !state.runs;
const isReplicate = (of) => ofPoints() && data.replicates.includes(of.name);
const visible = () => columns.filter((each) => !hidden().includes(each.name) && !isReplicate(each));
const hidden = () => state.hidden ?? columns.filter((each) => !each.shown && each.name !== "job").map((each) => each.name);

/** Whether a row passes every filter, or every one but that of a column. */
function passes(row, but = null) {
  for (const [name, words] of Object.entries(state.words)) {
    const of = column(name);
    if (name !== but && of && !words.includes(of.text(row))) return false;
  }
  for (const [name, [low, high]] of Object.entries(state.ranges)) {
    const of = column(name);
    if (name !== but && of && !(of.cells[row] >= low && of.cells[row] <= high)) return false;
  }
  return true;
}

/** Rows to list: runs, or points with their runs. */
function listed() {
  passing = [];
  for (let row = 0; row < data.rows; row++) if (passes(row)) passing.push(row);
  if (!ofPoints()) {
    entries = passing.map((row) => ({ row, runs: [row] }));
  } else {
    // A point with a run that passes is listed with all its runs.
    const points = new Set(passing.map((row) => pointOf[row]));
    entries = [...points].map((point) => ({ row: runsOf.get(point)[0], runs: runsOf.get(point) }));
  }
  const by = state.sort && column(state.sort.name);
  if (by) {
    by.direction = state.sort.direction;
    const key = (entry) => (by.isNumber ? middle(by, entry.runs) : entry.row);
    entries = entries.map((entry) => ({ ...entry, key: key(entry) }));
    entries.sort((a, b) => by.compare(a.key, b.key));
  }
}

/** The runs of a point whose measure counts, from the least up. */
function measured(of, runs) {
  const counts = (row) => of.has(row) && (runs.length === 1 || !counted || counted[row]);
  return runs.filter(counts).sort((a, b) => of.cells[a] - of.cells[b]);
}

/** The run in the middle. */
function middle(of, runs) {
  const known = measured(of, runs);
  return known.length ? known[(known.length - 1) >> 1] : runs[0];
}

function cell(of, { row, runs }) {
  if (runs.length === 1) return [of.text(row), of.isNumber ? of.error(row) : ""];
  if (!of.isNumber) {
    const counts = new Map();
    for (const run of runs) counts.set(of.text(run), (counts.get(of.text(run)) ?? 0) + 1);
    const texts = [...counts].filter(([word]) => word !== "");
    if (texts.length === 1 && texts[0][1] === runs.length) return [texts[0][0], ""];
    texts.sort((a, b) => outcomeOrder(a[0]) - outcomeOrder(b[0]));
    return [of.name === "job" ? `${runs.length} runs` : texts.map(([word, number]) => `${number} ${word}`).join(", "), ""];
  }
  const known = measured(of, runs).map((run) => of.cells[run]);
  if (!known.length) return ["", ""];
  const at = middle(of, runs);
  const [least, largest] = [known[0], known[known.length - 1]];
  const range = least < largest ? ` [${of.rounded(least, at)} to ${of.rounded(largest, at)}]` : "";
  // A margin of a point is its smallest.
  const value = of.name === "smallest_margin" ? least : d3.median(known);
  return [of.rounded(value, at) + range, of.error(at)];
}

/** What the run before had, in brackets, where it differs: numbers with their change in percent. */
function was(of, runs) {
  const other = before.find(({ name }) => name === of.name);
  if (!state.before || !other || of.name === "job") return "";
  if (!of.isNumber) {
    const words = new Set(runs.filter((row) => other.has(row) && other.text(row) !== of.text(row)).map((row) => other.text(row)));
    return words.size ? ` (${[...words].join(", ")})` : "";
  }
  const [now, then] = [of, other].map((each) => d3.median(measured(each, runs).map((row) => each.cells[row])));
  if (then === undefined || now === undefined || now === then) return "";
  const change = then === 0 ? "" : `, ${now > then ? "+" : "−"}${shown(Number(Math.abs((100 * (now - then)) / then).toPrecision(2)))} %`;
  return ` (${other.rounded(then, runs[0])}${change})`;
}

function filterWord(of, row) {
  if (of.isNumber) state.ranges[of.name] = [of.cells[row], of.cells[row]];
  else state.words[of.name] = [of.text(row)];
  state.page = 0;
  refresh();
}

function tick(runs, is) {
  const set = new Set(state.ticked);
  for (const row of runs) if (is) set.add(row); else set.delete(row);
  state.ticked = [...set].sort((a, b) => a - b);
  remember();
  for (const call of onTicked) call();
}

function drawHead() {
  const sorted = (of) => (state.sort?.name === of.name ? (state.sort.direction > 0 ? " ▲" : " ▼") : "");
  const head = (of) => {
    const turn = () => {
      const same = state.sort?.name === of.name;
      state.sort = same && state.sort.direction < 0 ? null : { name: of.name, direction: same ? -1 : 1 };
      refresh();
    };
    const order = { " ▲": "ascending", " ▼": "descending" }[sorted(of)];
    return element("th", { scope: "col", class: of.isNumber ? "" : "word", "aria-sort": order, title: of.meaning },
      element("button", { onclick: turn }, of.label + sorted(of)));
  };
  byId("rows").tHead.replaceChildren(element("tr", {},
    element("th", { scope: "col" }, "✓"), ...visible().map(head)));
}

function drawRow(entry, className = "") {
  const { runs } = entry;
  const ticked = runs.every((row) => state.ticked.includes(row));
  const label = `compare ${column("job")?.text(entry.row) ?? entry.row}`;
  const box = element("input", { type: "checkbox", checked: ticked, "aria-label": label,
    onchange: (event) => tick(runs, event.target.checked) });
  const open = () => {
    const is = state.open.includes(entry.row);
    state.open = is ? state.open.filter((row) => row !== entry.row) : [...state.open, entry.row];
    refresh();
  };
  const fold = runs.length > 1
    ? [" ", element("button", { "aria-label": "show the runs", onclick: open }, state.open.includes(entry.row) ? "−" : "+")] : [];
  const cells = visible().map((of) => {
    const [text, error] = cell(of, entry);
    const click = of.role !== "measure" && runs.length === 1 || of.role === "parameter" && of.varies;
    const inside = click && text ? element("button", { class: "value", title: "keep only this value",
      onclick: () => filterWord(of, entry.row) }, text) : text;
    return element("td", { class: of.isNumber ? "" : "word" }, inside, element("span", { class: "error" }, error), element("span", { class: "before" }, was(of, entry.runs)));
  });
  const film = runs.some((row) => shapeAt(row)) ? [element("span", { title: "has shapes in motion" }, " ◆")] : [];
  return element("tr", { class: className }, element("td", {}, box, ...film, ...fold), ...cells);
}

function drawRows() {
  const pages = Math.max(1, Math.ceil(entries.length / pageRows));
  state.page = Math.min(state.page, pages - 1);
  const from = state.page * pageRows;
  const body = [];
  for (const entry of entries.slice(from, from + pageRows)) {
    body.push(drawRow(entry));
    if (entry.runs.length > 1 && state.open.includes(entry.row)) {
      body.push(...entry.runs.map((row) => drawRow({ row, runs: [row] }, "run")));
    }
  }
  byId("rows").tBodies[0].replaceChildren(...body);
  byId("page").textContent = `page ${state.page + 1} of ${pages}`;
}

function drawFilters() {
  const remove = (of, name) => element("button", { "aria-label": `remove the filter of ${name}`,
    onclick: () => { delete of[name]; refresh(); } }, "×");
  const words = Object.entries(state.words).map(([name, all]) =>
    element("span", { class: "chip" }, `${name} = ${all.join(", ")} `, remove(state.words, name)));
  const ranges = Object.entries(state.ranges).map(([name, [low, high]]) =>
    element("span", { class: "chip" }, low === high ? `${name} = ${shown(low)} `
      : `${name} from ${shown(low)} to ${shown(high)} `, remove(state.ranges, name)));
  const all = data.rows === 1 ? "1 row" : `${data.rows} rows`;
  const count = passing.length === data.rows ? all : `${passing.length} of ${all}`;
  const points = entries.length === passing.length ? "" : `, ${entries.length} points`;
  byId("filters").replaceChildren(...words, ...ranges, element("span", { id: "count" }, count + points));
}

function drawColumns() {
  byId("columns").replaceChildren(...columns.map((of) => {
    const change = (event) => {
      const now = new Set(hidden());
      if (event.target.checked) now.delete(of.name); else now.add(of.name);
      state.hidden = [...now];
      refresh();
    };
    return element("label", { title: of.meaning },
      element("input", { type: "checkbox", checked: !hidden().includes(of.name), onchange: change }), ` ${of.label}`);
  }));
}

function csv() {
  const quoted = (text) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
  const plain = (of, row) => (of.isNumber ? (of.has(row) ? String(Number(of.cells[row].toPrecision(7))) : "") : of.text(row));
  const kept = columns.filter((of) => visible().includes(of) || isReplicate(of));
  const runs = entries.flatMap((entry) => entry.runs);
  const rows = runs.map((row) => kept.map((of) => quoted(plain(of, row))).join(","));
  return [kept.map((of) => quoted(of.label)).join(","), ...rows].join("\n") + "\n";
}

/** Everything that follows from filters and order. */
function refresh() {
  listed();
  drawHead();
  drawRows();
  drawFilters();
  drawParallel();
  remember();
}

function startTable() {
  byId("runs-label").hidden = !pointOf;
  byId("before-label").hidden = !before.length;
  byId("before").checked = state.before;
  byId("before").addEventListener("change", (event) => { state.before = event.target.checked; refresh(); });
  byId("runs").checked = state.runs;
  byId("runs").addEventListener("change", (event) => { state.runs = event.target.checked; refresh(); });
  byId("copy").addEventListener("click", async () => {
    try {
      await navigator.clipboard.writeText(csv());
      byId("copy").textContent = "Copied";
    } catch {
      downloadText(`${data.study}.csv`, csv(), "text/csv");
    }
  });
  byId("clear").addEventListener("click", () => { state.words = {}; state.ranges = {}; refresh(); });
  byId("untick").addEventListener("click", () => { tick(state.ticked, false); drawRows(); });
  byId("page-back").addEventListener("click", () => { state.page = Math.max(0, state.page - 1); drawRows(); remember(); });
  byId("page-on").addEventListener("click", () => { state.page += 1; drawRows(); remember(); });
  const measures = columns.filter((of) => of.isNumber && of.role === "measure" && of.varies);
  measures.sort((a, b) => limited.includes(b.name) - limited.includes(a.name) || (b.shown === true) - (a.shown === true));
  byId("best-measure").append(...measures.map((of) => element("option", { value: of.name }, of.label)));
  byId("best").addEventListener("click", () => {
    const of = column(byId("best-measure").value);
    if (!of) return;
    const values = passing.filter((row) => of.has(row)).map((row) => of.cells[row]).sort((a, b) => a - b);
    const count = Math.max(1, Math.round((values.length * byId("best-part").value) / 100));
    if (!values.length) return;
    state.ranges[of.name] = byId("best-end").value === "smallest"
      ? [values[0], values[count - 1]] : [values[values.length - count], values[values.length - 1]];
    refresh();
  });
  drawColumns();
  refresh();
}
