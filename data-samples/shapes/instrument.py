"""Musical instruments: the violin and guitar families, wind, drums, a grand piano. Lengths in mm (scaled down)."""

from .kernel import (box, circle_wire, curved_slab, cut, fillet, lathe, lines, move, ring, rod, rotate, shift, slab,
                     spline_edge, sweep, turn, wire_of)
from .model import Model
from .surfaces import limb


def waisted(half, thickness):
    """A plate whose outline is the spline of its left half, (x, y) from the tail to the neck, and its mirror image."""
    (x0, _), (x1, _) = half[0], half[-1]
    left = [(x0, 0.0), (x0 + 0.15, half[1][1] * 0.45)] + half[1:-1] + [(x1, 0.0)]
    return curved_slab([left, [(x, -y) for x, y in reversed(left)]], thickness)


def strings(model, count, spread, tail, top, r=0.35):
    """Parallel strings between two (x, z) points."""
    string = rod((tail[0], 0, tail[1]), (top[0], 0, top[1]), r)
    return model.add("string", string, *[shift(0, (k - (count - 1) / 2) * spread, 0) for k in range(count)])


def pegs(model, count, x, z, step, width):
    """Tuning pegs on both sides of a head, `count` in all, evenly and symmetrically."""
    peg = rod((0, -3, 0), (0, 3, 0), 1.0)
    knob = rod((0, 2, 0), (0, 5, 0), 2.2)
    rows = range(count // 2)
    model.add("peg", peg, *[shift(x + step * k, side * (width / 2 + 1), z) for k in rows for side in (1, -1)])
    for k in rows:
        model.add_pair("knob", move(knob, x + step * k, width / 2 + 1, z))
    return model


def violin(rng, scale=1.0, spike=False, chin_rest=False):
    """A waisted body with C bouts, bridge, fingerboard, four strings and a scroll; x points to the scroll."""
    wide, waist = rng.uniform(0.93, 1.07), rng.uniform(0.92, 1.06)
    half = [(0, 0), (4, 18 * wide), (20, 31 * wide), (42, 31 * wide), (58, 23 * wide), (72, 17.5 * waist), (88, 18.5 * waist),
            (100, 23 * wide), (114, 25 * wide), (130, 18 * wide), (137, 0)]
    rib = 11 * (1.6 if spike else 1.0)
    body = fillet(waisted(half, rib), 2)
    hole = slab([(58, 9), (61, 11), (70, 12.5), (78, 10), (78, 9), (70, 11), (62, 9)], 60, smooth=True)
    body = cut(
        body, cut(hole, box((200, 100, 200), (0, 0, -100 + rib * 0.2))),
        cut(slab([(x, -y) for x, y in [(58, 9), (61, 11), (70, 12.5), (78, 10), (78, 9), (70, 11), (62, 9)]], 60, smooth=True),
            box((200, 100, 200), (0, 0, -100 + rib * 0.2))))
    top = rib / 2
    model = Model().plane(label="partial" if chin_rest else "exact").add("body", body)
    model.add("neck",
              limb([(128, 0, top - 2), (150, 0, top + 0.5), (196, 0, top + 2.5), (206, 0, top + 2)], [4.5, 3.6, 3.2, 3.4]))
    model.add("fingerboard", slab([(84, 5.5), (84, -5.5), (200, -3.4), (200, 3.4)], 2.2, at=top + 5.2))
    model.add("bridge", slab([(-10, top - 0.5), (10, top - 0.5), (7, top + 9), (0, top + 10.5), (-7, top + 9)], 2, "yz", at=67))
    model.add("tailpiece", slab([(8, 3), (8, -3), (44, -6), (44, 6)], 2,
                                at=top + 6)).add("button", rod((-4, 0, 0), (3, 0, 0), 2))
    strings(model, 4, 2.6, (42, top + 7.5), (202, top + 7.2))
    model.add("scroll", ring((220, 0, top - 1), (0, 1, 0),
                             4.4, 2.6)).add("head",
                                            limb([(200, 0, top + 2), (212, 0, top + 2.5), (222, 0, top + 3.2)], [3.2, 3, 2.4]))
    peg = rod((0, -8, 0), (0, 8, 0), 1.1)
    model.add("peg", peg, *[shift(205 + 3.6 * k, 0, top + 2.2) for k in range(4)])
    if spike:
        model.add("spike", rod((-52, 0, 0), (2, 0, 0), 1.2, 1.8))
    if chin_rest:
        model.add("chin rest",
                  fillet(slab([(1, 6), (4, 20), (14, 29), (26, 26), (24, 10), (8, 4)], 4, at=top + 5, smooth=True),
                         1)).add("clamp", box((8, 3, 6), (2, 12, top + 2)))
    return model


def guitar(rng, cutaway=False):
    """A waisted body with a sound hole, a long neck and six pegs; with a cutaway the symmetry is partial."""
    wide = rng.uniform(0.94, 1.06)
    half = [(0, 0), (3, 22 * wide), (22, 38 * wide), (48, 37 * wide), (70, 27 * wide), (84, 25 * wide), (100, 29 * wide),
            (118, 28 * wide), (131, 14 * wide), (134, 0)]
    body = waisted(half, 20)
    hole = rod((84, 0, 5), (84, 0, 40), 10)
    body = cut(body, hole, rod((128, -34, -40), (128, -34, 40), 24)) if cutaway else cut(body, hole)
    model = Model().plane(label="partial" if cutaway else "exact").add("body", body)
    model.add("neck", slab([(128, 5.5), (128, -5.5), (262, -4.5), (262, 4.5)], 6,
                           at=8)).add("fingerboard", slab([(97, 6), (97, -6), (262, -4.8), (262, 4.8)], 2, at=12))
    model.add("head", slab([(260, 4.5), (266, 9), (304, 8), (306, 0), (304, -8), (266, -9), (260, -4.5)], 4, at=8))
    model.add("bridge", box((8, 40, 3), (36, 0, 11))).add("nut", box((2, 9, 2), (261, 0, 13)))
    strings(model, 6, 1.5, (36, 14), (264, 14))
    return pegs(model, 6, 274, 8, 11, 17)


def banjo(rng):
    """A round drum body with a rim of hooks, a long neck and pegs."""
    r = 48 * rng.uniform(0.94, 1.06)
    model = Model().plane()
    model.add("rim", lathe(lines((r - 4, -9), (r, -9), (r, 9), (r - 4, 9),
                                 (r - 4, -9)))).add("skin", rod((0, 0, 7), (0, 0, 8.5), r - 3))
    model.add("hoop", ring((0, 0, 9), (0, 0, 1), r, 1.8))
    hook = rod((r + 1.2, 0, -6), (r + 1.2, 0, 9), 1)
    model.add("hook", hook, *[turn(15 + 30 * k) for k in range(12)])
    model.add("neck",
              slab([(r - 2, 6), (r - 2, -6), (190, -4.5), (190, 4.5)], 6,
                   at=6)).add("head",
                              slab([(188, 4.5), (194, 9), (222, 8), (226, 0), (222, -8), (194, -9), (188, -4.5)], 4, at=6))
    model.add("bridge", box((3, 22, 7), (-14, 0, 11)))
    strings(model, 4, 2.4, (-r + 2, 13), (192, 13))
    return pegs(model, 4, 200, 6, 13, 17)


def trumpet(rng):
    """A long loop of tube with a bell, three valves in line and a mouthpiece; the loop is to one side."""
    r, w = 3.2, 20 * rng.uniform(0.92, 1.08)
    l = 115 * rng.uniform(0.95, 1.05)
    bell = lathe([[(22, l + 42), (12, l + 34), (7, l + 18), (r + 1, l - 10),
                   (r, l - 40)], [(r, l - 40),
                                  (r - 1, l - 40)], [(r - 1, l - 40), (r, l - 10), (6, l + 18), (11, l + 34),
                                                     (21, l + 42.6)], [(21, l + 42.6), (22, l + 42)]], axis="x", at=(0, 0, 0))
    model = Model().plane(label="partial").add("bell", bell)
    loop = wire_of(
        spline_edge([(l - 38, 0, 0), (0, 0, 0), (-l * 0.5, 0, 0), (-l * 0.68, 1, -5), (-l * 0.76, 2, -w / 2),
                     (-l * 0.68, 3, -w + 5), (-l * 0.5, 4, -w), (0, 4, -w), (l * 0.4, 4, -w)]))
    model.add("tube", sweep(loop, circle_wire((l - 38, 0, 0), (1, 0, 0), r)))
    back = wire_of(
        spline_edge([(l * 0.4, 4, -w), (l * 0.58, 3, -w + 4), (l * 0.64, -2, -w / 2), (l * 0.58, -6, -4), (l * 0.4, -7, -1),
                     (0, -7, 0), (-l, -7, 0)]))
    model.add("lead pipe", sweep(back, circle_wire((l * 0.4, 4, -w), (1, 0, 0), r * 0.9)))
    model.add("mouthpiece",
              lathe([[(2, -l + 2), (2.4, -l - 14), (6, -l - 24)], [(6, -l - 24), (7, -l - 27)]], axis="x", at=(0, -7, 0)))
    valve = lathe(
        lines((0, -36), (6, -36), (6, -34), (7, -34), (7, 12), (6, 12), (6, 14), (2, 14), (2, 22), (5, 22), (5, 24), (0, 24)))
    model.add("valve", valve, *[shift(x, -1.5, -w / 2 + 8) for x in (-17, 0, 17)])
    return model


def flute(rng, recorder=False):
    """A long tube with tone holes and key cups in a row on top."""
    l, r = 280 * rng.uniform(0.95, 1.05), 8 * rng.uniform(0.93, 1.07)
    tube = lathe(
        lines((r * 0.75, 0), (r, 0), (r, l * 0.28), (r * 1.15, l * 0.28), (r * 1.15, l * 0.33), (r, l * 0.33), (r, l),
              (r * 0.75, l), (r * 0.75, 0)), axis="x")
    spots = [l * (0.4 + 0.075 * k) for k in range(7)]
    body = cut(tube, *[rod((x, 0, 0), (x, 0, 3 * r), r * 0.35) for x in spots + [l * 0.12]])
    model = Model().plane().add("tube", body).add("cork", rod((0, 0, 0), (l * 0.04, 0, 0),
                                                              r * 0.75)).add("crown",
                                                                             fillet(rod((-6, 0, 0), (0, 0, 0), r * 1.05), 1.5))
    model.add(
        "lip plate",
        fillet(
            cut(box((26, 22, 5), (l * 0.12, 0, r)), rod((l * 0.12, 0, 0), (l * 0.12, 0, 3 * r), r * 0.36),
                rod((0, 0, 0), (l, 0, 0), r * 0.9)), 1, lambda m: abs(m[1]) > 9))
    key = lathe(lines((0, 0), (r * 0.6, 0), (r * 0.6, 1.6), (0, 2.6)))
    return model.add("key", key, *[shift(x, 0, r * 1.05) for x in spots[1:]])


def drum(rng):
    """A body of revolution: a shell with two hoops and two heads."""
    r, h = 90 * rng.uniform(0.9, 1.1), 62 * rng.uniform(0.85, 1.2)
    shell = lathe(
        lines((0, -h), (r, -h), (r, -h + 4), (r + 5, -h + 4), (r + 5, -h + 16), (r, -h + 16), (r, h - 16), (r + 5, h - 16),
              (r + 5, h - 4), (r, h - 4), (r, h), (0, h)))
    return built_of_revolution(shell)


def built_of_revolution(shell):
    """A body of revolution about z with the mid-plane z = 0."""
    model = Model(axis=((0, 0, 0), (0, 0, 1))).add("drum", shell)
    return model.plane((0, 0, 1))


def piano(rng):
    """A grand piano: the curved case has no mirror plane."""
    l = 230 * rng.uniform(0.93, 1.07)
    case = curved_slab([[(0, -75), (0, 75)],
                        [(0, 75), (l * 0.45, 75), (l * 0.6, 60), (l * 0.7, 18), (l * 0.85, -8), (l, -28), (l * 1.02, -52),
                         (l * 0.95, -75)], [(l * 0.95, -75), (0, -75)]], 30, at=85)
    well = box((34, 128, 30), (15, 0, 96))
    lid = curved_slab([[(34, -75), (34, 75)],
                       [(34, 75), (l * 0.45, 75), (l * 0.6, 60), (l * 0.7, 18), (l * 0.85, -8), (l, -28), (l * 1.02, -52),
                        (l * 0.95, -75)], [(l * 0.95, -75), (34, -75)]], 3)
    model = Model().add("case", cut(case, well)).add("lid", move(rotate(lid, 32, (1, 0, 0), (0, -75, 0)), 0, 0, 103))
    leg = lathe(lines((0, 0), (4, 0), (5, 6), (4, 10), (7, 60), (8, 72), (0, 72)))
    model.add("leg", leg, shift(18, 64), shift(18, -64), shift(l * 0.88, -45))
    model.add("key", box((24, 3.2, 4), (0, 0, 0)), *[shift(16, -60 + 4 * k, 84) for k in range(31)])
    model.add("lyre", box((8, 18, 66), (30, 0, 40))).add("music desk",
                                                         rotate(box((2, 90, 36), (42, 0, 116)), -15, (0, 1, 0), (42, 0, 100)))
    return model.add("prop", rod((l * 0.4, 60, 98), (l * 0.4, 42, 166), 1.5))


ENTRIES = [
    ("violin", violin, {}, {"structure": "compound"}),
    ("cello", violin, dict(spike=True), {"structure": "assembly"}),
    ("guitar", guitar, {}, {"structure": "assembly"}),
    ("guitar-with-cutaway", guitar, dict(cutaway=True), {}),
    ("drum", drum, {}, {}),
    ("banjo", banjo, {}, {"structure": "assembly"}),
    ("trumpet", trumpet, {}, {"structure": "compound", "pcurves": False, "splines": False}),
    ("flute", flute, {}, {"structure": "solid"}),
    ("grand-piano", piano, {}, {"structure": "assembly"}),
    ("violin-with-chin-rest", violin, dict(chin_rest=True), {}),
]
