#!/usr/bin/env python3
"""Holds the measures of a report against pytrec_eval, ir_measures and ranx: python3 benches/oracles.py REPORT_FOLDER

Reads `qrels.trec`, each `<method>.run.trec`, `per_query.csv` and `metrics.json` of `symalign eval --out FOLDER`, prints
each measure beside theirs with the largest difference over all queries, and fails where one is above 1e-12. The Princeton
DCG has no oracle; the column `formula` holds it as it is written. Needs pytrec-eval-terrier; the others are used where
they are installed. Exit code 77: none is.
"""

import csv
import json
import math
import pathlib
import sys

try:
    import pytrec_eval
except ImportError:
    print("skipped: this Python has no pytrec_eval")
    sys.exit(77)

LIMIT = 1e-12
LEVELS = [f"{level / 10:.1f}" for level in range(11)]
OURS = ["nn", "ft", "st", "e", "dcg", "ap", *(f"p({level})" for level in LEVELS)]


def read_qrels(path):
    qrels = {}
    for line in open(path):
        query, _, model, relevance = line.split()
        qrels.setdefault(query, {})[model] = int(relevance)
    return qrels


def read_run(path):
    run = {}
    for line in open(path):
        query, _, model, _, score, _ = line.split()
        run.setdefault(query, {})[model] = float(score)
    return run


def by_pytrec_eval(qrels, run, tiers):
    cuts = ",".join(str(k) for k in sorted(set(tiers.values())))
    names = {"P_1", "Rprec", "map", "iprec_at_recall", f"recall.{cuts}"}
    results = pytrec_eval.RelevanceEvaluator(qrels, names).evaluate(run)
    for query, found in results.items():
        yield query, {
            "nn": found["P_1"],
            "ft": found["Rprec"],
            "st": found[f"recall_{tiers[query]}"],
            "ap": found["map"],
            **{f"p({level})": found[f"iprec_at_recall_{level}0"] for level in LEVELS},
        }


def by_ir_measures(qrels, run, tiers):
    import ir_measures
    from ir_measures import AP, IPrec, P, R, Rprec

    names = {P @ 1: "nn", Rprec: "ft", AP: "ap", **{IPrec @ float(level): f"p({level})" for level in LEVELS}}
    cuts = {R @ k: k for k in set(tiers.values())}
    results = {query: {} for query in run}
    for found in ir_measures.iter_calc([*names, *cuts], qrels, run):
        if found.measure in names:
            results[found.query_id][names[found.measure]] = found.value
        elif cuts[found.measure] == tiers[found.query_id]:
            results[found.query_id]["st"] = found.value
    return results.items()


def by_ranx(qrels, run, tiers):
    import ranx

    cuts = sorted(set(tiers.values()))
    theirs = ranx.Run.from_dict(run)
    metrics = ["precision@1", "r-precision", "map", "f1@32", *(f"recall@{k}" for k in cuts)]
    ranx.evaluate(ranx.Qrels.from_dict(qrels), theirs, metrics)
    scores = theirs.scores
    for query in run:
        yield query, {
            "nn": scores["precision@1"][query],
            "ft": scores["r-precision"][query],
            "st": scores[f"recall@{tiers[query]}"][query],
            "e": scores["f1@32"][query],
            "ap": scores["map"][query],
        }


def by_formula(qrels, run, tiers):
    gain = lambda rank: 1 if rank == 1 else 1 / math.log2(rank)
    for query, found in run.items():
        order = sorted(found, key=lambda model: -found[model])
        hits = [rank for rank, model in enumerate(order, 1) if model in qrels[query]]
        ideal = sum(gain(rank) for rank in range(1, len(qrels[query]) + 1))
        yield query, {"dcg": sum(gain(rank) for rank in hits) / ideal}


ORACLES = {"pytrec_eval": by_pytrec_eval, "ir_measures": by_ir_measures, "ranx": by_ranx, "formula": by_formula}


def one_hit_short(measure, relevant):
    """trec_eval takes floor(level * C + 0.9) hits, which rounds 0.7 * 3 + 0.9 to 2.9999999999999996: one hit too few. The
    definition needs the least c with c / C >= level."""
    if not measure.startswith("p("):
        return False
    level = LEVELS.index(measure[2:-1])
    return int(level / 10 * relevant + 0.9) != -(-level * relevant // 10)


def token(text):
    """As the program writes ids with white space."""
    plain = lambda c: not c.isspace() and c != "%"
    return "".join(c if plain(c) else "".join(f"%{byte:02X}" for byte in c.encode()) for c in text)


def read_ours(path):
    ours = {}
    for row in csv.DictReader(open(path, newline="")):
        ours.setdefault(row["method"], {})[token(row["query"])] = {name: float(row[name]) for name in OURS}
    return ours


def compare(method, ours, qrels, run, oracles):
    """Prints a table and returns the largest difference."""
    # a list may be shorter than the gallery where it was cut; none of ours is cut before the second tier ends
    others = len(qrels.keys() | {model for found in run.values() for model in found}) - 1
    tiers = {query: min(2 * len(found), others) for query, found in qrels.items()}
    means, largest, left_out = {}, {}, {}
    for name, oracle in oracles.items():
        for query, theirs in oracle(qrels, run, tiers):
            for measure, value in theirs.items():
                means.setdefault((name, measure), []).append(value)
                if one_hit_short(measure, len(qrels[query])):
                    left_out.setdefault(measure, set()).add(query)
                    continue
                gap = abs(value - ours[query][measure])
                largest[name, measure] = max(largest.get((name, measure), 0), gap)
    print(f"\n{method}: {len(run)} queries\n{'':8}{'symalign':>20}" + "".join(f"{name:>20}{'most':>9}" for name in oracles))
    for measure in OURS:
        mine = sum(query[measure] for query in ours.values()) / len(ours)
        cells = ""
        for name in oracles:
            values = means.get((name, measure))
            told = values and f"{sum(values) / len(values):20.15f}{largest[name, measure]:9.0e}"
            cells += told or f"{'-':>20}{'':9}"
        note = f"  but for {len(left_out[measure])} queries, where trec_eval takes a hit too few" if measure in left_out else ""
        print(f"{measure:8}{mine:20.15f}{cells}{note}")
    return max(largest.values())


def main(folder):
    qrels, ours = read_qrels(folder / "qrels.trec"), read_ours(folder / "per_query.csv")
    oracles = {}
    for name, oracle in ORACLES.items():
        try:
            if name != "formula":
                __import__(name)
            oracles[name] = oracle
        except ImportError:
            print(f"{name} is not installed")
    methods = json.load(open(folder / "metrics.json"))["methods"]
    largest = 0
    for method in methods:
        run = read_run(folder / f"{method.replace(':', '-')}.run.trec")
        largest = max(largest, compare(method, ours[method], qrels, run, oracles))
        micro = methods[method]["micro"]["map"]
        largest = max(largest, abs(micro - sum(query["ap"] for query in ours[method].values()) / len(qrels)))
    print(f"\nlargest difference over {len(methods)} methods and {len(oracles) - 1} oracles: {largest:.1e}")
    return 1 if largest > LIMIT else 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(main(pathlib.Path(sys.argv[1])))
