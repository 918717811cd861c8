"""Guns as plain outside shapes. Lengths in mm; x points to the muzzle."""

from .kernel import apply, ball, box, cut, fillet, lathe, lines, rod, rotate, shift, slab, turn
from .model import Model
from .surfaces import limb


def trigger(model, x, z, r=13):
    """A round guard with a curved trigger."""
    model.add("guard",
              cut(rod((x, -3, z), (x, 3, z), r), rod((x, -9, z), (x, 9, z), r - 3), box((60, 30, 30), (x, 0, z + r + 9))))
    return model.add("trigger", limb([(x, 0, z + 8), (x - 1, 0, z), (x + 3, 0, z - 7)], [2.4, 2, 1.2]))


def pistol(rng):
    """A slide over a frame with a slanted grip."""
    l, rake = 95 * rng.uniform(0.93, 1.07), 18 * rng.uniform(0.8, 1.2)
    model = Model().plane()
    slide = fillet(box((2 * l, 24, 26), (0, 0, 20)), 3, lambda m: m[2] > 30 and abs(m[1]) > 11)
    grooves = [box((2, 2, 30), (-l + 10 + 5 * k, side * 12, 20)) for k in range(6) for side in (1, -1)]
    model.add("slide", cut(slide, *grooves, rod((l - 30, 0, 20), (l + 1, 0, 20), 5)))
    model.add("frame", slab([(-l * 0.98, 8), (l * 0.9, 8), (l * 0.9, -4), (-l * 0.1, -6), (-l * 0.98, -6)], 21, "xz"))
    grip = slab([(-l * 0.95, -4), (-l * 0.35, -4), (-l * 0.35 - rake, -88), (-l * 0.95 - rake, -88)], 25, "xz")
    model.add("grip", fillet(grip, 5, lambda m: abs(m[1]) > 12 and -80 < m[2] < -8))
    trigger(model, -l * 0.08, -10, 16)
    model.add("front sight", box((5, 3, 5), (l - 8, 0, 35))).add_pair("rear sight", box((5, 5, 6), (-l + 8, 5, 35)))
    return model.add("hammer", slab([(-l, 18), (-l - 10, 26), (-l - 6, 10), (-l, 8)], 8, "xz"))


def revolver(rng, chambers=6):
    """A drum with six chambers between frame and barrel, a curved grip."""
    l, r = 120 * rng.uniform(0.93, 1.07), 22 * rng.uniform(0.93, 1.07)
    model = Model().plane()
    holes = [turn(60 * k, (1, 0, 0), (0, 0, 0)) for k in range(chambers)]
    flute = rod((-6, 0, r * 1.12), (30, 0, r * 1.12), r * 0.28)
    hole = rod((-30, 0, r * 0.62), (30, 0, r * 0.62), r * 0.22)
    cylinder = cut(rod((-22, 0, 0), (22, 0, 0), r), *[apply(hole, t) for t in holes],
                   *[apply(rotate(flute, 30, (1, 0, 0)), t) for t in holes])
    model.add("drum", cylinder)
    frame = slab([(-40, 16), (-34, 30), (34, 30), (40, 22), (40, -22), (20, -32), (-34, -32), (-46, -14)], 15, "xz")
    model.add("frame", cut(frame, box((46, 40, 2 * r + 2), (0, 0, 0))))
    model.add("barrel", cut(rod((36, 0, 15), (36 + l, 0, 15), 9), rod(
        (60, 0, 15), (37 + l, 0, 15), 4.5))).add("rib", box((l, 5, 6),
                                                            (36 + l / 2, 0, 25))).add("ejector",
                                                                                      rod((36, 0, 2), (36 + l * 0.6, 0, 2), 5))
    model.add("front sight", slab([(20 + l, 27), (34 + l, 27), (32 + l, 36)], 3, "xz"))
    model.add("grip",
              limb([(-36, 0, 12), (-50, 0, -8), (-60, 0, -36), (-72, 0, -66), (-80, 0, -82)], [13, 12.5, 14, 15, 12], flat=1.2))
    trigger(model, -6, -34, 15)
    return model.add("hammer", slab([(-38, 20), (-44, 38), (-54, 40), (-46, 16)], 6, "xz"))


def rifle(rng, bolt=True):
    """A long stock, a barrel, a telescopic sight and a bolt handle on the right."""
    l = 330 * rng.uniform(0.94, 1.06)
    model = Model().plane(label="partial" if bolt else "exact")
    stock = slab([(-l * 0.95, 14), (-l * 0.95, -46), (-l * 0.5, -22), (-l * 0.36, -36), (-l * 0.3, -34), (-l * 0.26, -12),
                  (l * 0.3, -8), (l * 0.32, 4), (-l * 0.28, 8), (-l * 0.4, 2)], 26, "xz")
    model.add("stock", fillet(stock, 6, lambda m: abs(m[1]) > 12))
    model.add(
        "barrel",
        lathe(lines((0, -l * 0.28), (13, -l * 0.28), (13, l * 0.02), (9, l * 0.1), (6.5, l), (0, l)), axis="x", at=(0, 0, 12)))
    scope = lathe(
        lines((0, -l * 0.32), (13, -l * 0.32), (13, -l * 0.26), (9, -l * 0.2), (9, l * 0.0), (16, l * 0.06), (16, l * 0.14),
              (0, l * 0.14)), axis="x", at=(0, 0, 44))
    model.add("sight", scope).add("ring", box((8, 14, 26), (0, 0, 30)), shift(-l * 0.18),
                                  shift(-l * 0.02)).add("turret", rod((-l * 0.1, 0, 50), (-l * 0.1, 0, 62), 6))
    trigger(model, -l * 0.2, -14, 15)
    model.add("magazine", box((44, 16, 22), (-l * 0.06, 0, -18)))
    if bolt:
        model.add("bolt", limb([(-l * 0.2, -8, 12), (-l * 0.2, -24, 8), (-l * 0.21, -38, -4)],
                               [4, 3.2, 3.2])).add("knob", ball((-l * 0.21, -41, -7), 7))
    return model


def shotgun(rng):
    """Two barrels side by side, a long stock with a pistol grip."""
    l = 330 * rng.uniform(0.94, 1.06)
    model = Model().plane()
    barrel = cut(rod((-l * 0.1, 0, 0), (l, 0, 0), 11, 9.5), rod((l * 0.6, 0, 0), (l + 1, 0, 0), 7.5))
    model.add("barrel", barrel, shift(0, 10.5, 12), shift(0, -10.5, 12)).add("rib", box(
        (l * 1.08, 6, 4), (l * 0.45, 0, 21))).add("bead", ball((l * 0.97, 0, 24), 3))
    model.add(
        "action",
        fillet(slab([(-l * 0.28, 22), (-l * 0.09, 24), (-l * 0.09, -12), (-l * 0.24, -16)], 40, "xz"), 4,
               lambda m: abs(m[1]) > 19))
    model.add(
        "fore end",
        fillet(slab([(-l * 0.09, 4), (l * 0.3, 4), (l * 0.3, -6), (-l * 0.09, -14)], 38, "xz"), 4,
               lambda m: abs(m[1]) > 18 and m[2] < 0))
    stock = limb([(-l * 0.26, 0, 4), (-l * 0.4, 0, -4), (-l * 0.62, 0, -14), (-l * 0.9, 0, -26), (-l * 1.0, 0, -30)],
                 [17, 13, 15, 17, 17], flat=1.7)
    trigger(model, -l * 0.2, -18, 15)
    return model.add("stock", stock)


def carbine(rng):
    """An automatic rifle: a box receiver, a bent magazine, a grip, a skeleton stock, sights."""
    l = 210 * rng.uniform(0.94, 1.06)
    model = Model().plane()
    model.add("receiver", fillet(box((l * 0.85, 30, 44), (-l * 0.1, 0, 10)), 3, lambda m: m[2] > 30))
    model.add(
        "hand guard",
        cut(fillet(box((l * 0.6, 34, 34), (l * 0.6, 0, 12)), 5, lambda m: abs(m[1]) > 16 and abs(m[2] - 12) > 16),
            *[box((14, 60, 8), (l * (0.4 + 0.13 * k), 0, 14)) for k in range(4)]))
    model.add("barrel", rod((l * 0.85, 0, 12), (l * 1.35, 0, 12), 6)).add("flash hider",
                                                                          rod((l * 1.3, 0, 12), (l * 1.45, 0, 12), 9, 10))
    model.add(
        "magazine",
        slab([(l * 0.02, -10), (l * 0.26, -10), (l * 0.3, -56), (l * 0.42, -100), (l * 0.2, -110), (l * 0.08, -60)], 20, "xz"))
    model.add(
        "grip",
        fillet(slab([(-l * 0.42, -10), (-l * 0.24, -10), (-l * 0.32, -78), (-l * 0.52, -76)], 22, "xz"), 4,
               lambda m: abs(m[1]) > 10 and -70 < m[2] < -14))
    stock = cut(slab([(-l * 0.52, 26), (-l * 1.15, 30), (-l * 1.15, -52), (-l * 1.02, -52), (-l * 0.52, -6)], 22, "xz"),
                slab([(-l * 0.6, 16), (-l * 1.05, 18), (-l * 1.05, -36), (-l * 0.6, -2)], 50, "xz"))
    trigger(model, -l * 0.12, -16, 15)
    model.add("front sight", slab([(l * 0.95, 16), (l * 1.05, 16), (l * 1.02, 46), (l * 0.98, 46)], 5,
                                  "xz")).add("rear sight", box((30, 12, 16), (-l * 0.3, 0, 38)))
    return model.add("stock", stock)


ENTRIES = [
    ("pistol", pistol, {}, {"structure": "solid"}),
    ("revolver", revolver, {}, {"structure": "compound"}),
    ("hunting-rifle", rifle, {}, {"structure": "assembly"}),
    ("shotgun", shotgun, {}, {"structure": "assembly"}),
    ("carbine", carbine, {}, {}),
]
