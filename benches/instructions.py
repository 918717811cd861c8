#!/usr/bin/env python3
"""Counts the instructions that all stages take on fixed models and holds them against a budget.

    cargo build --release
    python3 benches/instructions.py            fails where a model takes over 10 % more than its budget
    python3 benches/instructions.py --update   writes the counts as the new budget; commit it with the reason

Counts, unlike times, are the same on a busy machine. There is one worker. glibc takes the code that every x86-64 processor
runs; memchr and blake3 still choose by the processor, of which valgrind shows no more than one of 2013 has. So machines
from 2013 on agree within a few percent, and compilers do not: another rustc than that of the budget is only warned about.
Exit code 77: skipped, as there is no valgrind or this is no x86-64.
"""
import argparse
import concurrent.futures
import csv
import os
import platform
import re
import shutil
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
SECONDS = 600
# No limit that a model passes because valgrind is slow.
SETTINGS = "[limits]\nseconds = 3600.0\n"
# One worker, and no choice by the processor in glibc; memchr and blake3 cannot be told.
PLAIN = {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX512F,-AVX2,-FMA,-ERMS", "RAYON_NUM_THREADS": "1"}


def instructions(model):
    """Instructions of `symalign run` on one model."""
    with tempfile.TemporaryDirectory() as folder:
        with open(f"{folder}/settings.toml", "w") as file:
            file.write(SETTINGS)
        command = ["valgrind", "--tool=callgrind", f"--callgrind-out-file={folder}/profile", SYMALIGN, "run",
                   os.path.join(ROOT, "data-samples", model), "--store", f"{folder}/store", "--method", METHODS,
                   "--jobs", "1", "--strict", "--config", f"{folder}/settings.toml"]
        done = subprocess.run(command, cwd=folder, env={**os.environ, **PLAIN}, capture_output=True, text=True,
                              timeout=SECONDS)
        found = re.search(r"Collected : (\d+)", done.stderr)
        if done.returncode or not found:
            sys.exit(f"{' '.join(command)} failed:\n{done.stderr}")
        return int(found.group(1))


def rustc():
    return subprocess.run(["rustc", "-V"], cwd=ROOT, capture_output=True, text=True, check=True).stdout.strip()


def budget():
    """The compiler, which the comment of the first line names, and the instructions of each model."""
    with open(BUDGET) as file:
        lines = file.read().splitlines()
    compiler = lines.pop(0)[2:] if lines[0].startswith("# ") else None
    return compiler, {row["model"]: int(row["instructions"]) for row in csv.DictReader(lines)}


def update(counts):
    with open(BUDGET, "w") as file:
        file.write(f"# {rustc()}\nmodel,instructions\n")
        file.writelines(f"{model},{count}\n" for model, count in counts.items())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--update", action="store_true", help="write the counts as the new budget")
    arguments = parser.parse_args()
    if platform.machine() != "x86_64" or not shutil.which("valgrind"):
        print("skipped: the instructions are counted by valgrind on x86-64")
        return 77
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        counts = dict(zip(MODELS, pool.map(instructions, MODELS)))
    if arguments.update:
        return update(counts)
    compiler, allowances = budget()
    slow = 0
    for model, allowed in allowances.items():
        share = counts[model] / allowed - 1
        print(f"{model:24} {counts[model] / 1e6:8.1f} M instructions, {share:+.1%} of the budget")
        slow += share > TOLERANCE
        if share < -TOLERANCE:
            print("  much less than the budget: run with --update to hold what was won")
    if slow:
        text = (f"{slow} models take over {TOLERANCE:.0%} more instructions than their budget: make it as fast as it was, "
                "or run benches/instructions.py --update and say why")
        if compiler not in (None, rustc()):
            print(f"warning: {text} (the budget is that of {compiler}, this is {rustc()})")
            return 0
        print(text)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
