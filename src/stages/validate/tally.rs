//! How exactly samples tell a share.

/// A share told by samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Support {
    /// From 0 to 1.
    pub share: f64,
    /// Its standard error.
    pub error: f64,
}

/// Hits among samples, face by face. As each face has its part of the samples, what is hit or missed as a whole adds
/// nothing to the error (stratified sampling: Cochran, Sampling Techniques, 1977, section 5.3).
#[derive(Clone, Copy, Debug, Default)]
pub struct Tally {
    asked: usize,
    hits: usize,
    /// Variance of the hits.
    variance: f64,
    /// Samples, and hits, of faces with few: together they are one more stratum.
    few: [usize; 2],
}

/// Samples of a face that tell nothing of their variance.
const FEW: usize = 3;

impl Tally {
    /// One that goes on where `asked` samples told `known`.
    pub fn from(known: Support, asked: usize) -> Self {
        let count = asked as f64;
        let (hits, variance) = ((known.share * count).round() as usize, (known.error * count).powi(2));
        Self { asked, hits, variance, few: [0; 2] }
    }

    /// Counts samples of one face.
    pub fn add(&mut self, asked: usize, hits: usize) {
        self.asked += asked;
        self.hits += hits;
        if asked > FEW {
            self.variance += binomial(asked, hits);
        } else {
            self.few = [self.few[0] + asked, self.few[1] + hits];
        }
    }

    /// Samples that were no hits.
    pub fn missed(&self) -> usize {
        self.asked - self.hits
    }

    /// The share of `count` samples, of which those that were not asked are no hits.
    pub fn support(&self, count: usize) -> Support {
        let count = count.max(1) as f64;
        let variance = self.variance + binomial(self.few[0], self.few[1]);
        Support { share: self.hits as f64 / count, error: variance.sqrt() / count }
    }
}

fn binomial(asked: usize, hits: usize) -> f64 {
    hits as f64 * (asked - hits) as f64 / asked.max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_faces_that_are_hit_in_part_are_in_doubt() {
        let mut tally = Tally::default();
        tally.add(60, 60);
        tally.add(20, 0);
        assert_eq!(tally.support(100), Support { share: 0.6, error: 0.0 });
        tally.add(16, 8);
        // 16 times 1/2 times 1/2.
        assert_eq!(tally.support(100), Support { share: 0.68, error: 0.02 });
        (0..4).for_each(|i| tally.add(1, i % 2));
        // Four faces of one sample each: 4 times 1/4 more.
        assert_eq!(tally.support(100), Support { share: 0.7, error: 5f64.sqrt() / 100.0 });
        assert_eq!(tally.missed(), 30);
    }

    #[test]
    fn a_tally_goes_on_where_another_ended() {
        let mut tally = Tally::from(Support { share: 0.5, error: 0.1 }, 10);
        tally.add(10, 10);
        assert_eq!(tally.support(20), Support { share: 0.75, error: 0.05 });
    }
}
