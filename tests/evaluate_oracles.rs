//! The measures beside those of pytrec_eval, where a Python that has it is found.
//!
//! `SYMALIGN_PYTHON` names the interpreter, else it is `python3`; without pytrec_eval the test says so and passes.

mod synthetic;

use std::path::Path;
use std::process::Command;
use symalign::evaluate::{self, Labels, Options};
use symalign::store::Store;

/// Prints `query nn ft st ap p(0) .. p(1)` for a run, one query a line.
const ORACLE: &str = r"
import sys, pytrec_eval
qrels, run = {}, {}
for line in open(sys.argv[1]):
    q, _, d, rel = line.split()
    qrels.setdefault(q, {})[d] = int(rel)
for line in open(sys.argv[2]):
    q, _, d, _, score, _ = line.split()
    run.setdefault(q, {})[d] = float(score)
second = {q: min(2 * len(docs), len(run[q])) for q, docs in qrels.items()}
measures = {'P_1', 'Rprec', 'map', 'iprec_at_recall', 'recall.' + ','.join(map(str, sorted(set(second.values()))))}
results = pytrec_eval.RelevanceEvaluator(qrels, measures).evaluate(run)
for q, r in results.items():
    levels = [r[f'iprec_at_recall_{i / 10:.2f}'] for i in range(11)]
    print(q, *map(repr, [r['P_1'], r['Rprec'], r[f'recall_{second[q]}'], r['map'], *levels]))
";

fn python() -> Option<String> {
    let python = std::env::var("SYMALIGN_PYTHON").unwrap_or_else(|_| "python3".into());
    let has = Command::new(&python).args(["-c", "import pytrec_eval"]).output().is_ok_and(|o| o.status.success());
    if !has {
        eprintln!("skipped: {python} has no pytrec_eval (set SYMALIGN_PYTHON to one that has)");
    }
    has.then_some(python)
}

fn oracle(python: &str, out: &Path, method: &str) -> Vec<(String, Vec<f64>)> {
    let run = out.join(format!("{method}.run.trec"));
    let output = Command::new(python).arg("-c").arg(ORACLE).arg(out.join("qrels.trec")).arg(run).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let parse = |line: &str| {
        let mut fields = line.split(' ');
        let query = fields.next().unwrap().to_owned();
        (query, fields.map(|field| field.parse().unwrap()).collect())
    };
    String::from_utf8(output.stdout).unwrap().lines().map(parse).collect()
}

/// Whether trec_eval asks for one hit too few at this recall level: it takes floor(level / 10 * C + 0.9) hits, which
/// rounds 0.7 * 3 + 0.9 to 2.9999999999999996. The definition needs the least c with c / C >= level / 10.
fn one_short(level: usize, relevant: usize) -> bool {
    let theirs = (level as f64 / 10.0 * relevant as f64 + 0.9) as usize;
    theirs != (level * relevant).div_ceil(10)
}

#[test]
fn the_oracle_is_one_short_at_few_levels() {
    let short = |relevant: usize| (0..11).filter(|&level| one_short(level, relevant)).collect::<Vec<_>>();
    assert_eq!(short(3), [7]);
    assert!((1..=21).map(|relevant| short(relevant).len()).sum::<usize>() < 10);
}

#[test]
fn measures_agree_with_pytrec_eval() {
    let Some(python) = python() else { return };
    let folder = tempfile::tempdir().unwrap();
    synthetic::store(folder.path());
    let store = Store::open(folder.path()).unwrap();
    let labels = Labels::load(&folder.path().join("labels.csv")).unwrap();
    let options = Options { draws: 100, resamples: 100, ..Options::default() };
    let evaluation = evaluate::evaluate(&store, &labels, &options).unwrap();
    let out = folder.path().join("out");
    evaluate::write(&evaluation, &store, &out).unwrap();
    let mut largest = 0.0f64;
    for method in &evaluation.methods {
        let theirs = oracle(&python, &out, &method.name.replace(':', "-"));
        assert_eq!(theirs.len(), method.queries.len());
        for query in &method.queries {
            let id = &evaluation.gallery.ids[query.query];
            let (_, theirs) = theirs.iter().find(|(theirs, _)| theirs == id).unwrap();
            let scores = &query.scores;
            let relevant = evaluation.gallery.class(query.query).relevant();
            let levels = query.curves.pr11.into_iter().enumerate().filter(|(level, _)| !one_short(*level, relevant));
            let ours = [scores.nn, scores.ft, scores.st, scores.ap].into_iter().enumerate();
            let ours = ours.chain(levels.map(|(level, precision)| (4 + level, precision)));
            let differences = ours.map(|(column, ours)| (ours - theirs[column]).abs());
            largest = differences.fold(largest, f64::max);
        }
    }
    println!("largest difference from pytrec_eval: {largest:e}");
    assert!(largest <= 1e-12, "{largest:e}");
}
