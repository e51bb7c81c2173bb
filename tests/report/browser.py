#!/usr/bin/env python3
"""Opens reports of small studies in headless Chromium and uses them: browser.py BILLOW [--pictures DIR]

A test script is put into a copy of each report. It clicks, drags and reads, and goes to a page of a server of this
program with what it found.
"""

import argparse
import http.server
import json
import pathlib
import queue
import shutil
import subprocess
import tempfile
import time
import urllib.parse

CHROMIUM = [
    "chromium", "--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
    "--hide-scrollbars", "--mute-audio", "--disable-dev-shm-usage",
]  # fmt: skip
TIMEOUT = 120
# Seconds until a picture is taken of a page.
WAIT = 4
EARLY = """<script>
const errors = [];
addEventListener("error", (event) => errors.push(String(event.message)));
addEventListener("unhandledrejection", (event) => errors.push(String(event.reason)));
</script>"""
HELP = """
const find = (selector) => document.querySelector(selector);
const every = (selector) => [...document.querySelectorAll(selector)];
const pause = (ms) => new Promise((done) => setTimeout(done, ms));
async function until(what, name) {
  for (let k = 0; k < 400; k++) { if (what()) return; await pause(50); }
  throw new Error(`never: ${name}`);
}
function check(holds, what) { if (!holds) throw new Error(`not so: ${what}`); }
const rows = () => every("#rows tbody tr");
const heads = () => every("#rows thead th").map((head) => head.textContent.replace(/ [▲▼]$/, ""));
const cells = (name) => rows().map((row) => row.children[heads().findIndex((head) => head.startsWith(name))].textContent);
const head = (name) => every("#rows thead button").find((button) => button.textContent.startsWith(name));
const numberOf = (text) => parseFloat(text.replace("−", "-"));
function mouse(target, kind, x, y) {
  target.dispatchEvent(new MouseEvent(kind, { bubbles: true, cancelable: true, clientX: x, clientY: y, view: window }));
}
/** d3 keeps a click away that follows a drag at once. */
async function drag(target, from, to) {
  mouse(target, "mousedown", ...from);
  for (let k = 1; k <= 4; k++) {
    mouse(window, "mousemove", from[0] + ((to[0] - from[0]) * k) / 4, from[1] + ((to[1] - from[1]) * k) / 4);
  }
  mouse(window, "mouseup", ...to);
  await pause(50);
}
/** Pixels of the film that are not white, and a sum that changes with the picture. */
function picture() {
  const film = byId("film");
  const copy = document.createElement("canvas");
  [copy.width, copy.height] = [film.width, film.height];
  copy.getContext("2d").drawImage(film, 0, 0);
  const { data } = copy.getContext("2d").getImageData(0, 0, copy.width, copy.height);
  let [count, sum] = [0, 0];
  for (let i = 0; i < data.length; i += 4) {
    if (data[i] + data[i + 1] + data[i + 2] < 750) { count += 1; sum = (sum * 31 + i + data[i]) % 1000003; }
  }
  return { count, sum };
}
const saved = [];
download = (name, url) => saved.push([name, url]);
"""

PROGRAM_TEXT = "<script>window.taken = 1</script><img src=x onerror='window.taken=1'> \"quoted\" & 'too'"

FIRST = {
    "question": "Does a faster inflow deploy the capsule sooner?",
    "design": {"fit": "cone", "M": 3, "bottom_radius": "500 mm", "top_radius": "365 mm", "height": "1000 mm",
               "stowed_height": "40 mm", "subdivisions": 2},
    "solver": {"model": "film", "end_time": "0.4 s"},
    "limits": {"peak_kinetic_energy": "< 25 J"},
    "outputs": {"frames": 24},
    "grid": {"N": [5, 6], "mass_flow_rate": ["1 g/s", "5 g/s"], "residual_gas_mass": [0, "0.05 g"]},
}  # fmt: skip


def piston(number):
    """That many fast jobs."""
    flows = [f"{1 + 0.01 * k:.2f} g/s" for k in range(number // 100)]
    masses = [f"{0.001 * k:.3f} g" for k in range(100)]
    design = {**FIRST["design"], "N": 6}
    return {"question": "", "design": design, "solver": {"model": "piston", "end_time": "0.2 s"},
            "outputs": {"sample_interval": "10 ms"},
            "grid": {"mass_flow_rate": flows, "residual_gas_mass": masses}}  # fmt: skip


CASES = {
    # name: study, what run must say (exit code), options of run, script
    "first": (FIRST, 0, [], """
        check(find("#question").textContent.startsWith("Does a faster"), "the question");
        check(find("#headline").textContent.length > 10, "the answer");
        check(rows().length === 8, "8 rows");
        check(!heads().some((name) => name.startsWith("M") || name.startsWith("height")), "only columns that vary");
        check(heads().some((name) => name === "mass_flow_rate (g/s)"), "units of the study");
        // Sort up and down.
        head("peak_kinetic_energy").click();
        let values = cells("peak_kinetic_energy").map(numberOf);
        check(values.every((v, k) => k === 0 || values[k - 1] <= v), `sorted ${values}`);
        head("peak_kinetic_energy").click();
        values = cells("peak_kinetic_energy").map(numberOf);
        check(values.every((v, k) => k === 0 || values[k - 1] >= v), `sorted down ${values}`);
        check(find('#rows th[aria-sort="descending"]'), "the order is said");
        // One click filters.
        const place = heads().indexOf("N");
        rows()[0].children[place].querySelector("button.value").click();
        check(rows().length === 4 && find("#count").textContent === "4 of 8 rows", find("#count").textContent);
        find(".chip button").click();
        check(rows().length === 8, "the filter goes");
        // A brush on an axis filters table and lines.
        const overlay = every("#parallel-plot .brush .overlay").at(-1).getBoundingClientRect();
        const x = overlay.left + overlay.width / 2;
        await drag(every("#parallel-plot .brush .overlay").at(-1), [x, overlay.top + overlay.height * 0.5], [x, overlay.bottom - 1]);
        const brushed = rows().length;
        check(brushed > 0 && brushed < 8, `brushed ${brushed}`);
        find("#clear").click();
        // A logarithmic axis.
        const log = every("#parallel-plot text").find((text) => text.textContent === "log");
        mouse(log, "click", 0, 0);
        check(state.log.length === 1 && every("#parallel-plot text").some((text) => text.textContent === "linear"), `log ${state.log}`);
        // The best quarter.
        byId("best-part").value = 25;
        byId("best").click();
        check(rows().length === 2, `best quarter: ${rows().length}`);
        find("#clear").click();
        // Columns stay away when hidden, and are remembered.
        const box = every("#columns label").find((label) => label.textContent.trim() === "status").querySelector("input");
        box.click();
        check(!heads().includes("status"), "status is hidden");
        check(JSON.parse(localStorage.getItem(memory)).hidden.includes("status"), "hidden columns are remembered");
        check(csv().trim().split("\\n").length === 9 && csv().includes("mass_flow_rate (g/s)"), "CSV");
        // Ticked rows are compared.
        for (const tick of every("#rows tbody input:checked")) tick.click();
        await until(() => find("#curve-plots").textContent.startsWith("Tick rows"), "no curves");
        every("#rows tbody input")[0].click();
        every("#rows tbody input")[3].click();
        await until(() => every("#curve-legend .key").length === 2 && every("#curve-plots svg").length === 3, "two curves");
        // Values on hover, zoom and back.
        let zoom = find("#curve-plots .zoom .overlay");
        let area = zoom.getBoundingClientRect();
        mouse(zoom, "mousemove", area.left + area.width / 2, area.top + 20);
        check(/s .*: .* m/.test(find("#curve-plots .read").textContent), find("#curve-plots .read").textContent);
        const y = area.top + area.height / 2;
        await drag(zoom, [area.left + 0.2 * area.width, y], [area.left + 0.4 * area.width, y]);
        await until(() => state.zoom, "zoom");
        await pause(300);
        check(state.zoom[0] > 0.05 && state.zoom[1] < 0.2, `zoom ${state.zoom}`);
        mouse(find("#curve-plots .zoom .overlay"), "dblclick", area.left + 50, y);
        await until(() => state.zoom === null, "no zoom");
        // The limit is drawn.
        every("#curve-columns label").find((label) => label.textContent.includes("kinetic_energy")).querySelector("input").click();
        await until(() => every("#curve-plots text").some((t) => t.textContent.includes("25 J")), "the limit in the curves");
        // Pictures of every kind.
        for (const button of every("#limits figure button, #parallel-export button, #curve-plots button")) button.click();
        await until(() => saved.filter(([name]) => name.endsWith(".png")).length >= 4, "PNG");
        check(saved.filter(([name]) => name.endsWith(".svg")).length >= 4, "SVG");
        check(saved.some(([name, url]) => name.startsWith("parallel") && url.startsWith("data:image/png")), "PNG of the axes");
        check(every("#charts img").length >= 2 && every("#charts img").every((img) => img.complete && img.naturalWidth > 100), "charts");
        // The film moves, turns, is cut and coloured.
        await until(() => film.panes.length === 2, "two films");
        const first = picture();
        check(first.count > 2000, `pixels ${first.count}`);
        byId("time-number").value = "0.3";
        byId("time-number").dispatchEvent(new Event("input"));
        check(state.time === 0.3 && byId("time-text").textContent.includes("stored"), byId("time-text").textContent);
        const later = picture();
        check(later.sum !== first.sum, "another time is another picture");
        byId("section").value = 50;
        byId("section").dispatchEvent(new Event("input"));
        check(picture().sum !== later.sum, "a section");
        byId("section").value = 100;
        byId("section").dispatchEvent(new Event("input"));
        for (const name of ["stress", "speed", "gap"]) {
          byId("colour").value = name;
          byId("colour").dispatchEvent(new Event("change"));
          check(picture().count > 2000 && byId("shape-legend").textContent.includes("Blue is 0"), name);
        }
        const before = state.time;
        byId("play").click();
        await pause(1200);
        check(state.time !== before, "it plays");
        byId("play").click();
        byId("still").click();
        check(saved.at(-1)[0].endsWith("s.png") && saved.at(-1)[1].length > 3000, "a still");
        // Paper shows the study file and every row.
        dispatchEvent(new Event("beforeprint"));
        check(find("#study-file").checkVisibility() && rows().length === 8, "paper");
        dispatchEvent(new Event("afterprint"));
        check(!find("#study-file").checkVisibility(), "and the screen is as before");
        // Names, and no colour alone.
        check(every("canvas, svg[role=img]").every((one) => one.getAttribute("aria-label")), "pictures have names");
        check(every("img").every((one) => one.alt), "charts have names");
        check(every("button").every((one) => one.textContent.trim() || one.getAttribute("aria-label")), "buttons have names");
        check(find("#study-file").textContent.includes("mass_flow_rate"), "the study file");
        return { brushed, saved: saved.length };
    """),
    "texts": ({**FIRST, "question": PROGRAM_TEXT, 
               "limits": {}, "solver": {"model": "piston", "end_time": "0.2 s"},
               "grid": {"mass_flow_rate": ["1 g/s", "2 g/s"]},
               "design": {**FIRST["design"], "N": 6}}, 0, [], """
        check(window.taken === undefined, "no text runs");
        check(find("#question").textContent.includes("<script>window.taken = 1</script>"), "the question is text");
        check(document.querySelectorAll("#question img, #study-file img").length === 0, "no elements from texts");
        await until(() => every("#curve-legend .key").length === 2, "curves");
        check(find("#film").hidden && find("#shape-legend").textContent.includes("No job"), "no shapes are said");
        return {};
    """),
    "outcomes": ({**FIRST, "design": {**{k: v for k, v in FIRST["design"].items() if k != "M"}, "N": 6}, "gas": {"mass_flow_rate": "5 g/s"},
                  "grid": {"M": [1, 3], "solver.step_limit": [5, 1000000], "seed": [1, 2]}}, 1,
                 ["--points", "1/2"], """
        const words = new Set(cells("status"));
        for (const word of ["done", "step_limit", "infeasible", "pending"]) check(words.has(word), `${word} in ${[...words]}`);
        check(rows().length === 8, "every point has a row");
        return { words: [...words] };
    """),
    "none-done": ({**FIRST, "design": {**FIRST["design"], "N": 6}, "gas": {"mass_flow_rate": "5 g/s"}, "grid": {"solver.step_limit": [5, 6]}}, 1, [], """
        check(new Set(cells("status")).size === 1 && cells("status")[0] === "step_limit", "all failed");
        check(find("#topics").textContent.includes("0 of 2"), find("#topics").textContent);
        return {};
    """),
    "one-job": ({**FIRST, "design": {**FIRST["design"], "N": 6}, "gas": {"mass_flow_rate": "5 g/s"}, "grid": {}}, 0, [], """
        check(rows().length === 1, "one row");
        check(find("#parallel-plot").textContent.includes("two columns that vary"), "no axes are said");
        await until(() => film.panes.length === 1, "one film");
        return {};
    """),
    "replicates": ({**FIRST, "design": {**FIRST["design"], "N": 6}, "replicates": {"seed": 3},
                    "grid": {"mass_flow_rate": ["2 g/s", "5 g/s"]}}, 0, [], """
        check(rows().length === 2, "one row a point");
        check(/\\[.* to .*\\]/.test(cells("peak_kinetic_energy")[0]), cells("peak_kinetic_energy")[0]);
        // The median is that of the table, also where a filter takes some runs of a point.
        const of = column("peak_vz");
        const runs = [0, 1, 2].map((row) => of.cells[row]).sort((a, b) => a - b);
        check(measured(of, [0, 1, 2]).length === 3, "three runs count");
        check(cell(of, entries[0])[0].startsWith(of.rounded(runs[1], middle(of, [0, 1, 2]))), cell(of, entries[0])[0]);
        state.ranges.peak_vz = [runs[0], runs[0]];
        refresh();
        check(rows().length === 1 && entries[0].runs.length === 3, "a point keeps its runs");
        find("#clear").click();
        rows()[0].querySelector("button").click();
        check(rows().length === 5, "a point opens to its runs");
        byId("runs").click();
        check(rows().length === 6, "each run");
        byId("runs").click();
        for (const tick of every("#rows tbody input")) if (!tick.checked) tick.click();
        await until(() => find("#curve-legend").textContent.includes("median and range of 3 runs"), "median and range");
        await until(() => every("#curve-plots path[fill-opacity]").length > 0, "a band");
        return {};
    """),
    "search": ({**FIRST, "design": {**FIRST["design"], "N": 6}, "solver": {"model": "storeys", "end_time": "0.4 s"},
                "limits": {"peak_vz": "< 15 m/s"},
                "grid": {"residual_gas_mass": [0, "0.05 g"],
                         "mass_flow_rate": {"bisect": ["0.5 g/s", "5 g/s"], "on": "safe", "tolerance": "20 %"}}}, 0, [], """
        check(find("#topics").textContent.includes("border"), "the border");
        check(find("#limit-list").textContent.includes("15 m/s"), find("#limit-list").textContent);
        check(every("#charts img").length > 0, "its chart");
        check(every("#borders tbody tr").length === 2 && find("#borders thead").textContent.includes("g/s"), "the borders");
        // A job of the answer is ticked and shown by a click.
        const job = find("#topics dd button");
        const before = state.ticked.length;
        job.click();
        check(every("#rows tbody tr").some((row) => row.textContent.includes(job.textContent.slice(4))), "its row is shown");
        find("#untick").click();
        check(before > 0 && state.ticked.length === 0, "no row is ticked");
        return { border: every("#topics dd").length };
    """),
    "meshes": ({**FIRST, "design": {key: value for key, value in FIRST["design"].items() if key != "subdivisions"} | {"N": 6},
                "solver": {"end_time": "0.2 s", "meshes": [2, 3]}, "grid": {"mass_flow_rate": ["2 g/s", "5 g/s"]}}, 0, [], """
        check(rows().length === 2, `one row a point, ${rows().length}`);
        return { heads: heads() };
    """),
    "run-before": ({**FIRST, "question": "And with thicker film?", "design": {**FIRST["design"], "N": 6},
                    "solver": {"model": "storeys", "end_time": "0.3 s"}, "limits": {}, "grid": {"mass_flow_rate": ["1 g/s", "2 g/s"]}}, 0,
                   ["--set", "film.thickness=50 um", "--set", 'grid.mass_flow_rate=["1 g/s", "2 g/s", "3 g/s"]'], """
        const said = find("#topics").textContent;
        check(said.includes("film.thickness") && said.includes("2 of 3 rows were in it"), said);
        check(!find("#rows .before").textContent, "not shown at first");
        byId("before").click();
        const all = rows().map((row) => [...row.querySelectorAll(".before")].map((one) => one.textContent).join(""));
        check(/\\(.*, [+−].* %\\)/.test(all[0]) && all[1] && !all[2], `changes ${all}`);
        return { changes: all };
    """),
    "ten-thousand": (piston(10_000), 0, [], """
        check(data.rows === 10000 && rows().length === 50, "a page of many rows");
        const times = [];
        for (let k = 0; k < 5; k++) {
          const start = performance.now();
          rows()[3 * k].children[heads().findIndex((name) => name.startsWith("mass_flow_rate"))].querySelector("button").click();
          times.push(performance.now() - start);
          find("#clear").click();
        }
        times.sort((a, b) => a - b);
        return { filter_ms: times[2], notes: data.notes };
    """),
}


class Answers(http.server.BaseHTTPRequestHandler):
    """Takes what the pages found."""

    found = queue.Queue()

    def do_GET(self):
        if self.path.startswith("/wait"):
            time.sleep(WAIT)
        if self.path.startswith("/?"):
            self.found.put(json.loads(urllib.parse.unquote(self.path[2:])))
        self.send_response(200)
        self.end_headers()

    def log_message(self, *_):
        """Says nothing."""


def used(page, script, port, folder):
    """What a script finds in a copy of a page."""
    text = page.read_text()
    wrapped = f"""<script>{HELP}
    (async () => {{
      let found;
      try {{
        await until(() => document.body.dataset.ready, "the page is ready");
        found = await (async () => {{ {script.replace("</", "<" + chr(92) + "/").replace("<script", "<" + chr(92) + "script")} }})();
      }} catch (error) {{ found = {{ failed: String(error) }}; }}
      location = `http://127.0.0.1:{port}/?${{encodeURIComponent(JSON.stringify({{ ...found, errors }}))}}`;
    }})();</script></body>"""
    copy = folder / "used.html"
    copy.write_text(text.replace("<style>", EARLY + "<style>", 1).replace("</body>", wrapped, 1))
    profile = folder / "profile"
    shutil.rmtree(profile, ignore_errors=True)
    options = [f"--user-data-dir={profile}", "--window-size=1400,1000", "--remote-debugging-port=0"]
    browser = subprocess.Popen([*CHROMIUM, *options, copy.as_uri()], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        return Answers.found.get(timeout=TIMEOUT)
    except queue.Empty:
        return {"failed": f"no answer in {TIMEOUT} s"}
    finally:
        browser.kill()
        browser.wait()


def pictures(page, name, port, folder):
    """Pictures of a page, wide and narrow. An image that comes late holds the load of a copy back until all is drawn."""
    folder.mkdir(parents=True, exist_ok=True)
    copy = folder / f"{name}.html"
    late = f'<img src="http://127.0.0.1:{port}/wait" alt="">'
    policy = "img-src data: blob:"
    copy.write_text(page.read_text().replace(policy, f"{policy} http:", 1).replace("<noscript>", late + "<noscript>", 1))
    for width, height in [(1400, 5200), (400, 9000)]:
        out = folder / f"{name}-{width}.png"
        options = [f"--window-size={width},{height}", f"--screenshot={out}"]
        subprocess.run([*CHROMIUM, *options, copy.as_uri()], check=True, capture_output=True, timeout=TIMEOUT)
    copy.unlink()


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("billow")
    parser.add_argument("--only", help="cases, comma-separated")
    parser.add_argument("--pictures", type=pathlib.Path, help="folder for pictures of every page")
    options = parser.parse_args()
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Answers)
    import threading

    threading.Thread(target=server.serve_forever, daemon=True).start()
    wanted = options.only.split(",") if options.only else list(CASES)
    failed = 0
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        for name in wanted:
            study, code, more, script = CASES[name]
            file = folder / f"{name}.json"
            file.write_text(json.dumps(study))
            results = folder / name
            start = time.monotonic()
            command = [options.billow, "run", str(file), "--results", str(results), "--quiet"]
            if name == "run-before":
                subprocess.run(command, capture_output=True, check=True)
            run = subprocess.run([*command, *more], capture_output=True, text=True)
            if run.returncode != code:
                failed += 1
                print(f"{name}: run ended with {run.returncode}, not {code}\n{run.stderr}")
                continue
            page = results / "report.html"
            size = page.stat().st_size / 1e6
            seconds = time.monotonic() - start
            found = used(page, script, server.server_port, folder)
            bad = found.get("failed") or found.get("errors")
            failed += bool(bad)
            print(f"{'FAILED' if bad else 'ok':>6} {name}: {size:.1f} MB, run and report {seconds:.1f} s, {json.dumps(found)}")
            if options.pictures:
                pictures(page, name, server.server_port, options.pictures)
    raise SystemExit(1 if failed else 0)


if __name__ == "__main__":
    main()
