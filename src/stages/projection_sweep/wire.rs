//! The edges of a mesh as slices cross them.

use std::ops::Range;

use crate::brep::Wireframe;
use crate::geometry::cells::{first_centre, starts};

use super::reference::Turntable;
use super::slices::{Flat, NOISE};

/// A wireframe with the level of each vertex (the first slice at or above it); of its edges and triangles those that cross
/// slices.
#[derive(Default)]
pub(super) struct Wire {
    vertices: Vec<WireVertex>,
    /// First one that crosses no slice and stands for all those.
    edges: Vec<Edge>,
    triangles: Vec<Triangle>,
    /// The slices that edges and triangles cross, in the order of the first of these.
    pub rising_edges: Vec<(Range<u32>, u32)>,
    pub rising_triangles: Vec<(Range<u32>, u32)>,
    low: f64,
    thickness: f64,
}

struct WireVertex {
    at: Flat,
    height: f64,
    level: u32,
}

/// An edge between two levels.
struct Edge {
    /// Lower and upper vertex.
    ends: [u32; 2],
    /// Whether hulls may have corners where it crosses a slice.
    bends: bool,
    /// All slices cross it at the same place.
    upright: bool,
}

/// A triangle that crosses slices, as its sides.
pub(super) struct Triangle {
    /// From the lowest corner to the highest.
    pub long: u32,
    /// From the lowest corner to the middle one, and from there to the highest.
    pub short: [u32; 2],
    /// The level of the middle corner.
    pub middle: u32,
}

impl Wire {
    pub fn new(wireframe: &Wireframe, table: &Turntable, low: f64, thickness: f64, count: usize) -> Self {
        let vertices = wireframe.vertices.iter().map(|p| {
            let d = p - table.centre;
            let height = table.axis.dot(&d);
            let level = first_centre((height - low) / thickness, count) as u32;
            WireVertex { at: [table.u.dot(&d), table.v.dot(&d)], height, level }
        });
        let none = Edge { ends: [0; 2], bends: false, upright: false };
        let mut wire = Self { vertices: vertices.collect(), edges: vec![none], low, thickness, ..Self::default() };
        let numbers = wire.add_edges(wireframe);
        wire.add_triangles(wireframe, &numbers);
        let edges = (1..wire.edges.len() as u32).map(|edge| (wire.span(edge), edge));
        let triangles = wire.triangles.iter().zip(0..).map(|(triangle, number)| (wire.span(triangle.long), number));
        (wire.rising_edges, wire.rising_triangles) = (rising(edges, count), rising(triangles, count));
        wire
    }

    /// Adds the edges that cross slices; the number here of each edge of the wireframe.
    fn add_edges(&mut self, wireframe: &Wireframe) -> Vec<u32> {
        let reach = self.vertices.iter().flat_map(|v| v.at).fold(0.0, |most: f64, c| most.max(c.abs()));
        let mut number = |(&[a, b], &bends): (&[u32; 2], &bool)| {
            let [p, q] = [a, b].map(|i| &self.vertices[i as usize]);
            if p.level == q.level {
                return 0;
            }
            let apart = (p.at[0] - q.at[0]).abs().max((p.at[1] - q.at[1]).abs());
            let ends = if p.level < q.level { [a, b] } else { [b, a] };
            self.edges.push(Edge { ends, bends, upright: apart <= NOISE * reach });
            self.edges.len() as u32 - 1
        };
        wireframe.edges.iter().zip(&wireframe.bends).map(&mut number).collect()
    }

    /// Adds the triangles that do not lie between two slices.
    fn add_triangles(&mut self, wireframe: &Wireframe, numbers: &[u32]) {
        for sides in &wireframe.triangles {
            let levels = sides.map(|side| self.vertices[wireframe.start(side)].level);
            let mut corners = [0, 1, 2];
            corners.sort_unstable_by_key(|&corner| levels[corner]);
            let [low, middle, high] = corners;
            if levels[low] < levels[high] {
                let opposite = |corner: usize| numbers[sides[(corner + 1) % 3].edge()];
                let (long, short) = (opposite(middle), [opposite(high), opposite(low)]);
                self.triangles.push(Triangle { long, short, middle: levels[middle] });
            }
        }
    }

    /// The slices that the edge crosses.
    fn span(&self, edge: u32) -> Range<u32> {
        let [lower, upper] = self.edges[edge as usize].ends.map(|i| self.vertices[i as usize].level);
        lower..upper
    }

    /// How often edges cross slices.
    pub fn crossings(&self) -> usize {
        self.rising_edges.iter().map(|(slices, _)| slices.len()).sum()
    }

    pub fn triangle(&self, number: u32) -> &Triangle {
        &self.triangles[number as usize]
    }

    /// Whether hulls may have corners where the edge crosses.
    pub fn bends(&self, edge: u32) -> bool {
        self.edges[edge as usize].bends
    }

    /// Whether all slices cross the edge at the same place.
    pub fn is_upright(&self, edge: u32) -> bool {
        self.edges[edge as usize].upright
    }

    /// Where an edge crosses a slice.
    pub fn crossing(&self, edge: u32, slice: u32) -> Flat {
        let [a, b] = self.edges[edge as usize].ends.map(|i| &self.vertices[i as usize]);
        let height = self.low + (f64::from(slice) + 0.5) * self.thickness;
        let share = ((height - a.height) / (b.height - a.height)).clamp(0.0, 1.0);
        [a.at[0] + share * (b.at[0] - a.at[0]), a.at[1] + share * (b.at[1] - a.at[1])]
    }
}

/// In the order of the first of `count` slices that each crosses.
fn rising(spans: impl Iterator<Item = (Range<u32>, u32)>, count: usize) -> Vec<(Range<u32>, u32)> {
    let spans: Vec<_> = spans.map(|span| (span.0.start, span)).collect();
    let mut rising = Vec::new();
    group(&spans, count + 1, &mut rising, &mut Vec::new());
    rising
}

/// Sorts things by the number of their group, those of one in the order in which they came, and tells where each of
/// `count` groups ends.
pub(super) fn group<T: Clone + Default>(things: &[(u32, T)], count: usize, sorted: &mut Vec<T>, ends: &mut Vec<usize>) {
    ends.clear();
    ends.resize(count, 0);
    things.iter().for_each(|(group, _)| ends[*group as usize] += 1);
    // Sizes become starts, and as things are put in, ends.
    sorted.resize(starts(ends), T::default());
    for (group, thing) in things {
        let end = &mut ends[*group as usize];
        sorted[*end] = thing.clone();
        *end += 1;
    }
}
