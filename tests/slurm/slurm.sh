#!/bin/bash
# Sweeps on a real Slurm: a controller and two virtual nodes on the loopback address run a job array, whose shards
# fail, are requeued, cancelled, and lose a node. Each time the merged digest is that of one process.
# usage: slurm.sh REPOSE WORK      (as root: it installs Debian's Slurm if it is missing)
set -eu -o pipefail
repose=$(realpath "$1") work=$2
mkdir -p "$work" && work=$(realpath "$work")

missing=
for p in slurmctld slurmd slurm-client munge; do
    dpkg-query -W -f '${Status}\n' $p 2>/dev/null | grep -q 'install ok installed' || missing="$missing $p"
done
if [ -n "$missing" ]; then
    echo "slurm   installing$missing"
    # their services stay as they are: this check runs daemons of its own
    printf '#!/bin/sh\nexit 101\n' >"$work/policy" && chmod +x "$work/policy"
    DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends $missing >/dev/null
fi

rm -rf "$work/cluster" && mkdir -p "$work/cluster/state"
chmod 755 "$work" "$work/cluster"
cd "$work/cluster"
export SLURM_CONF=$PWD/slurm.conf
port=$((20000 + $$ % 20000))
cat >slurm.conf <<C
ClusterName=repose
SlurmctldHost=$(hostname)(127.0.0.1)
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket=$PWD/munge.socket
CommunicationParameters=NoInAddrAny,NoCtldInAddrAny
SlurmctldPort=$port
StateSaveLocation=$PWD/state
SlurmdSpoolDir=$PWD/spool.%n
SlurmctldPidFile=$PWD/slurmctld.pid
SlurmdPidFile=$PWD/slurmd.%n.pid
SlurmctldLogFile=$PWD/slurmctld.log
SlurmdLogFile=$PWD/slurmd.%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
ReturnToService=2
SlurmdTimeout=5
KillWait=5
SchedulerParameters=batch_sched_delay=0,sched_interval=2,requeue_delay=1
NodeName=n1 NodeHostname=$(hostname) NodeAddr=127.0.0.1 Port=$((port + 1)) CPUs=1 RealMemory=500
NodeName=n2 NodeHostname=$(hostname) NodeAddr=127.0.0.1 Port=$((port + 2)) CPUs=1 RealMemory=500
PartitionName=all Nodes=n1,n2 Default=YES MaxTime=INFINITE State=UP
C

# Only processes that this script started are ended.
started=()
end() {
    scancel --quiet --user="$(id -un)" 2>/dev/null || true
    for p in "${started[@]}"; do kill "$p" 2>/dev/null || true; done
    wait 2>/dev/null || true
}
trap end EXIT
start() {
    "$@" >>daemons.log 2>&1 &
    started+=($!)
}
node() { start slurmd -D -N "$1"; }

head -c 1024 /dev/urandom >munge.key && chmod 600 munge.key
start munged --foreground --force --key-file="$PWD/munge.key" --socket="$PWD/munge.socket" --pid-file="$PWD/munge.pid" \
    --log-file="$PWD/munge.log" --seed-file="$PWD/munge.seed"
start slurmctld -D
node n1
node n2
n2=${started[-1]}

# wait_for SECONDS TEXT COMMAND...: until the command says yes
wait_for() {
    local left=$(($1 * 2)) what=$2
    shift 2
    until "$@"; do
        left=$((left - 1))
        if [ $left -le 0 ]; then
            echo "slurm   FAILED: waited in vain: $what" >&2
            { sinfo; squeue; tail -n 5 ./*.log; } >&2
            exit 1
        fi
        sleep 0.5
    done
}
nodes_idle() { [ "$(sinfo -h -N -t idle -o %N 2>/dev/null | wc -l)" = "$1" ]; }
none_left() { [ -z "$(squeue -h)" ]; }
some_run() { [ "$(squeue -h -t running | wc -l)" -ge "$1" ]; }
rows() { "$repose" sweep status "$dir" | sed -n 's/^# stored: //p'; }
rows_reach() { [ "$(rows)" -ge "$1" ]; }
wait_for 60 "two nodes" nodes_idle 2
echo "slurm   a controller and two nodes run"

cat >sweep.cfg <<'S'
protocol = "repose"; replicas = 8; seed = 1993;
fixed = { W = 2.0; H = 2.0; stop = "steps"; fill_steps = 15000; relax_steps = 15000; };
grid = { mu = [0.1, 0.2, 0.3]; };
S
"$repose" sweep plan sweep.cfg -o whole >/dev/null
"$repose" sweep run whole >/dev/null 2>&1
expected=$("$repose" sweep digest whole)

fresh() { # folder with a planned sweep and its job array
    dir=$PWD/$1
    "$repose" sweep plan sweep.cfg -o "$dir" >/dev/null
    "$repose" sweep slurm "$dir" --shards 4 --time 0:05:00 --mem 100M >"$dir/commands"
}
submit() { sbatch --parsable "$dir/array.sh"; }
same() { # after a merge, the digest of the local process
    "$repose" sweep merge "$dir" >merge.out || { cat merge.out >&2; echo "slurm   FAILED: $1: merge" >&2; exit 1; }
    [ "$("$repose" sweep digest "$dir")" = "$expected" ] || { echo "slurm   FAILED: $1: another digest" >&2; exit 1; }
    echo "slurm   $1: digest of one process"
}

fresh plain
submit >/dev/null
wait_for 120 "the array" none_left
same "array of four shards"

fresh failed
mkdir -p "$dir/shards/2-of-4.sqlite.lock" # no lock can be taken
submit >/dev/null
wait_for 120 "the array" none_left
"$repose" sweep status "$dir" | grep -q '^# shards with missing runs: 2 of 4$' || { echo "slurm   FAILED: the lost shard is not named" >&2; exit 1; }
rmdir "$dir/shards/2-of-4.sqlite.lock"
sbatch --parsable --array=2 "$dir/array.sh" >/dev/null
wait_for 120 "the shard again" none_left
same "a shard that failed, and was submitted again"

fresh requeued
job=$(submit)
wait_for 60 "rows" rows_reach 2
scontrol requeue "${job}_1" || true
wait_for 180 "the array" none_left
same "a job requeued while it ran"

fresh warned
job=$(submit)
wait_for 60 "rows" rows_reach 2
scancel --signal=USR1 --batch "${job}_1" || true # what Slurm sends two minutes before the time is out
wait_for 180 "the array" none_left
same "a job warned of its end, which queued again"

fresh cancelled
submit >/dev/null
wait_for 60 "rows" rows_reach 2
scancel --user="$(id -un)"
wait_for 60 "the cancelled jobs" none_left
[ "$(rows)" -lt 24 ] || echo "slurm   (all rows were stored before the cancellation)"
submit >/dev/null
wait_for 180 "the array" none_left
same "an array cancelled, and submitted again"

fresh lost
submit >/dev/null
wait_for 60 "two jobs" some_run 2
pkill -KILL -P "$n2" || true # its job steps, and the daemon: as when the machine dies
kill -KILL "$n2"
wait "$n2" 2>/dev/null || true
for p in $(pgrep -f "slurmstepd.*" || true); do
    tr '\0' '\n' <"/proc/$p/environ" 2>/dev/null | grep -qx "SLURM_CONF=$SLURM_CONF" && tr '\0' ' ' <"/proc/$p/cmdline" | grep -q n2 && kill -KILL "$p"
done || true
sleep 8
node n2
wait_for 240 "the array on what is left" none_left
if [ "$(rows)" -lt 24 ]; then submit >/dev/null; wait_for 180 "the array again" none_left; fi
same "a node lost"
echo "slurm   all is well"
