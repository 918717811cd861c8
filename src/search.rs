//! Nearest neighbours in a store: exact, by the distances of eq. 8.
//!
//! [`Rows`] are the descriptors of a store, or of memory; one query or many go through them in one pass (`scan`).

mod kernels;
mod page;
pub mod picture;
mod scan;

pub use page::{Asked, write_page};

use crate::alignment::Method;
use crate::distance;
use crate::error::{Result, RunError};
use crate::stages::descriptor::{MAGNITUDES, PHASES};
use crate::stages::merge::Label;
use crate::stages::projection_sweep::Source;
use crate::store::{Store, Summary};
use std::fmt;
use std::str::FromStr;

/// The descriptors of a model in a frame, and how they are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Kind {
    /// The magnitudes of the Fourier coefficients: blind to turns and mirrors in the picture plane.
    Magnitude,
    /// The complex coefficients, compared under the best signs of the axes.
    Phase,
    /// The magnitudes, compared in the better order of the second and third view.
    Swapped,
}

impl Kind {
    const ALL: [Self; 3] = [Self::Magnitude, Self::Phase, Self::Swapped];

    /// What follows the frame in a name.
    fn suffix(self) -> &'static str {
        match self {
            Self::Magnitude => "",
            Self::Phase => ":phase",
            Self::Swapped => ":swapped",
        }
    }
}

/// A frame and a descriptor: "symmetry", "symmetry:phase" for the phases, "symmetry:swapped" for the magnitudes in
/// the better order of the second and third view.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Name {
    /// What aligned the models.
    pub frame: Method,
    /// What is compared.
    pub kind: Kind,
}

impl fmt::Display for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}", self.frame.name(), self.kind.suffix())
    }
}

impl FromStr for Name {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let names = Method::ALL.into_iter().flat_map(|frame| Kind::ALL.map(|kind| Self { frame, kind }));
        names.into_iter().find(|name| name.to_string() == text).ok_or(format!("there is no method `{text}`"))
    }
}

/// What a store is evaluated by unless told otherwise: the magnitudes of its frames, then the phases.
pub fn names(store: &Store) -> Vec<Name> {
    let of = |kind| store.methods().iter().map(move |&frame| Name { frame, kind });
    of(Kind::Magnitude).chain(of(Kind::Phase)).collect()
}

/// The descriptors of all models of a store, one row a model, and how they are compared.
#[derive(Clone, Copy)]
pub struct Rows<'a> {
    values: &'a [f32],
    length: usize,
    kind: Kind,
}

impl<'a> Rows<'a> {
    /// The rows of `name`.
    ///
    /// # Errors
    /// A frame that the store does not hold, named with those that it does; damage.
    pub fn of(store: &'a Store, name: Name) -> Result<Self> {
        let (values, length) = match name.kind {
            Kind::Magnitude | Kind::Swapped => (store.magnitudes(name.frame)?, MAGNITUDES),
            Kind::Phase => (store.phases(name.frame)?, PHASES),
        };
        Ok(Self { values, length, kind: name.kind })
    }

    /// Rows that lie in memory, one after the other: [`MAGNITUDES`] or [`PHASES`] numbers each.
    ///
    /// # Errors
    /// A part of a row at the end.
    pub fn new(values: &'a [f32], kind: Kind) -> Result<Self> {
        let length = if kind == Kind::Phase { PHASES } else { MAGNITUDES };
        if values.len().is_multiple_of(length) {
            Ok(Self { values, length, kind })
        } else {
            Err(RunError::Usage(format!("{} numbers are no whole rows of {length}", values.len())))
        }
    }

    /// The descriptor of model `i`.
    pub fn row(&self, i: usize) -> &'a [f32] {
        &self.values[i * self.length..(i + 1) * self.length]
    }

    /// The distance of two descriptors: the sum of the three views', smaller is more alike.
    pub fn distance(&self, a: &[f32], b: &[f32]) -> f64 {
        match self.kind {
            Kind::Magnitude => distance::magnitude(a, b),
            Kind::Phase => distance::phase(a, b),
            Kind::Swapped => distance::magnitude_swapped(a, b),
        }
    }

    /// The distances of the three views, which add up to [`Rows::distance`].
    pub fn views(&self, a: &[f32], b: &[f32]) -> [f64; 3] {
        match self.kind {
            Kind::Magnitude => distance::magnitude_views(a, b),
            Kind::Phase => distance::phase_views(a, b),
            Kind::Swapped => distance::magnitude_swapped_views(a, b),
        }
    }

    /// The `k` models nearest to `descriptor`, nearest first, equally near ones in the order of the store.
    ///
    /// # Errors
    /// A descriptor of another length, or distances that are not numbers.
    pub fn nearest(&self, descriptor: &[f32], k: usize) -> Result<Vec<Hit>> {
        Ok(self.nearest_to_each(&[descriptor], k)?.remove(0))
    }

    /// The `k` models nearest to each of many descriptors, as [`Rows::nearest`] finds them, in one pass over the rows.
    ///
    /// # Errors
    /// A descriptor of another length, or distances that are not numbers.
    pub fn nearest_to_each(&self, descriptors: &[&[f32]], k: usize) -> Result<Vec<Vec<Hit>>> {
        if let Some(other) = descriptors.iter().find(|d| d.len() != self.length) {
            let (expected, got) = (self.length, other.len());
            return Err(RunError::Usage(format!("a descriptor of {expected} numbers is needed, this one has {got}")));
        }
        let found = scan::nearest(self, descriptors, k);
        if found.iter().any(|nearest| nearest.undefined) {
            return Err(RunError::Usage("a distance is not a number".into()));
        }
        let hit = |descriptor, (distance, row)| Hit { row, distance, views: self.views(descriptor, self.row(row)) };
        let hits = descriptors.iter().zip(found).map(|(d, found)| found.sorted().map(|f| hit(d, f)).collect());
        Ok(hits.collect())
    }
}

/// A model found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Its row in the store.
    pub row: usize,
    /// Its distance, the sum of the three of `views`.
    pub distance: f64,
    /// The distances of the three views.
    pub views: [f64; 3],
}

/// The `k` models of `store` nearest to `descriptor` (magnitudes or phases, as the store holds them), nearest first.
///
/// # Errors
/// A frame that the store does not hold; a descriptor of another length.
pub fn query(store: &Store, descriptor: &[f32], k: usize, name: Name) -> Result<Vec<Hit>> {
    Rows::of(store, name)?.nearest(descriptor, k)
}

/// What symmetry was found in a model, in a few words.
pub fn in_words(summary: &Summary) -> String {
    let share = summary.planes.first().map_or(0.0, |plane| plane.coverage);
    let found = match summary.label {
        Label::Exact => "exact mirror symmetry".to_owned(),
        Label::NearGlobal => format!("near-global symmetry, {:.1} %", 100.0 * share),
        Label::Partial => format!("partial symmetry, {:.0} %", 100.0 * share),
        Label::None => "no mirror symmetry".to_owned(),
    };
    match summary.source {
        Source::Symmetry => found,
        Source::Rectilinearity => format!("{found}, frame by rectilinearity"),
        Source::Cpca => format!("{found}, frame by continuous PCA"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Magnitude rows whose first numbers are given, the rest 0: distances are differences of these.
    fn values(firsts: &[f32]) -> Vec<f32> {
        let row = |&first: &f32| std::iter::once(first).chain(vec![0.0; MAGNITUDES - 1]).collect::<Vec<_>>();
        firsts.iter().flat_map(row).collect()
    }

    fn rows(values: &[f32]) -> Rows<'_> {
        Rows::new(values, Kind::Magnitude).unwrap()
    }

    #[test]
    fn the_nearest_come_first_and_equal_ones_in_order() {
        let values = values(&[5.0, 1.0, 3.0, 1.0, 9.0]);
        let hits = rows(&values).nearest(&values[..MAGNITUDES], 3).unwrap();
        assert_eq!(hits.iter().map(|hit| (hit.row, hit.distance)).collect::<Vec<_>>(), [(0, 0.0), (2, 2.0), (1, 4.0)]);
        assert_eq!(hits[1].views, [2.0, 0.0, 0.0]);
        let all = rows(&values).nearest(&values[..MAGNITUDES], 99).unwrap();
        assert_eq!(all.iter().map(|hit| hit.row).collect::<Vec<_>>(), [0, 2, 1, 3, 4]);
    }

    #[test]
    fn other_descriptors_and_nan_are_refused() {
        let values = values(&[1.0, f32::NAN, 2.0]);
        assert!(rows(&values).nearest(&[1.0], 1).is_err());
        assert!(rows(&values).nearest(&values[..MAGNITUDES], 1).is_err());
        assert!(rows(&values).nearest(&values[..MAGNITUDES], 0).unwrap().is_empty());
    }

    #[test]
    fn names_come_back() {
        for text in ["symmetry", "cpca:phase", "pca:swapped"] {
            assert_eq!(text.parse::<Name>().unwrap().to_string(), text);
        }
        assert!("magic".parse::<Name>().is_err());
    }

    /// What the definition says: all distances, sorted.
    fn by_definition(rows: &Rows, query: &[f32], k: usize) -> Vec<(usize, f64)> {
        let count = rows.values.len() / rows.length;
        let mut all: Vec<_> = (0..count).map(|i| (i, rows.distance(query, rows.row(i)))).collect();
        all.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
        all.truncate(k);
        all
    }

    fn check(kind: Kind, values: &[f32], queries: &[&[f32]], k: usize) {
        let rows = Rows::new(values, kind).unwrap();
        let found = rows.nearest_to_each(queries, k).unwrap();
        for (query, hits) in queries.iter().zip(found) {
            let found: Vec<_> = hits.iter().map(|hit| (hit.row, hit.distance)).collect();
            assert_eq!(found, by_definition(&rows, query, k));
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        #[test]
        fn one_or_many_queries_find_what_the_definition_says(
            seed in 0u64.., count in 1..2000usize, asked in 1..40usize, k in 1..30usize, coarse in any::<bool>(),
        ) {
            // Few different values make many equal distances.
            let value = |i: usize| {
                let bits = (seed ^ i as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40;
                if coarse { (bits % 3) as f32 } else { bits as f32 / 1e7 }
            };
            for (kind, length) in [(Kind::Magnitude, MAGNITUDES), (Kind::Swapped, MAGNITUDES), (Kind::Phase, PHASES)] {
                let count = if kind == Kind::Phase { count / 8 + 1 } else { count };
                let values: Vec<f32> = (0..count * length).map(value).collect();
                let others: Vec<f32> = (0..asked * length).map(|i| value(i * 7 + 1)).collect();
                let mut queries: Vec<_> = others.chunks_exact(length).collect();
                queries[0] = &values[..length];
                check(kind, &values, &queries, k);
            }
        }
    }

    #[test]
    fn shares_of_many_rows_are_joined() {
        let values: Vec<f32> = (0..20_000 * MAGNITUDES).map(|i| (i * i % 1009) as f32).collect();
        let queries: Vec<_> = values.chunks_exact(MAGNITUDES).step_by(4001).collect();
        check(Kind::Magnitude, &values, &queries, 25);
        check(Kind::Magnitude, &values, &queries[..1], 25);
    }

    #[test]
    fn distances_beyond_single_precision_are_still_in_order() {
        let values = values(&[3e20, 1e20, 2e20, 1e-30, 0.0]);
        check(Kind::Magnitude, &values, &[&values[..MAGNITUDES]; 1], 3);
        check(Kind::Magnitude, &values, &[&values[4 * MAGNITUDES..]; 9], 4);
    }
}
