"""Bodies of few or no corners: of revolution, closed free-form faces, springs, knots, balls."""

import math

import numpy as np
from shape import Shape, regular
from OCP import collections as occ
from OCP.BRep import BRep_Builder
from OCP.BRepBuilderAPI import BRepBuilderAPI_GTransform, BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakeSolid
from OCP.BRepLib import BRepLib
from OCP.BRepOffsetAPI import BRepOffsetAPI_ThruSections
from OCP.BRepPrimAPI import BRepPrimAPI_MakeCylinder
from OCP.Geom import Geom_BSplineSurface
from OCP.gp import gp_Ax2, gp_GTrsf, gp_Mat, gp_XYZ
from OCP.TopoDS import TopoDS_Shell
from shapes.kernel import (ball, box, circle_wire, cut, direction, fuse, lathe, lines, oriented, pnt, polyline, ring,
                           rod, rotate, spline_edge, sweep, turn, wire_of)
from shapes.surfaces import array1
from shapes.variants import as_splines, without_seams

Z, O = (0, 0, 1), (0, 0, 0)


def cylinder(rng, height=30, change=None):
    solid = rod((0, 0, -height / 2), (0, 0, height / 2), 10 * rng.uniform(.9, 1.1))
    return Shape(axis=(O, Z)).add(change(solid) if change else solid).plane(Z)


def cone(rng, top=0.0):
    return Shape(axis=(O, Z)).add(rod(O, (0, 0, 20), 12 * rng.uniform(.9, 1.1), top))


def sphere(rng, change=None):
    solid = ball(O, 10 * rng.uniform(.9, 1.1))
    return Shape(centre=O).add(change(solid) if change else solid)


def torus(rng, change=None):
    solid = ring(O, Z, 14, 4 * rng.uniform(.8, 1.2))
    return Shape(axis=(O, Z)).add(change(solid) if change else solid).plane(Z)


def tube(rng):
    return Shape(axis=(O, Z)).add(cut(rod((0, 0, -12), (0, 0, 12), 9), rod((0, 0, -13), (0, 0, 13), 6 * rng.uniform(.9, 1.1)))).plane(Z)


def capsule(rng):
    h = 10 * rng.uniform(.8, 1.2)
    return Shape(axis=(O, Z)).add(fuse(rod((0, 0, -h), (0, 0, h), 6), ball((0, 0, h), 6), ball((0, 0, -h), 6))).plane(Z)


def vase(rng):
    profile = [[(6, 0), (11, 8 * rng.uniform(.9, 1.1)), (7, 18), (9, 26)]]
    return Shape(axis=(O, Z)).add(lathe(profile))


def hemisphere(rng):
    return Shape(axis=(O, Z)).add(cut(ball(O, 10), box((30, 30, 30), (0, 0, -15 - rng.uniform(0, .001)))))


def stretched(solid, factors):
    """The solid scaled along the coordinate axes."""
    linear = gp_Mat(factors[0], 0, 0, 0, factors[1], 0, 0, 0, factors[2])
    return oriented(BRepBuilderAPI_GTransform(solid, gp_GTrsf(linear, gp_XYZ(0, 0, 0)), True).Shape())


def ellipsoid(rng):
    return Shape().add(stretched(ball(O, 10), (1, 1.4, 2 * rng.uniform(.9, 1.1)))).box()


def spheroid(rng, along=1.7):
    return Shape(axis=(O, Z)).add(stretched(ball(O, 10), (1, 1, along * rng.uniform(.95, 1.05)))).plane(Z)


def half_cylinder(rng):
    solid = cut(rod((0, 0, -15), (0, 0, 15), 10 * rng.uniform(.9, 1.1)), box((40, 40, 40), (-20, 0, 0)))
    return Shape().add(solid).box(x=False)


def ring_sector(rng, angle=100):
    profile = lines((10, -3), (16, -3), (16, 3), (10, 3 * 1), (10, -3))
    half = math.radians(angle * rng.uniform(.95, 1.05) / 2)
    solid = rotate(lathe(profile, angle=2 * math.degrees(half)), -math.degrees(half))
    return Shape().add(solid).box(x=False)


def elliptic_torus(rng):
    return Shape().add(stretched(ring(O, Z, 14, 4), (1, 1.3 * rng.uniform(.95, 1.05), 1))).box()


def periodic_net(point, rows, columns, closed_u):
    """A body that is one B-spline face, closed in v and (or ending in poles) in u, of control points point(s, t)."""
    net = occ.Array2_gp_Pnt(1, rows, 1, columns)
    for i in range(rows):
        for j in range(columns):
            net.SetValue(i + 1, j + 1, pnt(point(i / rows if closed_u else i / (rows - 1), j / columns)))
    v = array1(occ.Array1_double, list(range(columns + 1))), array1(occ.Array1_int, [1] * (columns + 1))
    if closed_u:
        u = array1(occ.Array1_double, list(range(rows + 1))), array1(occ.Array1_int, [1] * (rows + 1))
    else:
        u = array1(occ.Array1_double, list(range(rows - 2))), array1(occ.Array1_int, [4] + [1] * (rows - 4) + [4])
    surface = Geom_BSplineSurface(net, u[0], v[0], u[1], v[1], 3, 3, closed_u, True)
    if closed_u:
        surface.SetUNotPeriodic()
    surface.SetVNotPeriodic()
    shell, builder = TopoDS_Shell(), BRep_Builder()
    builder.MakeShell(shell)
    builder.Add(shell, BRepBuilderAPI_MakeFace(surface, 1e-6).Face())
    shell.Closed(True)
    solid = BRepBuilderAPI_MakeSolid(shell).Solid()
    BRepLib.OrientClosedSolid_s(solid)
    return solid


def lobed_ring(rng, n=3):
    """A closed tube of n bulges, one B-spline face closed in u and v: the bulges are where the control net repeats."""
    rows, columns = 4 * n, 8
    depth = .3 * rng.uniform(.8, 1.2)

    def point(s, t):
        a, b = 2 * math.pi * s, 2 * math.pi * t
        r = 5 * (1 + depth * math.cos(n * a))
        return ((16 + r * math.cos(b)) * math.cos(a), (16 + r * math.cos(b)) * math.sin(a), r * math.sin(b))
    return Shape().add(periodic_net(point, rows, columns, True)).fold(n).plane(Z)


def pebble(rng, n=2, lean=0.0):
    """A body that is one B-spline face closed in v with poles at its ends, of n bulges; a lean makes it an egg."""
    columns = max(8, 4 * n)
    depth = .25 * rng.uniform(.8, 1.2)

    def point(s, t):
        z = 14 * (2 * s - 1)
        r = 9 * math.sin(math.pi * s) ** .6 * (1 + lean * (2 * s - 1)) if 0 < s < 1 else 0.0
        a = 2 * math.pi * t
        r *= 1 + depth * math.cos(n * a)
        return (r * math.cos(a), r * math.sin(a), z)
    shape = Shape().add(periodic_net(point, 9, columns, False)).fold(n)
    return shape if lean else shape.plane(Z)


def tube_along(points, radius, sides=8, closed=True):
    """A round tube along a closed curve as one periodic B-spline face; the frame is carried along without twist."""
    points = np.asarray(points, float)
    tangents = np.roll(points, -1, axis=0) - np.roll(points, 1, axis=0)
    tangents /= np.linalg.norm(tangents, axis=1)[:, None]
    normals = [np.cross(tangents[0], np.eye(3)[np.argmin(abs(tangents[0]))])]
    for t in tangents[1:]:
        normals.append(normals[-1] - t * (normals[-1] @ t))
    normals = [n / np.linalg.norm(n) for n in normals]
    last = normals[-1] - tangents[0] * (normals[-1] @ tangents[0])
    twist = math.atan2(np.cross(normals[0], last) @ tangents[0], normals[0] @ last)
    rows = len(points)

    def point(s, t):
        i = round(s * rows) % rows
        a = 2 * math.pi * t - twist * i / rows
        across = np.cross(tangents[i], normals[i])
        return points[i] + radius * 1.1 * (math.cos(a) * normals[i] + math.sin(a) * across)
    return periodic_net(point, rows, sides, closed)


def curve(function, count):
    return [function(2 * math.pi * k / count) for k in range(count)]


def trefoil(rng):
    """A torus knot: rotations only."""
    r = 6 * rng.uniform(.9, 1.1)
    return Shape(loose=True).add(tube_along(curve(lambda a: ((14 + r * math.cos(3 * a)) * math.cos(2 * a), (14 + r * math.cos(3 * a)) * math.sin(2 * a), r * math.sin(3 * a)), 48), 2.2))


def figure_eight_knot(rng):
    f = rng.uniform(.95, 1.05)
    return Shape(loose=True).add(tube_along(curve(lambda a: (8 * (2 + math.cos(2 * a)) * math.cos(3 * a), 8 * (2 + math.cos(2 * a)) * math.sin(3 * a), 8 * f * math.sin(4 * a)), 64), 2))


def tennis_seam(rng):
    """A tube along the seam of a tennis ball: two planes."""
    b = .45 * rng.uniform(.9, 1.1)
    seam = lambda a: (10 * (math.cos(a) + b * math.cos(3 * a)), 10 * (math.sin(a) - b * math.sin(3 * a)), 10 * math.sqrt(b) * 2 * math.sin(2 * a))
    return Shape(loose=True).add(tube_along(curve(seam, 48), 2, 8)).plane((1, 1, 0)).plane((1, -1, 0))


def spring(rng, turns=3):
    """A wire along a helix: one half turn, no plane."""
    h = 6 * rng.uniform(.9, 1.1)
    points = [(12 * math.cos(a), 12 * math.sin(a), h * a / (2 * math.pi)) for a in np.linspace(0, 2 * math.pi * turns, 16 * turns + 1)]
    path = wire_of(spline_edge(points))
    start = np.array([0, 12, h / (2 * math.pi)])
    return Shape().add(sweep(path, circle_wire(points[0], start / np.linalg.norm(start), 2)))


def propeller(rng, blades=3):
    """Leaning blades on a hub: rotations only."""
    lean = 28 * rng.uniform(.9, 1.1)
    solid = rod((0, 0, -5), (0, 0, 5), 6)
    for k in range(blades):
        blade = rotate(box((20, 8, 1.6), (14, 0, 0)), lean, (1, 0, 0))
        solid = fuse(solid, rotate(blade, 360 * k / blades))
    return Shape().add(solid)


def helical_gear(rng, teeth=9):
    made = BRepOffsetAPI_ThruSections(True, True, 1e-6)
    lean = rng.uniform(.6, .9) * 180 / teeth
    for z, angle in ((-6, 0), (0, lean), (6, 2 * lean)):
        made.AddWire(polyline([p for k in range(teeth) for p in (regular(teeth, 20, angle, z)[k], regular(teeth, 15, angle + 180 / teeth, z)[k])]))
    made.Build()
    return Shape().add(oriented(made.Shape()))


def flange(rng, holes):
    r = 30 * rng.uniform(.95, 1.05)
    body = lathe(lines((8, 0), (r, 0), (r, 5), (14, 5), (12, 16), (8, 16), (8, 0)))
    drills = [rotate(rod((r * .75, 0, -1), (r * .75, 0, 8), min(3, 1.6 * r / holes)), 360 * k / holes) for k in range(holes)]
    return Shape().add(cut(body, *drills)).fold(holes)


def bent_wire(rng):
    """A round bar bent to a U: two planes, no face with corners."""
    r = 10 * rng.uniform(.9, 1.1)
    bend = rotate(lathe([[(r + 2, 0), (r + math.sqrt(2), math.sqrt(2)), (r, 2), (r - math.sqrt(2), math.sqrt(2)), (r - 2, 0)],
                         [(r - 2, 0), (r - math.sqrt(2), -math.sqrt(2)), (r, -2), (r + math.sqrt(2), -math.sqrt(2)), (r + 2, 0)]], angle=180), 0)
    legs = [rod((x, 0.0, 0), (x, -20, 0), 2) for x in (r, -r)]
    return Shape().add(bend).add(legs[0]).add(legs[1]).box(y=False)


def crossed_rods(rng):
    """Two rods at a right angle, one above the other."""
    solid = fuse(rod((-20, 0, 2), (20, 0, 2), 3), rod((0, -14 * rng.uniform(.9, 1.1), -2), (0, 14, -2), 3))
    return Shape().add(solid).plane((1, 0, 0))


def seam_turned(rng):
    """Two bosses on a plate whose seams lie at different places, one of them in two faces."""
    def boss(x, angle):
        frame = gp_Ax2(pnt((x, 0, 2)), direction(Z), direction((math.cos(angle), math.sin(angle), 0)))
        return BRepPrimAPI_MakeCylinder(frame, 4.0, 12.0).Shape()
    plate = box((40, 16 * rng.uniform(.9, 1.1), 4))
    left, right = boss(-12, rng.uniform(0, 6)), without_seams(boss(12, rng.uniform(0, 6)))
    return Shape().add(plate).add(left).add(right).box(z=False)


def ball_row(rng):
    """Balls of three sizes in a row, touching: a body of revolution of spheres alone."""
    return Shape(axis=(O, Z)).add(ball(O, 8)).add(ball((0, 0, 13), 5)).add(ball((0, 0, 20 + rng.uniform(0, .5)), 2))


def ball_triangle(rng, n=3):
    """Equal balls at the corners of a polygon."""
    return Shape().add(ball((12, 0, 0), 4 * rng.uniform(.8, 1.2)), *[turn(360 * k / n) for k in range(n)]).fold(n).plane(Z)


def ball_tripod(rng):
    """Three unlike balls: the plane of their centres alone."""
    return Shape().add(ball(O, 5)).add(ball((16, 0, 0), 3.5 * rng.uniform(.9, 1.1))).add(ball((5, 13, 0), 2.5)).plane(Z)


def spherical_segment(rng):
    """A sphere cut by two planes at an angle: the plane across both cuts, and the one between them."""
    lean = math.radians(35 * rng.uniform(.9, 1.1))
    solid = ball(O, 10)
    for sign in (1, -1):
        n = np.array([math.sin(lean) * sign, 0, math.cos(lean)])
        solid = cut(solid, rotate(box((40, 40, 40), (0, 0, 26)), math.degrees(math.atan2(n[0], n[2])), (0, 1, 0)))
    return Shape().add(solid).box(z=False)


ENTRIES = [
    ("cylinder", cylinder, {}), ("disc", cylinder, {"height": 1.0}), ("cylinder-halves", cylinder, {"change": without_seams}),
    ("cylinder-spline", cylinder, {"change": as_splines}), ("cone", cone, {}), ("frustum", cone, {"top": 6.0}), ("sphere", sphere, {}),
    ("sphere-spline", sphere, {"change": as_splines}), ("torus", torus, {}), ("torus-spline", torus, {"change": as_splines}),
    ("tube", tube, {}), ("capsule", capsule, {}), ("vase", vase, {}), ("hemisphere", hemisphere, {}), ("ellipsoid", ellipsoid, {}),
    ("spheroid", spheroid, {}), ("half-cylinder", half_cylinder, {}), ("ring-sector", ring_sector, {}),
    ("elliptic-torus", elliptic_torus, {}), ("lobed-ring-3", lobed_ring, {}), ("lobed-ring-2", lobed_ring, {"n": 2}),
    ("pebble-2", pebble, {}), ("pebble-3", pebble, {"n": 3}), ("egg-2", pebble, {"lean": .3}), ("trefoil-knot", trefoil, {}),
    ("figure-eight-knot", figure_eight_knot, {}), ("tennis-seam", tennis_seam, {}), ("spring", spring, {}), ("propeller-3", propeller, {}),
    ("propeller-4", propeller, {"blades": 4}), ("helical-gear", helical_gear, {}), ("flange-3", flange, {"holes": 3}),
    ("flange-8", flange, {"holes": 8}), ("flange-24", flange, {"holes": 24}), ("bent-wire", bent_wire, {}), ("crossed-rods", crossed_rods, {}),
    ("seams-apart", seam_turned, {}), ("ball-row", ball_row, {}), ("ball-triangle", ball_triangle, {}), ("ball-tripod", ball_tripod, {}),
    ("spherical-segment", spherical_segment, {}),
]
