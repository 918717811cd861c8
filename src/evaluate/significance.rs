//! Whether one ranker is better than another, or was lucky with its queries.
//!
//! The differences of two rankers on the same queries are tested by flipping signs at random (Fisher's randomisation;
//! Smucker, Allan and Carterette 2007). The queries of a class share their relevant models, so their differences
//! are not independent and a test on queries rejects far too often; the test to trust flips whole classes.

use super::gallery::Gallery;
use super::{MethodResult, Options};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use rayon::prelude::*;

/// Units up to which all sign flips are tried: 2^20 sums.
pub const EXACT: usize = 20;

/// How much better ranker `a` is than ranker `b`.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Comparison {
    /// The first method.
    pub a: String,
    /// The second method.
    pub b: String,
    /// What is compared: "ap", the average precision of each query.
    pub measure: &'static str,
    /// Mean of a - b over queries.
    pub mean_difference: f64,
    /// 95 % bootstrap interval of the mean difference, queries resampled.
    pub ci95: [f64; 2],
    /// The same, whole classes resampled.
    pub ci95_class: [f64; 2],
    /// Two-sided p-value, signs of queries flipped: far too small where queries share a class.
    pub p_query: f64,
    /// Two-sided p-value, signs of classes flipped: the one to read.
    pub p_class: f64,
    /// `p_class` after Holm's correction over all comparisons.
    pub p_holm: f64,
}

/// The first method against each other one of the same descriptor; both descriptors of the first method.
pub fn compare_all(gallery: &Gallery, methods: &[MethodResult], options: &Options) -> Vec<Comparison> {
    let mut comparisons: Vec<_> =
        pairs(methods).into_par_iter().map(|(a, b)| compare(gallery, a, b, options)).collect();
    let adjusted = holm(&comparisons.iter().map(|c| c.p_class).collect::<Vec<_>>());
    comparisons.iter_mut().zip(adjusted).for_each(|(comparison, p)| comparison.p_holm = p);
    comparisons
}

fn pairs(methods: &[MethodResult]) -> Vec<(&MethodResult, &MethodResult)> {
    let descriptor = |method: &MethodResult| method.name.split_once(':').map(|(_, kind)| kind.to_owned());
    let mut firsts: Vec<&MethodResult> = Vec::new();
    let mut pairs = Vec::new();
    for method in methods {
        match firsts.iter().find(|first| descriptor(first) == descriptor(method)) {
            Some(first) => pairs.push((*first, method)),
            None => {
                pairs.extend(firsts.first().map(|first| (method, *first)));
                firsts.push(method);
            }
        }
    }
    pairs
}

fn compare(gallery: &Gallery, a: &MethodResult, b: &MethodResult, options: &Options) -> Comparison {
    let difference = |(x, y): (&super::QueryResult, &super::QueryResult)| x.scores.ap - y.scores.ap;
    let queries: Vec<_> = a.queries.iter().zip(&b.queries).map(difference).collect();
    let mut classes: Vec<Unit> = Vec::new();
    for (result, &difference) in a.queries.iter().zip(&queries) {
        let start = gallery.class(result.query).members.start;
        match classes.last_mut().filter(|_| result.query != start) {
            Some(class) => class.add(difference),
            None => classes.push(Unit { sum: difference, queries: 1 }),
        }
    }
    let units: Vec<_> = queries.iter().map(|&sum| Unit { sum, queries: 1 }).collect();
    let p = |units: &[Unit]| sign_flip(&units.iter().map(|u| u.sum).collect::<Vec<_>>(), options.draws, options.seed);
    Comparison {
        a: a.name.clone(),
        b: b.name.clone(),
        measure: "ap",
        mean_difference: queries.iter().sum::<f64>() / queries.len() as f64,
        ci95: bootstrap(&units, options.resamples, options.seed),
        ci95_class: bootstrap(&classes, options.resamples, options.seed),
        p_query: p(&units),
        p_class: p(&classes),
        p_holm: 1.0,
    }
}

/// What is resampled or flipped as a whole: a query, or a class with the sum of its queries' differences.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// Of the differences.
    pub sum: f64,
    /// Their number.
    pub queries: usize,
}

impl Unit {
    fn add(&mut self, difference: f64) {
        self.sum += difference;
        self.queries += 1;
    }
}

/// The two-sided p-value of the sum of `differences`, their signs being arbitrary if the rankers are alike:
/// exact up to [`EXACT`] of them, else from `draws` draws, the observed signs counted as one more.
pub fn sign_flip(differences: &[f64], draws: usize, seed: u64) -> f64 {
    // sums of the same numbers in another order differ by rounding only: they are as extreme
    let slack = 1e-12 * differences.iter().map(|d| d.abs()).sum::<f64>();
    let observed = differences.iter().sum::<f64>().abs() - slack;
    if differences.len() <= EXACT {
        let all = 1u64 << differences.len();
        let extreme = (0..all).filter(|&signs| flipped(differences, signs).abs() >= observed).count();
        return extreme as f64 / all as f64;
    }
    let mut rng = Pcg64::seed_from_u64(seed);
    let mut draw = || differences.chunks(64).map(|chunk| flipped(chunk, rng.random())).sum::<f64>();
    let extreme = (0..draws).filter(|_| draw().abs() >= observed).count();
    (extreme + 1) as f64 / (draws + 1) as f64
}

/// The sum of `differences`, the i-th negated where bit i of `signs` is set.
fn flipped(differences: &[f64], signs: u64) -> f64 {
    differences.iter().enumerate().map(|(i, &d)| if signs >> i & 1 == 1 { -d } else { d }).sum()
}

/// The 95 % percentile interval of the mean difference over queries, `units` being drawn with replacement.
pub fn bootstrap(units: &[Unit], resamples: usize, seed: u64) -> [f64; 2] {
    let mut rng = Pcg64::seed_from_u64(seed);
    let mut mean = || {
        let drawn = (0..units.len()).map(|_| units[rng.random_range(0..units.len())]);
        let (sum, queries) = drawn.fold((0.0, 0), |(sum, n), unit| (sum + unit.sum, n + unit.queries));
        sum / queries as f64
    };
    let mut means: Vec<_> = (0..resamples.max(1)).map(|_| mean()).collect();
    means.sort_unstable_by(f64::total_cmp);
    [0.025, 0.975].map(|share| means[(share * (means.len() - 1) as f64).round() as usize])
}

/// Holm's step-down correction: the smallest of m p-values times m, the next times m - 1 .., never decreasing, at most 1.
pub fn holm(p: &[f64]) -> Vec<f64> {
    let mut order: Vec<_> = (0..p.len()).collect();
    order.sort_by(|&a, &b| p[a].total_cmp(&p[b]));
    let mut adjusted = vec![1.0; p.len()];
    let mut floor = 0.0f64;
    for (step, &i) in order.iter().enumerate() {
        floor = floor.max(p[i] * (p.len() - step) as f64).min(1.0);
        adjusted[i] = floor;
    }
    adjusted
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_differences_are_flipped_exhaustively() {
        // of the 8 sums of +-1 +-2 +-3 only 6 and -6 are as extreme as 6
        assert_eq!(sign_flip(&[1.0, 2.0, 3.0], 10, 1), 0.25);
        // |1 + 2 - 3| = 0: every sum is at least as extreme
        assert_eq!(sign_flip(&[1.0, 2.0, -3.0], 10, 1), 1.0);
        // 4 = 1 + 3 twice (the 0 flips freely), -4 twice, of 8
        assert_eq!(sign_flip(&[1.0, 3.0, 0.0], 10, 1), 0.5);
    }

    #[test]
    fn rounding_does_not_break_symmetry() {
        assert_eq!(sign_flip(&[0.1, 0.2, 0.3, -0.1], 10, 1), 0.375);
    }

    #[test]
    fn many_differences_are_drawn_and_never_give_zero() {
        assert_eq!(sign_flip(&[1.0; 200], 999, 1), 1.0 / 1000.0);
        let balanced: Vec<_> = (0..100).map(|i| if i % 2 == 0 { 1.0 } else { -1.0 }).collect();
        assert_eq!(sign_flip(&balanced, 999, 1), 1.0);
    }

    #[test]
    fn drawing_agrees_with_the_exact_test() {
        let differences: Vec<_> = (0..20).map(|i| ((i * 7) % 11) as f64 - 3.5).collect();
        let exact = sign_flip(&differences, 0, 1);
        // a zero more makes 21, which are drawn, and changes no sum
        let drawn = sign_flip(&[differences, vec![0.0]].concat(), 100_000, 1);
        assert!((exact - drawn).abs() < 0.01, "{exact} {drawn}");
    }

    #[test]
    fn whole_classes_are_less_convincing_than_their_queries() {
        // three classes of ten queries, all better by 1: 2 of 8 sign flips are as extreme
        assert_eq!(sign_flip(&[10.0, 10.0, 10.0], 0, 1), 0.25);
        assert!(sign_flip(&[1.0; 30], 10_000, 1) < 0.001);
    }

    #[test]
    fn holm_steps_down() {
        // 0.01 * 3, 0.02 * 2, 0.03 * 1 raised to the one before
        let adjusted = holm(&[0.03, 0.01, 0.02]);
        for (got, expected) in adjusted.iter().zip([0.04, 0.03, 0.04]) {
            assert!((got - expected).abs() < 1e-12);
        }
        assert_eq!(holm(&[0.5, 0.9]), [1.0, 1.0]);
        assert!(holm(&[]).is_empty());
    }

    #[test]
    fn intervals_hold_the_mean_and_shrink_to_a_constant() {
        let units: Vec<_> = (0..50).map(|i| Unit { sum: f64::from(i), queries: 1 }).collect();
        let [low, high] = bootstrap(&units, 10_000, 1);
        // the standard error of the mean of 0..50 is 14.4 / sqrt 50 = 2.04
        assert!((low - (24.5 - 1.96 * 2.04)).abs() < 0.3 && (high - (24.5 + 1.96 * 2.04)).abs() < 0.3);
        assert_eq!(bootstrap(&[Unit { sum: 3.0, queries: 3 }], 100, 1), [1.0, 1.0]);
    }
}
