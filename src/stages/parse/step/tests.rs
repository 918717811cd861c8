//! Reading small files written here: structure, units, sharing, and what is broken.

use proptest::prelude::*;

use super::*;
use crate::geometry::Point;
use crate::stages::parse::parse;

/// A tetrahedron as a faceted B-rep, with corners at the origin and one unit along each axis, in units of metres.
const TETRAHEDRON: &str = "
#1=CARTESIAN_POINT('',(0.,0.,0.));#2=CARTESIAN_POINT('',(1.,0.,0.));
#3=CARTESIAN_POINT('',(0.,1.,0.));#4=CARTESIAN_POINT('',(0.,0.,1));
#11=POLY_LOOP('',(#1,#3,#2));#12=POLY_LOOP('',(#1,#2,#4));#13=POLY_LOOP('',(#1,#4,#3));#14=POLY_LOOP('',(#2,#3,#4));
#21=FACE_BOUND('',#11,.T.);#22=FACE_BOUND('',#12,.T.);#23=FACE_BOUND('',#13,.T.);#24=FACE_BOUND('',#14,.T.);
#31=FACE('',(#21));#32=FACE('',(#22));#33=FACE('',(#23));#34=FACE('',(#24));
#40=CLOSED_SHELL('',(#31,#32,#33,#34));#41=FACETED_BREP('',#40);
#50=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#51))REPRESENTATION_CONTEXT('',''));
#51=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT($,.METRE.));
#52=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#53))REPRESENTATION_CONTEXT('',''));
#53=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));
#60=AXIS2_PLACEMENT_3D('',#1,$,$);#61=FACETED_BREP_SHAPE_REPRESENTATION('',(#41,#60),#50);
#70=PRODUCT_DEFINITION('','',#99,#99);#71=PRODUCT_DEFINITION_SHAPE('','',#70);#72=SHAPE_DEFINITION_REPRESENTATION(#71,#61);
";

/// An assembly in mm that uses the tetrahedron twice, shifted by 5 mm along x and by 7 mm along y.
const ASSEMBLY: &str = "
#100=PRODUCT_DEFINITION('','',#99,#99);#101=PRODUCT_DEFINITION_SHAPE('','',#100);
#102=SHAPE_REPRESENTATION('',(#110,#111),#52);#103=SHAPE_DEFINITION_REPRESENTATION(#101,#102);
#108=CARTESIAN_POINT('',(5.,0.,0.));#109=CARTESIAN_POINT('',(0.,7.,0.));
#110=AXIS2_PLACEMENT_3D('',#108,$,$);#111=AXIS2_PLACEMENT_3D('',#109,$,$);
#120=NEXT_ASSEMBLY_USAGE_OCCURRENCE('1','','',#100,#70,$);#121=PRODUCT_DEFINITION_SHAPE('','',#120);
#122=CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#123,#121);
#123=(REPRESENTATION_RELATIONSHIP('','',#61,#102)REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(#124)SHAPE_REPRESENTATION_RELATIONSHIP());
#124=ITEM_DEFINED_TRANSFORMATION('','',#60,#110);
#130=NEXT_ASSEMBLY_USAGE_OCCURRENCE('2','','',#100,#70,$);#131=PRODUCT_DEFINITION_SHAPE('','',#130);
#132=CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#133,#131);
#133=(REPRESENTATION_RELATIONSHIP('','',#102,#61)REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(#134)SHAPE_REPRESENTATION_RELATIONSHIP());
#134=ITEM_DEFINED_TRANSFORMATION('','',#111,#60);
";

fn read_text(data: &str) -> Result<Reading, ModelError> {
    let text = format!("ISO-10303-21;DATA;{data}ENDSEC;END-ISO-10303-21;");
    read(text.as_bytes(), &Options::default(), &Cancel::new())
}

#[test]
fn a_faceted_tetrahedron_shares_its_edges() {
    let Reading { model, skipped, warnings } = read_text(TETRAHEDRON).unwrap();
    assert_eq!((model.vertices.len(), model.edges.len(), model.faces.len()), (4, 6, 4));
    assert_eq!((model.bodies[0].solid, model.shells[0].closed, model.occurrences.len()), (true, true, 1));
    assert_eq!((model.unit_mm, model.vertices[1].point.coords.norm()), (1000.0, 1000.0));
    assert!(skipped.is_empty() && warnings.is_empty());
}

#[test]
fn a_parsed_tetrahedron_has_its_area_and_volume() {
    let text = format!("DATA;{TETRAHEDRON}");
    let parsed = parse(text.as_bytes(), &Options::default(), None, &Cancel::new()).unwrap();
    let area = 1.5 + 0.75_f64.sqrt();
    assert!((parsed.measures.area / 1e6 - area).abs() < 1e-9);
    assert!((parsed.measures.volume / 1e9 - 1.0 / 6.0).abs() < 1e-9);
}

#[test]
fn parts_are_placed_whichever_way_the_relation_is_written() {
    let Reading { model, skipped, .. } = read_text(&format!("{TETRAHEDRON}{ASSEMBLY}")).unwrap();
    assert!(skipped.is_empty(), "{skipped:?}");
    assert_eq!(model.bodies.len(), 1);
    let placed: Vec<_> =
        model.occurrences.iter().map(|o| (o.path.as_str(), o.placement.point(&Point::origin()))).collect();
    assert_eq!(placed, [("120", Point::new(5.0, 0.0, 0.0)), ("130", Point::new(0.0, 7.0, 0.0))]);
}

#[test]
fn a_product_in_itself_costs_only_that_branch() {
    let cycle = "#140=NEXT_ASSEMBLY_USAGE_OCCURRENCE('3','','',#70,#100,$);#150=PRODUCT_DEFINITION('','',#99,#99);
        #151=NEXT_ASSEMBLY_USAGE_OCCURRENCE('4','','',#150,#100,$);";
    let Reading { model, skipped, .. } = read_text(&format!("{TETRAHEDRON}{ASSEMBLY}{cycle}")).unwrap();
    assert_eq!(model.occurrences.len(), 2);
    assert!(skipped.iter().all(|s| s.entity == 140 && s.why.contains("part of itself")), "{skipped:?}");
}

#[test]
fn a_mapped_item_places_what_it_maps() {
    let mapped = "#200=REPRESENTATION_MAP(#60,#61);#201=MAPPED_ITEM('',#200,#110);#202=MAPPED_ITEM('',#200,#203);
        #203=CARTESIAN_TRANSFORMATION_OPERATOR_3D('',$,$,#109,2.,$);#204=SHAPE_REPRESENTATION('',(#201,#202,#205),#52);
        #205=MAPPED_ITEM('',#206,#110);#206=REPRESENTATION_MAP(#110,#204);
        #108=CARTESIAN_POINT('',(5.,0.,0.));#109=CARTESIAN_POINT('',(0.,7.,0.));#110=AXIS2_PLACEMENT_3D('',#108,$,$);";
    let without_product = TETRAHEDRON.replace("#72=SHAPE_DEFINITION_REPRESENTATION(#71,#61);", "");
    let Reading { model, skipped, .. } = read_text(&format!("{without_product}{mapped}")).unwrap();
    let ends: Vec<_> = model.occurrences.iter().map(|o| o.placement.point(&Point::new(1.0, 0.0, 0.0))).collect();
    assert_eq!(ends, [Point::new(6.0, 0.0, 0.0), Point::new(2.0, 7.0, 0.0)]);
    assert_eq!(skipped[0].entity, 205);
}

#[test]
fn a_broken_face_is_skipped_with_its_number() {
    let Reading { model, skipped, .. } =
        read_text(&TETRAHEDRON.replace("#33=FACE('',(#23));", "#33=FACE('',(#999));")).unwrap();
    assert_eq!(model.faces.len(), 3);
    assert_eq!(skipped, [Skipped { entity: 33, why: "#999: there is no such instance".into() }]);
}

#[test]
fn files_without_faces_say_why() {
    let why = |bytes: &[u8]| read(bytes, &Options::default(), &Cancel::new()).unwrap_err().why;
    assert_eq!(why(b"solid ascii stl"), "not a STEP file");
    assert_eq!(why(b""), "not a STEP file");
    assert_eq!(why(b"ISO-10303-21;DATA;ENDSEC;END-ISO-10303-21;"), "no entities");
    assert_eq!(why(b"DATA;#1=PRODUCT();"), "no shape representation");
    assert_eq!(why(b"#1=SHAPE_REPRESENTATION('',(#2),#3);#2=GEOMETRIC_CURVE_SET('',());"), "wireframe only: no faces");
}

proptest! {
    #[test]
    fn mutated_files_never_panic(cut in 0_usize..4000, changes in prop::collection::vec((0_usize..4000, any::<u8>()), 0..12)) {
        let mut bytes = format!("{TETRAHEDRON}{ASSEMBLY}").into_bytes();
        let length = bytes.len();
        changes.into_iter().for_each(|(at, value)| bytes[at % length] = value);
        bytes.truncate(length - cut % length / 4);
        if let Ok(Reading { model, .. }) = read(&bytes, &Options::default(), &Cancel::new()) {
            prop_assert!(!model.occurrences.is_empty());
        }
    }

    #[test]
    fn swapped_references_never_panic(swaps in prop::collection::vec((1_u64..140, 1_u64..140), 1..8)) {
        let mut text = format!("{TETRAHEDRON}{ASSEMBLY}");
        for (from, to) in swaps {
            text = text.replace(&format!("#{from},"), &format!("#{to},")).replace(&format!("#{from})"), &format!("#{to})"));
        }
        if let Ok(Reading { model, .. }) = read(text.as_bytes(), &Options::default(), &Cancel::new()) {
            prop_assert!(!model.occurrences.is_empty());
        }
    }
}
