//! STEP text of models with about as many faces as wanted.

use std::fmt::Write;

/// A kind of model, and what makes one with about so many faces.
pub type Kind = (&'static str, fn(usize) -> String);

/// Congruent faces: a plate with a grid of equal holes, a connector of equal pins, a grid of balls, many parts of one
/// shape. Distinct faces: boxes of all sizes, a plate with holes of all radii.
pub const KINDS: [Kind; 5] =
    [("holes", holes), ("pins", pins), ("balls", balls), ("boxes", boxes), ("odd-holes", odd_holes)];

/// Instances written so far.
struct Text {
    data: String,
    count: usize,
}

type Point = [f64; 3];

impl Text {
    fn new() -> Self {
        let mut text = Self { data: String::new(), count: 0 };
        text.add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))");
        text.add(
            "(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#1))REPRESENTATION_CONTEXT('',''))",
        );
        text
    }

    /// Adds an instance and returns its number.
    fn add(&mut self, what: &str) -> usize {
        self.count += 1;
        writeln!(self.data, "#{}={what};", self.count).expect("text grows");
        self.count
    }

    fn list(&mut self, what: &str, members: &[usize], rest: &str) -> usize {
        let members: Vec<_> = members.iter().map(|m| format!("#{m}")).collect();
        self.add(&format!("{what}('',({}){rest})", members.join(",")))
    }

    fn finish(self) -> String {
        let head = "ISO-10303-21;HEADER;FILE_SCHEMA(('AUTOMOTIVE_DESIGN'));ENDSEC;DATA;\n";
        format!("{head}{}ENDSEC;END-ISO-10303-21;\n", self.data)
    }

    fn point(&mut self, [x, y, z]: Point) -> usize {
        self.add(&format!("CARTESIAN_POINT('',({x:?},{y:?},{z:?}))"))
    }

    fn direction(&mut self, [x, y, z]: Point) -> usize {
        self.add(&format!("DIRECTION('',({x:?},{y:?},{z:?}))"))
    }

    fn placement(&mut self, at: Point, z: Point, x: Point) -> usize {
        let (p, z, x) = (self.point(at), self.direction(z), self.direction(x));
        self.add(&format!("AXIS2_PLACEMENT_3D('',#{p},#{z},#{x})"))
    }

    fn vertex(&mut self, at: Point) -> (usize, Point) {
        let p = self.point(at);
        (self.add(&format!("VERTEX_POINT('',#{p})")), at)
    }

    fn line(&mut self, (a, from): (usize, Point), (b, to): (usize, Point)) -> usize {
        let along = std::array::from_fn(|i| to[i] - from[i]);
        let (p, d) = (self.point(from), self.direction(along));
        let v = self.add(&format!("VECTOR('',#{d},1.)"));
        let line = self.add(&format!("LINE('',#{p},#{v})"));
        self.add(&format!("EDGE_CURVE('',#{a},#{b},#{line},.T.)"))
    }

    /// A whole circle about z.
    fn circle(&mut self, [x, y, z]: Point, radius: f64) -> (usize, usize) {
        let (vertex, _) = self.vertex([x + radius, y, z]);
        let place = self.placement([x, y, z], Z, X);
        let circle = self.add(&format!("CIRCLE('',#{place},{radius:?})"));
        (self.add(&format!("EDGE_CURVE('',#{vertex},#{vertex},#{circle},.T.)")), vertex)
    }

    fn edge_loop(&mut self, uses: &[(usize, bool)]) -> usize {
        let oriented: Vec<_> = uses
            .iter()
            .map(|(e, forward)| self.add(&format!("ORIENTED_EDGE('',*,*,#{e},.{}.)", if *forward { 'T' } else { 'F' })))
            .collect();
        self.list("EDGE_LOOP", &oriented, "")
    }

    fn face(&mut self, surface: usize, outer: usize, inner: &[usize]) -> usize {
        let mut bounds = vec![self.add(&format!("FACE_OUTER_BOUND('',#{outer},.T.)"))];
        bounds.extend(inner.iter().map(|l| self.add(&format!("FACE_BOUND('',#{l},.T.)"))));
        self.list("ADVANCED_FACE", &bounds, &format!(",#{surface},.T."))
    }

    fn plane(&mut self, at: Point, z: Point, x: Point) -> usize {
        let place = self.placement(at, z, x);
        self.add(&format!("PLANE('',#{place})"))
    }

    /// A box, with holes from bottom to top at (x, y) of a radius.
    fn block(&mut self, low: Point, high: Point, holes: &[(f64, f64, f64)]) -> usize {
        let corner = |i: usize| std::array::from_fn(|k| if i >> k & 1 == 1 { high[k] } else { low[k] });
        let v: Vec<_> = (0..8).map(|i| self.vertex(corner(i))).collect();
        let mut edges = std::collections::BTreeMap::new();
        let mut faces = Vec::new();
        let (mut floor, mut lid) = (Vec::new(), Vec::new());
        for &(x, y, r) in holes {
            let (below, above) = (self.circle([x, y, low[2]], r), self.circle([x, y, high[2]], r));
            let seam = self.line((below.1, [x + r, y, low[2]]), (above.1, [x + r, y, high[2]]));
            floor.push(self.edge_loop(&[(below.0, true)]));
            lid.push(self.edge_loop(&[(above.0, false)]));
            let place = self.placement([x, y, low[2]], Z, X);
            let wall = self.add(&format!("CYLINDRICAL_SURFACE('',#{place},{r:?})"));
            let around = self.edge_loop(&[(below.0, false), (seam, true), (above.0, true), (seam, false)]);
            let bound = self.add(&format!("FACE_OUTER_BOUND('',#{around},.T.)"));
            faces.push(self.list("ADVANCED_FACE", &[bound], &format!(",#{wall},.F.")));
        }
        // Counter-clockwise from outside: bottom, top, front, back, left, right.
        let sides: [([usize; 4], Point, Point); 6] = [
            ([0, 2, 3, 1], [0.0, 0.0, -1.0], X),
            ([4, 5, 7, 6], Z, X),
            ([0, 1, 5, 4], [0.0, -1.0, 0.0], X),
            ([2, 6, 7, 3], [0.0, 1.0, 0.0], X),
            ([0, 4, 6, 2], [-1.0, 0.0, 0.0], Z),
            ([1, 3, 7, 5], X, Z),
        ];
        for (i, (ring, normal, x)) in sides.into_iter().enumerate() {
            let uses: Vec<_> = (0..4)
                .map(|k| {
                    let (a, b) = (ring[k], ring[(k + 1) % 4]);
                    let edge = *edges.entry((a.min(b), a.max(b))).or_insert_with_key(|&(a, b)| self.line(v[a], v[b]));
                    (edge, a < b)
                })
                .collect();
            let outer = self.edge_loop(&uses);
            let surface = self.plane(v[ring[0]].1, normal, x);
            let inner = [&floor, &lid].get(i).map_or(&[][..], |l| l.as_slice());
            faces.push(self.face(surface, outer, inner));
        }
        let shell = self.list("CLOSED_SHELL", &faces, "");
        self.add(&format!("MANIFOLD_SOLID_BREP('',#{shell})"))
    }

    /// One body at many places, as mapped items.
    fn copies(&mut self, body: usize, places: impl Iterator<Item = Point>) -> Vec<usize> {
        let origin = self.placement([0.0; 3], Z, X);
        let shape = self.list("SHAPE_REPRESENTATION", &[body, origin], ",#2");
        let map = self.add(&format!("REPRESENTATION_MAP(#{origin},#{shape})"));
        let copy = |text: &mut Self, at: Point| {
            let place = text.placement(at, Z, X);
            text.add(&format!("MAPPED_ITEM('',#{map},#{place})"))
        };
        places.map(|at| copy(self, at)).collect()
    }

    fn model(mut self, items: &[usize]) -> String {
        self.list("ADVANCED_BREP_SHAPE_REPRESENTATION", items, ",#2");
        self.finish()
    }
}

const X: Point = [1.0, 0.0, 0.0];
const Z: Point = [0.0, 0.0, 1.0];

/// Places of a grid of about `count`, three columns to two rows, about the origin.
fn grid(count: usize, pitch: f64) -> (Vec<(f64, f64)>, f64, f64) {
    let rows = ((count as f64 / 1.5).sqrt().round() as usize).max(1);
    let columns = count.div_ceil(rows);
    let at = |i: usize, n: usize| (i as f64 - (n as f64 - 1.0) / 2.0) * pitch;
    let places = (0..rows).flat_map(|j| (0..columns).map(move |i| (at(i, columns), at(j, rows)))).collect();
    (places, columns as f64 * pitch / 2.0 + 1.0, rows as f64 * pitch / 2.0 + 1.0)
}

/// A number from 0 to 1 that looks random.
fn chance(i: usize, salt: u64) -> f64 {
    let mixed = (i as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ salt.wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let mixed = (mixed ^ mixed >> 31).wrapping_mul(0x94D0_49BB_1331_11EB);
    (mixed >> 11) as f64 / (1u64 << 53) as f64
}

fn plate(count: usize, radius: impl Fn(usize) -> f64) -> String {
    let (places, x, y) = grid(count.saturating_sub(6).max(1), 3.0);
    let holes: Vec<_> = places.iter().enumerate().map(|(i, &(x, y))| (x, y, radius(i))).collect();
    let mut text = Text::new();
    let plate = text.block([-x, -y, 0.0], [x, y, 2.0], &holes);
    text.model(&[plate])
}

fn holes(count: usize) -> String {
    plate(count, |_| 1.0)
}

fn odd_holes(count: usize) -> String {
    plate(count, |i| 0.4 + 0.9 * chance(i, 1))
}

fn pins(count: usize) -> String {
    let (places, x, y) = grid((count / 6).saturating_sub(1).max(1), 2.54);
    let mut text = Text::new();
    let body = text.block([-x, -y, 0.0], [x, y, 2.0], &[]);
    let pin = text.block([-0.3, -0.3, -3.0], [0.3, 0.3, 8.0], &[]);
    let mut items = text.copies(pin, places.into_iter().map(|(x, y)| [x, y, 0.0]));
    items.push(body);
    text.model(&items)
}

fn balls(count: usize) -> String {
    let (places, x, y) = grid(count.saturating_sub(6).max(1), 1.27);
    let mut text = Text::new();
    let body = text.block([-x, -y, 0.0], [x, y, 1.2], &[]);
    let place = text.placement([0.0; 3], Z, X);
    let sphere = text.add(&format!("SPHERICAL_SURFACE('',#{place},0.4)"));
    let (pole, _) = text.vertex([0.0, 0.0, -0.4]);
    let around = text.add(&format!("VERTEX_LOOP('',#{pole})"));
    let face = text.face(sphere, around, &[]);
    let shell = text.list("CLOSED_SHELL", &[face], "");
    let ball = text.add(&format!("MANIFOLD_SOLID_BREP('',#{shell})"));
    let mut items = text.copies(ball, places.into_iter().map(|(x, y)| [x, y, -0.4]));
    items.push(body);
    text.model(&items)
}

fn boxes(count: usize) -> String {
    let (places, ..) = grid((count / 6).max(1), 4.0);
    let mut text = Text::new();
    let boxed = |(i, &(x, y)): (usize, &(f64, f64))| {
        let size: [f64; 3] = std::array::from_fn(|k| 0.8 + 2.5 * chance(i, k as u64 + 2));
        text.block([x, y, 0.0], [x + size[0], y + size[1], size[2]], &[])
    };
    let items: Vec<_> = places.iter().enumerate().map(boxed).collect();
    text.model(&items)
}
