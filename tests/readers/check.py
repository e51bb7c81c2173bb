"""Checks that what billow stores opens in the tools people use: values, units, types.

    tests/readers/check.sh RESULTS

RESULTS is the folder of a study that has run. Every history file is opened with h5py and with
xarray (h5netcdf), summary.parquet with pandas and with pyarrow, and the two are held against each
other. The first thing found wrong ends the program with exit code 1.
"""

import hashlib
import json
import struct
import sys
from pathlib import Path

import h5py
import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import xarray as xr

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
    "kinetic_energy": "J",
    "strain_energy": "J",
    "contact_energy": "J",
    "gas_work": "J",
    "ledger_residual": "1",
    "passages": "1",
    "intersections": "1",
}
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
}
TABLE_TYPES = {
    "job": "string",
    "status": "string",
    "verdict": "string",
    "close": "bool",
    "final_volume": "double",
    "final_pressure": "double",
    "ledger_residual": "double",
    "steps": "int64",
    "elements": "int64",
    "physics_version": "int64",
    "content_hash": "string",
}


def check(holds, what):
    if not holds:
        raise SystemExit(f"check.py: {what}")


def same(one, other):
    """Equal to the bit, or both missing."""
    if other is None or (isinstance(other, float) and np.isnan(other)):
        return one is None or (isinstance(one, float) and np.isnan(one))
    return one == other


def content_hash(columns):
    """As history_file.rs computes it: names, lengths, values."""
    digest = hashlib.sha256()
    for name, values in columns:
        digest.update(struct.pack("<Q", len(name)) + name.encode())
        digest.update(struct.pack("<Q", len(values)) + values.astype("<f8").tobytes())
    return digest.hexdigest()


def check_table(path):
    table = pq.read_table(path)
    schema = {field.name: str(field.type).replace("large_", "") for field in table.schema}
    for name, kind in TABLE_TYPES.items():
        check(schema.get(name, "").replace("_view", "") == kind, f"{path}: {name} is {schema.get(name)}, not {kind}")
    metadata = json.loads(pq.read_metadata(path).metadata[b"billow"])
    check(metadata["format"] == "billow-table" and metadata["version"] == 1, f"{path}: {metadata}")
    told = {column["name"]: column for column in metadata["columns"]}
    check(list(told) == table.column_names, f"{path}: the metadata names other columns")
    check(all(column["meaning"] for column in told.values()), f"{path}: a column without meaning")
    for name, unit in TABLE_UNITS.items():
        check(told[name]["unit"] == unit, f"{path}: {name} in {told[name]['unit']}, not {unit}")

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
    with h5py.File(path) as file:
        check(file.attrs["format"] == "billow-history", f"{path}: format")
        check(file.attrs["version"] == 1 and file.attrs["complete"] == 1, f"{path}: version, complete")
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
        values = dict(columns)
        for name, unit in HISTORY_UNITS.items():
            check(group[name].attrs["units"] == unit, f"{path}: {name} in {group[name].attrs['units']}")
        hashed = content_hash(columns)
        check(hashed == file.attrs["content_hash"] == row["content_hash"], f"{path}: content hash {hashed}")

    check((np.diff(values["time"]) > 0).all(), f"{path}: time does not grow")
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


def main():
    results = Path(sys.argv[1])
    frame = check_table(results / "summary.parquet")
    ran = frame[frame["content_hash"].notna()]
    for _, row in ran.iterrows():
        check_history(results / "jobs" / row["job"][:2] / f"{row['job']}.h5", row)
    check(len(ran) > 0, f"{results}: no history")
    print(f"{results}: {len(frame)} rows and {len(ran)} histories read alike by h5py {h5py.__version__},"
          f" xarray {xr.__version__}, pandas {pd.__version__}, pyarrow {pa.__version__}")


if __name__ == "__main__":
    main()
