"""From a family to a file: variant, pose, scale, STEP file, and the truth about it in the file's own pose."""

import zlib
from dataclasses import dataclass

import numpy as np
from OCP.gp import gp_Quaternion, gp_Trsf, gp_Vec
from OCP.TopLoc import TopLoc_Location

from . import measure, variants, write
from .kernel import apply, solids_of
from .model import Model, Part, compound

SCHEMAS = ("AP214", "AP203", "AP242", "AP214")
UNITS = ("mm", "mm", "inch", "m", "mm", "cm")
STRUCTURES = ("solid", "assembly", "compound", "assembly")
MOST_UNITED = 14  # more solids than this are not united into one


@dataclass
class Pose:
    """p -> scale * rotation * p + translation; the translation is in mm of the file's pose."""

    scale: float
    rotation: np.ndarray
    quaternion: tuple
    translation: np.ndarray

    def rigid(self):
        """The pose without its scale."""
        trsf = gp_Trsf()
        trsf.SetRotation(gp_Quaternion(*self.quaternion))
        trsf.SetTranslationPart(gp_Vec(*map(float, self.translation)))
        return trsf

    def point(self, p):
        """A natural point in the file's pose."""
        return self.scale * self.rotation @ np.asarray(p, float) + self.translation

    def vector(self, v):
        """A natural direction, turned, of unit length."""
        turned = self.rotation @ np.asarray(v, float)
        return turned / np.linalg.norm(turned)


def random_pose(rng, size):
    """A uniform rotation, a scale of 10^uniform(-1, 1.3) and a shift of up to twice the size."""
    q = rng.normal(size=4)
    x, y, z, w = q / np.linalg.norm(q)
    rotation = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                         [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                         [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])
    scale = float(10**rng.uniform(-1, 1.3))
    return Pose(scale, rotation, (x, y, z, w), rng.uniform(-2, 2, 3) * size * scale)


def chosen_variant(index, rng, fixed):
    """The schema, unit, structure and geometry variant of one file; `fixed` overrides some."""
    choice = {
        "schema": SCHEMAS[index % len(SCHEMAS)], "unit": UNITS[(index * 5 + index // 4) % len(UNITS)],
        "structure": STRUCTURES[(index + index // 4) % len(STRUCTURES)], "splines": bool(rng.random() < 0.2),
        "seams": bool(rng.random() < 0.7), "split": bool(rng.random() < 0.35), "pcurves": bool(rng.random() < 0.4),
        "nested": bool(rng.random() < 0.5)
    }
    return {**choice, **fixed}


def varied(model, choice, rng):
    """The model restated as the variant says; sets choice["structure"] to what became of it."""
    if choice["structure"] == "solid":
        solids = model.placed()
        united = variants.united(solids) if len(solids) <= MOST_UNITED else None
        if united is not None:
            model = Model([Part(f"body {i + 1}", s, [gp_Trsf()]) for i, s in enumerate(united)], model.planes, model.axis)
        else:
            choice["structure"] = "compound"
    count = sum(len(part.places) for part in model.parts)
    if choice["structure"] != "assembly":
        choice["structure"] = "solid" if count == 1 else "compound"
    splitting = 2
    for part in model.parts:
        if choice["split"] and splitting and len(part.places) == 1:
            normal = ((1, 0, 0), (0, 0, 1))[int(rng.integers(2))]
            before = measure.face_count(part.solid)
            part.solid = variants.tried(variants.split_left, part.solid, normal, float(rng.uniform(0.35, 0.65)))
            splitting -= measure.face_count(part.solid) > before
        if not choice["seams"]:
            part.solid = variants.tried(variants.without_seams, part.solid)
        if choice["splines"]:
            part.solid = variants.tried(variants.as_splines, part.solid)
    choice["split"] = splitting < 2
    return model


def save(model, pose, choice, path):
    """Writes the model in its pose and returns its solids as the file should have them, but for their pose."""
    scaling = gp_Trsf()
    scaling.SetScaleFactor(pose.scale)
    parts = []
    for part in model.parts:
        places = []
        for place in part.places:
            scaled = gp_Trsf().Multiplied(place)
            scaled.SetTranslationPart(gp_Vec(place.TranslationPart()).Multiplied(pose.scale))
            places.append(scaled)
        parts.append((part.name, apply(part.solid, scaling), places))
    how = (path, choice["schema"], choice["unit"], choice["pcurves"])
    if choice["structure"] == "assembly":
        write.write_assembly(parts, pose.rigid(), choice["nested"], *how)
    else:
        solids = [apply(s.Moved(TopLoc_Location(place)), pose.rigid()) for _, s, places in parts for place in places]
        write.write_shape(solids[0] if len(solids) == 1 else compound(solids), *how)
    return [s for _, s, places in parts for _ in places]


def verified(path, expected):
    """The shape read back; an error where a solid is bad or the volumes of the solids differ from those expected."""
    shape = write.read(path)
    found = solids_of(shape)
    fault = measure.fault(shape) or (len(found) != len(expected) and f"{len(found)} solids for {len(expected)}")
    for volume, slack in ((measure.volume, 1e-4), (measure.mesh_volume, 3e-3)):
        total, due = (sum(map(volume, solids)) for solids in (found, expected))
        if abs(total - due) <= slack * due:
            break
    else:
        fault = fault or f"volume {total} where {due} was expected"
    if fault:
        raise ValueError(f"{path}: {fault}")
    return shape


def truth_rows(model, pose, shape, size):
    """The rows of truth.csv of one model (without its path), natural planes carried into the file's pose."""
    extent = size * pose.scale
    rows = []
    if model.axis:
        point, along = pose.point(model.axis[0]), pose.vector(model.axis[1])
        rows.append(["revolution"] + [""] * 4 + [extent, *point, *along, ""])
    if model.planes:
        mirrors = measure.Mirrors(shape, extent)
    for plane in model.planes:
        normal = pose.vector(plane.normal)
        offset = float(normal @ pose.point(plane.point))
        rows.append([plane.label, *normal, offset, extent] + [""] * 6 + [mirrors.coverage(normal, offset)])
    return rows or [["none"] + [""] * 4 + [extent] + [""] * 7]


def frame_row(pose, low, high):
    """The natural frame in the file's pose: lateral, up, forward, and the centre of the natural bounding box."""
    axes = [pose.vector(v) for v in ((0, 1, 0), (0, 0, 1), (1, 0, 0))]
    middle = (low + high) / 2
    return [c for axis in axes for c in axis] + list(pose.point(middle))


def seeded(*words):
    """A random generator fixed by words and numbers."""
    return np.random.default_rng([zlib.crc32(str(word).encode()) for word in words])


def produce(entry, category, index, path, archive):
    """Builds, writes and verifies one file; returns its record (a plain dict)."""
    name, family, details, fixed = entry
    model = family(seeded("shape", archive, category, index), **details)
    rng = seeded("file", archive, category, index)
    choice = chosen_variant(index + zlib.crc32(category.encode()) % 7, rng, fixed)
    model = varied(model, choice, rng)
    natural = compound(model.placed())
    low, high = measure.bounds(natural)
    size = float(np.linalg.norm(high - low))
    pose = random_pose(rng, size)
    path.parent.mkdir(parents=True, exist_ok=True)
    shape = verified(path, save(model, pose, choice, path))
    return {
        "path": f"{category}/{path.name}", "category": category, **choice, "solids": len(model.placed()),
        "parts": len(model.parts), "faces": measure.face_count(shape), "bytes": path.stat().st_size,
        "truth": truth_rows(model, pose, shape, size), "frame": frame_row(pose, low, high)
    }
