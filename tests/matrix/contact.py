#!/usr/bin/env python3
"""Deploys the paper's capsule with contact over meshes, loads, compressions, chiralities and seeds.

Every finished run is kept as one JSON summary and is not run again. Exit code 1 if a run is not
done, let film through film or left its ledger's bound.
"""

import argparse
import itertools
import json
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

# Scene and simulated time of each load.
LOADS = {"inflow": ("capsule.json", 1.5), "residual": ("residual_gas.json", 3.0)}
# Largest ledger residual by compression fraction.
RESIDUAL = {0: 5e-3, 1: 2e-2}
# Most energy contact may keep, of the peak kinetic energy.
NOT_RETURNED = 0.01

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
    "intersections residual kept     gap/mm impulses ns/step/element"
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
    told = subprocess.run(command, capture_output=True, text=True)
    if told.returncode not in (0, 1) or not told.stdout:
        sys.exit(f"{name(run)}: exit code {told.returncode}: {told.stderr}")
    unfinished = path.with_suffix(".part")
    unfinished.write_text(told.stdout)
    unfinished.rename(path)
    return json.loads(told.stdout)


def sound(run, told):
    peak = told["measures"]["peak_kinetic_energy"] or 0.0
    return (
        told["status"] == "done"
        and told["passages"] == 0
        and told["intersections"] == 0
        and told["ledger"]["residual"] <= RESIDUAL[run[2]]
        and abs(told["contact"]["unrecovered_contact_energy"]) <= NOT_RETURNED * peak
    )


def line(run, told):
    n, load, c, chirality, seed = run
    contact, measures = told["contact"], told["measures"]
    peak = measures["peak_kinetic_energy"] or float("nan")
    cost = told["wall_seconds"] / (told["steps"] * told["elements"]) * 1e9
    return (
        f"{n} {load:9} {c} {chirality:9} {seed:4} {told['status']:6} {told['volume']:.4f} "
        f"{told['nodes']['top_centre'][2]:.4f} {told['pressure']:7.1f} "
        f"{measures['peak_vz'] or float('nan'):7.2f} {peak:6.2f} {told['passages']:8} "
        f"{told['intersections']:13} {told['ledger']['residual']:.2e} "
        f"{contact['unrecovered_contact_energy'] / peak:+.1e} {contact['smallest_gap'] * 1e3:.4f} "
        f"{contact['collision_impulses']:8} {cost:.0f}"
        + ("" if sound(run, told) else "  OUT OF BAND")
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("results", type=Path, help="folder the runs are kept in")
    parser.add_argument("--billow", default="billow", help="the program")
    parser.add_argument("--scenes", type=Path, default=Path(__file__).parents[2] / "scenes")
    parser.add_argument("--subdivisions", type=int, choices=(5, 8), help="this mesh alone")
    parser.add_argument("--seeds", type=int, help="seeds up to this one alone")
    parser.add_argument("--jobs", type=int, default=2, help="runs at once")
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
        told = pool.map(lambda run: solve(run, args.billow, args.scenes, args.results), runs)
        for run, own in zip(runs, told):
            print(line(run, own), flush=True)
            bad += not sound(run, own)
    print(f"{len(runs)} runs, {bad} out of band")
    sys.exit(bad > 0)


if __name__ == "__main__":
    main()
