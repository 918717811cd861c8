"""One shape with its known answer, in a natural pose; ways to make solids that several families use.

Lengths in millimetres, angles in degrees. Built on the kernel of data-samples.
"""

import math
import pathlib
import sys
from dataclasses import dataclass, field

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "data-samples"))

from OCP.BRepBuilderAPI import BRepBuilderAPI_Sewing  # noqa: E402
from OCP.gp import gp_Trsf  # noqa: E402
from OCP.TopAbs import TopAbs_FACE  # noqa: E402
from shapes.kernel import face_of, parts_of, polyline, sewn  # noqa: E402
from shapes.variants import as_splines  # noqa: E402


@dataclass
class Shape:
    """Named pieces with the placements of their copies, and what is known of their symmetry.

    `planes` are (normal, point). A body of revolution has `axis` (point, direction), a sphere `centre`. A `loose` body
    is closed but for what the kernel asks of seams.
    """

    pieces: list = field(default_factory=list)
    planes: list = field(default_factory=list)
    axis: tuple = None
    centre: tuple = None
    sheet: bool = False
    loose: bool = False

    def add(self, piece, *places):
        """Adds a solid or sheet, with copies at placements."""
        self.pieces.append((piece, list(places) or [gp_Trsf()]))
        return self

    def plane(self, normal, point=(0, 0, 0)):
        """States a mirror plane."""
        self.planes.append((normal, point))
        return self

    def fold(self, n, phase=0.0):
        """States the n mirror planes through the z axis, the first with its trace at `phase` degrees from x."""
        for k in range(n):
            angle = math.radians(phase + 180.0 * k / n)
            self.plane((-math.sin(angle), math.cos(angle), 0.0))
        return self

    def box(self, x=True, y=True, z=True):
        """States the planes across the coordinate axes."""
        for wanted, normal in ((x, (1, 0, 0)), (y, (0, 1, 0)), (z, (0, 0, 1))):
            if wanted:
                self.plane(normal)
        return self


def regular(n, r, phase=0.0, z=0.0):
    """Corners of a regular polygon."""
    angles = [math.radians(phase + 360.0 * k / n) for k in range(n)]
    return [(r * math.cos(a), r * math.sin(a), z) for a in angles]


def extruded(points, height):
    """A prism over a polygon of (x, y), symmetric about z = 0."""
    from shapes.kernel import prism
    return prism(polyline([(x, y, -height / 2) for x, y, *_ in points]), (0, 0, height))


def polyhedron(faces):
    """A solid from lists of corners."""
    return sewn([face_of(polyline([tuple(map(float, p)) for p in face])) for face in faces])


def hull(points):
    """The convex hull of points as a solid, coplanar triangles joined."""
    from scipy.spatial import ConvexHull
    points = np.asarray(points, float)
    found = ConvexHull(points)
    groups = {}
    for simplex, equation in zip(found.simplices, found.equations):
        groups.setdefault(tuple(np.round(equation, 6)), set()).update(simplex)
    faces = []
    for equation, members in groups.items():
        normal, corners = np.array(equation[:3]), points[sorted(members)]
        centre = corners.mean(axis=0)
        x = (corners[0] - centre) / np.linalg.norm(corners[0] - centre)
        y = np.cross(normal, x)
        order = np.argsort(np.arctan2((corners - centre) @ y, (corners - centre) @ x))
        faces.append(corners[order])
    return polyhedron(faces)


def faces_of(shape):
    """The faces of a shape."""
    return parts_of(shape, TopAbs_FACE)


def joined(faces, tolerance=1e-4):
    """An open shell sewn from faces."""
    sewing = BRepBuilderAPI_Sewing(tolerance)
    for face in faces:
        sewing.Add(face)
    sewing.Perform()
    return sewing.SewedShape()


def halved(solid, change=as_splines, reach=1e4):
    """The solid made of its two halves left and right of y = 0, the left one's faces changed; one closed shell."""
    from shapes.kernel import box, cut
    from shapes.measure import bounds
    left = change(cut(solid, box((reach, reach, reach), (0, -reach / 2, 0))))
    right = cut(solid, box((reach, reach, reach), (0, reach / 2, 0)))
    size = np.linalg.norm(np.subtract(*bounds(solid)))

    def outside(face):
        low, high = bounds(face)
        return max(abs(low[1]), abs(high[1])) > 1e-6 * size
    return sewn([f for half in (left, right) for f in faces_of(half) if outside(f)], 1e-6 * size)


def beside(solid, change=as_splines, reach=1e4):
    """The two halves as two touching solids, the left one changed."""
    from shapes.kernel import box, cut
    left = change(cut(solid, box((reach, reach, reach), (0, -reach / 2, 0))))
    return left, cut(solid, box((reach, reach, reach), (0, reach / 2, 0)))
