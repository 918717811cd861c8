#!/usr/bin/env python3
"""Holds the frames mbb, mpa, rectilinearity and prst against searches that share nothing with them.

    cargo build --release
    pip install cadquery-ocp trimesh scipy
    python benches/frames.py MODEL.step...

OpenCASCADE reads and tessellates each model; what a frame minimises or maximises is then measured on that mesh, in
symalign's frame and in the best frame of the search:

    mbb             volume of the box; trimesh's bounding_box_oriented
    mpa             area of the shadow along the first axis (pixels); the least of 2,000 directions
    rectilinearity  sum of S (|n.e1| + |n.e2| + |n.e3|); the least of 2,000 rotations, then Nelder and Mead
    prst            symmetry across the first axis (k-d tree of samples); the most of 2,000 directions through the centroid

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


def shadow(mesh, direction, pixels=160):
    """Covered pixels, each counted where its centre lies in a triangle."""
    d = direction / np.linalg.norm(direction)
    u = np.cross(d, np.eye(3)[np.argmin(abs(d))])
    u /= np.linalg.norm(u)
    flat = (mesh.vertices - mesh.vertices.mean(0)) @ np.array([u, np.cross(d, u)]).T
    pixel = 2 * np.linalg.norm(mesh.vertices - mesh.vertices.mean(0), axis=1).max() / pixels
    flat = flat / pixel + pixels / 2
    covered = np.zeros((pixels, pixels), bool)
    for a, b, c in flat[mesh.faces]:
        low, high = np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)
        x = np.arange(np.ceil(low[0] - 0.5), np.floor(high[0] - 0.5) + 1).astype(int)
        y = np.arange(np.ceil(low[1] - 0.5), np.floor(high[1] - 0.5) + 1).astype(int)
        if not len(x) or not len(y):
            continue
        px, py = np.meshgrid(x + 0.5, y + 0.5)
        side = [(q[0] - p[0]) * (py - p[1]) - (q[1] - p[1]) * (px - p[0]) for p, q in ((a, b), (b, c), (c, a))]
        inside = np.all(np.array(side) >= 0, 0) | np.all(np.array(side) <= 0, 0)
        covered[py[inside].astype(int), px[inside].astype(int)] = True
    return covered.sum() * pixel**2


def rectilinear(mesh, axes):
    return (mesh.area_faces[:, None] * abs(mesh.face_normals @ np.asarray(axes).T)).sum()


def symmetry(samples, tree, centre, size, normal):
    """The most over planes across `normal` within 0.06 D of the centroid."""
    n = normal / np.linalg.norm(normal)
    best = 0
    for offset in np.linspace(-0.06, 0.06, 13) * size:
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
        coarse = [shadow(mesh, r[0], 48) for r in directions[:600]]
        best = min(shadow(mesh, directions[i][0]) for i in np.argsort(coarse)[:10])
        shade = shadow(mesh, frames["mpa"][0]) / best
        start = min(directions, key=lambda r: rectilinear(mesh, r))
        found = minimize(lambda v: rectilinear(mesh, Rotation.from_rotvec(v).as_matrix() @ start), np.zeros(3),
                         method="Nelder-Mead", options={"xatol": 1e-6, "fatol": 1e-9 * mesh.area})
        straight = rectilinear(mesh, frames["rectilinearity"]) / found.fun
        samples = trimesh.sample.sample_surface(mesh, 6000, seed=1)[0]
        centre = mesh.triangles_center.T @ mesh.area_faces / mesh.area
        size = 2 * np.linalg.norm(mesh.vertices - centre, axis=1).max()
        tree, few = cKDTree(samples), samples[:400]
        most = max(symmetry(few, tree, centre, size, r[0]) for r in directions[:400])
        mirrored = symmetry(few, tree, centre, size, frames["prst"][0]) / most
        print(f"{pathlib.Path(path).name:36} {boxed:7.3f} {shade:7.3f} {straight:8.3f} {mirrored:7.3f}", flush=True)


if __name__ == "__main__":
    main()
