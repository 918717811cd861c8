#!/usr/bin/env bash
# Tries the scripts of this folder on a real Slurm: two nodes on the loopback address, in the middle of the work a node
# that crashes, a process that is killed and a task whose time is up; then the merged store against that of one machine.
#
#   apt-get install -y --no-install-recommends slurm-wlm slurm-wlm-basic-plugins munge   # as root
#   contrib/slurm/test.sh [INPUT [STORE]]
#
# INPUT is a folder of models (data-samples), STORE the store that one machine made of it; without it, it is made first.
# Ends with 0 where all is well, 77 where Slurm is not installed. Ends all that it started.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
input=$(realpath "${1:-$here/../../data-samples}")
one=${2:+$(realpath "$2")}
export SYMALIGN
SYMALIGN=$(realpath "${SYMALIGN:-$here/../../target/release/symalign}")
export PATH=$PATH:/usr/sbin
for program in munged slurmctld slurmd sbatch python3; do
    command -v $program >/dev/null || { echo "skipped: $program is not installed"; exit 77; }
done
[ "$(id -u)" = 0 ] || { echo "skipped: slurmd wants root"; exit 77; }

work=$(mktemp -d)
cd "$work"
export SLURM_CONF=$work/slurm.conf
say() { printf '%(%T)T  %s\n' -1 "$*"; }

# The environments that our configuration stands in: daemons, jobs and what runs these.
environments() { grep -lzxF -e "SLURM_CONF=$SLURM_CONF" /proc/[0-9]*/environ 2>/dev/null || true; }
# Processes of jobs on a node of ours.
processes_on() {
    environments | { xargs -r grep -lzxF -e "SLURMD_NODENAME=$1" 2>/dev/null || true; } | cut -d/ -f3
}

finish() {
    local code=$?
    [ $code = 0 ] || { say "failed ($code)"; tail -n 20 ./*.log slurm-*.out 2>/dev/null || true; }
    kill $(jobs -pr) 2>/dev/null || true
    for _ in {1..100}; do
        [ -n "$(jobs -pr)" ] || break
        sleep 0.1
    done
    kill -9 $(environments | cut -d/ -f3) 2>/dev/null || true
    wait 2>/dev/null || true
    rm -rf "$work"
}
trap finish EXIT
trap 'exit 143' TERM

# Waits until a command succeeds.
until_true() {
    local what=$1 end=$((SECONDS + 300))
    shift
    until "$@" >/dev/null 2>&1; do
        [ $SECONDS -lt $end ] || { say "no sign of: $what"; exit 1; }
        sleep 0.2
    done
}

start_node() {
    slurmd -D -N "$1" >>"$1.out" 2>&1 &
    node_pid[$1]=$!
}

configure() {
    local port port1 port2
    read -r port port1 port2 < <(python3 -c '
import socket
free = [socket.create_server(("127.0.0.1", 0)) for _ in range(3)]
print(*(one.getsockname()[1] for one in free))')
    mkdir state spool
    head -c 1024 /dev/urandom >munge.key
    chmod 600 munge.key
    cat >"$SLURM_CONF" <<CONF
ClusterName=loopback
SlurmctldHost=$(hostname -s)(127.0.0.1)
SlurmctldPort=$port
CommunicationParameters=NoInAddrAny,NoCtldInAddrAny
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$work/munge.socket,cred_expire=10
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool/%n
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/%n.pid
SlurmctldLogFile=$work/slurmctld.log
SlurmdLogFile=$work/%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/linux
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
SchedulerParameters=sched_interval=2,batch_sched_delay=0
ReturnToService=2
SlurmdTimeout=60
BatchStartTimeout=1
SlurmdParameters=config_overrides
NodeName=n1 NodeHostname=$(hostname -s) NodeAddr=127.0.0.1 Port=$port1 CPUs=1 RealMemory=2000
NodeName=n2 NodeHostname=$(hostname -s) NodeAddr=127.0.0.1 Port=$port2 CPUs=1 RealMemory=2000
PartitionName=all Nodes=n1,n2 Default=YES MaxTime=INFINITE DefMemPerNode=1000
CONF
}

start_daemons() {
    munged --foreground --force --socket=munge.socket --key-file=munge.key --pid-file=munge.pid --seed-file=munge.seed \
        --log-file=munge.log >munge.out 2>&1 &
    until_true "munge" sh -c 'munge -n --socket=munge.socket | unmunge --socket=munge.socket'
    slurmctld -D >slurmctld.out 2>&1 &
    start_node n1
    start_node n2
    until_true "two idle nodes" sh -c 'test "$(sinfo -h -N -t idle -o %N | sort -u | wc -l)" = 2'
}

# Whether a shard has committed a few models and has more to do.
in_the_middle() { [ "$(models_of "$1")" -ge 2 ] && [ ! -e "store.shards/$1/models.symalign" ]; }
# Stops the processes of a node, `programs` of ours and `others`, in the middle of a `shard` other than $2.
stop_in_the_middle() {
    shard=$(squeue -h -w "$1" -t running -n symalign -o %K)
    [ -n "$shard" ] && [ "$shard" != "${2:-}" ] && in_the_middle "$shard" || return
    stopped=$(processes_on "$1")
    programs=$(for pid in $stopped; do ! grep -qs symalign "/proc/$pid/comm" || echo "$pid"; done)
    others=$(comm -23 <(sort <<<"$stopped") <(sort <<<"$programs"))
    [ -n "$programs" ] && [ -n "$others" ] && kill -STOP $stopped || return
    sleep 0.1 # what the kernel is at goes on
    in_the_middle "$shard" || { kill -CONT $stopped; return 1; }
}
models_of() { grep -c '"event":"model"' "store.shards/$1.jsonl"; }
starts_of() { grep -c '"event":"run_start"' "store.shards/$1.jsonl"; }

# A node dies with all that runs on it, which is stopped.
crash() {
    local parents
    parents=$(for pid in $stopped; do sed -n 's/^PPid:\s*//p' "/proc/$pid/status"; done | sort -u |
        while read -r pid; do ! grep -qs slurmstepd "/proc/$pid/comm" || echo "$pid"; done)
    [ -n "$parents" ] || { say "no slurmstepd on $1"; exit 1; }
    kill -STOP "${node_pid[$1]}" $parents # or they tell of the end of the others
    kill -9 $stopped $parents "${node_pid[$1]}"
    { wait "${node_pid[$1]}" || true; } 2>/dev/null
}

declare -A node_pid
configure
start_daemons
say "$(sinfo -V): $(sinfo -h -N -o '%N %t' | sort -u | paste -sd,)"
if [ -z "$one" ]; then
    one=$work/one
    "$SYMALIGN" run "$input" --store one >one.log 2>&1
fi
say "one machine: $("$SYMALIGN" store info "$one" | head -n 1)"

say "$("$here/submit.sh" 4 store "$input")"
until_true "a task in the middle on n2" stop_in_the_middle n2
crashed=$shard
say "shard $crashed has $(models_of "$crashed") models; its node n2 crashes"
crash n2
back=$((SECONDS + 13)) # before BatchStartTimeout + MessageTimeout, Slurm takes a job that it misses for one that starts
until_true "a task in the middle on n1" stop_in_the_middle n1
killed=$shard
say "shard $killed has $(models_of "$killed") models; its process on n1 is killed"
kill -9 $programs
kill -CONT $others
until_true "the next task in the middle on n1" stop_in_the_middle n1 "$killed"
late=$shard
say "shard $late has $(models_of "$late") models; its time is up"
scancel --batch --signal=USR1 "$(squeue -h -w n1 -t running -o %A)"
kill -CONT $others # they send the SIGTERM, the 15th bit, before the program goes on
until_true "a SIGTERM" grep -q '^ShdPnd:.*[4-7c-f]...$' $(printf '/proc/%s/status ' $programs)
kill -CONT $programs
sleep $((back > SECONDS ? back - SECONDS : 0))
say "n2 is back"
start_node n2
until_true "the end of all jobs" sh -c 'test -z "$(squeue -h)"'

grep -E 'equeu|NODE_FAIL|batch job|Allocate|done$' slurmctld.log | sed 's/^/    slurmctld: /'
sed -n '/queued again/s/^/    /p' slurm-*.out
for shard in 1 2 3 4; do
    say "shard $shard: started $(starts_of $shard) times, $(models_of $shard) outcomes in its log"
done
for shard in "$crashed" "$killed" "$late"; do
    [ "$(starts_of "$shard")" = 2 ] || { say "shard $shard did not start twice"; exit 1; }
done
cmp store/models.symalign "$one/models.symalign"
say "the merged store is that of one machine, byte for byte: $(sha256sum <store/models.symalign | head -c 16)"
