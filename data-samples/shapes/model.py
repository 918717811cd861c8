"""A model in its natural pose: parts, where they are placed, and the symmetry they were built with.

Natural pose: x forward, y to the left (normal of the natural symmetry plane), z up; millimetres and degrees.
"""

import math
from dataclasses import dataclass, field

from OCP.BRep import BRep_Builder
from OCP.gp import gp_Trsf
from OCP.TopLoc import TopLoc_Location
from OCP.TopoDS import TopoDS_Compound

from .kernel import mirror, solids_of


@dataclass
class Part:
    """One solid and the rigid placements of its copies."""

    name: str
    solid: object
    places: list


@dataclass
class Plane:
    """A mirror plane in the natural pose; `label` is exact or partial."""

    normal: tuple
    point: tuple
    label: str


@dataclass
class Model:
    """Parts, planes and, for a body of revolution, the axis (point, direction)."""

    parts: list = field(default_factory=list)
    planes: list = field(default_factory=list)
    axis: tuple = None

    def add(self, name, shape, *places):
        """Adds a shape; with placements, one copy at each of them."""
        solids = solids_of(shape)
        for i, solid in enumerate(solids):
            own = name if len(solids) == 1 else f"{name} {i + 1}"
            self.parts.append(Part(own, solid, list(places) or [gp_Trsf()]))
        return self

    def add_pair(self, name, shape):
        """Adds a shape and its mirror image across y = 0."""
        return self.add(f"{name} left", shape).add(f"{name} right", mirror(shape))

    def plane(self, normal=(0, 1, 0), point=(0, 0, 0), label="exact"):
        """States a mirror plane."""
        self.planes.append(Plane(normal, point, label))
        return self

    def fold(self, n, phase=0.0, label="exact"):
        """States the n mirror planes through the z axis, the first with its trace at `phase` degrees from x."""
        for k in range(n):
            angle = math.radians(phase + 180.0 * k / n)
            self.plane((-math.sin(angle), math.cos(angle), 0.0), label=label)
        return self

    def placed(self):
        """All solids at their placements."""
        return [part.solid.Moved(TopLoc_Location(place)) for part in self.parts for place in part.places]


def compound(shapes):
    """A compound of shapes."""
    made, builder = TopoDS_Compound(), BRep_Builder()
    builder.MakeCompound(made)
    for shape in shapes:
        builder.Add(made, shape)
    return made
