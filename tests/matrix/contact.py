#!/usr/bin/env python3
"""Deploys the paper's capsule with contact for many meshes, loads, compressions, chiralities and seeds.

The JSON summary of every finished run is stored; a stored run is not repeated. Exit code 1 if a run is
not done, has a passage or an intersection, or exceeds a bound of its energy.
"""

import argparse
import itertools
import json
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

# Scene and simulated time (s) of each load.
LOADS = {"inflow": ("capsule.json", 1.5), "residual": ("residual_gas.json", 3.0)}
# Largest allowed ledger residual for each compression fraction.
MAX_LEDGER_RESIDUAL = {0: 5e-3, 1: 2e-2}
# Largest allowed unrecovered contact energy over the peak kinetic energy.
MAX_UNRECOVERED = 0.01

COARSE = [
    (5, load, c, chirality, seed)
    for seed, load, c, chirality in itertools.product(
        range(1, 6), LOADS, (0, 1), ("same", "alternate")
    )
]
FINE = [
    (8, load, c, "same", seed) for seed, load, c in itertools.product((1, 2), LOADS, (0, 1))
] + [(8, "inflow", 0, "alternate", 1)]

COLUMNS = (
    "n load      c chirality seed status V/m3   z/m     p/Pa   peak_vz KE/J   passages "
    "intersections residual unrecov. gap/mm impulses ns/step/element"
)


def name(run):
    n, load, c, chirality, seed = run
    return f"n{n}_{load}_c{c}_{chirality}_seed{seed}"


def solve(run, billow, scenes, folder):
    n, load, c, chirality, seed = run
    path = folder / f"{name(run)}.json"
    if path.exists():
        return json.loads(path.read_text())
    scene, end_time = LOADS[load]
    sets = {
        "design.subdivisions": n,
        "design.chirality": chirality,
        "film.compression": c,
        "seed": seed,
        "solver.end_time": end_time,
    }
    command = [billow, "solve", str(scenes / scene), "--quiet"]
    for key, value in sets.items():
        command += ["--set", f"{key}={value}"]
    command += ["--shape", str(path.with_suffix(".obj"))]
    process = subprocess.run(command, capture_output=True, text=True)
    if process.returncode not in (0, 1) or not process.stdout:
        sys.exit(f"{name(run)}: exit code {process.returncode}: {process.stderr}")
    unfinished = path.with_suffix(".part")
    unfinished.write_text(process.stdout)
    unfinished.rename(path)
    return json.loads(process.stdout)


def in_band(run, summary):
    peak = summary["measures"]["peak_kinetic_energy"] or 0.0
    return (
        summary["status"] == "done"
        and summary["passages"] == 0
        and summary["intersections"] == 0
        and summary["ledger"]["residual"] <= MAX_LEDGER_RESIDUAL[run[2]]
        and abs(summary["contact"]["unrecovered_contact_energy"]) <= MAX_UNRECOVERED * peak
    )


def table_row(run, summary):
    n, load, c, chirality, seed = run
    contact, measures = summary["contact"], summary["measures"]
    peak = measures["peak_kinetic_energy"] or float("nan")
    cost = summary["wall_seconds"] / (summary["steps"] * summary["elements"]) * 1e9
    return (
        f"{n} {load:9} {c} {chirality:9} {seed:4} {summary['status']:6} {summary['volume']:.4f} "
        f"{summary['nodes']['top_centre'][2]:.4f} {summary['pressure']:7.1f} "
        f"{measures['peak_vz'] or float('nan'):7.2f} {peak:6.2f} {summary['passages']:8} "
        f"{summary['intersections']:13} {summary['ledger']['residual']:.2e} "
        f"{contact['unrecovered_contact_energy'] / peak:+.1e} {contact['smallest_gap'] * 1e3:.4f} "
        f"{contact['collision_impulses']:8} {cost:.0f}"
        + ("" if in_band(run, summary) else "  OUT OF BAND")
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("results", type=Path, help="folder of the stored summaries")
    parser.add_argument("--billow", default="billow", help="the program")
    parser.add_argument("--scenes", type=Path, default=Path(__file__).parents[2] / "scenes")
    parser.add_argument("--subdivisions", type=int, choices=(5, 8), help="only this mesh")
    parser.add_argument("--seeds", type=int, help="only seeds up to this one")
    parser.add_argument("--jobs", type=int, default=2, help="number of parallel runs")
    args = parser.parse_args()
    args.results.mkdir(parents=True, exist_ok=True)
    runs = [
        run
        for run in COARSE + FINE
        if args.subdivisions in (None, run[0]) and (args.seeds is None or run[4] <= args.seeds)
    ]
    print(COLUMNS)
    bad = 0
    with ThreadPoolExecutor(args.jobs) as pool:
        summaries = pool.map(lambda run: solve(run, args.billow, args.scenes, args.results), runs)
        for run, summary in zip(runs, summaries):
            print(table_row(run, summary), flush=True)
            bad += not in_band(run, summary)
    print(f"{len(runs)} runs, {bad} out of band")
    sys.exit(bad > 0)


if __name__ == "__main__":
    main()
