//! The pictures of queries and their hits, as data for the page's script.

use super::super::{Evaluation, MethodResult};
use crate::error::Result;
use crate::search::picture::{data_uri, grey_png};
use crate::search::{Rows, in_words};
use crate::stages::projection_sweep::Source;
use crate::store::{Store, Summary, THUMBNAIL};
use serde::Serialize;
use std::collections::BTreeMap;

/// Queries in the gallery at most.
const QUERIES: usize = 600;
/// Models pictured at most: at 2 to 3 kB each they make up most of the page's size.
const PICTURES: usize = 1_500;

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
    plane: String,
}

#[derive(Serialize)]
struct Hits {
    name: String,
    /// For each query: its average precision and its hits.
    queries: Vec<(f64, Vec<Hit>)>,
}

/// Place in `models`, distance, and where they are known the distances of the three views.
#[derive(Serialize)]
#[serde(untagged)]
enum Hit {
    Views(usize, f64, f64, f64, f64),
    Whole(usize, f64),
}

impl Gallery {
    /// The gallery of an evaluation of `store`: queries evenly spread, as many as [`QUERIES`] and [`PICTURES`] allow.
    ///
    /// # Errors
    /// A damaged store.
    pub fn new(evaluation: &Evaluation, store: &Store) -> Result<Self> {
        let total = evaluation.methods.first().map_or(0, |method| method.queries.len());
        let mut kept = total.min(QUERIES);
        let mut chosen = spread(total, kept);
        let mut places = Places::of(evaluation, &chosen);
        while places.models.len() > PICTURES && kept > 1 {
            kept = kept * 3 / 4;
            chosen = spread(total, kept);
            places = Places::of(evaluation, &chosen);
        }
        let queries = chosen.iter().map(|&i| places.place_of[&evaluation.methods[0].queries[i].query]).collect();
        let hits = |method| hits(evaluation, store, method, &chosen, &places);
        let methods = evaluation.methods.iter().map(hits).collect::<Result<_>>()?;
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

/// `kept` of `total` places, evenly spread.
fn spread(total: usize, kept: usize) -> Vec<usize> {
    (0..kept).map(|i| i * total / kept).collect()
}

/// Models in the order in which they are first needed.
#[derive(Default)]
struct Places {
    models: Vec<usize>,
    place_of: BTreeMap<usize, usize>,
}

impl Places {
    /// The chosen queries, then their hits by all methods.
    fn of(evaluation: &Evaluation, chosen: &[usize]) -> Self {
        let mut places = Self::default();
        let results = || evaluation.methods.iter().flat_map(|m| chosen.iter().map(|&i| &m.queries[i]));
        results().for_each(|result| places.add(result.query));
        results().flat_map(|result| &result.hits).for_each(|hit| places.add(hit.0));
        places
    }

    fn add(&mut self, model: usize) {
        let next = self.models.len();
        if *self.place_of.entry(model).or_insert(next) == next {
            self.models.push(model);
        }
    }
}

fn hits(
    evaluation: &Evaluation,
    store: &Store,
    method: &MethodResult,
    chosen: &[usize],
    places: &Places,
) -> Result<Hits> {
    let rows = method.name.parse().ok().map(|name| Rows::of(store, name)).transpose()?;
    let row = |rows: Rows<'_>, model: usize| rows.row(evaluation.gallery.rows[model]).to_vec();
    let hit = |query: usize, &(model, distance): &(usize, f64)| {
        let (place, distance) = (places.place_of[&model], rounded(distance));
        match rows {
            Some(rows) => {
                let [a, b, c] = rows.views(&row(rows, query), &row(rows, model)).map(rounded);
                Hit::Views(place, distance, a, b, c)
            }
            None => Hit::Whole(place, distance),
        }
    };
    let query = |&i: &usize| {
        let result = &method.queries[i];
        (rounded(result.scores.ap), result.hits.iter().map(|found| hit(result.query, found)).collect())
    };
    Ok(Hits { name: method.name.clone(), queries: chosen.iter().map(query).collect() })
}

fn shown(evaluation: &Evaluation, store: &Store, model: usize) -> Result<Model> {
    let (gallery, row) = (&evaluation.gallery, evaluation.gallery.rows[model]);
    let summary = store.summary(row)?;
    Ok(Model {
        id: gallery.ids[model].clone(),
        class: gallery.class(model).name.clone(),
        picture: data_uri(&grey_png(store.thumbnail(row)?, THUMBNAIL)),
        symmetry: in_words(&summary),
        plane: plane(&summary),
    })
}

/// The mirror plane behind the symmetry frame, with its evidence; in the coordinates the run worked in.
fn plane(summary: &Summary) -> String {
    let Some(plane) = summary.planes.first().filter(|_| summary.source == Source::Symmetry) else {
        return String::new();
    };
    let [x, y, z] = plane.normal;
    let mut text = format!("normal ({x:.3}, {y:.3}, {z:.3}) at {:.2} mm", plane.offset_mm);
    text += &match plane.pair_count {
        0 => String::new(),
        1 => ", a pair of faces".into(),
        n => format!(", {n} pairs of faces"),
    };
    text += &match plane.self_count {
        0 => String::new(),
        1 => ", a face onto itself".into(),
        n => format!(", {n} faces onto themselves"),
    };
    if !summary.axes.is_empty() {
        text += ", one of all through its axis";
    }
    text
}

/// Four digits are enough to look at.
fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}
