//! The pictures of queries and their hits, as data for the page's script.

use super::super::Evaluation;
use crate::error::Result;
use crate::search::picture::{data_uri, grey_png};
use crate::search::{Rows, in_words};
use crate::store::{Store, THUMBNAIL};
use serde::Serialize;
use std::collections::BTreeMap;

/// Queries in the gallery at most, evenly spread: their pictures make up most of the page's size.
const QUERIES: usize = 600;

/// What the script needs.
#[derive(Serialize)]
pub struct Gallery {
    models: Vec<Model>,
    /// Places in `models`.
    queries: Vec<usize>,
    methods: Vec<Hits>,
}

#[derive(Serialize)]
struct Model {
    id: String,
    class: String,
    picture: String,
    symmetry: String,
}

#[derive(Serialize)]
struct Hits {
    name: String,
    /// For each query: its average precision and its hits.
    queries: Vec<(f64, Vec<Hit>)>,
}

/// Place in `models`, distance, and the distances of the three views.
type Hit = (usize, f64, [f64; 3]);

impl Gallery {
    /// The gallery of an evaluation of `store`.
    ///
    /// # Errors
    /// A damaged store.
    pub fn new(evaluation: &Evaluation, store: &Store) -> Result<Self> {
        let total = evaluation.methods.first().map_or(0, |method| method.queries.len());
        let kept = total.min(QUERIES);
        let chosen: Vec<_> = (0..kept).map(|i| i * total / kept).collect();
        let mut places = Places::default();
        let queries = match evaluation.methods.first() {
            Some(method) => chosen.iter().map(|&i| places.of(method.queries[i].query)).collect(),
            None => Vec::new(),
        };
        let mut methods = Vec::new();
        for method in &evaluation.methods {
            let rows = method.name.parse().ok().map(|name| Rows::of(store, name)).transpose()?;
            let row = |model: usize| rows.map(|rows| rows.row(evaluation.gallery.rows[model]));
            let views = |a: usize, b: usize| rows.zip(row(a)).zip(row(b)).map(|((rows, a), b)| rows.views(a, b));
            let mut hits = |query: &super::super::QueryResult| {
                let hit = |&(model, distance): &(usize, f64)| {
                    let views = views(query.query, model).unwrap_or_default();
                    (places.of(model), rounded(distance), views.map(rounded))
                };
                (rounded(query.scores.ap), query.hits.iter().map(hit).collect())
            };
            let queries = chosen.iter().map(|&i| hits(&method.queries[i])).collect();
            methods.push(Hits { name: method.name.clone(), queries });
        }
        let models = places.models.iter().map(|&model| shown(evaluation, store, model)).collect::<Result<_>>()?;
        Ok(Self { models, queries, methods })
    }

    /// The number of queries that can be looked at.
    pub fn len(&self) -> usize {
        self.queries.len()
    }

    /// The data as JSON that can stand inside a `<script>` element.
    pub fn json(&self) -> String {
        let json = serde_json::to_string(self).expect("strings and finite numbers have a form in JSON");
        json.replace('<', "\\u003c")
    }
}

/// Models in the order in which they were first needed.
#[derive(Default)]
struct Places {
    models: Vec<usize>,
    place_of: BTreeMap<usize, usize>,
}

impl Places {
    fn of(&mut self, model: usize) -> usize {
        *self.place_of.entry(model).or_insert_with(|| {
            self.models.push(model);
            self.models.len() - 1
        })
    }
}

fn shown(evaluation: &Evaluation, store: &Store, model: usize) -> Result<Model> {
    let (gallery, row) = (&evaluation.gallery, evaluation.gallery.rows[model]);
    Ok(Model {
        id: gallery.ids[model].clone(),
        class: gallery.class(model).name.clone(),
        picture: data_uri(&grey_png(store.thumbnail(row), THUMBNAIL)),
        symmetry: in_words(&store.summary(row)?),
    })
}

/// Four digits after the point are enough to look at.
fn rounded(value: f64) -> f64 {
    (value * 1e4).round() / 1e4
}
