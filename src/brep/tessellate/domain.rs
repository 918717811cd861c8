//! A face's part of its parameter space -> triangles.

use smallvec::smallvec;

use super::Few;
use super::boundary::{Path, rectangle};
use super::chart::{Chart, Uv};
use super::columns::Columns;
use super::edges::Fineness;
use super::interior::Grid;
use super::strip;
use super::triangulate::{Chains, Room, delaunay, doubled_area, ears, zip};
use crate::geometry::{Point, Point2, polygon};
use crate::memory::held;

/// Regions without a triangle larger than this share of the whole are left out.
const EMPTY: f64 = 1e-9;

/// A triangulated face: points in space and in parameter space side by side. Filled anew for each face.
#[derive(Default)]
pub(super) struct Patch {
    pub points: Vec<Point>,
    pub uv: Vec<Uv>,
    /// Counter-clockwise in parameter space.
    pub triangles: Vec<[u32; 3]>,
    /// For each path: 1 where the face is on its left, -1 where it is on its right.
    pub sides: Few<f64>,
}

impl Patch {
    /// Bytes of memory that it holds.
    pub fn bytes(&self) -> usize {
        held(&self.points) + held(&self.uv) + held(&self.triangles)
    }

    pub fn clear(&mut self) {
        self.points.clear();
        self.uv.clear();
        self.triangles.clear();
        self.sides.clear();
    }

    /// Adds a point of the surface.
    pub fn add(&mut self, chart: &Chart, uv: Uv) {
        self.points.push(chart.point(uv));
        self.uv.push(uv);
    }

    /// Leaves out points that no triangle uses: grid nodes outside the face.
    fn drop_unused(&mut self) {
        const UNUSED: u32 = u32::MAX;
        let mut places = vec![UNUSED; self.uv.len()];
        let (mut points, mut uv) = (Vec::with_capacity(places.len()), Vec::with_capacity(places.len()));
        for index in self.triangles.iter_mut().flatten() {
            let place = &mut places[*index as usize];
            if *place == UNUSED {
                *place = uv.len() as u32;
                points.push(self.points[*index as usize]);
                uv.push(self.uv[*index as usize]);
            }
            *index = *place;
        }
        (self.points, self.uv) = (points, uv);
    }
}

/// Triangulates the part of the surface that the paths bound. `None` where they bound nothing sensible.
///
/// `quick`: ears and strips are tried before the constrained Delaunay triangulation with points inside.
pub(super) fn triangulate(
    chart: &Chart,
    paths: &mut [Path],
    fineness: &Fineness,
    quick: bool,
    patch: &mut Patch,
    room: &mut Room,
) -> Option<()> {
    if paths.iter().any(Path::winds) || is_complement(chart, paths) {
        return strip::triangulate(chart, paths, fineness, quick, patch);
    }
    let outer =
        (0..paths.len()).max_by(|&a, &b| paths[a].signed_area().abs().total_cmp(&paths[b].signed_area().abs()))?;
    gather_inside(chart, paths, outer);
    let layout = Layout::new(paths, outer)?;
    layout.add_points(paths, patch);
    let steps = chart.steps(layout.rectangle, fineness);
    let flat = matches!(*chart.surface, crate::brep::Surface::Plane(_));
    let ruled = chart.surface.is_ruled_along_v();
    if !flat && quick && layout.by_zip(patch, steps, &mut room.chains).is_some() {
        return Some(());
    }
    let flat_enough = flat || (quick && steps == [1, 1]);
    if flat_enough && ears(&patch.uv, &layout.rings, layout.area, room, &mut patch.triangles).is_some() {
        return Some(());
    }
    let cells =
        if ruled { Grid::rows_for_shape(layout.rectangle, steps, chart.scale(layout.rectangle)) } else { steps };
    by_delaunay(chart, &layout, patch, (!flat).then_some(cells))
}

/// On a closed surface a loop has a face on both sides. Seams tell which one it is; where there are none, the
/// direction of the largest loop.
fn is_complement(chart: &Chart, paths: &[Path]) -> bool {
    if !chart.is_closed() {
        return false;
    }
    let size = |p: &&Path| p.signed_area().abs();
    let Some(largest) = paths.iter().max_by(|a, b| size(a).total_cmp(&size(b))) else { return true };
    let polygon: Vec<Point2> = largest.uv.iter().map(|&uv| Point2::from(uv)).collect();
    let enclosed = |uv: &Uv| {
        chart.images(*uv, largest.rectangle()).any(|q| polygon::winding_number(&polygon, &Point2::from(q)) != 0)
    };
    let votes: i32 = chart.inner().map(|uv| if enclosed(&uv) { -1 } else { 1 }).sum();
    if votes != 0 { votes > 0 } else { (largest.signed_area() < 0.0) != chart.flipped }
}

/// Moves the other paths by whole periods into the outer one.
fn gather_inside(chart: &Chart, paths: &mut [Path], outer: usize) {
    if chart.periods == [None, None] || paths.len() == 1 {
        return;
    }
    let polygon: Vec<Point2> = paths[outer].uv.iter().map(|&uv| Point2::from(uv)).collect();
    let around = paths[outer].rectangle();
    for index in (0..paths.len()).filter(|&i| i != outer) {
        let start = paths[index].uv[0];
        let inside = |p: &Uv| polygon::winding_number(&polygon, &Point2::from(*p)) != 0;
        if let Some([u, v]) = chart.images(start, around).find(inside) {
            paths[index].shift([u - start[0], v - start[1]]);
        }
    }
}

/// The paths of a face laid out as rings, the outer one first.
struct Layout {
    order: Few<usize>,
    rings: Few<usize>,
    sides: Few<f64>,
    rectangle: [f64; 4],
    area: f64,
}

impl Layout {
    fn new(paths: &[Path], outer: usize) -> Option<Self> {
        let order: Few<usize> = std::iter::once(outer).chain((0..paths.len()).filter(|&i| i != outer)).collect();
        let mut sides = smallvec![1.0; paths.len()];
        let (mut rings, mut count, mut area) = (Few::new(), 0, 0.0);
        for &i in &order {
            let signed = paths[i].signed_area();
            sides[i] = if (signed > 0.0) == (i == outer) { 1.0 } else { -1.0 };
            area += if i == outer { signed.abs() } else { -signed.abs() };
            rings.push(count);
            count += paths[i].uv.len();
        }
        let rectangle = rectangle(paths[outer].uv.iter());
        (area > 0.0 && area.is_finite()).then_some(Self { order, rings, sides, rectangle, area })
    }

    /// Makes a patch of the points of the rings.
    fn add_points(&self, paths: &[Path], patch: &mut Patch) {
        patch.clear();
        patch.sides.extend_from_slice(&self.sides);
        for &i in &self.order {
            patch.points.extend_from_slice(&paths[i].points);
            patch.uv.extend_from_slice(&paths[i].uv);
        }
    }

    /// The rings as segments between `count` points.
    fn segments(&self, count: usize) -> Vec<[u32; 2]> {
        let ends = self.rings[1..].iter().copied().chain([count]);
        let ring = |(from, to): (usize, usize)| {
            (from..to).map(move |i| [i as u32, if i + 1 < to { i + 1 } else { from } as u32])
        };
        self.rings.iter().copied().zip(ends).flat_map(ring).collect()
    }

    /// A single ring on a surface that one step suffices for in one direction, as a strip along the other.
    fn by_zip(&self, patch: &mut Patch, steps: [usize; 2], room: &mut Chains) -> Option<()> {
        if self.rings.len() != 1 {
            return None;
        }
        let along = if steps[0] >= steps[1] { [0, 1] } else { [1, 0] };
        let mut straight_across = along.into_iter().filter(|&axis| steps[1 - axis] == 1);
        straight_across.find_map(|axis| self.zip_along(patch, axis, steps[axis], room))
    }

    /// Cuts the ring at its first and last u (or v) into two chains.
    fn zip_along(&self, patch: &mut Patch, axis: usize, steps: usize, room: &mut Chains) -> Option<()> {
        let Chains { ring, lower, upper, turned } = room;
        let uv = if axis == 0 {
            &patch.uv
        } else {
            turned.clear();
            // Mirrored, not only swapped, so that it still runs the same way round.
            turned.extend(patch.uv.iter().map(|p| [p[1], -p[0]]));
            &*turned
        };
        let [u0, u1] = [self.rectangle[2 * axis], self.rectangle[2 * axis + 1]];
        let near = 1e-7 * (u1 - u0);
        ring.clear();
        ring.extend(0..uv.len() as u32);
        if self.sides[self.order[0]] < 0.0 {
            ring.reverse();
        }
        cut_in_two(uv, ring, [u0 + near, u1 - near], lower, upper)?;
        let rising = |chain: &[u32]| chain.windows(2).all(|w| uv[w[1] as usize][0] >= uv[w[0] as usize][0] - near);
        if !rising(lower) || !rising(upper) {
            return None;
        }
        patch.triangles.clear();
        let [lower, upper] = [lower, upper].map(|chain| chain.iter().copied());
        zip(uv, lower, upper, self.area, 1.7 * (u1 - u0) / steps as f64 + near, &mut patch.triangles)
    }
}

/// The lower and the upper chain of a counter-clockwise ring, both from its first to its last u.
fn cut_in_two(
    uv: &[Uv],
    ring: &mut [u32],
    [first, last]: [f64; 2],
    lower: &mut Vec<u32>,
    upper: &mut Vec<u32>,
) -> Option<()> {
    let n = ring.len();
    let at_start = |&i: &u32| uv[i as usize][0] <= first;
    // The last point on the left side is its lowest.
    let start = (0..n).find(|&k| at_start(&ring[k]) && !at_start(&ring[(k + 1) % n]))?;
    ring.rotate_left(start);
    let right = ring.iter().position(|&i| uv[i as usize][0] >= last)?;
    lower.clear();
    lower.extend_from_slice(&ring[..=right]);
    upper.clear();
    upper.push(ring[0]);
    upper.extend(ring[right..].iter().rev());
    Some(())
}

/// Constrained Delaunay with grid points; the inside is where a ray crosses an odd number of segments.
fn by_delaunay(chart: &Chart, layout: &Layout, patch: &mut Patch, grid: Option<[usize; 2]>) -> Option<()> {
    let segments = layout.segments(patch.uv.len());
    let sides: Vec<[Uv; 2]> = segments.iter().map(|s| s.map(|i| patch.uv[i as usize])).collect();
    let mut scale = chart.scale(rectangle(patch.uv.iter()));
    if let Some(cells) = grid {
        scale = chart.metric(layout.rectangle, cells);
        let mut grid = Grid::new(layout.rectangle, cells);
        sides.iter().for_each(|[a, b]| grid.block(a, b));
        grid.nodes(false).for_each(|uv| patch.add(chart, uv));
    }
    let columns = Columns::new(&sides, 0);
    let inside = |p: &Uv| columns.below(p) % 2 == 1;
    fill(chart, patch, &segments, scale, inside)
}

/// Whether the segment passes below `p`, "below" being towards smaller values of the coordinate that is not `along`.
pub(super) fn crosses_below(a: &Uv, b: &Uv, p: &Uv, along: usize) -> bool {
    let up = 1 - along;
    if (a[along] <= p[along]) == (b[along] <= p[along]) {
        return false;
    }
    let s = (p[along] - a[along]) / (b[along] - a[along]);
    a[up] + s * (b[up] - a[up]) < p[up]
}

/// Triangulates the points and keeps the regions that are inside.
pub(super) fn fill(
    chart: &Chart,
    patch: &mut Patch,
    segments: &[[u32; 2]],
    scale: [f64; 2],
    inside: impl Fn(&Uv) -> bool,
) -> Option<()> {
    let origin = patch.uv.first().copied()?;
    let scaled: Vec<Uv> =
        patch.uv.iter().map(|p| [(p[0] - origin[0]) * scale[0], (p[1] - origin[1]) * scale[1]]).collect();
    let cut = delaunay(&scaled, segments, &|| chart.is_cancelled())?;
    for p in &cut.added {
        patch.add(chart, [origin[0] + p[0] / scale[0], origin[1] + p[1] / scale[1]]);
    }
    // Along a straight border rounding leaves slivers outside that no ray can tell from the inside.
    let least = EMPTY * cut.triangles.iter().map(|t| doubled_area(&patch.uv, t)).sum::<f64>();
    let keep: Vec<bool> = cut
        .largest
        .iter()
        .map(|&t| {
            let corners = cut.triangles[t as usize];
            let [a, b, c] = corners.map(|i| patch.uv[i as usize]);
            doubled_area(&patch.uv, &corners) > least
                && !chart.is_cancelled()
                && inside(&[(a[0] + b[0] + c[0]) / 3.0, (a[1] + b[1] + c[1]) / 3.0])
        })
        .collect();
    let kept = cut.triangles.iter().zip(&cut.regions).filter(|(_, r)| keep[**r as usize]);
    patch.triangles.clear();
    patch.triangles.extend(kept.map(|(t, _)| *t));
    patch.drop_unused();
    (!patch.triangles.is_empty()).then_some(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::{Placement, Surface};
    use crate::geometry::Vector;

    #[test]
    fn slivers_along_a_straight_side_are_not_inside() {
        let axes = Placement { origin: Point::origin(), x: Vector::x(), y: Vector::y(), z: Vector::z() };
        let surface = Surface::Plane(axes);
        let chart = Chart::new(&surface, true, &[], 1.0);
        let mut patch = Patch::default();
        // The second point is pushed inwards by rounding: the hull's side passes below it.
        let border = [[0.0, 0.0], [1.0, 1e-17], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]];
        border.iter().for_each(|&uv| patch.add(&chart, uv));
        let segments: Vec<[u32; 2]> = (0..5).map(|i| [i, (i + 1) % 5]).collect();
        fill(&chart, &mut patch, &segments, [1.0, 1.0], |_| true).unwrap();
        assert_eq!(patch.triangles.len(), 3);
    }
}
