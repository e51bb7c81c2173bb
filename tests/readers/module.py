"""Uses the Python module `billow`, and runs the notebook of docs: module.py NOTEBOOK

BILLOW_PROGRAM names the program, unless a wheel is installed.
"""

import os
import sys
import tempfile
from pathlib import Path

import billow
import nbclient
import nbformat
import numpy as np

STUDY = {
    "name": "small",
    "design": {"fit": "cone", "M": 3, "N": 6, "bottom_radius": "500 mm", "top_radius": "365 mm", "height": "1 m", "subdivisions": 2},
    "solver": {"model": "film", "end_time": "6 ms"},
    "outputs": {"sample_interval": "0.2 ms", "frames": 6},
    "grid": {"mass_flow_rate": ["1 g/s", "5 g/s"]},
}  # fmt: skip


def refused(study):
    """The message of a study that is refused."""
    try:
        billow.run(study)
    except billow.Error as error:
        assert error.code == 2, error.code
        return str(error)
    raise AssertionError("it was taken")


def check_module():
    results = billow.run(STUDY)
    assert results.folder == Path("results/small") and results.report.exists(), results
    assert results.answer["status"] == {"done": 2}, results.answer["status"]
    table = billow.table(results)
    assert list(table["mass_flow_rate"]) == [0.001, 0.005], table["mass_flow_rate"]
    assert table.attrs["units"]["peak_vz"] == "m/s" and "velocity" in table.attrs["meanings"]["peak_vz"], table.attrs
    cube = billow.cube(results)
    assert cube["pressure"].attrs["units"] == "Pa" and cube.sizes["time"] > 20, cube
    assert dict(billow.cube(results).sizes).keys() == {"time", "mass_flow_rate"}, cube.sizes
    both = {**STUDY, "name": "both", "grid": {"N": [5, 6], **STUDY["grid"]}, "solver": {"model": "piston", "end_time": "0.1 s"}}
    both["design"] = {key: value for key, value in STUDY["design"].items() if key != "N"}
    sizes = billow.cube(billow.run(both)).sizes
    assert (sizes["N"], sizes["mass_flow_rate"], "point" in sizes) == (2, 2, False), sizes
    job = table["job"][1]
    frames = billow.frames(results, job[:8])
    count, elements = len(frames.times), len(frames.triangles)
    assert frames.positions.shape[0] == count >= 5 and frames.positions.shape[2] == 3, frames.positions.shape
    assert frames.stresses.shape == (count, elements) == (count, table["elements"][1]), frames.stresses.shape
    assert frames.velocities.shape == frames.positions.shape and frames.storeys.max() == 4
    assert frames.triangles.max() == frames.positions.shape[1] - 1
    # The highest node of a frame is that of the history.
    highest = cube["z_max"].sel(mass_flow_rate=0.005).sel(time=frames.times[-1], method="nearest").item()
    assert np.isclose(frames.positions[-1, :, 2].max(), highest, rtol=1e-4), (frames.positions[-1, :, 2].max(), highest)
    # The same study again computes nothing; a file is taken as a dict is.
    assert billow.run(STUDY).answer["ran"] == 0
    piston = billow.run({**STUDY, "solver": {"model": "piston", "end_time": "0.1 s"}}, results="elsewhere")
    assert piston.folder == Path("elsewhere")
    for wrong in ["nothing", billow.table(piston)["job"][0]]:
        try:
            billow.frames(piston, wrong)
        except KeyError:
            continue
        raise AssertionError(f"{wrong} has shapes")
    assert "mass_flow_rat" in refused({**STUDY, "grid": {"mass_flow_rat": [1]}})
    assert "no such file" in refused("missing.json").lower()
    failed = billow.run({**STUDY, "name": "failed", "solver": {"model": "film", "end_time": "6 ms", "step_limit": 5}})
    assert failed.answer["failed"] == 2 and set(billow.table(failed)["status"]) == {"step_limit"}


def check_notebook(path):
    notebook = nbformat.read(path, as_version=4)
    nbclient.NotebookClient(notebook, timeout=300, kernel_name="python3").execute()
    cells = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert all(cell.outputs for cell in cells[1:]), "a cell without output"
    print(f"module: table, cube and frames; {path.name}: {len(cells)} cells")


def main():
    notebook = Path(sys.argv[1]).resolve()
    if "BILLOW_PROGRAM" in os.environ:
        os.environ["BILLOW_PROGRAM"] = str(Path(os.environ["BILLOW_PROGRAM"]).resolve())
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        check_module()
        check_notebook(notebook)
        os.chdir("/")


if __name__ == "__main__":
    main()
