//! What a random and an ideal ranking give: the floor and the ceiling of every table.

use super::gallery::{Class, Gallery};
use super::measures::{Group, Scores};
use super::precision_recall::{Curves, INTERPOLATED, princeton};
use super::summary::Summary;
use rand::SeedableRng;
use rand::seq::index;
use rand_pcg::Pcg64;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Random rankings drawn for the interpolated curve, whose expectation has no simple form;
/// with 4,000 its standard error is below 0.005 for one class and a fraction of that in the mean.
const DRAWS: usize = 4_000;

/// The expected results of a random ranking: exact, but for the 11-point curve, which is the mean of `DRAWS`
/// rankings drawn from `seed`.
pub fn random(gallery: &Gallery, seed: u64) -> Summary {
    let others = gallery.len() - 1;
    by_class(gallery, |class| {
        let c = class.relevant();
        let scores = Scores::expected([Group { size: others, relevant: c }], c, others);
        let pr20 = princeton(&expected_precisions(c, others));
        (scores, Curves { pr11: drawn_curve(c, others, seed), pr20 })
    })
}

/// The results of an ideal ranking: all relevant models first.
pub fn ideal(gallery: &Gallery) -> Summary {
    by_class(gallery, |class| {
        let ranks: Vec<_> = (1..=class.relevant()).collect();
        (Scores::of(&ranks, ranks.len(), gallery.len() - 1), Curves::of(&ranks, ranks.len()))
    })
}

/// The summary where the results of a query depend on the size of its class only; each size is computed once.
fn by_class(gallery: &Gallery, results: impl Fn(&Class) -> (Scores, Curves) + Sync) -> Summary {
    let sizes: BTreeMap<_, _> = gallery.queried().map(|class| (class.size(), class)).collect();
    let results: BTreeMap<_, _> = sizes.into_par_iter().map(|(size, class)| (size, results(class))).collect();
    let queries = gallery.queried().flat_map(|class| {
        let (scores, curves) = &results[&class.size()];
        class.members.clone().map(move |query| (query, scores, curves))
    });
    Summary::of(gallery, queries)
}

/// The expectation of c / r_c for c = 1 .. `relevant` in a random order of `others` models: r_c is negative
/// hypergeometric, P(r) = C(r-1, c-1) C(M-r, R-c) / C(M, R), here in logarithms since the first terms underflow.
fn expected_precisions(relevant: usize, others: usize) -> Vec<f64> {
    let (m, all) = (others as f64, relevant as f64);
    let mut first = 0.0;
    let mut expectations = Vec::with_capacity(relevant);
    for c in 1..=relevant {
        first += ((all - (c - 1) as f64) / (m - (c - 1) as f64)).ln();
        let mut log_p = first;
        let mut sum = 0.0;
        for rank in c..=others - (relevant - c) {
            sum += log_p.exp() / rank as f64;
            let (r, c) = (rank as f64, c as f64);
            log_p += (r / (r - c + 1.0) * (m - r - all + c) / (m - r)).ln();
        }
        expectations.push(c as f64 * sum);
    }
    expectations
}

fn drawn_curve(relevant: usize, others: usize, seed: u64) -> [f64; INTERPOLATED] {
    let mut rng = Pcg64::seed_from_u64(seed);
    let mut sum = [0.0; INTERPOLATED];
    for _ in 0..DRAWS {
        let mut ranks: Vec<_> = index::sample(&mut rng, others, relevant).into_iter().map(|i| i + 1).collect();
        ranks.sort_unstable();
        sum.iter_mut().zip(Curves::of(&ranks, relevant).pr11).for_each(|(sum, p)| *sum += p);
    }
    sum.map(|sum| sum / DRAWS as f64)
}

#[cfg(test)]
mod tests {
    use super::super::gallery::tests::gallery;
    use super::*;

    /// All rankings of `n` places with `c` relevant, as their ranks.
    fn subsets(n: usize, c: usize) -> Vec<Vec<usize>> {
        let chosen = |bits: u32| (1..=n).filter(|r| bits >> (r - 1) & 1 == 1).collect::<Vec<_>>();
        (0..1u32 << n).filter(|bits| bits.count_ones() as usize == c).map(chosen).collect()
    }

    #[test]
    fn the_precision_at_each_hit_is_the_mean_over_all_rankings() {
        for (n, c) in [(6, 1), (6, 6), (9, 4), (10, 3)] {
            let all = subsets(n, c);
            for (i, formula) in expected_precisions(c, n).iter().enumerate() {
                let mean = all.iter().map(|ranks| (i + 1) as f64 / ranks[i] as f64).sum::<f64>() / all.len() as f64;
                assert!((mean - formula).abs() < 1e-12, "{n} {c} {i}: {mean} {formula}");
            }
        }
    }

    #[test]
    fn large_classes_do_not_underflow() {
        let precisions = expected_precisions(500, 6000);
        // the last of 500 is near the end: 500 / (500 * 6001 / 501) a little more by convexity
        assert!((precisions[499] - 0.0835).abs() < 1e-3, "{}", precisions[499]);
    }

    #[test]
    fn the_drawn_curve_is_near_the_mean_over_all_rankings() {
        let all = subsets(10, 3);
        for (level, drawn) in drawn_curve(3, 10, 1).iter().enumerate() {
            let mean = all.iter().map(|ranks| Curves::of(ranks, 3).pr11[level]).sum::<f64>() / all.len() as f64;
            assert!((mean - drawn).abs() < 0.02, "{level}: {mean} {drawn}");
        }
    }

    #[test]
    fn the_paper_s_classes_have_the_known_chance_and_ceiling() {
        let sizes = [22, 12, 9, 9, 9, 4, 12, 15, 5];
        let categories: Vec<_> = sizes.iter().enumerate().flat_map(|(i, &n)| vec![i.to_string(); n]).collect();
        let gallery = gallery(&categories.iter().map(String::as_str).collect::<Vec<_>>());
        assert_eq!(gallery.len(), 97);
        assert!((random(&gallery, 1).micro.nn - 0.127).abs() < 5e-4);
        let ideal = ideal(&gallery);
        assert!((ideal.micro.e - 0.530).abs() < 5e-4);
        assert_eq!((ideal.micro.nn, ideal.macros.ap, ideal.micro.dcg), (1.0, 1.0, 1.0));
        assert_eq!(ideal.micro_curves.pr11, [Some(1.0); 11]);
    }
}
