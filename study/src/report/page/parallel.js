"use strict";
// Parallel coordinates over the rows of the table: a brush on an axis is a filter.

const MAX_DRAWN = 3000;
const MAX_AXES = 12;

function axes() {
  const wanted = visible().filter((of) => of.varies && of.name !== "job");
  const first = wanted.filter((of) => of.role === "parameter");
  return [...first, ...wanted.filter((of) => of.role === "outcome"), ...wanted.filter((of) => of.role === "measure")]
    .slice(0, MAX_AXES);
}

function drawParallel() {
  const shownAxes = axes();
  const plot = byId("parallel-plot");
  if (shownAxes.length < 2 || !data.rows) {
    plot.replaceChildren("Parallel coordinates need two columns that vary.");
    return;
  }
  const [width, height, top, bottom] = [Math.max(600, 130 * shownAxes.length), 350, 60, 18];
  const svg = d3.select(plot).html("").append("svg").attr("viewBox", `0 0 ${width} ${height}`).attr("width", width)
    .attr("height", height).attr("role", "img").attr("aria-label", "Parallel coordinates of parameters and measures");
  const x = d3.scalePoint(shownAxes.map((of) => of.name), [70, width - 60]);
  const scales = new Map(shownAxes.map((of) => [of.name, scaleOf(of, [height - bottom, top])]));
  const by = column("safety") ?? column("verdict");
  const groups = new Map();
  const drawn = (rows) => (rows.length <= MAX_DRAWN ? rows
    : Array.from({ length: MAX_DRAWN }, (_, k) => rows[Math.floor((k * rows.length) / MAX_DRAWN)]));
  const path = (row) => shownAxes.map((of, k) => {
    const y = of.has(row) ? scales.get(of.name)(of.isNumber ? of.cells[row] : of.text(row)) : height - 4;
    return `${k ? "L" : "M"}${x(of.name).toFixed(1)} ${(y ?? height - 4).toFixed(1)}`;
  }).join("");
  const kept = new Set(passing);
  const others = [];
  for (let row = 0; row < data.rows; row++) if (!kept.has(row)) others.push(row);
  svg.append("path").attr("d", drawn(others).map(path).join("")).attr("fill", "none").attr("stroke", "#ddd");
  for (const row of drawn(passing)) {
    const word = by ? by.text(row) || "no outcome" : "rows";
    groups.set(word, [...(groups.get(word) ?? []), row]);
  }
  for (const word of by?.words ?? []) if (word && !groups.has(word)) groups.set(word, []);
  const order = [...groups].sort((a, b) => outcomeOrder(a[0]) - outcomeOrder(b[0]));
  const opacity = passing.length > 300 ? 0.25 : 0.7;
  for (const [word, rows] of order) {
    const [colour, dash] = outcomeLook(word);
    svg.append("path").attr("d", rows.map(path).join("")).attr("fill", "none").attr("stroke", colour)
      .attr("stroke-dasharray", dash).attr("stroke-opacity", opacity);
  }
  byId("parallel-legend").replaceChildren(...order.map(([word, rows]) => legend(`${word}: ${rows.length}`, ...outcomeLook(word))));
  for (const of of shownAxes) {
    const scale = scales.get(of.name);
    const group = svg.append("g").attr("transform", `translate(${x(of.name)},0)`);
    const axis = d3.axisLeft(scale).ticks(6);
    if (of.isNumber) axis.tickFormat((value) => shown(value));
    group.call(axis);
    const up = shownAxes.indexOf(of) % 2 ? 40 : 26;
    group.append("text").attr("y", top - up).attr("text-anchor", "middle").attr("fill", "#1b1b1b").attr("font-size", 11)
      .attr("cursor", "pointer").text(of.label).on("click", () => {
        delete state.ranges[of.name];
        delete state.words[of.name];
        refresh();
      });
    if (of.isNumber && lowest(of) > 0) {
      const is = state.log.includes(of.name);
      group.append("text").attr("y", top - 12).attr("text-anchor", "middle").attr("fill", "#0b5394").attr("font-size", 10)
        .attr("cursor", "pointer").text(is ? "linear" : "log").on("click", () => {
          state.log = is ? state.log.filter((name) => name !== of.name) : [...state.log, of.name];
          refresh();
        });
    }
    const brush = d3.brushY().extent([[-12, top], [12, height - bottom]]).on("end", (event) => {
      if (event.sourceEvent) brushed(of, scale, event.selection);
    });
    const made = group.append("g").attr("class", "brush").call(brush);
    const range = state.ranges[of.name];
    if (range && range[0] < range[1]) {
      const ends = [scale(range[1]), scale(range[0])].map((y) => Math.min(height - bottom, Math.max(top, y)));
      made.call(brush.move, ends);
    }
  }
  byId("parallel-export").replaceChildren(...exportButtons("parallel", () => svgText(svg.node())));
}

const lowest = (of) => of.cells.reduce((low, value) => (value < low ? value : low), Infinity);

function scaleOf(of, range) {
  if (!of.isNumber) return d3.scalePoint([...of.words].filter((word) => word !== "").sort(), range).padding(0.5);
  const [low, high] = d3.extent(of.cells);
  const ends = low === high ? [low - 1, high + 1] : [low, high];
  return state.log.includes(of.name) && low > 0 ? d3.scaleLog(ends, range) : d3.scaleLinear(ends, range);
}

function brushed(of, scale, selection) {
  delete state.ranges[of.name];
  delete state.words[of.name];
  if (selection && of.isNumber) {
    const [high, low] = selection.map((y) => scale.invert(y));
    state.ranges[of.name] = [low, high];
  } else if (selection) {
    const inside = scale.domain().filter((word) => scale(word) >= selection[0] && scale(word) <= selection[1]);
    state.words[of.name] = inside;
  }
  state.page = 0;
  refresh();
}
