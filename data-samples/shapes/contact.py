"""A contact sheet: every model of an archive, shaded, seen obliquely in its natural pose."""

import csv

import numpy as np

from . import measure, write

VIEW = np.array([0.62, 0.62, 0.48])  # from where the models are seen, in the natural frame (forward, left, up)
SIDE = 190  # pixels of one picture


def camera():
    """The right, up and towards vectors of the view."""
    towards = VIEW / np.linalg.norm(VIEW)
    right = np.cross((0, 0, 1), towards)
    right /= np.linalg.norm(right)
    return right, np.cross(towards, right), towards


def natural(triangles, frame):
    """Triangles of a file's pose in the natural frame (x forward, y left, z up)."""
    e1, e2, e3, origin = (np.array(frame[i:i + 3]) for i in (0, 3, 6, 9))
    return (triangles - origin) @ np.stack([e3, e1, e2], axis=1)


def picture(triangles):
    """A shaded image, splatting area samples into a depth buffer."""
    points, owner = measure.area_samples(triangles, 400_000, np.random.default_rng(1))
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    right, up, towards = camera()
    u, v, depth = points @ right, points @ up, points @ towards
    span = max(np.ptp(u), np.ptp(v)) * 1.06
    column = ((u - (u.max() + u.min()) / 2) / span * SIDE + SIDE / 2).astype(int).clip(0, SIDE - 1)
    row = (SIDE / 2 - (v - (v.max() + v.min()) / 2) / span * SIDE).astype(int).clip(0, SIDE - 1)
    light = towards * 0.8 + up * 0.45 - right * 0.25
    shade = 60 + 175 * np.clip(normals[owner] @ (light / np.linalg.norm(light)), 0, 1)
    image = np.full((SIDE, SIDE), 255.0)
    order = np.argsort(depth)
    image[row[order], column[order]] = shade[order]
    return image.astype(np.uint8)


def draw(out, target, only):
    """Draws all models of the archive on one sheet."""
    from PIL import Image, ImageDraw
    with open(out / "frame.csv", encoding="ascii") as file:
        rows = [row for row in csv.reader(file)][1:]
    rows = [row for row in rows if any(word in row[0] for word in only.split(","))]
    columns = min(11, len(rows))
    sheet = Image.new("L", (columns * SIDE, -(-len(rows) // columns) * (SIDE + 14)), 255)
    pen = ImageDraw.Draw(sheet)
    for k, row in enumerate(rows):
        shape = write.read(out / row[0])
        low, high = measure.bounds(shape)
        triangles = natural(measure.mesh(shape, 1e-3 * np.linalg.norm(high - low), 0.3), [float(c) for c in row[1:]])
        x, y = k % columns * SIDE, k // columns * (SIDE + 14)
        sheet.paste(Image.fromarray(picture(triangles)), (x, y + 14))
        pen.text((x + 3, y + 1), row[0].removesuffix(".step"), fill=0)
    sheet.save(target)
