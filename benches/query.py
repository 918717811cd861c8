"""Times `query` against faiss IndexFlatL2: 1,000,000 random rows of 96, one query and a batch of 1,000, k = 10.

    python3 benches/query.py [ROWS [QUERIES]]

Both read the same numbers on the same cores, in turns in one run; the best of three each, wall and CPU seconds. faiss
ranks by the Euclidean distance of all 96 numbers, symalign by the sum of three over 32 each (eq. 8), exact in f64: the
hits differ, the bytes read do not. The first query's hits are held against the definition in NumPy.
"""

import json
import os
import resource
import subprocess
import sys
import tempfile
import time

# Set on some machines for old builds of OpenBLAS; they slow the current one that faiss brings.
for name in ("OPENBLAS_CORETYPE", "OPENBLAS_L2_SIZE"):
    os.environ.pop(name, None)

import faiss
import numpy as np

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
K = 10


def cpu():
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


def timed(work):
    times = []
    for _ in range(3):
        start, used = time.perf_counter(), cpu()
        work()
        times.append((time.perf_counter() - start, cpu() - used))
    return [min(t[i] for t in times) for i in (0, 1)]


def by_definition(rows, query):
    distances = np.zeros(len(rows))
    for view in range(3):
        part = slice(32 * view, 32 * view + 32)
        squares = np.zeros(len(rows))
        for i in range(part.start, part.stop):
            squares += (rows[:, i].astype(np.float64) - np.float64(query[i])) ** 2
        distances += np.sqrt(squares)
    order = np.lexsort((np.arange(len(rows)), distances))[:K]
    return [(int(i), float(distances[i])) for i in order]


def main():
    count, asked = (int(a) for a in (sys.argv[1:] + ["1000000", "1000"][len(sys.argv) - 1 :])[:2])
    subprocess.run(["cargo", "build", "--release", "--quiet", "--example", "query"], cwd=ROOT, check=True)
    program = os.path.join(os.environ.get("CARGO_TARGET_DIR", os.path.join(ROOT, "target")), "release/examples/query")
    random = np.random.default_rng(1)
    rows = random.random((count, 96), dtype=np.float32)
    queries = random.random((asked, 96), dtype=np.float32)
    faiss.omp_set_num_threads(len(os.sched_getaffinity(0)))
    index = faiss.IndexFlatL2(96)
    index.add(rows)
    with tempfile.TemporaryDirectory() as folder:
        files = [os.path.join(folder, name) for name in ("rows", "queries")]
        rows.tofile(files[0])
        queries.tofile(files[1])
        ours = json.loads(subprocess.run([program, *files, str(K)], check=True, stdout=subprocess.PIPE).stdout)
    theirs = {
        "one": timed(lambda: index.search(queries[:1], K)),
        "all": timed(lambda: index.search(queries, K)),
    }
    print(f"{count} rows, {len(os.sched_getaffinity(0))} cores      symalign s (CPU s)   faiss s (CPU s)   ratio (CPU)")
    for name, queries_in in (("one", 1), ("all", asked)):
        (a, b), (c, d) = ours[name], theirs[name]
        print(f"{queries_in:5} queries  {a:12.3f} ({b:.2f}) {c:16.3f} ({d:.2f}) {a / c:12.3f} ({b / d:.3f})")
    expected = by_definition(rows, queries[0])
    found = [(row, distance) for row, distance in ours["found"]]
    same = [a[0] for a in found] == [b[0] for b in expected]
    off = max(abs(a[1] - b[1]) for a, b in zip(found, expected))
    print(f"first query's hits by the definition in NumPy: {'the same' if same else 'DIFFERENT'}, distances to {off:.1e}")
    sys.exit(not same)


if __name__ == "__main__":
    main()
