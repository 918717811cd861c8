"""Sunglasses: two rims with lenses, a bridge, two temples that end in ear hooks. Lengths in mm; x forward."""

from .kernel import box, cut, fillet, move, rod, rotate, slab
from .model import Model
from .surfaces import limb

SHAPES = {
    "aviator": [(-27, 6), (-24, 18), (-8, 22), (14, 22), (25, 16), (25, 2), (14, -20), (-4, -26), (-20, -14)],
    "round": [(-24, 0), (-17, 17), (0, 24), (17, 17), (24, 0), (17, -17), (0, -24), (-17, -17)],
    "square": [(-27, 0), (-27, 13), (-20, 18), (0, 19), (22, 18), (28, 13), (26, -4), (20, -17), (0, -19), (-18, -17),
               (-25, -10)],
    "sport": [(-32, 2), (-26, 12), (-4, 15), (18, 13), (33, 8), (34, 0), (24, -12), (0, -15), (-20, -13), (-30, -6)],
}


def scaled(outline, factor):
    """An outline scaled about its origin."""
    return [(u * factor, v * factor) for u, v in outline]


def temple(y, z, length, r, drop, flat):
    """One side arm from the hinge backwards, bent down behind the ear."""
    return limb([(2, y, z), (-length * 0.35, y + 1, z + 1), (-length * 0.72, y, z), (-length * 0.92, y - 2, z - drop * 0.45),
                 (-length * 1.05, y - 4, z - drop)], [r, r, r * 1.1, r * 1.3, r * 1.2], flat=flat)


def sunglasses(rng, shape="round", rim=3.4, wrap=6, folded=False, r=1.6, flat=1.6):
    """A pair of sunglasses; with folded arms, one lies over the other and the symmetry is partial."""
    outline = scaled(SHAPES[shape], rng.uniform(0.95, 1.05))
    inner = scaled(outline, 0.88)
    offset, z = max(u for u, _ in outline) + 7 * rng.uniform(0.9, 1.15), 14
    frame = cut(slab(outline, rim, "yz", smooth=True), slab(inner, rim * 3, "yz", smooth=True))
    lens = slab(scaled(outline, 0.9), rim * 0.4, "yz", smooth=True)
    place = lambda part: rotate(move(part, 0, offset, 0), -wrap, (0, 0, 1))
    model = Model().plane(label="partial" if folded else "exact")
    model.add_pair("rim", place(frame)).add_pair("lens", place(lens))
    top = 0.6 if shape != "round" else 0.35
    nose = offset + min(u for u, _ in outline)
    model.add(
        "bridge",
        limb([(0, -nose - 3, z * top), (3, -nose * 0.4, z * top + 4), (3, nose * 0.4, z * top + 4), (0, nose + 3, z * top)],
             [1.8] * 4, side=(1, 0, 0)))
    if shape == "aviator":
        model.add("brow bar", rod((0, -offset * 0.7, 22), (0, offset * 0.7, 22), 1.3))
    edge = offset + max(u for u, _ in outline)
    length = 125 * rng.uniform(0.95, 1.08)
    arm = temple(edge, z * 0.6, length, r, 30, flat)
    if folded:
        right = limb([(-3, -edge, 8.4), (-8, -edge + 6, 8.4), (-10, 0, 8.4), (-10, edge * 0.75, 6), (-9, edge * 0.95, -10)],
                     [r, r, r, r * 1.2, r * 1.2], side=(0, 0, 1))
        left = limb([(-3, edge, 8.4), (-14, edge - 6, 8.4), (-18, 0, 8.4), (-18, -edge * 0.75, 6), (-17, -edge * 0.95, -10)],
                    [r, r, r, r * 1.2, r * 1.2], side=(0, 0, 1))
        model.add("arm right", right).add("arm left", left)
    else:
        model.add_pair("arm", arm)
    model.add_pair("hinge", fillet(box((6, 4.5, 7), (-wrap * 0.5, edge - 1, z * 0.6)), 0.8))
    return model.add_pair("pad", limb([(-2, nose + 1, 0), (-6, nose - 1, -3), (-6, nose - 1, -8)], [1, 2.2, 1.6],
                                      side=(0, 1, 0)))


ENTRIES = [
    ("aviator", sunglasses, dict(shape="aviator", rim=2.2, r=1.3, flat=1.0), {"structure": "compound"}),
    ("round-rims", sunglasses, dict(shape="round", rim=2.6), {"structure": "assembly"}),
    ("square-rims-folded", sunglasses, dict(shape="square", rim=5, r=2.0, folded=True), {}),
    ("sport", sunglasses, dict(shape="sport", rim=4.5, wrap=14, r=2.0, flat=2.0), {"split": True}),
]
