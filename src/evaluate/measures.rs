//! The scalar measures of one query.
//!
//! With n models in the query's class, C = n - 1 relevant ones, N in the gallery and the relevant ones at ranks
//! r_1 < .. < r_C of N - 1:
//!
//! | | |
//! |---|---|
//! | NN | 1 where r_1 = 1 |
//! | FT | hits among the first C, over C |
//! | ST | hits among the first min(2 C, N - 1), over C |
//! | E | harmonic mean of precision and recall at k = min(32, N - 1), which is 2 hits / (k + C) |
//! | DCG | sum of g(r_c), over its ideal value; g(1) = 1, g(r) = 1 / log2 r |
//! | AP | mean of c / r_c |
//!
//! All but AP are linear in the hits at each rank, so their expected value over random orders of tied models needs
//! only the expected hits; AP's is in McSherry and Najork 2008.

/// The length of the list that the E-measure looks at: what a person sees on a first page (Shilane et al. 2004).
const E_CUT: usize = 32;

/// The measures of one query, or their mean over several. Each is 0 to 1, higher is better.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Scores {
    /// Nearest neighbour, 0 to 1.
    pub nn: f64,
    /// First tier, 0 to 1.
    pub ft: f64,
    /// Second tier, 0 to 1.
    pub st: f64,
    /// E-measure over the first 32, 0 to 1.
    pub e: f64,
    /// Discounted cumulative gain over the ideal one, 0 to 1.
    pub dcg: f64,
    /// Average precision; its mean over queries is called mAP.
    #[serde(rename = "map")]
    pub ap: f64,
}

/// How each measure is called, in the order of [`Scores::values`].
pub const NAMES: [&str; 6] = ["nn", "ft", "st", "e", "dcg", "map"];

impl Scores {
    /// The measures of a query that finds `ranks.len()` of its `relevant` = C models, at `ranks` (ascending, from 1) of
    /// `others` = N - 1.
    pub fn of(ranks: &[usize], relevant: usize, others: usize) -> Self {
        let groups = ranks.iter().enumerate().flat_map(|(c, &rank)| {
            let before = if c == 0 { 0 } else { ranks[c - 1] };
            [Group { size: rank - before - 1, relevant: 0 }, Group { size: 1, relevant: 1 }]
        });
        Self::expected(groups, relevant, others)
    }

    /// Expected measures where the models of each group are in random order; `relevant` = C, `others` = N - 1.
    ///
    /// Groups after the last relevant model may be left out, and relevant models that were not found are in none.
    pub fn expected(groups: impl IntoIterator<Item = Group>, relevant: usize, others: usize) -> Self {
        let cuts = [1, relevant, others.min(2 * relevant), others.min(E_CUT)];
        let mut hits = [0.0; 4];
        let (mut gain, mut precision) = (0.0, 0.0);
        let (mut rank, mut seen) = (0, 0);
        for group in groups.into_iter().filter(|group| group.size > 0) {
            for (hits, cut) in hits.iter_mut().zip(cuts) {
                *hits += group.share() * cut.saturating_sub(rank).min(group.size) as f64;
            }
            if group.relevant > 0 {
                gain += group.share() * (rank + 1..=rank + group.size).map(discount).sum::<f64>();
                precision += group.precision(rank, seen);
            }
            rank += group.size;
            seen += group.relevant;
        }
        let c = relevant as f64;
        let ideal: f64 = (1..=relevant).map(discount).sum();
        let e = 2.0 * hits[3] / (cuts[3] + relevant) as f64;
        Self { nn: hits[0], ft: hits[1] / c, st: hits[2] / c, e, dcg: gain / ideal, ap: precision / c }
    }

    /// The measures in the order of [`NAMES`].
    pub fn values(&self) -> [f64; 6] {
        [self.nn, self.ft, self.st, self.e, self.dcg, self.ap]
    }

    fn from_values([nn, ft, st, e, dcg, ap]: [f64; 6]) -> Self {
        Self { nn, ft, st, e, dcg, ap }
    }

    /// The mean; zeros for none.
    pub fn mean<'a>(scores: impl IntoIterator<Item = &'a Self>) -> Self {
        let mut sum = [0.0; 6];
        let mut n = 0;
        for one in scores {
            sum.iter_mut().zip(one.values()).for_each(|(sum, value)| *sum += value);
            n += 1;
        }
        Self::from_values(sum.map(|sum| sum / n.max(1) as f64))
    }
}

/// Consecutive models of a ranking that are equally far from the query.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Group {
    /// Number of its models.
    pub size: usize,
    /// Relevant models among them.
    pub relevant: usize,
}

impl Group {
    /// The probability that the model at a given place of the group is relevant.
    fn share(&self) -> f64 {
        self.relevant as f64 / self.size as f64
    }

    /// Expected sum of the precisions at the group's relevant models, after `rank` models, `seen` of them relevant.
    fn precision(&self, rank: usize, seen: usize) -> f64 {
        let others = (self.size - 1).max(1) as f64;
        let density = (self.relevant - 1) as f64 / others;
        let at = |place: usize| (seen as f64 + 1.0 + place as f64 * density) / (rank + place + 1) as f64;
        self.share() * (0..self.size).map(at).sum::<f64>()
    }
}

/// The weight of a hit at `rank`: ranks 1 and 2 both weigh 1.
fn discount(rank: usize) -> f64 {
    if rank < 2 { 1.0 } else { 1.0 / (rank as f64).log2() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn close(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-12
    }

    #[test]
    fn discounted_gain_counts_the_first_two_ranks_in_full() {
        // rel = [1, 0, 1, 0], C = 2: (1 + 1 / log2 3) / 2
        assert!((Scores::of(&[1, 3], 2, 4).dcg - 0.815465).abs() < 1e-6);
    }

    #[test]
    fn a_query_worked_by_hand() {
        // C = 2 at ranks 2 and 5 of 6: nothing first, one among 2, one among 4, both among 6
        let scores = Scores::of(&[2, 5], 2, 6);
        assert_eq!((scores.nn, scores.ft, scores.st, scores.e), (0.0, 0.5, 0.5, 0.5));
        assert!(close(scores.dcg, (1.0 + 1.0 / 5f64.log2()) / 2.0));
        assert!(close(scores.ap, (1.0 / 2.0 + 2.0 / 5.0) / 2.0));
    }

    #[test]
    fn the_second_tier_ends_with_the_gallery() {
        // C = 3 of 4: the second tier would be 6 long
        assert_eq!(Scores::of(&[2, 3, 4], 3, 4).st, 1.0);
    }

    #[test]
    fn relevant_models_that_were_not_found_count_0() {
        // C = 4, one found, second of 9
        let scores = Scores::of(&[2], 4, 9);
        assert_eq!((scores.ft, scores.st, scores.ap), (0.25, 0.25, 0.125));
        assert!(close(scores.dcg, 1.0 / (2.0 + 1.0 / 3f64.log2() + 0.5)));
        assert_eq!(Scores::of(&[], 4, 9), Scores::default());
    }

    #[test]
    fn the_e_measure_looks_at_32_and_may_find_nothing() {
        assert_eq!(Scores::of(&[33], 1, 96).e, 0.0);
        assert!(close(Scores::of(&[32], 1, 96).e, 2.0 / 33.0));
        assert!(close(Scores::of(&(1..=21).collect::<Vec<_>>(), 21, 96).e, 42.0 / 53.0));
    }

    /// All 0/1 sequences of `n` places with `c` ones, as the ranks of the ones.
    fn subsets(n: usize, c: usize) -> Vec<Vec<usize>> {
        let chosen = |bits: u32| (1..=n).filter(|r| bits >> (r - 1) & 1 == 1).collect::<Vec<_>>();
        (0..1u32 << n).filter(|bits| bits.count_ones() as usize == c).map(chosen).collect()
    }

    #[test]
    fn chance_is_the_mean_over_all_rankings() {
        for (n, c) in [(1, 1), (5, 2), (7, 3), (8, 7), (9, 1), (10, 4)] {
            let all: Vec<_> = subsets(n, c).iter().map(|ranks| Scores::of(ranks, c, n)).collect();
            let expected = Scores::expected([Group { size: n, relevant: c }], c, n);
            for (mean, formula) in Scores::mean(&all).values().iter().zip(expected.values()) {
                assert!(close(*mean, formula), "{n} {c}: {mean} {formula}");
            }
        }
    }

    #[test]
    fn ties_in_the_middle_are_the_mean_over_their_orders() {
        // one relevant first, then four tied with two relevant, then one relevant last
        let all: Vec<_> = subsets(4, 2)
            .iter()
            .map(|tied| {
                Scores::of(&[&[1], tied.iter().map(|r| r + 1).collect::<Vec<_>>().as_slice(), &[6]].concat(), 4, 6)
            })
            .collect();
        let groups = [(1, 1), (4, 2), (1, 1)].map(|(size, relevant)| Group { size, relevant });
        for (mean, formula) in Scores::mean(&all).values().iter().zip(Scores::expected(groups, 4, 6).values()) {
            assert!(close(*mean, formula));
        }
    }

    proptest! {
        #[test]
        fn measures_stay_between_0_and_1(bits in proptest::collection::vec(any::<bool>(), 1..80)) {
            let ranks: Vec<_> = (1..=bits.len()).filter(|r| bits[r - 1]).collect();
            prop_assume!(!ranks.is_empty());
            for value in Scores::of(&ranks, ranks.len(), bits.len()).values() {
                prop_assert!((0.0..=1.0 + 1e-12).contains(&value));
            }
        }
    }
}
