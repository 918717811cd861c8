"""Tests an archive's truth against its files, independently of how they were made.

Every file is read again: its solids must be valid and closed. Every exact plane and the planes of every axis of
revolution must map at least EXACT of the surface onto itself, every partial plane must have the coverage stated and
less than EXACT. Planes normal to the natural axes and their diagonals through the natural centre and through the
centre of volume must not be exact unless they are listed.
"""

import csv

import numpy as np
from OCP.BRepGProp import BRepGProp
from OCP.GProp import GProp_GProps

from . import measure, write

EXACT = 0.999
SAME_ANGLE, SAME_OFFSET = 1e-3, 1e-3  # radians; share of the size


def rows_by_path(path):
    """The rows of a CSV file as dicts, grouped by the column `path`."""
    groups = {}
    with open(path, encoding="ascii") as file:
        for row in csv.DictReader(file):
            groups.setdefault(row["path"], []).append(row)
    return groups


def numbers(row, *keys):
    """Some columns of a row as an array."""
    return np.array([float(row[key]) for key in keys])


def axis_planes(row):
    """Three planes (normal, offset) that contain an axis of revolution."""
    point, along = numbers(row, "axis_px", "axis_py", "axis_pz"), numbers(row, "axis_dx", "axis_dy", "axis_dz")
    first = np.cross(along, np.eye(3)[np.argmin(np.abs(along))])
    first /= np.linalg.norm(first)
    second = np.cross(along, first)
    normals = [np.cos(a) * first + np.sin(a) * second for a in (0.3, 1.3, 2.3)]
    return [(n, float(n @ point)) for n in normals]


def centre_of_volume(shape):
    """The centre of volume in mm."""
    properties = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, properties)
    centre = properties.CentreOfMass()
    return np.array([centre.X(), centre.Y(), centre.Z()])


def guesses(frame, shape):
    """Planes a reader would try: natural axes and diagonals, through the natural centre and the centre of volume."""
    axes = numbers(frame, *(f"e{i}{c}" for i in (1, 2, 3) for c in "xyz")).reshape(3, 3)
    normals = list(axes) + [(axes[i] + s * axes[j]) / np.sqrt(2) for i, j in ((0, 1), (0, 2), (1, 2)) for s in (1, -1)]
    centres = numbers(frame, "origin_x", "origin_y", "origin_z"), centre_of_volume(shape)
    return [(n, float(n @ c)) for n in normals for c in centres]


def listed(normal, offset, rows, size):
    """Whether a plane is among the stated ones, or contains a stated axis of revolution."""
    for row in rows:
        if row["label"] == "revolution":
            point, along = numbers(row, "axis_px", "axis_py", "axis_pz"), numbers(row, "axis_dx", "axis_dy", "axis_dz")
            if abs(normal @ along) < SAME_ANGLE and abs(normal @ point - offset) < SAME_OFFSET * size:
                return True
        elif row["nx"]:
            other = numbers(row, "nx", "ny", "nz")
            sign = np.sign(other @ normal) or 1.0
            if np.linalg.norm(sign * other - normal) < SAME_ANGLE and abs(sign * float(row["offset_mm"]) -
                                                                          offset) < 2 * SAME_OFFSET * size:
                return True
    return False


def faults(path, shape, rows, frame):
    """What the file contradicts, as sentences."""
    size = float(rows[0]["size_mm"])
    found = [measure.fault(shape)] if measure.fault(shape) else []
    mirrors = measure.Mirrors(shape, size)
    for row in rows:
        if row["label"] == "revolution":
            for normal, offset in axis_planes(row):
                share = mirrors.coverage(normal, offset)
                if share < EXACT:
                    found.append(f"a plane through the axis covers {share:.4f}")
        elif row["nx"]:
            share = mirrors.coverage(numbers(row, "nx", "ny", "nz"), float(row["offset_mm"]))
            stated = float(row["coverage"])
            if (row["label"] == "exact") != (share >= EXACT) or abs(share - stated) > 5e-3:
                found.append(f"{row['label']} plane covers {share:.4f}, stated {stated:.4f}")
    for normal, offset in guesses(frame, shape):
        if listed(normal, offset, rows, size) or mirrors.coverage(normal, offset, 200) < 0.98:
            continue
        if mirrors.coverage(normal, offset) >= EXACT:
            found.append(f"unlisted exact plane {np.round(normal, 4)} at {offset:.4f}")
    return found


def run(out, only):
    """Checks all models; prints the faults and returns the exit code."""
    truth, frames, bad = rows_by_path(out / "truth.csv"), rows_by_path(out / "frame.csv"), 0
    labels = rows_by_path(out / "labels.csv")
    if set(labels) != set(truth) or set(labels) != set(frames):
        print("labels.csv, truth.csv and frame.csv do not name the same files")
        return 1
    for path, rows in truth.items():
        if any(word in path for word in only.split(",")):
            found = faults(path, write.read(out / path), rows, frames[path][0])
            bad += bool(found)
            print(f"{path:44} {'; '.join(found) or 'ok'}", flush=True)
    print(f"{bad} models with faults")
    return int(bad > 0)
