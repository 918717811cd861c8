"""Boats: hulls skinned over stations, with decks, rigs and deckhouses. Lengths in mm; x points to the bow."""

from .kernel import box, cut, fillet, move, ring, rod, shift, slab
from .model import Model
from .surfaces import fuselage, hull, limb, open_hull


def plain_stations(l, beam, deck, draught, stern=0.8, full=0.7, sheer=0.15, bow=0.5):
    """Stations of length 2 l: a transom `stern` of the beam wide, a bow raised by `sheer` of the depth."""
    rise = sheer * (deck + draught)
    return [(-l, beam * stern, deck, -draught * 0.55, full), (-l * 0.5, beam * 0.97, deck, -draught, full),
            (0, beam, deck, -draught, full), (l * 0.4, beam * 0.88, deck + rise * 0.2, -draught, full * 0.8),
            (l * 0.75, beam * bow, deck + rise * 0.55, -draught * 0.9, full * 0.4), (l, 0, deck + rise, -draught * 0.1, 0)]


def plain_hull(*sizes, **shape):
    """A decked hull over plain stations."""
    return hull(plain_stations(*sizes, **shape))


def canoe_stations(l, beam, deck, depth, rise):
    """Stations of a double-ended hull."""
    shape = [(-1, 0, rise, 0.62), (-0.8, 0.42, rise * 0.5, 0.15), (-0.4, 0.9, rise * 0.08, 0), (0, 1, 0, 0),
             (0.4, 0.9, rise * 0.08, 0), (0.8, 0.42, rise * 0.5, 0.15), (1, 0, rise, 0.62)]
    return [(a * l, b * beam, deck + up, deck - depth + low * depth, 0.55) for a, b, up, low in shape]


def sail(points, thickness=0.9):
    """A flat sail in the centre plane from (x, z) points."""
    return slab(points, thickness, "xz")


def sailing_boat(rng, hulls=1):
    """A yacht with mast, boom, main sail and jib, a fin keel and a rudder."""
    l, beam, mast = 80 * rng.uniform(0.93, 1.07), 25 * rng.uniform(0.92, 1.08), 190 * rng.uniform(0.9, 1.1)
    model = Model().plane()
    if hulls == 1:
        model.add("hull", plain_hull(l, beam, 12, 12, 0.65, 0.4))
        model.add("keel", slab([(-12, -8), (-18, -44), (4, -44), (18, -8)],
                               4, "xz")).add("rudder",
                                             slab([(-l + 4, 0), (-l + 2, -26), (-l + 12, -26), (-l + 16, -4)], 2.4, "xz"))
        model.add(
            "cabin",
            fillet(cut(slab([(-10, 10), (-10, 20), (26, 18), (40, 10)], beam * 1.1, "xz"), box((6, 100, 3), (4, 0, 16))), 1.5,
                   lambda m: m[2] > 17.5))
    else:
        model.add_pair("hull", move(plain_hull(l, 8, 12, 10, 0.8, 0.6, bow=0.6), 0, beam * 1.4, 0))
        model.add("deck", box((l * 0.95, beam * 2.8, 4),
                              (-l * 0.2, 0, 12))).add("cross beam",
                                                      rod((l * 0.7, -beam * 1.4, 12), (l * 0.7, beam * 1.4, 12), 1.8))
        model.add("cabin", fillet(box((48, beam * 1.4, 14), (-4, 0, 20)), 4, lambda m: m[2] > 20))
    model.add("mast", rod((16, 0, 10), (16, 0, mast), 1.8, 1.0)).add("boom", rod((16, 0, 32), (-l * 0.72, 0, 32), 1.3))
    model.add("main sail", sail([(15, 34), (15, mast - 6),
                                 (-l * 0.7, 34)])).add("jib", sail([(l * 0.97, 20), (18, mast * 0.86), (20, 32)]))
    return model


def canoe(rng, outrigger=False):
    """An open double-ended boat with seats; with an outrigger on one side the symmetry is partial."""
    l, beam, depth = 110 * rng.uniform(0.93, 1.07), 20 * rng.uniform(0.92, 1.08), 17
    shell = open_hull(canoe_stations(l, beam, 12, depth, 14), canoe_stations(l * 0.96, beam * 0.9, 12, depth * 0.88, 13.4))
    model = Model().plane(label="partial" if outrigger else "exact").add("hull", shell)
    if not outrigger:
        model.plane((1, 0, 0))
    model.add("seat", box((12, beam * 1.56, 2), (0, 0, 0)), shift(l * 0.42, 0, 8),
              shift(-l * 0.42, 0, 8)).add("thwart", box((4, beam * 1.86, 2), (0, 0, 10)))
    if outrigger:
        model.add("float", fuselage([(-64, 0, 0, 4), (-50, 3, 3, 1), (0, 4.5, 4.5, -2), (50, 3, 3, 1), (66, 0, 0, 5)]),
                  shift(0, 62, 0))
        model.add("arm", rod((0, -beam, 12), (0, 62, 3), 1.6), shift(26, 0, 0), shift(-26, 0, 0))
    return model


def rowing_boat(rng):
    """An open boat with a transom, three thwarts and a pair of oars."""
    l, beam = 85 * rng.uniform(0.93, 1.07), 30 * rng.uniform(0.93, 1.07)
    shell = open_hull(plain_stations(l, beam, 14, 10, 0.7, 0.6, 0.3), plain_stations(l * 0.96, beam * 0.92, 14, 8, 0.7, 0.6,
                                                                                     0.3))
    model = Model().plane().add("hull", shell)
    for x, w in ((-0.7, 0.8), (-0.15, 0.9), (0.4, 0.74)):
        model.add("thwart", box((11, 2 * beam * w, 2), (x * l, 0, 8)))
    model.add_pair("oar", rod(
        (10, beam * 0.3, 20), (-20, beam * 2.6, 8),
        1.2)).add_pair("blade", slab([(-14, beam * 2.4), (-30, beam * 3.0), (-38, beam * 2.9), (-22, beam * 2.35)], 1.4,
                                     at=7.6))
    return model


def tug(rng):
    """A short broad hull with a tall wheelhouse, a funnel, a mast and fenders."""
    l, beam = 74 * rng.uniform(0.94, 1.06), 30 * rng.uniform(0.94, 1.06)
    model = Model().plane().add("hull", plain_hull(l, beam, 18, 16, 0.85, 0.75, 0.35, 0.62))
    model.add("deckhouse",
              fillet(box((66, beam * 1.1, 20), (4, 0, 26)), 3,
                     lambda m: m[2] > 20)).add("wheelhouse",
                                               fillet(box((26, beam * 0.9, 22), (18, 0, 46)), 3, lambda m: m[2] > 40))
    model.add("roof", box((32, beam, 2.5), (18, 0, 58))).add("funnel", rod(
        (-14, 0, 34), (-18, 0, 66), 8, 6.5)).add("mast", rod((10, 0, 58), (8, 0, 92), 1.5,
                                                             0.8)).add("yard", rod((9, -12, 78), (9, 12, 78), 0.8))
    tyre = ring((0, 0, 0), (0, 1, 0), 5, 2)
    model.add("tyre", tyre, *[shift(x, side * (beam + 1), 10) for x in (-50, -25, 0) for side in (1, -1)])
    return model.add("bitt", rod((-52, 0, 14), (-52, 0, 28), 3))


def container_ship(rng, bays=6):
    """A long hull with stacks of containers and a bridge aft; two shorter stacks keep it symmetric."""
    l, beam = 190 * rng.uniform(0.95, 1.05), 27 * rng.uniform(0.95, 1.05)
    model = Model().plane().add("hull", plain_hull(l, beam, 22, 16, 0.9, 0.95, 0.12, 0.75))
    model.add("bridge", box((18, beam * 1.7, 52), (-l * 0.72, 0, 46))).add("wing", box(
        (10, beam * 2.1, 5), (-l * 0.72, 0, 70))).add("funnel", box((14, 14, 26), (-l * 0.84, 0, 58)))
    stack = (l * 1.45) / bays
    for k in range(bays):
        tall = 20 + 7 * ((k * 5) % 3)
        wide = beam * (1.8 if k < bays - 1 else 1.3)
        model.add(f"stack {k}", box((stack * 0.9, wide, tall), (-l * 0.6 + stack * (k + 0.5), 0, 22 + tall / 2)))
    return model.add("mast", rod((l * 0.9, 0, 22), (l * 0.9, 0, 52), 1.5))


def submarine(rng):
    """A round hull with a sail, planes, a cross of rudders."""
    l, r = 130 * rng.uniform(0.94, 1.06), 15 * rng.uniform(0.92, 1.08)
    model = Model().plane().add(
        "hull",
        fuselage([(-l, 0, 0, 0), (-l * 0.94, r * 0.2, r * 0.2, 0), (-l * 0.6, r * 0.75, r * 0.75, 0), (-l * 0.2, r, r, 0),
                  (l * 0.6, r, r, 0), (l * 0.85, r * 0.85, r * 0.85, 0), (l * 0.96, r * 0.5, r * 0.5, 0), (l, 0, 0, 0)]))
    model.add("sail", fuselage([(r * 0.7, 5, 15, l * 0.28), (r * 1.5, 4.5, 14, l * 0.28), (r * 2.0, 4, 12, l * 0.28)],
                               axis="z"))
    model.add_pair("sail plane",
                   slab([(l * 0.32, 0), (l * 0.3, 26), (l * 0.22, 26), (l * 0.22, 0)], 2,
                        at=r * 1.55)).add_pair("stern plane",
                                               slab([(-l * 0.74, 0), (-l * 0.82, 24), (-l * 0.9, 24), (-l * 0.9, 0)], 2))
    model.add("rudder", slab([(-l * 0.74, 0), (-l * 0.82, 24), (-l * 0.9, 24), (-l * 0.9, -24), (-l * 0.82, -24)], 2, "xz"))
    return model.add("periscope", rod((l * 0.3, 0, r * 1.9), (l * 0.3, 0, r * 2.9),
                                      1.2)).add("deck", box((l * 1.3, r * 0.6, 3), (0, 0, r)))


def speedboat(rng):
    """A planing hull with a raked windscreen, seats and two outboard engines."""
    l, beam = 90 * rng.uniform(0.94, 1.06), 27 * rng.uniform(0.94, 1.06)
    lines = [(-1, 1, 16, -9, 0.35), (-0.3, 1.02, 16, -9, 0.3), (0.3, 0.9, 17, -8, 0.2), (0.7, 0.5, 19, -3, 0.1),
             (1, 0, 22, 14, 0)]
    outer = [(a * l, b * beam, deck, keel, full) for a, b, deck, keel, full in lines]
    inner = [(a * l * 0.96, b * beam * 0.84, deck, keel + 6, full) for a, b, deck, keel, full in lines]
    model = Model().plane().add("hull", open_hull(outer, inner)).add(
        "fore deck",
        hull([(l * 0.08, beam * 0.9, 17, 13, 0.8), (l * 0.4, beam * 0.75, 19.5, 15, 0.8), (l * 0.7, beam * 0.42, 20.5, 17, 0.8),
              (l * 0.95, 0, 22, 19, 0)]))
    model.add("windscreen", slab([(2, 15), (14, 15), (-4, 32), (-7, 32)], beam * 1.4, "xz"))
    model.add_pair("seat", fillet(box((16, 14, 12), (-l * 0.35, beam * 0.4, 14)),
                                  2)).add("bench", box((14, beam * 1.4, 11), (-l * 0.72, 0, 14)))
    engine = limb([(-l - 4, 0, -12), (-l - 5, 0, 6), (-l - 6, 0, 18), (-l - 6, 0, 30)], [2, 3, 7, 5])
    return model.add("engine", engine, shift(0, 9, 0), shift(0, -9, 0))


ENTRIES = [
    ("sailing-boat", sailing_boat, {}, {"structure": "compound"}),
    ("catamaran", sailing_boat, dict(hulls=2), {}),
    ("canoe", canoe, {}, {"structure": "assembly"}),
    ("outrigger-canoe", canoe, dict(outrigger=True), {}),
    ("rowing-boat", rowing_boat, {}, {}),
    ("tug", tug, {}, {"structure": "assembly"}),
    ("container-ship", container_ship, {}, {}),
    ("submarine", submarine, {}, {"structure": "solid"}),
    ("speedboat", speedboat, {}, {}),
]
