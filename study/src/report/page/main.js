"use strict";
// The parts of the page that are texts, and the order in which all begin.

const RELOAD_SECONDS = 5;
const FIRST_TICKED = 4;

/** A line in which each job can be clicked: its row is ticked and shown. */
function withJobs(line) {
  return line.split(/(\bjob [0-9a-f]{8}\b)/).map((part) => {
    const id = part.match(/^job ([0-9a-f]{8})$/)?.[1];
    return id ? element("button", { class: "value", title: "tick and show its row", onclick: () => goTo(id) }, part) : part;
  });
}

function goTo(id) {
  const jobs = column("job");
  for (let row = 0; row < data.rows; row++) {
    if (!jobs.text(row).startsWith(id)) continue;
    [state.words, state.ranges] = [{}, {}];
    tick(ofPoints() ? all().filter((other) => pointOf[other] === pointOf[row]) : [row], true);
    refresh();
    state.page = Math.floor(entries.findIndex(({ runs }) => runs.includes(row)) / pageRows);
    drawRows();
    byId("table").scrollIntoView();
    return;
  }
}

const all = () => Array.from({ length: data.rows }, (_, row) => row);

/** What the searches of borders found, as a table. */
async function startBorders() {
  if (!data.borders) return;
  const { parameter, criterion, rows, columns: json } = data.borders;
  const known = json.map((one) => new Column(one)).filter((of) => of.varies || ["outcome", "from", "to"].includes(of.name));
  await Promise.all(known.map((of) => of.read()));
  const titles = { from: "met from", to: "met to", low: "border from", high: "border to" };
  const title = (of) => (titles[of.name] ? `${titles[of.name]}${of.unit ? ` (${of.unit})` : ""}` : of.label.replaceAll("_", " "));
  const head = known.map((of) => element("th", { scope: "col", class: of.isNumber ? "" : "word", title: of.meaning }, title(of)));
  const line = (row) => element("tr", {}, ...known.map((of) => element("td", { class: of.isNumber ? "" : "word" }, of.text(row))));
  byId("borders").replaceChildren(element("table", {},
    element("caption", {}, `Values of ${parameter} that are decided, for which: ${criterion}`), element("thead", {}, element("tr", {}, ...head)),
    element("tbody", {}, ...Array.from({ length: rows }, (_, row) => line(row)))));
}

function startTexts() {
  document.title = `${data.study}: billow report`;
  byId("study").textContent = data.study;
  byId("question").textContent = data.question;
  byId("running").hidden = !data.running;
  const topic = (wanted) => data.topics.find(([name]) => name === wanted);
  const first = (wanted) => topic(wanted)[1][0].split("; ")[0];
  const answer = topic("answer");
  const short = () => ["safe", "deployed"].filter(topic).map((name) => `${name[0].toUpperCase()}${name.slice(1)}: ${first(name)}.`);
  const choice = data.choice ? [`${data.choice[0].toUpperCase()}${data.choice.slice(1)}.`] : [];
  byId("headline").textContent = (answer ? answer[1] : [...choice, ...short()]).join(" ");
  const others = data.topics.filter((one) => one !== answer);
  byId("topics").replaceChildren(...others.flatMap(([name, lines]) => [
    element("dt", {}, name), element("dd", {}, ...lines.map((line) => element("div", {}, ...withJobs(line))))]));
  byId("notes").replaceChildren(...data.notes.map((note) => element("li", {}, note)));
  const limit = ({ measure, text }) => element("li", {}, text.includes(measure) ? text : `${measure} ${text}`);
  byId("limit-list").replaceChildren(...data.limits.map(limit));
  const chart = ([name, svg]) => {
    const source = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(svg)}`;
    return element("figure", {}, element("img", { src: source, alt: `chart ${name.replaceAll("-", " ")}` }),
      element("figcaption", {}, `${name} `, ...exportButtons(name, () => svg)));
  };
  byId("charts").replaceChildren(...(data.charts.length ? data.charts.map(chart) : ["No chart fits this study."]));
  const { program, commit, physics, study } = data.provenance;
  const rows = [["program", `billow ${program}, commit ${commit}`], ["physics version", String(physics)],
    ["repeat", "save the study file below as study.json, then: billow run study.json"],
    ["one job again", "billow run STUDY --again JOB: the same bits"]];
  byId("provenance").replaceChildren(...rows.flatMap(([name, text]) => [element("dt", {}, name), element("dd", {}, text)]));
  byId("study-file").textContent = study;
}

/** The rows of some jobs: what the browser remembers are jobs, since rows move when a grid grows. */
function rowsOfJobs(ids) {
  const jobs = column("job");
  return all().filter((row) => ids.includes(jobs.text(row)));
}

/** The rows that are ticked at first: with shapes if some have, far apart in the plan. */
function tickFirst() {
  if (state.ticked) return;
  const rows = (data.shapes.jobs.length ? data.shapes.jobs : data.curves.jobs).map(({ row }) => row).sort((a, b) => a - b);
  const count = Math.min(FIRST_TICKED, rows.length);
  const first = Array.from({ length: count }, (_, k) => rows[Math.floor((k * rows.length) / count)]);
  const points = new Set(first.map((row) => pointOf?.[row]));
  state.ticked = pointOf ? all().filter((row) => points.has(pointOf[row])) : first;
}

/** Paper shows what is folded on the screen: all rows, and every detail. */
function startPrint() {
  const details = [...document.querySelectorAll("details")];
  let opened = [];
  window.addEventListener("beforeprint", () => {
    opened = details.filter((one) => !one.open && !one.contains(byId("columns")));
    for (const one of opened) one.open = true;
    pageRows = PAPER_ROWS;
    drawRows();
  });
  window.addEventListener("afterprint", () => {
    for (const one of opened) one.open = false;
    pageRows = SCREEN_ROWS;
    drawRows();
  });
}

/** A running study: the page is read again, and the reader sees what they saw. */
function follow() {
  window.scrollTo(0, state.scroll);
  window.addEventListener("scroll", () => { state.scroll = window.scrollY; });
  if (!data.running) return;
  setTimeout(() => { remember(); location.reload(); }, 1000 * RELOAD_SECONDS);
}

async function start() {
  startTexts();
  await Promise.all([ready, startBorders()]);
  if (data.points) {
    [pointOf, counted] = await Promise.all(data.points.map(indices));
    for (const row of all()) runsOf.set(pointOf[row], [...(runsOf.get(pointOf[row]) ?? []), row]);
  }
  for (const name of ["ticked", "open"]) if (state[name]?.length) state[name] = rowsOfJobs(state[name]);
  tickFirst();
  startTable();
  await startCurves();
  await startPlayback();
  startPrint();
  follow();
  document.body.dataset.ready = "true";
}
start();
