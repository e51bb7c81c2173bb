"""Parameter studies of inflatable capsules, from Python.

    import billow
    results = billow.run("studies/first.json")     # or a dict with the keys of a study file
    results.answer["deployed"], billow.table(results), billow.cube(results), billow.frames(results, "7d2ad2c0")

The module runs the program `billow` and reads its files; it computes nothing itself.
"""

from __future__ import annotations

import json
import math
import os
import shutil
import subprocess
import sysconfig
import tempfile
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Mapping

import h5py
import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import xarray as xr

__all__ = ["Error", "Frames", "Results", "cube", "frames", "run", "table"]

#: Exit code of a run in which jobs failed: they are rows of the table.
JOBS_FAILED = 1


class Error(RuntimeError):
    """What the program refused: its message, and its exit code."""

    def __init__(self, message: str, code: int) -> None:
        super().__init__(message)
        self.code = code


@dataclass(frozen=True)
class Results(os.PathLike):
    """The folder of the results of a study, and the answer that its run ended with."""

    #: Folder of the results.
    folder: Path
    #: The answer: what `billow run --json` prints.
    answer: dict[str, Any] = field(repr=False)

    def __fspath__(self) -> str:
        return str(self.folder)

    @property
    def report(self) -> Path:
        """The page that answers the study."""
        return self.folder / "report.html"


@dataclass(frozen=True)
class Frames:
    """The stored shapes of a job."""

    #: Times, s, shape (frames,).
    times: np.ndarray
    #: Positions of the nodes, m, shape (frames, nodes, 3).
    positions: np.ndarray
    #: Velocities of the nodes, m/s, shape (frames, nodes, 3).
    velocities: np.ndarray
    #: Larger principal stress of the elements, Pa, shape (frames, elements).
    stresses: np.ndarray
    #: Nodes of the elements, counter-clockwise from outside, shape (elements, 3).
    triangles: np.ndarray
    #: Storey of the elements: 0 the bottom cap, then 1 to M, M + 1 the top cap, shape (elements,).
    storeys: np.ndarray


def _program() -> str:
    """The program: BILLOW_PROGRAM, or the one that was installed with this module, or the one in PATH."""
    given = os.environ.get("BILLOW_PROGRAM")
    beside = Path(sysconfig.get_path("scripts")) / "billow"
    found = given or (str(beside) if beside.exists() else shutil.which("billow"))
    if found is None:
        raise Error("the program billow is not installed: put it into PATH, or install the wheel of `make wheel`", 2)
    return found


def _call(*arguments: str | os.PathLike, allowed: tuple[int, ...] = (0,)) -> str:
    """Runs the program; its stdout."""
    ended = subprocess.run([_program(), *map(os.fspath, arguments)], capture_output=True, text=True, check=False)
    if ended.returncode not in allowed:
        raise Error(ended.stderr.strip(), ended.returncode)
    return ended.stdout


def run(study: Mapping[str, Any] | str | os.PathLike, results: str | os.PathLike | None = None) -> Results:
    """Runs the jobs of a study that are not finished.

    `study` is a dict with the keys of a study file, paths in it relative to this folder, or the path of a study file; `results` the folder of the results, by default
    `results/NAME`, where NAME is the key `name` of a dict (`study` without one) or the name of the file. Failed jobs are
    rows of the table. Raises `Error` for a study that the program refuses.
    """
    options = ["--json", "--quiet"]
    if isinstance(study, Mapping):
        name = str(study.get("name", "study"))
        results = Path("results") / name if results is None else results
        # In this folder, so that paths in the study are relative to it.
        with tempfile.NamedTemporaryFile("w", dir=".", prefix=".billow-", suffix=".json") as file:
            json.dump({"name": name, **study}, file)
            file.flush()
            said = _call("run", file.name, "--results", results, *options, allowed=(0, JOBS_FAILED))
    else:
        where = [] if results is None else ["--results", results]
        said = _call("run", study, *where, *options, allowed=(0, JOBS_FAILED))
    answer = json.loads(said)
    return Results(Path(answer["results"]), answer)


def table(results: str | os.PathLike) -> pd.DataFrame:
    """The summary table, one row a run, in SI. `attrs["units"]` has the unit of each column, `attrs["meanings"]` its meaning."""
    path = Path(os.fspath(results)) / "summary.parquet"
    frame = pd.read_parquet(path)
    columns = json.loads(pq.read_metadata(path).metadata[b"billow"])["columns"]
    frame.attrs["units"] = {column["name"]: column["unit"] for column in columns}
    frame.attrs["meanings"] = {column["name"]: column["meaning"] for column in columns}
    return frame


def cube(results: str | os.PathLike) -> xr.Dataset:
    """Every history over time, and every column of the table, in SI, in memory: over the axes of the grid where its points
    are all combinations of its values, else over `point`, of which the parameters are coordinates."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "cube.nc"
        _call("export", results, "--out", path)
        with xr.open_dataset(path, engine="h5netcdf") as opened:
            data = opened.load()
    axes = [str(name) for name, values in data.coords.items() if values.dims == ("point",) and name != "point"]
    varied = [name for name in axes if len(np.unique(data[name])) > 1] or axes[:1]
    points = set(zip(*(data[name].values.tolist() for name in varied), strict=True))
    whole = math.prod(len(np.unique(data[name])) for name in varied)
    if not varied or not len(points) == whole == data.sizes["point"]:
        return data
    if len(varied) == 1:
        return data.swap_dims(point=varied[0])
    return data.set_index(point=varied).unstack("point")


def frames(results: str | os.PathLike, job: str) -> Frames:
    """The stored shapes of a job, which the first digits of its id name. Raises `KeyError` for an unknown job, or one without
    shapes."""
    ids = [name for name in table(results)["job"].dropna().unique() if job and name.startswith(job)]
    if len(ids) != 1:
        raise KeyError(f"{len(ids)} jobs begin with {job!r}")
    path = Path(os.fspath(results)) / "jobs" / ids[0][:2] / f"{ids[0]}.h5"
    if not path.exists():
        raise KeyError(f"job {job} has not run")
    with h5py.File(path) as file:
        if "VTKHDF" not in file:
            raise KeyError(f"job {job} has no shapes: model piston or storeys, or outputs.frames 0")
        group = file["VTKHDF"]
        times = group["Steps/Values"][:]
        triangles = group["Connectivity"][:].reshape(-1, 3)

        def by_frame(name: str, *shape: int) -> np.ndarray:
            return group[name][:].reshape(len(times), -1, *shape)

        return Frames(
            times=times,
            positions=by_frame("Points", 3),
            velocities=by_frame("PointData/velocity", 3),
            stresses=by_frame("CellData/principal_stress_1"),
            triangles=triangles,
            storeys=group["CellData/storey"][:],
        )
