//! Stage 3: corners of each face -> pairs of faces that an isometry may map onto each other.
//!
//! In: the [`Outline`]s. Out: [`Matches`]: for each pair how the corners correspond.
//!
//! Method: section IV.B, eq. (3): two loops of corners match where the sum of the absolute differences of
//! consecutive corner distances is near zero, in some cyclic offset and one of two directions (`cyclic`). Faces are
//! compared only within buckets of equal invariants (`buckets`), and in a bucket of very many congruent faces only a
//! fixed subset meets all others: a global symmetry takes every face of the subset to some face of the bucket, so
//! its plane is still among the candidates. Faces of a body in several places are matched once for all of them.
//!
//! Cost: faces times the subset's size; corners squared for each pair. It does not promise that matched faces are
//! congruent: corner distances do not tell a rhombus from a square. The fit decides.

pub mod buckets;
mod cyclic;

use rustc_hash::FxHashMap;

use crate::cancel::{Cancel, Cancelled};
use crate::geometry::Point;
use crate::stages::corner_filter::{Outline, Shape};
use crate::stages::parse::Parsed;
use crate::stages::{ModelError, Stage};

/// Settings of the stage.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    /// Largest sum of eq. (3) for each corner, as a share of D. Files are precise to about 1e-6 D; parts that are
    /// meant to be equal differ by less than this, parts meant to differ by more.
    pub corner_distance: f64,
    /// Use absolute differences in eq. (3). As the paper's text prints it the sum is a difference of perimeters.
    pub absolute: bool,
    /// Compare only faces with equal invariants; the paper compares all with equal corner counts.
    pub buckets: bool,
    /// Match mirror images in reversed order only where faces have an outside; the paper tries both orders.
    pub orientation: bool,
    /// Corners one face may have more than the other.
    pub extra_corners: usize,
    /// Of a bucket, this many faces meet all others; the rest only them.
    pub subset: usize,
    /// Pairs in all, as a multiple of the number of faces: bounds time and memory.
    pub pairs_per_face: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            corner_distance: 1e-3,
            absolute: true,
            buckets: true,
            orientation: true,
            extra_corners: 2,
            subset: 8,
            pairs_per_face: 32,
        }
    }
}

impl Options {
    /// The paper's reading.
    pub fn paper() -> Self {
        Self {
            absolute: false,
            buckets: false,
            orientation: false,
            subset: 256,
            pairs_per_face: 256,
            ..Self::default()
        }
    }
}

/// The direction in which the second face's corners are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Order {
    /// As direct isometries keep it.
    Same,
    /// As mirror images have it.
    Reversed,
}

/// What of the two faces corresponds.
#[derive(Clone, Debug, PartialEq)]
pub enum Correspondence {
    /// Corner k of the first face to corner `offset` + k (or - k) of the second.
    Cyclic {
        /// Where the other face's corners start.
        offset: u32,
        /// In which direction they run.
        order: Order,
    },
    /// Pairs of corner positions, where one face has more corners than the other.
    Listed {
        /// Corner of one face, corner of the other.
        corners: Vec<(u32, u32)>,
        /// In which direction they run.
        order: Order,
    },
    /// Faces without enough corners: only their centroids (and axes, if they have any).
    Centroids,
}

/// Two faces (or one and itself) that may be images of each other.
#[derive(Clone, Debug, PartialEq)]
pub struct FacePair {
    /// Positions among the outlines; equal for a face that may be its own image.
    pub faces: [u32; 2],
    /// Which corner of one face belongs to which of the other.
    pub correspondence: Correspondence,
    /// How many pairs of its bucket this one stands for.
    pub weight: f64,
}

impl FacePair {
    /// The corresponding corners of the first and the second face.
    pub fn corners(&self, outlines: &[Outline]) -> Corners {
        let mut corners = Corners::default();
        corners.add(self, outlines);
        corners
    }

    /// Whether the two are different faces.
    pub fn is_of_two(&self) -> bool {
        self.faces[0] != self.faces[1]
    }

    /// The order of the corners; `None` where only centroids correspond.
    pub fn order(&self) -> Option<Order> {
        match &self.correspondence {
            Correspondence::Cyclic { order, .. } | Correspondence::Listed { order, .. } => Some(*order),
            Correspondence::Centroids => None,
        }
    }
}

/// Corresponding corners of pairs of faces: those of the first, and of the second in the same order.
#[derive(Clone, Debug, Default)]
pub struct Corners {
    /// Of the first face.
    pub from: Vec<Point>,
    /// Of the second.
    pub to: Vec<Point>,
}

impl Corners {
    /// Forgets the corners and keeps the memory.
    pub fn clear(&mut self) {
        self.from.clear();
        self.to.clear();
    }

    /// Adds the corners of a pair; none where only centroids correspond.
    pub fn add(&mut self, pair: &FacePair, outlines: &[Outline]) {
        let [a, b] = pair.faces.map(|i| &outlines[i as usize].corners);
        match &pair.correspondence {
            Correspondence::Cyclic { offset, order } => {
                self.from.extend_from_slice(a);
                cyclic::from_offset(b, *offset as usize, *order, |corner| self.to.push(*corner));
            }
            Correspondence::Listed { corners, .. } => {
                self.from.extend(corners.iter().map(|&(i, _)| a[i as usize]));
                self.to.extend(corners.iter().map(|&(_, j)| b[j as usize]));
            }
            Correspondence::Centroids => {}
        }
    }
}

/// The matched pairs.
#[derive(Clone, Debug, Default)]
pub struct Matches {
    /// Pairs of outlines, in growing order.
    pub pairs: Vec<FacePair>,
    /// Whether the bound on pairs cut the search short.
    pub truncated: bool,
}

/// Finds the pairs of faces whose corners, in order, are equally far apart.
///
/// # Errors
/// Only when cancelled.
pub fn pair_match(
    parsed: &Parsed,
    outlines: &[Outline],
    options: &Options,
    cancel: &Cancel,
) -> Result<Matches, ModelError> {
    let size = parsed.measures.tolerance.size();
    let mut loops = cyclic::Loops::default();
    outlines.iter().for_each(|outline| loops.push(&outline.corners));
    let mut matcher = Matcher {
        outlines,
        loops,
        options,
        cancel,
        size,
        room: options.pairs_per_face.saturating_mul(outlines.len()).max(4096),
        known: FxHashMap::default(),
        found: Vec::new(),
        matches: Matches::default(),
    };
    for bucket in buckets::plan(outlines, &parsed.measures, options) {
        matcher.bucket(&bucket).map_err(|c| ModelError::cancelled(Stage::PairMatch, c))?;
    }
    Ok(matcher.matches)
}

/// Collects the matches of one model.
struct Matcher<'a> {
    outlines: &'a [Outline],
    /// Their corners.
    loops: cyclic::Loops<'a>,
    options: &'a Options,
    cancel: &'a Cancel,
    size: f64,
    /// Pairs that may still be kept.
    room: usize,
    /// What was found for faces of bodies in several places, and whether it was a face and itself.
    known: FxHashMap<(Shape, Shape, bool), Vec<Correspondence>>,
    /// Memory for what is found for two faces.
    found: Vec<Correspondence>,
    matches: Matches,
}

impl Matcher<'_> {
    /// Lets each face of the bucket's subset meet all faces of its neighbourhood.
    fn bucket(&mut self, bucket: &buckets::Bucket) -> Result<(), Cancelled> {
        // Faces of one shape are in one bucket.
        self.known.clear();
        for &(a, b) in &bucket.meetings {
            if self.room == 0 {
                self.matches.truncated = true;
                return Ok(());
            }
            self.cancel.check()?;
            self.meet(a, b, bucket.weight)?;
        }
        Ok(())
    }

    fn meet(&mut self, a: u32, b: u32, weight: f64) -> Result<(), Cancelled> {
        let (p, q) = (&self.outlines[a as usize], &self.outlines[b as usize]);
        if self.options.buckets && !buckets::alike(p, q, self.size) {
            return Ok(());
        }
        if p.corners.len() < 3 || q.corners.len() < 3 {
            if self.options.buckets && a != b {
                self.keep([a, b], weight, [Correspondence::Centroids]);
            }
            return Ok(());
        }
        let mut found = std::mem::take(&mut self.found);
        found.clear();
        match p.shape.zip(q.shape) {
            Some((s, t)) => match self.known.get(&(s, t, a == b)) {
                Some(known) => found.extend_from_slice(known),
                None => {
                    self.correspondences(a, b, &mut found)?;
                    self.known.insert((s, t, a == b), found.clone());
                }
            },
            None => self.correspondences(a, b, &mut found)?,
        }
        self.keep([a, b], weight, found.drain(..));
        self.found = found;
        Ok(())
    }

    /// Adds all ways in which the corners of two faces correspond.
    fn correspondences(&self, a: u32, b: u32, found: &mut Vec<Correspondence>) -> Result<(), Cancelled> {
        let (p, q) = (&self.outlines[a as usize], &self.outlines[b as usize]);
        let search = cyclic::Search {
            limit: self.options.corner_distance * self.size,
            options: self.options,
            cancel: self.cancel,
        };
        let both = !(self.options.orientation && p.oriented && q.oriented);
        for order in [Order::Reversed, Order::Same] {
            // A face is always its own image in the same order: that says nothing of symmetry, unless it has no side.
            if order == Order::Same && a == b && !both {
                continue;
            }
            search.matches(self.loops.get(a as usize), self.loops.get(b as usize), order, &mut |c| found.push(c))?;
        }
        Ok(())
    }

    /// Keeps pairs of two faces while there is room.
    fn keep(&mut self, faces: [u32; 2], weight: f64, found: impl IntoIterator<Item = Correspondence>) {
        for correspondence in found.into_iter().take(self.room) {
            self.room -= 1;
            self.matches.pairs.push(FacePair { faces, correspondence, weight });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Transform, Vector};
    use crate::stages::corner_filter::{self, corner_filter};
    use crate::stages::fixture::{add_copy, prism, solid};

    /// A wedge, and the same body once more, pushed aside along other axes.
    fn two_wedges([x, y]: [Vector; 2]) -> Parsed {
        let mut parsed = solid(&prism(&[[0.0, 0.0], [4.0, 0.0], [0.0, 3.0]], 2.0), &Transform::identity());
        let z = Vector::z() * x.norm();
        add_copy(&mut parsed, &Transform::from_axes(&Point::new(9.0, 1.0, 0.0), &x, &y, &z));
        parsed
    }

    #[test]
    fn faces_of_one_body_in_two_places_match_as_those_of_two_bodies_do() {
        let (x, y) = (Vector::x(), Vector::y());
        for (axes, mirrored) in [([y, -x], false), ([x, -y], true), ([2.0 * x, 2.0 * y], false)] {
            let parsed = two_wedges(axes);
            let outlines = corner_filter(&parsed, &corner_filter::Options::default(), &Cancel::new()).unwrap();
            let matches = |of: &[Outline]| pair_match(&parsed, of, &Options::default(), &Cancel::new()).unwrap().pairs;
            let shared = matches(&outlines);
            assert!(outlines.iter().all(|outline| outline.shape.is_some()));
            assert_eq!(outlines[0].shape == outlines[5].shape, !mirrored && axes[0].norm() == 1.0);
            let apart: Vec<_> = outlines.into_iter().map(|outline| Outline { shape: None, ..outline }).collect();
            assert_eq!(shared, matches(&apart));
            // The two triangles of a wedge and those of the other: each of the four with three others and itself.
            let triangles = shared.iter().filter(|p| p.faces.iter().all(|f| f % 5 < 2)).count();
            assert_eq!(triangles, if axes[0].norm() == 1.0 { 6 } else { 2 });
        }
    }
}
