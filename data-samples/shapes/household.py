"""Household objects. Lengths in mm; z up, handles along x."""

import math

from .kernel import ball, box, cut, fillet, fuse, lathe, lines, move, ring, rod, rotate, shift, slab, turn
from .model import Model
from .surfaces import ellipsoid, limb


def pot(outer, wall):
    """An open vessel of revolution: the outside (r, z) points from the foot to the rim, and the wall thickness."""
    (r0, z0), (r1, z1) = outer[0], outer[-1]
    inner = [(max(r - wall, 2.0), z) for r, z in reversed(outer[1:-1])]
    base = (r0 * 0.8, z0 + wall)
    inside = [[(r1 - wall, z1)] + inner + [base]]
    return lathe([[(0, z0), (r0, z0)], outer, [(r1, z1), (r1 - wall, z1)]] + inside +
                 [[base, (0, base[1])], [(0, base[1]), (0, z0)]])


def handle(x, low, high, reach, r=4.0):
    """A bent tube beside a vessel, from (x, high) out and back to (x, low)."""
    mid = (low + high) / 2
    return limb([(x - 4, 0, high), (x + reach * 0.5, 0, high + 2), (x + reach, 0, mid + (high - low) * 0.2),
                 (x + reach * 0.8, 0, low + (high - low) * 0.12), (x - 3, 0, low)], [r * 1.2, r, r, r, r * 1.2], side=(0, 1, 0),
                flat=0.7)


def cup(rng, mark=False, saucer=False, straight=False):
    """A cup with a handle; a mark off the plane makes the symmetry partial."""
    r, h = 40 * rng.uniform(0.9, 1.1), (92 if straight else 70) * rng.uniform(0.9, 1.1)
    outer = [(r, 0), (r, h * 0.3), (r, h * 0.7), (r, h)] if straight else [(r * 0.55, 0), (r * 0.8, h * 0.22),
                                                                           (r * 0.96, h * 0.6), (r * 1.06, h)]
    model = Model().plane(label="partial" if mark else "exact").add("cup", pot(outer, 3.5))
    model.add("handle", handle(r * 0.92, h * 0.25, h * 0.8, 26 * rng.uniform(0.8, 1.3)))
    if mark:
        model.add("mark", cut(rod((0, r - 2, h * 0.5), (0, r + 2.5, h * 0.5), 15), rod((0, 0, h * 0.5), (0, 2 * r, h * 0.5),
                                                                                       9)))
        model.add("dot", rod((-r * 0.72, r * 0.6, h * 0.72), (-r * 0.84, r * 0.7, h * 0.72), 6))
    if saucer:
        model.add("saucer", pot([(r * 0.7, -6), (r * 1.2, -3), (r * 1.75, 6)], 3))
    return model


def teapot(rng):
    """A round pot with a spout in front, a handle behind and a lid with a knob."""
    r = 55 * rng.uniform(0.93, 1.07)
    body = lathe([[(0, 0), (r * 0.6, 0)],
                  [(r * 0.6, 0), (r * 0.95, r * 0.35), (r, r * 0.7), (r * 0.75, r * 1.15), (r * 0.42, r * 1.3)],
                  [(r * 0.42, r * 1.3), (0, r * 1.3)]])
    model = Model().plane().add("pot", body)
    model.add(
        "spout",
        limb([(r * 0.7, 0, r * 0.4), (r * 1.2, 0, r * 0.62), (r * 1.5, 0, r * 1.05), (r * 1.78, 0, r * 1.3)], [15, 11, 8, 6.5]))
    model.add(
        "handle",
        limb([(-r * 0.75, 0, r * 1.05), (-r * 1.35, 0, r * 1.2), (-r * 1.7, 0, r * 0.85), (-r * 1.45, 0, r * 0.42),
              (-r * 0.85, 0, r * 0.32)], [6, 5.5, 5.5, 5.5, 6]))
    return model.add(
        "lid",
        lathe([[(0, r * 1.28), (r * 0.46, r * 1.28)], [(r * 0.46, r * 1.28), (r * 0.3, r * 1.42), (4, r * 1.47)],
               [(4, r * 1.47), (5, r * 1.52), (9, r * 1.6), (6, r * 1.7), (0, r * 1.72)]]))


def turned(rng, kind):
    """Bodies of revolution: a bottle, a vase, a wine glass, a bowl."""
    r, h = rng.uniform(0.9, 1.1), rng.uniform(0.93, 1.08)
    if kind == "bottle":
        made = lathe(
            lines((0, 0), (35 * r, 0)) + [[(35 * r, 0), (38 * r, 4)], [(38 * r, 4), (
                38 * r, 130 * h)], [(38 * r, 130 * h), (34 * r, 155 * h), (18, 178 * h), (14, 200 * h), (14, 232 * h)]] +
            lines((14, 232 * h), (16.5, 232 * h), (16.5, 240 * h), (0, 240 * h)))
    elif kind == "vase":
        made = pot([(34 * r, 0), (58 * r, 45 * h), (62 * r, 90 * h), (36 * r, 150 * h), (26 * r, 175 * h), (42 * r, 205 * h)],
                   4)
    elif kind == "glass":
        made = lathe(
            lines((0, 0), (34, 0)) +
            [[(34, 0), (33, 2)], [(33, 2), (14, 5), (4.5, 14), (4, 40),
                                  (4.5, 78 * h)], [(4.5, 78 * h), (26 * r, 92 * h), (37 * r, 118 * h), (31 * r, 160 * h)],
             [(31 * r, 160 * h), (29.6 * r, 160 * h)], [(29.6 * r, 160 * h), (35 * r, 118 * h), (24 * r, 95 * h), (0, 84 * h)]])
    else:
        made = pot([(32 * r, 0), (70 * r, 18 * h), (95 * r, 45 * h), (106 * r, 72 * h)], 5)
    return Model(axis=((0, 0, 0), (0, 0, 1))).add(kind, made)


def pan(rng, lid=False):
    """A flat pan with a long handle, or a pot with two ears and a lid."""
    r, h = 100 * rng.uniform(0.93, 1.07), (90 if lid else 38) * rng.uniform(0.9, 1.1)
    model = Model().plane()
    shell = cut(lathe(lines((0, 0), (r * 0.9, 0), (r, h), (0, h))),
                lathe(lines((0, 4), (r * 0.86, 4), (r * 0.965, h + 1), (0, h + 1))))
    model.add("pan", shell)
    if lid:
        ear = limb([(r * 0.9, 18, h * 0.75), (r * 1.2, 16, h * 0.8), (r * 1.25, 0, h * 0.8), (r * 1.2, -16, h * 0.8),
                    (r * 0.9, -18, h * 0.75)], [5] * 5, side=(0, 0, 1))
        model.plane((1, 0, 0)).add("ear front", ear).add("ear back", rotate(ear, 180))
        model.add(
            "lid",
            lathe([[(0, h), (r * 1.02, h)], [(r * 1.02, h), (r * 1.02, h + 4)],
                   [(r * 1.02, h + 4), (r * 0.6, h + 16), (10, h + 21)],
                   [(10, h + 21), (8, h + 30), (16, h + 38), (12, h + 45), (0, h + 46)]]))
    else:
        model.add(
            "handle",
            limb([(r * 0.93, 0, h * 0.7), (r * 1.3, 0, h * 0.95), (r * 1.9, 0, h * 1.25), (r * 2.6, 0, h * 1.3)], [8, 7, 10, 9],
                 flat=0.6))
        model.add("rivet", ball((0, 0, 0), 3.5), shift(r * 0.9, 7, h * 0.72), shift(r * 0.9, -7, h * 0.72))
    return model


def spoon(rng, ladle=False):
    """An oval bowl at the end of a long flat handle."""
    l, w = 120 * rng.uniform(0.93, 1.07), 20 * rng.uniform(0.92, 1.08)
    if ladle:
        w *= 1.7
    deep = 1.15 if ladle else 0.5
    bowl = cut(ellipsoid((0, 0, 0), (w * (1.0 if ladle else 1.5), w, w * deep)),
               ellipsoid((0, 0, 1.5), (w * (0.93 if ladle else 1.42), w * 0.93, w * deep * 0.93)),
               box((400, 400, 100), (0, 0, 50)))
    model = Model().plane().add("bowl", bowl)
    x, rise = -w * (0.92 if ladle else 1.4), (l * 0.55 if ladle else 14)
    path = [(x, 0, -1.5), (x - l * 0.15, 0, rise * 0.35), (x - l * 0.5, 0, rise * 0.8), (x - l, 0, rise)]
    return model.add("handle", limb(path, [5, 3.4, 5, 8.5], flat=0.32))


def table(rng, round_top=False):
    """A table of four turned legs, or a round one on a central column with three feet."""
    l, w, h = 130 * rng.uniform(0.93, 1.07), 75 * rng.uniform(0.9, 1.1), 72 * rng.uniform(0.93, 1.07)
    model = Model().plane()
    if round_top:
        model.plane((math.sin(math.pi / 3), 0.5, 0)).plane((math.sin(math.pi / 3), -0.5, 0))
        model.add("top",
                  fillet(rod((0, 0, h), (0, 0, h + 5), w),
                         1.5)).add("column",
                                   lathe([[(0, 8), (9, 8)], [(9, 8), (6, 20), (8, 36), (5, 52), (10, h)], [(10, h), (0, h)]]))
        foot = limb([(2, 0, 14), (22, 0, 13), (42, 0, 5), (52, 0, 2)], [6, 5, 4, 3.5])
        return model.add("foot", foot, turn(0), turn(120), turn(240))
    model.plane((1, 0, 0)).add("top", fillet(box((2 * l, 2 * w, 6), (0, 0, h + 3)), 2, lambda m: abs(m[2] - h - 3) > 1))
    leg = lathe([[(0, 0), (4, 0)], [(4, 0), (6, 10), (5, 24), (8, 44), (6, 56)], [(6, 56), (8, 58)], [(8, 58), (8, h)],
                 [(8, h), (0, h)]])
    model.add("leg", leg, *[shift(sx * (l - 14), sy * (w - 14)) for sx in (1, -1) for sy in (1, -1)])
    model.add("rail x", box((2 * l - 28, 4, 12), (0, 0, h - 6)), shift(0, w - 14), shift(0, 14 - w))
    return model.add("rail y", box((4, 2 * w - 28, 12), (0, 0, h - 6)), shift(l - 14), shift(14 - l))


def chair(rng, arms=False):
    """A seat on four legs, a raked back with slats."""
    w, h, back = 44 * rng.uniform(0.93, 1.07), 46 * rng.uniform(0.95, 1.05), 52 * rng.uniform(0.9, 1.15)
    model = Model().plane().add("seat", fillet(box((w, w, 5), (0, 0, h)), 2, lambda m: m[2] > h + 1))
    model.add_pair("front leg", rod((w * 0.42, w * 0.42, h), (w * 0.46, w * 0.44, 0), 2.6, 1.8))
    model.add_pair("back leg", rod((-w * 0.42, w * 0.42, h), (-w * 0.54, w * 0.44, 0), 2.6, 1.8))
    model.add_pair("post", rod((-w * 0.44, w * 0.42, h), (-w * 0.66, w * 0.42, h + back), 2.4, 2.0))
    for share in (0.4, 0.65, 0.92):
        model.add("slat", box((2.4, w * 0.86, 6), (-w * (0.44 + 0.22 * share), 0, h + back * share)))
    model.add("rung", rod((w * 0.44, -w * 0.42, h * 0.35), (w * 0.44, w * 0.42, h * 0.35), 1.4))
    model.add_pair("rung", rod((w * 0.44, w * 0.43, h * 0.45), (-w * 0.49, w * 0.43, h * 0.45), 1.4))
    if arms:
        model.add_pair("arm", box(
            (w * 0.95, 4, 3),
            (-w * 0.06, w * 0.46, h + 20))).add_pair("arm post", rod((w * 0.34, w * 0.45, h), (w * 0.34, w * 0.45, h + 20),
                                                                     1.8))
    return model


def stool(rng):
    """A round seat on three splayed legs with a ring."""
    r, h = 22 * rng.uniform(0.93, 1.07), 58 * rng.uniform(0.9, 1.1)
    model = Model().fold(3).add("seat", fillet(rod((0, 0, h), (0, 0, h + 6), r), 2))
    model.add("leg", rod((r * 0.6, 0, h), (r * 1.15, 0, 0), 2.2, 1.6), *[turn(120 * k) for k in range(3)])
    return model.add("ring", ring((0, 0, h * 0.35), (0, 0, 1), r * 0.95, 1.2))


def lamp(rng, arm=False):
    """A table lamp with a conical shade, or a desk lamp with a bent arm."""
    h, r = 130 * rng.uniform(0.9, 1.1), 50 * rng.uniform(0.9, 1.1)
    if not arm:
        model = Model(axis=((0, 0, 0), (0, 0, 1)))
        model.add(
            "stand",
            lathe([[(0, 0), (34, 0)], [(34, 0), (33, 6), (14, 14), (10, 30), (18, 60), (12, 95), (5, h)], [(5, h), (0, h)]]))
        return model.add(
            "shade", lathe(lines((r, h - 12), (r + 1.5, h - 12), (r * 0.55 + 1.5, h + 55), (r * 0.55, h + 55),
                                 (r, h - 12)))).add("bulb", ball((0, 0, h + 14), 15))
    model = Model().plane().add("base", fillet(rod((0, 0, 0), (0, 0, 8), 42), 3, lambda m: m[2] > 4))
    model.add("lower arm", rod((-4, 0, 6), (-42, 0, h * 0.85), 3)).add("upper arm", rod((-42, 0, h * 0.85), (52, 0, h * 1.3),
                                                                                        3))
    model.add("joint", rod((-42, -7, h * 0.85), (-42, 7, h * 0.85), 6)).add("pivot", rod((52, -7, h * 1.3), (52, 7, h * 1.3),
                                                                                         6))
    shade = lathe([[(10, 18), (14, 6), (30, -16), (38, -30)], [(38, -30), (36.5, -30)],
                   [(36.5, -30), (28.5, -15), (12.5, 6), (8.5, 18)], [(8.5, 18), (10, 18)]])
    model.add("shade", move(rotate(fuse(shade, rod((0, 0, 14), (0, 0, 24), 10)), -25, (0, 1, 0)), 62, 0, h * 1.3 - 18))
    return model.add("bulb", ball((66, 0, h * 1.3 - 30), 11))


def helmet(rng):
    """A hollow half shell with an opening for the face, a visor peak and ridges on top."""
    r = 100 * rng.uniform(0.95, 1.05)
    shell = cut(ellipsoid((0, 0, 0), (r * 1.18, r * 0.92, r)), ellipsoid((0, 0, -3), (r * 1.1, r * 0.84, r * 0.93)),
                box((600, 600, 200), (0, 0, -100 - r * 0.25)), box((2 * r, 400, r), (r * 1.35, 0, -r * 0.4)))
    model = Model().plane().add("shell", shell)
    peak = slab([(r * 0.8, 62), (r * 1.2, 55), (r * 1.5, 30), (r * 1.58, 0), (r * 1.5, -30), (r * 1.2, -55), (r * 0.8, -62),
                 (r * 1.0, 0)], 5, smooth=False)
    model.add("peak", move(rotate(peak, 8, (0, 1, 0)), 0, 0, r * 0.22))
    for y in (0, 26, -26):
        model.add(
            "ridge",
            limb([(-r * 0.8, y, r * 0.72), (-r * 0.3, y, r * 0.97), (r * 0.3, y, r * 0.97), (r * 0.8, y, r * 0.72)],
                 [4, 8, 8, 4], side=(0, 1, 0)))
    return model.add_pair("buckle", fillet(box((30, 6, 40), (r * 0.1, r * 0.9, -r * 0.2)), 2))


def bucket(rng):
    """A conical bucket with a hoop handle over it."""
    r, h = 60 * rng.uniform(0.93, 1.07), 105 * rng.uniform(0.9, 1.1)
    shell = cut(lathe(lines((0, 0), (r * 0.72, 0), (r, h), (0, h))),
                lathe(lines((0, 3), (r * 0.69, 3), (r * 0.965, h + 1), (0, h + 1))))
    model = Model().plane().plane((1, 0, 0)).add("bucket", shell).add("rim", ring((0, 0, h), (0, 0, 1), r, 2.5))
    hoop = [(0, (r + 3) * math.cos(a), h - 8 + (r + 18) * math.sin(a)) for a in (math.pi * k / 8 for k in range(9))]
    model.add("hoop", limb(hoop, [2.2] * 9, side=(1, 0, 0)))
    return model.add_pair("lug", rod((0, r - 3, h - 8), (0, r + 6, h - 8), 5))


ENTRIES = [
    ("teacup-with-saucer", cup, dict(saucer=True), {"structure": "assembly"}),
    ("mug", cup, dict(straight=True), {"structure": "solid"}),
    ("mug-with-mark", cup, dict(mark=True, straight=True), {}),
    ("teapot", teapot, {}, {"structure": "solid"}),
    ("bottle", turned, dict(kind="bottle"), {}),
    ("vase", turned, dict(kind="vase"), {}),
    ("wine-glass", turned, dict(kind="glass"), {}),
    ("frying-pan", pan, {}, {}),
    ("spoon", spoon, {}, {"structure": "solid"}),
    ("table", table, {}, {"structure": "assembly"}),
    ("chair", chair, {}, {"structure": "compound"}),
    ("stool", stool, {}, {"structure": "assembly"}),
    ("desk-lamp", lamp, dict(arm=True), {}),
    ("helmet", helmet, {}, {"pcurves": False, "splines": False}),
    ("bucket", bucket, {}, {}),
    ("table-lamp", lamp, {}, {}),
    ("cooking-pot", pan, dict(lid=True), {}),
    ("bowl", turned, dict(kind="bowl"), {}),
    ("ladle", spoon, dict(ladle=True), {}),
    ("round-table", table, dict(round_top=True), {}),
    ("armchair", chair, dict(arms=True), {}),
]
