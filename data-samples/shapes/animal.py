"""Animals: skins over spines and legs. Lengths in mm; x points to the head, z up."""

import math

from .kernel import ball, box, cut, move, rotate, slab
from .model import Model
from .surfaces import ellipsoid, fuselage, limb


def fish(rng, shark=False):
    """A spindle with a tail fin, a back fin and a pair of breast fins."""
    l, tall, wide = 90 * rng.uniform(0.93, 1.07), 30 * rng.uniform(0.9, 1.1), 13 * rng.uniform(0.9, 1.1)
    if shark:
        l, tall, wide = l * 1.35, tall * 0.62, wide * 1.15
    model = Model().plane()
    model.add(
        "body",
        fuselage([(-l, wide * 0.12, tall * 0.2, 2), (-l * 0.75, wide * 0.25, tall * 0.24, 2),
                  (-l * 0.3, wide * 0.75, tall * 0.7, 1), (l * 0.15, wide, tall, 0), (l * 0.6, wide * 0.8, tall * 0.72, -1),
                  (l * 0.88, wide * 0.42, tall * 0.32, -3), (l, 0, 0, -4)]))
    fork = [(-l * 0.9, 0), (-l * 1.35, tall * 1.05), (-l * 1.22, 2), (-l * 1.3, -tall * (0.6 if shark else 1.0)),
            (-l * 0.9, -3)]
    model.add("tail fin", slab(fork, 2, "xz"))
    if shark:
        model.add("back fin", slab([(l * 0.3, tall * 0.8), (-l * 0.05, tall * 2.2), (-l * 0.02, tall * 0.8)], 2.4,
                                   "xz")).add("small fin", slab([(-l * 0.55, 4), (-l * 0.7, 16), (-l * 0.7, 4)], 1.6, "xz"))
        model.add_pair("breast fin",
                       slab([(l * 0.42, 6), (l * 0.02, l * 0.5), (-l * 0.02, l * 0.48), (l * 0.18, 6)], 2, at=-tall * 0.4))
    else:
        model.add(
            "back fin",
            slab([(l * 0.4, tall * 0.75), (l * 0.1, tall * 1.5), (-l * 0.4, tall * 1.25), (-l * 0.55, tall * 0.4)], 1.6, "xz"))
        model.add("belly fin", slab([(-l * 0.1, -tall * 0.75), (-l * 0.3, -tall * 1.35), (-l * 0.5, -tall * 0.35)], 1.6, "xz"))
        fin = rotate(slab([(l * 0.42, 0), (l * 0.1, 22), (l * 0.05, 14), (l * 0.2, 0)], 1.4), 40, (1, 0, 0))
        model.add_pair("breast fin", move(fin, 0, wide * 0.7, -tall * 0.3))
    eye = ball((l * 0.76, wide * (0.52 if shark else 0.55), tall * 0.12), 3)
    return model.add_pair("eye", eye)


def bird(rng):
    """A bird in flight: a drop-shaped body, swept wings, a fan tail, a beak."""
    l, span = 52 * rng.uniform(0.93, 1.07), 120 * rng.uniform(0.9, 1.1)
    model = Model().plane()
    model.add(
        "body",
        limb([(-l, 0, 2), (-l * 0.6, 0, 0), (0, 0, -2), (l * 0.55, 0, 2), (l * 0.85, 0, 8), (l * 1.12, 0, 12),
              (l * 1.35, 0, 11)], [2, 8, 14, 11, 7.5, 8, 0]))
    model.add("beak", limb([(l * 1.25, 0, 11), (l * 1.42, 0, 10.5), (l * 1.62, 0, 8)], [4, 2.6, 0]))
    wing = limb([(l * 0.1, 6, 4), (l * 0.3, span * 0.3, 16), (l * 0.12, span * 0.62, 22), (-l * 0.5, span, 18)],
                [20, 20, 14, 0], side=(1, 0, 0), flat=0.12)
    model.add_pair("wing", wing)
    model.add(
        "tail",
        slab([(-l * 0.8, 6), (-l * 1.75, 17), (-l * 1.9, 6), (-l * 1.8, 0), (-l * 1.9, -6), (-l * 1.75, -17), (-l * 0.8, -6)],
             2, at=2))
    return model.add_pair("foot", limb([(-l * 0.3, 5, -10), (-l * 0.8, 5, -14), (-l * 1.1, 5, -12)], [2, 1.5, 0]))


def quadruped(rng, l=55, leg=48, girth=17, neck=30, lean=35, head=15, thick=5.5, trunk=False, ears=8, snout=1.0, tail_up=-0.4,
              wag=0.0):
    """Four legs under a barrel, a neck and a head; `wag` bends the tail to one side (then it is only partly symmetric)."""
    l, leg, girth, neck = (v * rng.uniform(0.93, 1.07) for v in (l, leg, girth, neck))
    model = Model().plane(label="partial" if wag else "exact")
    model.add(
        "body",
        fuselage([(-l * 1.05, 0, 0, leg + girth * 0.9), (-l * 0.92, girth * 0.62, girth * 0.75, leg + girth * 0.9),
                  (-l * 0.4, girth * 0.92, girth * 0.95, leg + girth), (l * 0.3, girth * 0.95, girth * 1.05, leg + girth),
                  (l * 0.85, girth * 0.6, girth * 0.8, leg + girth * 1.15), (l * 1.05, 0, 0, leg + girth * 1.3)]))
    rise = math.radians(90 - lean)
    base = (l * 0.72, leg + girth * 1.3)
    top = (base[0] + neck * math.cos(rise), base[1] + neck * math.sin(rise))
    model.add(
        "neck",
        limb([(base[0] - 8, 0, base[1] - 8), (base[0] + (top[0] - base[0]) * 0.4, 0, base[1] + (top[1] - base[1]) * 0.45),
              (top[0], 0, top[1])], [girth * 0.72, girth * 0.45 + 1, head * 0.5]))
    hx, hz = top
    model.add(
        "head",
        limb([(hx - head * 0.8, 0, hz + head * 0.1), (hx - head * 0.4, 0, hz + head * 0.2), (hx + head * 0.4, 0, hz),
              (hx + head * (0.7 + 0.6 * snout), 0, hz - head * 0.35), (hx + head * (0.9 + 0.9 * snout), 0, hz - head * 0.5)],
             [0, head * 0.55, head * 0.55, head * 0.34, head * 0.22]))
    side = girth * 0.5
    for name, x, back in (("front leg", l * 0.66, 0), ("hind leg", -l * 0.74, 1)):
        made = limb([(x, side, leg + girth), (x - 2 - 4 * back, side, leg * 0.55), (x - 3 * back, side, leg * 0.12),
                     (x + 1, side, 0)], [thick * 1.45, thick * 1.1, thick * 0.9, thick * 1.1])
        model.add_pair(name, made)
    model.add(
        "tail",
        limb([(-l * 0.95, 0, leg + girth * 1.3), (-l * 1.25, wag * 6, leg + girth * (1.3 + tail_up * 0.5)),
              (-l * 1.5, wag * 22, leg + girth * (1.3 + tail_up * 1.6)),
              (-l * 1.62, wag * 34, leg + girth * (1.2 + tail_up * 2.4))], [3, 2.6, 2.2, 0]))
    if trunk:
        model.add(
            "trunk",
            limb([(hx + head * 0.9, 0, hz - head * 0.1), (hx + head * 1.5, 0, hz - head * 0.7),
                  (hx + head * 1.75, 0, hz - head * 1.7), (hx + head * 2.0, 0, hz - head * 2.5)],
                 [head * 0.32, head * 0.26, head * 0.19, head * 0.13]))
        model.add_pair(
            "tusk",
            limb([(hx + head * 0.8, head * 0.35, hz - head * 0.4), (hx + head * 1.4, head * 0.5, hz - head * 0.8),
                  (hx + head * 1.9, head * 0.45, hz - head * 0.6)], [2.4, 1.8, 0]))
        ear = ellipsoid((0, 0, 0), (ears * 0.8, 2, ears))
        model.add_pair("ear", move(rotate(ear, 35, (0, 0, 1)), hx - head * 0.5, head * 0.8, hz - 1))
    else:
        model.add_pair(
            "ear",
            limb([(hx - head * 0.3, head * 0.35, hz + head * 0.4), (hx - head * 0.4, head * 0.45, hz + head * 0.4 + ears * 0.6),
                  (hx - head * 0.45, head * 0.5, hz + head * 0.4 + ears)], [2.6, 2, 0]))
    return model


def turtle(rng):
    """A domed shell, four flippers, a head and a short tail."""
    l, w, h = 60 * rng.uniform(0.93, 1.07), 48 * rng.uniform(0.93, 1.07), 30 * rng.uniform(0.85, 1.15)
    dome = cut(ellipsoid((0, 0, 0), (l, w, h)), box((300, 300, 100), (0, 0, -54)))
    model = Model().plane().add("shell", dome).add("belly", ellipsoid((0, 0, -3), (l * 0.92, w * 0.9, 7)))
    model.add("head",
              limb([(l * 0.7, 0, -1), (l * 1.0, 0, 3), (l * 1.2, 0, 7), (l * 1.45, 0, 8), (l * 1.56, 0, 7)], [6, 6.5, 8, 7, 0]))
    model.add_pair(
        "flipper",
        limb([(l * 0.5, w * 0.6, -3), (l * 0.75, w * 1.1, -6), (l * 0.55, w * 1.55, -9), (l * 0.2, w * 1.8, -10)],
             [9, 11, 8, 0], side=(1, 0, 0.0), flat=0.35))
    model.add_pair(
        "hind flipper",
        limb([(-l * 0.6, w * 0.55, -3), (-l * 0.9, w * 0.85, -7), (-l * 1.15, w * 0.95, -9)], [9, 9, 0], side=(1, 1, 0),
             flat=0.35))
    model.add_pair("eye", ball((l * 1.36, 5.6, 10.5), 1.6))
    return model.add("tail", limb([(-l * 0.9, 0, -3), (-l * 1.1, 0, -4), (-l * 1.25, 0, -6)], [4, 2.5, 0]))


def snail(rng):
    """A foot with two pairs of feelers under a shell wound as a rising spiral: no mirror plane."""
    size, turns = 1.0 * rng.uniform(0.92, 1.08), 2.6
    steps = 27
    points, radii = [], []
    for k in range(steps + 1):
        angle = 2 * math.pi * turns * k / steps - 0.4
        grow = 3 + 21 * (k / steps)**1.4
        points.append((size * (-8 + grow * 1.05 * math.cos(angle)), size * (16 - 28 * (k / steps)) * 0.9,
                       size * (36 + grow * 1.05 * math.sin(angle))))
        radii.append(size * (1.6 + 12.5 * (k / steps)**1.25))
    model = Model()
    model.add("shell", limb(points, radii, side=(0, 1, 0)))
    model.add(
        "foot",
        limb([(-75, 0, 3), (-45, 0, 5), (0, 0, 7), (36, 0, 8), (54, 0, 16), (64, 0, 27), (72, 0, 30)], [1, 8, 12, 11, 9, 8, 0]))
    for side in (1, -1):
        model.add("feeler", limb([(64, side * 4, 30), (72, side * 8, 44), (78, side * 10, 54)],
                                 [1.8, 1.4, 1.1])).add("eye", ball((78, side * 10, 55), 2.2))
        model.add("lip", limb([(70, side * 3, 27), (78, side * 5, 24), (84, side * 7, 25)], [1.5, 1.1, 0]))
    return model


def snake(rng):
    """A winding tapered body with a raised head: no mirror plane."""
    wave, coil = rng.uniform(24, 32), rng.uniform(0.9, 1.1)
    points, radii = [], []
    for k in range(19):
        t = k / 18
        lift = 5 if t < 0.72 else 5 + 130 * (t - 0.72)**1.3
        points.append((-130 + 250 * t, wave * coil * math.sin(2 * math.pi * 2.2 * t + 0.4) * (1 - 0.35 * t), lift))
        radii.append(7.5 * math.sin(math.pi * min(0.5, 0.06 + t * 0.8)) if t < 0.9 else 7)
    end = points[-1]
    model = Model().add("body", limb(points, [0] + radii[1:], side=(0, 0.3, 1)))
    model.add(
        "head",
        limb([(end[0] - 6, end[1], end[2]), (end[0] + 4, end[1] + 1, end[2] + 2), (end[0] + 14, end[1] + 2, end[2] + 2),
              (end[0] + 26, end[1] + 3, end[2] - 1)], [6, 9.5, 9, 0], flat=0.7))
    return model.add(
        "tongue",
        slab([(end[0] + 22, end[1] + 2.4), (end[0] + 36, end[1] + 2), (end[0] + 22, end[1] + 3.4), (end[0] + 36, end[1] + 6),
              (end[0] + 22, end[1] + 4)][:3], 1, at=end[2] - 1))


ENTRIES = [
    ("fish", fish, {}, {"structure": "compound"}),
    ("shark", fish, dict(shark=True), {"structure": "solid"}),
    ("bird", bird, {}, {}),
    ("dog-with-tail-aside", quadruped, dict(wag=1.0, tail_up=0.6, ears=11, leg=42, l=50), {"structure": "assembly"}),
    ("giraffe", quadruped, dict(l=48, leg=92, girth=19, neck=110, lean=22, head=15, thick=4.6, ears=9), {}),
    ("elephant", quadruped,
     dict(l=72, leg=52, girth=38, neck=26, lean=50, head=31, thick=11, trunk=True, ears=30, snout=0.1,
          tail_up=-0.8), {"structure": "compound"}),
    ("turtle", turtle, {}, {}),
    ("snail", snail, {}, {"structure": "compound"}),
    ("snake", snake, {}, {}),
]
