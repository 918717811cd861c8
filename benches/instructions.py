#!/usr/bin/env python3
"""Counts the instructions that all stages take on fixed models and holds them against a budget.

    cargo build --release
    python3 benches/instructions.py            fails where a model takes over 10 % more than its budget
    python3 benches/instructions.py --update   writes the counts as the new budget; commit it with the reason

Counts, unlike times, are the same on a busy machine. valgrind runs one worker and no vector instructions beyond those of
every x86-64 processor where a library chooses by the processor, so that machines agree within a few percent.
"""
import argparse
import concurrent.futures
import csv
import os
import re
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(HERE)
BUDGET = os.path.join(HERE, "instructions.csv")
SYMALIGN = os.path.join(ROOT, "target", "release", "symalign")
MODELS = ("airplane/biplane.step", "household/mug.step", "vehicle/pickup.step")
TOLERANCE = 0.10
METHODS = "symmetry,pca,cpca,npca"
# glibc's own choices; memchr and blake3 still ask the processor, which valgrind shows one of 2013.
PLAIN = {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX512F,-AVX2,-FMA,-ERMS", "RAYON_NUM_THREADS": "1"}


def instructions(model):
    """Instructions of `symalign run` on one model."""
    with tempfile.TemporaryDirectory() as folder:
        command = ["valgrind", "--tool=callgrind", f"--callgrind-out-file={folder}/profile", SYMALIGN, "run",
                   os.path.join(ROOT, "data-samples", model), "--store", f"{folder}/store", "--method", METHODS,
                   "--jobs", "1"]
        done = subprocess.run(command, cwd=folder, env={**os.environ, **PLAIN}, capture_output=True, text=True)
        found = re.search(r"Collected : (\d+)", done.stderr)
        if done.returncode or not found:
            sys.exit(f"{' '.join(command)} failed:\n{done.stderr}")
        return int(found.group(1))


def budget():
    with open(BUDGET) as file:
        return {row["model"]: int(row["instructions"]) for row in csv.DictReader(file)}


def update(counts):
    with open(BUDGET, "w") as file:
        file.write("model,instructions\n")
        file.writelines(f"{model},{count}\n" for model, count in counts.items())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--update", action="store_true", help="write the counts as the new budget")
    arguments = parser.parse_args()
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        counts = dict(zip(MODELS, pool.map(instructions, MODELS)))
    if arguments.update:
        return update(counts)
    slow = 0
    for model, allowed in budget().items():
        share = counts[model] / allowed - 1
        print(f"{model:24} {counts[model] / 1e6:8.1f} M instructions, {share:+.1%} of the budget")
        slow += share > TOLERANCE
        if share < -TOLERANCE:
            print("  much less than the budget: run with --update to hold what was won")
    if slow:
        sys.exit(f"{slow} models take over {TOLERANCE:.0%} more instructions than their budget: make it as fast as it "
                 "was, or run benches/instructions.py --update and say why")


if __name__ == "__main__":
    main()
