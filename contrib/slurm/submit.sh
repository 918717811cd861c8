#!/usr/bin/env bash
# `submit.sh N STORE RUN-ARGUMENTS...`: computes the inputs in N shards on a Slurm cluster and merges them into STORE.
#
#   contrib/slurm/submit.sh 64 /shared/parts-store /shared/parts
#
# All nodes must see STORE, the inputs and the program (on the PATH, or named by SYMALIGN) under the same names. sbatch
# takes limits from its environment: SBATCH_TIMELIMIT, SBATCH_PARTITION, SBATCH_MEM_PER_NODE, ... A shard that failed for
# good is computed again by `sbatch --array=K shard.sh N STORE RUN-ARGUMENTS...`, then `merge.sh N STORE`.
set -eu
if [ $# -lt 3 ]; then
    sed -n '2,4s/^# \{0,1\}//p' "$0" >&2
    exit 2
fi
here=$(cd "$(dirname "$0")" && pwd)
shards=$1 store=$2
array=$(sbatch --parsable --array="1-$shards" "$here/shard.sh" "$@")
merge=$(sbatch --parsable --dependency="afterok:$array" --kill-on-invalid-dep=yes "$here/merge.sh" "$shards" "$store")
echo "array job $array ($shards shards), merge job $merge"
