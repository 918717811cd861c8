#!/usr/bin/env python3
"""Holds the frames mbb, mpa, rectilinearity and prst against searches that share nothing with them.

    cargo build --release
    pip install cadquery-ocp trimesh scipy networkx
    python benches/frames.py MODEL.step...

OpenCASCADE reads and tessellates each model; what a frame minimises or maximises is then measured on that mesh, in
symalign's frame and in the best frame of the search:

    mbb             volume of the box; trimesh's bounding_box_oriented
    mpa             area of the shadow along the first axis (pixels with samples); the least of 500 directions
    rectilinearity  sum of S (|n.e1| + |n.e2| + |n.e3|); the least of 2,000 rotations, then Nelder and Mead
    prst            symmetry across the first axis (k-d tree of samples); the most of 200 directions near the centroid

A ratio of 1.00 means as good as the search; below 1 symalign's is better (for prst: above 1).
"""

import json
import pathlib
import subprocess
import sys

import numpy as np
import trimesh
from OCP.BRep import BRep_Tool
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_FACE, TopAbs_REVERSED
from OCP.TopExp import TopExp_Explorer
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS
from scipy.optimize import minimize
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

PROGRAM = pathlib.Path(__file__).resolve().parent.parent / "target/release/symalign"
METHODS = "mbb,mpa,rectilinearity,prst"


def mesh_of(path):
    """OpenCASCADE's triangles of a file."""
    reader = STEPControl_Reader()
    reader.ReadFile(str(path))
    reader.TransferRoots()
    shape = reader.OneShape()
    BRepMesh_IncrementalMesh(shape, 0.002, True, 0.2, False)
    points, triangles = [], []
    explorer = TopExp_Explorer(shape, TopAbs_FACE)
    while explorer.More():
        face = TopoDS.Face(explorer.Current())
        place = TopLoc_Location()
        part = BRep_Tool.Triangulation_s(face, place)
        if part is not None:
            move, first = place.Transformation(), len(points)
            for i in range(1, part.NbNodes() + 1):
                p = part.Node(i).Transformed(move)
                points.append((p.X(), p.Y(), p.Z()))
            for i in range(1, part.NbTriangles() + 1):
                corners = [first + k - 1 for k in part.Triangle(i).Get()]
                triangles.append(corners[::-1] if face.Orientation() == TopAbs_REVERSED else corners)
        explorer.Next()
    return trimesh.Trimesh(np.array(points), np.array(triangles), process=False)


def box(points, axes):
    return np.prod(np.ptp(points @ np.asarray(axes).T, axis=0))


def shadow(samples, direction, size, pixels=80):
    """Pixels that hold a sample of the surface."""
    d = direction / np.linalg.norm(direction)
    u = np.cross(d, np.eye(3)[np.argmin(abs(d))])
    u /= np.linalg.norm(u)
    cells = np.floor(samples @ np.array([u, np.cross(d, u)]).T * (pixels / size)).astype(int)
    return len(np.unique(cells @ [1, 10 * pixels]))


def rectilinear(mesh, axes):
    return (mesh.area_faces[:, None] * abs(mesh.face_normals @ np.asarray(axes).T)).sum()


def symmetry(samples, tree, centre, size, normal):
    """The most over planes across `normal` within 0.06 D of the centroid."""
    n = normal / np.linalg.norm(normal)
    best = 0
    for offset in np.linspace(-0.06, 0.06, 7) * size:
        image = samples - 2 * np.outer((samples - centre) @ n - offset, n)
        best = max(best, np.exp(-0.5 * (tree.query(image)[0] / (0.01 * size)) ** 2).mean())
    return best


def main():
    directions = Rotation.random(2000, random_state=1).as_matrix()
    print(f"{'model':36} {'mbb':>7} {'mpa':>7} {'rectil.':>8} {'prst':>7}")
    for path in sys.argv[1:]:
        out = subprocess.run([PROGRAM, "inspect", "--json", "--method", METHODS, path], capture_output=True, check=True)
        frames = {name: np.array(f["axes"]) for name, f in json.loads(out.stdout)["frames"].items()}
        mesh = mesh_of(path)
        hull = mesh.convex_hull.vertices
        boxed = box(hull, frames["mbb"]) / mesh.bounding_box_oriented.volume
        centre = mesh.triangles_center.T @ mesh.area_faces / mesh.area
        size = 2 * np.linalg.norm(mesh.vertices - centre, axis=1).max()
        samples = trimesh.sample.sample_surface(mesh, 60000, seed=1)[0]
        shade = shadow(samples, frames["mpa"][0], size) / min(shadow(samples, r[0], size) for r in directions[:500])
        start = min(directions, key=lambda r: rectilinear(mesh, r))
        found = minimize(lambda v: rectilinear(mesh, Rotation.from_rotvec(v).as_matrix() @ start), np.zeros(3),
                         method="Nelder-Mead", options={"xatol": 1e-6, "fatol": 1e-9 * mesh.area})
        straight = rectilinear(mesh, frames["rectilinearity"]) / found.fun
        tree, few = cKDTree(samples[::10]), samples[:400]
        most = max(symmetry(few, tree, centre, size, r[0]) for r in directions[:200])
        mirrored = symmetry(few, tree, centre, size, frames["prst"][0]) / most
        print(f"{pathlib.Path(path).name:36} {boxed:7.3f} {shade:7.3f} {straight:8.3f} {mirrored:7.3f}", flush=True)


if __name__ == "__main__":
    main()
