"""Families of a second set, made to test on shapes that the method was not made with."""

import itertools
import math

import numpy as np
from shape import Shape, extruded, halved, hull, joined, regular
from flat import cubic
from mixed import patch, restated
from shapes.kernel import (ball, box, circle_wire, cut, face_of, fillet, fuse, lathe, lines, loft, mirror, move, polyline, ring, rod,
                           rotate, sewn, shift, slab, spline_edge, sweep, turn, wire_of)
from shapes.measure import bounds
from shapes.surfaces import fuselage
from shapes.variants import as_splines, without_seams
from turned import curve, periodic_net, tube_along

Z, O = (0, 0, 1), (0, 0, 0)


def hex_nut(rng):
    solid = cut(extruded(regular(6, 18 * rng.uniform(.9, 1.1)), 12), rod((0, 0, -9), (0, 0, 9), 8))
    return Shape().add(solid).fold(6).plane(Z)


def spanner(rng):
    """An open spanner with a slanting jaw: the plane of its sheet alone."""
    solid = fuse(box((60, 9, 5)), rod((-32, 0, -2.5), (-32, 0, 2.5), 12), rod((32, 0, -2.5), (32, 0, 2.5), 10))
    jaw = move(rotate(box((18, 9 * rng.uniform(.9, 1.1), 20)), 15), -42, 0, 0)
    return Shape().add(cut(solid, jaw, rod((32, 0, -9), (32, 0, 9), 5))).plane(Z)


def cross(rng, arms=4):
    arm = box((24, 6 * rng.uniform(.9, 1.1), 5), (12, 0, 0))
    solid = fuse(rod((0, 0, -2.5), (0, 0, 2.5), 8), *[rotate(arm, 360 * k / arms) for k in range(arms)])
    return Shape().add(solid).fold(arms).plane(Z)


def ratchet(rng, teeth=24):
    """Saw teeth: no plane through the axis."""
    points = [p for k in range(teeth) for p in (regular(teeth, 24, 0)[k], regular(teeth, 20 * rng.uniform(.999, 1.001), 3)[k])]
    return Shape().add(cut(extruded(points, 7), rod((0, 0, -9), (0, 0, 9), 5))).plane(Z)


def spline_shaft(rng, keys=6):
    solid = rod((0, 0, -25), (0, 0, 25), 9)
    for k in range(keys):
        solid = fuse(solid, rotate(box((6, 4 * rng.uniform(.999, 1.001), 50), (9, 0, 0)), 360 * k / keys))
    return Shape().add(solid).fold(keys).plane(Z)


def gusset_plate(rng):
    return Shape().add(slab([(0, -15), (30, -4), (30, 4), (0, 15)], 4 * rng.uniform(.9, 1.1))).plane((0, 1, 0)).plane(Z)


def pipe_elbow(rng):
    """A quarter bend with a flange at each end, the same: two planes."""
    r = 20 * rng.uniform(.9, 1.1)
    bend = rotate(lathe([[(r + 5, 0), (r + 5 / math.sqrt(2), 5 / math.sqrt(2)), (r, 5), (r - 5 / math.sqrt(2), 5 / math.sqrt(2)), (r - 5, 0)],
                         [(r - 5, 0), (r - 5 / math.sqrt(2), -5 / math.sqrt(2)), (r, -5), (r + 5 / math.sqrt(2), -5 / math.sqrt(2)), (r + 5, 0)]], angle=90), 0)
    return Shape().add(bend).add(rod((r, -4, 0), (r, 0, 0), 9)).add(rod((-4, r, 0), (0, r, 0), 9)).plane((1, -1, 0)).plane(Z)


def tee(rng):
    d = 6 * rng.uniform(.9, 1.1)
    return Shape().add(fuse(rod((-25, 0, 0), (25, 0, 0), d), rod((0, 0, 0), (0, 0, 22), d))).box(z=False)


def tee_unequal(rng):
    d = 6 * rng.uniform(.9, 1.1)
    return Shape().add(fuse(rod((-25, 0, 0), (17, 0, 0), d), rod((0, 0, 0), (0, 0, 22), d * .7))).plane((0, 1, 0))


def dumbbell(rng):
    return Shape(axis=(O, Z)).add(fuse(rod((0, 0, -20), (0, 0, 20), 3), ball((0, 0, 20), 8 * rng.uniform(.9, 1.1)), ball((0, 0, -20), 6)))


def double_cone(rng):
    r = 9 * rng.uniform(.9, 1.1)
    return Shape(axis=(O, Z)).add(lathe(lines((0, -15), (r, 0), (0, 15)))).plane(Z)


def paraboloid(rng):
    return Shape(axis=(O, Z)).add(as_splines(lathe([[(10 * rng.uniform(.9, 1.1), 15), (7, 7.35), (4, 2.4), (0, 0)]])))


def superquadric(rng):
    """A rounded brick that is one face closed in v."""
    e = .5 * rng.uniform(.9, 1.1)
    power = lambda x, k: math.copysign(abs(x) ** k, x)

    def point(s, t):
        a, b = math.pi * (s - .5), 2 * math.pi * t
        r = power(math.cos(a), e) if 0 < s < 1 else 0.0
        return (12 * r * power(math.cos(b), e), 8 * r * power(math.sin(b), e), 15 * power(math.sin(a), e))
    return Shape(loose=True).add(periodic_net(point, 13, 24, False)).box()


def bean(rng):
    """A bent body that is one face: one plane along, one across the bend."""
    bend = .05 * rng.uniform(.8, 1.2)

    def point(s, t):
        z = 16 * (2 * s - 1)
        r = 7 * math.sin(math.pi * s) ** .5 if 0 < s < 1 else 0.0
        return (r * math.cos(2 * math.pi * t) + bend * z * z, .8 * r * math.sin(2 * math.pi * t), z)
    return Shape(loose=True).add(periodic_net(point, 11, 12, False)).plane((0, 1, 0)).plane(Z)


def sea_shell(rng):
    """A body that is one face, twisted: nothing."""
    twist = 2.2 * rng.uniform(.9, 1.1)

    def point(s, t):
        r = 9 * math.sin(math.pi * s) ** .6 * (1 + .4 * s) if 0 < s < 1 else 0.0
        a = 2 * math.pi * t
        r *= 1 + .3 * math.cos(3 * a)
        return (r * math.cos(a + twist * s), r * math.sin(a + twist * s), 30 * s)
    return Shape(loose=True).add(periodic_net(point, 13, 12, False))


def cinquefoil(rng):
    f = 5 * rng.uniform(.9, 1.1)
    knot = lambda a: ((14 + f * math.cos(5 * a)) * math.cos(2 * a), (14 + f * math.cos(5 * a)) * math.sin(2 * a), f * math.sin(5 * a))
    return Shape(loose=True).add(tube_along(curve(knot, 80), 1.5))


def wavy_ring(rng, waves=3):
    """A tube along a crown: planes through the axis, none across it."""
    h = 4 * rng.uniform(.8, 1.2)
    return Shape(loose=True).add(tube_along(curve(lambda a: (15 * math.cos(a), 15 * math.sin(a), h * math.cos(waves * a)), 16 * waves), 2)).fold(waves)


def worm(rng):
    """A left-handed spring with straight ends."""
    points = [(10 * math.cos(a), -10 * math.sin(a), 5 * a / (2 * math.pi)) for a in np.linspace(0, 9 * math.pi, 70)]
    return Shape().add(sweep(wire_of(spline_edge(points)), circle_wire(points[0], (0, -10, 5 / (2 * math.pi)), 1.6 * rng.uniform(.9, 1.1))))


def fan(rng, blades=5):
    """Blades lofted with a twist between two rings."""
    solids = []
    for k in range(blades):
        section = lambda x, angle: polyline([(x, *(math.cos(math.radians(angle)) * y - math.sin(math.radians(angle)) * z, math.sin(math.radians(angle)) * y + math.cos(math.radians(angle)) * z))
                                             for y, z in ((-4, -.6), (4, -.6), (4, .6), (-4, .6))])
        solids.append(rotate(loft([section(5, 45), section(22, 20 * rng.uniform(.999, 1.001))]), 360 * k / blades))
    return Shape().add(fuse(rod((0, 0, -6), (0, 0, 6), 7), *solids))


def chair_seat(rng):
    """A free-form seat on four legs, of solids."""
    seat = fillet(box((36, 34, 4)), 1.5)
    back = slab([(-15, 2), (15, 2), (12, 30 * rng.uniform(.9, 1.1)), (-12, 30)], 3, "yz", at=-16)
    shape = Shape().add(seat).add(back)
    return shape.add(rod((0, 0, -30), (0, 0, 0), 1.5), *[shift(x, y) for x in (-14, 14) for y in (-13, 13)]).plane((0, 1, 0))


def car(rng):
    body = slab([(-30, 0), (30, 0), (30, 8), (14, 10), (8, 18), (-16, 18), (-30, 9 * rng.uniform(.9, 1.1))], 26, "xz")
    wheel = lathe(lines((2, -2), (6, -2), (6, 2), (2, 2), (2, -2)), axis="y")
    return Shape().add(body).add(wheel, *[shift(x, y) for x in (-18, 18) for y in (-15, 15)]).plane((0, 1, 0))


def plane_body(rng):
    """A fuselage of poles with a wing on both sides and a fin."""
    body = fuselage([(-30, 0, 0, 0), (-20, 4, 4, 0), (0, 5 * rng.uniform(.9, 1.1), 5, 0), (20, 3, 4, 1), (30, 0, 0, 2)])
    wing = slab([(-4, 3), (6, 3), (-2, 34), (-6, 34)], 1.2)
    return Shape().add(body).add(wing).add(mirror(wing)).add(slab([(20, 2), (30, 2), (30, 14), (26, 14)], 1, "xz")).plane((0, 1, 0))


def restated_hull(rng):
    a, b = rng.uniform(2, 4), rng.uniform(.2, .6)
    right = [patch(lambda s, t: 10 * s * (1 - s) * (1 - t ** a) * (1 + b * s)), patch(lambda s, t: -14 * (s * (1 - s)) * (1 - t * t) * (1 + b * t))]
    return Shape().add(sewn(right + [restated(mirror(f), knots=2, degree=2) for f in right], 1e-4)).plane((0, 1, 0))


def split_gear(rng, teeth=10):
    """A gear whose left half is B-spline and cut in pieces."""
    points = [p for k in range(teeth) for p in (regular(teeth, 24, -5)[k], regular(teeth, 24, 5)[k], regular(teeth, 19, 11)[k], regular(teeth, 19, 25)[k])]
    solid = cut(extruded(points, 8 * rng.uniform(.9, 1.1)), rod((0, 0, -9), (0, 0, 9), 6))
    return Shape().add(halved(solid)).fold(teeth).plane(Z)


def split_cylinder(rng):
    """A bored cylinder, its left half in quarters and B-splines."""
    solid = cut(rod((0, 0, -10), (0, 0, 10), 14 * rng.uniform(.9, 1.1)), rod((7, 0, -11), (7, 0, 11), 3))
    return Shape().add(halved(solid, lambda s: as_splines(without_seams(s)))).plane((0, 1, 0)).plane(Z)


def cube_halves(rng):
    solid = cut(box((20, 20, 20)), rod((0, 0, -20), (0, 0, 20), 5 * rng.uniform(.9, 1.1)))
    shape = Shape().fold(4).plane(Z)
    return shape.add(halved(solid))


def cuboctahedron(rng):
    points = [p for a, b in itertools.product((1, -1), repeat=2) for p in ((0, a, b), (a, 0, b), (a, b, 0))]
    return cubic(Shape().add(hull([tuple(10 * c for c in p) for p in points])))


def bipyramid(rng, n=7):
    h = 15 * rng.uniform(.9, 1.1)
    return Shape().add(hull(regular(n, 12) + [(0, 0, h), (0, 0, -h)])).fold(n).plane(Z)


def snub(rng):
    """A cube with a chiral corner on every face: rotations only."""
    corners = []
    for axis in range(3):
        for sign in (1, -1):
            for k in range(4):
                a = math.radians(90 * k + 18)
                p = [0.0, 0.0, 0.0]
                p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3] = sign * 12, 8 * math.cos(sign * a), 8 * math.sin(sign * a)
                corners.append(tuple(p))
    return Shape().add(hull(corners))


def across(angle):
    """The normal of the plane through the z axis whose trace lies at an angle."""
    return -math.sin(math.radians(angle)), math.cos(math.radians(angle)), 0.0


def keyed_disc(rng):
    """A disc with one notch: one plane through it, one across."""
    return Shape().add(cut(rod((0, 0, -2), (0, 0, 2), 20), box((8, 4 * rng.uniform(.9, 1.1), 9), (19, 0, 0)))).plane((0, 1, 0)).plane(Z)


def two_notches(rng):
    """A disc with two notches: the plane between them, and nearly those through one of them."""
    notch = box((8, 4, 9), (19, 0, 0))
    half = 50 * rng.uniform(.9, 1.1)
    return Shape().add(cut(rod((0, 0, -2), (0, 0, 2), 20), rotate(notch, half), rotate(notch, -half)))\
        .plane((0, 1, 0)).plane(Z).plane(across(half)).plane(across(-half))


def unlike_notches(rng):
    """A disc with two unlike notches: between its faces, and nearly those through one of them."""
    return Shape().add(cut(rod((0, 0, -2), (0, 0, 2), 20), box((10, 5, 9), (19, 0, 0)), rotate(box((14, 7 * rng.uniform(.9, 1.1), 9), (19, 0, 0)), 100)))\
        .plane(Z).plane(across(100)).plane(across(0))


def chipped(rng):
    """A chipped tumbler: its plane through the chip, all the others nearly."""
    cup = lathe(lines((0, 0), (10, 0), (12, 24), (10.5, 24), (8.8, 2), (0, 2)))
    return Shape().add(cut(cup, ball((12, 0, 24), 6 * rng.uniform(.9, 1.1)))).plane((0, 1, 0))


def broken_box(rng):
    """A box with a corner broken off on one side of two planes."""
    return Shape().add(cut(box((40, 25, 12 * rng.uniform(.9, 1.1))), rotate(box((12, 12, 40), (20, 20, 0)), 12))).box()


def lettered(rng):
    """A block with an F engraved 0.3 mm deep, in 60."""
    solid = box((60, 40, 20 * rng.uniform(.95, 1.05)))
    top = bounds(solid)[1][2]
    for size, at in (((3, 20, .6), (-6, 0, top)), ((10, 3, .6), (-1, 8.5, top)), ((7, 3, .6), (-2, 1, top))):
        solid = cut(solid, box(size, at))
    return Shape().add(solid).box()


def open_tube(rng):
    """A bent sheet of two free-form patches."""
    a = rng.uniform(.7, 1.4)
    right = patch(lambda s, t: 6 * a * math.cos(3 * s) * (1 - t * t) + 3 * s)
    return Shape(sheet=True).add(joined([right, mirror(right)])).plane((0, 1, 0))


def lone_patch(rng):
    """A free-form sheet without a symmetry."""
    a = rng.uniform(.8, 1.2)
    return Shape(sheet=True).add(patch(lambda s, t: 9 * a * (s ** 2 - .6 * s * t + .8 * t ** 3 * s)))


def folded(rng):
    """Two rectangles of sheet with a common edge: three planes where they are equal."""
    w, h = 20, 12 * rng.uniform(.9, 1.1)
    c, s = math.cos(.6), math.sin(.6)
    left = face_of(polyline([(-w, 0, 0), (w, 0, 0), (w, h * c, h * s), (-w, h * c, h * s)]))
    return Shape(sheet=True).add(joined([left, mirror(left)])).box(z=False)


def mirrored_arms(rng):
    """Chiral arms and their mirror images in turns about an axis: n planes between them."""
    arm = fuse(box((10, 3, 5), (15, 4, 0)), box((3, 5, 3), (18, 7, 2 * rng.uniform(.9, 1.1))))
    shape = Shape().add(rod((0, 0, -4), (0, 0, 4), 12)).fold(3)
    return shape.add(arm, *[turn(120 * k) for k in range(3)]).add(mirror(arm), *[turn(120 * k) for k in range(3)])


def chain(rng):
    """Links of rings at right angles, 4 of them in line."""
    shape = Shape()
    d = 17 * rng.uniform(.98, 1.02)
    for k in range(4):
        link = ring((d * (k - 1.5), 0, 0), (0, 0, 1) if k % 2 else (0, 1, 0), 10, 2)
        shape.add(link)
    return shape.plane((0, 1, 0)).plane(Z)


def pin_header(rng):
    shape = Shape().add(box((40, 5, 2.5)))
    return shape.add(box((.64, .64, 11), (0, 0, 2 * rng.uniform(.9, 1.1))), *[shift(2.54 * (k - 7.0)) for k in range(15)]).box(z=False)


ENTRIES = [(name.replace("_", "-"), family, {}) for name, family in (
    ("hex_nut", hex_nut), ("spanner", spanner), ("cross", cross), ("ratchet", ratchet), ("spline_shaft", spline_shaft),
    ("gusset_plate", gusset_plate), ("pipe_elbow", pipe_elbow), ("tee", tee), ("tee_unequal", tee_unequal), ("dumbbell", dumbbell),
    ("double_cone", double_cone), ("paraboloid", paraboloid), ("superquadric", superquadric), ("bean", bean), ("sea_shell", sea_shell),
    ("cinquefoil", cinquefoil), ("wavy_ring", wavy_ring), ("worm", worm), ("fan", fan), ("chair_seat", chair_seat), ("car", car),
    ("plane_body", plane_body), ("restated_hull", restated_hull), ("split_gear", split_gear), ("split_cylinder", split_cylinder),
    ("cube_halves", cube_halves), ("cuboctahedron", cuboctahedron), ("bipyramid", bipyramid), ("snub", snub), ("keyed_disc", keyed_disc),
    ("two_notches", two_notches), ("unlike_notches", unlike_notches), ("chipped", chipped), ("broken_box", broken_box),
    ("lettered", lettered), ("open_tube", open_tube), ("lone_patch", lone_patch), ("folded", folded), ("mirrored_arms", mirrored_arms),
    ("chain", chain), ("pin_header", pin_header))]
