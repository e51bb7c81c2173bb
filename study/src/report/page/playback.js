"use strict";
// Shapes in motion: the stored frames of up to four ticked jobs, side by side at one time.

const MAX_PANES = 4;
const STOREYS = ["#4477aa", "#66ccee", "#228833", "#ccbb44", "#ee6677", "#aa3377", "#bbbbbb"];
const PLAY_SECONDS = 8;
/** Part of the time that is shown at first: most films move there. */
const FIRST_TIME = 0.08;
const shapeOf = new Map(data.shapes.jobs.map((shape) => [shape.row, shape]));
const film = { panes: [], renderer: null, camera: null, controls: null, plane: null, left: [], failed: false, playing: false, end: 0, last: 0 };
const shapesRead = new Map();

function shapeAt(row) {
  if (shapeOf.has(row)) return shapeOf.get(row);
  const job = column("job");
  return (job && data.shapes.jobs.find((shape) => job.cells[shape.row] === job.cells[row])) || null;
}

async function readShape(shape) {
  if (!shapesRead.has(shape.row)) {
    const mesh = data.shapes.meshes[shape.mesh];
    mesh.nodesOf ??= await indices(mesh.triangles);
    mesh.storeyOf ??= await indices(mesh.storeys);
    const read = { ...shape, triangles: mesh.nodesOf, storeys: mesh.storeyOf, where: await unpack(shape.positions) };
    for (const name of ["stress", "speed", "gap"]) if (shape[name]) read[`${name}Values`] = await unpack(shape[name]);
    shapesRead.set(shape.row, read);
  }
  return shapesRead.get(shape.row);
}

/** Numbers of the two frames about a time, and how far it is between them. */
function between(times, time) {
  const k = Math.min(times.length - 1, Math.max(1, d3.bisectLeft(times, time)));
  if (times.length === 1) return [0, 0, 0];
  const part = (time - times[k - 1]) / (times[k] - times[k - 1] || 1);
  return [k - 1, k, Math.min(1, Math.max(0, part))];
}

function startRenderer() {
  const canvas = byId("film");
  try {
    film.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
  } catch {
    film.failed = true;
    byId("shape-legend").textContent = "This browser has no WebGL: the shapes in motion need it.";
    canvas.hidden = true;
    return false;
  }
  film.renderer.setClearColor(0xffffff);
  film.renderer.setScissorTest(true);
  film.renderer.localClippingEnabled = true;
  film.camera = new THREE.PerspectiveCamera(35, 1, 0.001, 1000);
  film.camera.up.set(0, 0, 1);
  film.controls = new THREE.OrbitControls(film.camera, canvas);
  film.plane = new THREE.Plane(new THREE.Vector3(0, -1, 0), 1e9);
  film.controls.addEventListener("change", draw);
  film.controls.addEventListener("end", () => {
    state.camera = [...film.camera.position.toArray(), ...film.controls.target.toArray()];
    remember();
  });
  new ResizeObserver(draw).observe(canvas);
  return true;
}

/** One pane: its scene, with corners of its own for every element so that each has one colour. */
function pane(shape) {
  const scene = new THREE.Scene();
  scene.add(new THREE.HemisphereLight(0xffffff, 0x888888, 1.6));
  const sun = new THREE.DirectionalLight(0xffffff, 1.4);
  sun.position.set(1, -2, 3);
  scene.add(sun);
  const corners = shape.triangles.length;
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(3 * corners), 3));
  geometry.setAttribute("color", new THREE.BufferAttribute(new Float32Array(3 * corners), 3));
  const material = new THREE.MeshLambertMaterial({ vertexColors: true, side: THREE.DoubleSide, flatShading: true,
    clippingPlanes: [film.plane] });
  const mesh = new THREE.Mesh(geometry, material);
  mesh.frustumCulled = false;
  scene.add(mesh);
  return { shape, scene, geometry };
}

/** Largest value of a field in all panes but for the highest hundredth, so that a peak does not hide the others. */
function largest(name) {
  const tops = film.panes.map(({ shape }) => {
    const values = shape[`${name}Values`];
    if (!values) return 0;
    const some = Array.from({ length: Math.min(20000, values.length) }, (_, k) =>
      values[Math.floor((k * values.length) / Math.min(20000, values.length))]).filter((v) => !Number.isNaN(v)).sort((a, b) => a - b);
    return some.length ? some[Math.floor(0.99 * (some.length - 1))] : 0;
  });
  return Math.max(...tops, 1e-30);
}

/** From blue over white to red, as seen by any colour vision. */
function ramp(part, colour) {
  const t = Math.min(1, Math.max(0, part));
  return colour.setRGB(0.15 + 0.75 * t, 0.35 + 0.35 * (1 - Math.abs(2 * t - 1)), 0.75 - 0.65 * t);
}

function place({ shape, geometry }, time) {
  const { nodes, triangles, where, storeys } = shape;
  const [before, after, part] = between(shape.times, time);
  const position = geometry.getAttribute("position").array;
  const [a, b] = [3 * nodes * before, 3 * nodes * after];
  for (let corner = 0; corner < triangles.length; corner++) {
    for (let k = 0; k < 3; k++) {
      const i = 3 * triangles[corner] + k;
      position[3 * corner + k] = (1 - part) * where[a + i] + part * where[b + i];
    }
  }
  const colours = geometry.getAttribute("color").array;
  const colour = new THREE.Color();
  const name = state.colour;
  const field = shape[`${name}Values`];
  const frame = part < 0.5 ? before : after;
  const perElement = name === "stress";
  for (let corner = 0; corner < triangles.length; corner++) {
    const triangle = Math.floor(corner / 3);
    if (name === "storey") colour.set(STOREYS[storeys[triangle] % STOREYS.length]);
    else if (field) {
      const size = perElement ? triangles.length / 3 : nodes;
      const value = field[frame * size + (perElement ? triangle : triangles[corner])];
      if (Number.isNaN(value)) colour.set("#dddddd"); else ramp(value / film.largest, colour);
    } else colour.set("#8fb3d9");
    colour.toArray(colours, 3 * corner);
  }
  geometry.getAttribute("position").needsUpdate = true;
  geometry.getAttribute("color").needsUpdate = true;
}

function draw() {
  const { renderer, camera, panes } = film;
  if (!renderer || !panes.length) return;
  const canvas = renderer.domElement;
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  if (!width || !height) return;
  renderer.setPixelRatio(Math.min(2, devicePixelRatio));
  renderer.setSize(width, height, false);
  const across = width < 600 ? Math.min(2, panes.length) : panes.length;
  const down = Math.ceil(panes.length / across);
  camera.aspect = width / across / (height / down);
  camera.updateProjectionMatrix();
  panes.forEach((one, k) => {
    const [x, y] = [((k % across) * width) / across, height - ((Math.floor(k / across) + 1) * height) / down];
    renderer.setViewport(x, y, width / across, height / down);
    renderer.setScissor(x, y, width / across, height / down);
    renderer.render(one.scene, camera);
  });
}

/** The slider moves slowly at first, where films move most. */
const timeOf = (place) => film.end * (place / 1000) ** 2;

function show(time) {
  if (!film.panes.length) return;
  state.time = time;
  byId("time").value = String(film.end ? 1000 * Math.sqrt(time / film.end) : 0);
  if (document.activeElement !== byId("time-number")) byId("time-number").value = String(Number(time.toPrecision(4)));
  const drawn = film.panes.map(({ shape }) => {
    const [before, after, part] = between(shape.times, time);
    const [from, to] = [shape.times[before], shape.times[after]].map(shown);
    return part > 0 && part < 1 ? `between those stored at ${from} and ${to} s` : `as stored`;
  });
  byId("time-text").textContent = [...new Set(drawn)].length === 1 ? `(drawn ${drawn[0]})` : "(drawn between stored shapes)";
  for (const one of film.panes) place(one, time);
  draw();
  for (const call of redrawCursors) call();
}

function frameAll() {
  const box = [Infinity, Infinity, Infinity, -Infinity, -Infinity, -Infinity];
  for (const { shape } of film.panes) {
    for (let i = 0; i < shape.where.length; i++) {
      const k = i % 3;
      box[k] = Math.min(box[k], shape.where[i]);
      box[3 + k] = Math.max(box[3 + k], shape.where[i]);
    }
  }
  film.box = box;
  if (state.camera) {
    film.camera.position.fromArray(state.camera);
    film.controls.target.fromArray(state.camera, 3);
  } else {
    const middle = [0, 1, 2].map((k) => (box[k] + box[3 + k]) / 2);
    const size = Math.hypot(...[0, 1, 2].map((k) => box[3 + k] - box[k]));
    film.controls.target.fromArray(middle);
    film.camera.position.set(middle[0] + 0.7 * size, middle[1] - 1.6 * size, middle[2] + 0.6 * size);
  }
  film.controls.update();
  cut();
}

/** The section plane: what is before it, along y, is cut away. */
function cut() {
  const part = byId("section").value / 100;
  const [low, high] = [film.box?.[1] ?? 0, film.box?.[4] ?? 1];
  film.plane.normal.set(0, 1, 0);
  film.plane.constant = part >= 1 ? 1e9 : -(low + (1 - part) * (high - low));
  draw();
}

/** Number of the last choice: one that is overtaken while it unpacks ends. */
let choosing = 0;

async function setPanes() {
  const mine = ++choosing;
  // One of the runs of each point.
  const chosen = new Map();
  for (const row of state.ticked) {
    const shape = shapeAt(row);
    const key = ofPoints() ? pointOf[row] : shape ?? `row ${row}`;
    if (!chosen.get(key)?.shape) chosen.set(key, { row, shape });
  }
  const all = [...chosen.values()];
  const shapes = [...new Set(all.map(({ shape }) => shape).filter((shape) => shape))].slice(0, MAX_PANES);
  film.left = all.filter(({ shape }) => !shapes.includes(shape))
    .map(({ row, shape }) => `${label(row)} (${shape ? `only ${MAX_PANES} fit` : "no shapes in this file"})`);
  const none = data.shapes.jobs.length ? "Tick rows of the table that have shapes."
    : "No job of this study has stored frames (model piston, or outputs.frames 0).";
  byId("film").hidden = !shapes.length || film.failed;
  if (!shapes.length) film.panes = [];
  if (!shapes.length) byId("shape-legend").textContent = none;
  if (!shapes.length || film.failed || (!film.renderer && !startRenderer())) return;
  const read = await Promise.all(shapes.map(readShape));
  if (mine !== choosing) return;
  for (const one of film.panes) one.geometry.dispose();
  film.panes = read.map(pane);
  film.end = Math.max(...read.map(({ times }) => times[times.length - 1]));
  film.largest = largest(state.colour);
  frameAll();
  legendOfShapes();
  show(Math.min(state.time ?? FIRST_TIME * film.end, film.end));
}

function legendOfShapes() {
  if (!film.panes.length) return;
  const units = { stress: "Pa", speed: "m/s", gap: "m" };
  const scale = units[state.colour] ? ` Blue is 0, red ${shown(film.largest)} ${units[state.colour]} and more.` : "";
  const names = film.panes.map(({ shape }, k) => `${k + 1}: ${label(shape.row)}`);
  const left = film.left.length ? ` Not shown: ${film.left.join("; ")}.` : "";
  byId("shape-legend").textContent = `From the upper left, ${names.join("; ")}.${scale}${left}`;
}

function step(now) {
  if (!film.playing) return;
  const passed = film.last ? (now - film.last) / 1000 : 0;
  film.last = now;
  const next = state.time + (passed * film.end) / PLAY_SECONDS;
  show(next > film.end ? 0 : next);
  requestAnimationFrame(step);
}

function play(is) {
  film.playing = is;
  film.last = 0;
  byId("play").textContent = is ? "Stop" : "Play";
  if (is) requestAnimationFrame(step); else remember();
}

/** The film as a picture, with time, jobs and colours below it. */
function still() {
  const drawn = film.renderer.domElement;
  const lines = [`${data.study}, ${shown(state.time)} s`, ...byId("shape-legend").textContent.split(/[.;] /)];
  const size = Math.max(14, Math.round(drawn.width / 80));
  const canvas = element("canvas", { width: drawn.width, height: drawn.height + size * (1.4 * lines.length + 0.6) });
  const context = canvas.getContext("2d");
  context.fillStyle = "#fff";
  context.fillRect(0, 0, canvas.width, canvas.height);
  context.drawImage(drawn, 0, 0);
  context.fillStyle = "#1b1b1b";
  context.font = `${size}px sans-serif`;
  lines.forEach((text, k) => context.fillText(text, size, drawn.height + size * (1.4 * k + 1.3)));
  return canvas.toDataURL("image/png");
}

/** Plays once from the start and saves it as a film. */
function record() {
  if (!film.renderer || film.recorder || !window.MediaRecorder) return;
  const pieces = [];
  film.recorder = new MediaRecorder(film.renderer.domElement.captureStream(24), { mimeType: "video/webm" });
  film.recorder.ondataavailable = (event) => pieces.push(event.data);
  film.recorder.onstop = () => {
    const url = URL.createObjectURL(new Blob(pieces, { type: "video/webm" }));
    download(`${data.study}.webm`, url);
    film.recorder = null;
  };
  show(0);
  film.recorder.start();
  play(true);
  setTimeout(() => { play(false); film.recorder.stop(); }, 1000 * PLAY_SECONDS);
}

function startPlayback() {
  const has = (name) => data.shapes.jobs.some((shape) => shape[name]);
  const choices = ["storey", "stress", "speed", "gap"].filter((name) => name === "storey" || has(name));
  byId("colour").append(...[...choices, "none"].map((name) => element("option", { value: name }, name)));
  byId("colour").value = state.colour;
  byId("colour").addEventListener("change", () => {
    state.colour = byId("colour").value;
    film.largest = largest(state.colour);
    legendOfShapes();
    show(state.time);
    remember();
  });
  byId("time").addEventListener("input", () => show(timeOf(byId("time").value)));
  byId("time").addEventListener("change", remember);
  byId("time-number").addEventListener("input", () => {
    const time = Number(byId("time-number").value);
    if (time >= 0 && time <= film.end) show(time);
  });
  byId("section").addEventListener("input", cut);
  byId("play").addEventListener("click", () => play(!film.playing));
  byId("still").addEventListener("click", () => {
    if (film.renderer) download(`${data.study}-${shown(state.time)}s.png`, still());
  });
  byId("record").addEventListener("click", record);
  onTicked.push(setPanes);
  return setPanes();
}
