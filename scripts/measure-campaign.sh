#!/usr/bin/env bash
# What a campaign costs, and how it grows with nodes: runs per minute on a Slurm of one node and of
# two, each node a slurmd of this machine with one core to itself; what a run costs beyond its
# simulation; and how long 10 000 rows take to collect.
#
#   scripts/measure-campaign.sh [RUNS [DURATION_S]]      24 runs of 60 s, free-running
#
# Needs a built build/rigwire, the package slurm-wlm, two cores. Every pair of clusters runs within
# minutes, so that their ratio holds on a machine that others use, too: its load is printed. Nothing
# of Slurm's is left running, and nothing of it is beyond loopback.
set -euo pipefail

runs=${1:-24} duration=${2:-60} rounds=2 rows=10000
here=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
export RIGWIRE=$here/build/rigwire
work=$(mktemp -d "${TMPDIR:-/tmp}/rigwire-campaign.XXXXXX")
pids=()
end_cluster() {
  [ ${#pids[@]} != 0 ] || return 0
  # Of one that is interrupted: its tasks first, which would outlive their node.
  scancel --user="$(id -un)" 2>/dev/null || true
  for ((i = 0; i < 50; ++i)); do
    [ -n "$(squeue --noheader 2>/dev/null || true)" ] || break
    sleep 0.2
  done
  kill "${pids[@]}" 2>/dev/null || true
  wait "${pids[@]}" 2>/dev/null || true
  pids=()
}
trap 'end_cluster; rm -rf "$work"' EXIT
trap 'exit 130' INT TERM

load() { cut -d' ' -f1-3 /proc/loadavg; }
# median FILE: of numbers, one a line.
median() { sort -g "$1" | awk '{x[NR]=$1} END {print NR % 2 ? x[(NR+1)/2] : (x[NR/2]+x[NR/2+1])/2}'; }

write_campaign() { # write_campaign FILE RUNS
  cat >"$work/rig.yaml" <<'RIG'
machine: {type: wheeled, wheeled: {level: kinematic}}
devices:
  gnss: {type: ublox-neo-7p, path: /tmp/rigwire/gnss, baud: 115200, mount: {link: body}}
RIG
  cat >"$1" <<CAMPAIGN
rig: rig.yaml
duration: $duration s
design: random
runs: $2
parameters:
  yaw: {type: uniform, from: 0 deg, to: 90 deg, keys: [machine.yaw]}
criteria:
  turned: {type: stays, quantity: heading_deg, above: false, value: 91}
CAMPAIGN
}

start_cluster() { # start_cluster NODES ROUND
  local folder=$work/slurm$1.$2 first=$((20000 + RANDOM % 10000)) node
  mkdir -p "$folder/state"
  export SLURM_CONF=$folder/slurm.conf
  # Without what a container has not: munge, cgroups, systemd, accounting.
  cat >"$SLURM_CONF" <<CONF
ClusterName=rigwire
SlurmctldHost=localhost(127.0.0.1)
SlurmctldPort=$first
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
AuthType=auth/none
CredType=cred/none
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool.%n
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.%n.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
MpiDefault=none
ReturnToService=2
SchedulerType=sched/builtin
SchedulerParameters=batch_sched_delay=0,sched_min_interval=10000,sched_interval=1
NodeName=n[1-$1] NodeHostname=localhost NodeAddr=127.0.0.1 Port=[$((first + 1))-$((first + $1))] CPUs=1 RealMemory=100 State=UNKNOWN
PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP
CONF
  echo "CgroupPlugin=cgroup/v1" >"$folder/cgroup.conf"
  # In sessions of their own: what interrupts this script leaves them to end_cluster.
  setsid slurmctld -D -f "$SLURM_CONF" >"$folder/slurmctld.txt" 2>&1 &
  pids+=($!)
  for ((node = 1; node <= $1; ++node)); do
    setsid taskset -c $((node - 1)) slurmd -D -f "$SLURM_CONF" -N "n$node" >"$folder/slurmd$node.txt" 2>&1 &
    pids+=($!)
  done
  local deadline=$((SECONDS + 60))
  until [ "$(sinfo --noheader --states=idle --format=%D 2>/dev/null)" = "$1" ]; do
    [ $SECONDS -lt $deadline ] || {
      echo "the cluster did not come up" >&2
      tail -n 5 "$folder"/*.txt >&2
      exit 1
    }
    sleep 0.2
  done
}

# measure_nodes NODES ROUND: runs per minute into $per_minute, collected, as a user waits for them.
# Not in a subshell, which would keep from the trap what it has started.
measure_nodes() {
  start_cluster "$1" "$2"
  # Four tasks a node: long enough beside the scheduler's second for each.
  local each=$(((runs + 4 * $1 - 1) / (4 * $1))) begin end
  begin=$(date +%s.%N)
  "$here/configs/campaigns/engines/slurm.sh" "$work/campaign.yaml" "$work/runs$1.$2" "$each" >"$work/out" ||
    { cat "$work/out" >&2 && exit 1; }
  end=$(date +%s.%N)
  grep -q "$runs passed, 0 failed, 0 crashed, 0 unfinished, 0 missing" "$work/out" ||
    { cat "$work/out" >&2 && exit 1; }
  end_cluster
  per_minute=$(awk -v b="$begin" -v e="$end" -v n="$runs" 'BEGIN {printf "%.1f", 60 * n / (e - b)}')
}

PATH=$PATH:/usr/sbin
write_campaign "$work/campaign.yaml" "$runs"
echo "cores: $(nproc), load at the begin: $(load)"
for ((round = 1; round <= rounds; ++round)); do
  measure_nodes 1 $round
  one=$per_minute
  measure_nodes 2 $round
  two=$per_minute
  awk -v a="$one" -v b="$two" 'BEGIN {printf "%.3f\n", b / a}' >>"$work/ratios"
  echo "round $round: one node $one runs a minute, two nodes $two: $(tail -n 1 "$work/ratios") times; load $(load)"
done
echo "two nodes against one, median of $rounds: $(median "$work/ratios") times"

# What is beyond the simulation, of the runs that had a core to themselves.
python3 - "$work"/runs1.* >"$work/beyond" <<'PYTHON'
import json, pathlib, sys
for folder in sys.argv[1:]:
    for file in pathlib.Path(folder, "runs").glob("*/result.json"):
        wall = json.loads(file.read_text())["wall"]
        print(wall["whole_s"] - wall["rig_s"])
PYTHON
echo "a run beyond its simulation, median of $(wc -l <"$work/beyond"): $(median "$work/beyond") s, at most $(sort -g "$work/beyond" | tail -n 1) s"

# One run's folder for each row: what collect reads has the size that it has.
write_campaign "$work/many.yaml" "$rows"
"$RIGWIRE" campaign expand "$work/many.yaml" -o "$work/many" >/dev/null
source_run=$(dirname "$(find "$work"/runs1.1/runs -name DONE | head -n 1)")
mkdir -p "$work/many/runs/000000"
cp "$source_run"/{result.json,report.json,events.json,rig.yaml,rig.log,DONE} "$work/many/runs/000000"
(cd "$work/many/runs" && seq -f %06.0f 1 $((rows - 1)) | xargs -P 1 -I{} cp -r 000000 {})
begin=$(date +%s.%N)
"$RIGWIRE" campaign collect "$work/many" >"$work/out"
end=$(date +%s.%N)
grep -q "^$rows passed" "$work/out" || { cat "$work/out" >&2 && exit 1; }
awk -v b="$begin" -v e="$end" -v n="$rows" 'BEGIN {printf "%d rows collected in %.1f s\n", n, e - b}'
echo "load at the end: $(load)"
