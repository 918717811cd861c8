//! From the directory to placed bodies: which entities stand for themselves, and what subfigures place.

use rustc_hash::FxHashMap;

use super::curves::is_curve;
use super::file::File;
use super::trimmed::is_face;
use crate::cancel::{Cancel, Cancelled};
use crate::geometry::{Point, Transform, Vector};
use crate::stages::parse::fault::{Fault, Read};

/// How deep subfigures and assemblies may be nested.
const DEEPEST_NESTING: usize = 64;

/// What makes a body.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) enum Source {
    /// A solid or shell with topology.
    Solid(u64),
    /// The faces without topology of a subfigure or group; 0: of the whole file.
    Loose(u64),
}

/// A body to build, placed.
#[derive(Clone, Debug)]
pub(super) struct Placed {
    pub source: Source,
    pub placement: Transform,
    pub path: Vec<u64>,
}

/// What to build and what was left out.
pub(super) struct Assembly {
    pub placed: Vec<Placed>,
    /// The faces of each [`Source::Loose`].
    pub loose: FxHashMap<u64, Vec<u64>>,
    /// Curves and points that bound no face.
    pub free: Vec<(u64, Transform)>,
    pub faults: Vec<Fault>,
}

/// Places the visible entities that are not parts of others; where none of them makes a face, all that could.
pub(super) fn assemble(file: &File, room: usize, cancel: &Cancel) -> Result<Assembly, Cancelled> {
    let assembly = Assembly { placed: Vec::new(), loose: FxHashMap::default(), free: Vec::new(), faults: Vec::new() };
    // A file that marks no entity as a part of others does not tell free curves from edges.
    let has_free_curves = file.entries.iter().any(|entry| entry.dependent);
    let mut walk = Walk { file, room, cancel, has_free_curves, above: Vec::new(), assembly };
    let shown = |purpose: u32| !matches!(purpose, 1 | 2 | 5);
    let all = file.numbered().filter(|(_, entry)| !entry.blanked && shown(entry.purpose));
    let roots: Vec<u64> = all.filter(|(_, entry)| !entry.dependent).map(|(entity, _)| entity).collect();
    walk.items(&roots, 0, &Transform::identity(), &mut Vec::new())?;
    if walk.assembly.placed.is_empty() && walk.assembly.loose.is_empty() {
        let has_solids = file.entries.iter().any(|entry| entry.kind == 186);
        let last_resort = |kind: u32| matches!(kind, 186 | 144 | 143) || (kind == 514 && !has_solids);
        let all: Vec<u64> =
            file.numbered().filter(|(_, e)| last_resort(e.kind) && !e.blanked).map(|(entity, _)| entity).collect();
        walk.items(&all, 0, &Transform::identity(), &mut Vec::new())?;
    }
    Ok(walk.assembly)
}

/// The entities of a SUBFIGURE DEFINITION (308).
fn members(file: &File, definition: u64) -> Read<Vec<u64>> {
    let record = file.expect(definition, 308, "a subfigure definition was expected")?;
    let mut fields = record.fields();
    let count = fields.skip(2).count()?;
    fields.pointers(count)
}

struct Walk<'a> {
    file: &'a File<'a>,
    room: usize,
    cancel: &'a Cancel,
    has_free_curves: bool,
    /// The entities from the top to the one that is placed.
    above: Vec<u64>,
    assembly: Assembly,
}

impl Walk<'_> {
    /// Places entities; faces without topology among them make one body of `owner`.
    fn items(
        &mut self,
        items: &[u64],
        owner: u64,
        placement: &Transform,
        path: &mut Vec<u64>,
    ) -> Result<(), Cancelled> {
        let kind = |entity: &u64| self.file.entry(*entity).map_or(0, |entry| entry.kind);
        let shown = |entity: &u64| !self.file.entry(*entity).is_ok_and(|entry| entry.blanked);
        let items: Vec<u64> = items.iter().copied().filter(shown).collect();
        let loose: Vec<u64> = items.iter().copied().filter(|entity| is_face(kind(entity))).collect();
        if !loose.is_empty() {
            let source = Source::Loose(owner);
            self.assembly.placed.push(Placed { source, placement: *placement, path: path.clone() });
            self.assembly.loose.entry(owner).or_insert(loose);
        }
        for &entity in items.iter().filter(|entity| !is_face(kind(entity))) {
            self.cancel.check()?;
            if let Err(fault) = self.item(entity, placement, path)? {
                self.note(fault);
            }
        }
        Ok(())
    }

    fn item(&mut self, entity: u64, placement: &Transform, path: &mut Vec<u64>) -> Result<Read<()>, Cancelled> {
        let (kind, purpose) = match self.file.entry(entity) {
            Ok(entry) => (entry.kind, entry.purpose),
            Err(fault) => return Ok(Err(fault)),
        };
        if self.has_free_curves && purpose == 0 && (kind == 116 || is_curve(kind)) && self.room > 0 {
            self.room -= 1;
            self.assembly.free.push((entity, *placement));
        }
        if !matches!(kind, 184 | 186 | 402 | 408 | 430 | 514) {
            return Ok(Ok(()));
        }
        let (own, parts) = match self.enter(entity).and_then(|()| self.parts(entity, kind)) {
            Ok(found) => found,
            Err(fault) => return Ok(Err(fault)),
        };
        self.above.push(entity);
        self.place(entity, parts, &placement.after(&own), path)?;
        self.above.pop();
        Ok(Ok(()))
    }

    fn enter(&mut self, entity: u64) -> Read<()> {
        let room = self.room.checked_sub(1).ok_or_else(|| Fault::new(entity, "too many bodies are placed"))?;
        self.room = room;
        if self.above.contains(&entity) {
            return Err(Fault::new(entity, "an entity that is part of itself"));
        }
        if self.above.len() > DEEPEST_NESTING { Err(Fault::new(entity, "nested too deep")) } else { Ok(()) }
    }

    /// Where an entity lies, and what it consists of with the place of each.
    fn parts(&self, entity: u64, kind: u32) -> Read<(Transform, Parts)> {
        let record = self.file.record(entity)?;
        let own = self.file.transform(&record)?.unwrap_or_else(Transform::identity);
        let mut fields = record.fields();
        Ok(match kind {
            186 | 514 => (own, Parts::Itself),
            402 => {
                let count = fields.count()?;
                // The others stand for themselves.
                let dependent = |entity: &u64| self.file.entry(*entity).is_ok_and(|entry| entry.dependent);
                let members = fields.pointers(count)?.into_iter().filter(dependent).collect();
                (Transform::identity(), Parts::Members(members))
            }
            430 => (own, Parts::Several(vec![(fields.pointer()?, Transform::identity())])),
            184 => {
                let count = fields.count()?;
                let items = (0..count).map(|_| fields.pointer()).collect::<Read<Vec<_>>>()?;
                let matrix = |fields: &mut super::file::Fields| match fields.real_or(0.0) {
                    m if m >= 1.0 => self.file.matrix(m as u64, 0),
                    _ => Ok(Transform::identity()),
                };
                let placed = items.into_iter().map(|item| Ok((item, matrix(&mut fields)?)));
                (own, Parts::Several(placed.collect::<Read<_>>()?))
            }
            _ => {
                let definition = fields.pointer()?;
                let shift = Vector::from(fields.reals::<3>()?) * self.file.global.unit_mm;
                let scale = fields.real_or(1.0);
                if !(scale > 0.0 && scale.is_finite()) {
                    return Err(record.fault("a scale that is not positive"));
                }
                let axes = [Vector::x(), Vector::y(), Vector::z()].map(|a| a * scale);
                let inner = Transform::from_axes(&Point::from(shift), &axes[0], &axes[1], &axes[2]);
                (own.after(&inner), Parts::Definition(definition))
            }
        })
    }

    fn place(
        &mut self,
        entity: u64,
        parts: Parts,
        placement: &Transform,
        path: &mut Vec<u64>,
    ) -> Result<(), Cancelled> {
        match parts {
            Parts::Itself => {
                let source = Source::Solid(entity);
                self.assembly.placed.push(Placed { source, placement: *placement, path: path.clone() });
            }
            Parts::Members(members) => {
                path.push(entity);
                self.items(&members, entity, placement, path)?;
                path.pop();
            }
            Parts::Definition(definition) => match members(self.file, definition) {
                Ok(members) => {
                    path.push(entity);
                    self.items(&members, definition, placement, path)?;
                    path.pop();
                }
                Err(fault) => self.note(fault),
            },
            Parts::Several(parts) => {
                for (index, (part, by)) in parts.into_iter().enumerate() {
                    path.extend([entity, index as u64 + 1]);
                    if let Err(fault) = self.item(part, &placement.after(&by), path)? {
                        self.note(fault);
                    }
                    path.truncate(path.len() - 2);
                }
            }
        }
        Ok(())
    }

    fn note(&mut self, fault: Fault) {
        if self.assembly.faults.last() != Some(&fault) {
            self.assembly.faults.push(fault);
        }
    }
}

/// What an entity consists of.
enum Parts {
    Itself,
    /// The parts of a group that do not stand for themselves.
    Members(Vec<u64>),
    /// The members of a subfigure definition.
    Definition(u64),
    Several(Vec<(u64, Transform)>),
}
