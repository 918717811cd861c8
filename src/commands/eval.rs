//! `eval`.

use std::path::Path;

use symalign::error::Result;
use symalign::evaluate::{self, Evaluation, Labels, Options};
use symalign::store::Store;

use crate::cli::{Compat, Eval, Exit};

/// Scores retrieval over a store and writes the report.
pub fn eval(args: &Eval) -> Result<Exit> {
    let options = Options {
        methods: args.method.iter().flatten().map(ToString::to_string).collect(),
        compat_psb: args.compat == Some(Compat::Psb),
        ..Options::default()
    };
    score(&args.store, &args.labels, &args.out, &options)?;
    Ok(Exit::Done)
}

/// Writes the report on `store` into `out` and prints its main figures.
pub fn score(store: &Path, labels: &Path, out: &Path, options: &Options) -> Result<()> {
    let store = Store::open(store)?;
    let evaluation = evaluate::evaluate(&store, &Labels::load(labels)?, options)?;
    evaluate::write(&evaluation, &store, out)?;
    super::print(&figures(&evaluation))?;
    eprintln!("the report is {}", out.join("report.html").display());
    Ok(())
}

/// One line a method: its averages over the queries.
fn figures(evaluation: &Evaluation) -> String {
    let (models, queries) = (evaluation.gallery.len(), evaluation.gallery.queries().len());
    let mut text = format!("{models} models, {queries} queries\n");
    text += &format!("{:<18}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}\n", "", "mAP", "NN", "FT", "ST", "E", "DCG");
    let rows = evaluation.methods.iter().map(|method| (method.name.as_str(), &method.summary));
    for (name, summary) in rows.chain([("chance", &evaluation.chance), ("ceiling", &evaluation.ceiling)]) {
        let m = &summary.micro;
        let figures = [m.ap, m.nn, m.ft, m.st, m.e, m.dcg].map(|figure| format!("{figure:8.3}"));
        text += &format!("{name:<18}{}\n", figures.concat());
    }
    text
}
