//! Directions that principal axes leave open, tried roughly.

use std::f64::consts::PI;

use super::Merger;
use crate::brep::sample::Sample;
use crate::cancel::Cancelled;
use crate::geometry::bvh::Recent;
use crate::geometry::{Plane, Vector, any_perpendicular};
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
    /// Whether a direction is among them.
    pub fn has(&self, normal: &Vector) -> bool {
        self.across.is_none_or(|axis| axis.dot(normal).abs() <= 0.035)
    }

    /// The directions whose planes through the centroid map most of the surface near itself, best first.
    pub fn promising(&self, merger: &Merger) -> Result<Vec<Vector>, Cancelled> {
        let mut rated = Vec::new();
        for direction in self.directions() {
            merger.cancel.check()?;
            rated.push((share(merger, &direction), direction));
        }
        rated.retain(|r| r.0 >= SHARE);
        // Stable: equal ones stay in their order.
        rated.sort_by(|a, b| b.0.total_cmp(&a.0));
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
            None => {
                // The lattice of Fibonacci, the golden angle from one to the next.
                let golden = PI * (3.0 - 5.0_f64.sqrt());
                let direction = |i: usize| {
                    let z = (i as f64 + 0.5) / ON_SPHERE as f64;
                    let (r, angle) = ((1.0 - z * z).sqrt(), golden * i as f64);
                    Vector::new(r * angle.cos(), r * angle.sin(), z)
                };
                (0..ON_SPHERE).map(direction).collect()
            }
        }
    }
}

/// The share of some samples whose mirror image is near the surface.
fn share(merger: &Merger, normal: &Vector) -> f64 {
    let (field, measures) = (&merger.validated.field, &merger.parsed.measures);
    let plane = Plane::through(&measures.centroid, normal);
    let radius = measures.tolerance.length(RADIUS);
    let samples = field.samples(Round::Coarse);
    let step = (samples.len() / SAMPLES).max(1);
    let mut recent = Recent::default();
    let mut near = |s: &&Sample| {
        let (p, normal) = (plane.reflect(&s.point), plane.reflect_vector(&s.normal));
        field.touches((&p, &normal), radius, &mut recent, |_| true)
    };
    let asked = samples.iter().step_by(step);
    asked.clone().filter(|s| near(s)).count() as f64 / asked.count().max(1) as f64
}
