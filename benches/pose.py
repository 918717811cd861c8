#!/usr/bin/env python3
"""Moves, turns and scales models with OpenCASCADE and asks whether symalign's results go with them.

    cargo build --release
    pip install cadquery-ocp numpy
    python benches/pose.py [--models 50] [--copies 4] FOLDER...

Of all STEP files in the folders as many are taken as asked for, evenly, each with copies in random poses at random scales
between 1e-3 and 1e3, written as STEP by OpenCASCADE. For the symmetry frame it prints a line for each copy that is

- turned: its frame is more than 0.05 degrees from the moved frame, and its descriptor is not the same either (where
  a symmetry of the model makes several frames equal, their descriptors are equal);
- away: its descriptor (magnitude or phase) is farther from the original's than 1 % of the distance to the nearest
  other model;
- lost: the original is not the nearest of all models to it;

and the totals. Models whose descriptors are within 0.005 of the original's are the same part from another file, and no
other models.
"""

import argparse
import itertools
import json
import pathlib
import subprocess
import tempfile

import numpy as np
from OCP.BRepBuilderAPI import BRepBuilderAPI_Transform
from OCP.gp import gp_Pnt, gp_Quaternion, gp_Trsf, gp_Vec
from OCP.IFSelect import IFSelect_RetDone
from OCP.Message import Message
from OCP.STEPControl import STEPControl_AsIs, STEPControl_Reader, STEPControl_Writer

SAME = 0.005
PROGRAM = pathlib.Path(__file__).resolve().parent.parent / "target/release/symalign"


def write_copy(path, out, seed):
    """Writes a moved and scaled copy of a file; returns the rotation, or None where OpenCASCADE cannot."""
    rng = np.random.default_rng(seed)
    reader = STEPControl_Reader()
    if reader.ReadFile(str(path)) != IFSelect_RetDone:
        return None
    reader.TransferRoots()
    shape = reader.OneShape()
    quaternion = rng.normal(size=4)
    quaternion /= np.linalg.norm(quaternion)
    turn, scale, shift = gp_Trsf(), gp_Trsf(), gp_Trsf()
    turn.SetRotation(gp_Quaternion(*quaternion))
    factor = 10 ** rng.uniform(-3, 3)
    scale.SetScale(gp_Pnt(0, 0, 0), factor)
    shift.SetTranslation(gp_Vec(*(rng.uniform(-100, 100, 3) * factor)))
    moved = BRepBuilderAPI_Transform(shape, shift.Multiplied(scale).Multiplied(turn), True).Shape()
    writer = STEPControl_Writer()
    writer.Transfer(moved, STEPControl_AsIs)
    writer.Write(str(out))
    return np.array([[turn.Value(i, k) for k in (1, 2, 3)] for i in (1, 2, 3)])


def inspect(paths):
    """What symalign says of each file, by path."""
    command = [PROGRAM, "inspect", "--json", "--method", "symmetry", *paths]
    lines = subprocess.run(command, capture_output=True, text=True, check=False).stdout.splitlines()
    return {found["model"]: found for found in map(json.loads, lines) if "error" not in found}


def described(found):
    """Magnitudes (3, 32) and phases (start, view, harmonic) of the symmetry frame."""
    parts = found["descriptors"]
    starts = [parts[name]["symmetry"] for name in ("phase", "phase_opposite")]
    return np.array(parts["magnitude"]["symmetry"]), np.array(starts) @ [1, 1j]


def magnitude(a, b):
    return np.linalg.norm(a[0] - b[0], axis=1).sum()


def phase(a, b):
    """The least over the signs of the axes: see src/distance.rs."""
    def view(i, right, up):
        other = b[1][::-1] if right else b[1]
        other = other.conj() if right != up else other
        return np.sqrt(0.5 * (abs(a[1][:, i] - other[:, i]) ** 2).sum())
    signs = itertools.product((False, True), repeat=3)
    return min(sum(view(i, s[(i + 1) % 3], s[(i + 2) % 3]) for i in range(3)) for s in signs)


def angle(a, b):
    """Degrees between axes of the same number, signs apart."""
    sines = np.linalg.norm(np.cross(a, b), axis=1)
    return np.degrees(np.arctan2(sines, abs((a * b).sum(1)))).max()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--models", type=int, default=50)
    parser.add_argument("--copies", type=int, default=4)
    parser.add_argument("folder", nargs="+", type=pathlib.Path)
    arguments = parser.parse_args()
    for printer in list(Message.DefaultMessenger_s().Printers()):
        Message.DefaultMessenger_s().RemovePrinter(printer)
    paths = sorted(p for folder in arguments.folder for p in folder.rglob("*") if p.suffix.lower() in (".step", ".stp"))
    paths = [str(paths[i * len(paths) // arguments.models]) for i in range(min(arguments.models, len(paths)))]
    originals = inspect(paths)
    known = {path: described(found) for path, found in originals.items()}
    counts = dict.fromkeys(("copies", "unique frame", "turned", "away", "lost"), 0)
    angles = []
    for number, path in enumerate(known):
        with tempfile.TemporaryDirectory() as folder:
            out = {str(pathlib.Path(folder) / f"{k}.step"): 1000 * number + k for k in range(arguments.copies)}
            turns = {name: write_copy(path, name, seed) for name, seed in out.items()}
            copies = inspect([name for name, turn in turns.items() if turn is not None])
        for name, copy in copies.items():
            counts["copies"] += 1
            own, verdict = described(copy), []
            axes = np.array(originals[path]["frames"]["symmetry"]["axes"]) @ turns[name].T
            off = angle(axes, np.array(copy["frames"]["symmetry"]["axes"]))
            shares = []
            for distance in (magnitude, phase):
                others = {other: distance(known[path], known[other]) for other in known}
                others = {other: d for other, d in others.items() if d > SAME}
                to_own = distance(own, known[path])
                shares.append(to_own / min(others.values()))
                if min(distance(own, known[other]) for other in others) <= to_own:
                    verdict.append("lost")
            if off <= 0.05:
                angles.append(off)
            elif max(shares) > 0.01:
                verdict.append("turned")
            if max(shares) > 0.01:
                verdict.append("away")
            for word in set(verdict):
                counts[word] += 1
            if verdict:
                told = " ".join(sorted(set(verdict)))
                print(f"{path}: {told}: {off:.4f} degrees, {shares[0]:.4f} and {shares[1]:.4f} of the nearest", flush=True)
    counts["unique frame"] = len(angles)
    print(", ".join(f"{name}: {count}" for name, count in counts.items()))
    if angles:
        print(f"degrees where within 0.05: median {np.median(angles):.6f}, largest {max(angles):.6f}")


if __name__ == "__main__":
    main()
