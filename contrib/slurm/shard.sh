#!/usr/bin/env bash
#SBATCH --job-name=symalign
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --signal=B:USR1@120
#
# One task of a Slurm array job: `sbatch --array=1-N shard.sh N STORE RUN-ARGUMENTS...` computes shard K of N into
# STORE.shards/K. A task that starts again goes on where it stopped, so it may be killed, preempted and put back into the
# queue at any time; nothing is computed twice but the models that were in flight. submit.sh submits this and the merge.
set -u
shards=$1 store=$2
shift 2
folder=$store.shards
mkdir -p "$folder"

# Time is nearly up (--signal above): stop, and queue again.
again=maybe
trap 'again=yes; kill -TERM "$run"' USR1
# Cancelled or preempted: stop; Slurm knows what follows.
trap 'again=no; kill -TERM "$run"' TERM

"${SYMALIGN:-symalign}" run "$@" --shard "$SLURM_ARRAY_TASK_ID/$shards" --jobs "${SLURM_CPUS_PER_TASK:-1}" \
    --store "$folder/$SLURM_ARRAY_TASK_ID" --log "$folder/$SLURM_ARRAY_TASK_ID.jsonl" &
run=$!
while
    wait "$run"
    code=$?
    kill -0 "$run" 2>/dev/null # a trapped signal ends `wait` before the run ends
do :; done

# Killed from outside, as where memory runs out: try again, but not for ever.
if [ "$code" -gt 128 ] && [ "$again" = maybe ] && [ "${SLURM_RESTART_COUNT:-0}" -lt 5 ]; then
    again=yes
fi
if [ "$again" = yes ]; then
    echo "shard $SLURM_ARRAY_TASK_ID: ended with $code, queued again"
    scontrol requeue "${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID"
fi
exit "$code"
