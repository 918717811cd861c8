//! Which representation belongs to which product, and how representations and products hang together.

use rustc_hash::{FxHashMap, FxHashSet};

use super::keyword::Kind;
use super::records::{File, Record};
use crate::stages::parse::fault::Read;

/// A relation between two representations.
#[derive(Clone, Copy, Debug)]
pub(super) struct Relation {
    pub first: u64,
    pub second: u64,
    /// ITEM_DEFINED_TRANSFORMATION or CARTESIAN_TRANSFORMATION_OPERATOR_3D between them.
    pub transformation: Option<u64>,
}

/// A product used as part of another one (NEXT_ASSEMBLY_USAGE_OCCURRENCE).
#[derive(Clone, Copy, Debug)]
pub(super) struct Usage {
    pub entity: u64,
    pub parent: u64,
    pub child: u64,
    /// How the child's representation lies in the parent's, where the file says it.
    pub relation: Option<Relation>,
}

/// Products, representations and their relations, by entity number in file order.
#[derive(Debug, Default)]
pub(super) struct Structure {
    pub products: Vec<u64>,
    /// The representations of each product.
    pub shapes: FxHashMap<u64, Vec<u64>>,
    /// All representations that may hold shape.
    pub representations: Vec<u64>,
    /// The relations of a representation other than those that place a used product.
    pub relations: FxHashMap<u64, Vec<Relation>>,
    /// The parts of each product.
    pub parts: FxHashMap<u64, Vec<Usage>>,
    /// All representations that a mapped item places.
    pub mapped: Vec<u64>,
}

/// What is collected before it is put together.
#[derive(Default)]
struct Found {
    usages: Vec<Usage>,
    relations: Vec<(u64, Relation)>,
    /// Product definition shape, representation.
    shapes: Vec<(u64, u64)>,
    /// Relation, product definition shape.
    placements: Vec<(u64, u64)>,
}

/// Reads the structure of a file; entities of it that cannot be read are left out.
pub(super) fn structure(file: &File) -> Structure {
    let (mut structure, mut found) = (Structure::default(), Found::default());
    for entry in &file.table.entries {
        let kind = entry.kind();
        if kind == Kind::Other {
            continue;
        }
        if kind == Kind::Complex {
            let record = file.record_of(*entry);
            record.kinds().for_each(|part| collect(&record, part, &mut structure, &mut found));
        } else if is_structural(kind) {
            collect(&file.record_of(*entry), kind, &mut structure, &mut found);
        }
    }
    join(file, &mut structure, found);
    structure
}

fn is_structural(kind: Kind) -> bool {
    kind.code() >= Kind::MappedItem.code() && kind.code() <= Kind::NextAssemblyUsage.code()
}

/// Notes what `record` tells as an instance of `kind`.
fn collect(record: &Record, kind: Kind, structure: &mut Structure, found: &mut Found) {
    match kind {
        Kind::ProductDefinition | Kind::ProductDefinitionWithDocuments => structure.products.push(record.id),
        Kind::Representation
        | Kind::ShapeRepresentation
        | Kind::AdvancedBrepRepresentation
        | Kind::FacetedBrepRepresentation
        | Kind::ManifoldSurfaceRepresentation
        | Kind::NonManifoldSurfaceRepresentation
        | Kind::BoundedSurfaceRepresentation
        | Kind::BoundedWireframeRepresentation
        | Kind::TessellatedRepresentation
        | Kind::AccurateTessellatedRepresentation
            if structure.representations.last() != Some(&record.id) =>
        {
            structure.representations.push(record.id);
        }
        Kind::RepresentationMap => structure.mapped.extend(mapped_representation(record)),
        Kind::NextAssemblyUsage => found.usages.extend(usage(record)),
        Kind::RepresentationRelationship | Kind::ShapeRepresentationRelationship
            if found.relations.last().map(|r| r.0) != Some(record.id) =>
        {
            found.relations.extend(relation(record).map(|r| (record.id, r)));
        }
        Kind::ShapeDefinitionRepresentation => found.shapes.extend(pair(record)),
        Kind::ContextDependentRepresentation => found.placements.extend(pair(record)),
        _ => {}
    }
}

fn mapped_representation(record: &Record) -> Read<u64> {
    record.fields(&[Kind::RepresentationMap]).skip_many(1).reference()
}

fn usage(record: &Record) -> Read<Usage> {
    let mut cursor = record.fields(&[]);
    let parent = cursor.skip_many(3).reference()?;
    Ok(Usage { entity: record.id, parent, child: cursor.reference()?, relation: None })
}

fn pair(record: &Record) -> Read<(u64, u64)> {
    let mut cursor = record.fields(&[]);
    Ok((cursor.reference()?, cursor.reference()?))
}

fn relation(record: &Record) -> Read<Relation> {
    let mut cursor = record.fields(&[Kind::RepresentationRelationship, Kind::ShapeRepresentationRelationship]);
    let first = cursor.skip_many(2).reference()?;
    let second = cursor.reference()?;
    let transformation = match record.part(Kind::RelationshipWithTransformation) {
        Some(mut part) => part.optional_reference()?,
        None => None,
    };
    Ok(Relation { first, second, transformation })
}

/// Follows product definition shapes to products and usages.
fn join(file: &File, structure: &mut Structure, found: Found) {
    for (definition, representation) in found.shapes {
        if let Some(product) = defined_by(file, definition) {
            structure.shapes.entry(product).or_default().push(representation);
        }
    }
    let all: FxHashMap<u64, Relation> = found.relations.iter().copied().collect();
    let mut placed = FxHashMap::default();
    for &(relation, definition) in &found.placements {
        if let (Some(usage), Some(relation)) = (defined_by(file, definition), all.get(&relation)) {
            placed.entry(usage).or_insert(*relation);
        }
    }
    let placing: FxHashSet<u64> = found.placements.iter().map(|p| p.0).collect();
    for (id, relation) in &found.relations {
        if !placing.contains(id) {
            structure.relations.entry(relation.first).or_default().push(*relation);
            structure.relations.entry(relation.second).or_default().push(*relation);
        }
    }
    for usage in found.usages {
        let usage = Usage { relation: placed.get(&usage.entity).copied(), ..usage };
        structure.parts.entry(usage.parent).or_default().push(usage);
    }
}

/// What a PRODUCT_DEFINITION_SHAPE is the shape of: a product definition or a usage.
fn defined_by(file: &File, definition: u64) -> Option<u64> {
    let record = file.record(definition).ok()?;
    if record.kind != Kind::ProductDefinitionShape {
        return None;
    }
    record.fields(&[]).skip_many(2).reference().ok()
}
