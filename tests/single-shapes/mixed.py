"""The same geometry said differently left and right, damaged and engraved bodies, sheets, assemblies."""

import math

import numpy as np
from OCP.BRep import BRep_Tool
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
from OCP.GeomConvert import GeomConvert
from OCP.TopoDS import TopoDS
from shape import Shape, beside, extruded, faces_of, halved, joined, regular
from shapes.kernel import (ball, box, cut, face_of, fillet, fuse, lathe, lines, mirror, move, polyline, rod, rotate, sewn, shift,
                           turn)
from shapes.measure import bounds
from shapes.surfaces import surface_face
from shapes.variants import as_splines, split_left, without_seams


def restated(face, knots=3, swap=True, reverse=True, degree=1):
    """The same B-spline patch with its parameters exchanged and reversed, more knots, a higher degree."""
    surface = GeomConvert.SurfaceToBSplineSurface_s(BRep_Tool.Surface_s(TopoDS.Face(face)))
    if degree:
        surface.IncreaseDegree(surface.UDegree() + degree, surface.VDegree())
    u0, u1, v0, v1 = surface.Bounds()
    for k in range(1, knots + 1):
        surface.InsertUKnot(u0 + (u1 - u0) * (k / (knots + 1)) ** 1.3, 1, 1e-9)
        surface.InsertVKnot(v0 + (v1 - v0) * k / (knots + 2), 1, 1e-9)
    if swap:
        surface.ExchangeUV()
    if reverse:
        surface.UReverse()
    return BRepBuilderAPI_MakeFace(surface, 1e-6).Face()


def patch(height, nx=6, ny=5, size=(20, 16)):
    """A free-form patch z = height(x, y) as a bicubic net over y in [0, size]."""
    net = np.array([[(size[0] * (i / (nx - 1) - .5), size[1] * j / (ny - 1), height(i / (nx - 1), j / (ny - 1))) for j in range(ny)]
                    for i in range(nx)])
    clamp = lambda n: [0] * 4 + list(range(1, n - 3)) + [n - 3] * 4
    return surface_face(net, None, 3, clamp(nx), 3, clamp(ny))


def pillow(rng, **how):
    """Four free-form patches closed to a pillow, those on the left said differently: one plane."""
    a, b = rng.uniform(.5, 1.5, 2)
    bump = lambda s, t: 16 * s * (1 - s) * (1 - t * t) * (1 + a * s)
    dent = lambda s, t: -9 * s * (1 - s) * (1 - t * t) * (1 + b * (1 - s) * t)
    right = [patch(bump), patch(dent)]
    left = [restated(mirror(f), **how) for f in right]
    return Shape().add(sewn(right + left, 1e-4)).plane((0, 1, 0))


def saddle_pair(rng):
    """A sheet of two mirrored patches, one said differently."""
    a = rng.uniform(.7, 1.3)
    right = patch(lambda s, t: 8 * a * s * s - 3 * s * t * t * t)
    return Shape(sheet=True).add(joined([right, restated(mirror(right))])).plane((0, 1, 0))


def half_spline(rng):
    """A bored block whose left half is all B-spline."""
    solid = cut(box((30, 26, 10)), rod((6, 0, -9), (6, 0, 9), 5 * rng.uniform(.9, 1.1)), rod((-9, 7, -9), (-9, 7, 9), 2.5), rod((-9, -7, -9), (-9, -7, 9), 2.5),
                box((8, 40, 4), (15, 0, 5)))
    return Shape().add(halved(solid)).plane((0, 1, 0))


def half_spline_turned(rng):
    """A turned body whose left half is all B-spline."""
    solid = lathe([[(6, 0), (11, 8 * rng.uniform(.9, 1.1)), (7, 18), (9, 26)]])
    return Shape(axis=((0, 0, 0), (0, 0, 1))).add(halved(solid))


def halves_touching(rng):
    """Two touching half solids, the left one all B-spline."""
    solid = fuse(box((30, 20, 8)), rod((4, 0, 0), (4, 0, 14 * rng.uniform(.9, 1.1)), 6))
    shape = Shape().plane((0, 1, 0))
    for half in beside(solid):
        shape.add(half)
    return shape


def filleted_halves(rng):
    """A block rounded but for one edge, whose left half is cut in more faces."""
    solid = fillet(box((30, 24, 12)), 3 * rng.uniform(.8, 1.2), lambda m: m[2] > 0 and m[0] > -14)
    return Shape().add(split_left(split_left(solid, (1, 0, 0), .4), (0, 0, 1), .6)).box(z=False)


def split_block(rng):
    """A block of pockets whose left wall and left pockets are cut in pieces."""
    pockets = [box((6, 5, 8), (x, y, 6)) for x in (-9, 1) for y in (7, -7)]
    solid = cut(box((34, 24, 12 * rng.uniform(.95, 1.05))), *pockets, rod((11, 7, -9), (11, 7, 9), 3), rod((11, -7, -9), (11, -7, 9), 3))
    for normal, share in (((1, 0, 0), .3), ((1, 0, 0), .77), ((0, 0, 1), .5)):
        solid = split_left(solid, normal, share)
    return Shape().add(solid).plane((0, 1, 0))


def seams_and_none(rng):
    """A block with two bosses and two bores; those on the left have no seams."""
    solid, bore = box((30, 30, 8)), 3 * rng.uniform(.9, 1.1)
    for y in (9, -9):
        solid = fuse(solid, rod((7, y, 4), (7, y, 15), 5, 3))
        solid = cut(solid, rod((-7, y, -9), (-7, y, 9), bore))
    return Shape().add(halved(solid, without_seams)).plane((0, 1, 0))


# ---- damaged and engraved ----------------------------------------------------------------------------------


def bracket():
    """A body of one plane: an angle with two gussets and two holes."""
    angle = extruded([(0, 0), (40, 0), (40, 5), (5, 5), (5, 30), (0, 30)], 40)
    angle = rotate(angle, 90, (1, 0, 0))
    gusset = rotate(extruded([(4, 4), (30, 4), (4, 24)], 4), 90, (1, 0, 0))
    solid = fuse(angle, move(gusset, 0, 13, 0), move(gusset, 0, -13, 0))
    return cut(solid, rod((33, 11, -1), (33, 11, 9), 3), rod((33, -11, -1), (33, -11, 9), 3))


def damaged(rng, share):
    """A bracket with a piece broken off one side."""
    piece = move(rotate(box((30 * share, 18 * share, 60)), 20 * rng.uniform(.8, 1.2)), 38, 18)
    return Shape().add(cut(bracket(), piece)).plane((0, 1, 0))


def damaged_flange(rng):
    """A six-hole flange with a slanting piece broken off: partial planes, the best of them through the damage."""
    body = cut(lathe(lines((8, 0), (30, 0), (30, 6), (16, 6), (14, 14), (8, 14), (8, 0))),
               *[rotate(rod((23, 0, -1), (23, 0, 8), 3), 60 * k) for k in range(6)])
    return Shape().add(cut(body, rotate(box((10, 60, 40), (28 * rng.uniform(.99, 1.01), 0, 0)), 15))).fold(6).plane((math.cos(math.radians(105)), math.sin(math.radians(105)), 0))


def engraved(rng, depth, width):
    """A block with a slanting groove on its lid; at a small depth it is within every tolerance."""
    solid = box((40, 28, 16 * rng.uniform(.95, 1.05)))
    high = bounds(solid)[1][2]
    groove = move(rotate(box((14, width, 2 * depth)), 33), 7, 5, high)
    return Shape().add(cut(solid, groove)).box()


def one_side_hole(rng):
    """A plate with one hole off its middle lines: a plane between its lids, and two that miss the hole alone."""
    return Shape().add(cut(box((50, 30, 5)), rod((13, 7 * rng.uniform(.9, 1.1), -9), (13, 7, 9), 2.5))).box()


def keyed_shaft(rng):
    """A stepped shaft with a keyway: one plane through the key."""
    shaft = lathe(lines((0, -30), (6, -30), (6, -5), (9, -5), (9, 12), (5, 12), (5, 30), (0, 30)))
    return Shape().add(cut(shaft, box((10, 3 * rng.uniform(.9, 1.1), 10), (11, 0, 4)))).plane((0, 1, 0))


def marked_shaft(rng):
    """A shaft with a keyway so small that turning it hardly matters: still one plane."""
    return Shape(axis=None).add(cut(rod((0, 0, -30), (0, 0, 30), 8), box((2, 1.5 * rng.uniform(.9, 1.1), 5), (8, 0, 20)))).plane((0, 1, 0))


def drilled_ball(rng):
    """A ball with a small blind hole beside its middle and a smaller one: the plane of both."""
    return Shape().add(cut(ball((0, 0, 0), 10), rod((0, 0, 7), (0, 0, 12), .8 * rng.uniform(.9, 1.1)), rod((8, 0, 0), (12, 0, 3), .5))).plane((0, 1, 0))


# ---- sheets ------------------------------------------------------------------------------------------------


def flat_sheet(rng, n=5):
    return Shape(sheet=True).add(face_of(polyline(regular(n, 15)))).fold(n).plane((0, 0, 1))


def tray(rng):
    """A box without its lid, of sheets."""
    a, b, c = 15, 10 * rng.uniform(.9, 1.1), 6
    base = [(-a, -b, 0), (a, -b, 0), (a, b, 0), (-a, b, 0)]
    walls = [[p, q, (*q[:2], c), (*p[:2], c)] for p, q in zip(base, base[1:] + base[:1])]
    return Shape(sheet=True).add(joined([face_of(polyline(w)) for w in [base] + walls])).box(z=False)


def gutter(rng):
    """Half a cylinder of sheet."""
    solid = rod((0, 0, -15), (0, 0, 15), 10 * rng.uniform(.9, 1.1))
    half = cut(solid, box((40, 40, 40), (-20, 0, 0)))
    bent = max(faces_of(half), key=lambda f: np.subtract(*bounds(f)).prod() ** 2)
    return Shape(sheet=True).add(bent).box(x=False)


def saddle(rng):
    """A hyperbolic paraboloid: two planes across its diagonals."""
    h = 5 * rng.uniform(.8, 1.2)
    net = np.array([[(-10, -10, h), (-10, 10, -h)], [(10, -10, -h), (10, 10, h)]], float)
    return Shape(sheet=True).add(surface_face(net, None, 1, [0, 0, 1, 1], 1, [0, 0, 1, 1])).plane((1, 1, 0)).plane((1, -1, 0))


# ---- assemblies --------------------------------------------------------------------------------------------


def table(rng):
    leg = rod((0, 0, -20), (0, 0, 0), 1.2, 1.8)
    places = [shift(x, y) for x in (-16, 16) for y in (-9, 9)]
    return Shape().add(box((40, 24 * rng.uniform(.95, 1.05), 2), (0, 0, 1))).add(leg, *places).box(z=False)


def bearing(rng, balls=9):
    """Balls between two rings."""
    inner, outer = lathe(lines((8, -4), (12, -4), (12, 4), (8, 4), (8, -4))), lathe(lines((18, -4), (22, -4), (22, 4), (18, 4), (18, -4)))
    shape = Shape().add(inner).add(outer)
    return shape.add(ball((15, 0, 0), 2.8 * rng.uniform(.9, 1.1)), *[turn(360 * k / balls) for k in range(balls)]).fold(balls).plane((0, 0, 1))


def pair(rng):
    """A chiral part and its mirror image, held by a bar."""
    part = cut(box((10, 8, 12), (0, 14, 0)), box((6, 5, 7), (5, 17, 6)), rod((-2, 9, 2), (-2, 20, 2), 1.5))
    shape = Shape().add(box((8, 20 * rng.uniform(.99, 1.0), 3))).add(part).add(mirror(part))
    return shape.plane((0, 1, 0))


def carousel(rng, n=5):
    """Chiral parts about an axis: rotations only."""
    part = rotate(fuse(box((9, 4, 6), (15, 0, 0)), box((3, 9 * rng.uniform(.9, 1.1), 3), (17, 4, 3))), 25, (1, 0, 0))
    return Shape().add(rod((0, 0, -3), (0, 0, 3), 8)).add(part, *[turn(360 * k / n) for k in range(n)])


ENTRIES = [
    ("pillow-restated", pillow, {}), ("pillow-swapped", pillow, {"knots": 0, "reverse": False, "degree": 0}),
    ("pillow-knots", pillow, {"knots": 6, "swap": False}), ("saddle-pair", saddle_pair, {}), ("half-spline", half_spline, {}),
    ("half-spline-turned", half_spline_turned, {}), ("halves-touching", halves_touching, {}), ("filleted-halves", filleted_halves, {}),
    ("split-block", split_block, {}), ("seams-on-one-side", seams_and_none, {}), ("damaged-little", damaged, {"share": .5}),
    ("damaged-much", damaged, {"share": .9}), ("damaged-flange", damaged_flange, {}),
    ("engraved-unseen", engraved, {"depth": .02, "width": 2}), ("engraved-shallow", engraved, {"depth": .6, "width": 3}),
    ("engraved-deep", engraved, {"depth": 3.0, "width": 4}), ("one-side-hole", one_side_hole, {}), ("keyed-shaft", keyed_shaft, {}), ("marked-shaft", marked_shaft, {}),
    ("drilled-ball", drilled_ball, {}),
    ("sheet-pentagon", flat_sheet, {}), ("sheet-tray", tray, {}), ("sheet-gutter", gutter, {}), ("sheet-saddle", saddle, {}),
    ("table", table, {}), ("bearing-9", bearing, {}), ("pair-of-hands", pair, {}), ("carousel-5", carousel, {}),
]
