"use strict";
// Curves over time of the ticked jobs: zoom, values on hover, limits; runs of a point as their median and range.

const MAX_CURVES = 32;
const FIRST = ["z_rim", "height", "vz", "pressure"];
const curveOf = new Map(data.curves.jobs.map((curve) => [curve.row, curve]));
/** Curves that are unpacked. */
const unpacked = new Map();
const redrawCursors = [];

/** The curve of a row, also where its job has another row. */
function curveAt(row) {
  if (curveOf.has(row)) return curveOf.get(row);
  const job = column("job");
  const same = job && data.curves.jobs.find((curve) => job.cells[curve.row] === job.cells[row]);
  return same || null;
}

async function values(curve, name) {
  const key = `${curve.row} ${name}`;
  if (!unpacked.has(key)) {
    const of = data.curves.columns.find((known) => known.name === name);
    const read = await unpack(curve[name]);
    unpacked.set(key, of ? read.map((value) => of.offset + of.scale * value) : read);
  }
  return unpacked.get(key);
}

/** What distinguishes a row, as text. */
function label(row) {
  const parts = columns.filter((of) => of.role === "parameter" && of.varies && !isReplicate(of));
  const texts = parts.map((of) => `${of.name} ${of.text(row)}${of.unit ? ` ${of.unit}` : ""}`);
  return texts.join(", ") || `job ${column("job")?.text(row).slice(0, 8) ?? row}`;
}

/** The ticked points, or runs, that have curves: their name and their curves. */
function chosenCurves() {
  const groups = new Map();
  for (const row of state.ticked) {
    const curve = curveAt(row);
    if (!curve) continue;
    const key = ofPoints() ? `p${pointOf[row]}` : `r${row}`;
    const group = groups.get(key) ?? { name: label(row), curves: [] };
    if (!group.curves.includes(curve)) group.curves.push(curve);
    groups.set(key, group);
  }
  return [...groups.values()].slice(0, MAX_CURVES);
}

/** Value at a time, linear between samples; NaN outside them. */
function at(times, of, time) {
  const last = times.length - 1;
  if (last < 0 || time < times[0] || time > times[last]) return NaN;
  const k = Math.min(last, Math.max(1, d3.bisectLeft(times, time)));
  const part = (time - times[k - 1]) / (times[k] - times[k - 1] || 1);
  return of[k - 1] + part * (of[k] - of[k - 1]);
}

/** Times, middle values and range of the runs of a point. */
async function line({ curves }, name) {
  const having = curves.filter((curve) => curve[name]);
  if (!having.length) return null;
  const all = await Promise.all(having.map(async (curve) => [await values(curve, "time"), await values(curve, name)]));
  if (all.length === 1) return { times: all[0][0], middle: all[0][1] };
  const end = Math.min(...all.map(([times]) => times[times.length - 1]));
  // The times of the run with most samples.
  const most = all.reduce((a, b) => (b[0].length > a[0].length ? b : a));
  const times = Array.from(most[0]).filter((time) => time <= end);
  const sorted = times.map((time) => all.map(([t, v]) => at(t, v, time)).filter((v) => !Number.isNaN(v)).sort((a, b) => a - b));
  return {
    times, middle: sorted.map((of) => d3.median(of)), least: sorted.map((of) => of[0]), largest: sorted.map((of) => of[of.length - 1]),
  };
}

/** Number of the last drawing: one that is overtaken while it unpacks ends. */
let drawing = 0;

async function drawCurves() {
  const mine = ++drawing;
  const groups = chosenCurves();
  const names = data.curves.columns.filter((of) => state.curves.includes(of.name));
  byId("curve-legend").replaceChildren(...groups.map(({ name, curves }, k) =>
    legend(curves.length > 1 ? `${name} (median and range of ${curves.length} runs)` : name, colourOf(k), dashOf(k))));
  const all = await Promise.all(names.map((of) => Promise.all(groups.map((group) => line(group, of.name)))));
  if (mine !== drawing) return;
  redrawCursors.length = 0;
  const plots = names.map((of, k) => drawCurve(of, all[k], groups));
  byId("curve-plots").replaceChildren(...(groups.length ? plots : ["Tick rows of the table that have curves."]));
}

function drawCurve(of, lines, groups) {
  const width = Math.min(900, Math.max(360, byId("curve-plots").clientWidth));
  const [height, left, bottom, top, right] = [260, 70, 34, 22, 20];
  const box = element("div", { class: "plot" });
  const known = lines.filter((line) => line);
  const end = Math.max(0, ...known.map(({ times }) => times[times.length - 1]));
  const [from, to] = state.zoom ?? [0, end || 1];
  const inside = known.flatMap(({ times, middle, least, largest }) => [middle, least ?? [], largest ?? []]
    .flatMap((series) => Array.from(series).filter((value, k) => times[k] >= from && times[k] <= to && !Number.isNaN(value))));
  let [low, high] = inside.length ? d3.extent(inside) : [0, 1];
  const bounds = data.limits.flatMap((limit) => {
    return limit.column === of.name && limit.bound != null ? limit.signs.map((sign) => ({ value: of.offset + of.scale * sign * limit.bound, text: limit.text })) : [];
  });
  for (const { value } of bounds) {
    const room = 0.1 * (high - low);
    if (value > low - (high - low) && value < high + (high - low)) {
      [low, high] = [Math.min(low, value - room), Math.max(high, value + room)];
    }
  }
  if (low === high) [low, high] = [low - 1, high + 1];
  const x = d3.scaleLinear([from, to], [left, width - right]);
  const y = d3.scaleLinear([low, high], [height - bottom, top]).nice();
  const svg = d3.select(box).append("svg").attr("viewBox", `0 0 ${width} ${height}`).attr("width", width).attr("height", height)
    .attr("role", "img").attr("aria-label", `${of.meaning} over time`);
  const clip = `clip-${of.name}`;
  svg.append("clipPath").attr("id", clip).append("rect").attr("x", left).attr("y", top).attr("width", width - right - left)
    .attr("height", height - bottom - top);
  svg.append("g").attr("transform", `translate(0,${height - bottom})`).call(d3.axisBottom(x).ticks(8))
    .append("text").attr("x", width - right).attr("y", 30).attr("text-anchor", "end").attr("fill", "#1b1b1b").text("time (s)");
  svg.append("g").attr("transform", `translate(${left},0)`).call(d3.axisLeft(y).ticks(6).tickFormat((value) => shown(value)));
  svg.append("text").attr("x", left).attr("y", 14).attr("font-size", 12).text(of.unit ? `${of.name} (${of.unit})` : of.name)
    .append("title").text(of.meaning);
  const area = svg.append("g").attr("clip-path", `url(#${clip})`);
  const path = (times, series) => d3.line((_, k) => x(times[k]), (value) => y(value)).defined((value) => !Number.isNaN(value))(series);
  lines.forEach((line, k) => {
    if (!line) return;
    if (line.least) {
      const back = [...line.largest.keys()].reverse().map((i) => `L${x(line.times[i])} ${y(line.largest[i])}`).join("");
      area.append("path").attr("d", `${path(line.times, line.least)}${back}Z`).attr("fill", colourOf(k)).attr("fill-opacity", 0.15);
    }
    area.append("path").attr("d", path(line.times, Array.from(line.middle))).attr("fill", "none").attr("stroke", colourOf(k))
      .attr("stroke-width", 1.5).attr("stroke-dasharray", dashOf(k));
  });
  for (const { value, text } of bounds) {
    area.append("line").attr("x1", left).attr("x2", width - right).attr("y1", y(value)).attr("y2", y(value))
      .attr("stroke", "#b00020").attr("stroke-dasharray", "6 4");
    area.append("text").attr("x", width - right - 4).attr("y", y(value) - 4).attr("text-anchor", "end").attr("font-size", 11)
      .attr("fill", "#b00020").text(text);
  }
  const cursor = area.append("line").attr("y1", top).attr("y2", height - bottom).attr("stroke", "#555").attr("visibility", "hidden");
  const now = area.append("line").attr("y1", top).attr("y2", height - bottom).attr("stroke", "#888").attr("stroke-dasharray", "2 2");
  const moveNow = () => now.attr("x1", x(state.time)).attr("x2", x(state.time));
  moveNow();
  redrawCursors.push(moveNow);
  const read = element("p", { class: "read", "aria-live": "off" });
  const brush = d3.brushX().extent([[left, top], [width - right, height - bottom]]).on("end", (event) => {
    if (!event.sourceEvent || !event.selection) return;
    const zoom = event.selection.map((place) => x.invert(place));
    if (zoom[1] - zoom[0] > 1e-9 * (end || 1)) { state.zoom = zoom; remember(); drawCurves(); }
  });
  svg.append("g").attr("class", "zoom").call(brush)
    .on("mousemove", (event) => {
      const time = x.invert(d3.pointer(event, svg.node())[0]);
      cursor.attr("x1", x(time)).attr("x2", x(time)).attr("visibility", "visible");
      const texts = lines.map((line, k) => [groups[k].name, line ? at(line.times, line.middle, time) : NaN])
        .filter(([, value]) => !Number.isNaN(value)).map(([name, value]) => `${name}: ${shown(value)} ${of.unit}`);
      read.textContent = `${shown(time)} s   ${texts.join("   ")}`;
    })
    .on("mouseleave", () => { cursor.attr("visibility", "hidden"); read.textContent = ""; })
    .on("dblclick", () => { state.zoom = null; remember(); drawCurves(); });
  box.append(read, element("p", { class: "controls" }, ...exportButtons(of.name, () => svgText(svg.node()))));
  return box;
}

function startCurves() {
  const known = data.curves.columns.map((of) => of.name);
  state.curves = (state.curves ?? FIRST).filter((name) => known.includes(name));
  byId("curve-columns").replaceChildren(...data.curves.columns.map((of) => {
    const change = (event) => {
      state.curves = event.target.checked ? [...state.curves, of.name] : state.curves.filter((name) => name !== of.name);
      remember();
      drawCurves();
    };
    return element("label", { title: of.meaning },
      element("input", { type: "checkbox", checked: state.curves.includes(of.name), onchange: change }), ` ${of.name}`);
  }));
  onTicked.push(drawCurves);
  return drawCurves();
}
