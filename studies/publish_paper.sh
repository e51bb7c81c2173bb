#!/usr/bin/env bash
# Runs the three studies of the paper's cases (two hours of one core; finished jobs are not run again) and
# writes their tables and pictures to results/paper/published.
#
# usage: studies/publish_paper.sh [BILLOW [RESULTS]]
set -euo pipefail
cd "$(dirname "$0")/.."
billow=${1:-target/release/billow}
results=${2:-results}
out=results/paper/published
mkdir -p "$out"

for study in paper paper-ensemble paper-mesh; do
  "$billow" run "studies/$study.json" --results "$results/$study" -q > "$out/$study.txt"
  sed -i '/^  results  /d; /^  next  /,$d' "$out/$study.txt"
  cp "$results/$study/summary.parquet" "$out/$study.parquet"
done

# table STUDY TITLE OPTION...: one section of tables.md.
table() {
  local study=$1 title=$2
  shift 2
  printf '\n## %s\n\n```text\n' "$title"
  "$billow" table "$results/$study" -q "$@"
  printf '```\n'
}
measures=verdict,volume_ratio,height_ratio,final_z_rim,final_volume,final_pressure,peak_vz,peak_kinetic_energy
{
  printf '# Tables\n\nWritten by studies/publish_paper.sh. The Parquet files have all columns and every run.\n'
  table paper 'paper.json: n 8' --columns "strategy,residual_gas,compression,$measures"
  table paper-ensemble 'paper-ensemble.json: n 5, five seeds'
  table paper-ensemble 'paper-ensemble.json: end states' \
    --columns strategy,compression,deployed,volume_ratio,height_ratio,final_z_rim,final_volume,final_pressure
  table paper-mesh 'paper-mesh.json' --columns "strategy,bending,subdivisions,$measures"
} > "$out/tables.md"

# chart NAME STUDY OPTION...
chart() {
  local name=$1 study=$2
  shift 2
  "$billow" chart "$results/$study" -q --out "$out/$name.png" "$@" > /dev/null
}
curves=z_centre,volume,pressure,kinetic_energy
for compression in 0 1; do
  chart "curves-$compression" paper --history "$curves" --to '12 s' \
    --where "compression == $compression and residual_gas == 'burst'" \
    --title "The paper's five cases, compression fraction $compression"
done
chart first-second paper --history z_centre,vz,kinetic_energy --to '1 s' \
  --where "residual_gas == 'burst'" --title "The first second of the paper's cases"
chart bands paper-ensemble --history z_centre,volume --where 'compression == 1' --to '12 s' \
  --title "Five seeds of each case, compression fraction 1"
chart outcomes paper-ensemble --measure verdict --map compression,strategy
chart mesh paper-mesh --measure volume_ratio --over subdivisions --by strategy,bending

job=$("$billow" table "$results/paper-mesh" --format csv --columns job --where \
  "strategy == 'residual' and bending == true and subdivisions == 8" | sed -n 2p)
"$billow" frames "$job" "$results/paper-mesh" -q --count 4 --out "$out/frames-bending-8.png" > /dev/null

# Freed by a later inflow: ten minutes.
"$billow" run studies/paper-mesh.json --results "$results/paper-freed" -q --set 'subdivisions=[12]' \
  --set 'bending=[true]' --set 'grid.zip=[{"strategy": ["rapid"], "residual_gas_mass": ["0.05 g"],
  "solver.end_time": ["8.5 s"]}]' > /dev/null
job=$("$billow" table "$results/paper-freed" --format csv --columns job | sed -n 2p)
"$billow" frames "$job" "$results/paper-freed" -q --times '0.2,0.9,1.5,8' \
  --title 'Residual gas, then 1 g/s from 1 s to 8 s; compression 1 with bending, n 12' \
  --out "$out/frames-bending-freed.png" > /dev/null

# Filmstrips: strategy and compression fraction.
while read -r strategy compression; do
  job=$("$billow" table "$results/paper" --format csv --columns job --where \
    "strategy == '$strategy' and compression == $compression and residual_gas == 'burst'" | sed -n 2p)
  "$billow" frames "$job" "$results/paper" -q --count 4 --out "$out/frames-$strategy-$compression.png" > /dev/null
done << END
direct 0
residual 0
residual 1
delayed 1
rapid 1
preinflate 1
END
ls "$out"
