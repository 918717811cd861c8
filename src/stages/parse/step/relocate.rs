//! A STEP file moved without touching its entities.
//!
//! Method: a new product is added above the products of the file that are part of no other, each of which it uses
//! (NEXT_ASSEMBLY_USAGE_OCCURRENCE) at the place it is moved to. Representations that no product leads to become
//! mapped items of the new product; solids that no representation holds get one. Afterwards the structure is read
//! again and must place the same items, each moved.

use std::fmt::Write;

use super::assembly::{Assembly, assemble};
use super::keyword::Kind;
use super::lexer::{self, Table, behind_statement};
use super::placement::Geometry;
use super::records::File;
use super::structure::{Structure, structure};
use super::units::Units;
use crate::cancel::Cancel;
use crate::geometry::{Isometry, Transform};
use crate::stages::parse::Options;
use crate::stages::{ModelError, Stage};

/// How far a placement of the moved file may be off, mm and parts of one.
const CLOSE: f64 = 1e-6;

/// The file with everything in it moved.
///
/// Errors: where the bytes are no STEP file or place nothing, where more than adding entities would be needed, and
/// when cancelled.
pub(in crate::stages::parse) fn relocated(
    bytes: &[u8],
    by: &Isometry,
    options: &Options,
    cancel: &Cancel,
) -> Result<Vec<u8>, ModelError> {
    let (table, before) = assembled(bytes, options, cancel)?;
    let file = File { bytes, table: &table };
    let added = Addition::new(file, by.as_transform()).and_then(|addition| addition.over(&before));
    let added = added.ok_or_else(|| ModelError::new(Stage::Parse, "no place to add entities to"))?;
    let last = table.entries.iter().map(|e| e.start()).max().and_then(|at| behind_statement(bytes, at));
    let (head, tail) = bytes.split_at(last.unwrap_or(bytes.len()));
    // A file that does not end is ended here: what follows its last whole instance cannot be read.
    let tail = if table.ended { tail } else { b"\nENDSEC;\nEND-ISO-10303-21;\n" };
    let moved = [head, b"\n", added.trim_end().as_bytes(), tail].concat();
    let (_, after) = assembled(&moved, options, cancel)?;
    same_but_moved(&before, &after, &by.as_transform())?;
    Ok(moved)
}

fn assembled(bytes: &[u8], options: &Options, cancel: &Cancel) -> Result<(Table, Assembly), ModelError> {
    let stopped = |c| ModelError::cancelled(Stage::Parse, c);
    let table = lexer::scan(bytes, cancel).map_err(stopped)?;
    let assembly = assemble(File { bytes, table: &table }, options.most_occurrences, cancel).map_err(stopped)?;
    Ok((table, assembly))
}

/// Whether each item lies where it was moved to.
fn same_but_moved(before: &Assembly, after: &Assembly, by: &Transform) -> Result<(), ModelError> {
    let ordered = |assembly: &Assembly| {
        let mut placed: Vec<_> = assembly.placed.iter().map(|p| (p.item, p.placement)).collect();
        placed.sort_by_key(|p| p.0);
        placed
    };
    let (before, after) = (ordered(before), ordered(after));
    let close = |a: &Transform, b: &Transform| {
        let far = a.translation.norm().max(1.0);
        (a.linear - b.linear).norm() <= CLOSE && (a.translation - b.translation).norm() <= CLOSE * far
    };
    let differs = |((item, old), (same, new)): (&(u64, Transform), &(u64, Transform))| {
        item != same || !close(&by.after(old), new)
    };
    let pairs = before.iter().zip(&after);
    match pairs.clone().find(|(old, new)| differs((old, new))) {
        Some(((item, _), _)) => Err(ModelError::at(Stage::Parse, *item, "cannot be moved by adding entities")),
        None if before.len() != after.len() => {
            Err(ModelError::new(Stage::Parse, "the file cannot be moved by adding entities"))
        }
        None => Ok(()),
    }
}

/// Entities to add, in mm and radians.
struct Addition<'a> {
    file: File<'a>,
    structure: Structure,
    by: Transform,
    next: u64,
    text: String,
    /// Items of the new product's representation.
    items: Vec<u64>,
}

/// The new product's definition, the context of its units, and its representation, whose items come last.
struct Top {
    product: u64,
    context: u64,
    representation: u64,
}

impl<'a> Addition<'a> {
    /// `None` where there is no number left to give.
    fn new(file: File<'a>, by: Transform) -> Option<Self> {
        let next = file.table.entries.last()?.id.checked_add(1)?;
        // Far more numbers than entities are added: three hundred million of each root.
        next.checked_add(u64::from(u32::MAX))?;
        Some(Self { file, structure: structure(&file), by, next, text: String::new(), items: Vec::new() })
    }

    /// Adds the new product above all roots.
    fn over(mut self, assembly: &Assembly) -> Option<String> {
        let roots = &assembly.roots;
        let top = self.top();
        for &product in &roots.products {
            self.use_product(&top, product);
        }
        for &representation in &roots.representations {
            self.map(representation);
        }
        if !roots.items.is_empty() {
            let items = list(&roots.items);
            let bare = self.add(&format!("SHAPE_REPRESENTATION('',{items},#{})", top.context));
            self.map(bare);
        }
        let (items, Top { context, representation, .. }) = (list(&self.items), top);
        let _ = writeln!(self.text, "#{representation}=SHAPE_REPRESENTATION('aligned',{items},#{context});");
        (!self.items.is_empty()).then_some(self.text)
    }

    /// Adds an entity and returns its number.
    fn add(&mut self, entity: &str) -> u64 {
        let id = self.next;
        self.next += 1;
        // Writing to a string cannot fail.
        let _ = writeln!(self.text, "#{id}={entity};");
        id
    }

    /// The new product with all that a product needs; its representation is numbered, and written in the end.
    fn top(&mut self) -> Top {
        let application = self.add("APPLICATION_CONTEXT('mechanical design')");
        let context = self.add(&format!("PRODUCT_CONTEXT('',#{application},'mechanical')"));
        let stage = self.add(&format!("PRODUCT_DEFINITION_CONTEXT('part definition',#{application},'design')"));
        let product = self.add(&format!("PRODUCT('aligned','aligned','',(#{context}))"));
        let formation = self.add(&format!("PRODUCT_DEFINITION_FORMATION('','',#{product})"));
        let product = self.add(&format!("PRODUCT_DEFINITION('design','',#{formation},#{stage})"));
        let shape = self.add(&format!("PRODUCT_DEFINITION_SHAPE('','',#{product})"));
        let length = self.add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))");
        let angle = self.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))");
        let solid = self.add("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())");
        let context = self.add(&format!(
            "(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#{length},#{angle},#{solid}))\
             REPRESENTATION_CONTEXT('aligned','3D'))"
        ));
        let representation = self.next;
        self.next += 1;
        self.add(&format!("SHAPE_DEFINITION_REPRESENTATION(#{shape},#{representation})"));
        Top { product, context, representation }
    }

    /// Uses a product of the file in the new one, where it is moved to.
    fn use_product(&mut self, top: &Top, product: u64) {
        let known = self.structure.shapes.get(&product).and_then(|shapes| shapes.first().copied());
        let shape = known.unwrap_or_else(|| self.empty_shape_of(product));
        // A transformation takes a placement of one representation to one of the other.
        let from = self.origin_of(shape);
        let to = self.placement(&{ self.by });
        self.items.push(to);
        let usage =
            self.add(&format!("NEXT_ASSEMBLY_USAGE_OCCURRENCE('#{product}','','',#{},#{product},$)", top.product));
        let placed = self.add(&format!("PRODUCT_DEFINITION_SHAPE('','',#{usage})"));
        let transformation = self.add(&format!("ITEM_DEFINED_TRANSFORMATION('','',#{from},#{to})"));
        let relation = self.add(&format!(
            "(REPRESENTATION_RELATIONSHIP('','',#{shape},#{})\
             REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(#{transformation})SHAPE_REPRESENTATION_RELATIONSHIP())",
            top.representation
        ));
        self.add(&format!("CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#{relation},#{placed})"));
    }

    /// A representation for a product that has only parts.
    fn empty_shape_of(&mut self, product: u64) -> u64 {
        let length = self.add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))");
        let context = self.add(&format!(
            "(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#{length}))\
             REPRESENTATION_CONTEXT('',''))"
        ));
        let origin = self.placement(&Transform::identity());
        let representation = self.add(&format!("SHAPE_REPRESENTATION('',(#{origin}),#{context})"));
        let shape = self.add(&format!("PRODUCT_DEFINITION_SHAPE('','',#{product})"));
        self.add(&format!("SHAPE_DEFINITION_REPRESENTATION(#{shape},#{representation})"));
        representation
    }

    /// Places a representation in the new product's.
    fn map(&mut self, representation: u64) {
        let origin = self.origin_of(representation);
        let to = self.placement(&{ self.by });
        let map = self.add(&format!("REPRESENTATION_MAP(#{origin},#{representation})"));
        let item = self.add(&format!("MAPPED_ITEM('',#{map},#{to})"));
        self.items.extend([to, item]);
    }

    /// A placement at the origin: among the items of a representation, as transformations ask for, or else a new one.
    ///
    /// OpenCASCADE misreads others of an assembly, where its parts are placed from.
    fn origin_of(&mut self, representation: u64) -> u64 {
        // The origin is the same in all units.
        self.own_origin(representation).unwrap_or_else(|| self.placement(&Transform::identity()))
    }

    fn own_origin(&self, representation: u64) -> Option<u64> {
        let record = self.file.record(representation).ok()?;
        let mut cursor = record.fields(&[Kind::Representation]);
        let items = cursor.skip_many(1).references_leniently().ok()?;
        let geometry = Geometry::new(self.file, Units::default());
        let is_placement = |item: u64| self.file.record(item).is_ok_and(|r| r.is(Kind::Axis2));
        let is_origin = |item: u64| is_placement(item) && geometry.transform(item) == Ok(Transform::identity());
        items.into_iter().find(|item| is_origin(*item))
    }

    /// Adds a placement, in mm.
    fn placement(&mut self, at: &Transform) -> u64 {
        let origin = self.add(&format!("CARTESIAN_POINT('',{})", triple(at.translation.as_slice())));
        let z = self.add(&format!("DIRECTION('',{})", triple(at.linear.column(2).as_slice())));
        let x = self.add(&format!("DIRECTION('',{})", triple(at.linear.column(0).as_slice())));
        self.add(&format!("AXIS2_PLACEMENT_3D('',#{origin},#{z},#{x})"))
    }
}

/// A list of references.
fn list(ids: &[u64]) -> String {
    let ids: Vec<_> = ids.iter().map(|id| format!("#{id}")).collect();
    format!("({})", ids.join(","))
}

/// A list of reals.
fn triple(values: &[f64]) -> String {
    let values: Vec<_> = values.iter().map(|v| real(*v)).collect();
    format!("({})", values.join(","))
}

/// A number as Part 21 writes it: with a point, also before an exponent.
fn real(value: f64) -> String {
    let text = format!("{value:?}");
    match text.split_once('e') {
        Some((digits, exponent)) if digits.contains('.') => format!("{digits}E{exponent}"),
        Some((digits, exponent)) => format!("{digits}.E{exponent}"),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Chirality, Matrix, Vector};
    use crate::stages::parse::read;

    /// Turns x to y, and 10 mm up.
    fn motion() -> Isometry {
        let rotation = Matrix::new(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0);
        Isometry { rotation, translation: Vector::new(0.0, 0.0, 10.0), chirality: Chirality::Proper }
    }

    fn placements(bytes: &[u8]) -> Vec<Transform> {
        let reading = read(bytes, &Options::default(), &Cancel::new()).unwrap();
        reading.model.occurrences.iter().map(|o| o.placement).collect()
    }

    /// A triangle as a faceted surface model, held by what `structure` says.
    fn file(structure: &str) -> String {
        format!(
            "ISO-10303-21;HEADER;FILE_SCHEMA(('AUTOMOTIVE_DESIGN'));ENDSEC;DATA;
             #1=SHELL_BASED_SURFACE_MODEL('',(#2));#2=OPEN_SHELL('',(#3));#3=FACE_SURFACE('',(#4),#5,.T.);
             #4=FACE_BOUND('',#6,.T.);#5=PLANE('',#7);#6=POLY_LOOP('',(#8,#9,#10));#7=AXIS2_PLACEMENT_3D('',#8,$,$);
             #8=CARTESIAN_POINT('',(0.,0.,0.));#9=CARTESIAN_POINT('',(1.,0.,0.));#10=CARTESIAN_POINT('',(0.,1.,0.));
             #20=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#21))REPRESENTATION_CONTEXT('',''));
             #21=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.CENTI.,.METRE.));
             #22=AXIS2_PLACEMENT_3D('',#9,$,$);{structure}\nENDSEC;END-ISO-10303-21;"
        )
    }

    fn assert_moved(text: &str) {
        let moved = relocated(text.as_bytes(), &motion(), &Options::default(), &Cancel::new()).unwrap();
        let (before, after) = (placements(text.as_bytes()), placements(&moved));
        assert!(!before.is_empty() && before.len() == after.len());
        for (old, new) in before.iter().zip(&after) {
            let expected = motion().as_transform().after(old);
            assert!((expected.linear - new.linear).norm() < 1e-12, "{new:?}");
            assert!((expected.translation - new.translation).norm() < 1e-12, "{new:?}");
        }
        let kept = moved.starts_with(text.split("ENDSEC;END").next().unwrap().trim_end().as_bytes());
        assert!(kept && moved.ends_with(b"END-ISO-10303-21;"));
    }

    #[test]
    fn a_product_is_moved_from_the_origin() {
        assert_moved(&file(
            "#30=PRODUCT_DEFINITION('','',#99,#99);#31=PRODUCT_DEFINITION_SHAPE('','',#30);
             #32=MANIFOLD_SURFACE_SHAPE_REPRESENTATION('',(#1,#22),#20);#33=SHAPE_DEFINITION_REPRESENTATION(#31,#32);",
        ));
    }

    #[test]
    fn representations_and_solids_without_a_product_are_moved() {
        assert_moved(&file("#32=MANIFOLD_SURFACE_SHAPE_REPRESENTATION('',(#1,#22),#20);"));
        assert_moved(&file("#32=MANIFOLD_SURFACE_SHAPE_REPRESENTATION('',(#1),#20);"));
        assert_moved(&file(""));
    }

    #[test]
    fn a_file_that_breaks_off_is_ended() {
        let text = file("#32=MANIFOLD_SURFACE_SHAPE_REPRESENTATION('',(#1,#22),#20);#33=CARTESIAN_PO");
        let text = text.split("\nENDSEC;END").next().unwrap();
        let moved = relocated(text.as_bytes(), &motion(), &Options::default(), &Cancel::new()).unwrap();
        assert!(moved.ends_with(b"ENDSEC;\nEND-ISO-10303-21;\n"));
        assert_eq!(placements(&moved).len(), 1);
    }

    #[test]
    fn what_is_no_step_file_is_refused() {
        assert!(relocated(b"DBRep_DrawableShape", &motion(), &Options::default(), &Cancel::new()).is_err());
    }

    #[test]
    fn numbers_have_a_point() {
        assert_eq!([1.0, -0.5, 1e-9, 1.5e-9, 3e20].map(real), ["1.0", "-0.5", "1.E-9", "1.5E-9", "3.E20"]);
    }
}
