//! The section `TShapes`: what shapes are made of.

use super::curves::Space;
use super::text::{Found, Lost, Words, cancelled};
use crate::cancel::Cancel;
use crate::geometry::Point;

/// What a shape is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Vertex,
    Edge,
    Wire,
    Face,
    Shell,
    Solid,
    CompSolid,
    Compound,
}

impl Kind {
    fn of(word: &[u8]) -> Option<Self> {
        Some(match word {
            b"Ve" => Self::Vertex,
            b"Ed" => Self::Edge,
            b"Wi" => Self::Wire,
            b"Fa" => Self::Face,
            b"Sh" => Self::Shell,
            b"So" => Self::Solid,
            b"CS" => Self::CompSolid,
            b"Co" => Self::Compound,
            _ => return None,
        })
    }
}

/// How a shape is used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Orientation {
    Forward,
    Reversed,
    /// Inside, or outside: it bounds nothing.
    Loose,
}

/// A use of a shape in another one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Use {
    /// Position in [`Shapes::all`].
    pub shape: u32,
    pub orientation: Orientation,
    /// Number of the location.
    pub location: u32,
}

/// A curve of an edge in the parameter space of a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct ParameterCurve {
    pub curve: u32,
    pub surface: u32,
    pub location: u32,
    pub range: [f64; 2],
}

/// The curve of an edge in space.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpaceCurve {
    pub curve: u32,
    pub location: u32,
    pub range: [f64; 2],
}

/// What an edge says of itself.
#[derive(Clone, Debug, Default)]
pub(super) struct EdgeData {
    pub degenerated: bool,
    pub curve: Option<SpaceCurve>,
    pub on_surface: Option<ParameterCurve>,
}

/// The geometry of a shape, by the numbers in the other sections; 0 is none.
#[derive(Clone, Debug)]
pub(super) enum Data {
    Vertex(Point),
    Edge(EdgeData),
    Face { surface: u32, location: u32, triangulation: u32 },
    None,
}

/// A shape; its entity number is its position, from 1.
#[derive(Clone, Debug)]
pub(super) struct Shape {
    pub kind: Kind,
    pub closed: bool,
    pub data: Data,
    /// First and last position in [`Shapes::uses`].
    uses: [u32; 2],
}

/// All shapes of a file; each uses earlier ones only.
#[derive(Clone, Debug, Default)]
pub(super) struct Shapes {
    pub all: Vec<Shape>,
    uses: Vec<Use>,
    /// The use of the whole shape.
    pub root: Option<Use>,
    /// Uses left out, as they name no earlier shape: the shapes that have them.
    pub dangling: Vec<u32>,
}

impl Shapes {
    /// Reads the section, in a format of version `version`.
    pub fn read(words: &mut Words, version: u32, cancel: &Cancel) -> Found<Self> {
        let mut shapes = Self::default();
        let count = words.count()?;
        for position in 0..count {
            cancelled(cancel)?;
            let read = shapes.shape(words, count, version);
            read.map_err(|Lost(why)| Lost(format!("TShape {} of {count}: {why}", position + 1).into()))?;
        }
        if !words.peek().is_empty() {
            shapes.root = shapes.next_use(words, count)?.and_then(Result::ok);
        }
        Ok(shapes)
    }

    /// The uses of a shape.
    pub fn uses_of(&self, shape: u32) -> &[Use] {
        let [from, to] = self.all[shape as usize].uses;
        &self.uses[from as usize..to as usize]
    }

    fn shape(&mut self, words: &mut Words, count: usize, version: u32) -> Found<()> {
        let word = words.word()?;
        let kind = Kind::of(word).ok_or_else(|| Lost("a kind of shape was expected".into()))?;
        let data = match kind {
            Kind::Vertex => vertex(words)?,
            Kind::Edge => edge(words, version)?,
            Kind::Face => face(words)?,
            _ => Data::None,
        };
        // Free, modified, checked, orientable, closed, infinite, convex.
        let closed = words.word()?.get(4) == Some(&b'1');
        let from = self.uses.len() as u32;
        while let Some(used) = self.next_use(words, count)? {
            match used {
                Ok(used) => self.uses.push(used),
                Err(Missing) => self.dangling.push(self.all.len() as u32),
            }
        }
        self.all.push(Shape { kind, closed, data, uses: [from, self.uses.len() as u32] });
        Ok(())
    }

    /// A use such as `+12 0`; `None` at the `*` that ends a list.
    fn next_use(&self, words: &mut Words, count: usize) -> Found<Option<Result<Use, Missing>>> {
        let word = words.word()?;
        let (orientation, number) = match word.split_first() {
            Some((b'*', _)) => return Ok(None),
            Some((b'+', number)) => (Orientation::Forward, number),
            Some((b'-', number)) => (Orientation::Reversed, number),
            Some((b'i' | b'e', number)) => (Orientation::Loose, number),
            _ => return Err(Lost("the use of a shape was expected".into())),
        };
        let number = Words::new(number).integer()?;
        let location = words.index()?;
        // Numbers run backwards: the last shape is number 1.
        let position = usize::try_from(number).ok().and_then(|n| count.checked_sub(n));
        Ok(Some(match position.filter(|p| *p < self.all.len()) {
            Some(shape) => Ok(Use { shape: shape as u32, orientation, location }),
            None => Err(Missing),
        }))
    }
}

/// A use names no earlier shape.
struct Missing;

fn vertex(words: &mut Words) -> Found<Data> {
    words.real()?;
    let point = super::curves::point(words, Space::Space)?;
    loop {
        words.real()?;
        match words.integer()? {
            0 => return Ok(Data::Vertex(point)),
            1 => words.skip(2)?,
            2 => words.skip(3)?,
            // The second parameter, the surface and its location.
            3 => words.skip(3)?,
            other => return Err(Lost(format!("there is no vertex on a thing of type {other}").into())),
        }
    }
}

fn edge(words: &mut Words, version: u32) -> Found<Data> {
    // Tolerance, same parameter, same range.
    words.skip(3)?;
    let mut data = EdgeData { degenerated: words.flag()?, ..EdgeData::default() };
    loop {
        match words.integer()? {
            0 => return Ok(Data::Edge(data)),
            1 => {
                let curve = SpaceCurve { curve: words.index()?, location: words.index()?, range: words.reals()? };
                if curve.curve > 0 {
                    data.curve.get_or_insert(curve);
                }
            }
            kind @ (2 | 3) => {
                let curve = parameter_curve(words, kind == 3, version)?;
                data.on_surface.get_or_insert(curve);
            }
            4 => words.skip(5)?,
            5 => words.skip(2)?,
            6 => words.skip(3)?,
            7 => words.skip(4)?,
            other => return Err(Lost(format!("there is no edge on a thing of type {other}").into())),
        }
    }
}

/// On a seam there are two curves and the continuity across it. Version 2 also writes the ends in parameter space.
fn parameter_curve(words: &mut Words, seam: bool, version: u32) -> Found<ParameterCurve> {
    let curve = words.index()?;
    // The second curve and the continuity, which are written without a space between them, such as `3CN`.
    if seam && words.word()?.iter().all(u8::is_ascii_digit) {
        words.skip(1)?;
    }
    let (surface, location, range) = (words.index()?, words.index()?, words.reals()?);
    if version == 2 {
        words.skip(4)?;
    }
    Ok(ParameterCurve { curve, surface, location, range })
}

fn face(words: &mut Words) -> Found<Data> {
    // Natural restriction, tolerance.
    words.skip(2)?;
    let (surface, location) = (words.index()?, words.index()?);
    let triangulation = if words.peek() == b"2" {
        words.skip(1)?;
        words.index()?
    } else {
        0
    };
    Ok(Data::Face { surface, location, triangulation })
}
