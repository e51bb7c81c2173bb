#!/usr/bin/env bash
# Runs studies/stability.json (minutes on two cores; finished cells are not run again) and writes the maps, borders and
# pictures of where methods fail to results/stability/published.
#
# usage: studies/publish_stability.sh [BILLOW]
set -euo pipefail
cd "$(dirname "$0")/.."
billow=${1:-target/release/billow}
results=results/stability
out=$results/published
mkdir -p "$out"
rm -rf "$results/charts"

# Outcomes that are not as expected end this script; the pictures and lines that show them are written before.
code=0
"$billow" stability studies/stability.json --results "$results" > "$results/maps.txt" || code=$?
sed "\\|$results/charts/|d" "$results/maps.txt" > "$out/maps.txt"
"$billow" stability "$results" --all --format csv --no-pictures -q > "$out/cells.csv" || true

rm -f "$out"/*.svg "$out"/*.png
for picture in "$results"/charts/*.svg; do
  case $picture in
    *_strip.svg) ;;
    *) cp "$picture" "$out" ;;
  esac
done
# Pictures of the page; the other maps are SVG only.
for picture in overview step step_bag coincident residual_gas mass_flow_rate \
  step_strip step_bag_strip residual_gas_strip stowed_height_strip; do
  if [ -f "$results/charts/$picture.png" ]; then cp "$results/charts/$picture.png" "$out"; fi
done
exit "$code"
