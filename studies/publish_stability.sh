#!/usr/bin/env bash
# Runs studies/stability.json (a quarter of an hour on two cores; finished cells are not run again) and writes the maps, borders
# and pictures of where methods fail to RESULTS/published: maps.txt, cells.csv and one SVG a map.
#
# usage: studies/publish_stability.sh [CHECKS [RESULTS]]
set -euo pipefail
cd "$(dirname "$0")/.."
checks=${1:-target/release/billow-checks}
results=${2:-results/stability}
out=$results/published
mkdir -p "$out"
rm -rf "$results/charts"

# Outcomes that are not as expected end this script; the pictures and lines that show them are written before.
code=0
"$checks" stability studies/stability.json --results "$results" > "$results/maps.txt" || code=$?
# A run that was stopped draws nothing, and what is published stays.
[ -d "$results/charts" ] || exit "$code"
sed "\\|$results/charts/|d" "$results/maps.txt" > "$out/maps.txt"
"$checks" stability studies/stability.json --results "$results" --format csv --no-pictures -q > "$out/cells.csv" 2> /dev/null || true

rm -f "$out"/*.svg "$out"/*.png
cp "$results"/charts/*.svg "$out"
echo "written to $out: $(find "$out" -type f | wc -l) files, $(du -sk "$out" | cut -f 1) KiB; exit code of the maps: $code"
exit "$code"
