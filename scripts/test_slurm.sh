#!/bin/bash
# A real Slurm on this machine (slurmctld and two slurmd, munge, all in a temporary folder): a set of four shards by
# `phyvisgen submit`, one node set down in the middle. It must become the same bits as a set that one process made.
# Argument: how many episodes (default 8). Root, as the daemons of Debian's packages want to be; ports 16817, 17000, 17001.
set -euo pipefail
cd "$(dirname "$0")/.."
program=$PWD/build/bin/phyvisgen
task=$PWD/tests/pipeline/small_task/push_beaker.yaml
episodes="${1:-8}"
scripts/apt_install.sh slurmctld slurmd slurm-client munge

folder=$(mktemp -d)
cluster=$folder/cluster
stop_cluster() { # only the daemons whose numbers stand in this folder
  for file in "$cluster"/run/*.pid; do [ ! -s "$file" ] || kill "$(cat "$file")" 2>/dev/null || true; done
}
cleanup() {
  scancel --user "$(id -un)" 2>/dev/null || true
  stop_cluster
  sleep 1
  rm -rf "$folder"
}
trap cleanup EXIT

# ---- the cluster
mkdir -p "$cluster"/{state,spool/n0,spool/n1,log,run,munge}
dd if=/dev/urandom of="$cluster/munge/key" bs=128 count=1 status=none
chmod 0400 "$cluster/munge/key"
chmod 0755 "$folder" "$cluster" "$cluster/munge"
/usr/sbin/munged --force --key-file="$cluster/munge/key" --socket="$cluster/munge/socket" \
  --pid-file="$cluster/run/munged.pid" --log-file="$cluster/log/munged" --seed-file="$cluster/munge/seed"
host=$(hostname -s)
user=$(id -un)
cat >"$cluster/slurm.conf" <<CONF
ClusterName=test
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=16817
AuthType=auth/munge
AuthInfo=socket=$cluster/munge/socket,cred_expire=5
CredType=cred/munge
SlurmUser=$user
SlurmdUser=$user
StateSaveLocation=$cluster/state
SlurmdSpoolDir=$cluster/spool/%n
SlurmctldPidFile=$cluster/run/slurmctld.pid
SlurmdPidFile=$cluster/run/slurmd.%n.pid
SlurmctldLogFile=$cluster/log/slurmctld
SlurmdLogFile=$cluster/log/slurmd.%n
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
ReturnToService=2
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SlurmdParameters=config_overrides
KillWait=5
MinJobAge=300
NodeName=n0 NodeHostname=$host NodeAddr=127.0.0.1 Port=17000 CPUs=1 RealMemory=1000 State=UNKNOWN
NodeName=n1 NodeHostname=$host NodeAddr=127.0.0.1 Port=17001 CPUs=1 RealMemory=1000 State=UNKNOWN
PartitionName=test Nodes=n[0-1] Default=YES MaxTime=INFINITE State=UP
CONF
export SLURM_CONF=$cluster/slurm.conf
/usr/sbin/slurmctld -f "$SLURM_CONF" -c
for node in n0 n1; do /usr/sbin/slurmd -f "$SLURM_CONF" -N $node -c; done
for ((i = 0; i < 120; ++i)); do
  [ "$(sinfo -h -N -o %T 2>/dev/null | grep -c idle)" != 2 ] || break
  sleep 0.5
done
[ "$(sinfo -h -N -o %T | grep -c idle)" = 2 ] || { echo "test_slurm: the nodes do not become idle" >&2; exit 1; }
echo "test_slurm: two nodes are up"

# ---- the set, with a node lost
"$program" submit "$task" -n "$episodes" --shards 4 --seed 5 -o "$folder/set" --run
waited=0
wait_for() { # $1: what for; the rest: a command that says yes
  local what="$1"
  shift
  until "$@"; do
    sleep 1
    waited=$((waited + 1))
    [ $waited -lt 1500 ] || { echo "test_slurm: waited too long for $what" >&2; squeue >&2; tail "$folder"/set/jobs/*.log >&2; exit 1; }
  done
}
runs_on_n1() { [ -n "$(squeue -h -w n1 -t R)" ]; }
shard_on_n1() { grep -l 'on n1' "$folder"/set/jobs/shard_*.log 2>/dev/null | head -1; }
is_writing() { ls -A "$folder"/set/shards/*/ 2>/dev/null | grep -q partial; }
wait_for "a shard on n1" runs_on_n1
wait_for "an episode in the making" is_writing
lost=$(squeue -h -w n1 -t R -o %K | head -1)
scontrol update nodename=n1 state=down reason=test
echo "test_slurm: node n1 is down, shard $lost was running on it"
is_empty() { [ -z "$(squeue -h)" ]; }
wait_for "the end of all jobs" is_empty
restarts=$(grep -h -o 'start [1-9]' "$folder"/set/jobs/shard_*.log | wc -l)
[ "$restarts" -gt 0 ] || { echo "test_slurm: no shard was started again" >&2; exit 1; }
cat "$folder"/set/jobs/merge.log
stop_cluster

# ---- the same set by one process
"$program" generate "$task" -n "$episodes" --seed 5 -o "$folder/single" >/dev/null 2>&1
diff -r --exclude=summary.json --exclude=set.json --exclude=jobs "$folder/single" "$folder/set"
echo "test_slurm: $episodes episodes of 4 shards, $restarts started again after the loss of a node: the same bits as by one process"
