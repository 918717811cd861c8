#!/usr/bin/env bash
#SBATCH --job-name=symalign-merge
#SBATCH --open-mode=append
#
# `merge.sh N STORE`: joins the N stores in STORE.shards into STORE and checks every byte.
set -eu
shards=$1 store=$2
sources=()
for shard in $(seq "$shards"); do
    sources+=("$store.shards/$shard")
done
"${SYMALIGN:-symalign}" store merge "${sources[@]}" --into "$store"
"${SYMALIGN:-symalign}" store verify "$store"
