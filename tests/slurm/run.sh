#!/usr/bin/env bash
# Runs a study on this machine and on a Slurm cluster of two nodes on this machine, with accidents: a task is killed, a task is
# asked to stop, a node goes down and comes back. The tables must be the same but for what clocks and versions say.
#
# usage: tests/slurm/run.sh [BILLOW [STUDY]]
#
# BILLOW is a program, or an archive of `make dist`, of which the program is taken.
#
# Needs root (it starts munge and the daemons of Slurm) and the packages slurmctld, slurmd, slurm-client, munge. Exit code 77 where
# it cannot run.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
billow=$(realpath "${1:-$here/../../target/release/billow}")
study=$(realpath "${2:-$here/study.json}")

if [ "$(id -u)" -ne 0 ]; then
  echo "slurm: not tested: only root can start munge and the daemons"
  exit 77
fi
for program in slurmctld slurmd sbatch munged; do
  if ! command -v "$program" > /dev/null; then
    echo "slurm: not tested: no $program (make slurm-deps installs it)"
    exit 77
  fi
done

. "$here/cluster.sh"
work=$(mktemp -d)
# Programs of tasks outlive a cluster that is stopped by force.
trap 'stop_cluster || true; pkill -9 -f -- "$work/shared --points" || true; rm -rf "$work"' EXIT
if [[ $billow == *.tar.gz ]]; then
  tar -xzf "$billow" -C "$work"
  billow=$(realpath "$work"/billow-*/billow)
fi
direct=$work/direct
shared=$work/shared

say() { printf 'slurm: %4d s: %s\n' "$SECONDS" "$*"; }

# The table without what a clock measured, and what program it was.
table() {
  "$billow" table "$1" --runs --format json --quiet | python3 -c '
import json, sys
leave_out = {"wall_seconds", "time_per_zone_cycle", "program_version", "commit"}
for row in json.load(sys.stdin):
    print(json.dumps({name: cell for name, cell in row.items() if name not in leave_out}))
'
}

queue_is_empty() { [ -z "$(squeue --noheader)" ]; }
tasks_run() { [ "$(squeue --noheader --states=running | wc -l)" -ge 2 ]; }
pending() { "$billow" status "$shared" --json | python3 -c 'import json, sys; print(json.load(sys.stdin)["pending"])'; }
# The number of the first task that has a process, other than one that was killed.
killed=0
running_task() {
  pgrep -af -- "$work/shared --points" | grep -o 'points [0-9]*' | cut -d ' ' -f 2 | sort -n | grep -vx "$killed" | head -1
}
# Kills the process of a task; a task may end before it is killed.
kill_task() {
  killed=$(running_task)
  [ -n "$killed" ] && pkill -9 -f -- "--points $killed/6 "
}
# Asks a task to stop. scancel gives the signal, and then ends with an error of its array.
ask_task_to_stop() {
  asked=$(running_task)
  [ -n "$asked" ] && { scancel --batch --signal=USR1 "${array}_$asked" || true; }
}

"$billow" run "$study" --results "$direct" --quiet > "$work/direct.txt"
say "the study has run on this machine: $("$billow" table "$direct" --runs --format json -q | python3 -c 'import json, sys; print(len(json.load(sys.stdin)))') jobs"

if ! start_cluster; then
  echo "slurm: not tested: the daemons of Slurm do not start here"
  exit 77
fi
say "two nodes are up: $(sinfo --version)"
"$billow" submit "$study" --results "$shared" --dry-run --tasks 6 > "$work/scripts.txt"
grep -q -- '^#SBATCH --array=1-6$' "$work/scripts.txt"
[ ! -e "$shared" ]
"$billow" submit "$study" --results "$shared" --tasks 6
if "$billow" submit "$study" --results "$shared" --tasks 6 2> "$work/refused.txt"; then
  echo "slurm: a second submission was not refused" >&2
  exit 1
fi
grep -q "still in the queue" "$work/refused.txt"

wait_for "running tasks" 60 tasks_run
"$billow" status "$shared" | grep -E "^  slurm"
wait_for "task to kill" 60 kill_task
say "task $killed was killed"
array=$(python3 -c 'import json, sys; print(json.load(open(sys.argv[1]))["array"])' "$shared/submission/queue.json")
wait_for "task to ask" 60 ask_task_to_stop
say "task $asked was asked to stop"
wait_for "running tasks" 60 tasks_run
sleep 1
# A node goes down with everything that runs on it.
kill -9 "$(cat "$cluster/node2.pid")"
for process in $(pgrep -f "slurmstepd: \[$array" || true); do
  if tr '\0' '\n' < "/proc/$process/environ" 2> /dev/null | grep -q node2 || grep -q node2 "/proc/$process/cmdline"; then
    pkill -9 -P "$process" || true
    kill -9 "$process" || true
  fi
done
say "node 2 is down"
sleep 2
start_node node2
say "node 2 is back"

for submission in 1 2 3 4 5; do
  wait_for "end of submission $submission" 900 queue_is_empty
  left=$(pending)
  say "submission $submission has ended, $left jobs are missing"
  [ "$left" -eq 0 ] && break
  "$billow" submit "$study" --results "$shared" --tasks 6
done
[ "$(pending)" -eq 0 ]
grep -q "stopped by signal" "$shared/submission/task-$asked.txt"
"$billow" doctor "$shared"
table "$direct" > "$work/direct.json"
table "$shared" > "$work/shared.json"
cmp "$work/direct.json" "$work/shared.json"
"$billow" submit "$study" --results "$shared" 2>&1 | grep -q "nothing to submit"
say "the same table: $(wc -l < "$work/shared.json") rows"
