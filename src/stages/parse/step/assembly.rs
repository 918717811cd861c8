//! From the products and representations of a file to placed items.

use rustc_hash::{FxHashMap, FxHashSet};

use super::bodies::BodyKind;
use super::keyword::Kind;
use super::records::File;
use super::representation::{DEEPEST_NESTING, Placed, Representations};
use super::structure::{Structure, Usage, structure};
use crate::cancel::{Cancel, Cancelled};
use crate::geometry::Transform;
use crate::stages::parse::fault::{Fault, Read};

/// The items to build and place, and the branches that were left out.
pub(super) struct Assembly {
    pub placed: Vec<Placed>,
    pub faults: Vec<(u64, Fault)>,
    /// Whether the file has any representation.
    pub has_representations: bool,
    pub roots: Roots,
}

/// From where the placed items are reached.
#[derive(Debug, Default)]
pub(super) struct Roots {
    /// The products that are part of no other and place something.
    pub products: Vec<u64>,
    /// The representations that no product leads to and that place something.
    pub representations: Vec<u64>,
    /// The items of a file without such products and representations.
    pub items: Vec<u64>,
}

/// Places the items of all products, then those of representations that no product leads to.
///
/// `room` is how many items may be placed at most.
pub(super) fn assemble(file: File, room: usize, cancel: &Cancel) -> Result<Assembly, Cancelled> {
    let structure = structure(&file);
    let mut walk = Walk {
        structure: &structure,
        representations: Representations::new(file, &structure, room, cancel),
        own: FxHashMap::default(),
        placed: Vec::new(),
        roots: Roots::default(),
    };
    for root in roots(&structure) {
        let before = walk.placed.len();
        walk.product(root, &Transform::identity(), &mut Vec::new(), &mut vec![root]);
        if walk.placed.len() > before {
            walk.roots.products.push(root);
        }
    }
    walk.orphans();
    let Walk { mut placed, representations, mut roots, .. } = walk;
    let mut faults = representations.faults;
    if placed.is_empty() {
        placed = bare_items(&file, &mut faults, room);
        roots.items = placed.iter().map(|p| p.item).collect();
    }
    cancel.check()?;
    Ok(Assembly { placed, faults, has_representations: !structure.representations.is_empty(), roots })
}

/// The products that are part of no other; where all are, as in a cycle, the first one.
fn roots(structure: &Structure) -> Vec<u64> {
    let children: FxHashSet<u64> = structure.parts.values().flatten().map(|u| u.child).collect();
    let mut roots: Vec<u64> = structure.products.iter().copied().filter(|p| !children.contains(p)).collect();
    if roots.is_empty() {
        roots.extend(structure.products.first());
    }
    roots
}

struct Walk<'a> {
    structure: &'a Structure,
    representations: Representations<'a>,
    /// What each product places itself, without its parts.
    own: FxHashMap<u64, Vec<Placed>>,
    placed: Vec<Placed>,
    roots: Roots,
}

impl Walk<'_> {
    /// Places a product and its parts; `above` are the products from the root to this one.
    fn product(&mut self, product: u64, placement: &Transform, path: &mut Vec<u64>, above: &mut Vec<u64>) {
        for own in self.own_items(product) {
            let Some(room) = self.representations.room.checked_sub(1) else { return };
            self.representations.room = room;
            self.placed.push(Placed {
                placement: placement.after(&own.placement),
                path: [&path[..], &own.path].concat(),
                ..own
            });
        }
        let structure = self.structure;
        for usage in structure.parts.get(&product).into_iter().flatten() {
            if let Err(fault) = self.part(usage, placement, path, above) {
                self.representations.note(usage.entity, fault);
            }
        }
    }

    /// Places a product used in another one.
    fn part(&mut self, usage: &Usage, placement: &Transform, path: &mut Vec<u64>, above: &mut Vec<u64>) -> Read<()> {
        if self.representations.is_cancelled() {
            return Ok(());
        }
        if above.contains(&usage.child) {
            return Err(Fault::new(usage.child, "a product that is part of itself"));
        }
        if above.len() > DEEPEST_NESTING {
            return Err(Fault::new(usage.child, "an assembly nested too deep"));
        }
        let room = self.representations.room.checked_sub(1);
        self.representations.room = room.ok_or_else(|| Fault::new(usage.child, "too many bodies are placed"))?;
        let Some(within) = self.within_parent(usage)? else { return Ok(()) };
        path.push(usage.entity);
        above.push(usage.child);
        self.product(usage.child, &placement.after(&within), path, above);
        above.pop();
        path.pop();
        Ok(())
    }

    /// How the child of a usage lies in the parent; `None` where mapped items of the parent place it already.
    fn within_parent(&mut self, usage: &Usage) -> Read<Option<Transform>> {
        let Some(relation) = &usage.relation else {
            let own = self.own_items(usage.parent);
            return Ok((!own.iter().any(|p| !p.path.is_empty())).then(Transform::identity));
        };
        let of_child = |id: u64, walk: &Self| walk.belongs(id, usage.child);
        let second_is_child = of_child(relation.second, self) && !of_child(relation.first, self);
        let child = if second_is_child { relation.second } else { relation.first };
        if !self.structure.shapes.contains_key(&usage.child) {
            let items = self.representations.expand(&[child], &Transform::identity());
            self.own.entry(usage.child).or_insert(items);
        }
        self.representations.transform(relation, child).map(Some)
    }

    /// Whether a representation is one of a product's, or related to one of them.
    fn belongs(&self, representation: u64, product: u64) -> bool {
        let own = self.structure.shapes.get(&product).map(Vec::as_slice).unwrap_or_default();
        let related = || self.structure.relations.get(&representation).into_iter().flatten();
        own.contains(&representation) || related().any(|r| own.contains(&r.first) || own.contains(&r.second))
    }

    /// What a product places itself: its B-rep, or else its triangles.
    fn own_items(&mut self, product: u64) -> Vec<Placed> {
        if let Some(known) = self.own.get(&product) {
            return known.clone();
        }
        let shapes = self.structure.shapes.get(&product).cloned().unwrap_or_default();
        let items = prefer_brep(self.representations.expand(&shapes, &Transform::identity()));
        self.own.insert(product, items.clone());
        items
    }

    /// Whether a representation has mapped items.
    fn maps_others(&mut self, representation: u64) -> bool {
        let file = self.representations.file;
        let is_mapped = |item: &u64| file.record(*item).is_ok_and(|r| r.is(Kind::MappedItem));
        self.representations.content(representation).is_ok_and(|content| content.items.iter().any(is_mapped))
    }

    /// Places the representations that nothing has placed, those that others map last; what was placed already is not
    /// placed again, since views and validation properties name the same items, as they name faces of shells.
    fn orphans(&mut self) {
        let mapped: FxHashSet<u64> = self.structure.mapped.iter().copied().collect();
        let structure = self.structure;
        let (mut last, first): (Vec<u64>, Vec<u64>) =
            structure.representations.iter().partition(|r| mapped.contains(r));
        last.sort_by_key(|id| !self.maps_others(*id));
        let mut known: FxHashSet<u64> = self.placed.iter().map(|p| p.item).collect();
        for id in first.into_iter().chain(last) {
            if !self.representations.placed.contains(&id) {
                let mut items = prefer_brep(self.representations.expand(&[id], &Transform::identity()));
                items.retain(|p| !known.contains(&p.item) && (known.is_empty() || p.kind != BodyKind::Bare));
                known.extend(items.iter().map(|p| p.item));
                if !items.is_empty() {
                    self.roots.representations.push(id);
                }
                self.placed.extend(items);
            }
        }
    }
}

/// Without the triangles where there is also a B-rep.
fn prefer_brep(mut items: Vec<Placed>) -> Vec<Placed> {
    if items.iter().any(|p| p.kind != BodyKind::Tessellated) {
        items.retain(|p| p.kind != BodyKind::Tessellated);
    }
    items
}

/// Solids and surface models of a file in which no representation holds any.
fn bare_items(file: &File, faults: &mut Vec<(u64, Fault)>, room: usize) -> Vec<Placed> {
    let mut placed = Vec::new();
    for entry in &file.table.entries {
        let kind = BodyKind::of(&file.record_of(*entry));
        let Some(kind) = kind.filter(|k| matches!(k, BodyKind::Solid | BodyKind::Shells)) else { continue };
        if placed.len() == room {
            faults.push((entry.id, Fault::new(entry.id, "too many bodies are placed")));
            break;
        }
        let (units, placement) = (Default::default(), Transform::identity());
        placed.push(Placed { item: entry.id, kind, units, placement, path: Vec::new() });
    }
    placed
}
