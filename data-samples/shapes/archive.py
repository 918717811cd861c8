"""The tables beside the models: labels, truth, frames, and the table inside README.md."""

import csv

TRUTH = [
    "path", "label", "nx", "ny", "nz", "offset_mm", "size_mm", "axis_px", "axis_py", "axis_pz", "axis_dx", "axis_dy", "axis_dz",
    "coverage"
]
FRAME = ["path"] + [f"e{i}{c}" for i in (1, 2, 3) for c in "xyz"] + ["origin_x", "origin_y", "origin_z"]
BEGIN, END = "<!-- table: begin (written by generate.py) -->", "<!-- table: end -->"


def number(value):
    """A number with 12 significant digits; text as it is."""
    if isinstance(value, str):
        return value
    return f"{0.0 if abs(value) < 1e-13 else float(value):.12g}"


def renew_csv(path, head, rows, order):
    """Writes the rows into a CSV file in the order of their paths, keeping the rows of the paths not given."""
    new = [[number(cell) for cell in row] for row in rows]
    given, kept = {row[0] for row in new}, []
    if path.exists():
        with open(path, newline="", encoding="ascii") as file:
            kept = [row for row in list(csv.reader(file))[1:] if row[0] not in given and row[0] in order]
    with open(path, "w", newline="", encoding="ascii") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(head)
        table.writerows(sorted(new + kept, key=lambda row: order[row[0]]))


def symmetry(record):
    """The symmetry of one model in words."""
    labels = [row[0] for row in record["truth"]]
    words = []
    if "revolution" in labels:
        words.append("revolution")
    for label in ("exact", "partial"):
        rows = [row for row in record["truth"] if row[0] == label]
        if rows and label == "exact":
            words.append(f"{len(rows)} exact")
        elif rows:
            words.append("partial " + ", ".join(f"{row[-1]:.3f}" for row in rows))
    return "; ".join(words) or "none"


def readme_row(r):
    """The row of one file in the table of README.md."""
    structure = r["structure"] if r["structure"] == "solid" else f"{r['structure']}, {r['solids']} solids"
    if r["structure"] == "assembly":
        structure += f" of {r['parts']} parts" + (", nested" if r["nested"] else "")
    notes = [note for key, note in (("splines", "all B-spline"), ("split", "split unevenly")) if r[key]]
    notes += [] if r["seams"] else ["no seams"]
    name = r["path"].split("/")[1].removesuffix(".step").replace("-", " ")
    return (
        f"| `{r['path']}` | {name} | generated | {r['schema']} | {r['unit']} | {'; '.join([structure] + notes)} | {symmetry(r)} |"
        f" {r['faces']} | {r['bytes'] / 1000:.0f} |")


def renew_readme(page, records, order):
    """Writes the rows of the table of README.md, keeping the rows of the paths not given."""
    head, rest = page.read_text(encoding="utf-8").split(BEGIN)
    table, tail = rest.split(END)
    rows = {line.split("`")[1]: line for line in table.splitlines() if line.startswith("| `")}
    rows.update({r["path"]: readme_row(r) for r in records})
    lines = [
        "| file | shape | origin | schema | unit | structure | symmetry | faces | kB |", "|---|---|---|---|---|---|---|---|---|"
    ]
    lines += [rows[path] for path in order if path in rows]
    page.write_text("\n".join([head + BEGIN, *lines, END + tail]), encoding="utf-8")


def write_tables(out, records, paths):
    """Renews labels.csv, truth.csv, frame.csv and, where there is one, the table of README.md."""
    order = {path: k for k, path in enumerate(paths)}
    renew_csv(out / "labels.csv", ["path", "category"], [[r["path"], r["category"]] for r in records], order)
    renew_csv(out / "truth.csv", TRUTH, [[r["path"], *row] for r in records for row in r["truth"]], order)
    renew_csv(out / "frame.csv", FRAME, [[r["path"], *r["frame"]] for r in records], order)
    if (out / "README.md").exists():
        renew_readme(out / "README.md", records, order)
