//! `eval`.

use std::path::{Path, PathBuf};

use symalign::error::{Result, RunError};
use symalign::evaluate::{self, Evaluation, Input, Labels, Options};
use symalign::store::Store;

use crate::cli::{Compat, Eval, Exit};

/// Scores retrieval over a store, and over results of others, and writes the report.
pub fn eval(args: &Eval) -> Result<Exit> {
    let options = Options {
        methods: args.method.iter().flatten().map(ToString::to_string).collect(),
        compat_psb: args.compat == Some(Compat::Psb),
        ..Options::default()
    };
    let alone = args.store.is_none() && !(args.matrix.is_empty() && args.run.is_empty());
    let folder = args.store.clone().unwrap_or_else(|| PathBuf::from("store"));
    let store = if alone { None } else { Some(Store::open(&folder)?) };
    let labels = match (&args.qrels, &args.labels) {
        (Some(qrels), _) => evaluate::judgements(qrels, &args.run)?,
        (None, Some(labels)) => Labels::load(labels)?,
        (None, None) => Labels::ParentFolder,
    };
    if alone && labels == Labels::ParentFolder {
        return Err(RunError::Usage("results of others need --labels FILE or --qrels FILE, or a --store".into()));
    }
    let input = Input { store: store.as_ref(), labels, matrices: args.matrix.clone(), runs: args.run.clone() };
    report(&input, &options, &args.out)?;
    Ok(Exit::Done)
}

/// Writes the report on `store` into `out` and prints its main figures.
pub fn score(store: &Path, labels: &Path, out: &Path) -> Result<()> {
    let store = Store::open(store)?;
    report(&Input::of_store(&store, Labels::load(labels)?), &Options::default(), out)
}

fn report(input: &Input, options: &Options, out: &Path) -> Result<()> {
    let evaluation = evaluate::report(input, options, out)?;
    super::print(&format!("{}{}", figures(&evaluation), comparisons(&evaluation)))?;
    eprintln!("the report is {}", out.join("report.html").display());
    Ok(())
}

/// One line a method: its averages over the queries.
fn figures(evaluation: &Evaluation) -> String {
    let (models, queries) = (evaluation.gallery.len(), evaluation.gallery.queries().len());
    let distractors = match evaluation.gallery.distractors() {
        0 => String::new(),
        n => format!(", {n} distractors"),
    };
    let mut text = format!("{models} models, {queries} queries{distractors}\n");
    text += &format!("{:<18}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}\n", "", "mAP", "NN", "FT", "ST", "E", "DCG");
    let rows = evaluation.methods.iter().map(|method| (method.name.as_str(), &method.summary));
    for (name, summary) in rows.chain([("chance", &evaluation.chance), ("ceiling", &evaluation.ceiling)]) {
        let m = &summary.micro;
        let figures = [m.ap, m.nn, m.ft, m.st, m.e, m.dcg].map(|figure| format!("{figure:8.3}"));
        text += &format!("{name:<18}{}\n", figures.concat());
    }
    text
}

/// One line a comparison: how much better in mAP, and how surely.
fn comparisons(evaluation: &Evaluation) -> String {
    if evaluation.comparisons.is_empty() {
        return String::new();
    }
    let [classes, queries] = ["p classes", "p queries"];
    let mut text = format!("\n{:<36}{:>8}{:>18}{classes:>11}{:>9}{queries:>11}\n", "", "mAP", "95 %", "Holm");
    for c in &evaluation.comparisons {
        let pair = format!("{} - {}", c.a, c.b);
        let interval = format!("{:+.3} .. {:+.3}", c.ci95_class[0], c.ci95_class[1]);
        let p = format!("{:>11.5}{:>9.5}{:>11.5}", c.p_class, c.p_holm, c.p_query);
        text += &format!("{pair:<36}{:>+8.3}{interval:>18}{p}\n", c.mean_difference);
    }
    text
}
