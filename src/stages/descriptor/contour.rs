//! Outer contours, traced along the boundaries of pixels.

use crate::silhouette::Silhouette;

/// A closed polygon in pixel units, counter-clockwise (first image axis right, second up).
#[derive(Clone, Debug, PartialEq)]
pub struct Contour {
    /// Corners in order, in the picture plane.
    pub points: Vec<[f64; 2]>,
}

/// The four directions of a crack, counter-clockwise: right, up, left, down.
const STEPS: [[isize; 2]; 4] = [[1, 0], [0, 1], [-1, 0], [0, -1]];

/// Pixel corners averaged on each side of one: turns the stairs of a slanted edge into a line (without it the length
/// of a diagonal is 41 % too large and the spacing of the points depends on the direction) and blunts a corner by
/// about a pixel.
const SMOOTHED: usize = 3;

impl Contour {
    /// The outer contour that encloses the largest area, and whether it is the only one; `None` for an empty picture.
    ///
    /// Pixels that touch at a corner are connected.
    pub fn largest(picture: &Silhouette) -> Option<(Self, bool)> {
        let mut best: Option<(i64, Vec<[isize; 2]>)> = None;
        let mut outer = 0;
        for path in boundaries(picture) {
            let area = doubled_area(&path);
            outer += usize::from(area > 0);
            if best.as_ref().is_none_or(|(most, _)| area > *most) {
                best = Some((area, path));
            }
        }
        best.map(|(_, path)| (Self { points: path.iter().map(|p| p.map(|c| c as f64)).collect() }, outer == 1))
    }

    /// Covered pixels of a picture inside this contour (which runs along the boundaries of pixels).
    pub fn enclosed(&self, picture: &Silhouette) -> usize {
        let ends = self.points.iter().cycle().skip(1);
        let crossing = |(p, q): (&[f64; 2], &[f64; 2])| (p[1] != q[1]).then(|| [p[1].min(q[1]) as u32, p[0] as u32]);
        // Row by row, and in each from left to right: in, out, in, out.
        let mut crossings: Vec<_> = self.points.iter().zip(ends).filter_map(crossing).collect();
        crossings.sort_unstable();
        let inside = |pair: &[[u32; 2]]| picture.count(pair[0][0] as usize, pair[0][1] as usize, pair[1][1] as usize);
        crossings.chunks_exact(2).map(inside).sum()
    }

    /// The contour with its stairs smoothed to lines.
    pub fn smoothed(&self) -> Self {
        const WIDTH: usize = 2 * SMOOTHED + 1;
        let n = self.points.len();
        let shares = self.points.iter().cycle().skip(n - SMOOTHED % n).take(n + WIDTH - 1);
        let shares: Vec<_> = shares.map(|p| p.map(|c| c / WIDTH as f64)).collect();
        let mean = |near: &[[f64; 2]]| near.iter().fold([0.0; 2], |sum, p| [sum[0] + p[0], sum[1] + p[1]]);
        Self { points: shares.windows(WIDTH).map(mean).collect() }
    }
}

/// All boundaries of a picture as chains of pixel corners, in order of their lowest left edge.
pub fn boundaries(picture: &Silhouette) -> Vec<Vec<[isize; 2]>> {
    let mut seen = Silhouette::new(picture.side());
    let mut paths = Vec::new();
    picture.each_run(|y, first, _| {
        let left = [first, y].map(|c| c as isize);
        if !seen.get(left[0], left[1]) {
            paths.push(trace(picture, left, &mut seen));
        }
    });
    paths
}

/// Follows the boundary that holds the left edge of a covered pixel, the covered side on the left, and marks all left
/// edges that it passes. Outer boundaries come out counter-clockwise, holes clockwise.
fn trace(picture: &Silhouette, [x, y]: [isize; 2], seen: &mut Silhouette) -> Vec<[isize; 2]> {
    let start = ([x, y + 1], 3);
    let (mut at, mut heading) = start;
    let mut path = Vec::new();
    loop {
        path.push(at);
        if heading == 3 {
            seen.fill(at[1] as usize - 1, at[0] as usize, at[0] as usize + 1);
        }
        at = [at[0] + STEPS[heading][0], at[1] + STEPS[heading][1]];
        heading = turn(picture, at, heading);
        if (at, heading) == start {
            return path;
        }
    }
}

/// The next heading at a pixel corner: right where the pixel ahead on the right is covered (so that pixels touching
/// at a corner stay together), straight on along a covered pixel on the left, else left.
fn turn(picture: &Silhouette, at: [isize; 2], heading: usize) -> usize {
    let (left, right) = ahead(at, heading);
    if picture.get(right[0], right[1]) {
        (heading + 3) % 4
    } else if picture.get(left[0], left[1]) {
        heading
    } else {
        (heading + 1) % 4
    }
}

/// The pixels ahead of a corner, to the left and to the right of the heading.
fn ahead([x, y]: [isize; 2], heading: usize) -> ([isize; 2], [isize; 2]) {
    match heading {
        0 => ([x, y], [x, y - 1]),
        1 => ([x - 1, y], [x, y]),
        2 => ([x - 1, y - 1], [x - 1, y]),
        _ => ([x, y - 1], [x - 1, y - 1]),
    }
}

fn doubled_area(path: &[[isize; 2]]) -> i64 {
    let Some(mut previous) = path.last() else { return 0 };
    let mut doubled = 0;
    for p in path {
        doubled += (previous[0] * p[1] - previous[1] * p[0]) as i64;
        previous = p;
    }
    doubled
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pixel_has_four_sides() {
        let picture = Silhouette::from_text("... .#. ...");
        let contour = Contour::largest(&picture).unwrap().0;
        assert_eq!(contour.points, vec![[1.0, 2.0], [1.0, 1.0], [2.0, 1.0], [2.0, 2.0]]);
        assert_eq!(contour.enclosed(&picture), 1);
    }

    #[test]
    fn holes_are_enclosed_and_islands_in_them_too() {
        let picture = Silhouette::from_text(
            ".........
             .#######.
             .#.....#.
             .#.....#.
             .#..#..#.
             .#.....#.
             .#.....#.
             .#######.
             ......... ",
        );
        let contour = Contour::largest(&picture).unwrap().0;
        assert_eq!(contour.points.len(), 28);
        assert_eq!(contour.enclosed(&picture), picture.area());
    }

    #[test]
    fn pixels_that_touch_at_a_corner_share_a_contour() {
        let picture = Silhouette::from_text(".... .#.. ..#. ....");
        let contour = Contour::largest(&picture).unwrap().0;
        assert_eq!(contour.points.len(), 8);
        assert_eq!(contour.enclosed(&picture), 2);
    }

    #[test]
    fn the_larger_of_two_parts_is_taken() {
        let picture = Silhouette::from_text("##..... ##..... ....... ....### ....### ....### .......");
        let contour = Contour::largest(&picture).unwrap().0;
        assert_eq!((contour.enclosed(&picture), picture.area()), (9, 13));
    }

    #[test]
    fn an_empty_picture_has_no_contour() {
        assert_eq!(Contour::largest(&Silhouette::new(8)), None);
    }

    #[test]
    fn smoothing_makes_the_stairs_of_a_diagonal_a_line() {
        let mut picture = Silhouette::new(200);
        (20..180).for_each(|y| picture.fill(y, y.abs_diff(100) + 10, 190 - y.abs_diff(100)));
        let smooth = Contour::largest(&picture).unwrap().0.smoothed();
        let next = smooth.points.iter().cycle().skip(1);
        let length: f64 = smooth.points.iter().zip(next).map(|(p, q)| (p[0] - q[0]).hypot(p[1] - q[1])).sum();
        // A hexagon: four slanted sides of 80 rows, top and bottom of 20 pixels.
        let exact = 4.0 * 80.0 * 2f64.sqrt() + 2.0 * 20.0;
        assert!((length / exact - 1.0).abs() < 0.02, "{length} {exact}");
    }
}
