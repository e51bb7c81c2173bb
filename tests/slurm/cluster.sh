# Starts a Slurm cluster of two nodes on this machine, and stops it. Sourced by run.sh.
#
# Without accounting (no slurmdbd), as small sites have it: squeue knows what is in the queue, and no program what was.

cluster=$(mktemp -d)
export SLURM_CONF=$cluster/slurm.conf

munge_answers() {
  munge -n > /dev/null 2>&1
}

start_munge() {
  munge_answers && return
  mkdir -p /run/munge
  chown munge:munge /run/munge
  runuser -u munge -- munged
  wait_for "munge" 10 munge_answers
}

# start_node NAME
start_node() {
  slurmd -N "$1"
}

start_cluster() {
  local host cpus memory
  host=$(hostname -s)
  memory=$(awk '/MemAvailable/ {print int($2 / 1024 / 3)}' /proc/meminfo)
  mkdir "$cluster/state" "$cluster/spool"
  cat > "$SLURM_CONF" <<CONF
ClusterName=billow
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=26817
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
JobCompType=jobcomp/filetxt
JobCompLoc=$cluster/ended.txt
StateSaveLocation=$cluster/state
SlurmdSpoolDir=$cluster/spool/%n
SlurmctldPidFile=$cluster/slurmctld.pid
SlurmdPidFile=$cluster/%n.pid
SlurmctldLogFile=$cluster/slurmctld.log
SlurmdLogFile=$cluster/%n.log
ReturnToService=2
SlurmdTimeout=20
KillWait=5
MpiDefault=none
SchedulerParameters=sched_interval=1,bf_interval=1
NodeName=node1 NodeHostname=$host NodeAddr=127.0.0.1 Port=27001 CPUs=1 RealMemory=$memory
NodeName=node2 NodeHostname=$host NodeAddr=127.0.0.1 Port=27002 CPUs=1 RealMemory=$memory
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
CONF
  start_munge
  slurmctld -c
  start_node node1
  start_node node2
  wait_for "two nodes that are idle" 30 nodes_are_idle
}

nodes_are_idle() {
  [ "$(sinfo --noheader --Node --states=idle --format=%N | wc -l)" -eq 2 ]
}

stop_cluster() {
  local file
  for file in "$cluster"/*.pid; do
    [ -e "$file" ] && kill "$(cat "$file")" 2> /dev/null
  done
  # What a killed node left.
  pkill -9 -f "slurmstepd: \[.*\]" 2> /dev/null
  # The daemons write their state as they end.
  for file in "$cluster"/*.pid; do
    while [ -e "$file" ] && kill -0 "$(cat "$file")" 2> /dev/null; do sleep 0.2; done
  done
  rm -rf "$cluster"
}

# wait_for WHAT SECONDS COMMAND...: until the command succeeds.
wait_for() {
  local what=$1 end=$((SECONDS + $2))
  shift 2
  until "$@"; do
    if [ "$SECONDS" -ge "$end" ]; then
      echo "slurm: no $what in time" >&2
      squeue --array >&2 || true
      tail -n 20 "$cluster"/*.log >&2 || true
      return 1
    fi
    sleep 0.5
  done
}
