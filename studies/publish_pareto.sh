#!/usr/bin/env bash
# Runs studies/pareto.json (three quarters of an hour on two cores; finished jobs are not run again) and the scenes with an
# exact answer, and writes the tables and pictures of their work-precision diagrams to results/pareto/published.
#
# usage: studies/publish_pareto.sh [BILLOW [CHECKS]]
set -euo pipefail
cd "$(dirname "$0")/.."
billow=${1:-target/release/billow}
checks=${2:-target/release/billow-checks}
results=results/pareto
out=$results/published
mkdir -p "$out"
new=$(mktemp -d)
trap 'rm -rf "$new"' EXIT

# Exit code 1: jobs failed. They are crosses in the diagrams.
"$billow" run studies/pareto.json --results "$results" || [ $? -eq 1 ]

rm -f "$results"/charts/work-precision*

# diagrams OPTION...: the table and the pictures of one cost.
diagrams() {
  "$billow" chart studies/pareto.json --results "$results" -q --work-precision "$@" | sed "\\|^$results/charts/|d"
}
diagrams --cost seconds > "$new/front_seconds.txt"
diagrams --format csv > "$new/configurations.csv"
diagrams | tee "$new/front.txt"
mv "$new"/* "$out"
# pictures of billow have other names than the published ones.
for picture in "$results"/charts/work-precision*; do
  name=$(basename "$picture" | sed 's/work-precision/pareto/; s/-/_/g')
  cp "$picture" "$new/$name"
done
cp "$new"/*.svg "$out"
"$checks" pareto --format csv > "$out/exact.csv"
cp results/exact/charts/pareto*.svg "$out"
# Of the pictures over seconds the overview and these show what the others do not.
# In quiet filling integrators are compared, whose steps do not cost the same.
for picture in pareto pareto_capsule_direct pareto_quiet_filling; do
  cp "$new/$picture"{,_seconds}.png "$out"
done
for scene in capsule_residual end_state slow_filling; do
  cp "$new/pareto_$scene.png" "$out"
done
for scene in exact injected_piston breathing_sphere stretched_disc; do
  cp "results/exact/charts/pareto_$scene.png" "$out"
done
