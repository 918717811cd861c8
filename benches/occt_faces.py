#!/usr/bin/env python3
"""Holds every face of STEP files against OpenCASCADE's: exact area and exact box.

    pip install cadquery-ocp
    occt_faces.py facts FILE_OR_FOLDER... > occt.csv          # OpenCASCADE's faces, one row each
    cargo run --release --example faces -- FILE_OR_FOLDER... > ours.csv
    occt_faces.py compare ours.csv occt.csv                   # prints what differs, then a summary

Give both listings the same paths. Lengths are in mm. A face is matched with the one of the same file whose area
centroid is nearest, among those that nobody has taken; faces that are left over on either side are printed as well.
What is printed: the file, our entity number, the kind of surface, and by how much the face is off:

    area       |ours - OCCT's| as a share of OCCT's area             printed above 0.005
               (OCCT's quadrature is of a fixed order, which free-form borders need more of, or adaptive and now and
               then far off; where the two differ by more than 0.002, its own fine triangles decide)
    triangles  |our triangles' area - our exact area| / exact area   printed above 0.03
    box        largest distance of two sides / the file's diagonal   printed above 0.002
               (OCCT's box of a free-form face is that of its parameter rectangle; where the box of its edges is
               another one, its own fine triangles decide)

Passed over (`--all` shows them) are errors of area below 1e-6 of the file's area, and of triangles below 1e-4 of it,
which is what tests/triangles.rs holds.
"""
import csv
import os
import sys
from collections import defaultdict

from reading import corners

LIMITS = {"area": 0.005, "triangles": 0.03, "box": 0.002}
UNSEEN = {"area": 1e-6, "triangles": 1e-4, "box": 0.0}
STEP = (".step", ".stp", ".p21")
CORNERS = "xmin ymin zmin xmax ymax zmax".split()
CENTROID = "cx cy cz".split()
FREE_FORM = ("bsplinesurface", "beziersurface", "surfaceofrevolution", "surfaceofextrusion", "offsetsurface", "othersurface")


def distance(a, b):
    return max(abs(x - y) for x, y in zip(a, b))


def paths(arguments):
    for a in arguments:
        if os.path.isdir(a):
            for folder, _, names in sorted(os.walk(a)):
                yield from (os.path.join(folder, n) for n in sorted(names) if n.lower().endswith(STEP))
        else:
            yield a


def triangles(face, deflection):
    """The area and the box of OpenCASCADE's triangles."""
    from OCP.Bnd import Bnd_Box
    from OCP.BRep import BRep_Tool
    from OCP.BRepMesh import BRepMesh_IncrementalMesh
    from OCP.TopLoc import TopLoc_Location

    BRepMesh_IncrementalMesh(face, deflection, False, 0.1, False)
    place = TopLoc_Location()
    mesh = BRep_Tool.Triangulation_s(face, place)
    if mesh is None:
        return None, None
    box, total = Bnd_Box(), 0.0
    nodes = [mesh.Node(i + 1).Transformed(place.Transformation()) for i in range(mesh.NbNodes())]
    for p in nodes:
        box.Add(p)
    for i in range(1, mesh.NbTriangles() + 1):
        a, b, c = (nodes[k - 1].XYZ() for k in mesh.Triangle(i).Get())
        total += 0.5 * b.Subtracted(a).Crossed(c.Subtracted(a)).Modulus()
    return total, box


def edge_box(face):
    from OCP.Bnd import Bnd_Box
    from OCP.BRepBndLib import BRepBndLib
    from OCP.TopAbs import TopAbs_EDGE
    from OCP.TopExp import TopExp_Explorer

    box = Bnd_Box()
    edges = TopExp_Explorer(face, TopAbs_EDGE)
    while edges.More():
        BRepBndLib.AddOptimal_s(edges.Current(), box, False, False)
        edges.Next()
    return box


def face_facts(face):
    from OCP.Bnd import Bnd_Box
    from OCP.BRepAdaptor import BRepAdaptor_Surface
    from OCP.BRepBndLib import BRepBndLib
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    box, fixed, adaptive = Bnd_Box(), GProp_GProps(), GProp_GProps()
    BRepBndLib.AddOptimal_s(face, box, False, False)
    BRepGProp.SurfaceProperties_s(face, fixed)
    kind = str(BRepAdaptor_Surface(face, False).GetType()).split("_")[-1].lower()
    area, c = abs(fixed.Mass()), fixed.CentreOfMass()
    BRepGProp.SurfaceProperties_s(face, adaptive, 1e-5, False)
    unsure = not abs(abs(adaptive.Mass()) - area) <= 0.002 * area
    edges = edge_box(face) if kind in FREE_FORM else box
    beyond = edges.IsVoid() or box.IsVoid() or distance(corners(edges), corners(box)) > 1e-3 * box.SquareExtent() ** 0.5
    if unsure or beyond:
        mesh_area, mesh_box = triangles(face, 0.001 * area**0.5)
        area = mesh_area if unsure and mesh_area else area
        box = mesh_box if beyond and mesh_box else box
    row = {"kind": kind, "area": area, "cx": c.X(), "cy": c.Y(), "cz": c.Z()}
    if not box.IsVoid():
        row.update(zip(CORNERS, corners(box)))
    return row


def read(path):
    from OCP.IFSelect import IFSelect_RetDone
    from OCP.STEPControl import STEPControl_Reader
    from OCP.TopAbs import TopAbs_FACE
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS
    to_face = getattr(TopoDS, "Face_s", None) or TopoDS.Face

    reader = STEPControl_Reader()
    if reader.ReadFile(path) != IFSelect_RetDone:
        return
    reader.TransferRoots()
    if reader.NbShapes() == 0:
        return
    e = TopExp_Explorer(reader.OneShape(), TopAbs_FACE)
    while e.More():
        yield to_face(e.Current())
        e.Next()


def facts(arguments):
    from OCP.Message import Message, Message_Gravity

    for printer in list(Message.DefaultMessenger_s().Printers()):
        printer.SetTraceLevel(Message_Gravity.Message_Fail)
    out = csv.DictWriter(sys.stdout, ["path", "face", "kind", "area", *CORNERS, *CENTROID])
    out.writeheader()
    for path in paths(arguments):
        for index, face in enumerate(read(path)):
            try:
                row = face_facts(face)
            except Exception as e:  # a face that OCCT itself cannot measure is a fact too
                print(f"{path}: face {index}: {type(e).__name__}: {e}", file=sys.stderr)
                row = {}
            out.writerow({"path": path, "face": index, **row})
        sys.stdout.flush()


def number(row, name):
    return float(row[name]) if row.get(name) else float("nan")


def load(path):
    files = defaultdict(list)
    with open(path, newline="") as f:
        for row in csv.DictReader(f):
            row["centre"] = [number(row, c) for c in CENTROID]
            row["corners"] = [number(row, c) for c in CORNERS]
            row["measure"] = number(row, "area")
            files[row["path"]].append(row)
    return files


def diagonal(rows):
    low = [min((r["corners"][k] for r in rows if r["corners"][k] == r["corners"][k]), default=0) for k in range(3)]
    high = [max((r["corners"][k] for r in rows if r["corners"][k] == r["corners"][k]), default=0) for k in (3, 4, 5)]
    return sum((b - a) ** 2 for a, b in zip(low, high)) ** 0.5 or 1.0


def match(ours, theirs, size):
    """Pairs (ours, theirs): the same place in both lists first where they agree, then nearest first."""
    def cost(a, b):
        far = distance(a["centre"], b["centre"]) + distance(a["corners"], b["corners"])
        return far / size + abs(a["measure"] - b["measure"]) / (size * size)

    pairs, left, right = [], [], []
    if len(ours) == len(theirs):
        for a, b in zip(ours, theirs):
            if cost(a, b) < 1e-4:
                pairs.append((a, b))
            else:
                left.append(a)
                right.append(b)
    else:
        left, right = list(ours), list(theirs)
    if len(left) * len(right) > 25_000_000:
        return pairs, left, right
    costs = sorted((c, i, j) for i, a in enumerate(left) for j, b in enumerate(right) if (c := cost(a, b)) < 1)
    used, taken = set(), set()
    for _, i, j in costs:
        if i not in used and j not in taken:
            used.add(i)
            taken.add(j)
            pairs.append((left[i], right[j]))
    rest = [a for i, a in enumerate(left) if i not in used], [b for j, b in enumerate(right) if j not in taken]
    return pairs, *rest


def differences(a, b, size, whole, show_all):
    """What of a pair is beyond its limit."""
    area, exact = a["measure"], abs(b["measure"])
    tiny = 1e-12 * whole
    off = {
        "area": (abs(area - exact), max(exact, tiny)),
        "triangles": (abs(number(a, "triangles") - area), max(area, tiny)),
        "box": (distance(a["corners"], b["corners"]), size),
    }
    seen = {k: v / of for k, (v, of) in off.items() if show_all or not v <= UNSEEN[k] * whole}
    return {k: v for k, v in seen.items() if not v <= LIMITS[k]}


def compare(ours_csv, theirs_csv, show_all):
    ours, theirs = load(ours_csv), load(theirs_csv)
    tally, bad_files = defaultdict(int), defaultdict(set)
    for path, occt in theirs.items():
        good = [r for r in ours.get(path, []) if r["area"]]
        size, whole = diagonal(occt), sum(abs(r["measure"]) for r in occt if r["measure"] == r["measure"])
        pairs, left, right = match(good, occt, size)
        tally["faces"] += len(occt)
        tally["pairs"] += len(pairs)
        for a, b in pairs:
            off = differences(a, b, size, whole, show_all)
            if off:
                what = ", ".join(f"{k} {v:.4f}" for k, v in off.items())
                print(f"{path} #{a['entity']} {a['kind']}: {what} (area {a['measure']:.6g}, {b['measure']:.6g}, "
                      f"triangles {number(a, 'triangles'):.6g})")
                for k in off:
                    tally[k] += 1
                    bad_files[k].add(path)
        for a in left:
            print(f"{path} #{a['entity']} {a['kind']}: only ours (area {a['measure']:.6g})")
        for b in right:
            print(f"{path} face {b['face']} {b['kind']}: only OCCT's (area {b['measure']:.6g})")
        for r in ours.get(path, []):
            if not r["area"]:
                print(f"{path} #{r['entity']}: {r['why']}")
        if left or right:
            bad_files["count"].add(path)
    print(f"{len(theirs)} files, {tally['faces']} faces, {tally['pairs']} matched")
    for k in ("count", *LIMITS):
        print(f"  {k}: {tally[k]} faces off in {len(bad_files[k])} files")


if __name__ == "__main__":
    arguments = [a for a in sys.argv[1:] if a != "--all"]
    if len(arguments) > 1 and arguments[0] == "facts":
        facts(arguments[1:])
    elif len(arguments) == 3 and arguments[0] == "compare":
        compare(arguments[1], arguments[2], "--all" in sys.argv)
    else:
        sys.exit(__doc__)
