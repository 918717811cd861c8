#!/usr/bin/env python3
"""Opens the arrays of a store in NumPy as they lie in the file, without a copy.

    python3 contrib/numpy/open_store.py STORE [METHOD]

prints the nearest neighbour of each model by the magnitudes of METHOD (the store's first). SYMALIGN names the program.
"""

import json
import os
import subprocess
import sys

import numpy


def symalign(*arguments):
    program = os.environ.get("SYMALIGN", "symalign")
    return subprocess.run([program, *arguments], check=True, stdout=subprocess.PIPE, text=True).stdout


def open_store(folder):
    """The ids, and the mapped arrays by (method or None, name); row i of each array is model i."""
    info = json.loads(symalign("store", "info", "--json", folder))
    ids = symalign("store", "list", folder).split("\n")[:-1]
    arrays = {
        (section.get("method"), section["name"]): numpy.memmap(
            info["file"], section["dtype"], "r", section["offset"], tuple(section["shape"])
        )
        for section in info["sections"]
        if "dtype" in section and section["bytes"] > 0  # no memory can be mapped of an empty store
    }
    return info["methods"], ids, arrays


def nearest(rows):
    """For each row the number of the row next to it, and how far that is."""
    for i, row in enumerate(rows):
        distances = numpy.linalg.norm(rows - row, axis=1)
        distances[i] = numpy.inf
        yield distances.argmin(), distances.min()


if __name__ == "__main__":
    methods, ids, arrays = open_store(sys.argv[1])
    method = sys.argv[2] if len(sys.argv) > 2 else methods[0]
    for name, (other, distance) in zip(ids, nearest(arrays[method, "magnitude"])):
        print(f"{distance:10.5f}  {name}  {ids[other]}")
