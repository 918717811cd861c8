#!/usr/bin/env python3
"""Holds symalign's reading against OpenCASCADE's, both in this run, one thread each.

    pip install cadquery-ocp
    cargo build --release --example facts
    python3 benches/reading.py FILE_OR_FOLDER... [--out TABLE.csv]

Both read the same files and tessellate them at 0.2 % of the diagonal and 0.35 rad; a class is a file's folder.
OpenCASCADE runs in a process of its own, which is started again where it crashes or hangs. Exactness: equal numbers
of faces and solids, area and volume within 0.5 %, the box within 0.2 % of its diagonal.
"""
import argparse
import csv
import os
import statistics
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
FACTS = os.path.join(HERE, "..", "target", "release", "examples", "facts")
MODELS = (".step", ".stp", ".p21")
HANG_S = 300
BOX = ("xmin", "ymin", "zmin", "xmax", "ymax", "zmax")


def occt_facts(path):
    """Facts of one file from OpenCASCADE; the seconds are those of reading, transfer and meshing."""
    from OCP.BRepBndLib import BRepBndLib
    from OCP.BRepGProp import BRepGProp
    from OCP.BRepMesh import BRepMesh_IncrementalMesh
    from OCP.Bnd import Bnd_Box
    from OCP.GProp import GProp_GProps
    from OCP.IFSelect import IFSelect_RetDone
    from OCP.STEPControl import STEPControl_Reader
    from OCP.TopAbs import TopAbs_FACE, TopAbs_SOLID
    from OCP.TopExp import TopExp_Explorer

    def count(kind):
        explorer, n = TopExp_Explorer(shape, kind), 0
        while explorer.More():
            n += 1
            explorer.Next()
        return n

    row = {"path": path, "bytes": os.path.getsize(path), "ok": 0}
    reader, started = STEPControl_Reader(), time.process_time()
    if reader.ReadFile(path) != IFSelect_RetDone:
        return row
    reader.TransferRoots()
    if reader.NbShapes() == 0:
        return row
    shape = reader.OneShape()
    row["read_s"] = time.process_time() - started
    box, area, volume = Bnd_Box(), GProp_GProps(), GProp_GProps()
    BRepBndLib.AddOptimal_s(shape, box, False, False)
    BRepGProp.SurfaceProperties_s(shape, area)
    BRepGProp.VolumeProperties_s(shape, volume)
    started = time.process_time()
    if not box.IsVoid():
        BRepMesh_IncrementalMesh(shape, 0.002 * box.SquareExtent() ** 0.5, False, 0.35, False)
        row.update(zip(BOX, corners(box)))
    row.update(mesh_s=time.process_time() - started, ok=int(count(TopAbs_FACE) > 0), faces=count(TopAbs_FACE),
               solids=count(TopAbs_SOLID), area_mm2=area.Mass(), volume_mm3=volume.Mass())
    return row


def corners(box):
    """The least and the largest coordinates of a box; newer versions of OCP cannot pass on what its `Get` gives."""
    return tuple(c for p in (box.CornerMin(), box.CornerMax()) for c in (p.X(), p.Y(), p.Z()))


def occt_worker():
    """Reads names from standard input and writes facts, a line each."""
    from OCP.Message import Message, Message_Gravity
    for printer in list(Message.DefaultMessenger_s().Printers()):
        printer.SetTraceLevel(Message_Gravity.Message_Fail)
    out = csv.DictWriter(sys.stdout, COLUMNS, restval="")
    for line in sys.stdin:
        try:
            out.writerow(occt_facts(line.rstrip("\n")))
        except Exception as error:  # a file that OpenCASCADE refuses is a fact too
            out.writerow({"path": line.rstrip("\n"), "ok": 0, "why": f"{type(error).__name__}: {error}"})
        sys.stdout.flush()


COLUMNS = ["path", "bytes", "ok", "solids", "faces", "area_mm2", "volume_mm3", *BOX, "read_s", "mesh_s", "why"]


def occt(paths):
    """Facts of all files; a file that ends or hangs the process gets a row that says so."""
    rows, left = {}, list(paths)
    while left:
        with tempfile.TemporaryFile("w+") as names, tempfile.TemporaryFile("w+") as table:
            names.write("\n".join(left) + "\n")
            names.seek(0)
            worker = subprocess.Popen([sys.executable, __file__, "--worker"], stdin=names, stdout=table)
            seen, since = 0, time.monotonic()
            while worker.poll() is None:
                time.sleep(0.2)
                size = os.fstat(table.fileno()).st_size
                seen, since = (size, time.monotonic()) if size != seen else (seen, since)
                if time.monotonic() - since > HANG_S:
                    worker.kill()
            table.seek(0)
            done = list(csv.DictReader(table, COLUMNS))
        rows.update((row["path"], row) for row in done)
        left = left[len(done):]
        if left:
            rows[left[0]] = {"path": left[0], "ok": "0", "why": "crashed or hung"}
            left = left[1:]
    return rows


def symalign(paths):
    """Facts of all files from `benches/facts.rs`."""
    done = subprocess.run([FACTS, "-"], input="\n".join(paths), capture_output=True, text=True, check=True)
    return {row["path"]: row for row in csv.DictReader(done.stdout.splitlines())}


def peak_memory(path):
    """Peak resident bytes of reading and tessellating one file."""
    with open(os.devnull, "w") as nothing:
        process = subprocess.Popen([FACTS, path], stdout=nothing)
        _, _, usage = os.wait4(process.pid, 0)
        process.returncode = 0
    return usage.ru_maxrss * 1024


def number(row, name):
    return float(row[name]) if row.get(name) else 0.0


def seconds(row):
    return number(row, "read_s") + number(row, "mesh_s")


def faults(ours, theirs):
    """What differs between two rows."""
    if ours["ok"] != "1":
        return ["not read"]
    found = [name for name in ("faces", "solids") if int(ours[name]) != int(theirs[name])]
    for name in ("area_mm2", "volume_mm3"):
        if name == "area_mm2" or int(theirs["solids"]) > 0:
            a, b = abs(number(ours, name)), abs(number(theirs, name))
            found += [f"{name} {a / b - 1:+.2%}" if b else name] if abs(a - b) > 0.005 * b else []
    diagonal = sum((number(theirs, high) - number(theirs, low)) ** 2 for low, high in zip(BOX, BOX[3:])) ** 0.5
    off = max(abs(number(ours, name) - number(theirs, name)) for name in BOX)
    return found + ([f"box {off / diagonal:.2%}" if diagonal else "box"] if off > 0.002 * diagonal else [])


def report(paths, ours, theirs):
    read = [p for p in paths if theirs[p]["ok"] == "1"]
    wrong = {p: faults(ours[p], theirs[p]) for p in read}
    print(f"{len(paths)} files, {sum(os.path.getsize(p) for p in paths) / 1e6:.1f} MB; OpenCASCADE reads {len(read)}, "
          f"symalign {sum(ours[p]['ok'] == '1' for p in paths)}, {sum(ours[p]['ok'] == '1' for p in read)} of those")
    for name in ("faces", "solids", "area", "volume", "box"):
        good = sum(not any(f.startswith((name, "not")) for f in wrong[p]) for p in read)
        print(f"  {name:7} equal or within tolerance: {good} ({good / max(1, len(read)):.2%})")
    for p, found in wrong.items():
        if found:
            print(f"  {p}: {', '.join(found)}")
    speed(read, ours, theirs)


def speed(read, ours, theirs):
    classes = {}
    for p in read:
        classes.setdefault(os.path.basename(os.path.dirname(p)), []).append(p)
    print(f"{'class':44} files      MB  OCCT s  symalign s  ratio: total  median")
    for name, files in [*sorted(classes.items()), ("all", read)]:
        a, b = sum(seconds(theirs[p]) for p in files), sum(seconds(ours[p]) for p in files)
        median = statistics.median(seconds(theirs[p]) / max(1e-9, seconds(ours[p])) for p in files)
        size = sum(os.path.getsize(p) for p in files) / 1e6
        print(f"{name[:44]:44} {len(files):5} {size:7.1f} {a:7.2f} {b:11.3f} {a / max(1e-9, b):13.1f} {median:7.1f}")
    scanned = [p for p in read if ours[p]["ok"] == "1" and number(ours[p], "scan_s") > 0]
    size, scan = sum(os.path.getsize(p) for p in scanned), sum(number(ours[p], "scan_s") for p in scanned)
    print(f"text scan {size / 1e6 / max(1e-9, scan):.0f} MB/s")
    for p in sorted(read, key=os.path.getsize)[-3:]:
        size, peak = os.path.getsize(p), peak_memory(p)
        print(f"peak memory {peak / 1e6:7.1f} MB for {size / 1e6:6.1f} MB ({(peak - 30e6) / size:4.1f} x the file + 30 MB): {p}")


def model_files(arguments):
    for argument in arguments:
        if os.path.isdir(argument):
            for folder, _, names in sorted(os.walk(argument)):
                yield from (os.path.join(folder, n) for n in sorted(names) if n.lower().endswith(MODELS))
        else:
            yield argument


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="*")
    parser.add_argument("--out", help="also write both rows of each file to this table")
    parser.add_argument("--worker", action="store_true", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.worker:
        return occt_worker()
    paths = list(model_files(arguments.files))
    ours, theirs = symalign(paths), occt(paths)
    if arguments.out:
        with open(arguments.out, "w") as file:
            table = csv.DictWriter(file, ["who", *COLUMNS], restval="", extrasaction="ignore")
            table.writeheader()
            for p in paths:
                table.writerow({"who": "occt", **theirs[p]})
                table.writerow({"who": "symalign", **ours[p]})
    report(paths, ours, theirs)


if __name__ == "__main__":
    main()
