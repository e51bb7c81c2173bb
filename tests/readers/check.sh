#!/bin/sh
# Opens a results folder with h5py, xarray, pandas, pyarrow and vtk:  tests/readers/check.sh RESULTS [CUBE]
# Reads the decks of its jobs:  tests/readers/check.sh --deck BILLOW RESULTS
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
if [ "$1" = --deck ]; then
    for job in $("$2" table "$3" --columns job --format csv | tail -n +2); do
        "$2" export "$job" "$3" --deck radioss "$3/deck" > /dev/null
        "$2" export "$job" "$3" --deck dyna "$3/deck/$job.k" > /dev/null
        "$venv/bin/python" "$here/deck.py" "$3"/deck/job_"$(echo "$job" | cut -c1-8)"_0000.rad "$3/deck/$job.k" "$3"/jobs/*/"$job".h5
    done
    exit
fi
exec "$venv/bin/python" "$here/check.py" "$@"
