"""Bodies of flat faces: prisms, pyramids, regular solids, plates, and bodies without any mirror plane."""

import itertools
import math

import numpy as np
from shape import Shape, extruded, hull, regular
from shapes.kernel import box, cut, fuse, move, rod, rotate

GOLDEN = (1 + math.sqrt(5)) / 2


def cuboid(rng):
    return Shape().add(box((10 * rng.uniform(.9, 1.1), 17, 31))).box()


def cube(rng):
    return cubic(Shape().add(box((20, 20, 20))))


def cubic(shape):
    """States the nine planes of a cube."""
    for i, j in ((0, 1), (0, 2), (1, 2)):
        for sign in (1, -1):
            normal = [0, 0, 0]
            normal[i], normal[j] = 1, sign
            shape.plane(tuple(normal))
    return shape.box()


def square_prism(rng):
    return Shape().add(box((14, 14, 30 * rng.uniform(.9, 1.2)))).fold(4).plane((0, 0, 1))


def regular_prism(rng, n):
    return Shape().add(extruded(regular(n, 20), 12 * rng.uniform(.8, 1.3))).fold(n).plane((0, 0, 1))


def star(rng, n, depth=.8):
    """A star-shaped prism of n points."""
    inner = 30 * depth * rng.uniform(.95, 1.05)
    points = [p for k in range(n) for p in (regular(n, 30)[k], regular(n, inner, 180 / n)[k])]
    return Shape().add(extruded(points, 9)).fold(n).plane((0, 0, 1))


def pyramid(rng, n):
    base = regular(n, 15)
    return Shape().add(hull(base + [(0, 0, 22 * rng.uniform(.8, 1.3))])).fold(n)


def antiprism(rng, n):
    low, high = regular(n, 15, 0, -8), regular(n, 15, 180 / n, 8 * rng.uniform(.9, 1.2))
    return Shape().add(hull(low + high)).fold(n)


def twisted_prism(rng, n=4):
    """The hull of a polygon and one turned by a general angle: rotations only."""
    turned = regular(n, 15, rng.uniform(.2, .35) * 180 / n, 12)
    return Shape().add(hull(regular(n, 15, 0, -12) + turned))


def tetrahedron(rng):
    corners = [(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)]
    shape = Shape().add(hull([tuple(12 * c for c in p) for p in corners]))
    for i, j in itertools.combinations(range(4), 2):
        shape.plane(tuple(a - b for a, b in zip(corners[i], corners[j])))
    return shape


def octahedron(rng):
    axes = [tuple(s * 15 * (i == k) for i in range(3)) for k in range(3) for s in (1, -1)]
    return cubic(Shape().add(hull(axes)))


def icosahedral(shape):
    """States the fifteen planes across the edges' directions."""
    base = [(1, 0, 0)] + [(a / 2, b * GOLDEN / 2, c / GOLDEN / 2) for a, b, c in itertools.product((1,), (1, -1), (1, -1))]
    for x, y, z in base:
        for normal in {(x, y, z), (y, z, x), (z, x, y)}:
            shape.plane(normal)
    return shape


def icosahedron(rng):
    points = [p for a, b in itertools.product((1, -1), (1, -1)) for p in ((0, b * GOLDEN, a), (b * GOLDEN, a, 0), (a, 0, b * GOLDEN))]
    return icosahedral(Shape().add(hull([tuple(10 * c for c in p) for p in points])))


def dodecahedron(rng):
    points = list(itertools.product((1, -1), repeat=3))
    for a, b in itertools.product((1, -1), (1, -1)):
        points += [(0, a / GOLDEN, b * GOLDEN), (a / GOLDEN, b * GOLDEN, 0), (b * GOLDEN, 0, a / GOLDEN)]
    return icosahedral(Shape().add(hull([tuple(10 * c for c in p) for p in points])))


def wedge(rng):
    """A prism over a scalene triangle: one plane between its lids."""
    return Shape().add(extruded([(0, 0), (20, 0), (6, 11 * rng.uniform(.8, 1.2))], 9)).plane((0, 0, 1))


def trapezium(rng):
    w = 7 * rng.uniform(.8, 1.2)
    return Shape().add(extruded([(-12, 0), (12, 0), (w, 10), (-w, 10)], 15)).box(y=False)


def rhombus(rng):
    h = 9 * rng.uniform(.7, 1.2)
    return Shape().add(extruded([(14, 0), (0, h), (-14, 0), (0, -h)], 8)).box()


def parallelogram(rng):
    """A prism over a parallelogram: half turns, and one plane between its lids."""
    d = 5 * rng.uniform(.7, 1.2)
    return Shape().add(extruded([(-12, -6), (8, -6), (8 + d, 6), (-12 + d, 6)], 11)).plane((0, 0, 1))


def parallelepiped(rng):
    """Symmetric about its centre only."""
    skew = np.array([[22, 0, 0], [6 * rng.uniform(.8, 1.2), 15, 0], [4, 5, 12]])
    return Shape().add(hull([np.array(c) @ skew for c in itertools.product((-.5, .5), repeat=3)]))


def irregular_tetrahedron(rng):
    return Shape().add(hull([(0, 0, 0), (20, 0, 0), (5, 15 * rng.uniform(.9, 1.1), 0), (8, 4, 11)]))


def angle_profile(rng, equal):
    a, b = 24, 24 if equal else 15 * rng.uniform(.9, 1.1)
    shape = Shape().add(extruded([(0, 0), (a, 0), (a, 4), (4, 4), (4, b), (0, b)], 40)).plane((0, 0, 1))
    return shape.plane((1, -1, 0)) if equal else shape


def z_profile(rng):
    t = 4 * rng.uniform(.8, 1.2)
    outline = [(-t / 2, -12), (14, -12), (14, -12 + t), (t / 2, -12 + t), (t / 2, 12), (-14, 12), (-14, 12 - t), (-t / 2, 12 - t)]
    return Shape().add(extruded(outline, 30)).plane((0, 0, 1))


def pinwheel(rng, n=5):
    """A plate of n slanting arms: rotations, and one plane between its lids."""
    lean = rng.uniform(.35, .5) * 360 / n
    points = [p for k in range(n) for p in (regular(n, 10)[k], regular(n, 28, lean)[k])]
    return Shape().add(extruded(points, 6)).plane((0, 0, 1))


def three_notches(rng):
    """A box with three unlike notches at three unlike edges: none."""
    solid = cut(box((30, 24, 18)), box((12, 10, 8), (15, 12, 9)), box((9, 14, 6), (-15, -12, 4)), box((7, 8, 10), (-9, 12, -9 * rng.uniform(.9, 1.05))))
    return Shape().add(solid)


def quartz(rng):
    """A hexagonal prism whose lids are cut by facets that all lean the same way: rotations only."""
    solid = extruded(regular(6, 15), 44)
    for turned in (0, 180):
        for k in range(3):
            facet = rotate(box((40, 40, 40), (0, 0, 20)), 38, (1, 0, 0))
            facet = rotate(move(facet, 0, -6, 14 * rng.uniform(.999, 1.001)), 120 * k + 14)
            solid = cut(solid, rotate(facet, turned, (1, 0, 0)))
    return Shape().add(solid)


def staircase(rng):
    solid = box((10, 30, 5), (5, 0, 2.5))
    for k in range(1, 5):
        solid = fuse(solid, box((10, 30, 5 * (k + 1)), (10 * k + 5, 0, 2.5 * (k + 1))))
    return Shape().add(solid).plane((0, 1, 0))


def perforated(rng, rows, columns):
    """A plate with a grid of holes: congruent faces in large numbers."""
    a, b = 8, 8 * rng.uniform(1.1, 1.3)
    drills = [rod((a * (i - (columns - 1) / 2), b * (j - (rows - 1) / 2), -5), (a * (i - (columns - 1) / 2), b * (j - (rows - 1) / 2), 5), 2.2)
              for i in range(columns) for j in range(rows)]
    return Shape().add(cut(box((a * columns + 5, b * rows + 5, 4)), *drills)).box()


def comb(rng, teeth):
    """A row of equal pins on a bar, one end longer: two planes."""
    solid = box((6 * teeth, 5, 4), (0, 0, 2))
    pins = [box((2, 2, 12), (6 * (k - (teeth - 1) / 2), 0, 9)) for k in range(teeth)]
    return Shape().add(fuse(solid, *pins)).box(z=False)


ENTRIES = [
    ("box", cuboid, {}), ("cube", cube, {}), ("square-prism", square_prism, {}),
    *[(f"prism-{n}", regular_prism, {"n": n}) for n in (3, 5, 6, 7, 8, 12)],
    *[(f"star-{n}", star, {"n": n, "depth": d}) for n, d in ((2, .3), (3, .5), (4, .6), (5, .5), (9, .7), (72, .95))],
    ("pyramid-4", pyramid, {"n": 4}), ("pyramid-5", pyramid, {"n": 5}), ("antiprism-4", antiprism, {"n": 4}),
    ("tetrahedron", tetrahedron, {}), ("octahedron", octahedron, {}), ("icosahedron", icosahedron, {}),
    ("dodecahedron", dodecahedron, {}), ("wedge", wedge, {}), ("trapezium", trapezium, {}),
    ("rhombic-prism", rhombus, {}), ("parallelogram-prism", parallelogram, {}), ("angle-equal", angle_profile, {"equal": True}),
    ("angle-unequal", angle_profile, {"equal": False}), ("z-profile", z_profile, {}), ("pinwheel-5", pinwheel, {}),
    ("staircase", staircase, {}), ("plate-of-holes", perforated, {"rows": 4, "columns": 6}), ("comb", comb, {"teeth": 8}),
    ("twisted-prism-4", twisted_prism, {}), ("twisted-prism-6", twisted_prism, {"n": 6}), ("parallelepiped", parallelepiped, {}),
    ("irregular-tetrahedron", irregular_tetrahedron, {}), ("three-notches", three_notches, {}), ("quartz", quartz, {}),
]
