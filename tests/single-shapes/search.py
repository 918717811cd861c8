"""Mirror planes of a shape by brute force on samples of OpenCASCADE's mesh: no faces, no corners, nothing of symalign.

A plane that maps (nearly) all of a surface onto itself passes (nearly) through its centroid. So every direction of a
fine grid over the hemisphere is tried through the centroid, and the best are improved in all three degrees of freedom.
"""

import numpy as np
from scipy.optimize import minimize
from shapes import measure

DIRECTIONS, SAMPLES, IMPROVED = 3000, 250, 40
CAP = 0.03  # distances count up to this share of the size
EXACT = 0.999
ANGLE, OFFSET = 0.35, 2e-3  # planes this near (degrees, share of the size) are the same


def numbers(row, *keys):
    """Some columns of a row as an array."""
    return np.array([float(row[key]) for key in keys])


def is_known(normal, offset, rows, size, slack=1.0):
    """Whether a row states the plane."""
    for row in rows:
        if row["nx"]:
            other, sign = numbers(row, "nx", "ny", "nz"), 1.0
            sign = np.sign(other @ normal) or 1.0
            angle = np.degrees(np.arccos(min(1.0, abs(other @ normal))))
            if angle < slack * ANGLE and abs(sign * float(row["offset_mm"]) - offset) < slack * OFFSET * size:
                return True
        elif row["axis_px"]:
            point = numbers(row, "axis_px", "axis_py", "axis_pz")
            through = abs(normal @ point - offset) < slack * OFFSET * size
            along = row["axis_dx"] and abs(normal @ numbers(row, "axis_dx", "axis_dy", "axis_dz"))
            if through and (row["label"] == "sphere" or along < np.radians(slack * ANGLE)):
                return True
    return False


def hemisphere(count):
    """Directions spread evenly over half a sphere (Fibonacci lattice)."""
    z = (np.arange(count) + 0.5) / count
    angle = np.arange(count) * np.pi * (3 - np.sqrt(5))
    r = np.sqrt(1 - z * z)
    return np.stack([r * np.cos(angle), r * np.sin(angle), z], axis=1)


def candidates(mirrors):
    """Planes (normal, offset) that locally map most samples near the surface, improved."""
    areas = np.linalg.norm(np.cross(mirrors.triangles[:, 1] - mirrors.triangles[:, 0], mirrors.triangles[:, 2] - mirrors.triangles[:, 0]), axis=1)
    centre = (mirrors.triangles.mean(axis=1) * areas[:, None]).sum(axis=0) / areas.sum()
    size, tests = mirrors.size, mirrors.tests - centre

    def cost(normal, offset, count):
        p = tests[:count]
        image = p - 2 * (p @ normal - offset)[:, None] * normal + centre
        return np.minimum(mirrors.tree.query(image, distance_upper_bound=CAP * size)[0], CAP * size).mean() / size
    directions = hemisphere(DIRECTIONS)
    costs = np.array([cost(n, 0.0, SAMPLES) for n in directions])
    found = []
    for i in np.argsort(costs, kind="stable"):
        if len(found) < IMPROVED and all(abs(n @ directions[i]) < np.cos(np.radians(3)) for n in found):
            found.append(directions[i])
    for n in found:
        x = np.cross(n, np.eye(3)[np.argmin(abs(n))])
        x /= np.linalg.norm(x)
        y = np.cross(n, x)
        bent = lambda p: (n + p[0] * x + p[1] * y) / np.linalg.norm(n + p[0] * x + p[1] * y)
        start = np.array([[0, 0, 0], [.03, 0, 0], [0, .03, 0], [0, 0, .01]])
        best = minimize(lambda p: cost(bent(p), p[2] * size, 600), start[0], method="Nelder-Mead",
                        options={"initial_simplex": start, "maxfev": 160, "xatol": 1e-5, "fatol": 1e-7})
        normal = bent(best.x)
        yield normal, best.x[2] * size + normal @ centre


def faults(shape, rows):
    """What a file contradicts, as sentences."""
    size = float(rows[0]["size_mm"])
    mirrors, found, best = measure.Mirrors(shape, size), [], 0.0
    for row in rows:
        if row["nx"]:
            share, stated = mirrors.coverage(numbers(row, "nx", "ny", "nz"), float(row["offset_mm"])), float(row["coverage"])
            best = max(best, share)
            if (row["label"] == "exact") != (share >= EXACT) or abs(share - stated) > 5e-3:
                found.append(f"{row['label']} plane covers {share:.4f}, stated {stated:.4f}")
    turned = [row for row in rows if row["axis_px"]]
    for row in turned:
        point = numbers(row, "axis_px", "axis_py", "axis_pz")
        along = numbers(row, "axis_dx", "axis_dy", "axis_dz") if row["axis_dx"] else np.array([.48, .6, .64])
        for other in np.eye(3):
            normal = np.cross(along, other)
            normal /= np.linalg.norm(normal)
            if mirrors.coverage(normal, normal @ point) < EXACT:
                found.append("a plane through the axis is not exact")
    needed = 0.95 * (1.0 if turned else best) if rows[0]["label"] != "none" else 0.5
    seen = []
    for normal, offset in candidates(mirrors):
        near = any(abs(n @ normal) > np.cos(np.radians(1)) for n in seen)
        if near or is_known(normal, offset, rows, size, 8.0) or mirrors.coverage(normal, offset, 300) < needed - .05:
            continue
        seen.append(normal)
        share = mirrors.coverage(normal, offset)
        if share >= needed:
            found.append(f"unlisted plane {np.round(normal, 4)} at {offset:.5g} covers {share:.4f}")
    return found
