"""Machine components. Lengths in mm; the main axis of turned parts is z."""

import math

from OCP.BRepAlgoAPI import BRepAlgoAPI_Common
from OCP.BRepPrimAPI import BRepPrimAPI_MakeTorus
from OCP.gp import gp_Ax2, gp_Trsf

from .kernel import apply, ball, boolean, box, cut, direction, fillet, fuse, lathe, lines, move, pnt, rod, slab, turn
from .model import Model
from .surfaces import limb, skin


def around(shape, n, phase=0.0):
    """n copies of a shape about the z axis."""
    return [apply(shape, turn(phase + 360 * k / n)) for k in range(n)]


def gear(rng, teeth=18, keyway=False):
    """A spur gear with a hub and holes in its web; a keyway leaves only one plane through the axis."""
    r, b = 60 * rng.uniform(0.95, 1.05), 12 * rng.uniform(0.9, 1.1)
    outline, step = [], 2 * math.pi / teeth
    for k in range(teeth):
        for radius, at in ((r * 0.88, -0.36), (r * 0.95, -0.2), (r * 1.05, -0.1), (r * 1.05, 0.1), (r * 0.95, 0.2), (r * 0.88,
                                                                                                                     0.36)):
            outline.append((radius * math.cos((k + at) * step), radius * math.sin((k + at) * step)))
    made = cut(slab(outline, 2 * b), rod((0, 0, -50), (0, 0, 50), r * 0.2))
    groove = lathe(lines((r * 0.4, b * 0.5), (r * 0.72, b * 0.5), (r * 0.72, b * 2), (r * 0.4, b * 2), (r * 0.4, b * 0.5)))
    made = cut(made, groove, apply(groove, turn(180, (1, 0, 0))))
    model = Model().plane((0, 0, 1))
    if keyway:
        made = cut(made, box((r * 0.5, r * 0.12, 4 * b), (r * 0.15, 0, 0)))
        return model.add("gear", made).plane()
    return model.add("gear", made).fold(teeth)


def flange(rng, holes=6):
    """A welding-neck flange with bolt holes."""
    r, neck = 70 * rng.uniform(0.94, 1.06), 46 * rng.uniform(0.85, 1.2)
    body = lathe([[(22, 0), (r, 0)], [(r, 0), (r, 16)], [(r, 16), (46, 16)], [(46, 16), (40, 20), (36, 30), (32, 40)],
                  [(32, 40), (30, neck + 14)], [(30, neck + 14), (22, neck + 14)], [(22, neck + 14), (22, 0)]])
    drill = rod((r * 0.82, 0, -10), (r * 0.82, 0, 40), 6)
    return Model().add("flange", cut(body, *around(drill, holes))).fold(holes)


def bracket(rng):
    """An angle with two gussets, two slots below and two holes in its wall."""
    l, h, w = 100 * rng.uniform(0.93, 1.07), 80 * rng.uniform(0.9, 1.1), 90 * rng.uniform(0.93, 1.07)
    angle = slab([(0, 0), (l, 0), (l, 10), (10, 10), (10, h), (0, h)], w, "xz")
    angle = fillet(angle, 8, lambda m: abs(m[0] - 10) < 1e-6 and abs(m[2] - 10) < 1e-6)
    gusset = slab([(9, 9), (l * 0.72, 9), (9, h * 0.8)], 8, "xz")
    made = fuse(angle, move(gusset, 0, w * 0.3, 0), move(gusset, 0, -w * 0.3, 0))
    slot = fuse(box((20, 9, 40), (l * 0.8, 0, 0)), rod((l * 0.8 - 10, 0, -20), (l * 0.8 - 10, 0, 20), 4.5),
                rod((l * 0.8 + 10, 0, -20), (l * 0.8 + 10, 0, 20), 4.5))
    holes = [move(slot, 0, side * w * 0.42 - side * 4, 0)
             for side in (1, -1)] + [rod((-5, y, h * 0.7), (20, y, h * 0.7), 6) for y in (w * 0.15, -w * 0.15)]
    return Model().plane().add("bracket", cut(made, *holes))


def crankshaft(rng, throws=4):
    """Journals, webs with counterweights and pins in one plane (0, 180, 180, 0 degrees)."""
    r, off = 16 * rng.uniform(0.93, 1.07), 26 * rng.uniform(0.93, 1.07)
    pitch, web = 62, 12
    side = [(-15, 16), (15, 16), (20, -6), (34, -16), (30, -34), (0, -44), (-30, -34), (-34, -16), (-20, -6)]
    solids, x = [], -pitch * throws / 2
    plate = slab([(u, v + 12) for u, v in side], web, "yz")
    for k in range(throws):
        flip = turn(180 if k in (1, 2) else 0, (1, 0, 0))
        at = x + pitch * (k + 0.5)
        solids += [
            move(apply(plate, flip), at - 17),
            move(apply(plate, flip), at + 17),
            move(apply(rod((-24, 0, off), (24, 0, off), r * 0.8), flip), at)
        ]
    ends = [rod((x + pitch * k - 9, 0, 0), (x + pitch * k + 9, 0, 0), r) for k in range(throws + 1)]
    model = Model().plane()
    for i, solid in enumerate(solids):
        model.add(f"throw {i}", solid)
    for i, solid in enumerate(ends):
        model.add(f"journal {i}", solid)
    return model.add("flange", rod((x - 18, 0, 0), (x - 8, 0, 0), 30)).add("nose", rod((-x + 8, 0, 0), (-x + 44, 0, 0), 11))


def bolt(rng):
    """A hexagon bolt with a washer face and a chamfered shank (the thread is not modelled)."""
    r, l = 10 * rng.uniform(0.93, 1.07), 80 * rng.uniform(0.85, 1.25)
    head = slab([(1.9 * r * math.cos(math.pi * k / 3), 1.9 * r * math.sin(math.pi * k / 3)) for k in range(6)], r * 1.3,
                at=r * 0.65)
    cone = lathe(lines((0, -1), (1.95 * r, -1), (1.95 * r, r * 1.0), (1.55 * r, r * 1.31), (0, r * 1.31)))
    head = boolean(BRepAlgoAPI_Common(), [head], [cone])
    shank = lathe(lines((0, 1), (r, 1), (r, -l * 0.4), (r * 0.88, -l * 0.4 - 2), (r * 0.88, -l + 2), (r * 0.7, -l), (0, -l)))
    return Model().add("bolt", fuse(head, shank)).fold(6)


def bearing(rng, balls=9):
    """A ball bearing: two grooved rings and the balls."""
    r, w = 50 * rng.uniform(0.95, 1.05), 11
    b = r * 0.15

    def race(inner, outer, groove):
        half = math.sqrt((b * 1.03)**2 - (groove - r * 0.74)**2)
        arc = [(groove, -half), (r * 0.74 + math.copysign(b * 1.03, groove - r * 0.74), 0), (groove, half)]
        far = inner if groove == outer else outer
        return lathe(
            lines((far, w), (far, -w), (groove, -w), (groove, -half)) + [arc] + lines((groove, half), (groove, w), (far, w)))

    model = Model().plane((0, 0, 1)).fold(balls)
    model.add("inner ring", race(r * 0.48, r * 0.66, r * 0.66)).add("outer ring", race(r * 0.82, r, r * 0.82))
    return model.add("ball", ball((r * 0.74, 0, 0), b), *[turn(360 * k / balls) for k in range(balls)])


def pulley(rng, spokes=5):
    """A grooved wheel with spokes and a hub."""
    r, w = 70 * rng.uniform(0.94, 1.06), 13
    rim = lathe(
        lines((r * 0.8, -w), (r, -w), (r, -w * 0.75), (r * 0.88, -w * 0.2), (r * 0.88, w * 0.2), (r, w * 0.75), (r, w),
              (r * 0.8, w), (r * 0.8, -w)))
    hub = lathe(lines((9, -w * 1.5), (20, -w * 1.5), (20, w * 1.5), (9, w * 1.5), (9, -w * 1.5)))
    spoke = slab([(17, 8), (r * 0.84, 5), (r * 0.84, -5), (17, -8)], 9)
    return Model().add("pulley", fuse(rim, hub, *around(spoke, spokes))).plane((0, 0, 1)).fold(spokes)


def elbow(rng):
    """A bent pipe with a flange at both ends; symmetric between its ends as well."""
    r, bend = 24 * rng.uniform(0.93, 1.07), 80 * rng.uniform(0.9, 1.1)
    frame = gp_Ax2(pnt((0, 0, 0)), direction((0, 1, 0)), direction((0, 0, 1)))
    outer, inner = (BRepPrimAPI_MakeTorus(frame, bend, radius, math.pi / 2).Shape() for radius in (r, r * 0.8))
    plate = cut(
        rod((0, 0, bend), (-10, 0, bend), r * 1.9), rod((5, 0, bend), (-15, 0, bend), r * 0.8), *[
            apply(rod((5, r * 1.5, bend), (-15, r * 1.5, bend), 5), turn(45 + 90 * k, (1, 0, 0), (0, 0, bend)))
            for k in range(4)
        ])
    other = apply(plate, mirror_xz())
    body = cut(outer, inner)
    return Model().plane().plane((1, 0, -1)).add("bend", body).add("flange front", plate).add("flange below", other)


def mirror_xz():
    """The mirror that swaps x and z."""
    trsf = gp_Trsf()
    trsf.SetMirror(gp_Ax2(pnt((0, 0, 0)), direction((1, 0, -1))))
    return trsf


def propeller(rng, blades=3):
    """A ship's propeller: twisted blades on a hub, chiral, without any mirror plane."""
    r, pitch = 75 * rng.uniform(0.94, 1.06), rng.uniform(0.9, 1.1)
    sections = []
    for share, chord, angle in ((0.12, 13, 62), (0.35, 24, 48), (0.6, 31, 36), (0.82, 27, 28), (0.96, 13, 24), (1.0, 0, 22)):
        a = math.radians(angle * pitch)
        sections.append(((share * r, 0.12 * share * r, 0), (0, chord * math.cos(a), chord * math.sin(a)),
                         (0, -3.2 * math.sin(a) * (chord > 0), 3.2 * math.cos(a) * (chord > 0))))
    model = Model().add("blade", skin(sections), *[turn(360 * k / blades) for k in range(blades)])
    return model.add(
        "hub", cut(lathe([[(19, -24), (20, -5), (18, 14), (12, 28)], [(12, 28), (0, 30)]]), rod((0, 0, -40), (0, 0, 10), 7)))


def connecting_rod(rng):
    """A rod with an I section between a big and a small eye, and two bolts."""
    l, big = 140 * rng.uniform(0.93, 1.07), 30 * rng.uniform(0.94, 1.06)
    shank = slab([(big * 0.6, 14), (l, 9), (l, -9), (big * 0.6, -14)], 16)
    pocket = slab([(big * 1.35, 7), (l - 22, 4.5), (l - 22, -4.5), (big * 1.35, -7)], 10)
    body = fuse(rod((0, 0, -12), (0, 0, 12), big), rod((l, 0, -10), (l, 0, 10), 17), shank,
                box((22, 2 * big + 14, 20), (0, 0, 0)))
    body = cut(body, rod((0, 0, -30), (0, 0, 30), big * 0.72), rod((l, 0, -30), (l, 0, 30), 10), move(pocket, 0, 0, 10),
               move(pocket, 0, 0, -10))
    model = Model().plane().plane((0, 0, 1)).add("rod", body)
    return model.add_pair("bolt", fuse(rod((-17, big + 2, 0), (14, big + 2, 0), 4), rod((11, big + 2, 0), (17, big + 2, 0),
                                                                                        6.5)))


def pillow_block(rng):
    """A bearing housing on a foot with two slots."""
    w, r = 80 * rng.uniform(0.93, 1.07), 30 * rng.uniform(0.94, 1.06)
    foot = fillet(box((40, 2 * w, 16), (0, 0, 8)), 6, lambda m: abs(abs(m[1]) - w) < 1e-6 and abs(abs(m[0]) - 20) < 1e-6)
    made = fuse(foot, rod((-18, 0, 44), (18, 0, 44), r), slab([(-r * 1.25, 10), (r * 1.25, 10), (r, 44), (-r, 44)], 30, "yz"))
    slots = [box((11, 22, 60), (0, side * w * 0.75, 0)) for side in (1, -1)]
    made = cut(made, rod((-40, 0, 44), (40, 0, 44), r * 0.62), *slots)
    model = Model().plane().plane((1, 0, 0)).add("housing", made)
    return model.add("insert", cut(rod((-22, 0, 44), (22, 0, 44), r * 0.62), rod((-40, 0, 44), (40, 0, 44), r * 0.4)))


def spring(rng, coils=4.5):
    """A helical compression spring: no mirror plane."""
    r, pitch = 30 * rng.uniform(0.93, 1.07), 15 * rng.uniform(0.9, 1.15)
    count = int(coils * 10)
    points = [(r * math.cos(0.2 * math.pi * k), r * math.sin(0.2 * math.pi * k), pitch * k / 10) for k in range(count + 1)]
    return Model().add("wire", limb(points, [4.2] * len(points), side=(0, 0, 1)))


ENTRIES = [
    ("spur-gear", gear, {}, {"structure": "solid"}),
    ("gear-with-keyway", gear, dict(teeth=24, keyway=True), {"structure": "solid", "split": False}),
    ("flange", flange, {}, {"structure": "solid"}),
    ("bracket", bracket, {}, {"structure": "solid"}),
    ("crankshaft", crankshaft, {}, {"structure": "solid"}),
    ("hexagon-bolt", bolt, {}, {"structure": "solid"}),
    ("ball-bearing", bearing, {}, {"structure": "assembly"}),
    ("spoked-pulley", pulley, {}, {"structure": "solid"}),
    ("pipe-elbow", elbow, {}, {}),
    ("ship-propeller", propeller, {}, {"structure": "assembly"}),
    ("connecting-rod", connecting_rod, {}, {}),
    ("pillow-block", pillow_block, {}, {"structure": "compound", "split": True}),
    ("spring", spring, {}, {}),
]
