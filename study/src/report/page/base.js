"use strict";
// What every part of the page needs: the data, numbers as text, what the reader chose.

const data = JSON.parse(document.getElementById("data").textContent);
const byId = (id) => document.getElementById(id);

/** A new element with attributes, and texts or elements in it. A text is never HTML. */
function element(name, attributes = {}, ...inside) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) made.addEventListener(key.slice(2), value);
    else if (value === true) made.setAttribute(key, "");
    else if (value !== false && value != null) made.setAttribute(key, value);
  }
  made.append(...inside);
  return made;
}

async function inflate(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(stream).arrayBuffer();
}
const singles = async (text) => new Float32Array(await inflate(text));
const indices = async (text) => new Uint32Array(await inflate(text));

/** Numbers in steps: `packed.rs` says how they are stored. */
async function unpack({ low, high, levels, stride, data: text }) {
  const bytes = new Uint8Array(await inflate(text));
  const count = bytes.length / 2;
  const steps = new Uint16Array(count);
  const values = new Float32Array(count);
  const size = (high - low) / levels;
  for (let i = 0; i < count; i++) {
    steps[i] = (bytes[i] | (bytes[count + i] << 8)) + (i < stride ? 0 : steps[i - stride]);
    values[i] = steps[i] > levels ? NaN : low + size * steps[i];
  }
  return values;
}

/** A number with five significant digits. */
function shown(number) {
  if (number === 0) return "0";
  const size = Math.abs(number);
  const text = size >= 1e-3 && size < 1e6 ? String(Number(number.toPrecision(5))) : number.toExponential(3);
  return text.replace("-", "−");
}

/** What the reader chose; the browser remembers it for this study. */
const state = {
  sort: null, words: {}, ranges: {}, hidden: null, ticked: null, log: [], runs: false, before: false, open: [], page: 0, curves: null,
  zoom: null, time: null, colour: "storey", camera: null, scroll: 0,
};
const about = data.provenance.study + data.columns.map(({ name, unit }) => name + unit).join();
const memory = `billow report ${data.study} ${[...about].reduce((sum, letter) => (31 * sum + letter.codePointAt(0)) >>> 0, 7)}`;
try {
  Object.assign(state, JSON.parse(localStorage.getItem(memory)) ?? {});
} catch { /* A browser may refuse to remember. */ }
function remember() {
  try {
    const jobs = (rows) => rows && rows.map((row) => (typeof row === "string" ? row : column("job").text(row)));
    localStorage.setItem(memory, JSON.stringify({ ...state, ticked: jobs(state.ticked), open: jobs(state.open) }));
  } catch { /* As above. */ }
}

/** Downloads a file. */
function download(name, url) {
  element("a", { href: url, download: name }).click();
}
function downloadText(name, text, type) {
  const url = URL.createObjectURL(new Blob([text], { type }));
  download(name, url);
  setTimeout(() => URL.revokeObjectURL(url), 10000);
}

/** Buttons that save an SVG as it is, and as PNG with twice its pixels. */
function exportButtons(name, svgText) {
  const png = () => {
    const picture = new Image();
    picture.onload = () => {
      const canvas = element("canvas", { width: 2 * picture.width, height: 2 * picture.height });
      const context = canvas.getContext("2d");
      context.fillStyle = "#fff";
      context.fillRect(0, 0, canvas.width, canvas.height);
      context.drawImage(picture, 0, 0, canvas.width, canvas.height);
      download(`${name}.png`, canvas.toDataURL("image/png"));
    };
    picture.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(svgText())}`;
  };
  return [
    element("button", { onclick: () => downloadText(`${name}.svg`, svgText(), "image/svg+xml") }, "SVG"), " ",
    element("button", { onclick: png }, "PNG"),
  ];
}
const svgText = (svg) => {
  const copy = svg.cloneNode(true);
  copy.setAttribute("xmlns", "http://www.w3.org/2000/svg");
  copy.setAttribute("font-family", "sans-serif");
  return new XMLSerializer().serializeToString(copy);
};

/** Colours that people with any colour vision tell apart (Okabe and Ito), each with its dashes. */
const COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#000000", "#7f6a00"];
const DASHES = ["", "7 3", "2 3", "8 3 2 3"];
const colourOf = (number) => COLOURS[number % COLOURS.length];
const dashOf = (number) => DASHES[Math.floor(number / COLOURS.length) % DASHES.length];

/** Outcomes from good to bad: each has one colour and one line on every page, whatever is filtered. */
const OUTCOMES = ["safe", "uncertain", "unsafe", "deployed", "partial", "stalled"];
const OUTCOME_COLOURS = ["#0072b2", "#e69f00", "#a50026"];
const outcomeOrder = (word) => (OUTCOMES.includes(word) ? OUTCOMES.indexOf(word) : OUTCOMES.length);
const outcomeLook = (word) => {
  const place = outcomeOrder(word);
  return place < OUTCOMES.length ? [OUTCOME_COLOURS[place % 3], DASHES[place % 3]] : ["#666666", DASHES[3]];
};

/** A line of a legend. */
function legend(text, colour, dash) {
  const line = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  d3.select(line).attr("width", 30).attr("height", 8).attr("aria-hidden", "true").append("line").attr("x2", 30).attr("y1", 4)
    .attr("y2", 4).attr("stroke", colour).attr("stroke-width", 2.5).attr("stroke-dasharray", dash);
  return element("span", { class: "key" }, line, ` ${text}`);
}

/** A column whose cells are read. */
class Column {
  constructor(json) {
    Object.assign(this, json);
    this.label = this.unit ? `${this.name} (${this.unit})` : this.name;
    this.isNumber = json.numbers !== undefined;
  }

  async read() {
    if (this.isNumber) {
      this.cells = await singles(this.numbers);
      if (this.below) [this.lower, this.upper] = [await singles(this.below), await singles(this.above)];
      delete this.numbers;
    } else {
      this.cells = await indices(this.codes);
    }
  }

  has(row) {
    return this.isNumber ? !Number.isNaN(this.cells[row]) : this.words[this.cells[row]] !== "";
  }

  /** The cell for a person. */
  text(row) {
    if (!this.isNumber) return this.words[this.cells[row]];
    return this.has(row) ? this.rounded(this.cells[row], row) : "";
  }

  /** A value with as many digits as the uncertainty of a row leaves. */
  rounded(value, row) {
    const error = Math.max(this.lower?.[row] ?? 0, this.upper?.[row] ?? 0);
    if (!(error > 0)) return shown(value);
    const step = 10 ** (Math.floor(Math.log10(error)) - 1);
    return shown(step * Math.round(value / step));
  }

  /** Its uncertainty as text. */
  error(row) {
    const [below, above] = [this.lower?.[row], this.upper?.[row]];
    if (below === undefined || Number.isNaN(below) || Number.isNaN(above)) return "";
    const [less, more] = [below, above].map((size) => shown(Number(size.toPrecision(2))));
    return less === more ? ` ± ${less}` : ` −${less} +${more}`;
  }

  compare(a, b) {
    if (this.has(a) !== this.has(b)) return this.has(a) ? -1 : 1;
    if (this.isNumber) return this.direction * (this.cells[a] - this.cells[b]);
    return this.direction * this.text(a).localeCompare(this.text(b));
  }
}
const PLACES = { parameter: 1, outcome: 2, measure: 4 };
const limited = data.limits.map(({ measure }) => measure);
const placeOf = (of) => {
  if (of.name === "job") return 0;
  return of.name === "smallest_margin" || limited.includes(of.name) ? 3 : PLACES[of.role];
};
const columns = data.columns.map((json) => new Column(json)).sort((a, b) => placeOf(a) - placeOf(b));
const column = (name) => columns.find((known) => known.name === name);
/** What the run before had, for the rows of this one. */
const before = (data.before ?? []).map((json) => new Column(json));
const ready = Promise.all([...columns, ...before].map((each) => each.read()));
