//! Directions that principal axes leave open, tried roughly.

use std::f64::consts::PI;

use super::Merger;
use crate::cancel::Cancelled;
use crate::geometry::bvh::Recent;
use crate::geometry::directions::half_sphere;
use crate::geometry::{Isometry, Plane, Vector, any_perpendicular};
use crate::stages::validate::support::Round;

/// Directions tried on half a circle, and on half a sphere: about 2 and 6 degrees apart.
const ON_CIRCLE: usize = 90;
const ON_SPHERE: usize = 600;
/// Promising directions are at least this far apart, radians.
const APART: [f64; 2] = [0.05, 0.15];
/// A mirrored sample this near (share of D) speaks for a direction that is half a step off.
const RADIUS: f64 = 0.04;
/// Samples for each direction, and the share of them that is worth a closer look.
const SAMPLES: usize = 100;
const SHARE: f64 = 0.7;
/// Directions that are looked at closely.
const MOST: usize = 12;

/// All directions, or those across an axis.
pub(super) struct Open {
    pub across: Option<Vector>,
}

impl Open {
    /// The directions whose planes through the centroid map most of the surface near itself, best first.
    pub fn promising(&self, merger: &Merger) -> Result<Vec<Vector>, Cancelled> {
        let mut rated = Vec::new();
        for direction in self.directions() {
            merger.cancel.check()?;
            let plane = Plane::through(&merger.parsed.measures.centroid, &direction);
            rated.extend(missed(merger, &plane.reflection()).map(|missed| (missed, direction)));
        }
        // Stable: equal ones stay in their order.
        rated.sort_by_key(|r| r.0);
        let apart = APART[usize::from(self.across.is_none())].sin();
        let mut chosen: Vec<Vector> = Vec::new();
        for (_, direction) in rated {
            if chosen.len() < MOST && chosen.iter().all(|c| c.cross(&direction).norm() >= apart) {
                chosen.push(direction);
            }
        }
        Ok(chosen)
    }

    fn directions(&self) -> Vec<Vector> {
        match self.across {
            Some(axis) => {
                let x = any_perpendicular(&axis);
                let y = axis.cross(&x);
                let angle = |i: usize| PI * i as f64 / ON_CIRCLE as f64;
                (0..ON_CIRCLE).map(|i| x * angle(i).cos() + y * angle(i).sin()).collect()
            }
            None => half_sphere(&[Vector::x(), Vector::y(), Vector::z()], ON_SPHERE).collect(),
        }
    }
}

/// How many of some samples have no image near the surface; `None` as soon as they are too many.
pub(super) fn missed(merger: &Merger, isometry: &Isometry) -> Option<usize> {
    let (field, measures) = (&merger.validated.field, &merger.parsed.measures);
    let radius = measures.tolerance.length(RADIUS);
    let samples = field.samples(Round::Coarse);
    let asked = samples.iter().step_by((samples.len() / SAMPLES).max(1));
    let most = ((1.0 - SHARE) * asked.len() as f64) as usize;
    let (mut missed, mut recent) = (0, Recent::default());
    for sample in asked {
        missed += usize::from(!field.maps_near(isometry, sample, radius, &mut recent));
        if missed > most {
            return None;
        }
    }
    Some(missed)
}
