"""Checks that common tools read what billow stores: values, units, types.

    tests/readers/check.sh RESULTS [CUBE]

RESULTS is the results folder of a finished study, CUBE what `billow export --out` wrote of it. Every history file is opened with h5py and with xarray
(h5netcdf), the cube with xarray, its frames with the reader of VTK and ParaView, summary.parquet with pandas and with pyarrow.
All of them are compared. The film of no frame intersects itself, as CGAL finds. The first difference ends the program with exit code 1.
"""

import hashlib
import json
import struct
import sys
from pathlib import Path

import h5py
import numpy as np
import pandas as pd
import pint
import pyarrow as pa
import pyarrow.parquet as pq
import xarray as xr
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkVersion
from vtkmodules.vtkCommonDataModel import VTK_TRIANGLE
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline
from vtkmodules.vtkIOHDF import vtkHDFReader

import self_intersections

PINT = pint.UnitRegistry()
HISTORY_UNITS = {
    "time": "s",
    "z_centre": "m",
    "z_rim": "m",
    "z_max": "m",
    "vz": "m/s",
    "volume": "m3",
    "pressure": "Pa",
    "temperature": "K",
    "gas_mass": "kg",
    "lid_force": "N",
    "support_impulse": "N s",
    "kinetic_energy": "J",
    "strain_energy": "J",
    "contact_energy": "J",
    "gas_work": "J",
    "ledger_residual": "1",
    "passages": "1",
    "intersections": "1",
}
# Further columns of film with contact.
FILM_UNITS = {
    "film_stress_99": "Pa",
    "vz_centre": "m/s",
    "film_speed": "m/s",
    "interlayer_pressure": "Pa",
    "interlayer_pressure_mean": "Pa",
    "contact_area_fraction": "1",
    "smallest_gap": "m",
    "contact_pairs": "1",
    "broad_phase_rebuilds": "1",
    "collision_impulses": "1",
    "pinched_volume_fraction": "1",
    "pleat_relative_pressure_difference": "1",
    "pleat_gap": "m",
    "pleat_conductance": "m3/s",
}
UNITS = {"", "1", "s", "m", "m/s", "m2", "m3", "Pa", "K", "kg", "kg/s", "N", "N/m", "J", "Hz", "rad", "ns",
         "kg/m3", "m3/s", "m/s2", "N s", "J/(kg K)", "W/(m2 K)"}
TABLE_UNITS = {
    "job": "",
    "status": "",
    "t_90_z_rim": "s",
    "peak_vz": "m/s",
    "final_volume": "m3",
    "final_pressure": "Pa",
    "phi": "rad",
    "top_radius": "m",
    "steps": "1",
    "wall_seconds": "s",
    "film_stress": "Pa",
    "peak_kinetic_energy": "J",
    "ringing_frequency": "Hz",
    "reference_volume": "m3",
    "ledger_residual": "1",
    "time_per_zone_cycle": "ns",
}
TABLE_TYPES = {
    "job": "string",
    "status": "string",
    "verdict": "string",
    "near_threshold": "bool",
    "final_volume": "double",
    "final_pressure": "double",
    "ledger_residual": "double",
    "steps": "int64",
    "elements": "int64",
    "physics_version": "int64",
    "content_hash": "string",
    "passages": "int64",
    "intersections": "int64",
    "film_stress": "double",
}


def check(holds, what):
    if not holds:
        raise SystemExit(f"check.py: {what}")


def same(a, b):
    """Equal values, or both missing."""
    if b is None or (isinstance(b, float) and np.isnan(b)):
        return a is None or (isinstance(a, float) and np.isnan(a))
    return a == b


# A renamed column enters the content hash under its first name.
FIRST_NAMES = {
    "broad_phase_rebuilds": "contact_searches",
    "collision_impulses": "contact_impulses",
    "numerical_dissipation": "viscous_work",
}


def content_hash(arrays):
    """The hash of history_file: first names, lengths, values."""
    digest = hashlib.sha256()
    for name, values in arrays:
        name = FIRST_NAMES.get(name, name)
        digest.update(struct.pack("<Q", len(name)) + name.encode())
        digest.update(struct.pack("<Q", values.size) + values.astype(values.dtype.newbyteorder("<")).tobytes())
    return digest.hexdigest()


def check_table(path):
    table = pq.read_table(path)
    schema = {field.name: str(field.type).replace("large_", "") for field in table.schema}
    for name, kind in TABLE_TYPES.items():
        check(schema.get(name, "").replace("_view", "") == kind, f"{path}: {name} is {schema.get(name)}, not {kind}")
    metadata = json.loads(pq.read_metadata(path).metadata[b"billow"])
    check(metadata["format"] == "billow-table" and metadata["version"] == 1, f"{path}: {metadata}")
    described = {column["name"]: column for column in metadata["columns"]}
    check(list(described) == table.column_names, f"{path}: the metadata names other columns")
    check(all(column["meaning"] for column in described.values()), f"{path}: a column without meaning")
    for name, unit in TABLE_UNITS.items():
        check(described[name]["unit"] == unit, f"{path}: {name} in {described[name]['unit']}, not {unit}")
    for name, column in described.items():
        check(column["unit"] in UNITS, f"{path}: {name} in {column['unit']}")

    frame = pd.read_parquet(path)
    check(len(frame) == table.num_rows, f"{path}: pandas sees {len(frame)} rows")
    check(frame["job"].is_unique, f"{path}: a job twice")
    check(frame["job"].str.fullmatch("[0-9a-f]{32}").all(), f"{path}: a malformed job id")
    check(frame["status"].notna().all(), f"{path}: a row without status")
    done = frame[frame["status"] == "done"]
    check(len(done) > 0, f"{path}: no job is done")
    check(done["verdict"].isin(["deployed", "partial", "stalled"]).all(), f"{path}: a done row without verdict")
    check((done["final_volume"] > 0).all(), f"{path}: a volume that is not positive")
    infeasible = frame[frame["status"] == "infeasible"]
    check(infeasible["reason"].notna().all(), f"{path}: an infeasible row without reason")
    check(infeasible["final_volume"].isna().all(), f"{path}: an infeasible row with a volume")
    return frame


def check_history(path, row):
    """Checks one history file; returns its number of frames."""
    with h5py.File(path) as file:
        check(file.attrs["format"] == "billow-history", f"{path}: format")
        check(file.attrs["version"] == 2 and file.attrs["complete"] == 1, f"{path}: version, complete")
        check(file.attrs["job"] == path.stem == row["job"], f"{path}: job {file.attrs['job']}")
        check(file.attrs["status"] == row["status"], f"{path}: status {file.attrs['status']}")
        check("design" in json.loads(file.attrs["scene"]), f"{path}: scene without design")
        group = file["history"]
        time = group["time"]
        check(time.is_scale, f"{path}: time is no dimension scale")
        columns = []
        for name, data in group.items():
            check(data.dtype == np.float64, f"{path}: {name} is {data.dtype}")
            check(data.shape == time.shape, f"{path}: {name} has {data.shape}")
            check(isinstance(data.attrs["long_name"], str), f"{path}: {name} without long_name")
            if name != "time":
                check(data.dims[0][0].name == "/history/time", f"{path}: {name} is not along time")
            columns.append((name, data[()]))
            check(data.attrs["units"] in UNITS, f"{path}: {name} in {data.attrs['units']}")
        values = dict(columns)
        for name, unit in HISTORY_UNITS.items():
            check(group[name].attrs["units"] == unit, f"{path}: {name} in {group[name].attrs['units']}")
        film = json.loads(file.attrs["scene"])["solver"]["model"] == "film"
        check(film == ("VTKHDF" in file), f"{path}: film without frames, or frames without film")
        for name, unit in FILM_UNITS.items() if film else []:
            check(group[name].attrs["units"] == unit, f"{path}: {name} in {group[name].attrs['units']}")
        frames = [
            (name, file[name][()])
            for name in ["VTKHDF/Connectivity", "VTKHDF/CellData/storey", "VTKHDF/Steps/Values",
                         "VTKHDF/Points", "VTKHDF/CellData/regime", "VTKHDF/CellData/principal_stress_1",
                         "VTKHDF/CellData/principal_stress_2", "VTKHDF/PointData/velocity",
                         "VTKHDF/PointData/gap"]
            if film
        ]
        hashed = content_hash(columns + frames)
        check(hashed == file.attrs["content_hash"] == row["content_hash"], f"{path}: content hash {hashed}")

    check((np.diff(values["time"]) > 0).all(), f"{path}: time does not increase")
    for column, measure in [
        ("volume", "final_volume"),
        ("pressure", "final_pressure"),
        ("temperature", "final_temperature"),
        ("z_rim", "final_z_rim"),
    ]:
        check(
            same(values[column][-1], row[measure]),
            f"{path}: {measure} is {row[measure]}, the history ends in {values[column][-1]}",
        )

    with xr.open_dataset(path, engine="h5netcdf", group="history") as data:
        check(list(data.sizes) == ["time"], f"{path}: xarray sees dimensions {list(data.sizes)}")
        check(list(data.coords) == ["time"], f"{path}: xarray sees coordinates {list(data.coords)}")
        check(data["time"].dtype == np.float64, f"{path}: xarray turned time into {data['time'].dtype}")
        check(data["pressure"].dims == ("time",), f"{path}: pressure along {data['pressure'].dims}")
        check(data["pressure"].attrs["units"] == "Pa", f"{path}: xarray lost the unit of pressure")
        last = data["volume"].sel(time=values["time"][-1]).item()
        check(same(last, row["final_volume"]), f"{path}: xarray reads another volume")
        for name, column in values.items():
            check((data[name].values == column).all(), f"{path}: xarray reads another {name}")
        half = data.sel(time=slice(0, values["time"][-1] / 2))
        check(0 < half.sizes["time"] < len(values["time"]), f"{path}: xarray cannot select by time")

    return check_frames(path, values, dict(frames)) if film else 0


def check_cube(path, results, frame):
    """Compares the cube with the table and every history."""
    study = json.loads((results / "study.json").read_text())
    grid = {name: axis for name, axis in study["grid"].items() if name not in ("points", "filter")}
    names = [name for key, axis in grid.items() for group in (axis if key == "zip" else [[key]]) for name in group]
    with xr.open_dataset(path, engine="h5netcdf") as cube:
        check(cube.attrs["format"] == "billow-cube" and cube.attrs["complete"] == 1, f"{path}: {cube.attrs['format']}")
        check(cube.attrs["study"] == (results / "study.json").read_text(), f"{path}: another study")
        check(list(cube["z_max"].dims) == ["point", "time"], f"{path}: z_max along {cube['z_max'].dims}")
        check(set(cube.coords) == set(names + ["point", "time"]), f"{path}: coordinates {list(cube.coords)}")
        for name, variable in cube.variables.items():
            unit = variable.attrs["units"]
            check(unit.replace("^", "") in UNITS, f"{path}: {name} in {unit}")
            # An unknown unit raises an error.
            check(not unit or PINT.parse_units(unit) is not None, f"{path}: pint reads no {unit}")
            check(variable.attrs["long_name"], f"{path}: {name} without long_name")
        for name in names:
            check(cube[name].attrs["units"] == ("kg/s" if name == "mass_flow_rate" else "1"), f"{path}: {name}")
        check(cube["time"].dtype == np.float64 and cube["time"].attrs["units"] == "s", f"{path}: time")
        check(cube["status"].size == len(frame), f"{path}: {cube['status'].size} points, {len(frame)} rows")
        grid = cube.set_index(point=names).unstack("point")
        check(grid["status"].size == len(frame), f"{path}: {grid['status'].size} points of the grid")
        for number, (_, row) in enumerate(frame.iterrows()):
            point = cube.isel(point=number)
            for name in ["job", "status", "final_volume", "t_90_z_rim"]:
                check(same(point[name].item(), row[name]), f"{path}: {name} of {row['job']} is {point[name].item()}")
            check(point["verdict"].item() == ("" if pd.isna(row["verdict"]) else row["verdict"]), f"{path}: verdict")
            if row["status"] != "done":
                check(bool(np.isnan(point["pressure"]).all()), f"{path}: {row['job']} is {row['status']} and has values")
                continue
            history = xr.open_dataset(
                results / "jobs" / row["job"][:2] / f"{row['job']}.h5", engine="h5netcdf", group="history")
            with history:
                check(np.array_equal(point["time"], history["time"]), f"{path}: other times")
                for name, values in history.items():
                    check(np.array_equal(point[name], values, equal_nan=True), f"{path}: {name} of {row['job']}")
        print(f"{path}: {dict(cube.sizes)}, {len(cube.data_vars)} variables read by xarray like the histories")


def check_frames(path, values, stored):
    """Compares the frames of VTK's reader with the arrays and the history; returns their number."""
    reader = vtkHDFReader()
    check(reader.CanReadFile(str(path)), f"{path}: no file for vtkHDFReader")
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    times = stored["VTKHDF/Steps/Values"]
    vtk_times = reader.GetOutputInformation(0).Get(vtkStreamingDemandDrivenPipeline.TIME_STEPS())
    check(reader.GetHasTemporalData() and list(vtk_times) == list(times), f"{path}: VTK sees the times {vtk_times}")
    check(reader.GetNumberOfSteps() == len(times), f"{path}: VTK sees {reader.GetNumberOfSteps()} steps")
    check(times[0] == 0 and times[-1] == values["time"][-1], f"{path}: frames from {times[0]} to {times[-1]}")
    cells = stored["VTKHDF/Connectivity"].reshape(-1, 3)
    nodes = len(stored["VTKHDF/Points"]) // len(times)
    storeys = stored["VTKHDF/CellData/storey"]
    regimes = stored["VTKHDF/CellData/regime"].reshape(len(times), len(cells))
    check(regimes.max() <= 2, f"{path}: a regime unknown")
    check(set(storeys) == set(range(storeys.max() + 1)), f"{path}: a storey without elements")
    check(self_intersections.is_seen(stored["VTKHDF/Points"][:nodes], cells), f"{path}: no intersection is seen")
    for step, time in enumerate(times):
        # By number as in a script, and by time as in ParaView.
        reader.SetStep(step)
        reader.UpdateTimeStep(time)
        grid = reader.GetOutputDataObject(0)
        check(grid.IsA("vtkUnstructuredGrid"), f"{path}: VTK reads a {grid.GetClassName()}")
        positions = vtk_to_numpy(grid.GetPoints().GetData())
        check(positions.dtype == np.float32, f"{path}: positions of {positions.dtype}")
        expected = stored["VTKHDF/Points"][step * nodes : (step + 1) * nodes]
        check((positions == expected).all(), f"{path}: VTK reads other positions at {time} s")
        check((vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, 3) == cells).all()
              and grid.GetNumberOfCells() == len(cells)
              and all(grid.GetCellType(cell) == VTK_TRIANGLE for cell in range(len(cells))),
              f"{path}: VTK reads other elements at {time} s")
        data = grid.GetCellData()
        check((vtk_to_numpy(data.GetArray("storey")) == storeys).all(), f"{path}: storeys at {time} s")
        check((vtk_to_numpy(data.GetArray("regime")) == regimes[step]).all(), f"{path}: regimes at {time} s")
        for which in ["principal_stress_1", "principal_stress_2"]:
            expected = stored[f"VTKHDF/CellData/{which}"][step * len(cells) : (step + 1) * len(cells)]
            check((vtk_to_numpy(data.GetArray(which)) == expected).all(), f"{path}: {which} at {time} s")
        points = grid.GetPointData()
        for which in ["velocity", "gap"]:
            expected = stored[f"VTKHDF/PointData/{which}"][step * nodes : (step + 1) * nodes]
            check((vtk_to_numpy(points.GetArray(which)) == expected).all(), f"{path}: {which} at {time} s")
        passed = self_intersections.pairs(positions, cells)
        check(passed == 0, f"{path}: {passed} pairs of elements intersect at {time} s")
        sample = np.flatnonzero(values["time"] == time)
        check(len(sample) == 1, f"{path}: the frame at {time} s is no sample")
        highest = np.float32(values["z_max"][sample[0]])
        check(grid.GetBounds()[5] == highest, f"{path}: {grid.GetBounds()[5]} m high at {time} s, not {highest}")
    return len(times)


def main():
    results = Path(sys.argv[1])
    frame = check_table(results / "summary.parquet")
    ran = frame[frame["content_hash"].notna()]
    frames = sum(
        check_history(results / "jobs" / row["job"][:2] / f"{row['job']}.h5", row) for _, row in ran.iterrows()
    )
    check(len(ran) > 0, f"{results}: no history")
    for cube in sys.argv[2:]:
        check_cube(cube, results, frame)
    print(f"{results}: {len(frame)} rows and {len(ran)} histories with {frames} frames read alike by"
          f" h5py {h5py.__version__}, xarray {xr.__version__}, pandas {pd.__version__}, pyarrow {pa.__version__},"
          f" vtk {vtkVersion.GetVTKVersion()}; no frame intersects itself")


if __name__ == "__main__":
    main()
