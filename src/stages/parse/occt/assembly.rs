//! From the whole shape of a file to placed bodies.

use super::file::File;
use super::shapes::{Kind, Use};
use crate::cancel::{Cancel, Cancelled};
use crate::geometry::Transform;
use crate::stages::parse::fault::Fault;
use crate::stages::parse::sound::Why;

/// How deep compounds may be nested.
const DEEPEST_NESTING: usize = 64;

/// A shape that makes a body, placed.
#[derive(Clone, Debug)]
pub(super) struct Placed {
    /// Position of a solid, of a shell, or of what holds loose faces.
    pub shape: u32,
    pub placement: Transform,
    /// Which use it is at each level, from 1.
    pub path: Vec<u32>,
}

/// Shapes to build and what was left out.
pub(super) struct Assembly {
    pub placed: Vec<Placed>,
    /// Wires, edges and vertices that are parts of no face.
    pub free: Vec<Placed>,
    pub faults: Vec<Fault>,
}

/// Walks down from the whole shape; `room` is how many compounds and bodies are visited at most.
pub(super) fn assemble(file: &File, room: usize, cancel: &Cancel) -> Result<Assembly, Cancelled> {
    let last = file.shapes.all.len().checked_sub(1);
    let whole = last.map(|p| Use { shape: p as u32, orientation: super::shapes::Orientation::Forward, location: 0 });
    let mut walk =
        Walk { file, room, cancel, assembly: Assembly { placed: Vec::new(), free: Vec::new(), faults: Vec::new() } };
    if let Some(root) = file.shapes.root.or(whole) {
        walk.visit(&root, &Transform::identity(), &mut Vec::new())?;
    }
    Ok(walk.assembly)
}

struct Walk<'a> {
    file: &'a File,
    room: usize,
    cancel: &'a Cancel,
    assembly: Assembly,
}

impl Walk<'_> {
    /// The orientation does not matter here: bodies are given with their outside outside.
    fn visit(&mut self, used: &Use, outer: &Transform, path: &mut Vec<u32>) -> Result<(), Cancelled> {
        let kind = self.file.shapes.all[used.shape as usize].kind;
        self.cancel.check()?;
        let placement = match self.enter(path.len()).and_then(|()| self.placed(used, outer)) {
            Ok(placement) => placement,
            Err(why) => {
                self.note(used, why);
                return Ok(());
            }
        };
        let made = || Placed { shape: used.shape, placement, path: path.clone() };
        match kind {
            Kind::Compound | Kind::CompSolid => return self.compound(used.shape, &placement, path),
            Kind::Vertex | Kind::Edge | Kind::Wire => self.assembly.free.push(made()),
            Kind::Face | Kind::Shell | Kind::Solid => self.assembly.placed.push(made()),
        }
        Ok(())
    }

    /// The parts of a compound; faces that are parts themselves make one body together.
    fn compound(&mut self, shape: u32, placement: &Transform, path: &mut Vec<u32>) -> Result<(), Cancelled> {
        let file = self.file;
        let is_face = |part: &Use| file.shapes.all[part.shape as usize].kind == Kind::Face;
        let parts = file.shapes.uses_of(shape);
        if parts.iter().any(is_face) {
            self.assembly.placed.push(Placed { shape, placement: *placement, path: path.clone() });
        }
        for (index, part) in parts.iter().enumerate().filter(|(_, part)| !is_face(part)) {
            path.push(index as u32 + 1);
            self.visit(part, placement, path)?;
            path.pop();
        }
        Ok(())
    }

    fn placed(&self, used: &Use, outer: &Transform) -> Result<Transform, Why> {
        let own = self.file.locations.transform(self.file.locations.numbered(used.location)?)?;
        Ok(own.map_or(*outer, |own| outer.after(own)))
    }

    fn enter(&mut self, depth: usize) -> Result<(), Why> {
        self.room = self.room.checked_sub(1).ok_or("too many bodies are placed")?;
        if depth > DEEPEST_NESTING { Err("compounds nested too deep") } else { Ok(()) }
    }

    fn note(&mut self, used: &Use, why: Why) {
        let fault = Fault::new(u64::from(used.shape) + 1, why);
        if self.assembly.faults.last() != Some(&fault) {
            self.assembly.faults.push(fault);
        }
    }
}
