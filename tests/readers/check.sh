#!/bin/sh
# Opens a results folder with h5py, xarray, pandas, pyarrow and vtk:  tests/readers/check.sh RESULTS [CUBE]
# Uses the Python module and the notebook:  tests/readers/check.sh --module NOTEBOOK
# The packages are installed once, into .venv next to this script.
set -eu
here=$(CDPATH= cd -- "$(dirname -- "$0")" && pwd)
venv=${VENV:-$here/.venv}
if ! cmp -s "$here/requirements.txt" "$venv/installed.txt"; then
    python3 -m venv "$venv"
    "$venv/bin/pip" install --quiet --disable-pip-version-check -r "$here/requirements.txt"
    cp "$here/requirements.txt" "$venv/installed.txt"
fi
if [ "$1" = --module ]; then
    shift
    exec env PYTHONPATH="$here/../../python" "$venv/bin/python" "$here/module.py" "$@"
fi
exec "$venv/bin/python" "$here/check.py" "$@"
