#!/usr/bin/env bash
# Builds the Python wheel of python/ around the program of the last `make dist`, installs it into an environment of its
# own, and uses it there: target/dist/billow-VERSION-py3-none-PLATFORM.whl.
set -euo pipefail
cd "$(dirname "$0")/.."
dist=$(cd "${CARGO_TARGET_DIR:-target}/dist" && pwd)
archive=$(ls -t "$dist"/billow-*.tar.gz | head -1)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
tar -xzf "$archive" -C "$folder"
rm -f "$dist"/billow-*.whl
python3 -m venv "$folder/venv"
pip=("$folder/venv/bin/pip" --quiet --disable-pip-version-check)
BILLOW_PROGRAM=$(echo "$folder"/billow-*/billow) "${pip[@]}" wheel --no-deps --wheel-dir "$dist" ./python
wheel=$(ls "$dist"/billow-*.whl)
"${pip[@]}" install "$wheel" $(grep -E '^(ipykernel|matplotlib|nbclient|nbformat)==' tests/readers/requirements.txt)
(cd "$folder" && PATH="$folder/venv/bin:$PATH" billow --version)
env -u BILLOW_PROGRAM PATH="$folder/venv/bin:$PATH" "$folder/venv/bin/python" tests/readers/module.py docs/first_study.ipynb
echo "$wheel"
