//! What a representation places: its bodies, those of related representations and those of mapped items.

use std::rc::Rc;

use rustc_hash::{FxHashMap, FxHashSet};

use super::bodies::BodyKind;
use super::keyword::Kind;
use super::placement::Geometry;
use super::records::{File, Record};
use super::structure::{Relation, Structure};
use super::units::{Units, units_of_context};
use crate::cancel::Cancel;
use crate::geometry::Transform;
use crate::stages::parse::fault::{Fault, Read};

/// How deep mapped items and products may be nested.
pub(super) const DEEPEST_NESTING: usize = 64;

/// Branches left out beyond this number are not told: one broken product may be used very often.
const MOST_FAULTS: usize = 10_000;

/// An item that makes a body, where it lies, and through which mapped items.
#[derive(Clone, Debug)]
pub(super) struct Placed {
    pub item: u64,
    pub kind: BodyKind,
    pub units: Units,
    pub placement: Transform,
    /// Entity numbers of the mapped items, or of the usages of products, from the outside in.
    pub path: Vec<u64>,
}

/// The items of a representation.
#[derive(Clone, Debug)]
pub(super) struct Content {
    pub items: Vec<u64>,
    pub units: Units,
}

/// Answers questions about representations, each read once.
pub(super) struct Representations<'a> {
    pub file: File<'a>,
    pub structure: &'a Structure,
    contents: FxHashMap<u64, Rc<Content>>,
    units: FxHashMap<u64, Units>,
    /// Representations that were placed.
    pub placed: FxHashSet<u64>,
    /// Branches that were left out, with their reasons.
    pub faults: Vec<(u64, Fault)>,
    /// Items that may still be placed.
    pub room: usize,
    cancel: &'a Cancel,
}

/// Where an expansion is: the placement, the path and the representations that lead here.
#[derive(Clone)]
struct Branch {
    placement: Transform,
    path: Vec<u64>,
    above: Vec<u64>,
}

impl<'a> Representations<'a> {
    pub fn new(file: File<'a>, structure: &'a Structure, room: usize, cancel: &'a Cancel) -> Self {
        let (contents, units) = (FxHashMap::default(), FxHashMap::default());
        Self { file, structure, contents, units, placed: FxHashSet::default(), faults: Vec::new(), room, cancel }
    }

    /// Notes that a branch at `entity` is left out.
    pub fn note(&mut self, entity: u64, fault: Fault) {
        if self.faults.len() < MOST_FAULTS {
            self.faults.push((entity, fault));
        }
    }

    /// Whether the work should stop.
    pub fn is_cancelled(&self) -> bool {
        self.cancel.is_cancelled()
    }

    /// The items and units of a representation.
    pub fn content(&mut self, id: u64) -> Read<Rc<Content>> {
        if let Some(known) = self.contents.get(&id) {
            return Ok(known.clone());
        }
        let record = self.file.record(id)?;
        let mut cursor = record.fields(&[Kind::Representation]);
        let items = cursor.skip_many(1).references_leniently()?;
        let units = match cursor.optional_reference()? {
            Some(context) => *self.units.entry(context).or_insert_with(|| units_of_context(&self.file, context)),
            None => Units::default(),
        };
        let content = Rc::new(Content { items, units });
        self.contents.insert(id, content.clone());
        Ok(content)
    }

    /// All that the representations in `roots` place, each representation once.
    pub fn expand(&mut self, roots: &[u64], placement: &Transform) -> Vec<Placed> {
        let mut found = Vec::new();
        let branch = Branch { placement: *placement, path: Vec::new(), above: Vec::new() };
        self.expand_branch(roots, branch, &mut found);
        found
    }

    fn expand_branch(&mut self, roots: &[u64], branch: Branch, found: &mut Vec<Placed>) {
        let mut queue: Vec<(u64, Transform)> = roots.iter().map(|r| (*r, branch.placement)).collect();
        let mut seen: FxHashSet<u64> = branch.above.iter().copied().collect();
        let mut items = FxHashSet::default();
        let mut at = 0;
        while let Some(&(id, placement)) = queue.get(at) {
            at += 1;
            if self.cancel.is_cancelled() {
                return;
            }
            if !seen.insert(id) {
                continue;
            }
            self.placed.insert(id);
            self.follow_relations(id, &placement, &mut queue);
            let here = Branch { placement, path: branch.path.clone(), above: [&branch.above[..], &[id]].concat() };
            if let Err(fault) = self.expand_items(id, &here, &mut items, found) {
                self.note(id, fault);
            }
        }
    }

    fn expand_items(
        &mut self,
        id: u64,
        branch: &Branch,
        seen: &mut FxHashSet<u64>,
        found: &mut Vec<Placed>,
    ) -> Read<()> {
        let content = self.content(id)?;
        for &item in &content.items {
            let Ok(record) = self.file.record(item) else {
                self.note(id, Fault::new(item, "there is no such item"));
                continue;
            };
            if record.is(Kind::MappedItem) {
                if let Err(fault) = self.expand_mapped(&record, &content, branch, found) {
                    self.note(item, fault);
                }
            } else if let Some(kind) = BodyKind::of(&record).filter(|_| seen.insert(item)) {
                self.room = self.room.checked_sub(1).ok_or_else(|| Fault::new(id, "too many bodies are placed"))?;
                let (placement, path) = (branch.placement, branch.path.clone());
                found.push(Placed { item, kind, units: content.units, placement, path });
            }
        }
        Ok(())
    }

    /// MAPPED_ITEM: another representation, moved so that the map's origin comes to lie on the item's target.
    fn expand_mapped(
        &mut self,
        record: &Record,
        content: &Content,
        branch: &Branch,
        found: &mut Vec<Placed>,
    ) -> Read<()> {
        let mut cursor = record.fields(&[Kind::RepresentationItem, Kind::MappedItem]);
        let source = self.file.record(cursor.skip_many(1).reference()?)?;
        let target = Geometry::new(self.file, content.units).transform(cursor.reference()?)?;
        let mut cursor = source.fields(&[Kind::RepresentationMap]);
        let (origin, mapped) = (cursor.reference()?, cursor.reference()?);
        if branch.above.contains(&mapped) {
            return Err(Fault::new(mapped, "a representation that contains itself"));
        }
        if branch.above.len() > DEEPEST_NESTING {
            return Err(Fault::new(mapped, "mapped items nested too deep"));
        }
        self.room = self.room.checked_sub(1).ok_or_else(|| Fault::new(mapped, "too many bodies are placed"))?;
        let units = self.content(mapped)?.units;
        let origin = Geometry::new(self.file, units).transform(origin)?;
        let back = origin.inverse().ok_or_else(|| source.fault("a map whose origin has no inverse"))?;
        let inner = Branch {
            placement: branch.placement.after(&target.after(&back)),
            path: [&branch.path[..], &[record.id]].concat(),
            above: branch.above.clone(),
        };
        self.expand_branch(&[mapped], inner, found);
        Ok(())
    }

    /// Adds the representations that `id` is related to, where they lie.
    fn follow_relations(&mut self, id: u64, placement: &Transform, queue: &mut Vec<(u64, Transform)>) {
        let structure = self.structure;
        for relation in structure.relations.get(&id).into_iter().flatten() {
            let other = if relation.first == id { relation.second } else { relation.first };
            match self.transform(relation, other) {
                Ok(transform) => queue.push((other, placement.after(&transform))),
                Err(fault) => self.note(other, fault),
            }
        }
    }

    /// The map from the coordinates of representation `child` to those of the other one of a relation.
    pub fn transform(&mut self, relation: &Relation, child: u64) -> Read<Transform> {
        let Some(id) = relation.transformation else { return Ok(Transform::identity()) };
        let record = self.file.record(id)?;
        let first = self.content(relation.first)?;
        let second = self.content(relation.second)?;
        let onto_second = if record.is(Kind::ItemDefinedTransformation) {
            let mut cursor = record.fields(&[Kind::ItemDefinedTransformation]);
            let mut items = [cursor.skip_many(2).reference()?, cursor.reference()?];
            let belongs = |item: u64, content: &Content| content.items.contains(&item);
            // Some writers list the two placements the other way round than the representations.
            if belongs(items[0], &second) && belongs(items[1], &first) && !belongs(items[0], &first) {
                items.swap(0, 1);
            }
            let from = Geometry::new(self.file, first.units).transform(items[0])?;
            let to = Geometry::new(self.file, second.units).transform(items[1])?;
            to.after(&from.inverse().ok_or_else(|| record.fault("a placement without inverse"))?)
        } else {
            Geometry::new(self.file, second.units).transform(id)?
        };
        if child == relation.first {
            Ok(onto_second)
        } else {
            onto_second.inverse().ok_or_else(|| record.fault("a transformation without inverse"))
        }
    }
}
