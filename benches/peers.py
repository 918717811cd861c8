#!/usr/bin/env python3
"""The whole of symalign side by side with what others need for a part of it, in this run, one core each.

    cargo build --release --examples --bins
    pip install cadquery-ocp numpy trimesh open3d    each may be missing; its rows are left out
    python3 benches/peers.py FILE_OR_FOLDER... [--every N]

- OpenCASCADE reads, transfers and meshes the files: no symmetry, frames or descriptors. symalign takes them through all eight
  stages into a store, with the symmetry frame, and once more with the three PCA frames as well.
- trimesh and Open3D take PCA and boxes of the meshes that OpenCASCADE made, symalign those of its own meshes.

For search against faiss see `query.py`. Times are those of the processor (user and system), so that other programs on the
machine disturb the ratios little. OpenCASCADE and symalign take turns, a few files at a time, for the same reason.
"""
import argparse
import csv
import os
import random
import resource
import subprocess
import sys
import tempfile
import time

import reading

ROOT = os.path.join(reading.HERE, "..")
SYMALIGN = os.path.join(ROOT, "target", "release", "symalign")
METHODS = ("symmetry", "symmetry,pca,cpca,npca")
# Files to a turn.
TURN = 25


def cpu_seconds(run):
    """Processor time of the child processes that `run` starts and waits for."""
    used = lambda: sum(resource.getrusage(resource.RUSAGE_CHILDREN)[:2])
    before = used()
    run()
    return used() - before


def occt(paths):
    """Processor seconds of OpenCASCADE's reading, transfer and meshing, as the process itself measures them."""
    rows = reading.occt(paths)
    read = [path for path in paths if rows[path]["ok"] == "1"]
    return {path: reading.seconds(rows[path]) for path in read}


def symalign(paths, methods, jobs=1):
    """Processor seconds of `symalign run`, all of it, and the models done."""
    with tempfile.TemporaryDirectory() as folder:
        command = [SYMALIGN, "run", *paths, "--store", f"{folder}/store", "--method", methods, "--jobs", str(jobs)]
        seconds = cpu_seconds(lambda: subprocess.run(command, cwd=folder, capture_output=True, check=True))
        info = subprocess.run([SYMALIGN, "store", "list", f"{folder}/store"], capture_output=True, text=True, check=True)
        return seconds, len(info.stdout.splitlines())


def pipelines(paths):
    """The table of the whole pipeline."""
    theirs, ours = 0.0, dict.fromkeys(METHODS, 0.0)
    models = 0
    for start in range(0, len(paths), TURN):
        turn = paths[start:start + TURN]
        read = occt(turn)
        theirs += sum(read.values())
        for methods in METHODS:
            seconds, done = symalign(sorted(read), methods)
            ours[methods] += seconds
        models += len(read)
        print(f"  {start + len(turn)} of {len(paths)} files", file=sys.stderr)
    size = sum(os.path.getsize(path) for path in paths)
    print(f"{models} models, {size / 1e6:.1f} MB, processor seconds")
    print(f"{'':58} seconds  ms a model  MB/s  OpenCASCADE takes")
    row("OpenCASCADE: read, transfer, mesh", theirs, models, size, theirs)
    for methods in METHODS:
        row(f"symalign, all stages: {methods}", ours[methods], models, size, theirs)


def row(name, seconds, models, size, theirs):
    print(f"{name:58} {seconds:7.2f} {1e3 * seconds / models:11.2f} {size / 1e6 / seconds:5.1f} {theirs / seconds:9.1f} x")


def frames_of_ours(paths):
    """Seconds of the three PCA frames and the box, in all."""
    done = subprocess.run([reading.FACTS, "-"], input="\n".join(paths), capture_output=True, text=True, check=True)
    return sum(reading.number(r, "frames_s") for r in csv.DictReader(done.stdout.splitlines()))


def triangles(path):
    """Points and triangles of OpenCASCADE's mesh as arrays."""
    import numpy
    from OCP.BRep import BRep_Tool
    from OCP.BRepMesh import BRepMesh_IncrementalMesh
    from OCP.STEPControl import STEPControl_Reader
    from OCP.TopAbs import TopAbs_FACE
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopLoc import TopLoc_Location
    from OCP.TopoDS import TopoDS
    to_face = getattr(TopoDS, "Face_s", None) or TopoDS.Face

    reader = STEPControl_Reader()
    reader.ReadFile(path)
    reader.TransferRoots()
    shape = reader.OneShape()
    BRepMesh_IncrementalMesh(shape, 0.1, False, 0.35, False)
    points, corners = [], []
    explorer = TopExp_Explorer(shape, TopAbs_FACE)
    while explorer.More():
        place = TopLoc_Location()
        mesh = BRep_Tool.Triangulation_s(to_face(explorer.Current()), place)
        if mesh is not None:
            first = len(points) - 1
            move = place.Transformation()
            for i in range(1, mesh.NbNodes() + 1):
                p = mesh.Node(i).Transformed(move)
                points.append((p.X(), p.Y(), p.Z()))
            corners += [[first + i for i in mesh.Triangle(t).Get()] for t in range(1, mesh.NbTriangles() + 1)]
        explorer.Next()
    return numpy.array(points, dtype=float).reshape(-1, 3), numpy.array(corners, dtype=int).reshape(-1, 3)


def by_trimesh(points, corners):
    import trimesh
    mesh = trimesh.Trimesh(points, corners, process=False)
    return mesh.bounds, mesh.principal_inertia_vectors


def by_open3d(points, corners):
    import numpy
    import open3d
    mesh = open3d.geometry.TriangleMesh(open3d.utility.Vector3dVector(points), open3d.utility.Vector3iVector(corners))
    cloud = open3d.geometry.PointCloud(mesh.vertices)
    return mesh.get_axis_aligned_bounding_box(), numpy.linalg.eigh(cloud.compute_mean_and_covariance()[1])


def frames(paths):
    """The table of PCA and boxes."""
    meshes = [mesh for mesh in map(triangles, paths) if len(mesh[1])]
    print(f"\nPCA and boxes of {len(meshes)} meshes")
    ours = frames_of_ours(paths)
    print(f"{'symalign: vertices, surface and normals, box':58} {1e3 * ours / len(paths):11.3f} ms a model")
    for name, take in (("trimesh: inertia, box", by_trimesh), ("Open3D: vertices, box", by_open3d)):
        try:
            take(*meshes[0])
        except ImportError:
            print(f"{name:58} {'not installed':>11}")
            continue
        started = time.process_time()
        for mesh in meshes:
            take(*mesh)
        seconds = time.process_time() - started
        print(f"{name:58} {1e3 * seconds / len(meshes):11.3f} ms a model, {seconds / ours:.1f} x")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="+")
    parser.add_argument("--every", type=int, default=1, help="take every N-th file of a shuffled list")
    arguments = parser.parse_args()
    for program in (SYMALIGN, reading.FACTS):
        if not os.path.exists(program):
            parser.error(f"{os.path.relpath(program)} is not built: cargo build --release --examples --bins")
    paths = list(reading.model_files(arguments.files))
    random.Random(7).shuffle(paths)
    paths = paths[::arguments.every]
    pipelines(paths)
    frames(paths[:50])


if __name__ == "__main__":
    main()
