"""Airplanes: one parametric aircraft, and the types of the archive as settings of it. Lengths in mm."""

from types import SimpleNamespace

from .kernel import box, curved_slab, lathe, lines, move, rod, shift, slab, turn
from .model import Model
from .surfaces import fuselage, limb, pair, wing

DEFAULTS = dict(length=200, radius=9, nose=0.14, tail_up=0.5, square=0.0, span=180, root=34, tip=14, sweep=20, dihedral=6,
                wing_x=20, wing_z=-3, thick=2.6, tail="plain", fin=30, fin_chord=26, tail_span=60, tail_chord=20,
                engines="none", gear=False, struts=False, canopy=False, decks=1, gap=22, canard=False, floats=False,
                blades="flat")


def body(s):
    """The fuselage along x, its tail end lifted by `tail_up` of the radius."""
    l, r, up = s.length / 2, s.radius, s.tail_up * s.radius
    cone = l - s.nose * s.length
    return fuselage([(-l, 0, 0, up), (-l * 0.97, r * 0.14, r * 0.16, up), (-l * 0.7, r * 0.5, r * 0.55, up * 0.6),
                     (-l * 0.3, r * 0.95, r * 0.97, 0.1 * up), (0, r, r, 0), (cone * 0.8, r, r, 0),
                     (l * 0.9, r * 0.8, r * 0.76, -0.08 * r), (l * 0.96, r * 0.54, r * 0.5, -0.14 * r),
                     (l * 0.99, r * 0.27, r * 0.25, -0.2 * r), (l, 0, 0, -0.22 * r)], s.square)


def main_wings(model, s):
    """One wing pair for each deck, with struts between decks or to the fuselage."""
    half = s.span / 2
    for deck in range(s.decks):
        z, back = s.wing_z + deck * s.gap, -deck * 3
        root, tip = (s.wing_x + back, 0.25 * s.radius if s.decks == 1 else 0, z), (s.wing_x + back - s.sweep, half,
                                                                                   z + s.dihedral)
        model.add_pair(f"wing {deck + 1}", wing(root, s.root, tip, s.tip, s.thick))
    if s.decks > 1:
        top = s.wing_z + (s.decks - 1) * s.gap
        for share in (0.2, 0.72):
            for back in (0.25, 0.7):
                x, y = s.wing_x - share * s.sweep - back * s.root * 0.8, half * share
                model.add_pair("strut", rod((x, y, s.wing_z + s.dihedral * share), (x - 2, y, top + s.dihedral * share), 0.8))
    if s.struts:
        x = s.wing_x - 0.35 * s.root
        model.add_pair("strut", rod((x, 0.6 * s.radius, -0.8 * s.radius), (x - 2, half * 0.5, s.wing_z + s.dihedral * 0.5),
                                    0.8))


def upright(x, y, z, chord, height, sweep, thick=1.4, tip_share=0.5):
    """A fin: a wing that stands up."""
    return wing((x, y, z), chord, (x - sweep, y, z + height), chord * tip_share, thick, up=(0, 1, 0))


def tail(model, s):
    """Fin and tailplane of the type `tail`."""
    x, z, half = -s.length / 2 + s.fin_chord * 1.15, s.tail_up * s.radius, s.tail_span / 2
    sweep = 0.6 * s.fin
    if s.tail == "none":
        return
    if s.tail == "vee":
        model.add_pair("tail", wing((x, 0, z), s.tail_chord, (x - 10, half * 0.75, z + half * 0.7), s.tail_chord * 0.6, 1.3))
        return
    heights = {"plain": 0.05, "tee": 0.97, "cross": 0.45, "twin": 0.05, "fighter": -0.1}
    high = z + heights[s.tail] * s.fin
    back = x - (heights[s.tail] > 0.3) * sweep * heights[s.tail]
    model.add_pair("tailplane",
                   wing((back - 3, 0, high), s.tail_chord, (back - 3 - 0.35 * half, half, high + 1), s.tail_chord * 0.5, 1.2))
    if s.tail == "twin":
        model.add_pair("fin", upright(back + 1 - 0.3 * half, half * 0.96, high - 0.35 * s.fin, s.fin_chord * 0.8, s.fin, 5))
    elif s.tail == "fighter":
        model.add_pair("fin", upright(x + 4, 0.7 * s.radius, z, s.fin_chord, s.fin, sweep))
    else:
        model.add("fin", upright(x, 0, z, s.fin_chord, s.fin, sweep))


def nacelle(length, r):
    """A jet nacelle along x around the origin, its intake in front, open through the middle."""
    h = length / 2
    return lathe([[(r * 0.8, h), (r, h * 0.7), (r * 0.95, -h * 0.2), (r * 0.6, -h)]] + lines(
        (r * 0.6, -h), (r * 0.5, -h)) + [[(r * 0.5, -h), (r * 0.72, 0), (r * 0.8, h)]], axis="x")


def turboprop(length, r):
    """A slim closed nacelle along x with a spinner."""
    h = length / 2
    return lathe([[(0, -h), (r * 0.7, -h * 0.5), (r, h * 0.3),
                   (r * 0.6, h * 0.9)], [(r * 0.6, h * 0.9), (0.4 * r, h * 1.1), (0, h * 1.2)]], axis="x")


def propeller(radius, blades="flat"):
    """A two-bladed propeller across the x axis: flat (mirror-symmetric) or pitched (chiral)."""
    if blades == "flat":
        return slab([(-radius, -0.6), (-radius * 0.4, -1.5), (radius * 0.4, -1.5), (radius, -0.6), (radius, 0.6),
                     (radius * 0.4, 1.5), (-radius * 0.4, 1.5), (-radius, 0.6)], 0.8, "yz")
    made = slab([(-radius, -0.8), (-radius * 0.4, -1.8), (0, -1.2), (0, 1.2), (-radius * 0.4, 1.8), (-radius, 0.8)], 0.8, "yz")
    from .kernel import fuse, rotate
    return fuse(rotate(made, 30, (0, 1, 0)), rotate(rotate(made, 30, (0, 1, 0)), 180, (1, 0, 0)),
                rod((-1.5, 0, 0), (1.5, 0, 0), 1.6))


def wing_point(s, share):
    """The leading edge of the wing at a share of the half span."""
    return s.wing_x - s.sweep * share, s.span / 2 * share, s.wing_z + s.dihedral * share


def engines(model, s):
    """Engines of the kind `engines`, a kind and a list of places along the half span."""
    kind, *shares = s.engines.split()
    shares = [float(share) for share in shares]
    r = s.radius
    if kind == "under":
        places = [(x + 4, y, z - 0.75 * r) for x, y, z in (wing_point(s, share) for share in shares)]
        model.add("nacelle", nacelle(2.6 * r, 0.52 * r), *[shift(x, side * y, z) for x, y, z in places for side in (1, -1)])
        for x, y, z in places:
            model.add_pair("pylon", box((1.5 * r, 0.8, 0.7 * r), (x - 0.6 * r, y, z + 0.62 * r)))
    elif kind == "rear":
        x = -s.length * 0.27
        model.add("nacelle", nacelle(3.2 * r, 0.5 * r), *[shift(x, side * 1.55 * r, 0.35 * r) for side in (1, -1)])
        model.add_pair("pylon", box((1.4 * r, 0.9 * r, 1.2), (x, 0.95 * r, 0.35 * r)))
    elif kind == "props":
        points = [wing_point(s, share) for share in shares]
        model.add("engine", turboprop(3 * r, 0.45 * r),
                  *[shift(x - 2, side * y, z + 0.5) for x, y, z in points for side in (1, -1)])
        prop = propeller(1.3 * r, s.blades)
        model.add("propeller", prop, *[shift(x + 1.4 * r, side * y, z + 0.5) for x, y, z in points for side in (1, -1)])
    elif kind in ("nose", "pusher"):
        x = s.length / 2 + 1 if kind == "nose" else -s.length / 2 - 1
        z = -0.22 * r if kind == "nose" else s.tail_up * r
        model.add("propeller", propeller(2.4 * r, s.blades), shift(x, 0, z))
        model.add("spinner", lathe([[(0, 4.5), (1.6, 3.2), (2.2, -2)]], axis="x"), shift(x, 0, z))
    elif kind == "intakes":
        model.add_pair("intake", box((0.3 * s.length, 0.9 * r, 1.1 * r), (-0.03 * s.length, 0.95 * r, -0.15 * r)))
        model.add_pair("jet pipe", rod((-0.35 * s.length, 0.5 * r, 0), (-0.53 * s.length, 0.5 * r, 0), 0.5 * r, 0.42 * r))


def fittings(model, s):
    """Canopy, canard, landing gear and floats."""
    r = s.radius
    if s.canopy:
        at, l = s.length * 0.23, s.length
        model.add(
            "canopy",
            fuselage([(at - 0.1 * l, 0, 0, 0.55 * r), (at - 0.05 * l, 0.5 * r, 0.6 * r, 0.6 * r),
                      (at, 0.6 * r, 0.85 * r, 0.6 * r), (at + 0.05 * l, 0.45 * r, 0.5 * r, 0.55 * r),
                      (at + 0.09 * l, 0, 0, 0.4 * r)]))
    if s.canard:
        x = s.length * 0.3
        model.add_pair("canard",
                       wing((x, 0.3 * r, 0.2 * r), s.tail_chord, (x - 10, s.tail_span / 2, 0.3 * r), s.tail_chord * 0.4, 1.1))
    if s.gear:
        wheel = lathe(lines((0, -1.2), (3.6, -1.2), (4.2, -0.6), (4.2, 0.6), (3.6, 1.2), (0, 1.2)), axis="y")
        x, low = s.wing_x - 2, -r - 9
        model.add("wheel", wheel, shift(x, 1.5 * r, low), shift(x, -1.5 * r, low))
        model.add_pair("leg", rod((x, 0.5 * r, -0.7 * r), (x, 1.5 * r - 1, low), 0.9))
        model.add("tail wheel", wheel, shift(-s.length * 0.42, 0, -r * 0.35 - 4))
    if s.floats:
        at, low = s.wing_x - 10, -r - 16
        float_body = fuselage([(at - 55, 0, 0, low + 3), (at - 40, 2.5, 2.5, low + 2), (at, 4.5, 4.5, low),
                               (at + 35, 4, 4, low), (at + 52, 0, 0, low + 3)], 0.3)
        model.add_pair("float", move(float_body, 0, 2 * r, 0))
        for x in (at - 18, at + 18):
            model.add_pair("strut", rod((x, 2 * r, low), (x, 0.5 * r, -0.5 * r), 0.9))


def aircraft(rng, pod=False, **settings):
    """An aircraft with every length varied a little."""
    s = SimpleNamespace(**{**DEFAULTS, **settings})
    for key in ("length", "radius", "span", "root", "tip", "fin", "fin_chord", "tail_span", "tail_chord"):
        setattr(s, key, getattr(s, key) * float(rng.uniform(0.92, 1.08)))
    for key in ("sweep", "dihedral"):
        setattr(s, key, getattr(s, key) * float(rng.uniform(0.85, 1.15)))
    model = Model().plane(label="partial" if pod or (s.blades != "flat" and s.engines != "none") else "exact")
    model.add("fuselage", body(s))
    main_wings(model, s)
    tail(model, s)
    engines(model, s)
    fittings(model, s)
    if pod:
        x, y, z = wing_point(s, 0.45)
        model.add("pod", fuselage([(-22, 0, 0, 0), (-16, 3, 3, 0), (0, 4.5, 4.5, 0), (16, 3.5, 3.5, 0), (22, 0, 0, 0)]),
                  shift(x - 10, y, z - 6))
    return model


def twin_boom(rng, **settings):
    """A short pod between two booms that carry the tail."""
    l, y, root = 170 * rng.uniform(0.9, 1.1), 26 * rng.uniform(0.9, 1.1), 34 * rng.uniform(0.9, 1.1)
    span = 190 * rng.uniform(0.9, 1.1)
    model = Model().plane()
    model.add("pod", fuselage([(-25, 0, 0, 2), (-15, 6, 6, 1), (5, 10, 11, 0), (40, 9, 9, 0), (58, 5, 5, -1), (66, 0, 0, -2)]))
    model.add_pair(
        "boom",
        move(fuselage([(-l * 0.6, 0, 0, 3), (-l * 0.55, 2, 2.5, 3), (0, 4, 4, 0), (25, 5, 5, 0), (40, 3, 3, 0), (46, 0, 0, 0)]),
             0, y, 0))
    model.add_pair("wing", wing((28, 2, 0), root, (16, span / 2, 7), root * 0.45, 2.8))
    x = -l * 0.6 + 24
    model.add_pair("tailplane", wing((x - 2, 0, 4), 19, (x - 2, y, 4), 19, 1.3, 1.3))
    model.add_pair("fin", upright(x, y, -6, 22, 26, 6))
    model.add("propeller", propeller(16), shift(47, y, 0), shift(47, -y, 0))
    return model


def flying_wing(rng, **settings):
    """A swept wing without a tail, thick in the middle."""
    span, root, sweep = 200 * rng.uniform(0.9, 1.1), 70 * rng.uniform(0.9, 1.1), 62 * rng.uniform(0.9, 1.1)
    model = Model().plane()
    inner = (40 - sweep * 0.3, span * 0.15, 0.5)
    model.add_pair("centre wing", wing((40, 0, 0), root, inner, root * 0.66, 6, 3.2))
    model.add_pair("outer wing", wing(inner, root * 0.66, (40 - sweep, span / 2, 3), 13, 3.2, 1.0))
    model.add("cockpit", fuselage([(-22, 0, 0, 3), (-5, 8, 5, 3), (15, 8, 6, 3), (28, 5, 4, 2), (36, 0, 0, 0)]))
    model.add("engine", nacelle(22, 5), shift(-12, 16, 4), shift(-12, -16, 4))
    return model


def delta(rng, ogival=False, canard=False, **settings):
    """A delta: a thin fuselage on a flat triangular or ogival wing, one fin, no tailplane."""
    l, half, r = 105 * rng.uniform(0.9, 1.1), (42 if ogival else 52) * rng.uniform(0.92, 1.08), 7 * rng.uniform(0.9, 1.1)
    model = Model().plane()
    model.add(
        "fuselage",
        fuselage([(-l, 0, 0, 2), (-l * 0.8, r * 0.5, r * 0.5, 1), (-l * 0.3, r, r, 0), (l * 0.3, r, r, 0),
                  (l * 0.7, r * 0.7, r * 0.7, -0.5), (l * 0.95, r * 0.2, r * 0.2, -1.5), (l * 1.06, 0, 0, -2)]))
    back = -l * 0.72
    if ogival:
        edge = [(l * 0.55, r * 0.5), (l * 0.2, 0.26 * half), (-l * 0.2, 0.5 * half), (-l * 0.5, 0.92 * half), (back - 2, half)]
        plate = curved_slab([edge, [edge[-1], (back + 4, 0)], [(back + 4, 0), (l * 0.55, 0)], [(l * 0.55, 0), edge[0]]], 1.6,
                            at=-2)
        for y in (0.3, 0.45):
            model.add_pair("engine", box((30, 6, 6), (back + 18, y * half, -5)))
    else:
        plate = slab([(l * 0.32, 0), (l * 0.28, r), (back + 8, half), (back, half), (back, 0)], 1.8, at=-1)
        model.add_pair("intake", box((40, 5, 8), (0, r + 1, -1)))
    model.add_pair("wing", plate)
    if canard:
        model.add_pair("canard", slab([(l * 0.62, 0), (l * 0.44, 24), (l * 0.38, 24), (l * 0.42, 0)], 1.2, at=2))
    fin = [(back + 34, 4), (back + 4, 34), (back - 6, 34), (back - 2, 2)]
    model.add("fin", slab(fin, 1.6, "xz"))
    model.add(
        "canopy",
        fuselage([(l * 0.3, 0, 0, r * 0.7), (l * 0.4, 3, 4, r * 0.7), (l * 0.5, 3, 4, r * 0.6), (l * 0.65, 0, 0, r * 0.4)]))
    return model


def flying_boat(rng, **settings):
    """A high wing on a boat-shaped fuselage with engines above and tip floats."""
    model = aircraft(rng, length=190, radius=11, wing_z=14, span=210, root=32, tip=20, sweep=6, dihedral=2, tail="cross",
                     fin=34, engines="props 0.22", square=0.25)
    model.add("keel", slab([(-30, -8), (-20, -14), (50, -15), (78, -10), (84, -4), (0, -4)], 9, "xz"))
    model.add("tower", box((26, 9, 12), (6, 0, 10)))
    model.add_pair("tip float", move(fuselage([(-16, 0, 0, 1), (-8, 2, 2, 0), (6, 2.6, 2.6, 0), (16, 0, 0, 1)]), 8, 78, 0))
    model.add_pair("strut", rod((8, 78, 0), (4, 78, 15), 0.9))
    return model


JET = dict(tail_span=66, sweep=48, root=46, tip=12)
ENTRIES = [
    ("airliner-twin", aircraft, dict(JET, engines="under 0.33"), {"structure": "assembly"}),
    ("airliner-quad", aircraft, dict(JET, span=196, length=215, radius=11, engines="under 0.3 0.58"), {}),
    ("airliner-rear-engines", aircraft, dict(JET, span=150, length=210, engines="rear", tail="tee", wing_x=8), {}),
    ("business-jet", aircraft,
     dict(JET, span=140, length=150, radius=8, root=34, sweep=30, engines="rear", tail="cross",
          wing_x=6), {"structure": "solid"}),
    ("turboprop-high-wing", aircraft, dict(wing_z=8, span=190, sweep=4, root=24, tail="tee", engines="props 0.27",
                                           radius=8), {"structure": "assembly"}),
    ("bomber-four-propellers", aircraft,
     dict(span=220, sweep=12, root=36, engines="props 0.25 0.5", tail="twin", tail_span=70, fin=26), {}),
    ("biplane", aircraft,
     dict(length=120, span=150, root=24, tip=22, sweep=2, dihedral=3, decks=2, wing_z=-7, engines="nose", gear=True,
          tail_span=46, fin=20, fin_chord=18, tail_chord=16, thick=1.6), {"structure": "compound"}),
    ("triplane", aircraft,
     dict(length=105, span=125, root=18, tip=18, sweep=1, dihedral=1, decks=3, gap=16, wing_z=-9, engines="nose", gear=True,
          tail_span=42, fin=18, fin_chord=17, tail_chord=16, thick=1.4, blades="pitched"), {}),
    ("glider", aircraft,
     dict(length=120, radius=5, span=270, root=15, tip=6, sweep=3, dihedral=10, tail="tee", fin=20, fin_chord=14, tail_span=44,
          tail_chord=10, thick=1.2, wing_x=16, canopy=True), {"structure": "solid"}),
    ("glider-v-tail", aircraft,
     dict(length=115, radius=5, span=230, root=16, tip=7, sweep=4, dihedral=12, tail="vee", tail_span=46, tail_chord=12,
          thick=1.3, wing_x=14), {}),
    ("light-aircraft-high-wing", aircraft,
     dict(length=115, radius=8, span=160, root=22, tip=18, sweep=3, dihedral=4, wing_z=9, struts=True, gear=True,
          engines="nose", tail_span=52, fin=24, fin_chord=20, tail_chord=16, square=0.2), {"structure": "assembly"}),
    ("trainer-low-wing", aircraft,
     dict(length=125, radius=8, span=150, root=28, tip=16, sweep=7, dihedral=10, canopy=True, gear=True, engines="nose",
          tail_span=50, fin=24, fin_chord=20, tail_chord=17, blades="pitched"), {"pcurves": False}),
    ("twin-boom", twin_boom, {}, {}),
    ("flying-wing", flying_wing, {}, {"structure": "compound"}),
    ("delta-canard", delta, dict(canard=True), {"structure": "solid"}),
    ("delta-fighter", delta, {}, {"split": True}),
    ("supersonic-transport", delta, dict(ogival=True), {"splines": True}),
    ("fighter-twin-fin", aircraft,
     dict(length=175, radius=9, span=115, root=56, tip=14, sweep=42, dihedral=-1, tail="fighter", tail_span=74, tail_chord=26,
          fin=28, fin_chord=30, engines="intakes", canopy=True, thick=1.8), {}),
    ("seaplane", aircraft,
     dict(length=120, radius=8, span=155, root=23, tip=20, sweep=3, wing_z=8, engines="nose", floats=True, tail_span=48, fin=24,
          fin_chord=20, tail_chord=16), {"structure": "compound"}),
    ("flying-boat", flying_boat, {}, {}),
    ("pusher-canard", aircraft,
     dict(length=105, radius=7, span=150, root=24, tip=12, sweep=30, wing_x=-12, tail="none", canard=True, tail_span=58,
          tail_chord=13, engines="pusher", canopy=True, tail_up=0.1), {}),
    ("jet-with-one-pod", aircraft, dict(JET, span=160, engines="under 0.3", pod=True), {}),
]
