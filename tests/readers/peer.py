"""Runs the Radioss decks of jobs with OpenRadioss, and puts their height, volume and pressure beside those of billow.

    peer.py BILLOW PROGRAMS PICTURE JOB RESULTS [JOB RESULTS ...]

PROGRAMS is the folder of starter_linux64_gf and engine_linux64_gf, which find their files by RAD_CFG_PATH and LD_LIBRARY_PATH. This is
no test: the programs are large, and come from elsewhere. It prints a table for each job and draws one row of curves for each.
"""

import os
import struct
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import h5py
import matplotlib

matplotlib.use("agg")
import matplotlib.pyplot as plt
import numpy as np

from deck import Radioss, fields

TIMES = [0.01, 0.02, 0.04, 0.06, 0.1, 0.2, 0.5, 0.95]
NAMES = {"z_rim": ("mean height of the top ring", "m"), "volume": ("volume", "m³"), "pressure": ("pressure", "Pa")}


def records(path):
    """The records of a time history file, big-endian, each between two copies of its length."""
    data, at = Path(path).read_bytes(), 0
    while at + 4 <= len(data):
        (length,) = struct.unpack_from(">i", data, at)
        yield data[at + 4 : at + 4 + length]
        at += length + 8


def histories(path, deck):
    """Time, height of the followed ring, volume and pressure, of every time: time, totals, parts, nodes, control volume."""
    found = list(records(path))
    steps = []
    while len(found) >= 5 and (len(found[-5]), len(found[-1])) == (4, 36):
        *found, when, _, _, nodes, volume = found
        steps.append([np.frombuffer(record, ">f4").astype(float) for record in (when, nodes, volume)])
    steps.reverse()
    lines = deck.blocks["/TH/NODE/3"][2:]
    followed = [int(fields(line[:20], 10, 10)[0]) for line in lines]
    centre, order = followed[0], sorted(followed)
    start = np.array([deck.nodes[node][2] for node in order])
    ring = np.array([node != centre for node in order])
    # Displacement and velocity of each node, in the order of their numbers.
    heights = start + np.array([nodes.reshape(len(order), -1)[:, 2] for _, nodes, _ in steps])
    volumes = np.array([volume for _, _, volume in steps])
    times = np.array([when[0] for when, _, _ in steps])
    return {"time": times, "z_rim": heights[:, ring].mean(axis=1), "volume": volumes[:, 1], "pressure": volumes[:, 2]}


def seconds(command, folder):
    """Runs a program in a folder. Returns its user seconds."""
    with open(folder / f"{Path(command[0]).name}.log", "w") as log:
        before = os.times().children_user
        done = subprocess.run(command, cwd=folder, stdout=log, stderr=log, env={**os.environ, "OMP_NUM_THREADS": "1"})
    if done.returncode != 0:
        sys.exit(f"exit code {done.returncode}: see {log.name}")
    return os.times().children_user - before


def both(billow, programs, job, results):
    """The histories of the peer and of billow since the release, and the user seconds of the peer."""
    folder = Path(tempfile.mkdtemp(prefix="peer_"))
    subprocess.run([billow, "export", job, results, "--deck", "radioss", folder], check=True, stdout=subprocess.DEVNULL)
    (starter,), (engine,) = folder.glob("*_0000.rad"), folder.glob("*_0001.rad")
    seconds([f"{programs}/starter_linux64_gf", "-i", starter.name, "-np", "1", "-nt", "1"], folder)
    spent = seconds([f"{programs}/engine_linux64_gf", "-i", engine.name, "-nt", "1"], folder)
    name = starter.name.removesuffix("_0000.rad")
    peer = histories(folder / f"{name}T01", Radioss(starter))
    with h5py.File(next(Path(results).glob(f"jobs/*/{job}*.h5"))) as file:
        ours = {column: file[f"history/{column}"][:] for column in ("time", *NAMES)}
    ours["time"] -= ours["time"][-1] - peer["time"][-1]
    return peer, ours, spent


def main(billow, programs, picture, *jobs):
    pairs = list(zip(jobs[::2], jobs[1::2], strict=True))
    figure, rows = plt.subplots(len(pairs), len(NAMES), figsize=(11, 2.6 * len(pairs)), squeeze=False, sharex=True)
    for (job, results), row in zip(pairs, rows):
        began = time.time()
        peer, ours, spent = both(billow, programs, job, results)
        print(f"job {job}: {spent:.1f} s of processor time, {time.time() - began:.1f} s in all")
        print("| time (s) | " + " | ".join(f"{name} (peer)" for name in NAMES) + " |")
        for at in (t for t in TIMES if t <= ours["time"][-1]):
            values = [[np.interp(at, side["time"], side[name]) for side in (ours, peer)] for name in NAMES]
            print(f"| {at} | " + " | ".join(f"{a:.4g} ({b:.4g})" for a, b in values) + " |")
        for axes, (name, (meaning, unit)) in zip(row, NAMES.items()):
            axes.plot(ours["time"], ours[name], label="billow", color="#0072b2")
            axes.plot(peer["time"], peer[name], label="peer", color="#d55e00", linestyle="--")
            axes.set_title(f"{job}: {meaning} ({unit})", fontsize=9)
            axes.grid(alpha=0.3)
    for axes in rows[-1]:
        axes.set_xlabel("time since the release (s)")
    rows[0][0].legend()
    figure.tight_layout()
    figure.savefig(picture, dpi=110)


if __name__ == "__main__":
    main(*sys.argv[1:])
