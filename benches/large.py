#!/usr/bin/env python3
"""Writes a large STEP file: many copies of one model side by side, as parts of one file.

    python3 benches/large.py data-samples/instrument/trumpet.step 500 large.step    about 500 MB
    symalign run large.step --store large-store                                     time by stage, at the end
    python3 benches/large.py --run large.step...                                    the same as a table, with the peak memory

`cargo run --release --example face_scaling` makes models by their number of faces instead.
"""
import json
import os
import re
import subprocess
import sys
import tempfile

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
SYMALIGN = os.path.join(ROOT, "target", "release", "symalign")
STAGES = ("parse", "corner_filter", "pair_match", "isometry", "validate", "merge", "projection_sweep", "descriptor")
POINT = re.compile(r"CARTESIAN_POINT\s*\(\s*('[^']*')\s*,\s*\(\s*([-+.\dEe]+)\s*,\s*([-+.\dEe]+)\s*,\s*([-+.\dEe]+)\s*\)")
NUMBER = re.compile(r"#(\d+)")


def write(source, megabytes, target):
    with open(source, encoding="latin-1") as file:
        head, data, tail = re.split(r"(?<=DATA;)|(?=ENDSEC;\s*END-ISO)", file.read())
    last = max(map(int, NUMBER.findall(data)))
    xs = [abs(float(x)) for _, x, _, _ in POINT.findall(data)]
    step = 2.5 * max(xs) or 1.0
    copies = max(1, round(megabytes * 1e6 / len(data)))
    with open(target, "w", encoding="latin-1") as file:
        file.write(head)
        for copy in range(copies):
            moved = POINT.sub(lambda p: f"CARTESIAN_POINT({p[1]},({float(p[2]) + copy * step!r},{p[3]},{p[4]})", data)
            file.write(NUMBER.sub(lambda n: f"#{int(n[1]) + copy * last}", moved))
        file.write(tail)
    print(f"{target}: {copies} copies, {os.path.getsize(target) / 1e6:.0f} MB")


def run(paths):
    print(f"{'MB':>7} {'faces':>8} {'triangles':>10} " + " ".join(f"{name[:10]:>10}" for name in STAGES)
          + "      total  seconds a GB  peak MB  bytes a byte")
    for path in paths:
        with tempfile.TemporaryDirectory() as folder, open(os.path.join(folder, "out"), "w+") as out:
            process = subprocess.Popen([SYMALIGN, "inspect", "--json", path], stdout=out, cwd=ROOT)
            _, _, usage = os.wait4(process.pid, 0)
            process.returncode = 0
            out.seek(0)
            facts = json.load(out)
        size, peak = os.path.getsize(path), usage.ru_maxrss * 1024
        if "error" in facts:
            print(f"{size / 1e6:7.0f} {facts['error']}")
            continue
        seconds = [facts["seconds"][name] for name in STAGES]
        print(f"{size / 1e6:7.0f} {facts['faces']:8} {facts['triangles']:10} "
              + " ".join(f"{s:10.3f}" for s in seconds)
              + f" {sum(seconds):10.2f} {sum(seconds) / size * 1e9:13.1f} {peak / 1e6:8.0f} {peak / size:13.1f}")


if __name__ == "__main__":
    if sys.argv[1] == "--run":
        run(sys.argv[2:])
    else:
        write(sys.argv[1], float(sys.argv[2]), sys.argv[3])
