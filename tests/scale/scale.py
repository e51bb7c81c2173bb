#!/usr/bin/env python3
"""Runs a study of many piston jobs and measures what its commands cost: wall time, processor time, peak memory.

    tests/scale/scale.py --billow target/release/billow [--jobs 100000] [--folder DIR] [--keep]

The study lies in a scratch folder (--folder names it; a study that is there is run on, not again). Each command runs
once before it is measured, so that its files are in the cache of the disk.
"""

import argparse
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

# Bounds at 100,000 jobs: seconds, megabytes.
BOUNDS = {"status": 3, "job": 3, "table": 3}
MAX_MEGABYTES = 500
# Values of the axes beside the mass flow rate: N, M.
DESIGNS = 20


def study(jobs):
    """A grid of this number of piston jobs: 20 designs, each with as many mass flow rates."""
    rates = max(1, jobs // DESIGNS)
    return {
        "question": f"What do the commands cost with {rates * DESIGNS} finished jobs?",
        "design": {"fit": "height", "bottom_radius": "500 mm", "height": "1 m",
                   "alpha1_over_phi": 0.9},
        "solver": {"model": "piston", "end_time": "0.3 s"},
        "outputs": {"sample_interval": "10 ms"},
        "grid": {
            "N": [6, 7, 8, 9, 10],
            "M": [3, 4, 5, 6],
            "mass_flow_rate": {"from": "1 g/s", "to": "6 g/s", "steps": rates},
        },
    }


def measured(command, folder):
    """Wall time, processor time (s), peak memory (MB), exit code and output of a command."""
    start = time.monotonic()
    child = subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    output = child.stdout.read()
    _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    seconds = time.monotonic() - start
    return seconds, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024, child.returncode, output


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--billow", required=True, type=Path)
    parser.add_argument("--jobs", type=int, default=100_000)
    parser.add_argument("--folder", type=Path)
    parser.add_argument("--keep", action="store_true", help="keep the scratch folder")
    parser.add_argument("--only", default="", help="commands to measure, comma-separated")
    arguments = parser.parse_args()
    folder = arguments.folder or Path(tempfile.mkdtemp(prefix="billow-scale-"))
    folder.mkdir(parents=True, exist_ok=True)
    try:
        return measure(arguments, folder.resolve())
    finally:
        if not (arguments.folder or arguments.keep):
            shutil.rmtree(folder)


def measure(arguments, folder):
    billow = str(arguments.billow.resolve())
    path = folder / "scale.json"
    if not path.exists():
        path.write_text(json.dumps(study(arguments.jobs), indent=2) + "\n")
    is_new = not (folder / "results").exists()
    seconds, processor, memory, code, _ = measured([billow, "run", "scale.json", "-q"], folder)
    rows = [("run (first)", seconds, processor, memory, None)] if is_new else []
    if code != 0:
        sys.exit(f"billow run ended with {code}")
    results = "results/scale"
    status = json.loads(measured([billow, "status", results, "--json"], folder)[4])
    jobs = status["done"]
    job = next((folder / results / "jobs").glob("*/*.h5")).stem
    commands = {
        "status": ["status", results],
        "run": ["run", "scale.json", "-q"],
        "job": ["job", job, results],
        "compare": ["compare", results, "--by", "N", "--base", "6", "--summary", "-q"],
        "table": ["table", results, "--limit", "20", "-q"],
    }
    chosen = [name for name in arguments.only.split(",") if name] or list(commands)
    failed = []
    for name in chosen:
        command = [billow, *commands[name]]
        measured(command, folder)
        seconds, processor, memory, code, _ = measured(command, folder)
        bound = BOUNDS.get(name)
        rows.append((name, seconds, processor, memory, bound))
        if code != 0:
            failed.append(f"{name} ended with {code}")
        if jobs >= 100_000 and bound and (seconds > bound or memory > MAX_MEGABYTES):
            failed.append(f"{name} is above its bound")
    print(f"{jobs} finished jobs, {os.cpu_count()} cores; {version(billow)}")
    print("command       wall (s)  processor (s)  peak memory (MB)  bound")
    for name, seconds, processor, memory, bound in rows:
        text = f"{bound} s, {MAX_MEGABYTES} MB" if bound else "-"
        print(f"{name:<12}  {seconds:8.2f}  {processor:13.2f}  {memory:16.0f}  {text}")
    if is_new:
        each = 1e3 * rows[0][2] / max(jobs, 1)
        print(f"processor time of a job, with planning, storing and the table: {each:.2f} ms")
    for problem in failed:
        print(problem)
    return 1 if failed else 0


def version(billow):
    return re.sub(r"\s+", " ", subprocess.run([billow, "--version"], capture_output=True, text=True).stdout.strip())


if __name__ == "__main__":
    sys.exit(main())
