#!/usr/bin/env python3
"""Generates single shapes with known mirror planes, and checks the answers without symalign.

    generate.py --out DIR                  the shapes and their truth.csv
    generate.py --seed N --out DIR         the same families with other dimensions, poses and scales
    generate.py --set others --out DIR     other families
    generate.py --check --out DIR          tests every stated plane on the files, and searches for planes not stated
    generate.py --pack NAME --out DIR      puts the shapes and truth.csv into NAME.tar.xz of this folder

Needs cadquery-ocp, numpy and scipy. One process, no network.
"""

import argparse
import csv
import importlib
import os
import pathlib
import sys
import tarfile
import traceback

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(variable, "1")


from shape import gp_Trsf, np  # noqa: E402  (the thread limits come first)
import search  # noqa: E402
from OCP.gp import gp_Vec  # noqa: E402
from OCP.TopLoc import TopLoc_Location  # noqa: E402
from shapes import archive, build, measure, model, write  # noqa: E402
from shapes.kernel import apply, solids_of  # noqa: E402

HERE = pathlib.Path(__file__).resolve().parent
SETS = {"shapes": ("flat", "turned", "mixed"), "others": ("others",)}
EXACT = 0.999
# Planes below these shares of the best coverage need not be reported, and must not be.
REQUIRED, ALLOWED = 0.96, 0.9


def tasks(which):
    """(name, family, details) of every shape."""
    return [entry for module in SETS[which] for entry in importlib.import_module(module).ENTRIES]


def scaled(place, factor):
    """A rigid placement of a model that is scaled."""
    trsf = gp_Trsf().Multiplied(place)
    trsf.SetTranslationPart(gp_Vec(place.TranslationPart()).Multiplied(factor))
    return trsf


def save(shape, pose, rng, path):
    """Writes the shape in its pose."""
    scaling = gp_Trsf()
    scaling.SetScaleFactor(pose.scale)
    parts = [(f"piece {i + 1}", apply(piece, scaling), [scaled(p, pose.scale) for p in places])
             for i, (piece, places) in enumerate(shape.pieces)]
    how = path, *(str(rng.choice(c)) for c in (("AP203", "AP214", "AP242"), ("mm", "mm", "cm", "inch", "m"))), bool(rng.random() < .4)
    if not shape.sheet and (len(parts) > 1 or len(parts[0][2]) > 1) and rng.random() < .6:
        return write.write_assembly(parts, pose.rigid(), bool(rng.random() < .5), *how)
    placed = [apply(piece.Moved(TopLoc_Location(place)), pose.rigid()) for _, piece, places in parts for place in places]
    return write.write_shape(placed[0] if len(placed) == 1 else model.compound(placed), *how)


def truth_rows(shape, pose, read, extent):
    """The rows of truth.csv without the path."""
    if shape.axis or shape.centre:
        point = pose.point((shape.axis or [shape.centre])[0])
        along = pose.vector(shape.axis[1]) if shape.axis else ["", "", ""]
        rows = [["revolution" if shape.axis else "sphere"] + [""] * 4 + [extent, *point, *along, ""]]
    else:
        rows = []
    mirrors = measure.Mirrors(read, extent)
    planes = [(pose.vector(n), float(pose.vector(n) @ pose.point(p))) for n, p in shape.planes]
    covered = [mirrors.coverage(n, d) for n, d in planes]
    best = 1.0 if rows else max(covered, default=0.0)
    for (normal, offset), coverage in zip(planes, covered):
        label = "exact" if coverage >= EXACT else "partial" if coverage >= REQUIRED * best else "optional"
        if coverage >= ALLOWED * best:
            rows.append([label, *normal, offset, extent] + [""] * 6 + [coverage])
    return rows or [["none"] + [""] * 4 + [extent] + [""] * 7]


def produce(name, family, details, seed, path):
    """Builds and writes one file; returns its rows of truth.csv."""
    shape = family(build.seeded("single", seed, name), **details)
    rng = build.seeded("single file", seed, name)
    natural = model.compound([piece.Moved(TopLoc_Location(place)) for piece, places in shape.pieces for place in places])
    fault = None if shape.sheet or shape.loose else measure.fault(natural)
    if fault:
        raise ValueError(fault)
    low, high = measure.bounds(natural)
    size = float(np.linalg.norm(high - low))
    pose = build.random_pose(rng, size)
    save(shape, pose, rng, path)
    read = write.read(path)
    if not shape.sheet and len(solids_of(read)) != len(solids_of(natural)):
        raise ValueError(f"{len(solids_of(read))} solids came back")
    return [[path.name, *row] for row in truth_rows(shape, pose, read, size * pose.scale)]


def generate(out, which, seed, only):
    """Writes the shapes and truth.csv."""
    out.mkdir(parents=True, exist_ok=True)
    rows, failed, entries = [], 0, tasks(which)
    for name, family, details in entries:
        if only and only not in name:
            continue
        try:
            rows += (found := produce(name, family, details, seed, out / f"{name}.step"))
        except Exception:  # a failing family must not hide the others
            failed += 1
            print(f"{name}: {traceback.format_exc(limit=-1)}", file=sys.stderr, flush=True)
            continue
        print(f"{name:24} {' '.join(f'{r[1]}' + (f':{r[-1]:.4f}' if r[-1] != '' and r[-1] < 1 else '') for r in found)[:90]}", flush=True)
    order = {f"{name}.step": k for k, (name, *_) in enumerate(entries)}
    archive.renew_csv(out / "truth.csv", archive.TRUTH, rows, order)
    return int(failed > 0)


def check(out, only):
    """Tests the answers on the files; prints what they contradict."""
    bad = 0
    with open(out / "truth.csv", encoding="ascii") as file:
        rows = list(csv.DictReader(file))
    for name in dict.fromkeys(row["path"] for row in rows):
        if only in name:
            faults = search.faults(write.read(out / name), [row for row in rows if row["path"] == name])
            bad += bool(faults)
            print(f"{name:28} {'; '.join(faults) or 'ok'}", flush=True)
    print(f"{bad} shapes with faults")
    return int(bad > 0)


def pack(out, name):
    """Writes an archive that depends on the files alone."""
    with tarfile.open(HERE / f"{name}.tar.xz", "w:xz", preset=9, format=tarfile.USTAR_FORMAT) as archived:
        for path in sorted(out.glob("*.step")) + [out / "truth.csv"]:
            entry = tarfile.TarInfo(path.name)
            entry.size = path.stat().st_size
            with open(path, "rb") as file:
                archived.addfile(entry, file)


def main():
    """Reads the arguments."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--set", choices=SETS, default="shapes")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--pack", metavar="NAME")
    parser.add_argument("--only", default="", metavar="TEXT", help="only the shapes whose name contains the text")
    arguments = parser.parse_args()
    if arguments.check:
        sys.exit(check(arguments.out, arguments.only))
    if arguments.pack:
        return pack(arguments.out, arguments.pack)
    sys.exit(generate(arguments.out, arguments.set, arguments.seed, arguments.only))


if __name__ == "__main__":
    main()
