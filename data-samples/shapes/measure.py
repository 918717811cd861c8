"""Measures of shapes: validity, volume, size, meshes, and how much of a surface a mirror maps onto itself."""

import numpy as np
from OCP.Bnd import Bnd_Box
from OCP.BRep import BRep_Tool
from OCP.BRepBndLib import BRepBndLib
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepGProp import BRepGProp
from OCP.BRepMesh import BRepMesh_IncrementalMesh
from OCP.GProp import GProp_GProps
from OCP.gp import gp_Pnt
from OCP.TopAbs import TopAbs_FACE, TopAbs_REVERSED, TopAbs_SHELL
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS
from scipy.spatial import cKDTree

from .kernel import parts_of, solids_of

NEAR = 1e-3  # a mirrored sample this close to the surface (relative to the size) counts as covered


def volume(shape):
    """The volume in mm^3, integrated about the middle of the shape (far from it the kernel loses digits).

    The kernel's integration may be a few percent off for rational surfaces.
    """
    low, high = rough_bounds(shape)
    properties = GProp_GProps(gp_Pnt(*(float(c) for c in (low + high) / 2)))
    BRepGProp.VolumeProperties_s(shape, properties)
    return properties.Mass()


def mesh_volume(shape):
    """The volume in mm^3 inside a mesh of the shape, good to about one in a thousand."""
    low, high = rough_bounds(shape)
    t = mesh(shape, 1e-3 * float(np.linalg.norm(high - low))) - (low + high) / 2
    return float(np.einsum("ij,ij->", t[:, 0], np.cross(t[:, 1], t[:, 2]))) / 6


def rough_bounds(shape):
    """The corners of a box around the shape, with tolerances and control points."""
    box = Bnd_Box()
    BRepBndLib.Add_s(shape, box, False)
    low, high = box.CornerMin(), box.CornerMax()
    return np.array([low.X(), low.Y(), low.Z()]), np.array([high.X(), high.Y(), high.Z()])


def fault(shape):
    """What is wrong with a shape, or None: every solid valid, closed and of positive volume."""
    solids = solids_of(shape)
    if not solids:
        return "no solid"
    for solid in solids:
        if not BRepCheck_Analyzer(solid).IsValid():
            return "invalid solid"
        if not all(BRep_Tool.IsClosed_s(shell) for shell in parts_of(solid, TopAbs_SHELL)):
            return "open shell"
        if volume(solid) <= 0:
            return "volume not positive"
    return None


def bounds(shape):
    """The corners of the axis-aligned bounding box, without tolerance."""
    box = Bnd_Box()
    BRepBndLib.AddOptimal_s(shape, box, False, False)
    low, high = box.CornerMin(), box.CornerMax()
    return np.array([low.X(), low.Y(), low.Z()]), np.array([high.X(), high.Y(), high.Z()])


def face_count(shape):
    """The number of faces, counting every placement."""
    return len(parts_of(shape, TopAbs_FACE))


def mesh(shape, deflection, angle=0.25):
    """The triangles (n, 3, 3) of a shape meshed to a deflection in mm, oriented outwards."""
    BRepMesh_IncrementalMesh(shape, deflection, False, angle, False)
    found = []
    for face in parts_of(shape, TopAbs_FACE):
        place = TopLoc_Location()
        triangulation = BRep_Tool.Triangulation_s(TopoDS.Face(face), place)
        if triangulation is None:
            continue
        trsf = place.Transformation()
        nodes = [triangulation.Node(i + 1).Transformed(trsf) for i in range(triangulation.NbNodes())]
        points = np.array([(p.X(), p.Y(), p.Z()) for p in nodes])
        corners = np.array([triangulation.Triangle(i + 1).Get() for i in range(triangulation.NbTriangles())]) - 1
        triangles = points[corners]
        found.append(triangles[:, ::-1] if face.Orientation() == TopAbs_REVERSED else triangles)
    return np.concatenate(found)


def area_samples(triangles, count, rng):
    """Random points uniform in area, and the triangle of each."""
    areas = np.linalg.norm(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), axis=1) / 2
    chosen = rng.choice(len(triangles), count, p=areas / areas.sum())
    a, b = rng.random(count), rng.random(count)
    over = a + b > 1
    a[over], b[over] = 1 - a[over], 1 - b[over]
    t = triangles[chosen]
    return t[:, 0] + a[:, None] * (t[:, 1] - t[:, 0]) + b[:, None] * (t[:, 2] - t[:, 0]), chosen


def segment_distance(p, a, b):
    """The distances of points to segments, row by row."""
    ab = b - a
    t = np.einsum("ij,ij->i", p - a, ab) / np.maximum(np.einsum("ij,ij->i", ab, ab), 1e-300)
    return np.linalg.norm(p - a - np.clip(t, 0, 1)[:, None] * ab, axis=1)


def triangle_distance(p, triangles):
    """The distances of points to triangles, row by row."""
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    normal = np.cross(b - a, c - a)
    length = np.maximum(np.linalg.norm(normal, axis=1), 1e-300)
    inside = np.ones(len(p), bool)
    for s, e in ((a, b), (b, c), (c, a)):
        inside &= np.einsum("ij,ij->i", np.cross(e - s, p - s), normal) >= 0
    edges = np.minimum(np.minimum(segment_distance(p, a, b), segment_distance(p, b, c)), segment_distance(p, c, a))
    return np.where(inside, np.abs(np.einsum("ij,ij->i", p - a, normal)) / length, edges)


class Mirrors:
    """Tests mirror planes of one shape on a fine mesh, in units of its size (the bounding box diagonal)."""

    def __init__(self, shape, size, samples=8000, dense=120000):
        """Meshes the shape; the reference samples are drawn with a fixed seed."""
        rng = np.random.default_rng(7)
        self.size = size
        self.triangles = mesh(shape, 2.5e-4 * size, 0.1)
        self.tests, _ = area_samples(self.triangles, samples, rng)
        points, owner = area_samples(self.triangles, dense, rng)
        centres = self.triangles.mean(axis=1)
        self.low, self.high = self.triangles.min(axis=1), self.triangles.max(axis=1)
        self.owner = np.concatenate([owner, np.arange(len(centres))])
        self.tree = cKDTree(np.concatenate([points, centres]))

    def coverage(self, normal, offset, samples=None):
        """The share of the surface whose mirror image lies on the surface within NEAR, from all or the first samples."""
        tests = self.tests[:samples]
        normal = np.asarray(normal, float)
        image = tests - 2 * (tests @ normal - offset)[:, None] * normal
        gap = np.full(len(image), np.inf)
        near, index = self.tree.query(image, k=24, distance_upper_bound=0.05 * self.size)
        for k in range(24):
            left = (gap > NEAR * self.size) & np.isfinite(near[:, k])
            if left.any():
                gap[left] = np.minimum(gap[left], triangle_distance(image[left], self.triangles[self.owner[index[left, k]]]))
        left = np.flatnonzero(gap > NEAR * self.size)
        if len(left) < 0.05 * len(image):
            gap[left] = [self.exact_distance(p) for p in image[left]]
        return float((gap <= NEAR * self.size).mean())

    def exact_distance(self, p):
        """The distance of a point to the surface where it is within NEAR, found among all triangles."""
        slack = NEAR * self.size
        near = np.flatnonzero(((self.low <= p + slack) & (self.high >= p - slack)).all(axis=1))
        return triangle_distance(np.broadcast_to(p, (len(near), 3)), self.triangles[near]).min(initial=np.inf)
