//! Precision-recall curves: of one query from the ranks of its relevant models, and their means.

/// Recall levels 0, 0.1 .. 1 of the interpolated curve.
pub const INTERPOLATED: usize = 11;
/// Recall levels 0.05, 0.1 .. 1 of the Princeton curve.
pub const PRINCETON: usize = 20;

/// The two curves of one query.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curves {
    /// P(R): the highest precision at any recall >= R = 0, 0.1 .. 1 (TREC).
    pub pr11: [f64; INTERPOLATED],
    /// Precision at recall 0.05, 0.1 .. 1, linear between the hits (psbPlot); `None` below the recall of one hit.
    pub pr20: [Option<f64>; PRINCETON],
}

impl Curves {
    /// The curves of a query that finds its `relevant` models (at least one) at `ranks` (ascending, from 1); the
    /// precision at those that are not among them is 0.
    pub fn of(ranks: &[usize], relevant: usize) -> Self {
        let mut precisions: Vec<_> = ranks.iter().enumerate().map(|(c, &rank)| (c + 1) as f64 / rank as f64).collect();
        precisions.resize(relevant, 0.0);
        Self { pr11: interpolated(&precisions), pr20: princeton(&precisions) }
    }
}

/// `precisions[c - 1]` is the precision at the c-th hit, recall c / C.
fn interpolated(precisions: &[f64]) -> [f64; INTERPOLATED] {
    let relevant = precisions.len();
    std::array::from_fn(|level| {
        // the first hit c with c / C >= level / 10, in whole numbers
        let first = (level * relevant).div_ceil(INTERPOLATED - 1).max(1);
        precisions[first - 1..].iter().copied().fold(0.0, f64::max)
    })
}

/// Linear between the hits, as [`Curves::pr20`].
pub(super) fn princeton(precisions: &[f64]) -> [Option<f64>; PRINCETON] {
    std::array::from_fn(|level| {
        let scaled = (level + 1) * precisions.len();
        let (hits, rest) = (scaled / PRINCETON, scaled % PRINCETON);
        let at = *precisions.get(hits.checked_sub(1)?)?;
        let next = precisions.get(hits).copied().unwrap_or(at);
        Some(at + (next - at) * rest as f64 / PRINCETON as f64)
    })
}

/// Means of curves over queries; a level that no query reaches is `None`.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct MeanCurves {
    /// Interpolated precision at recall 0, 0.1 .. 1.
    pub pr11: [Option<f64>; INTERPOLATED],
    /// Precision at recall 0.05, 0.1 .. 1, as psbPlot has it.
    pub pr20: [Option<f64>; PRINCETON],
}

impl MeanCurves {
    /// The mean of `curves`, level by level, over those that count there.
    pub fn of<'a>(curves: impl IntoIterator<Item = &'a Curves>) -> Self {
        let (mut pr11, mut pr20) = ([Mean::default(); INTERPOLATED], [Mean::default(); PRINCETON]);
        for one in curves {
            pr11.iter_mut().zip(one.pr11).for_each(|(mean, value)| mean.add(value));
            pr20.iter_mut().zip(one.pr20).for_each(|(mean, value)| value.into_iter().for_each(|v| mean.add(v)));
        }
        Self { pr11: pr11.map(Mean::get), pr20: pr20.map(Mean::get) }
    }

    /// The mean over classes of their means.
    pub fn of_means(curves: &[Self]) -> Self {
        let (mut pr11, mut pr20) = ([Mean::default(); INTERPOLATED], [Mean::default(); PRINCETON]);
        for one in curves {
            pr11.iter_mut().zip(one.pr11).for_each(|(mean, value)| value.into_iter().for_each(|v| mean.add(v)));
            pr20.iter_mut().zip(one.pr20).for_each(|(mean, value)| value.into_iter().for_each(|v| mean.add(v)));
        }
        Self { pr11: pr11.map(Mean::get), pr20: pr20.map(Mean::get) }
    }
}

#[derive(Clone, Copy, Default)]
struct Mean {
    sum: f64,
    n: usize,
}

impl Mean {
    fn add(&mut self, value: f64) {
        self.sum += value;
        self.n += 1;
    }

    fn get(self) -> Option<f64> {
        (self.n > 0).then(|| self.sum / self.n as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_princeton_curve_of_a_class_of_six() {
        let curves = Curves::of(&[1, 4, 10, 41, 44], 5);
        let expected = [(0.2, 1.0), (0.4, 0.5), (0.6, 0.3), (0.8, 0.097561), (1.0, 0.113636)];
        for (recall, precision) in expected {
            let level = (recall * 20.0 + 0.5) as usize - 1;
            assert!((curves.pr20[level].unwrap() - precision).abs() < 1e-6);
        }
        // recall 0.3 is half-way between the first and the second hit
        assert!((curves.pr20[5].unwrap() - 0.75).abs() < 1e-12);
        assert_eq!(curves.pr20[..3], [None; 3]);
    }

    #[test]
    fn interpolation_takes_the_best_precision_further_on() {
        // hits at 2, 3 of C = 2: precisions 1/2 and 2/3
        assert_eq!(Curves::of(&[2, 3], 2).pr11, [2.0 / 3.0; 11]);
        // recall of the first hit is exactly 0.5: it still counts at 0.5
        let curves = Curves::of(&[1, 4], 2);
        assert_eq!((curves.pr11[5], curves.pr11[6]), (1.0, 0.5));
    }

    #[test]
    fn a_level_counts_from_the_first_hit_on() {
        // C = 3: 1 / 3 lies between 0.30 and 0.35
        let curves = Curves::of(&[1, 2, 3], 3);
        assert_eq!((curves.pr20[5], curves.pr20[6]), (None, Some(1.0)));
        // C = 20: the first level is the first hit
        assert_eq!(Curves::of(&(1..=20).collect::<Vec<_>>(), 20).pr20, [Some(1.0); 20]);
    }

    #[test]
    fn means_are_over_the_queries_that_count() {
        let mean = MeanCurves::of(&[Curves::of(&[1], 1), Curves::of(&[2, 4], 2)]);
        assert_eq!(mean.pr20[18], Some(0.5), "0.95: only the class of three");
        assert_eq!(mean.pr20[19], Some(0.75));
        assert_eq!(mean.pr20[0], None);
    }
}
