"""Ways to state the same geometry differently: unions, other surface types, other face splits."""

import numpy as np
from OCP.BRepAlgoAPI import BRepAlgoAPI_Fuse, BRepAlgoAPI_Section, BRepAlgoAPI_Splitter
from OCP.BRepBuilderAPI import BRepBuilderAPI_NurbsConvert
from OCP.gp import gp_Pln
from OCP.ShapeUpgrade import ShapeUpgrade_ShapeDivideClosed
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE

from .kernel import as_list, direction, oriented, parts_of, pnt, solids_of
from .measure import bounds, fault, volume


def united(solids):
    """The union of solids as a list of solids, or None where the kernel does not make a valid one."""
    if len(solids) == 1:
        return solids
    try:
        operation = BRepAlgoAPI_Fuse()
        operation.SetArguments(as_list(solids[:1]))
        operation.SetTools(as_list(solids[1:]))
        operation.Build()
        made = operation.Shape()
    except Exception:  # the kernel's failures are exceptions of many types
        return None
    found = solids_of(made)
    largest, total = max(volume(s) for s in solids), sum(volume(s) for s in solids)
    good = found and fault(made) is None and largest * 0.999 <= sum(map(volume, found)) <= total * 1.001
    return found if good else None


def as_splines(solid):
    """The solid with every surface and curve a B-spline."""
    return oriented(BRepBuilderAPI_NurbsConvert(solid, True).Shape())


def without_seams(solid):
    """The solid with its closed faces divided in two."""
    divide = ShapeUpgrade_ShapeDivideClosed(solid)
    divide.SetNbSplitPoints(1)
    divide.Perform()
    return oriented(divide.Result())


def split_left(solid, normal, share):
    """The solid with its faces on the left (y > 0) cut by a plane across x or z at a share of the solid's extent.

    Only faces that lie wholly on the left are cut, so the right half keeps its faces: the surface is the same, the
    two halves are divided differently.
    """
    low, high = bounds(solid)
    at = low + share * (high - low)
    plane = gp_Pln(pnt(at), direction(normal))
    edges = []
    for face in parts_of(solid, TopAbs_FACE):
        if bounds(face)[0][1] > 1e-3 * np.linalg.norm(high - low):
            section = BRepAlgoAPI_Section(face, plane, False)
            section.Approximation(True)
            section.Build()
            edges += parts_of(section.Shape(), TopAbs_EDGE)
    if not edges:
        return solid
    operation = BRepAlgoAPI_Splitter()
    operation.SetArguments(as_list([solid]))
    operation.SetTools(as_list(edges))
    operation.Build()
    found = solids_of(operation.Shape())
    same = len(found) == 1 and abs(volume(found[0]) - volume(solid)) < 1e-6 * volume(solid)
    return found[0] if same else solid


def tried(change, solid, *details):
    """The changed solid where the change keeps it valid and of the same volume, otherwise the solid itself."""
    try:
        made = change(solid, *details)
        good = fault(made) is None and abs(volume(made) - volume(solid)) <= 1e-4 * volume(solid)
        return made if good else solid
    except Exception:  # the kernel's failures are exceptions of many types
        return solid
