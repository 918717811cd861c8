#!/usr/bin/env python3
"""Generates the labelled STEP models of this folder, and checks and draws them.

    generate.py                              the 97 models, labels.csv, truth.csv, frame.csv, the table of README.md
    generate.py --per-class 200 --out DIR    a larger archive of the same families with other seeds
    generate.py --check [--out DIR]          tests every stated plane, and that none is missing, on the files
    generate.py --contact FILE.png           draws all models in their natural pose on one sheet

Needs cadquery-ocp, numpy, scipy and (for --contact) pillow. One process, no network.
"""

import argparse
import importlib
import os
import pathlib
import sys

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

from shapes import archive, build, check, contact  # noqa: E402  (the thread limits come first)

HERE = pathlib.Path(__file__).resolve().parent
CATEGORIES = {"airplane": 22, "vehicle": 12, "instrument": 9, "boat": 9, "animal": 9, "sunglasses": 4, "machinery": 12,
              "household": 15, "gun": 5}


def tasks(per_class):
    """(category, index, file name, entry) of every model; without `per_class` the counts of the paper."""
    for category, count in CATEGORIES.items():
        entries = importlib.import_module(f"shapes.{category}").ENTRIES
        for index in range(per_class or count):
            entry = entries[index % len(entries)]
            yield category, index, f"{entry[0]}-{index:03d}" if per_class else entry[0], entry


def generate(out, per_class, only):
    """Writes the models and their tables; `only` limits the run to paths that contain one of its texts."""
    records, failed = [], []
    paths = [f"{category}/{name}.step" for category, _, name, _ in tasks(per_class)]
    for category, index, name, entry in tasks(per_class):
        if only and not any(word in f"{category}/{name}" for word in only.split(",")):
            continue
        path = out / category / f"{name}.step"
        try:
            record = build.produce(entry, category, index, path, "large" if per_class else "paper")
        except Exception as error:  # a failing family must not hide the others
            failed.append(path)
            print(f"{path}: {error!r}", file=sys.stderr, flush=True)
            continue
        planes = " ".join(f"{row[0]}{'' if row[-1] == '' else f':{row[-1]:.4f}'}" for row in record["truth"])
        print(f"{record['path']:44} {record['schema']} {record['unit']:4} {record['structure']:9} {record['faces']:5} faces"
              f" {record['bytes'] / 1000:7.0f} kB  {planes[:60]}", flush=True)
        records.append(record)
        if len(records) % 10 == 0:
            archive.write_tables(out, records, paths)
    archive.write_tables(out, records, paths)
    return int(bool(failed))


def main():
    """Reads the arguments and runs one of the four commands."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--per-class", type=int, default=0, metavar="N")
    parser.add_argument("--out", type=pathlib.Path, default=HERE)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--contact", metavar="FILE")
    parser.add_argument("--only", default="", metavar="TEXT", help="only the models whose path contains one of the texts, separated by commas")
    arguments = parser.parse_args()
    if arguments.check:
        sys.exit(check.run(arguments.out, arguments.only))
    if arguments.contact:
        return contact.draw(arguments.out, arguments.contact, arguments.only)
    sys.exit(generate(arguments.out, arguments.per_class, arguments.only))


if __name__ == "__main__":
    main()
