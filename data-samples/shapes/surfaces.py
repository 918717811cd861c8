"""Free-form solids built from their control nets: skins over ellipses, tubes, wings, hulls.

The nets are mirror images of themselves where the sections are, so a symmetric body is symmetric to rounding.
Lengths in millimetres, angles in degrees.
"""

import math

import numpy as np
from OCP import collections as occ
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
from OCP.Geom import Geom_BSplineSurface

from .kernel import loft, mirror, pnt, sewn, spline_edge, wire_of

ROUND = math.sqrt(0.5)  # weight of a corner control point that makes a quarter arc circular

# ---- B-spline surfaces -------------------------------------------------------------------------------------


def clamped_knots(params, degree):
    """The averaged clamped knot vector for interpolation at the parameters."""
    n = len(params)
    inner = [sum(params[j:j + degree]) / degree for j in range(1, n - degree)]
    return [params[0]] * (degree + 1) + inner + [params[-1]] * (degree + 1)


def basis(knots, degree, count, t):
    """The values at t of all B-spline basis functions."""
    last = max(i for i in range(len(knots) - 1) if knots[i] < knots[i + 1])
    values = [
        1.0 if (knots[i] <= t < knots[i + 1]) or (i == last and t == knots[i + 1]) else 0.0 for i in range(len(knots) - 1)
    ]
    for d in range(1, degree + 1):
        values = [(values[i] * (t - knots[i]) / (knots[i + d] - knots[i]) if knots[i + d] > knots[i] else 0.0) +
                  (values[i + 1] * (knots[i + d + 1] - t) /
                   (knots[i + d + 1] - knots[i + 1]) if knots[i + d + 1] > knots[i + 1] else 0.0)
                  for i in range(len(values) - 1)]
    return values[:count]


def interpolating_rows(rows, params):
    """Control points, degree and knots of the columns of splines through `rows` (stations x columns x 3)."""
    degree = min(3, len(params) - 1)
    knots = clamped_knots(params, degree)
    matrix = np.array([basis(knots, degree, len(params), t) for t in params])
    flat = np.linalg.solve(matrix, rows.reshape(len(params), -1))
    return flat.reshape(rows.shape), degree, knots


def split_knots(knots):
    """Distinct knots and their multiplicities."""
    distinct = sorted(set(knots))
    return distinct, [knots.count(k) for k in distinct]


def array1(kind, values):
    """An OCCT array from a list."""
    array = kind(1, len(values))
    for i, value in enumerate(values):
        array.SetValue(i + 1, value)
    return array


def surface_face(net, weights, udegree, uknots, vdegree, vknots):
    """A face on the B-spline surface of a control net; `weights` has one value per column, or is None."""
    rows, columns = net.shape[:2]
    poles, weight = occ.Array2_gp_Pnt(1, rows, 1, columns), occ.Array2_double(1, rows, 1, columns)
    for i in range(rows):
        for j in range(columns):
            poles.SetValue(i + 1, j + 1, pnt(net[i, j]))
            weight.SetValue(i + 1, j + 1, 1.0 if weights is None else weights[j])
    (u, um), (v, vm) = split_knots(uknots), split_knots(vknots)
    knots = (array1(occ.Array1_double, u), array1(occ.Array1_double,
                                                  v), array1(occ.Array1_int, um), array1(occ.Array1_int, vm), udegree, vdegree)
    surface = Geom_BSplineSurface(poles, *knots) if weights is None else Geom_BSplineSurface(poles, weight, *knots)
    return BRepBuilderAPI_MakeFace(surface, 1e-6).Face()


# ---- skins over elliptic sections --------------------------------------------------------------------------


def chord_params(points):
    """Chord-length parameters in [0, 1] of a list of points."""
    steps = [math.dist(a, b) for a, b in zip(points, points[1:])]
    total = sum(steps)
    return [0.0] + [sum(steps[:i + 1]) / total for i in range(len(steps) - 1)] + [1.0]


def mean_chord_params(rows):
    """Parameters in [0, 1] from the mean chord of the columns: steps that only widen a section count too."""
    steps = np.linalg.norm(np.diff(rows, axis=0), axis=2).mean(axis=1)
    return [0.0] + list(np.cumsum(steps)[:-1] / steps.sum()) + [1.0]


def half_columns(centre, side, up, down, sign):
    """Five control points of the half section on one side: top, corner, side, corner, bottom."""
    c, s, u, d = (np.asarray(x, float) for x in (centre, side, up, down))
    return [c + u, c + u + sign * s, c + sign * s, c + d + sign * s, c + d]


def skin(sections, square=0.0):
    """A solid over sections (centre, side vector, up vector, down vector).

    A section is a closed oval: top at centre + up, sides at centre +- side, bottom at centre + down. Ends of zero
    size become poles, others flat caps. `square` in [0, 1) fills the corners of the ovals.
    """
    sections = [(s[0], s[1], s[2], s[3] if len(s) > 3 else [-c for c in s[2]]) for s in sections]
    weights = [1.0, ROUND + square * 3, 1.0, ROUND + square * 3, 1.0]
    both = [np.array([half_columns(*s, sign) for s in sections]) for sign in (1, -1)]
    params = mean_chord_params(np.concatenate(both, axis=1))
    faces = []
    for rows in both:
        net, degree, knots = interpolating_rows(rows, params)
        faces.append(surface_face(net, weights, degree, knots, 2, [0, 0, 0, 0.5, 0.5, 1, 1, 1]))
    for end in (sections[0], sections[-1]):
        if np.linalg.norm(end[1]) > 1e-9:
            faces.append(section_cap(end, weights))
    return sewn(faces)


def section_cap(section, weights):
    """The flat face inside a section: a surface ruled between its two halves."""
    halves = [half_columns(*section, sign) for sign in (1, -1)]
    return surface_face(np.array(halves), weights, 1, [0, 0, 1, 1], 2, [0, 0, 0, 0.5, 0.5, 1, 1, 1])


def fuselage(stations, square=0.0, axis="x"):
    """A skin along an axis from stations (position, half width, half height up, centre height[, half height down]).

    A station of half width 0 is a pole.
    """
    place = {"x": lambda a, y, z: (a, y, z), "z": lambda a, y, z: (z, y, a), "y": lambda a, y, z: (y, a, z)}[axis]
    sections = []
    for at, width, up, height, *down in stations:
        below = down[0] if down else up
        sections.append((place(at, 0, height), place(0, width, 0), place(0, 0, up), place(0, 0, -below)))
    return skin(sections, square)


def ellipsoid(at, radii, tilt=0.0):
    """An ellipsoid; `tilt` raises its long x axis by an angle about y."""
    x, y, z = at
    rx, ry, rz = radii
    cos, sin = math.cos(math.radians(tilt)), math.sin(math.radians(tilt))
    sections = []
    for angle in (-90, -72, -50, -25, 0, 25, 50, 72, 90):
        a, r = math.sin(math.radians(angle)), math.cos(math.radians(angle)) if abs(angle) < 90 else 0.0
        sections.append(((x + rx * a * cos, y, z + rx * a * sin), (0, ry * r, 0), (-rz * r * sin, 0, rz * r * cos)))
    return skin(sections)


def limb(points, radii, side=(0, 1, 0), flat=1.0):
    """A tapered round tube through points with a radius at each; `side` is a vector not along the path.

    `flat` scales the half height against the half width. A radius of 0 at an end makes a pole.
    """
    path = np.array(points, float)
    sections = []
    for i, (p, r) in enumerate(zip(path, radii)):
        tangent = path[min(i + 1, len(path) - 1)] - path[max(i - 1, 0)]
        tangent /= np.linalg.norm(tangent)
        across = np.asarray(side, float) - np.dot(side, tangent) * tangent
        across /= np.linalg.norm(across)
        up = np.cross(across, tangent)
        sections.append((p, across * r, up * r * flat))
    return skin(sections)


# ---- wings -------------------------------------------------------------------------------------------------

AIRFOIL = [(1.0, 0.0), (0.7, 0.42), (0.3, 0.95), (0.08, 0.62), (0.0, 0.0), (0.08, -0.45), (0.3, -0.6), (0.7, -0.22), (1.0, 0.0)]


def airfoil(leading, chord, thick, up=(0, 0, 1), twist=0.0):
    """A closed airfoil wire from the leading edge backwards (-x); `thick` is about half its thickness.

    It is cambered, except where it stands upright (up along y): a fin is symmetric.
    """
    shape = [(c, abs(h) if i < 4 else -abs(AIRFOIL[8 - i][1])) for i, (c, h) in enumerate(AIRFOIL)] if up[1] else AIRFOIL
    cos, sin = math.cos(math.radians(twist)), math.sin(math.radians(twist))
    back = np.array((-cos, 0, 0)) + sin * np.asarray(up, float)
    lift = np.asarray(up, float) * cos + np.array((sin, 0, 0))
    points = [np.asarray(leading, float) + back * c * chord + lift * h * thick for c, h in shape]
    return wire_of(spline_edge(points[:5]), spline_edge(points[4:]))


def wing(root, root_chord, tip, tip_chord, thick, tip_thick=None, up=(0, 0, 1), twist=0.0):
    """A ruled wing from the leading edge of its root to that of its tip; chords run backwards (-x)."""
    tip_thick = thick * tip_chord / root_chord if tip_thick is None else tip_thick
    return loft([airfoil(root, root_chord, thick, up), airfoil(tip, tip_chord, tip_thick, up, twist)])


def pair(shape):
    """The shape and its mirror image across y = 0."""
    return [shape, mirror(shape)]


# ---- hulls -------------------------------------------------------------------------------------------------


def hull_skin(stations, params):
    """The faces of a hull without its deck, the control nets of its two halves, their degree and knots along x."""
    halves, nets = [], []
    for sign in (1, -1):
        rows = np.array([[(x, sign * b, deck), (x, sign * b * (0.7 + 0.3 * full), keel + (deck - keel) * (0.55 - 0.5 * full)),
                          (x, sign * b * (0.25 + 0.65 * full), keel), (x, 0, keel)] for x, b, deck, keel, full in stations])
        net, degree, knots = interpolating_rows(rows, params)
        nets.append(net)
        halves.append(surface_face(net, None, degree, knots, 3, [0] * 4 + [1] * 4))
    if stations[0][1] > 0:
        stern = np.stack([nets[0][0], nets[1][0]])
        halves.append(surface_face(stern, None, 1, [0, 0, 1, 1], 3, [0] * 4 + [1] * 4))
    return halves, nets, degree, knots


def hull(stations):
    """A boat hull from stations (x, half beam, deck height, keel height, fullness), stern first.

    `fullness` in [0, 1] goes from a V to a U section. A station of half beam 0 is a stem on the centre plane. The
    deck is ruled between the sheer lines, a stern with a beam is closed by a flat transom.
    """
    faces, nets, degree, knots = hull_skin(stations, chord_params([(s[0], 0, 0) for s in stations]))
    sheer = np.stack([nets[0][:, 0], nets[1][:, 0]], axis=1)
    return sewn(faces + [surface_face(sheer, None, degree, knots, 1, [0, 0, 1, 1])])


def open_hull(outer, inner):
    """An open boat between two hulls of as many stations each, joined by a gunwale."""
    params = chord_params([(s[0], 0, 0) for s in outer])
    (faces, nets, degree, knots), (inside, cores, _, _) = hull_skin(outer, params), hull_skin(inner, params)
    faces = faces + inside
    for net, core in zip(nets, cores):
        rail = np.stack([net[:, 0], core[:, 0]], axis=1)
        faces.append(surface_face(rail, None, degree, knots, 1, [0, 0, 1, 1]))
    if outer[0][1] > 0:
        top = np.array([[nets[0][0, 0], nets[1][0, 0]], [cores[0][0, 0], cores[1][0, 0]]])
        faces.append(surface_face(top, None, 1, [0, 0, 1, 1], 1, [0, 0, 1, 1]))
    return sewn(faces)
