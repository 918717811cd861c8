"""Solids from OpenCASCADE (through OCP): primitives, extrusions, revolutions, booleans.

Every length is in millimetres and every angle in degrees. Points are plain tuples (x, y, z). The natural pose
of all families is x forward, y to the left, z up.
"""

import math

from OCP import collections as occ
from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
from OCP.BRepBuilderAPI import (BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakeSolid,
                                BRepBuilderAPI_MakeWire, BRepBuilderAPI_Sewing, BRepBuilderAPI_Transform)
from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet
from OCP.BRepLib import BRepLib
from OCP.BRepOffsetAPI import BRepOffsetAPI_MakePipeShell, BRepOffsetAPI_ThruSections
from OCP.BRepPrimAPI import (BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCone, BRepPrimAPI_MakeCylinder, BRepPrimAPI_MakePrism,
                             BRepPrimAPI_MakeRevol, BRepPrimAPI_MakeSphere, BRepPrimAPI_MakeTorus)
from OCP.Geom import Geom_BezierCurve
from OCP.GeomAPI import GeomAPI_Interpolate
from OCP.gp import gp_Ax1, gp_Ax2, gp_Circ, gp_Dir, gp_Pnt, gp_Trsf, gp_Vec
from OCP.ShapeFix import ShapeFix_Shape
from OCP.ShapeUpgrade import ShapeUpgrade_UnifySameDomain
from OCP.TopAbs import TopAbs_EDGE, TopAbs_SHELL, TopAbs_SOLID
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS

# ---- small conversions -------------------------------------------------------------------------------------


def pnt(p):
    """A point from a tuple."""
    return gp_Pnt(*(float(c) for c in p))


def vec(v):
    """A vector from a tuple."""
    return gp_Vec(*(float(c) for c in v))


def direction(v):
    """A unit direction from a tuple."""
    return gp_Dir(*(float(c) for c in v))


def parts_of(shape, kind):
    """The sub-shapes of one kind (TopAbs_EDGE, ...), in the order of the explorer."""
    found, walk = [], TopExp_Explorer(shape, kind)
    while walk.More():
        found.append(walk.Current())
        walk.Next()
    return found


def solids_of(shape):
    """The solids inside a shape."""
    return parts_of(shape, TopAbs_SOLID)


# ---- placing -----------------------------------------------------------------------------------------------


def apply(shape, trsf):
    """A transformed copy of the shape (geometry changed, no location left)."""
    return BRepBuilderAPI_Transform(shape, trsf, True).Shape()


def shift(dx=0.0, dy=0.0, dz=0.0):
    """The translation by (dx, dy, dz)."""
    trsf = gp_Trsf()
    trsf.SetTranslation(vec((dx, dy, dz)))
    return trsf


def turn(angle, axis=(0, 0, 1), at=(0, 0, 0)):
    """The rotation by an angle about an axis through a point."""
    trsf = gp_Trsf()
    trsf.SetRotation(gp_Ax1(pnt(at), direction(axis)), math.radians(angle))
    return trsf


def move(shape, dx=0.0, dy=0.0, dz=0.0):
    """The shape translated."""
    return apply(shape, shift(dx, dy, dz))


def rotate(shape, angle, axis=(0, 0, 1), at=(0, 0, 0)):
    """The shape rotated."""
    return apply(shape, turn(angle, axis, at))


def mirror(shape, normal=(0, 1, 0), at=(0, 0, 0)):
    """The mirror image of the shape (left and right by default)."""
    trsf = gp_Trsf()
    trsf.SetMirror(gp_Ax2(pnt(at), direction(normal)))
    return apply(shape, trsf)


# ---- primitives --------------------------------------------------------------------------------------------


def box(size, at=(0, 0, 0)):
    """A box of the given size, centred at a point."""
    corner = [c - s / 2 for c, s in zip(at, size)]
    return BRepPrimAPI_MakeBox(pnt(corner), *(float(s) for s in size)).Shape()


def rod(start, end, r1, r2=None):
    """A cylinder, or a cone where r2 is given, between two points."""
    along = [e - s for s, e in zip(start, end)]
    length = math.sqrt(sum(c * c for c in along))
    frame = gp_Ax2(pnt(start), direction(along))
    if r2 is None or abs(r2 - r1) < 1e-9:
        return BRepPrimAPI_MakeCylinder(frame, float(r1), length).Shape()
    return BRepPrimAPI_MakeCone(frame, float(r1), float(r2), length).Shape()


def ball(at, r):
    """A sphere."""
    return BRepPrimAPI_MakeSphere(pnt(at), float(r)).Shape()


def ring(at, axis, major, minor):
    """A torus."""
    return BRepPrimAPI_MakeTorus(gp_Ax2(pnt(at), direction(axis)), float(major), float(minor)).Shape()


# ---- wires, extrusions, revolutions ------------------------------------------------------------------------


def polyline(points, closed=True):
    """A wire of straight edges."""
    ends = points[1:] + points[:1] if closed else points[1:]
    wire = BRepBuilderAPI_MakeWire()
    for a, b in zip(points, ends):
        wire.Add(BRepBuilderAPI_MakeEdge(pnt(a), pnt(b)).Edge())
    return wire.Wire()


def spline_edge(points, periodic=False):
    """An edge: the cubic spline that interpolates the points."""
    array = occ.HArray1_gp_Pnt(1, len(points))
    for i, p in enumerate(points):
        array.SetValue(i + 1, pnt(p))
    fit = GeomAPI_Interpolate(array, periodic, 1e-6)
    fit.Perform()
    return BRepBuilderAPI_MakeEdge(fit.Curve()).Edge()


def bezier_edge(points):
    """An edge: the Bezier curve of the control points."""
    array = occ.Array1_gp_Pnt(1, len(points))
    for i, p in enumerate(points):
        array.SetValue(i + 1, pnt(p))
    return BRepBuilderAPI_MakeEdge(Geom_BezierCurve(array)).Edge()


def wire_of(*edges):
    """A wire of edges that meet end to end."""
    wire = BRepBuilderAPI_MakeWire()
    for edge in edges:
        wire.Add(edge)
    return wire.Wire()


def circle_wire(at, axis, r):
    """A circle as a wire."""
    circle = gp_Circ(gp_Ax2(pnt(at), direction(axis)), float(r))
    return wire_of(BRepBuilderAPI_MakeEdge(circle).Edge())


def face_of(wire):
    """The planar face inside a wire."""
    return BRepBuilderAPI_MakeFace(wire).Face()


def prism(wire, along):
    """The solid swept by the planar inside of a wire along a vector."""
    return BRepPrimAPI_MakePrism(face_of(wire), vec(along)).Shape()


PLANES = {"xy": lambda u, v, w: (u, v, w), "xz": lambda u, v, w: (u, w, v), "yz": lambda u, v, w: (w, u, v)}
NORMALS = {"xy": (0, 0, 1), "xz": (0, 1, 0), "yz": (1, 0, 0)}


def slab(points, thickness, plane="xy", at=0.0, smooth=False):
    """A flat plate: a closed outline of (u, v) points, thick on both sides of the plane at the given height.

    `smooth` makes the outline one periodic spline instead of a polygon.
    """
    place = PLANES[plane]
    outline = [place(u, v, at - thickness / 2) for u, v in points]
    wire = wire_of(spline_edge(outline, True)) if smooth else polyline(outline)
    return prism(wire, [thickness * c for c in NORMALS[plane]])


def curved_slab(pieces, thickness, plane="xy", at=0.0):
    """A flat plate whose outline is made of pieces: a list of point lists, two points a line, more a spline."""
    place = PLANES[plane]
    edges = []
    for piece in pieces:
        points = [place(u, v, at - thickness / 2) for u, v in piece]
        straight = len(points) == 2
        edges.append(BRepBuilderAPI_MakeEdge(*map(pnt, points)).Edge() if straight else spline_edge(points))
    return prism(wire_of(*edges), [thickness * c for c in NORMALS[plane]])


def lathe(profile, at=(0, 0, 0), axis="z", angle=360.0):
    """A body of revolution from pieces of (r, h) points, closed along the axis where it does not close itself.

    `profile` is a list of pieces, each a list of points: two points make a line, more make a spline. The pieces
    follow each other; straight edges close the outline over the axis.
    """
    swap = {"z": lambda r, h: (r, 0, h), "x": lambda r, h: (h, 0, r), "y": lambda r, h: (r, h, 0)}[axis]
    place = lambda p: tuple(c + d for c, d in zip(swap(*p), at))
    first, last = profile[0][0], profile[-1][-1]
    closing = [last, (0.0, last[1]), (0.0, first[1]), first] if first != last else []
    pieces = list(profile) + [[a, b] for a, b in zip(closing, closing[1:]) if math.dist(a, b) > 1e-9]
    edges = [
        spline_edge([place(p) for p in piece]) if len(piece) > 2 else BRepBuilderAPI_MakeEdge(
            pnt(place(piece[0])), pnt(place(piece[1]))).Edge() for piece in pieces
    ]
    spin = gp_Ax1(pnt(at), direction({"z": (0, 0, 1), "x": (1, 0, 0), "y": (0, 1, 0)}[axis]))
    face = face_of(wire_of(*edges))
    made = BRepPrimAPI_MakeRevol(face, spin) if angle >= 360 else BRepPrimAPI_MakeRevol(face, spin, math.radians(angle))
    return oriented(made.Shape())


def lines(*points):
    """A polyline as pieces for `lathe` and `curved_slab`."""
    return [[a, b] for a, b in zip(points, points[1:])]


def loft(wires, ruled=True):
    """The solid through closed wires, ruled or smooth."""
    made = BRepOffsetAPI_ThruSections(True, ruled, 1e-6)
    for wire in wires:
        made.AddWire(wire)
    made.CheckCompatibility(False)
    made.Build()
    return oriented(made.Shape())


def sweep(path, profile):
    """A profile wire swept along a path wire, with round or mitred corners as the path has them."""
    made = BRepOffsetAPI_MakePipeShell(path)
    made.Add(profile)
    made.Build()
    made.MakeSolid()
    return oriented(made.Shape())


# ---- booleans and finishing --------------------------------------------------------------------------------


def as_list(shapes):
    """An OCCT list of shapes."""
    listed = occ.List_TopoDS_Shape()
    for shape in shapes:
        listed.Append(shape)
    return listed


def boolean(operation, shapes, tools):
    """A boolean of two groups; the result is simplified where faces share a surface."""
    operation.SetArguments(as_list(shapes))
    operation.SetTools(as_list(tools))
    operation.Build()
    merged = ShapeUpgrade_UnifySameDomain(operation.Shape(), True, True, False)
    merged.Build()
    found = solids_of(merged.Shape())
    return found[0] if len(found) == 1 else merged.Shape()


def fuse(first, *others):
    """The union."""
    return boolean(BRepAlgoAPI_Fuse(), [first], others) if others else first


def cut(shape, *tools):
    """The shape without the tools."""
    return boolean(BRepAlgoAPI_Cut(), [shape], tools)


def fillet(shape, radius, keep=lambda middle: True):
    """Rounds the edges whose middle point satisfies `keep`; where the kernel fails the shape stays sharp."""
    made, picked = BRepFilletAPI_MakeFillet(shape), 0
    for edge in unique_edges(shape):
        if keep(edge_middle(edge)):
            made.Add(float(radius), edge)
            picked += 1
    if not picked:
        return shape
    try:
        made.Build()
        return made.Shape() if made.IsDone() else shape
    except Exception:  # the kernel reports a fillet it cannot build as an exception of many types
        return shape


def unique_edges(shape):
    """Every edge once, in a fixed order."""
    seen, found = occ.IndexedMap_TopoDS_Shape(), []
    for edge in parts_of(shape, TopAbs_EDGE):
        if not seen.Contains(edge):
            seen.Add(edge)
            found.append(TopoDS.Edge(edge))
    return found


def edge_middle(edge):
    """The point at the middle parameter of an edge."""
    from OCP.BRepAdaptor import BRepAdaptor_Curve
    curve = BRepAdaptor_Curve(edge)
    middle = curve.Value((curve.FirstParameter() + curve.LastParameter()) / 2)
    return middle.X(), middle.Y(), middle.Z()


def sewn(faces, tolerance=1e-5):
    """A closed solid from faces that meet along their edges."""
    sewing = BRepBuilderAPI_Sewing(tolerance)
    for face in faces:
        sewing.Add(face)
    sewing.Perform()
    shells = parts_of(sewing.SewedShape(), TopAbs_SHELL)
    solid = BRepBuilderAPI_MakeSolid(TopoDS.Shell(shells[0])).Solid()
    return oriented(solid)


def oriented(shape):
    """The shape with its solid turned inside in, so that the volume is positive."""
    found = solids_of(shape)
    if len(found) != 1:
        return shape
    solid = TopoDS.Solid(found[0])
    BRepLib.OrientClosedSolid_s(solid)
    return solid


def healed(shape):
    """The shape after the kernel's general repair."""
    fix = ShapeFix_Shape(shape)
    fix.Perform()
    return fix.Shape()
