"""Vehicles on wheels: cars, lorries, a bus, a tractor, racing cars, a digger. Lengths in mm (about 1:20)."""

from .kernel import box, curved_slab, cut, fillet, lathe, lines, loft, move, polyline, rod, rotate, shift, slab
from .model import Model
from .surfaces import fuselage


def wheel(r, width):
    """A tyre on a dished disc, its axis along y, symmetric in y."""
    h = width / 2
    return lathe(
        lines((0, -h * 0.4), (r * 0.55, -h * 0.4), (r * 0.62, -h), (r * 0.9, -h), (r, -h * 0.6), (r, h * 0.6), (r * 0.9, h),
              (r * 0.62, h), (r * 0.55, h * 0.4), (0, h * 0.4)), axis="y")


def on_axles(model, name, made, axles, track, z):
    """One wheel at both ends of every axle (positions along x)."""
    return model.add(name, made, *[shift(x, side * track / 2, z) for x in axles for side in (1, -1)])


def axle_rods(model, axles, track, z, r=1.5):
    """A rod between the wheels of every axle."""
    return model.add("axle", rod((0, -track / 2, 0), (0, track / 2, 0), r), *[shift(x, 0, z) for x in axles])


def cabin(x0, x1, x2, x3, low, high, width, top_width):
    """A glasshouse: from (x0, x3) at the waist to (x1, x2) at the roof, narrower above."""

    def rectangle(a, b, w, z):
        return polyline([(a, -w / 2, z), (b, -w / 2, z), (b, w / 2, z), (a, w / 2, z)])

    return loft([rectangle(x0, x3, width, low), rectangle(x1, x2, top_width, high)])


def arches(shape, axles, r, width):
    """A body with round wheel arches cut through its sides."""
    return cut(shape, *[rod((x, side * width / 2 * 0.62, 0), (x, side * width, 0), r) for x in axles for side in (1, -1)])


def car(rng, length=210, hood=0.32, boot=0.2, roof=0.62, waist=0.6, height=70, width=84, rake=0.1, wing=False, spare=False,
        bed=0.0):
    """A road car: `hood` and `boot` are shares of the length, `waist` and `roof` describe the side profile."""
    length, height, width = length * rng.uniform(0.93, 1.07), height * rng.uniform(0.94, 1.06), width * rng.uniform(0.96, 1.04)
    l, r, z0 = length / 2, 15 * rng.uniform(0.94, 1.06), 9
    belt = z0 + (height - z0) * waist
    axles = (l * 0.62, -l * 0.6)
    hood_z = belt - 5
    outline = [[(-l, z0 + 4), (-l + 4, z0)], [(-l + 4, z0), (l - 6, z0)], [(l - 6, z0), (l, z0 + 6)],
               [(l, z0 + 6), (l - 1, hood_z - 8), (l - 14, hood_z - 3), (l - length * hood, belt)],
               [(l - length * hood, belt), (-l + length * boot, belt)], [(-l + length * boot, belt), (-l + 3, belt - 2)],
               [(-l + 3, belt - 2), (-l, z0 + 4)]]
    body = curved_slab(outline, width, "xz")
    body = fillet(body, 2.5 if wing else 4, lambda m: abs(abs(m[1]) - width / 2) < 1e-3 and m[2] > z0 + 7)
    body = arches(body, axles, r + 3, width)
    if bed:
        body = cut(body, box((length * bed, width - 12, belt), (-l + 5 + length * bed / 2, 0, belt / 2 + z0 + 9)))
    model = Model().plane().add("body", body)
    front, back = l - length * hood + 6, -l + length * boot
    model.add(
        "cabin",
        fillet(
            cabin(back, back + length * rake * 0.7, front - length * rake * 1.5, front, belt - 1, height, width - 6,
                  width - 22), 3, lambda m: m[2] > belt + 2))
    on_axles(model, "wheel", wheel(r, 13), axles, width - 12, r)
    model.add_pair("lamp", rod((l - 8, width * 0.34, hood_z - 12), (l + 1, width * 0.34, hood_z - 12), 5))
    model.add_pair("mirror", box((5, 8, 6), (front - 16, width / 2 + 2, belt + 4)))
    if wing:
        model.add("wing", slab([(-l - 2, 0), (-l + 16, 2), (-l + 16, 4), (-l - 2, 3)], width * 0.9, "xz"),
                  shift(0, 0, belt + 9))
        model.add_pair("wing support", box((6, 3, 12), (-l + 8, width * 0.3, belt + 5)))
    if spare:
        model.add("spare wheel", rotate(wheel(r * 0.95, 10), 90), shift(-l - 5, 0, belt - 8))
    return model


def van(rng, length=230, height=98, width=90, windows=3, axles=(0.62, -0.6), nose=0.16, r=15):
    """A one-box body: a van, a minibus or a bus, with window recesses on both sides."""
    length, height = length * rng.uniform(0.93, 1.07), height * rng.uniform(0.95, 1.05)
    l, z0 = length / 2, 10
    spots = tuple(a * l for a in axles)
    body = curved_slab([[(-l, z0),
                         (l, z0)], [(l, z0),
                                    (l, z0 + height * 0.33)], [(l, z0 + height * 0.33),
                                                               (l - length * nose * 0.4, height * 0.52)],
                        [(l - length * nose * 0.4, height * 0.52),
                         (l - length * nose, height - 4)], [(l - length * nose, height - 4), (l - length * nose - 10, height)],
                        [(l - length * nose - 10, height),
                         (-l + 5, height)], [(-l + 5, height), (-l, height - 6)], [(-l, height - 6), (-l, z0)]], width, "xz")
    body = fillet(body, 6, lambda m: abs(abs(m[1]) - width / 2) < 1e-3 and m[2] > height - 5)
    body = arches(body, spots, r + 3, width)
    step = (length * (0.86 - nose)) / windows
    panes = [
        box((step * 0.82, 4, height * 0.28), (-l + length * 0.05 + step * (k + 0.5), side * width / 2, height * 0.66))
        for k in range(windows) for side in (1, -1)
    ]
    model = Model().plane().add("body", cut(body, *panes))
    on_axles(model, "wheel", wheel(r, 13), spots, width - 12, r)
    model.add_pair("mirror", box((4, 9, 12), (l - length * nose, width / 2 + 4, height * 0.6)))
    return model


def lorry(rng, load="box"):
    """A cab on a frame with a box, a tank or an open bed; twin axles behind."""
    l, width, high = 290 * rng.uniform(0.93, 1.07), 88 * rng.uniform(0.96, 1.04), 118 * rng.uniform(0.95, 1.05)
    r, front, bed = 18, l / 2, 36
    model = Model().plane()
    cab = curved_slab([[(front - 62, 18), (front, 18)], [(front, 18), (front, 60)], [(front, 60), (front - 12, high * 0.88)],
                       [(front - 12, high * 0.88),
                        (front - 18, high * 0.92)], [(front - 18, high * 0.92),
                                                     (front - 62, high * 0.92)], [(front - 62, high * 0.92), (front - 62, 18)]],
                      width, "xz")
    axles = (front - 30, -l / 2 + 78, -l / 2 + 36)
    model.add("cab", arches(fillet(cab, 4, lambda m: m[2] > 62), axles[:1], r + 3, width))
    model.add("frame", box((l - 10, 30, 12), (-5, 0, 28)))
    on_axles(model, "wheel", wheel(r, 17), axles, width - 16, r)
    axle_rods(model, axles, width - 20, r)
    back, length = -l / 2, l - 72
    if load == "box":
        model.add("box", fillet(box((length, width + 4, high + 6 - bed), (back + length / 2, 0, (high + 6 + bed) / 2)), 3))
    elif load == "tank":
        ends = [(0, 0), (0.02, 22), (0.06, 31), (0.12, 35), (0.5, 36), (0.88, 35), (0.94, 31), (0.98, 22), (1, 0)]
        model.add("tank", fuselage([(back + share * length, 1.15 * w, w * 0.92, bed + 32) for share, w in ends]))
        model.add("hatch", rod((0, 0, 0), (0, 0, 10), 10), *[shift(back + length * k / 4, 0, bed + 60) for k in (1, 2, 3)])
        model.add("saddle", box((14, 60, 12), (0, 0, 0)), *[shift(back + length * k, 0, bed + 2) for k in (0.2, 0.8)])
    else:
        tray = cut(box((length, width + 2, 44), (back + length / 2, 0, bed + 22)),
                   box((length - 8, width - 6, 44), (back + length / 2, 0, bed + 27)))
        model.add("tray", tray)
    return model


def tractor(rng):
    """Large rear wheels, a narrow bonnet, a cab, and an exhaust pipe on one side of the bonnet."""
    big, small = 42 * rng.uniform(0.93, 1.07), 24 * rng.uniform(0.93, 1.07)
    model = Model().plane(label="partial")
    model.add("bonnet", fillet(box((86, 34, 38), (52, 0, 58)), 5, lambda m: m[2] > 76 or m[0] > 94))
    model.add("transmission", box((110, 26, 22), (30, 0, 38)))
    model.add("cab", cabin(-44, -38, 6, 12, 44, 118, 62, 54))
    model.add("roof", fillet(box((58, 64, 6), (-16, 0, 120)), 2))
    on_axles(model, "rear wheel", wheel(big, 26), (-30, ), 92, big)
    on_axles(model, "front wheel", wheel(small, 16), (78, ), 76, small)
    axle_rods(model, (0, ), 80, 0, 4).parts[-1].places[:] = [shift(-30, 0, big), shift(78, 0, small)]
    model.add("exhaust", rod((40, 12, 70), (40, 12, 118), 3)).add("air filter", rod((62, -8, 70), (62, -8, 90), 4.5))
    model.add_pair("mudguard", box((60, 20, 4), (-28, 42, 2 * big + 4)))
    return model


def formula(rng, sport=False):
    """A racing car with open wheels, a pointed nose, a front and a rear wing; or a closed sports prototype."""
    l, r = 115 * rng.uniform(0.93, 1.07), 16 * rng.uniform(0.94, 1.06)
    model = Model().plane()
    model.add(
        "tub",
        fuselage([(-l * 0.8, 8, 8, 20), (-l * 0.4, 17, 14, 22), (0, 18, 12, 21), (l * 0.45, 9, 9, 18), (l * 0.8, 6, 5, 15),
                  (l * 1.0, 0, 0, 12)], 0.3))
    axles = (l * 0.62, -l * 0.62)
    on_axles(model, "front wheel", wheel(r, 16), axles[:1], 88, r)
    on_axles(model, "rear wheel", wheel(r * 1.05, 22), axles[1:], 84, r * 1.05)
    for x in axles:
        model.add_pair("suspension", rod((x - 8, 6, 18), (x, 40, 16), 1.4))
        model.add_pair("suspension", rod((x + 8, 6, 18), (x, 40, 16), 1.4))
    model.add_pair("sidepod",
                   move(fuselage([(-50, 5, 6, 16), (-20, 11, 10, 17), (14, 11, 10, 17), (20, 8, 8, 17)], 0.5), 0, 23, 0))
    model.add("front wing", box((16, 92, 2), (l * 0.98, 0, 7))).add_pair("end plate", box((22, 2, 13), (l * 0.96, 46, 11)))
    model.add("rear wing", box((18, 62, 2.5), (-l * 0.93, 0, 48))).add_pair("end plate", box((26, 2, 24), (-l * 0.92, 31, 40)))
    model.add("wing post", box((8, 4, 30), (-l * 0.86, 0, 34)))
    model.add("airbox",
              fuselage([(-60, 3, 4, 32), (-30, 6, 10, 34), (-14, 6, 10, 36),
                        (-8, 4, 6, 37)])).add("helmet", fuselage([(-6, 0, 0, 34), (-3, 6, 7, 34), (3, 7, 8, 34),
                                                                  (9, 0, 0, 33)]))
    if sport:
        model.add_pair(
            "fender",
            move(
                fuselage([(-l * 0.95, 6, 5, 20), (-l * 0.6, 12, 18, 22), (-l * 0.2, 10, 8, 16), (l * 0.3, 10, 8, 16),
                          (l * 0.62, 12, 17, 20), (l * 0.95, 5, 4, 14)], 0.3), 0, 42, 0))
        model.add("floor", box((l * 1.9, 96, 3), (0, 0, 9)))
    return model


def digger(rng):
    """A tracked excavator: its arm beside the cab, so that hardly half of it is symmetric."""
    l, reach = 150 * rng.uniform(0.95, 1.05), rng.uniform(0.9, 1.1)
    model = Model().plane(label="partial")
    track = cut(
        slab([(-l / 2, 12), (-l / 2 + 12, 0), (l / 2 - 12, 0), (l / 2, 12), (l / 2 - 12, 30), (-l / 2 + 12, 30)], 22, "xz"),
        slab([(-l / 2 + 10, 12), (-l / 2 + 16, 5), (l / 2 - 16, 5), (l / 2 - 10, 12), (l / 2 - 16, 24), (-l / 2 + 16, 24)], 30,
             "xz"))
    model.add("track", track, shift(0, 42, 0), shift(0, -42, 0))
    roller = rod((0, -9, 0), (0, 9, 0), 8)
    model.add("roller", roller, *[shift(x, y, 14) for x in (-50, -25, 0, 25, 50) for y in (42, -42)])
    model.add("undercarriage", box((80, 70, 16), (0, 0, 16))).add("slewing ring", rod((0, 0, 22), (0, 0, 36), 30))
    model.add("house", fillet(box((110, 88, 42), (-20, 0, 57)), 4)).add("cab", cabin(-6, 0, 34, 42, 36, 112, 38, 32),
                                                                        shift(0, 24, 0))
    boom = slab([(20, 52), (30, 44), (90 * reach, 112), (150 * reach, 118), (150 * reach, 128), (84 * reach, 126)], 16, "xz",
                at=-12)
    stick = slab([(140 * reach, 132), (150 * reach, 134), (166 * reach, 50), (158 * reach, 48)], 12, "xz", at=-12)
    model.add("boom", boom).add("stick", stick)
    model.add(
        "bucket",
        slab([(170 * reach, 54), (152 * reach, 54), (138 * reach, 34), (146 * reach, 22), (176 * reach, 24), (154 * reach, 34)],
             40, "xz", at=-12))
    return model


def bus_details(rng, **settings):
    """A long van with a ring of roof hatches."""
    model = van(rng, **settings)
    model.add("hatch", box((26, 30, 6), (0, 0, 0)), *[shift(x, 0, 118) for x in (-80, 0, 70)])
    return model


ENTRIES = [
    ("sedan", car, {}, {"structure": "assembly", "splines": False}),
    ("hatchback", car, dict(length=178, boot=0.03, hood=0.27, height=74, rake=0.08), {}),
    ("sports-car", car, dict(length=205, height=58, hood=0.4, boot=0.12, waist=0.62, wing=True,
                             rake=0.14), {"pcurves": False, "splines": False}),
    ("pickup", car, dict(length=245, height=84, boot=0.42, hood=0.26, waist=0.58, bed=0.38, rake=0.03,
                         width=88), {"structure": "solid"}),
    ("jeep-with-spare-wheel", car, dict(length=185, height=88, boot=0.02, hood=0.28, waist=0.55, rake=0.02, spare=True), {}),
    ("van", van, {}, {}),
    ("bus", bus_details, dict(length=400, height=118, width=98, windows=6, axles=(0.7, -0.5), nose=0.03, r=18), {}),
    ("box-lorry", lorry, {}, {"structure": "assembly"}),
    ("tank-lorry", lorry, dict(load="tank"), {}),
    ("tractor", tractor, {}, {"structure": "compound"}),
    ("formula-car", formula, {}, {"structure": "assembly"}),
    ("digger", digger, {}, {}),
]
